/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ranges of axes, of colours and of views that a figure leaves to its data. */
#include <math.h>

#include "engine/output/draw/painter.h"

static const double ROOM = 0.06;     /* above and below the data */
static const double ONE_SIGN = 1e-9; /* noise of the other sign makes no signed quantity */

/* Widens the axes that are not NULL by all that a panel shows. */
static void include_panel(const strut_panel *panel, strut_axis *x, strut_axis *y) {
  double limits[2];
  for (size_t i = 0; i < panel->series_count; i++) {
    const strut_series *series = &panel->series[i];
    for (const strut_point *p = series->points; p < series->points + series->count; p++) {
      if (!isfinite(p->x) || (!isfinite(p->y) && !panel->lost)) continue;
      if (x) strut_axis_include(x, p->x);
      for (int k = 0; y && k < 3; k++)
        strut_axis_include(y, k == 0 ? p->y : k == 1 ? p->low : p->high);
    }
  }
  for (int d = 0; d < 2 && panel->map; d++) {
    strut_axis *axis = d ? y : x;
    strut_map_limits(d ? panel->map->ys : panel->map->xs,
                     d ? panel->map->rows : panel->map->columns, limits);
    for (int k = 0; k < 2 && axis; k++) strut_axis_include(axis, limits[k]);
  }
}

/* Numbers of the panels, of the y axis or of the scale; only counts them where `values` is NULL. */
static size_t gather(const strut_panel *panels, size_t count, bool scale, double *values) {
  size_t known = 0;
  for (const strut_panel *panel = panels; panel < panels + count; panel++) {
    const strut_map *map = panel->map;
    for (size_t s = 0; s < panel->series_count; s++)
      for (size_t k = 0; k < panel->series[s].count; k++, known++)
        if (values)
          values[known] = scale ? panel->series[s].points[k].value : panel->series[s].points[k].y;
    for (size_t k = 0; scale && map && map->value && k < map->columns * map->rows; k++, known++)
      if (values) values[known] = map->value[k];
  }
  return known;
}

/* Narrows a range to what is seen of those numbers. False: out of memory. */
static bool narrow(const strut_panel *panels, size_t count, bool scale, strut_axis *range,
                   strut_beyond *beyond, strut_arena *arena) {
  size_t known = gather(panels, count, scale, NULL);
  double *values = strut_arena_allocate(arena, known + 1, sizeof *values);
  if (!values) return false;
  gather(panels, count, scale, values);
  for (size_t i = 0; i < known && scale; i++) strut_axis_include(range, values[i]);
  strut_range_without_outliers(values, known, &range->low, &range->high, beyond);
  return true;
}

/* The range of the colours; of a signed quantity with zero in the middle. */
static bool settle_scale(const strut_panel *panels, size_t count, strut_colour_scale *scale,
                         strut_arena *arena) {
  strut_axis range = strut_axis_of("", "");
  if (scale->high > scale->low) return true;
  if (!narrow(panels, count, true, &range, &scale->beyond, arena)) return false;
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

/* All views show what any of them has to. */
static void settle_views(strut_panel *panels, size_t count) {
  strut_bounds all = strut_bounds_none();
  for (strut_panel *panel = panels; panel < panels + count; panel++) {
    const strut_bounds *own = &panel->bounds;
    if (own->low[0] != 0 || own->low[1] != 0 || own->high[0] != 0 || own->high[1] != 0) {
      strut_bounds_widen(&all, own->low, own->high);
      continue;
    }
    for (size_t i = 0; i < panel->shape_count; i++)
      strut_bounds_add(&all, panel->shapes[i].model, panel->shapes[i].q);
    for (size_t i = 0; i < panel->trail_count; i++)
      for (size_t k = 0; k < panel->trails[i].count; k++)
        strut_bounds_widen(&all, panel->trails[i].at[k], panel->trails[i].at[k]);
  }
  for (size_t i = 0; i < count; i++) panels[i].bounds = all;
}

bool strut_panels_settle(strut_panel *panels, size_t count, strut_arena *arena) {
  if (panels->shape_count) {
    settle_views(panels, count);
    return true;
  }
  strut_axis x = panels->x, y = panels->y;
  strut_colour_scale scale = panels->scale;
  strut_beyond beyond;
  bool fit_x = isnan(x.low) || isnan(x.high), fit_y = isnan(y.low) || isnan(y.high);
  bool cells = panels->map != NULL, trim = panels->outliers && fit_y && !y.logarithmic;
  for (size_t i = 0; i < count; i++)
    include_panel(&panels[i], fit_x ? &x : NULL, fit_y ? &y : NULL);
  if (fit_y && panels->zero) strut_axis_include(&y, 0);
  double missing = fit_y ? panels->least - (y.high - y.low) : 0;
  if (missing > 0) y.low -= 0.5 * missing, y.high += 0.5 * missing;
  if (trim && !narrow(panels, count, false, &y, &beyond, arena)) return false;
  strut_axis_settle(&x, fit_x && !cells ? panels->room : 0);
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
