/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/work_precision.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"

static bool diverged(const strut_saving *saving) { return !isfinite(saving->error); }

void strut_pareto_front(const strut_saving *saving, size_t count, bool *front) {
  for (size_t i = 0; i < count; i++) {
    front[i] = !diverged(&saving[i]) && saving[i].cost > 0;
    for (size_t k = 0; k < count && front[i]; k++) {
      bool no_worse = saving[k].cost <= saving[i].cost && saving[k].error <= saving[i].error;
      bool better = saving[k].cost < saving[i].cost || saving[k].error < saving[i].error;
      front[i] = diverged(&saving[k]) || !(no_worse && better);
    }
  }
}

/* Room for (count) points of a series. */
static double *columns_of(strut_series *series, size_t count, strut_arena *arena) {
  double *x = strut_arena_allocate(arena, 4 * count + 1, sizeof *x);
  if (x)
    series->x = x, series->y = x + count, series->low = x + 2 * count, series->high = x + 3 * count;
  return x;
}

/* The points of a group in their order, diverged ones last, off its line. */
static bool fill_group(const strut_work_precision *precision, size_t group, strut_series *series,
                       strut_arena *arena) {
  double *x = columns_of(series, precision->count, arena);
  if (!x) return false;
  for (int lost = 0; lost < 2; lost++)
    for (size_t i = 0; i < precision->count; i++) {
      const strut_saving *saving = &precision->bargains[i];
      if (saving->group != (int)group || diverged(saving) != (lost == 1)) continue;
      x[series->count] = saving->cost;
      x[precision->count + series->count] = saving->error;
      x[2 * precision->count + series->count] = saving->low,
                               x[3 * precision->count + series->count++] = saving->high;
    }
  series->label = precision->groups[group];
  series->look = (int)group;
  series->markers = STRUT_MARKERS_ALL;
  return true;
}

/* Indices of the front by cost, in `order`; returns how many. */
static size_t sort_front(const strut_work_precision *precision, const bool *front, size_t *order) {
  size_t used = 0;
  for (size_t i = 0; i < precision->count; i++) {
    if (!front[i]) continue;
    size_t k = used++;
    for (; k > 0 && precision->bargains[order[k - 1]].cost > precision->bargains[i].cost; k--)
      order[k] = order[k - 1];
    order[k] = i;
  }
  return used;
}

/* The staircase of the front. */
static bool fill_stairs(const strut_work_precision *precision, const size_t *order, size_t count,
                        strut_series *series, strut_arena *arena) {
  static const strut_pen pen = {.colour = {0.6, 0.6, 0.6, 1}, .width = 3.2};
  double *x = columns_of(series, 2 * count + 1, arena), *y = (double *)series->y;
  series->pen = &pen;
  series->low = series->high = NULL;
  for (size_t k = 0; x && k < count; k++) {
    const strut_saving *saving = &precision->bargains[order[k]];
    if (k)
      x[series->count] = saving->cost, y[series->count] = y[series->count - 1], series->count++;
    x[series->count] = saving->cost, y[series->count++] = saving->error;
  }
  return x != NULL;
}

/* The text beside the k-th point of the front; with its group where other points have the same label. */
static const char *label_text(const strut_work_precision *precision, const size_t *order,
                              size_t count, size_t k, strut_arena *arena) {
  const strut_saving *own = &precision->bargains[order[k]];
  bool alike = false;
  for (size_t i = 0; i < count; i++) {
    const strut_saving *other = &precision->bargains[order[i]];
    alike = alike || (i != k && other->label && strcmp(other->label, own->label) == 0);
  }
  return strut_arena_format(arena, "%.60s%s%.60s", own->label, alike ? ", " : "",
                            alike ? precision->groups[own->group] : "");
}

bool strut_work_precision_fill(const strut_work_precision *precision, strut_arena *arena,
                               strut_panel *panel) {
  bool *front = strut_arena_allocate(arena, precision->count + 1, sizeof *front);
  size_t *order = strut_arena_allocate(arena, precision->count + 1, sizeof *order);
  strut_series *series = strut_arena_allocate(arena, precision->group_count + 1, sizeof *series);
  strut_mark *marks = strut_arena_allocate(arena, precision->count + 1, sizeof *marks);
  if (!front || !order || !series || !marks) return false;
  strut_pareto_front(precision->bargains, precision->count, front);
  size_t count = sort_front(precision, front, order), named = 0;
  bool fine = fill_stairs(precision, order, count, &series[0], arena);
  for (size_t g = 0; g < precision->group_count && fine; g++)
    fine = fill_group(precision, g, &series[g + 1], arena);
  for (size_t k = 0; k < count && fine; k++) {
    const strut_saving *saving = &precision->bargains[order[k]];
    if (!saving->label) continue;
    marks[named] = (strut_mark){.at = {saving->cost, saving->error},
                                .text = label_text(precision, order, count, k, arena),
                                .angle = 1.25 * STRUT_PI, /* no better point can be there */
                                .steady = 0.5};
    fine = marks[named++].text != NULL;
  }
  *panel = (strut_panel){.title = precision->title,
                         .x = precision->cost,
                         .y = precision->error,
                         .room = 0.06,
                         .lost = "diverged",
                         .series_count = precision->group_count + 1,
                         .series = series,
                         .mark_count = named,
                         .marks = marks};
  panel->x.logarithmic = panel->y.logarithmic = true;
  return fine;
}
