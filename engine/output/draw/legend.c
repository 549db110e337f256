/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/legend.h"

#include <string.h>

#include "engine/output/draw/palette.h"

static const double LINE = 11.0, SIGN = 16.0, SCALE = 34.0, GAP = 4.0, BETWEEN = 13.0; /* [pt] */
static const double DOT = 2.6, BAND = 5.0;
enum { SHADES = 34 };

static strut_font letters(void) { return (strut_font){.size = 7.5, .down = 0.5}; }

static double width_of(strut_canvas *canvas, const char *text) {
  double width = 0, height;
  if (text && *text) strut_text_size(canvas, text, letters(), &width, &height);
  return width;
}

/* What stands left of the text. */
static double sign_width(strut_canvas *canvas, const strut_key_item *item) {
  switch (item->sign) {
    case STRUT_KEY_LINE:
    case STRUT_KEY_ARROW: return SIGN + GAP;
    case STRUT_KEY_DOT:
      return 2 * DOT + GAP + (item->letter ? width_of(canvas, item->letter) + GAP : 0.0);
    case STRUT_KEY_SIGNED: return width_of(canvas, item->before) + SCALE + 2 * GAP;
    case STRUT_KEY_WORDS: break;
  }
  return 0.0;
}

static void draw_sign(strut_canvas *canvas, const strut_key_item *item, double x, double y) {
  strut_font font = letters();
  switch (item->sign) {
    case STRUT_KEY_LINE: strut_draw_segment(canvas, x, y, x + SIGN, y, item->pen); break;
    case STRUT_KEY_ARROW: strut_draw_arrow(canvas, x, y, x + SIGN, y, 4.0, item->pen); break;
    case STRUT_KEY_DOT:
      strut_draw_circle(canvas, x + DOT, y, DOT, &item->fill, &item->pen);
      font.bold = true;
      if (item->letter) strut_draw_text(canvas, x + 2 * DOT + GAP, y, item->letter, font);
      break;
    case STRUT_KEY_SIGNED:
      strut_draw_text(canvas, x, y, item->before, font);
      x += width_of(canvas, item->before) + GAP;
      for (int i = 0; i < SHADES; i++) {
        /* Each reaches below the next, or the white between them would show. */
        const strut_fill fill = {.colour = strut_palette_signed(2.0 * i / (SHADES - 1) - 1.0)};
        double at = SCALE * i / SHADES;
        strut_draw_box(canvas, (strut_box){x + at, y - BAND / 2, SCALE - at, BAND}, &fill, NULL);
      }
      break;
    case STRUT_KEY_WORDS: break;
  }
}

/* Lays the items out, and draws them where asked to; returns the height. */
static double lay_out(strut_canvas *canvas, strut_box box, const strut_key_item *items,
                      size_t count, bool draw) {
  double x = 0.0, y = LINE / 2;
  char fitted[STRUT_FITTED_TEXT];
  for (size_t i = 0; i < count; i++) {
    double sign = sign_width(canvas, &items[i]);
    double room = box.width - sign;
    const char *text = strut_text_fit(canvas, items[i].text, letters(), room, 0.0, fitted);
    double width = sign + width_of(canvas, text);
    if (x > 0 && x + width > box.width) x = 0.0, y += LINE;
    if (draw) {
      draw_sign(canvas, &items[i], box.x + x, box.y + y);
      strut_draw_text(canvas, box.x + x + sign, box.y + y, text, letters());
    }
    x += width + BETWEEN;
  }
  return count ? y + LINE / 2 : 0.0;
}

double strut_key_height(strut_canvas *canvas, double width, const strut_key_item *items,
                        size_t count) {
  return lay_out(canvas, (strut_box){0, 0, width, 0}, items, count, false);
}

void strut_draw_key(strut_canvas *canvas, strut_box box, const strut_key_item *items,
                    size_t count) {
  lay_out(canvas, box, items, count, true);
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
