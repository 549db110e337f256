/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How far a stable motion may be pushed: kicks of the whole structure at the start of a period, after each
 * of which the motion must come back. The smallest that it does not come back from is found by bisection
 * between kicks that grow; since boundaries of basins may be intricate, smaller ones may exist.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/follow/follow_parts.h"

/* Smallest and largest kick, in speeds of the motion; growth between them; halvings. */
static const double FIRST = 0.05, LARGEST = 20.0, GROWTH = 1.6;
enum { HALVINGS = 4 };
/* Periods after which the motion must be back, and how near. */
enum { PERIODS = 60 };
static const double NEAR = 0.02;

typedef struct kick {
  const char *name;
  double along, outward; /* parts of the ground's tangent and normal */
} kick;
static const kick kicks[STRUT_FOLLOW_KICKS] = {
    {"forwards", 1.0, 0.0}, {"backwards", -1.0, 0.0}, {"up", 0.0, 1.0}, {"down", 0.0, -1.0}};

const char *strut_follow_kick_name(int i) { return kicks[i].name; }

/* Does the motion come back from a kick of this speed [m/s]? `y`, `work` (both): on it; scratch. */
static bool comes_back(strut_follow_system *s, const double *y, const kick *k, double speed,
                       double *work) {
  const strut_model *m = s->model;
  const double *t = m->contacts.tangent, *n = m->contacts.normal;
  bool ground = m->contacts.count > 0;
  memcpy(work, y, s->both * sizeof(double));
  for (int32_t i = 0; i < 2 * m->node_count; i++) {
    double along = ground ? t[i % 2] : i % 2 == 0, outward = ground ? n[i % 2] : i % 2 == 1;
    if (!m->fixed[i]) work[m->length + i] += speed * (k->along * along + k->outward * outward);
  }
  for (int period = 0; period < PERIODS; period += s->repeats) {
    if (!isfinite(strut_follow_apply(s, work, false).travel)) return false;
    strut_follow_centre(s, work);
    double off = 0.0;
    for (size_t i = 0; i < s->n; i++)
      off = fmax(off, fabs(work[s->place[i]] - y[s->place[i]]) / strut_follow_unit(s, i));
    if (off < NEAR) return true;
  }
  return false;
}

/* Speed of the smallest kick found from which it does not come back [m/s]; INFINITY: none up to LARGEST. */
static double smallest_kick(strut_follow_system *s, const double *y, const kick *k, double *work) {
  double low = 0.0, high = FIRST * s->speed;
  while (comes_back(s, y, k, high, work)) {
    low = high, high *= GROWTH;
    if (high > LARGEST * s->speed) return HUGE_VAL;
    if (s->interrupt && *s->interrupt) return (double)NAN;
  }
  for (int i = 0; i < HALVINGS; i++) {
    double middle = low > 0.0 ? sqrt(low * high) : 0.5 * high;
    *(comes_back(s, y, k, middle, work) ? &low : &high) = middle;
    if (s->interrupt && *s->interrupt) return (double)NAN;
  }
  return high;
}

strut_status strut_follow_push(strut_follow_system *s, const double *y, strut_follow_basin *basin,
                               strut_error *error) {
  double *work = strut_arena_allocate(&s->arena, s->both, sizeof(double));
  if (!work) return strut_no_memory(error, "");
  for (int i = 0; i < STRUT_FOLLOW_KICKS; i++)
    basin->kick[i] = smallest_kick(s, y, &kicks[i], work);
  if (s->interrupt && *s->interrupt)
    return strut_fail(error, STRUT_INTERRUPTED, "interrupted while motions were kicked");
  return STRUT_OK;
}
