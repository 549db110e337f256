/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit.h"

#include <math.h>
#include <string.h>

/* The sum over a disturbance ends when it moves the structure so much less than at its height. */
static const double REMAINDER = 0.02;
enum { MOST_PERIODS = 20 };

/*
 * What C makes of the disturbance d of `base`, summed over the periods, into sum; returns the sum of
 * the travel it causes, NAN where it does not die out. It ends where two periods in a row add less
 * than `enough` [m]. d is used up; work: (2 length + 1).
 */
static double follow(strut_period_map *cheap, const double *base, double travel, double enough,
                     double *d, double *sum, double *work) {
  int32_t both = 2 * cheap->model->length + 1;
  double first = strut_period_map_size(cheap, d), last = first, gone = 0.0, farthest = 0.0,
         last_step = 0.0;
  for (int32_t i = 0; i < both; i++) sum[i] = d[i];
  for (int k = 0; k < MOST_PERIODS; k++) {
    for (int32_t i = 0; i < both; i++) work[i] = base[i] + d[i];
    double step = strut_period_map_apply(cheap, work) - travel;
    strut_period_map_subtract(cheap, base, work, d);
    double now = strut_period_map_size(cheap, d);
    gone += step;
    for (int32_t i = 0; i < both; i++) sum[i] += d[i];
    if (!isfinite(step) || !(now < 30.0 * first)) return (double)NAN;
    farthest = fmax(farthest, fabs(step));
    bool still = fmax(fabs(step), fabs(last_step)) <= fmax(REMAINDER * farthest, enough);
    if (still && fmax(now, last) <= 0.3 * first) return gone;
    last = now, last_step = step;
  }
  return (double)NAN;
}

strut_status strut_orbit_correct(strut_period_map *cheap, strut_period_map *accurate,
                                 const double *base, double travel, double enough,
                                 strut_orbit *orbit) {
  size_t both = 2 * (size_t)cheap->model->length + 1;
  strut_arena arena = {0};
  double *end = strut_arena_allocate(&arena, both, sizeof(double));
  double *d = strut_arena_allocate(&arena, both, sizeof(double));
  double *sum = strut_arena_allocate(&arena, both, sizeof(double));
  double *work = strut_arena_allocate(&arena, both, sizeof(double));
  orbit->converged = false;
  if (!end || !d || !sum || !work) {
    strut_arena_free(&arena);
    return STRUT_NO_MEMORY;
  }
  memcpy(end, orbit->y, both * sizeof *end);
  double gone = strut_period_map_apply(accurate, end);
  strut_period_map_subtract(cheap, orbit->y, end, d);
  orbit->defect = strut_period_map_size(cheap, d);
  double more = isfinite(gone) ? follow(cheap, base, travel, enough, d, sum, work) : (double)NAN;
  if (isfinite(more)) {
    double period = cheap->period * cheap->repeats;
    for (size_t i = 0; i < both; i++) orbit->y[i] += sum[i];
    orbit->velocity = (gone + more) / period;
    orbit->correction = more / period;
    orbit->converged = true;
  }
  strut_arena_free(&arena);
  return STRUT_OK;
}
