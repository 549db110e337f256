/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scale of colours beside a drawing. */
#include <math.h>

#include "engine/output/draw/axes.h"
#include "engine/output/draw/palette.h"
#include "engine/output/draw/structure.h"

enum { CELLS = 60 };

static const double BAR = 8, TEXT = 7, TICK = 2;

static strut_colour colour_at(const strut_colour_scale *scale, double part) {
  double value = scale->low + part * (scale->high - scale->low);
  return strut_palette_at(scale->colours, value, scale->low, scale->high);
}

/* The strip: cells overlap, so that no viewer shows seams. */
static void draw_strip(strut_canvas *canvas, strut_box strip, bool upright,
                       const strut_colour_scale *scale) {
  for (int i = 0; i < CELLS; i++) {
    const strut_fill fill = {.colour = colour_at(scale, (i + 0.5) / CELLS)};
    strut_box cell = strip;
    if (upright) { /* from the top: each covers what is left below the one before */
      cell.height = strip.height * (CELLS - i) / CELLS;
      const strut_fill from_top = {.colour = colour_at(scale, 1 - (i + 0.5) / CELLS)};
      cell.y = strip.y + strip.height - cell.height;
      strut_draw_box(canvas, cell, &from_top, NULL);
    } else {
      cell.width = strip.width * (CELLS - i) / CELLS;
      cell.x = strip.x + strip.width - cell.width;
      strut_draw_box(canvas, cell, &fill, NULL);
    }
  }
  strut_draw_box(canvas, strip, NULL, &(strut_pen){.colour = strut_grey(0.3), .width = 0.4});
}

void strut_draw_colour_scale(strut_canvas *canvas, strut_box box, const strut_colour_scale *scale) {
  bool upright = box.height > box.width;
  const strut_axis axis = {
      .name = scale->name, .unit = scale->unit, .low = scale->low, .high = scale->high};
  const strut_font font = {.size = TEXT};
  const strut_pen pen = {.colour = strut_grey(0.3), .width = 0.5, .butt = true};
  strut_tick_set set;
  double width, line;
  strut_axis_ticks(&axis, (int)fmax(3, upright ? box.height / 24 : box.width / 40), &set);
  strut_text_size(canvas, "0", font, &width, &line);
  strut_box strip = upright ? (strut_box){box.x, box.y + line + 6, BAR, box.height - line - 10}
                            : (strut_box){box.x + 8, box.y + line + 2, box.width - 16, BAR};
  draw_strip(canvas, strip, upright, scale);
  for (size_t i = 0; i < set.count; i++) {
    double part = (set.at[i] - scale->low) / (scale->high - scale->low);
    strut_font own = font;
    if (upright) {
      double y = strip.y + strip.height * (1 - part), x = strip.x + BAR;
      strut_draw_segment(canvas, x, y, x + TICK, y, pen);
      own.down = 0.5;
      strut_draw_text(canvas, x + TICK + 2, y, set.text[i], own);
    } else {
      double x = strip.x + strip.width * part, y = strip.y + BAR;
      strut_draw_segment(canvas, x, y, x, y + TICK, pen);
      own.across = 0.5;
      strut_draw_text(canvas, x, y + TICK + 1, set.text[i], own);
    }
  }
  /* A long name ends where the box does, rather than beyond the page. */
  strut_text_size(canvas, set.label, font, &width, &line);
  double across = !upright ? 0.5 : width > box.width ? 1 : 0;
  strut_draw_text(canvas, box.x + across * box.width, box.y, set.label,
                  (strut_font){.size = TEXT, .across = across, .halo = strut_grey(1)});
}
