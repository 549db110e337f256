/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/chart.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "engine/base/memory.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"

static const double SCALE_WIDTH = 46, GAP = 6;

/* Categories distinguishable in grey: light and dark alternate, and repeated colours are
   hatched. */
static strut_fill category_fill(size_t i) {
  static const unsigned order[] = {0xF2C14E, 0x2F6DB5, 0x8C2D62, 0xBFD8EA, 0x4C9F70, 0xE7E7E7};
  static const strut_hatch hatches[] = {STRUT_HATCH_NONE, STRUT_HATCH_RISING, STRUT_HATCH_FALLING,
                                        STRUT_HATCH_LEVEL};
  size_t count = sizeof order / sizeof *order;
  unsigned rgb = order[i % count];
  return (strut_fill){
      .colour = {(rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, 1},
      .hatch = hatches[i / count % 4],
      .hatch_colour = strut_grey(0.3)};
}

/* The lower edge of cell i of (count) ascending positions: midway to the previous one. */
static double edge(const double *at, size_t count, size_t i) {
  if (count == 1) return at[0] + (i ? 0.5 : -0.5) * (at[0] != 0 ? fabs(at[0]) : 1);
  if (i == 0) return at[0] - 0.5 * (at[1] - at[0]);
  if (i == count) return at[count - 1] + 0.5 * (at[count - 1] - at[count - 2]);
  return 0.5 * (at[i - 1] + at[i]);
}

typedef struct mapper {
  strut_canvas *canvas;
  const strut_map *map;
  strut_axes axes;
  double low, high; /* of the values */
  strut_colours colours;
  strut_legend_entry *entries;
  size_t entry_count;
} mapper;

/* Noise of the other sign, in parts of the largest value, makes no signed quantity. */
static const double ONE_SIGN = 1e-9;

/* The range of the colour bar; of a signed quantity with zero in the middle. */
static void find_range(mapper *m) {
  const strut_map *map = m->map;
  bool given = map->value_high > map->value_low;
  m->low = given ? map->value_low : HUGE_VAL;
  m->high = given ? map->value_high : -HUGE_VAL;
  for (size_t k = 0; !given && map->value && k < map->columns * map->rows; k++) {
    if (!isfinite(map->value[k])) continue;
    m->low = fmin(m->low, map->value[k]);
    m->high = fmax(m->high, map->value[k]);
  }
  if (!(m->high > m->low) || strut_is_noise(&m->low, &m->high, map->value_unit)) {
    /* one value, or none */
    double middle = isfinite(m->low) ? m->low : 0;
    m->low = middle - (middle != 0 ? 0.5 * fabs(middle) : 0.5);
    m->high = 2 * middle - m->low;
  }
  bool signs = m->low < -ONE_SIGN * m->high && m->high > -ONE_SIGN * m->low;
  m->colours = map->colours != STRUT_COLOURS_AUTO ? map->colours
               : signs                            ? STRUT_COLOURS_DIVERGING
                                                  : STRUT_COLOURS_SEQUENTIAL;
  if (m->colours != STRUT_COLOURS_DIVERGING) return;
  m->high = fmax(fabs(m->low), fabs(m->high));
  m->low = -m->high;
}

static bool has_result(const strut_map *map, size_t k) {
  return map->category ? map->category[k] >= 0 : isfinite(map->value[k]);
}

static strut_fill cell_fill(const mapper *m, size_t k) {
  const strut_map *map = m->map;
  if (!has_result(map, k)) return (strut_fill){.colour = strut_grey(1)};
  if (map->category) return category_fill((size_t)map->category[k]);
  return (strut_fill){.colour = strut_palette_at(m->colours, map->value[k], m->low, m->high)};
}

/* The box of a cell. */
static strut_box cell_box(const mapper *m, size_t row, size_t column) {
  const strut_map *map = m->map;
  double a[2], b[2];
  strut_axes_point(&m->axes, edge(map->xs, map->columns, column), edge(map->ys, map->rows, row), a);
  strut_axes_point(&m->axes, edge(map->xs, map->columns, column + 1),
                   edge(map->ys, map->rows, row + 1), b);
  return (strut_box){a[0], b[1], b[0] - a[0], a[1] - b[1]};
}

/* Cells of a map from which on neighbours in a row that look alike are drawn as one. */
enum { MANY_CELLS = 10000 };

static bool look_alike(const strut_map *map, size_t a, size_t b) {
  if (!has_result(map, a) || !has_result(map, b)) return !has_result(map, a) && !has_result(map, b);
  return map->category ? map->category[a] == map->category[b] : map->value[a] == map->value[b];
}

static void draw_cells(const mapper *m) {
  const strut_map *map = m->map;
  bool join = map->columns * map->rows >= MANY_CELLS;
  for (size_t row = 0; row < map->rows; row++)
    for (size_t column = 0; column < map->columns; column++) {
      size_t k = row * map->columns + column;
      strut_fill fill = cell_fill(m, k);
      strut_box box = cell_box(m, row, column);
      for (; join && column + 1 < map->columns && look_alike(map, k, k + 1); k++, column++)
        box.width = cell_box(m, row, column + 1).x + cell_box(m, row, column + 1).width - box.x;
      box.width += 0.4;
      box.y -= 0.4;
      box.height += 0.4;
      strut_draw_box(m->canvas, box, &fill, NULL);
    }
}

/* Draws hatching on doubtful cells and dots on those without a result. */
static void draw_marks(const mapper *m) {
  const strut_map *map = m->map;
  const strut_fill doubt = {.hatch = STRUT_HATCH_RISING, .hatch_colour = strut_grey(0.05)};
  const strut_fill dot = {.colour = strut_grey(0.5)};
  for (size_t row = 0; row < map->rows; row++)
    for (size_t column = 0; column < map->columns; column++) {
      size_t k = row * map->columns + column;
      strut_box box = cell_box(m, row, column);
      if (map->doubtful && map->doubtful[k]) strut_draw_box(m->canvas, box, &doubt, NULL);
      if (!has_result(map, k))
        strut_draw_circle(m->canvas, box.x + 0.5 * box.width, box.y + 0.5 * box.height,
                          fmin(1.0, 0.25 * fmin(box.width, box.height)), &dot, NULL);
    }
}

static void collect_legend(mapper *m) {
  const strut_map *map = m->map;
  bool some_doubt = false, some_missing = false;
  for (size_t k = 0; k < map->columns * map->rows; k++) {
    some_doubt = some_doubt || (map->doubtful && map->doubtful[k]);
    some_missing = some_missing || !has_result(map, k);
  }
  for (size_t i = 0; map->category && i < map->category_count; i++)
    m->entries[m->entry_count++] =
        (strut_legend_entry){.label = map->names[i], .area = true, .fill = category_fill(i)};
  if (some_doubt)
    m->entries[m->entry_count++] =
        (strut_legend_entry){.label = map->doubt ? map->doubt : "doubtful",
                             .area = true,
                             .fill = {.colour = strut_grey(1),
                                      .hatch = STRUT_HATCH_RISING,
                                      .hatch_colour = strut_grey(0.05)}};
  if (some_missing)
    m->entries[m->entry_count++] =
        (strut_legend_entry){.label = "no result", .area = true, .fill = {.colour = strut_grey(1)}};
}

static void settle_axes(const strut_map *map, strut_axis *x, strut_axis *y) {
  *x = map->x;
  *y = map->y;
  x->logarithmic = y->logarithmic = false; /* cell edges are midpoints, which needs linear axes */
  if (!(x->low < x->high)) {
    x->low = edge(map->xs, map->columns, 0);
    x->high = edge(map->xs, map->columns, map->columns);
  }
  if (!(y->low < y->high)) {
    y->low = edge(map->ys, map->rows, 0);
    y->high = edge(map->ys, map->rows, map->rows);
  }
}

strut_status strut_draw_map(strut_canvas *canvas, strut_box box, const strut_map *map) {
  mapper m = {.canvas = canvas, .map = map};
  strut_axis x, y;
  assert(map->columns > 0 && map->rows > 0 && (map->category || map->value));
  for (size_t i = 1; i < map->columns; i++) assert(map->xs[i] > map->xs[i - 1]);
  for (size_t i = 1; i < map->rows; i++) assert(map->ys[i] > map->ys[i - 1]);
  double legend[2] = {0, 0}, right = map->category ? 0 : SCALE_WIDTH;
  m.entries = strut_allocate(map->category_count + 2, sizeof *m.entries);
  if (!m.entries) return STRUT_NO_MEMORY;
  find_range(&m);
  collect_legend(&m);
  settle_axes(map, &x, &y);
  double width = fmax(box.width - right, 60);
  if (m.entry_count) strut_legend_size(canvas, m.entries, m.entry_count, width - 40, legend);
  strut_box inner = {box.x, box.y + legend[1], width, box.height - legend[1]};
  m.axes = strut_axes_place(canvas, inner, x, y, map->title);
  strut_draw_axes(canvas, &m.axes, map->title);
  strut_canvas_clip(canvas, m.axes.frame);
  draw_cells(&m);
  draw_marks(&m);
  strut_canvas_unclip(canvas);
  strut_draw_box(canvas, m.axes.frame, NULL,
                 &(strut_pen){.colour = strut_grey(0.25), .width = 0.6});
  if (m.entry_count)
    strut_draw_legend(canvas, m.entries, m.entry_count, width - 40, m.axes.frame.x, box.y, false);
  if (!map->category) {
    const strut_colour_scale scale = {.name = map->value_name ? map->value_name : "",
                                      .unit = map->value_unit ? map->value_unit : "",
                                      .low = m.low,
                                      .high = m.high,
                                      .colours = m.colours,
                                      .beyond = map->beyond};
    strut_draw_colour_scale(canvas,
                            (strut_box){box.x + width + GAP, m.axes.frame.y - 8, SCALE_WIDTH - GAP,
                                        fmax(m.axes.frame.height, 60)},
                            &scale);
  }
  strut_release(m.entries);
  return STRUT_OK;
}
