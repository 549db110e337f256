/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines, areas and their hatching. */
#include <cairo.h>
#include <math.h>

#include "engine/base/vec.h"
#include "engine/output/draw/canvas_parts.h"

static const double HATCH_DISTANCE = 4.0, HATCH_WIDTH = 0.6;

static void set_pen(strut_canvas *c, const strut_pen *pen) {
  int dashes = 0;
  while (dashes < 4 && pen->dash[dashes] > 0) dashes++;
  strut_canvas_ink(c, pen->colour);
  cairo_set_line_width(c->cairo, pen->width);
  cairo_set_dash(c->cairo, pen->dash, dashes, 0);
  cairo_set_line_cap(c->cairo, pen->butt ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
}

static void trace(strut_canvas *c, const double (*points)[2], size_t count) {
  cairo_new_path(c->cairo);
  for (size_t i = 0; i < count; i++)
    cairo_line_to(c->cairo, strut_canvas_near(points[i][0]), strut_canvas_near(points[i][1]));
}

void strut_draw_line(strut_canvas *c, const double (*points)[2], size_t count, strut_pen pen) {
  if (!count || !(pen.colour.alpha > 0)) return;
  trace(c, points, count);
  set_pen(c, &pen);
  cairo_stroke(c->cairo);
}

void strut_draw_segments(strut_canvas *c, const double (*ends)[2], size_t count, strut_pen pen) {
  if (!count || !(pen.colour.alpha > 0)) return;
  cairo_new_path(c->cairo);
  for (size_t i = 0; i < count; i++) {
    cairo_move_to(c->cairo, strut_canvas_near(ends[2 * i][0]), strut_canvas_near(ends[2 * i][1]));
    cairo_line_to(c->cairo, strut_canvas_near(ends[2 * i + 1][0]),
                  strut_canvas_near(ends[2 * i + 1][1]));
  }
  set_pen(c, &pen);
  cairo_stroke(c->cairo);
}

void strut_draw_segment(strut_canvas *c, double x1, double y1, double x2, double y2,
                        strut_pen pen) {
  const double ends[2][2] = {{x1, y1}, {x2, y2}};
  strut_draw_line(c, ends, 2, pen);
}

/* One line at every HATCH_DISTANCE across the clip, anchored to the page so that areas side by side
   join; `slant` is the line's rise for each point it runs to the right. */
static void hatch_lines(strut_canvas *c, double slant) {
  double x1, y1, x2, y2;
  cairo_clip_extents(c->cairo, &x1, &y1, &x2, &y2);
  double step = slant == 0 ? HATCH_DISTANCE : HATCH_DISTANCE * sqrt(2.0);
  double low = y1 + fmin(slant * x1, slant * x2), high = y2 + fmax(slant * x1, slant * x2);
  for (double k = floor(low / step); k * step <= high; k++) {
    cairo_move_to(c->cairo, x1, k * step - slant * x1);
    cairo_line_to(c->cairo, x2, k * step - slant * x2);
  }
  cairo_stroke(c->cairo);
}

static void hatch_dots(strut_canvas *c) {
  double x1, y1, x2, y2;
  cairo_clip_extents(c->cairo, &x1, &y1, &x2, &y2);
  for (double j = floor(y1 / HATCH_DISTANCE); j * HATCH_DISTANCE <= y2; j++)
    for (double i = floor(x1 / HATCH_DISTANCE); i * HATCH_DISTANCE <= x2; i++) {
      cairo_arc(c->cairo, i * HATCH_DISTANCE, j * HATCH_DISTANCE, HATCH_WIDTH, 0, 2 * STRUT_PI);
      cairo_fill(c->cairo);
    }
}

static void hatch(strut_canvas *c, const strut_fill *fill) {
  cairo_save(c->cairo);
  cairo_clip_preserve(c->cairo);
  cairo_path_t *outline = cairo_copy_path(c->cairo);
  cairo_new_path(c->cairo);
  const strut_pen pen = {.colour = fill->hatch_colour, .width = HATCH_WIDTH, .butt = true};
  set_pen(c, &pen);
  if (fill->hatch == STRUT_HATCH_RISING || fill->hatch == STRUT_HATCH_CROSSED) hatch_lines(c, 1);
  if (fill->hatch == STRUT_HATCH_FALLING || fill->hatch == STRUT_HATCH_CROSSED) hatch_lines(c, -1);
  if (fill->hatch == STRUT_HATCH_LEVEL) hatch_lines(c, 0);
  if (fill->hatch == STRUT_HATCH_DOTS) hatch_dots(c);
  cairo_restore(c->cairo);
  cairo_append_path(c->cairo, outline);
  cairo_path_destroy(outline);
}

/* Fills and strokes the current path. */
static void paint(strut_canvas *c, const strut_fill *fill, const strut_pen *pen) {
  if (fill && fill->colour.alpha > 0) {
    strut_canvas_ink(c, fill->colour);
    cairo_fill_preserve(c->cairo);
  }
  if (fill && fill->hatch != STRUT_HATCH_NONE) hatch(c, fill);
  if (pen && pen->colour.alpha > 0) {
    set_pen(c, pen);
    cairo_stroke_preserve(c->cairo);
  }
  cairo_new_path(c->cairo);
}

void strut_draw_polygon(strut_canvas *c, const double (*points)[2], size_t count,
                        const strut_fill *fill, const strut_pen *pen) {
  trace(c, points, count);
  cairo_close_path(c->cairo);
  paint(c, fill, pen);
}

void strut_draw_box(strut_canvas *c, strut_box box, const strut_fill *fill, const strut_pen *pen) {
  const double corners[4][2] = {{box.x, box.y},
                                {box.x + box.width, box.y},
                                {box.x + box.width, box.y + box.height},
                                {box.x, box.y + box.height}};
  strut_draw_polygon(c, corners, 4, fill, pen);
}

void strut_draw_circle(strut_canvas *c, double x, double y, double radius, const strut_fill *fill,
                       const strut_pen *pen) {
  cairo_new_path(c->cairo);
  cairo_arc(c->cairo, strut_canvas_near(x), strut_canvas_near(y), radius, 0, 2 * STRUT_PI);
  cairo_close_path(c->cairo);
  paint(c, fill, pen);
}

void strut_draw_arrow(strut_canvas *c, double x1, double y1, double x2, double y2, double head,
                      strut_pen pen) {
  double length = hypot(x2 - x1, y2 - y1);
  if (!(length > 0)) return;
  double along[2] = {(x2 - x1) / length, (y2 - y1) / length}, size = fmin(head, length);
  double neck[2] = {x2 - size * along[0], y2 - size * along[1]};
  if (length > size) {
    strut_pen shaft = pen;
    shaft.butt = true;
    strut_draw_segment(c, x1, y1, neck[0] + 0.2 * size * along[0], neck[1] + 0.2 * size * along[1],
                       shaft);
  }
  const double half = 0.35 * size;
  const double tip[3][2] = {{x2, y2},
                            {neck[0] - half * along[1], neck[1] + half * along[0]},
                            {neck[0] + half * along[1], neck[1] - half * along[0]}};
  const strut_fill fill = {.colour = pen.colour};
  strut_draw_polygon(c, tip, 3, &fill, NULL);
}
