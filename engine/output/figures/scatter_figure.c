/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/scatter_figure.h"

#include <math.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/draw/palette.h"

static const double ASPECT = 0.62, SCALE_WIDTH = 60, RADIUS = 2.6, RING = 5.0;

typedef struct scatter {
  const strut_scatter_figure *figure;
  const strut_table *table;
  strut_canvas *canvas;
  strut_axes axes;
  double low, high; /* of the colours */
} scatter;

static const double *values_of(const strut_table *table, int column) {
  return column >= 0 ? table->columns[column].value : NULL;
}

static strut_axis axis_of(const scatter *s, int column, const strut_axis_choice *choice) {
  const strut_table_column *c = &s->table->columns[column];
  strut_axis axis = {.name = c->name, .unit = c->unit, .low = (double)NAN, .high = (double)NAN};
  for (size_t i = 0; i < s->table->row_count; i++)
    if (s->figure->shown[i]) strut_axis_include(&axis, c->value[i]);
  strut_axis_settle(&axis, 0.04);
  strut_axis_choose(&axis, choice);
  return axis;
}

static void find_colours(scatter *s) {
  const double *value = values_of(s->table, s->figure->value);
  s->low = HUGE_VAL, s->high = -HUGE_VAL;
  for (size_t i = 0; value && i < s->table->row_count; i++) {
    if (!s->figure->shown[i] || !isfinite(value[i])) continue;
    s->low = fmin(s->low, value[i]);
    s->high = fmax(s->high, value[i]);
  }
  if (!(s->low < s->high)) s->high = s->low = 0.0;
}

static strut_colours colours_of(const scatter *s) {
  return s->figure->colours == STRUT_COLOURS_AUTO ? STRUT_COLOURS_SEQUENTIAL : s->figure->colours;
}

static void draw_point(const scatter *s, size_t row, bool ring) {
  const double *x = values_of(s->table, s->figure->x), *y = values_of(s->table, s->figure->y);
  const double *value = values_of(s->table, s->figure->value);
  double at[2];
  if (!s->figure->shown[row] || !isfinite(x[row]) || !isfinite(y[row])) return;
  strut_axes_point(&s->axes, x[row], y[row], at);
  strut_fill fill = {.colour = strut_grey(0.75)}; /* without a value */
  if (!value)
    fill.colour = strut_palette_thing(0);
  else if (isfinite(value[row]))
    fill.colour = s->high > s->low ? strut_palette_at(colours_of(s), value[row], s->low, s->high)
                                   : strut_palette_thing(0);
  if (ring) {
    const strut_pen pen = {.colour = strut_grey(0), .width = 1.2};
    strut_draw_circle(s->canvas, at[0], at[1], RING, NULL, &pen);
  }
  strut_draw_circle(s->canvas, at[0], at[1], RADIUS, &fill, NULL);
}

static void draw(scatter *s) {
  const strut_scatter_figure *f = s->figure;
  strut_box box = strut_canvas_box(s->canvas);
  bool scale = s->high > s->low;
  strut_box left = {box.x, box.y, box.width - (scale ? SCALE_WIDTH : 0), box.height};
  s->axes = strut_axes_place(s->canvas, left, axis_of(s, f->x, &f->x_axis),
                             axis_of(s, f->y, &f->y_axis), NULL, f->title);
  strut_draw_axes(s->canvas, &s->axes, f->title);
  for (size_t i = 0; i < s->table->row_count; i++)
    if (!f->marked[i]) draw_point(s, i, false);
  for (size_t i = 0; i < s->table->row_count; i++)
    if (f->marked[i]) draw_point(s, i, true);
  if (!scale) return;
  const strut_table_column *c = &s->table->columns[f->value];
  const strut_box frame = s->axes.frame;
  strut_box right = {left.x + left.width + 8, frame.y, SCALE_WIDTH - 8, frame.height};
  strut_draw_colour_scale(s->canvas, right,
                          &(strut_colour_scale){c->name, c->unit, s->low, s->high, colours_of(s)});
}

strut_status strut_table_scatter(const char *path, const strut_scatter_figure *f,
                                 const strut_table *table, strut_error *error) {
  scatter s = {.figure = f, .table = table};
  if (f->x < 0 || f->y < 0 || !values_of(table, f->x) || !values_of(table, f->y) ||
      (f->value >= 0 && !values_of(table, f->value)))
    return strut_fail(error, STRUT_USAGE, "points are drawn over columns of numbers");
  strut_status status = strut_canvas_open(path, f->width, f->width * ASPECT,
                                          f->title ? f->title : "points", &s.canvas, error);
  if (status) return status;
  find_colours(&s);
  draw(&s);
  status = strut_canvas_commit(s.canvas, error);
  strut_canvas_free(s.canvas);
  return status;
}
