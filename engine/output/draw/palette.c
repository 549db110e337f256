/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/palette.h"

#include <assert.h>
#include <math.h>

/* Anchors at equal distances; the lightness of each row grows from left to right. */
static const unsigned SIGNED[] = {0x0A1F66, 0x2F4A9E, 0x7D8390, 0xC98B45, 0xF5A31A};
static const unsigned SEQUENCE[] = {0x2A0F54, 0x33508C, 0x1F8A8C, 0x55B567, 0xD3CB2F};
static const unsigned DIVERGING[] = {0x1B4A9C, 0x7AA3D4, 0xEBEBEB, 0xE59A52, 0x9C430C};
static const unsigned THINGS[STRUT_PALETTE_THINGS] = {0x0060A8, 0xD55E00, 0x009E73, 0xB0508F,
                                                      0xE69F00, 0x4FAEE6, 0x333333};

static strut_colour from(unsigned rgb) {
  return (strut_colour){(double)(rgb >> 16) / 255.0, (double)(rgb >> 8 & 255) / 255.0,
                        (double)(rgb & 255) / 255.0, 1.0};
}

/* value from 0 to 1 along (count) anchors. */
static strut_colour between(const unsigned *anchors, int count, double value) {
  double place = (value > 0 ? value < 1 ? value : 1.0 : 0.0) * (count - 1);
  int i = (int)place < count - 1 ? (int)place : count - 2;
  double t = place - i;
  strut_colour a = from(anchors[i]), b = from(anchors[i + 1]);
  return (strut_colour){a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
                        a.blue + t * (b.blue - a.blue), 1.0};
}

strut_colour strut_palette_signed(double value) {
  return between(SIGNED, sizeof SIGNED / sizeof *SIGNED, 0.5 + 0.5 * value);
}

strut_colour strut_palette_sequence(double value) {
  return between(SEQUENCE, sizeof SEQUENCE / sizeof *SEQUENCE, value);
}

strut_colour strut_palette_diverging(double value) {
  return between(DIVERGING, sizeof DIVERGING / sizeof *DIVERGING, 0.5 + 0.5 * value);
}

strut_colour strut_palette_at(strut_colours colours, double value, double low, double high) {
  double part = (value - low) / (high - low), limit = fmax(fabs(low), fabs(high));
  switch (colours) {
    case STRUT_COLOURS_SEQUENTIAL: return strut_palette_sequence(part);
    case STRUT_COLOURS_DIVERGING: return strut_palette_diverging(value / limit);
    case STRUT_COLOURS_GREY: return strut_grey(0.12 + 0.8 * fmax(0, fmin(1, part)));
    case STRUT_COLOURS_SIGNED: return strut_palette_signed(value / limit);
    case STRUT_COLOURS_AUTO: break;
  }
  assert(false && "a map decides what AUTO means");
  return strut_grey(0.5);
}

strut_colour strut_palette_thing(size_t i) { return from(THINGS[i % STRUT_PALETTE_THINGS]); }

strut_colour strut_grey(double brightness) {
  return (strut_colour){brightness, brightness, brightness, 1.0};
}

strut_colour strut_faded(strut_colour colour, double alpha) {
  colour.alpha *= alpha;
  return colour;
}
