/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cells of a map. */
#include <math.h>

#include "engine/output/draw/painter.h"

strut_fill strut_category_fill(size_t i) {
  /* Distinguishable in grey: light and dark alternate, and repeated colours are hatched. */
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

void strut_map_limits(const double *at, size_t count, double limits[2]) {
  limits[0] = edge(at, count, 0), limits[1] = edge(at, count, count);
}

bool strut_map_has(const strut_map *map, size_t k) {
  return map->category ? map->category[k] >= 0 : isfinite(map->value[k]);
}

static strut_fill cell_fill(const strut_panel *panel, size_t k) {
  const strut_map *map = panel->map;
  const strut_colour_scale *scale = &panel->scale;
  if (!strut_map_has(map, k)) return (strut_fill){.colour = strut_grey(1)};
  if (map->category) return strut_category_fill((size_t)map->category[k]);
  return (strut_fill){.colour =
                          strut_palette_at(scale->colours, map->value[k], scale->low, scale->high)};
}

/* The box of (count) cells of a row from `column` on. */
static strut_box cell_box(const strut_chart *chart, size_t row, size_t column, size_t count) {
  const strut_map *map = chart->panel->map;
  double a[2], b[2];
  strut_axes_point(&chart->axes, edge(map->xs, map->columns, column), edge(map->ys, map->rows, row),
                   a);
  strut_axes_point(&chart->axes, edge(map->xs, map->columns, column + count),
                   edge(map->ys, map->rows, row + 1), b);
  return (strut_box){a[0], b[1], b[0] - a[0], a[1] - b[1]};
}

/* Cells of a map from which on neighbours in a row that look alike are drawn as one. */
enum { MANY_CELLS = 10000 };

static bool look_alike(const strut_map *map, size_t a, size_t b) {
  bool has = strut_map_has(map, a);
  if (has != strut_map_has(map, b)) return false;
  if (!has) return true;
  return map->category ? map->category[a] == map->category[b] : map->value[a] == map->value[b];
}

/* Hatching on a doubtful cell, a dot on one without a result. */
static void mark_cell(const strut_chart *chart, size_t k) {
  const strut_map *map = chart->panel->map;
  const strut_fill doubt = {.hatch = STRUT_HATCH_RISING, .hatch_colour = strut_grey(0.05)};
  const strut_fill dot = {.colour = strut_grey(0.5)};
  strut_box box = cell_box(chart, k / map->columns, k % map->columns, 1);
  if (map->doubtful && map->doubtful[k]) strut_draw_box(chart->canvas, box, &doubt, NULL);
  if (!strut_map_has(map, k))
    strut_draw_circle(chart->canvas, box.x + 0.5 * box.width, box.y + 0.5 * box.height,
                      fmin(1.0, 0.25 * fmin(box.width, box.height)), &dot, NULL);
}

void strut_draw_map(const strut_chart *chart) {
  const strut_map *map = chart->panel->map;
  size_t cells = map->columns * map->rows, joined;
  for (size_t k = 0; k < cells; k += joined) {
    size_t row = k / map->columns, column = k % map->columns;
    for (joined = 1; cells >= MANY_CELLS && column + joined < map->columns; joined++)
      if (!look_alike(map, k, k + joined)) break;
    strut_fill fill = cell_fill(chart->panel, k);
    strut_box box = cell_box(chart, row, column, joined);
    box.width += 0.4, box.y -= 0.4, box.height += 0.4;
    strut_draw_box(chart->canvas, box, &fill, NULL);
  }
  for (size_t k = 0; k < cells; k++) mark_cell(chart, k);
}
