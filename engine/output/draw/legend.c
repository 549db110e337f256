/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What explains a figure: keys, markers of series, scales. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/draw/painter.h"

void strut_draw_marker(strut_canvas *canvas, size_t look, double x, double y, double size) {
  static const struct {
    int corners;         /* 0: a circle */
    double radius, turn; /* of the first corner, down from the right, in turns */
  } shapes[] = {{0, 1, 0}, {4, 1.41, 0.125}, {3, 1.35, -0.25}, {4, 1.3, 0}, {3, 1.35, 0.25}};
  enum { SHAPES = sizeof shapes / sizeof *shapes, CORNERS = 4 };
  bool hollow = look / SHAPES % 2 == 1;
  const strut_colour own = strut_palette_thing(look), white = strut_grey(1);
  const strut_fill fill = {.colour = hollow ? white : own};
  const strut_pen edge = {.colour = hollow ? own : white, .width = hollow ? 0.8 : 0.4};
  int count = shapes[look % SHAPES].corners;
  double at[CORNERS][2];
  for (int i = 0; i < count; i++) {
    double angle = STRUT_TAU * (shapes[look % SHAPES].turn + (double)i / count);
    at[i][0] = x + size * shapes[look % SHAPES].radius * cos(angle);
    at[i][1] = y + size * shapes[look % SHAPES].radius * sin(angle);
  }
  if (count == 0)
    strut_draw_circle(canvas, x, y, size, &fill, &edge);
  else
    strut_draw_polygon(canvas, (const double(*)[2])at, (size_t)count, &fill, &edge);
}

/* ---- scales ---- */

void strut_draw_yardstick(strut_canvas *canvas, double left, double bottom, double width,
                          double scale) {
  double length = strut_round_below(0.3 * width / scale);
  double x = left + 3, y = bottom - 4, end = x + length * scale;
  const strut_pen pen = {.colour = strut_grey(0.2), .width = 0.9, .butt = true};
  if (!isfinite(length) || !(length > 0)) return;
  strut_draw_segment(canvas, x, y, end, y, pen);
  strut_draw_segment(canvas, x, y - 2, x, y + 2, pen);
  strut_draw_segment(canvas, end, y - 2, end, y + 2, pen);
  strut_draw_text(canvas, 0.5 * (x + end), y - 2, strut_quantity_of(length, 3, "m").text,
                  (strut_font){.size = 7, .across = 0.5, .down = 1, .halo = strut_grey(1)});
}

static const double BAR = 8, BAR_TEXT = 7, BAR_TICK = 2; /* [pt] */

void strut_draw_colour_scale(strut_canvas *canvas, strut_box box, const strut_colour_scale *scale) {
  const strut_axis axis = {.name = scale->name,
                           .unit = scale->unit,
                           .low = scale->low,
                           .high = scale->high,
                           .shown = scale->shown};
  const strut_pen pen = {.colour = strut_grey(0.3), .width = 0.5, .butt = true};
  strut_font font = {.size = BAR_TEXT, .across = 0.5};
  enum { SHADES = 32 };
  strut_tick_set set;
  double line = strut_text_box(canvas, "0", font).height;
  const strut_box strip = {box.x + 8, box.y + line + 2, box.width - 16, BAR};
  const double bottom = strip.y + BAR, right = strip.x + strip.width, middle = strip.y + 0.5 * BAR;
  strut_axis_ticks(&axis, (int)fmax(3, box.width / 40), &set);
  for (int i = 0; i < SHADES; i++) { /* each covers the rest, so that no viewer shows seams */
    double x = strip.x + strip.width * i / SHADES;
    double value = scale->low + (i + 0.5) / SHADES * (scale->high - scale->low);
    const strut_fill fill = {.colour =
                                 strut_palette_at(scale->colours, value, scale->low, scale->high)};
    strut_draw_box(canvas, (strut_box){x, strip.y, right - x, BAR}, &fill, NULL);
  }
  strut_draw_box(canvas, strip, NULL, &pen);
  for (int end = -1; end < 2; end += 2) /* values beyond the ends */
    if (end > 0 ? scale->beyond.above : scale->beyond.below)
      strut_draw_arrow(canvas, end > 0 ? right : strip.x, middle,
                       (end > 0 ? right : strip.x) + end * STRUT_BEYOND_SIZE, middle,
                       STRUT_BEYOND_SIZE, pen);
  for (size_t i = 0; i < set.count; i++) {
    double x = strip.x + strip.width * (set.at[i] - scale->low) / (scale->high - scale->low);
    strut_draw_segment(canvas, x, bottom, x, bottom + BAR_TICK, pen);
    strut_draw_text(canvas, x, bottom + BAR_TICK + 1, set.text[i], font);
  }
  if (scale->beyond.below + scale->beyond.above) {
    size_t used = strlen(set.label);
    snprintf(set.label + used, sizeof set.label - used, ", up to %s",
             strut_quantity_shown(scale->beyond.farthest, 3, *scale->unit ? scale->unit : "1",
                                  scale->shown)
                 .text);
  }
  font.halo = strut_grey(1);
  strut_draw_text(canvas, box.x + 0.5 * box.width, box.y, set.label, font);
}

/* ---- keys ---- */

static const double LINE = 11.0, SIGN = 20.0, SIGN_GAP = 4.0, BETWEEN = 13.0; /* [pt] */
static const double DOT = 2.6, MARKER = 2.0, AREA = 7.0;
static const strut_font letters = {.size = 7.5, .down = 0.5};

static void draw_sign(strut_canvas *canvas, const strut_key_item *item, double x, double y) {
  const strut_pen rim = {.colour = strut_grey(0.4), .width = 0.4};
  const strut_box area = {x, y - 0.5 * AREA, SIGN, AREA};
  if (item->sign == STRUT_KEY_DOT)
    strut_draw_circle(canvas, x + DOT, y, DOT, &item->fill, &item->pen);
  if (item->sign == STRUT_KEY_LINE) strut_draw_segment(canvas, x, y, x + SIGN, y, item->pen);
  if (item->sign == STRUT_KEY_ARROW) strut_draw_arrow(canvas, x, y, x + SIGN, y, 4.0, item->pen);
  if (item->sign == STRUT_KEY_AREA) strut_draw_box(canvas, area, &item->fill, &rim);
  if (item->marked) strut_draw_marker(canvas, item->look, x + 0.5 * SIGN, y, MARKER);
}

strut_box strut_draw_key(strut_canvas *canvas, strut_box box, const strut_key_item *items,
                         size_t count) {
  double x = 0.0, y = 0.0, row = LINE, line = strut_text_box(canvas, "0", letters).height;
  const double widths[] = {SIGN + SIGN_GAP, SIGN + SIGN_GAP, 2 * DOT + SIGN_GAP, SIGN + SIGN_GAP,
                           0};
  strut_box whole = {box.x, box.y, 0, 0};
  for (size_t i = 0; i < count; i++) {
    if (!items[i].text) continue;
    double sign = widths[items[i].sign]; /* how far right of it the text begins */
    strut_font font = letters;
    font.down = 0.0;
    if (box.width > 0 && sign + strut_text_box(canvas, items[i].text, letters).width > box.width)
      font.width = box.width - sign;
    const strut_box text = strut_text_box(canvas, items[i].text, font);
    if (x > 0 && x + sign + text.width > box.width) x = 0.0, y += row, row = LINE;
    draw_sign(canvas, &items[i], box.x + x, box.y + y + 0.5 * LINE);
    strut_draw_text(canvas, box.x + x + sign, box.y + y + 0.5 * (LINE - line), items[i].text, font);
    row = fmax(row, text.height + LINE - line);
    whole.width = fmax(whole.width, x + sign + text.width);
    x += sign + text.width + BETWEEN;
  }
  whole.height = x > 0.0 ? y + row : 0.0;
  return whole;
}
