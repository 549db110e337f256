/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/legend.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/output/draw/chart.h"

static const double LINE = 11.0, SIGN = 20.0, SCALE = 34.0, SIGN_GAP = 4.0,
                    BETWEEN = 13.0; /* [pt] */
static const double DOT = 2.6, MARKER = 2.0, BAND = 5.0, AREA = 7.0;

static strut_font letters(void) { return (strut_font){.size = 7.5, .down = 0.5}; }

static double text_width(strut_canvas *canvas, const char *text) {
  return text && *text ? strut_text_width(canvas, text, letters()) : 0;
}

/* The sign left of the text, which is drawn if `draw`. Returns how far right of it the text begins. */
static double put_sign(strut_canvas *canvas, const strut_key_item *item, double x, double y,
                       bool draw) {
  const strut_pen rim = {.colour = strut_grey(0.4), .width = 0.4};
  double before = text_width(canvas, item->before) + SIGN_GAP;
  strut_font font = letters();
  switch (item->sign) {
    case STRUT_KEY_WORDS: return 0.0;
    case STRUT_KEY_DOT:
      font.bold = true;
      if (draw) strut_draw_circle(canvas, x + DOT, y, DOT, &item->fill, &item->pen);
      if (draw) strut_draw_text(canvas, x + 2 * DOT + SIGN_GAP, y, item->letter, font);
      return 2 * DOT + SIGN_GAP +
             (item->letter ? text_width(canvas, item->letter) + SIGN_GAP : 0.0);
    case STRUT_KEY_SIGNED:
      if (draw) strut_draw_text(canvas, x, y, item->before, font);
      if (draw)
        strut_draw_shades(canvas, (strut_box){x + before, y - BAND / 2, SCALE, BAND},
                          STRUT_COLOURS_SIGNED, -1, 1);
      return before + SCALE + SIGN_GAP;
    case STRUT_KEY_LINE:
      if (draw) strut_draw_segment(canvas, x, y, x + SIGN, y, item->pen);
      if (draw && item->marked) strut_draw_marker(canvas, item->look, x + 0.5 * SIGN, y, MARKER);
      break;
    case STRUT_KEY_CLOUD:
      if (draw) strut_draw_circle(canvas, x + 0.5 * SIGN, y, DOT, &item->fill, NULL);
      break;
    case STRUT_KEY_ARROW:
      if (draw) strut_draw_arrow(canvas, x, y, x + SIGN, y, 4.0, item->pen);
      break;
    case STRUT_KEY_AREA:
      if (draw)
        strut_draw_box(canvas, (strut_box){x, y - 0.5 * AREA, SIGN, AREA}, &item->fill, &rim);
  }
  return SIGN + SIGN_GAP;
}

strut_box strut_draw_key(strut_canvas *canvas, strut_box box, const strut_key_item *items,
                         size_t count, bool draw) {
  double x = 0.0, y = 0.0, row = LINE, line = strut_text_height(canvas, "0", letters());
  strut_box whole = {box.x, box.y, 0, 0};
  for (size_t i = 0; i < count; i++) {
    if (!items[i].text) continue;
    double sign = put_sign(canvas, &items[i], 0, 0, false), width, height;
    strut_font font = letters();
    font.down = 0.0;
    if (box.width > 0 && sign + text_width(canvas, items[i].text) > box.width)
      font.width = box.width - sign;
    strut_text_size(canvas, items[i].text, font, &width, &height);
    if (x > 0 && x + sign + width > box.width) x = 0.0, y += row, row = LINE;
    double top = y + 0.5 * (LINE - line);
    if (draw) {
      put_sign(canvas, &items[i], box.x + x, box.y + y + 0.5 * LINE, true);
      strut_draw_text(canvas, box.x + x + sign, box.y + top, items[i].text, font);
    }
    row = fmax(row, height + LINE - line);
    whole.width = fmax(whole.width, x + sign + width);
    x += sign + width + BETWEEN;
  }
  whole.height = x > 0.0 ? y + row : 0.0;
  return whole;
}

static bool fits(strut_canvas *canvas, const char *text, strut_font font, double width,
                 double height) {
  double wide, high;
  strut_text_size(canvas, text, font, &wide, &high);
  return wide <= width + 1e-6 && (height <= 0 || high <= height + 1e-6);
}

int strut_text_bytes(const char *text, int most) {
  int length = (int)strnlen(text, (size_t)most), last = length;
  while (last > 0 && ((unsigned char)text[last - 1] & 0xC0) == 0x80) last--;
  if (last == 0) return 0;
  unsigned char lead = (unsigned char)text[last - 1];
  int wanted = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC0 ? 2 : 1;
  return length - last + 1 < wanted ? last - 1 : length;
}

const char *strut_text_fit(strut_canvas *canvas, const char *text, strut_font font, double width,
                           double height, char fitted[STRUT_FITTED_TEXT]) {
  static const char ELLIPSIS[] = "\xE2\x80\xA6";
  int length = strut_text_bytes(text, STRUT_FITTED_TEXT - (int)sizeof ELLIPSIS);
  bool whole = text[length] == '\0';
  for (;;) {
    memcpy(fitted, text, (size_t)length);
    memcpy(fitted + length, ELLIPSIS, sizeof ELLIPSIS);
    if (whole) fitted[length] = '\0';
    if (length == 0 || fits(canvas, fitted, font, width, height)) return fitted;
    if (!whole) length = strut_text_bytes(text, length - 1);
    whole = false;
  }
}

/* ---- styles of series ---- */

strut_pen strut_series_pen(size_t look) {
  enum { DASHES = 7 };
  static const double dashes[DASHES][4] = {{0},      {5, 2}, {1.2, 1.8}, {6, 2, 1.2, 2},
                                           {3, 1.5}, {8, 2}, {2, 3}};
  strut_pen pen = {.colour = strut_palette_thing(look), .width = 1.2};
  /* When colours repeat, dashes differ. */
  size_t dash = (look + 3 * (look / STRUT_PALETTE_THINGS)) % DASHES;
  for (int i = 0; i < 4; i++) pen.dash[i] = dashes[dash][i];
  pen.butt = pen.dash[0] > 0;
  return pen;
}

void strut_draw_marker(strut_canvas *canvas, size_t look, double x, double y, double size) {
  static const double diamond[4][2] = {{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}};
  static const double square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  static const double up[3][2] = {{0, -1.3}, {1.2, 0.9}, {-1.2, 0.9}};
  static const double down[3][2] = {{0, 1.3}, {1.2, -0.9}, {-1.2, -0.9}};
  static const struct {
    const double (*corner)[2];
    size_t count;
  } shapes[] = {{NULL, 0}, {square, 4}, {up, 3}, {diamond, 4}, {down, 3}};
  const strut_fill full = {.colour = strut_palette_thing(look)}, hollow = {.colour = strut_grey(1)};
  const strut_pen edge = {.colour = strut_palette_thing(look), .width = 0.8};
  const strut_pen rim = {.colour = strut_grey(1), .width = 0.4};
  size_t shape = look % 5;
  bool open = look / 5 % 2 == 1;
  double corners[4][2];
  if (shape == 0) {
    strut_draw_circle(canvas, x, y, size, open ? &hollow : &full, open ? &edge : &rim);
    return;
  }
  for (size_t i = 0; i < shapes[shape].count; i++) {
    corners[i][0] = x + size * shapes[shape].corner[i][0];
    corners[i][1] = y + size * shapes[shape].corner[i][1];
  }
  strut_draw_polygon(canvas, (const double(*)[2])corners, shapes[shape].count,
                     open ? &hollow : &full, open ? &edge : &rim);
}

/* ---- colours ---- */

/* Anchors at equal distances; the lightness of each row grows from left to right. */
enum { ANCHORS = 5 };
static const unsigned SIGNED[ANCHORS] = {0x0A1F66, 0x2F4A9E, 0x7D8390, 0xC98B45, 0xF5A31A};
static const unsigned SEQUENCE[ANCHORS] = {0x2A0F54, 0x33508C, 0x1F8A8C, 0x55B567, 0xD3CB2F};
static const unsigned DIVERGING[ANCHORS] = {0x1B4A9C, 0x7AA3D4, 0xEBEBEB, 0xE59A52, 0x9C430C};
static const unsigned THINGS[STRUT_PALETTE_THINGS] = {0x0060A8, 0xD55E00, 0x009E73, 0xB0508F,
                                                      0xE69F00, 0x4FAEE6, 0x333333};

static strut_colour from(unsigned rgb) {
  return (strut_colour){(double)(rgb >> 16) / 255.0, (double)(rgb >> 8 & 255) / 255.0,
                        (double)(rgb & 255) / 255.0, 1.0};
}

/* value from 0 to 1 along the anchors. */
static strut_colour between(const unsigned anchors[ANCHORS], double value) {
  double place = (value > 0 ? value < 1 ? value : 1.0 : 0.0) * (ANCHORS - 1);
  int i = (int)place < ANCHORS - 1 ? (int)place : ANCHORS - 2;
  double t = place - i;
  strut_colour a = from(anchors[i]), b = from(anchors[i + 1]);
  return (strut_colour){a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
                        a.blue + t * (b.blue - a.blue), 1.0};
}

strut_colour strut_palette_at(strut_colours colours, double value, double low, double high) {
  static const unsigned *const anchors[] = {[STRUT_COLOURS_SEQUENTIAL] = SEQUENCE,
                                            [STRUT_COLOURS_DIVERGING] = DIVERGING,
                                            [STRUT_COLOURS_SIGNED] = SIGNED};
  double part = (value - low) / (high - low), limit = fmax(fabs(low), fabs(high));
  assert(colours != STRUT_COLOURS_AUTO && "a map decides what AUTO means");
  if (colours == STRUT_COLOURS_GREY) return strut_grey(0.12 + 0.8 * fmax(0, fmin(1, part)));
  return between(anchors[colours],
                 colours == STRUT_COLOURS_SEQUENTIAL ? part : 0.5 + 0.5 * value / limit);
}

strut_colour strut_palette_signed(double value) {
  return strut_palette_at(STRUT_COLOURS_SIGNED, value, -1, 1);
}

strut_colour strut_palette_sequence(double value) {
  return strut_palette_at(STRUT_COLOURS_SEQUENTIAL, value, 0, 1);
}

strut_colour strut_palette_thing(size_t i) { return from(THINGS[i % STRUT_PALETTE_THINGS]); }

strut_colour strut_grey(double brightness) {
  return (strut_colour){brightness, brightness, brightness, 1.0};
}

strut_colour strut_faded(strut_colour colour, double alpha) {
  colour.alpha *= alpha;
  return colour;
}
