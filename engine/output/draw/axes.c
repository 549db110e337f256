/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/axes.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/palette.h"

static const double TICK_SIZE = 7.5, LABEL_SIZE = 8, TITLE_SIZE = 8.5, TICK = 2.5, GAP = 2.5;
static const double LEAST_LEFT = 26; /* so that frames one above the other line up more often */

/* Part of the values that is rounding; lengths [m] and velocities [m/s] far below an atom's size. */
static const double ROUNDING = 1e-12, LEAST_LENGTH = 1e-13;

bool strut_is_noise(double *low, double *high, const char *unit) {
  double size = fmax(fabs(*low), fabs(*high));
  bool length = unit && (strcmp(unit, "m") == 0 || strcmp(unit, "m/s") == 0);
  if (length && size < LEAST_LENGTH) *low = *high = 0;
  return !(*high - *low > ROUNDING * size);
}

void strut_axis_include(strut_axis *axis, double value) {
  if (!isfinite(value) || (axis->logarithmic && !(value > 0))) return;
  if (!(axis->low <= value)) axis->low = value;
  if (!(axis->high >= value)) axis->high = value;
}

void strut_axis_settle(strut_axis *axis, double room) {
  if (!isfinite(axis->low) || !isfinite(axis->high) || axis->low > axis->high) {
    axis->low = axis->logarithmic ? 0.1 : 0;
    axis->high = 1;
  }
  if (axis->logarithmic) {
    if (!(axis->high > 0)) axis->high = 1;
    if (!(axis->low > 0)) axis->low = 1e-3 * axis->high;
    double wider = pow(axis->high / axis->low, room);
    if (axis->high / axis->low < 1.5) wider = fmax(wider, 2);
    axis->low = fmin(fmax(axis->low / wider, 1e-300), 1e299);
    axis->high = fmax(fmin(axis->high * wider, 1e300), 2 * axis->low);
    return;
  }
  bool constant = strut_is_noise(&axis->low, &axis->high, axis->unit);
  double span = axis->high - axis->low;
  double size = fmax(fabs(axis->low), fabs(axis->high));
  if (constant || !isfinite(span)) { /* a constant stands in the middle */
    span = size > 1e-300 ? fmin(size, 1e300) : 1;
    room = isfinite(axis->high - axis->low) ? 0.1 : 0;
  }
  axis->low -= room * span;
  axis->high += room * span;
}

/* How many ticks go along: by the room that their texts take. */
static int ticks_along_x(strut_canvas *canvas, const strut_axis *axis, double width) {
  for (int wanted = 10; wanted > 1; wanted--) {
    strut_tick_set set;
    double widest = 0, total = 0, height;
    strut_axis_ticks(axis, wanted, &set);
    for (size_t i = 0; i < set.count; i++) {
      double one;
      strut_text_size(canvas, set.text[i], (strut_font){.size = TICK_SIZE}, &one, &height);
      widest = fmax(widest, one);
    }
    total = (double)set.count * (widest + 8);
    if (total <= width) return wanted;
  }
  return 1;
}

static int ticks_along_y(double height) { return (int)fmax(1, fmin(10, height / 22)); }

static double widest_tick(strut_canvas *canvas, const strut_axis *axis, double height) {
  strut_tick_set set;
  double widest = 0;
  strut_axis_ticks(axis, ticks_along_y(height), &set);
  for (size_t i = 0; i < set.count; i++) {
    double width, line;
    strut_text_size(canvas, set.text[i], (strut_font){.size = TICK_SIZE}, &width, &line);
    widest = fmax(widest, width);
  }
  return widest;
}

strut_axes strut_axes_place(strut_canvas *canvas, strut_box box, strut_axis x, strut_axis y,
                            const strut_axis *second, const char *title) {
  double width, line, label, above = 0.5 * TICK_SIZE;
  strut_text_size(canvas, "0", (strut_font){.size = TICK_SIZE}, &width, &line);
  strut_text_size(canvas, "0", (strut_font){.size = LABEL_SIZE}, &width, &label);
  if (title && *title) {
    strut_text_size(canvas, title,
                    (strut_font){.size = TITLE_SIZE, .bold = true, .width = box.width}, &width,
                    &above);
    above += GAP;
  }
  double below = TICK + GAP + line + label;
  double height = fmax(box.height - above - below, 10);
  double left = fmax(widest_tick(canvas, &y, height) + TICK + GAP, LEAST_LEFT) + label + GAP;
  double right = 10; /* half of the last tick's text */
  if (second)
    right = fmax(widest_tick(canvas, second, height) + TICK + GAP, LEAST_LEFT) + label + GAP;
  return (strut_axes){
      .x = x,
      .y = y,
      .right = second ? *second : (strut_axis){0},
      .has_right = second != NULL,
      .frame = {box.x + left, box.y + above, fmax(box.width - left - right, 10), height}};
}

strut_axes strut_axes_right(const strut_axes *axes) {
  assert(axes->has_right);
  strut_axes swapped = *axes;
  swapped.y = axes->right;
  return swapped;
}

static double place(const strut_axis *axis, double value) {
  if (axis->logarithmic) return log10(value / axis->low) / log10(axis->high / axis->low);
  return (value - axis->low) / (axis->high - axis->low);
}

void strut_axes_point(const strut_axes *axes, double x, double y, double point[2]) {
  point[0] = axes->frame.x + axes->frame.width * place(&axes->x, x);
  point[1] = axes->frame.y + axes->frame.height * (1.0 - place(&axes->y, y));
}

static void draw_x(strut_canvas *canvas, const strut_axes *axes, const strut_tick_set *set) {
  const strut_box *f = &axes->frame;
  const strut_pen grid = {.colour = strut_grey(0.9), .width = 0.4, .butt = true};
  const strut_pen tick = {.colour = strut_grey(0.25), .width = 0.6, .butt = true};
  double bottom = f->y + f->height, point[2];
  for (size_t i = 0; i < set->count; i++) {
    strut_axes_point(axes, set->at[i], axes->y.low, point);
    strut_draw_segment(canvas, point[0], f->y, point[0], bottom, grid);
    strut_draw_segment(canvas, point[0], bottom, point[0], bottom + TICK, tick);
    strut_draw_text(canvas, point[0], bottom + TICK + 1, set->text[i],
                    (strut_font){.size = TICK_SIZE, .across = 0.5});
  }
  for (size_t i = 0; i < set->minor_count; i++) {
    strut_axes_point(axes, set->minor[i], axes->y.low, point);
    strut_draw_segment(canvas, point[0], bottom, point[0], bottom + 0.6 * TICK, tick);
  }
  double width, line;
  strut_text_size(canvas, "0", (strut_font){.size = TICK_SIZE}, &width, &line);
  strut_draw_text(canvas, f->x + 0.5 * f->width, bottom + TICK + 1 + line, set->label,
                  (strut_font){.size = LABEL_SIZE, .across = 0.5});
}

static void draw_y(strut_canvas *canvas, const strut_axes *axes, const strut_tick_set *set) {
  const strut_box *f = &axes->frame;
  const strut_pen grid = {.colour = strut_grey(0.9), .width = 0.4, .butt = true};
  const strut_pen tick = {.colour = strut_grey(0.25), .width = 0.6, .butt = true};
  double widest = LEAST_LEFT - TICK - GAP, point[2];
  for (size_t i = 0; i < set->count; i++) {
    double width, line;
    strut_axes_point(axes, axes->x.low, set->at[i], point);
    strut_draw_segment(canvas, f->x, point[1], f->x + f->width, point[1], grid);
    strut_draw_segment(canvas, f->x - TICK, point[1], f->x, point[1], tick);
    strut_draw_text(canvas, f->x - TICK - GAP, point[1], set->text[i],
                    (strut_font){.size = TICK_SIZE, .across = 1, .down = 0.5});
    strut_text_size(canvas, set->text[i], (strut_font){.size = TICK_SIZE}, &width, &line);
    widest = fmax(widest, width);
  }
  for (size_t i = 0; i < set->minor_count; i++) {
    strut_axes_point(axes, axes->x.low, set->minor[i], point);
    strut_draw_segment(canvas, f->x - 0.6 * TICK, point[1], f->x, point[1], tick);
  }
  strut_draw_text(canvas, f->x - TICK - 2 * GAP - widest, f->y + 0.5 * f->height, set->label,
                  (strut_font){.size = LABEL_SIZE, .across = 0.5, .down = 1, .upwards = true});
}

/* The second y axis; the grid is that of the left one. */
static void draw_right(strut_canvas *canvas, const strut_axes *axes) {
  const strut_box *f = &axes->frame;
  const strut_axes own = strut_axes_right(axes);
  const strut_pen tick = {.colour = strut_grey(0.25), .width = 0.6, .butt = true};
  double widest = LEAST_LEFT - TICK - GAP, edge = f->x + f->width, point[2];
  strut_tick_set set;
  strut_axis_ticks(&axes->right, ticks_along_y(f->height), &set);
  for (size_t i = 0; i < set.count; i++) {
    double width, line;
    strut_axes_point(&own, own.x.low, set.at[i], point);
    strut_draw_segment(canvas, edge, point[1], edge + TICK, point[1], tick);
    strut_draw_text(canvas, edge + TICK + GAP, point[1], set.text[i],
                    (strut_font){.size = TICK_SIZE, .down = 0.5});
    strut_text_size(canvas, set.text[i], (strut_font){.size = TICK_SIZE}, &width, &line);
    widest = fmax(widest, width);
  }
  for (size_t i = 0; i < set.minor_count; i++) {
    strut_axes_point(&own, own.x.low, set.minor[i], point);
    strut_draw_segment(canvas, edge, point[1], edge + 0.6 * TICK, point[1], tick);
  }
  strut_draw_text(canvas, edge + TICK + 2 * GAP + widest, f->y + 0.5 * f->height, set.label,
                  (strut_font){.size = LABEL_SIZE, .across = 0.5, .upwards = true});
}

void strut_draw_vertical_axis(strut_canvas *canvas, const strut_axes *axes) {
  const strut_box *f = &axes->frame;
  strut_tick_set set;
  strut_axis_ticks(&axes->y, ticks_along_y(f->height), &set);
  draw_y(canvas, axes, &set);
  strut_draw_segment(canvas, f->x, f->y, f->x, f->y + f->height,
                     (strut_pen){.colour = strut_grey(0.25), .width = 0.6});
}

void strut_draw_axes(strut_canvas *canvas, const strut_axes *axes, const char *title) {
  const strut_box *f = &axes->frame;
  const strut_pen frame = {.colour = strut_grey(0.25), .width = 0.6};
  strut_tick_set set;
  strut_axis_ticks(&axes->x, ticks_along_x(canvas, &axes->x, f->width), &set);
  draw_x(canvas, axes, &set);
  strut_axis_ticks(&axes->y, ticks_along_y(f->height), &set);
  draw_y(canvas, axes, &set);
  if (axes->has_right) draw_right(canvas, axes);
  strut_draw_box(canvas, *f, NULL, &frame);
  if (title && *title)
    strut_draw_text(
        canvas, f->x + 0.5 * f->width, f->y - GAP, title,
        (strut_font){
            .size = TITLE_SIZE, .bold = true, .across = 0.5, .down = 1, .width = f->width});
}
