/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ranges of axes, of colours and of views that a figure leaves to its data; scales that few values do not flatten. */
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdio.h>

#include "engine/base/vec.h"
#include "engine/output/draw/painter.h"

/* Values that take more than this part of a scale are left out of it, if they are few: of all values. */
static const double MOST_OF_RANGE = 0.75, FEW = 0.05;

/* Sorts the finite values to the front. Returns how many there are. */
static size_t sort_finite(double *values, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) values[kept++] = values[i];
  if (kept) gsl_sort(values, 1, kept);
  return kept;
}

double strut_limit_without_outliers(double *magnitudes, size_t count, double other, double share,
                                    strut_beyond *beyond) {
  size_t kept = sort_finite(magnitudes, count), most = (size_t)(share * (double)kept);
  *beyond = (strut_beyond){0};
  if (!kept) return other;
  for (; beyond->above < most && kept > 1; kept--) {
    double rest = fmax(magnitudes[kept - 2], other);
    if (!(magnitudes[kept - 1] * (1 - MOST_OF_RANGE) > rest) || !(rest > 0)) break;
    if (!beyond->above++) beyond->farthest = magnitudes[kept - 1];
  }
  return fmax(magnitudes[kept - 1], other);
}

void strut_range_without_outliers(double *values, size_t count, double *low, double *high,
                                  strut_beyond *beyond) {
  size_t kept = sort_finite(values, count), most = (size_t)(FEW * (double)kept), best = 0;
  double least = HUGE_VAL;
  *beyond = (strut_beyond){0};
  if (!kept) return;
  for (size_t below = 0; below <= most; below++) { /* so many at the lower end, the others above */
    double range = values[kept - 1 - (most - below)] - values[below];
    if (range < least) least = range, best = below;
  }
  double whole = values[kept - 1] - values[0];
  if (!(least < (1 - MOST_OF_RANGE) * whole) || !(least > 0)) return;
  /* The rest of the values decides; of those left out, which still fit into its neighbourhood stay. */
  *low = values[best], *high = values[kept - 1 - (most - best)];
  for (size_t i = best; i-- > 0 && values[i] >= *low - 0.5 * least;) *low = values[i];
  for (size_t i = kept - (most - best); i < kept && values[i] <= *high + 0.5 * least; i++)
    *high = values[i];
  for (size_t i = 0; i < kept; i++) {
    if (values[i] >= *low && values[i] <= *high) continue;
    beyond->below += values[i] < *low;
    beyond->above += values[i] > *high;
    if (fabs(values[i]) > fabs(beyond->farthest)) beyond->farthest = values[i];
  }
}

const char *strut_beyond_text(const strut_beyond *beyond, const char *what, const char *unit,
                              char text[STRUT_BEYOND_TEXT]) {
  size_t count = beyond->below + beyond->above;
  text[0] = '\0';
  if (count)
    snprintf(text, STRUT_BEYOND_TEXT, "%zu %s%s beyond the scale, up to %s", count, what,
             count > 1 ? "s" : "",
             strut_drawn_quantity(beyond->farthest, 3, unit ? unit : "").text);
  return text;
}

void strut_draw_beyond(strut_canvas *canvas, const double at[2], strut_side side, double outside) {
  static const double outwards[][2] = {{0, -1}, {0, 1}, {-1, 0}, {1, 0}};
  const double *out = outwards[side], size = STRUT_BEYOND_SIZE;
  double tip[3][2];
  for (int d = 0; d < 2; d++) {
    double across = 0.45 * size * out[1 - d];
    tip[0][d] = at[d] + outside * out[d];
    tip[1][d] = tip[0][d] - size * out[d] + across;
    tip[2][d] = tip[0][d] - size * out[d] - across;
  }
  const strut_fill fill = {.colour = strut_grey(0.15)};
  const strut_pen rim = {.colour = strut_grey(1), .width = 0.4};
  strut_draw_polygon(canvas, (const double(*)[2])tip, 3, &fill, &rim);
}

/* ---- what a figure leaves open ---- */

static const double ROOM = 0.06;     /* above and below the data */
static const double ONE_SIGN = 1e-9; /* noise of the other sign makes no signed quantity */

static void include_series(const strut_series *series, bool lost, strut_axis *axis,
                           strut_axis *other_axis) {
  for (const strut_point *p = series->points; p < series->points + series->count; p++) {
    if (!isfinite(p->x) || (!isfinite(p->y) && !lost)) continue;
    if (axis) strut_axis_include(axis, p->x);
    for (int k = 0; other_axis && k < 3; k++)
      strut_axis_include(other_axis, k == 0 ? p->y : k == 1 ? p->low : p->high);
  }
}

static void include_panel(const strut_panel *panel, strut_axis *x, strut_axis *other_axis) {
  double limits[2];
  for (size_t i = 0; i < panel->series_count; i++)
    include_series(&panel->series[i], panel->lost != NULL, x, other_axis);
  for (int d = 0; d < 2 && panel->map; d++) {
    strut_axis *axis = d ? other_axis : x;
    strut_map_limits(d ? panel->map->ys : panel->map->xs,
                     d ? panel->map->rows : panel->map->columns, limits);
    for (int k = 0; k < 2 && axis; k++) strut_axis_include(axis, limits[k]);
  }
}

/* Numbers of the panels: of the y axis, or of the scale. Returns how many. */
static size_t gather(const strut_panel *panels, size_t count, bool scale, double *values) {
  size_t known = 0;
  for (size_t i = 0; i < count; i++) {
    const strut_map *map = panels[i].map;
    for (size_t s = 0; s < panels[i].series_count; s++) {
      const strut_series *series = &panels[i].series[s];
      for (size_t k = 0; k < series->count; k++, known++)
        if (values) values[known] = scale ? series->points[k].value : series->points[k].y;
    }
    for (size_t k = 0; scale && map && map->value && k < map->columns * map->rows; k++, known++)
      if (values) values[known] = map->value[k];
  }
  return known;
}

static double *gather_values(const strut_panel *panels, size_t count, bool scale, size_t *known,
                             strut_arena *arena) {
  *known = gather(panels, count, scale, NULL);
  double *values = strut_arena_allocate(arena, *known + 1, sizeof *values);
  if (values) gather(panels, count, scale, values);
  return values;
}

/* The range of the colours; of a signed quantity with zero in the middle. */
static bool settle_scale(const strut_panel *panels, size_t count, strut_colour_scale *scale,
                         strut_arena *arena) {
  size_t known;
  if (scale->high > scale->low) return true;
  double *values = gather_values(panels, count, true, &known, arena);
  if (!values) return false;
  strut_axis range = {.low = (double)NAN, .high = (double)NAN};
  for (size_t i = 0; i < known; i++) strut_axis_include(&range, values[i]);
  strut_range_without_outliers(values, known, &range.low, &range.high, &scale->beyond);
  scale->low = range.low, scale->high = range.high;
  if (!(scale->high > scale->low) || strut_is_noise(&scale->low, &scale->high, scale->unit)) {
    double middle = isfinite(scale->low) ? scale->low : 0; /* one value, or none */
    scale->low = middle - (middle != 0 ? 0.5 * fabs(middle) : 0.5);
    scale->high = 2 * middle - scale->low;
  }
  bool signs = scale->low < -ONE_SIGN * scale->high && scale->high > -ONE_SIGN * scale->low;
  if (scale->colours == STRUT_COLOURS_AUTO)
    scale->colours = signs ? STRUT_COLOURS_DIVERGING : STRUT_COLOURS_SEQUENTIAL;
  if (scale->colours != STRUT_COLOURS_DIVERGING) return true;
  scale->high = fmax(fabs(scale->low), fabs(scale->high));
  scale->low = -scale->high;
  return true;
}

/* What is seen, where that is open. */
static strut_bounds find_bounds(const strut_panel *panel) {
  strut_bounds b = panel->bounds;
  if (b.low[0] != 0 || b.low[1] != 0 || b.high[0] != 0 || b.high[1] != 0) return b;
  b = strut_bounds_none();
  for (size_t i = 0; i < panel->shape_count; i++)
    strut_bounds_add(&b, panel->shapes[i].model, panel->shapes[i].q);
  for (size_t i = 0; i < panel->trail_count; i++)
    for (size_t k = 0; k < panel->trails[i].count; k++)
      strut_bounds_widen(&b, panel->trails[i].at[k], panel->trails[i].at[k]);
  return b;
}

static void settle_views(strut_panel *panels, size_t count) {
  strut_bounds all = strut_bounds_none();
  for (size_t i = 0; i < count; i++) {
    const strut_bounds own = find_bounds(&panels[i]);
    strut_bounds_widen(&all, own.low, own.high);
  }
  for (size_t i = 0; i < count; i++) panels[i].bounds = all;
}

bool strut_panels_settle(strut_panel *panels, size_t count, strut_arena *arena) {
  if (panels->shape_count) {
    settle_views(panels, count);
    return true;
  }
  strut_axis x = panels[0].x, y = panels[0].y;
  strut_colour_scale scale = panels[0].scale;
  bool fit_x = isnan(x.low) || isnan(x.high), fit_y = isnan(y.low) || isnan(y.high);
  bool cells = panels[0].map != NULL, trim = panels[0].outliers && fit_y && !y.logarithmic;
  size_t known;
  for (size_t i = 0; i < count; i++)
    include_panel(&panels[i], fit_x ? &x : NULL, fit_y ? &y : NULL);
  if (trim) {
    strut_beyond beyond;
    double *values = gather_values(panels, count, false, &known, arena);
    if (!values) return false;
    strut_range_without_outliers(values, known, &y.low, &y.high, &beyond);
  }
  strut_axis_settle(&x, fit_x && !cells ? panels[0].room : 0);
  strut_axis_settle(&y, fit_y && !cells ? ROOM : 0);
  if (scale.name && !settle_scale(panels, count, &scale, arena)) return false;
  for (size_t i = 0; i < count; i++) {
    panels[i].x.low = x.low, panels[i].x.high = x.high;
    panels[i].y.low = y.low, panels[i].y.high = y.high;
    panels[i].outliers = trim;
    if (scale.name) panels[i].scale = scale;
  }
  return true;
}
