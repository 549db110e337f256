/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/work_precision.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"

static bool diverged(const strut_saving *b) { return !isfinite(b->error); }

void strut_pareto_front(const strut_saving *b, size_t count, bool *front) {
  for (size_t i = 0; i < count; i++) {
    front[i] = !diverged(&b[i]) && b[i].cost > 0;
    for (size_t k = 0; k < count && front[i]; k++) {
      bool no_worse = b[k].cost <= b[i].cost && b[k].error <= b[i].error;
      bool better = b[k].cost < b[i].cost || b[k].error < b[i].error;
      front[i] = diverged(&b[k]) || !(no_worse && better);
    }
  }
}

/* Room for (count) points of a series. */
static double *columns_of(strut_series *s, size_t count, strut_arena *arena) {
  double *x = strut_arena_allocate(arena, 4 * count + 1, sizeof *x);
  if (x) s->x = x, s->y = x + count, s->low = x + 2 * count, s->high = x + 3 * count;
  return x;
}

/* The points of a group in their order, diverged ones last, off its line. */
static bool fill_group(const strut_work_precision *w, size_t group, strut_series *s,
                       strut_arena *arena) {
  double *x = columns_of(s, w->count, arena);
  if (!x) return false;
  for (int lost = 0; lost < 2; lost++)
    for (size_t i = 0; i < w->count; i++) {
      const strut_saving *b = &w->bargains[i];
      if (b->group != (int)group || diverged(b) != (lost == 1)) continue;
      x[s->count] = b->cost;
      x[w->count + s->count] = b->error;
      x[2 * w->count + s->count] = b->low, x[3 * w->count + s->count++] = b->high;
    }
  s->label = w->groups[group];
  s->look = (int)group;
  s->markers = STRUT_MARKERS_ALL;
  return true;
}

/* Indices of the front by cost, in `order`; returns how many. */
static size_t sort_front(const strut_work_precision *w, const bool *front, size_t *order) {
  size_t used = 0;
  for (size_t i = 0; i < w->count; i++) {
    if (!front[i]) continue;
    size_t k = used++;
    for (; k > 0 && w->bargains[order[k - 1]].cost > w->bargains[i].cost; k--)
      order[k] = order[k - 1];
    order[k] = i;
  }
  return used;
}

/* The staircase of the front. */
static bool fill_stairs(const strut_work_precision *w, const size_t *order, size_t count,
                        strut_series *s, strut_arena *arena) {
  static const strut_pen pen = {.colour = {0.6, 0.6, 0.6, 1}, .width = 3.2};
  double *x = columns_of(s, 2 * count + 1, arena), *y = (double *)s->y;
  s->pen = &pen;
  s->low = s->high = NULL;
  for (size_t k = 0; x && k < count; k++) {
    const strut_saving *b = &w->bargains[order[k]];
    if (k) x[s->count] = b->cost, y[s->count] = y[s->count - 1], s->count++;
    x[s->count] = b->cost, y[s->count++] = b->error;
  }
  return x != NULL;
}

/* The text beside the k-th point of the front; with its group where other points have the same label. */
static const char *label_text(const strut_work_precision *w, const size_t *order, size_t count,
                              size_t k, strut_arena *arena) {
  const strut_saving *own = &w->bargains[order[k]];
  bool alike = false;
  for (size_t i = 0; i < count; i++) {
    const strut_saving *other = &w->bargains[order[i]];
    alike = alike || (i != k && other->label && strcmp(other->label, own->label) == 0);
  }
  return strut_arena_format(arena, "%.60s%s%.60s", own->label, alike ? ", " : "",
                            alike ? w->groups[own->group] : "");
}

bool strut_work_precision_fill(const strut_work_precision *w, strut_arena *arena,
                               strut_panel *panel) {
  bool *front = strut_arena_allocate(arena, w->count + 1, sizeof *front);
  size_t *order = strut_arena_allocate(arena, w->count + 1, sizeof *order);
  strut_series *series = strut_arena_allocate(arena, w->group_count + 1, sizeof *series);
  strut_mark *marks = strut_arena_allocate(arena, w->count + 1, sizeof *marks);
  if (!front || !order || !series || !marks) return false;
  strut_pareto_front(w->bargains, w->count, front);
  size_t count = sort_front(w, front, order), named = 0;
  bool fine = fill_stairs(w, order, count, &series[0], arena);
  for (size_t g = 0; g < w->group_count && fine; g++)
    fine = fill_group(w, g, &series[g + 1], arena);
  for (size_t k = 0; k < count && fine; k++) {
    const strut_saving *b = &w->bargains[order[k]];
    if (!b->label) continue;
    marks[named] = (strut_mark){.at = {b->cost, b->error},
                                .text = label_text(w, order, count, k, arena),
                                .angle = 1.25 * STRUT_PI, /* no better point can be there */
                                .steady = 0.5};
    fine = marks[named++].text != NULL;
  }
  *panel = (strut_panel){.title = w->title,
                         .x = w->cost,
                         .y = w->error,
                         .room = 0.06,
                         .lost = "diverged",
                         .series_count = w->group_count + 1,
                         .series = series,
                         .mark_count = named,
                         .marks = marks};
  panel->x.logarithmic = panel->y.logarithmic = true;
  return fine;
}
