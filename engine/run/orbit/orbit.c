/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit/orbit.h"

#include <math.h>
#include <string.h>

#include "engine/run/orbit/extrapolation.h"

/* The sum over a disturbance ends when it moves the structure so much less than at its height. */
static const double REMAINDER = 0.02;
enum { WINDOW = STRUT_EXTRAPOLATION_WINDOW, KEPT = WINDOW + 1, MOST_PERIODS = 20, LOST = 12 };

/* A disturbance and what has come of it after the latest periods; entry k % KEPT is after k. */
typedef struct trail {
  double *d[KEPT], *sum[KEPT]; /* (2 length + 1) what is left of it; all until then */
  double gone[KEPT];           /* the travel that all until then causes [m] */
  double *limit, *work;
  double travel; /* extrapolated [m]; NAN where there is none */
} trail;

static bool make_trail(size_t both, strut_arena *arena, trail *t) {
  bool ready = (t->limit = strut_arena_allocate(arena, both, sizeof(double)));
  ready = ready && (t->work = strut_arena_allocate(arena, both, sizeof(double)));
  for (int k = 0; k < KEPT && ready; k++)
    ready = (t->d[k] = strut_arena_allocate(arena, both, sizeof(double))) &&
            (t->sum[k] = strut_arena_allocate(arena, both, sizeof(double)));
  return ready;
}

/*
 * The sums' limit after m periods, by extrapolation, into t->limit and t->travel. Returns the size of
 * what the combination leaves of the disturbance.
 */
static double extrapolate(const strut_period_map *map, int m, trail *t) {
  double *d[WINDOW], c[WINDOW];
  int n = m < WINDOW ? m : WINDOW;
  size_t both = 2 * (size_t)map->model->length + 1;
  for (int i = 0; i < n; i++) d[i] = t->d[(m - n + i + 1) % KEPT];
  t->travel = (double)NAN;
  if (n < 2 || !strut_extrapolation_weights(map, d, n, c)) return HUGE_VAL;
  t->travel = 0.0;
  memset(t->limit, 0, both * sizeof(double));
  memset(t->work, 0, both * sizeof(double));
  for (int i = 0; i < n; i++) {
    int k = (m - n + i) % KEPT;
    t->travel += c[i] * t->gone[k];
    for (size_t j = 0; j < both; j++) {
      t->limit[j] += c[i] * t->sum[k][j];
      t->work[j] += c[i] * d[i][j];
    }
  }
  return strut_period_map_size(map, t->work);
}

/*
 * What C makes of the disturbance t->d[0] of `base`, summed over the periods, into t->limit; returns
 * the sum of the travel it causes, NAN where it does not die out. It ends where two periods in a row
 * add less than `enough` [m], or where two extrapolations in a row differ by less.
 */
static double follow(strut_period_map *cheap, const double *base, double travel, double enough,
                     trail *t) {
  int32_t both = 2 * cheap->model->length + 1;
  size_t bytes = (size_t)both * sizeof(double);
  double first = strut_period_map_size(cheap, t->d[0]), last = first, gone = 0.0, farthest = 0.0;
  double last_step = 0.0, guess = (double)NAN;
  memcpy(t->sum[0], t->d[0], bytes);
  for (int m = 1; m <= MOST_PERIODS; m++) {
    const double *before = t->d[(m - 1) % KEPT], *sum = t->sum[(m - 1) % KEPT];
    double *d = t->d[m % KEPT], *total = t->sum[m % KEPT];
    for (int32_t i = 0; i < both; i++) t->work[i] = base[i] + before[i];
    double step = strut_period_map_apply(cheap, t->work) - travel;
    strut_period_map_subtract(cheap, base, t->work, d);
    double now = strut_period_map_size(cheap, d);
    t->gone[(m - 1) % KEPT] = gone += step;
    for (int32_t i = 0; i < both; i++) total[i] = sum[i] + d[i];
    if (!isfinite(step) || !(now < 30.0 * first) || (m >= LOST && now > first)) return (double)NAN;
    farthest = fmax(farthest, fabs(step));
    double little = fmax(REMAINDER * farthest, enough);
    if (fmax(fabs(step), fabs(last_step)) <= little && fmax(now, last) <= 0.3 * first) {
      memcpy(t->limit, total, bytes);
      return gone;
    }
    double left = extrapolate(cheap, m, t);
    if (left <= 0.1 * first && fabs(t->travel - guess) <= little) return t->travel;
    last = now, last_step = step, guess = t->travel;
  }
  return (double)NAN;
}

strut_status strut_orbit_correct(strut_period_map *cheap, strut_period_map *accurate,
                                 const double *base, double travel, double enough,
                                 strut_orbit *orbit) {
  size_t both = 2 * (size_t)cheap->model->length + 1;
  strut_arena arena = {0};
  trail t = {.limit = NULL};
  double *end = strut_arena_allocate(&arena, both, sizeof(double));
  orbit->converged = false;
  if (!end || !make_trail(both, &arena, &t)) {
    strut_arena_free(&arena);
    return STRUT_NO_MEMORY;
  }
  memcpy(end, orbit->y, both * sizeof *end);
  double gone = strut_period_map_apply(accurate, end);
  strut_period_map_subtract(cheap, orbit->y, end, t.d[0]);
  orbit->defect = strut_period_map_size(cheap, t.d[0]);
  double more = isfinite(gone) ? follow(cheap, base, travel, enough, &t) : (double)NAN;
  if (isfinite(more)) {
    double period = cheap->period * cheap->repeats;
    for (size_t i = 0; i < both; i++) orbit->y[i] += t.limit[i];
    orbit->velocity = (gone + more) / period;
    orbit->correction = more / period;
    orbit->converged = true;
  }
  strut_arena_free(&arena);
  return STRUT_OK;
}
