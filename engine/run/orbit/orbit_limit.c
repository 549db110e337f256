/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The limit of a sequence of periods without running all of them, by extrapolation. */
#include <math.h>
#include <string.h>

#include "engine/run/orbit/extrapolation.h"
#include "engine/run/orbit/orbit.h"

enum { WINDOW = STRUT_EXTRAPOLATION_WINDOW, MOST_CYCLES = 8 };

/* A window of periods: y[k + 1] = C(y[k]), d[k] their difference, travel[k] on the way. */
typedef struct window {
  double *y[WINDOW + 1], *d[WINDOW], *best;
  double travel[WINDOW], size[WINDOW];
} window;

static bool make_window(size_t both, strut_arena *arena, window *w) {
  bool ready = true;
  for (int k = 0; k <= WINDOW && ready; k++)
    ready = (w->y[k] = strut_arena_allocate(arena, both, sizeof(double)));
  for (int k = 0; k < WINDOW && ready; k++)
    ready = (w->d[k] = strut_arena_allocate(arena, both, sizeof(double)));
  return ready && (w->best = strut_arena_allocate(arena, both, sizeof(double)));
}

/* The extrapolated limit into w->best; the latest period's end where that is no good. */
static void extrapolate(const strut_period_map *map, window *w) {
  double c[WINDOW];
  size_t both = 2 * (size_t)map->model->length + 1;
  memcpy(w->best, w->y[WINDOW], both * sizeof(double));
  if (!strut_extrapolation_weights(map, w->d, WINDOW, c)) return;
  for (size_t k = 0; k < both; k++) {
    double x = w->y[WINDOW][k];
    for (int i = 0; i < WINDOW; i++) x += c[i] * (w->y[i + 1][k] - w->y[WINDOW][k]);
    w->best[k] = x;
  }
}

/* What is left to go, in travel per application: by the decay of the differences. */
static double remaining(const window *w) {
  double effect = 0.0, first = w->size[0], last = w->size[WINDOW - 1];
  for (int k = 1; k < WINDOW; k++)
    effect = fmax(effect, fabs(w->travel[k] - w->travel[k - 1]) / fmax(w->size[k - 1], 1e-300));
  double rate = first > 0.0 ? pow(last / first, 1.0 / (WINDOW - 1)) : 0.0;
  if (!(rate < 0.98)) rate = 0.98;
  return effect * last * rate / (1.0 - rate);
}

strut_status strut_orbit_limit(strut_period_map *map, double enough, double *y, double *travel,
                               bool *found) {
  size_t both = 2 * (size_t)map->model->length + 1, bytes = both * sizeof(double);
  strut_arena arena = {0};
  window w = {.best = NULL};
  *found = false;
  if (!make_window(both, &arena, &w)) {
    strut_arena_free(&arena);
    return STRUT_NO_MEMORY;
  }
  double before = HUGE_VAL; /* the last difference before extrapolation */
  bool jumped = false;
  for (int cycle = 0; cycle < MOST_CYCLES && !*found; cycle++) {
    memcpy(w.y[0], y, bytes);
    for (int k = 0; k < WINDOW; k++) {
      memcpy(w.y[k + 1], w.y[k], bytes);
      w.travel[k] = strut_period_map_apply(map, w.y[k + 1]);
      strut_period_map_subtract(map, w.y[k], w.y[k + 1], w.d[k]);
      w.size[k] = strut_period_map_size(map, w.d[k]);
      if (!isfinite(w.travel[k])) cycle = MOST_CYCLES;
    }
    if (cycle == MOST_CYCLES) break;
    if (jumped && w.size[WINDOW - 1] > before) break; /* it led away: not a steady motion's doing */
    if (remaining(&w) <= enough) {
      memcpy(y, w.y[WINDOW], bytes);
      *travel = w.travel[WINDOW - 1];
      *found = true;
      break;
    }
    before = w.size[WINDOW - 1];
    extrapolate(map, &w);
    memcpy(y, w.best, bytes);
    jumped = true;
  }
  strut_arena_free(&arena);
  return STRUT_OK;
}
