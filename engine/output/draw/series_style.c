/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How curves are told apart: colour, dashes and markers at once; and the legend that names them. */
#include <math.h>

#include "engine/output/draw/curves_parts.h"
#include "engine/output/draw/palette.h"

static const double TEXT = 7.5, SAMPLE = 20, GAP = 4, ROW_GAP = 1.5, PADDING = 3;

strut_pen strut_series_pen(size_t look) {
  enum { DASHES = 7 };
  static const double dashes[DASHES][4] = {{0},      {5, 2}, {1.2, 1.8}, {6, 2, 1.2, 2},
                                           {3, 1.5}, {8, 2}, {2, 3}};
  strut_pen pen = {.colour = strut_palette_thing(look), .width = 1.2};
  /* Where the colours come again, the dashes are others. */
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

strut_fill strut_band_fill(int look) {
  static const strut_hatch hatches[] = {STRUT_HATCH_NONE, STRUT_HATCH_RISING, STRUT_HATCH_FALLING,
                                        STRUT_HATCH_DOTS, STRUT_HATCH_CROSSED};
  size_t i = look > 0 ? (size_t)look : 0;
  return (strut_fill){.colour = strut_grey(i % 2 ? 0.94 : 0.86),
                      .hatch = hatches[i % 5],
                      .hatch_colour = strut_grey(0.7)};
}

size_t strut_thin(double (*points)[2], size_t count, double grain) {
  size_t kept = 0;
  for (size_t i = 1; i < count; i++)
    if (!(points[i][0] >= points[i - 1][0])) return count;
  for (size_t first = 0; first < count;) {
    double cell = floor(points[first][0] / grain);
    size_t last = first, low = first, high = first;
    while (last + 1 < count && floor(points[last + 1][0] / grain) == cell) {
      last++;
      if (points[last][1] < points[low][1]) low = last;
      if (points[last][1] > points[high][1]) high = last;
    }
    size_t pick[4] = {first, low < high ? low : high, low < high ? high : low, last};
    for (int k = 0; k < 4; k++) {
      if (k > 0 && pick[k] == pick[k - 1]) continue;
      points[kept][0] = points[pick[k]][0]; /* kept never overtakes what is still needed */
      points[kept++][1] = points[pick[k]][1];
    }
    first = last + 1;
  }
  return kept;
}

/* Where each entry goes; calls draw for it if there is a canvas to draw on. */
static void lay_out(strut_canvas *canvas, const strut_legend_entry *entries, size_t count,
                    double width, const double corner[2], bool draw, double size[2]) {
  double x = 0, y = 0, row = 0;
  size[0] = size[1] = 0;
  for (size_t i = 0; i < count; i++) {
    const strut_legend_entry *e = &entries[i];
    double text, line;
    strut_font font = {.size = TEXT, .down = 0.5};
    strut_text_size(canvas, e->label, font, &text, &line);
    double wide = SAMPLE + GAP + text;
    if (i > 0 && (!(width > 0) || x + wide > width)) {
      x = 0;
      y += row + ROW_GAP;
      row = 0;
    }
    if (draw) {
      double left = corner[0] + x, middle = corner[1] + y + 0.5 * line;
      if (e->area)
        strut_draw_box(canvas, (strut_box){left, middle - 0.35 * line, SAMPLE, 0.7 * line},
                       &e->fill, &(strut_pen){.colour = strut_grey(0.4), .width = 0.4});
      if (e->line)
        strut_draw_segment(canvas, left, middle, left + SAMPLE, middle, strut_series_pen(e->look));
      if (e->marker) strut_draw_marker(canvas, e->look, left + 0.5 * SAMPLE, middle, 2);
      strut_draw_text(canvas, left + SAMPLE + GAP, middle, e->label, font);
    }
    x += wide;
    size[0] = fmax(size[0], x);
    x += 3 * GAP;
    row = fmax(row, line);
  }
  size[1] = y + row;
}

void strut_legend_size(strut_canvas *canvas, const strut_legend_entry *entries, size_t count,
                       double width, double size[2]) {
  const double corner[2] = {0, 0};
  lay_out(canvas, entries, count, width, corner, false, size);
  size[0] += 2 * PADDING;
  size[1] += 2 * PADDING;
}

void strut_draw_legend(strut_canvas *canvas, const strut_legend_entry *entries, size_t count,
                       double width, double x, double y, bool background) {
  const double corner[2] = {x + PADDING, y + PADDING};
  double size[2];
  strut_legend_size(canvas, entries, count, width, size);
  if (background) {
    const strut_fill white = {.colour = strut_faded(strut_grey(1), 0.85)};
    const strut_pen edge = {.colour = strut_grey(0.8), .width = 0.4};
    strut_draw_box(canvas, (strut_box){x, y, size[0], size[1]}, &white, &edge);
  }
  lay_out(canvas, entries, count, width, corner, true, size);
}
