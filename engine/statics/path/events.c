/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regula falsi with the Illinois correction; each trial is corrected back onto the path. */
#include "engine/statics/path/events.h"

#include <math.h>
#include <string.h>

enum { MOST_TRIALS = 60, KEPT = 4 };

static const double ZERO = 1e-13;   /* of the measure at the ends */
static const double NARROW = 1e-13; /* of the piece's length */
/* Of the eigenvalue at the ends. Nearer to zero Newton's method may leave by the other branch, and */
static const double FORK = 1e-4;
static const double BLURRED = 100; /* so it may within so many roundings of the stiffness. */

double strut_path_measure_switch(strut_path_system *s, const double *y,
                                 const strut_path_piece *piece, int32_t which) {
  (void)piece;
  return strut_path_switch_value(s, which, y);
}

double strut_path_measure_eigenvalue(strut_path_system *s, const double *y,
                                     const strut_path_piece *piece, int32_t which) {
  (void)piece;
  if (!strut_path_spectrum(s, y, STRUT_PATH_VALUES)) return (double)NAN;
  return gsl_vector_get(s->values, (size_t)which);
}

/* Some point between two; it wants to be corrected. */
static void blend(const strut_path_system *s, double share, const double *low, const double *high,
                  double *y) {
  for (int32_t i = 0; i < 2 * (s->n + 1); i++) y[i] = low[i] + share * (high[i] - low[i]);
}

/* The point of the path at `place` along the tangent, begun between the two ends low and high. */
static bool point_at(strut_path_system *s, const strut_path_piece *piece, double place,
                     double share, const double *low, const double *high, double *y) {
  double value = place;
  blend(s, share, low, high, y);
  for (int32_t i = 0; i <= s->n; i++) value += piece->tangent[i] * piece->from[i];
  return strut_path_correct(s, piece->tangent, value, y) >= 0;
}

/* Points of the path where the measure is known, those nearest to zero first. */
typedef struct trial {
  double place, value, *y; /* y (2 n + 2) */
} trial;

typedef struct trials {
  int count;
  trial kept[KEPT];
} trials;

static bool make_trials(const strut_path_system *s, strut_arena *arena, trials *t) {
  for (int k = 0; k < KEPT; k++) {
    t->kept[k].y = strut_arena_allocate(arena, 2 * ((size_t)s->n + 1), sizeof(double));
    if (!t->kept[k].y) return false;
  }
  return true;
}

static void keep_trial(const strut_path_system *s, trials *t, double place, double value,
                       const double *y) {
  int at = t->count < KEPT ? t->count++ : KEPT;
  if (at == KEPT && !(fabs(value) < fabs(t->kept[--at].value))) return;
  double *block = t->kept[at].y;
  for (; at > 0 && fabs(value) < fabs(t->kept[at - 1].value); at--) t->kept[at] = t->kept[at - 1];
  t->kept[at] = (trial){place, value, block};
  memcpy(block, y, 2 * ((size_t)s->n + 1) * sizeof *y);
}

/* Where the measure vanishes, by a polynomial in it through the trials kept; false: off the piece. */
static bool interpolate(const strut_path_system *s, const trials *t, double length, double *place,
                        double *y) {
  double weight[KEPT], sum = 0;
  const trial *nearest = &t->kept[0];
  for (int k = 0; k < t->count; k++) {
    weight[k] = 1;
    for (int l = 0; l < t->count; l++)
      if (l != k) weight[k] *= t->kept[l].value / (t->kept[l].value - t->kept[k].value);
    sum += weight[k] * t->kept[k].place;
  }
  if (!(sum >= -NARROW * length && sum <= (1 + NARROW) * length)) return false;
  *place = fmax(0.0, fmin(length, sum));
  for (int32_t i = 0, count = s->n + 1; i < count; i++) {
    double change = 0;
    for (int k = 1; k < t->count; k++)
      change += weight[k] * ((t->kept[k].y[i] - nearest->y[i]) +
                             (t->kept[k].y[count + i] - nearest->y[count + i]));
    strut_dd at = dd_add((strut_dd){nearest->y[i], nearest->y[count + i]}, dd_of(change));
    y[i] = at.hi, y[count + i] = at.lo;
  }
  return true;
}

/*
 * Where an eigenvalue vanishes near `place`. Newton's method would be led astray there, so that the
 * point is interpolated between four on its two sides, near enough for a cubic and far enough for
 * Newton's method. `slope` is the measure's derivative. False: they are not to be had.
 */
static bool interpolate_fork(strut_path_system *s, const strut_path_piece *piece, int32_t which,
                             double scale, double slope, trials *t, double *place, double *y) {
  static const double sides[KEPT] = {-2, -1, 1, 2};
  double apart = fmin(fmax(FORK * scale, BLURRED * s->noise) / slope, 0.1 * piece->length);
  double middle = *place;
  t->count = 0;
  for (int k = 0; k < KEPT; k++) {
    double at = middle + sides[k] * apart;
    if (!point_at(s, piece, at, at / piece->length, piece->from, piece->to, y)) continue;
    double value = strut_path_measure_eigenvalue(s, y, piece, which);
    if (fabs(value) <= 2 * scale) keep_trial(s, t, at, value, y);
  }
  return t->count > 1 && interpolate(s, t, piece->length, place, y);
}

double strut_path_locate(strut_path_system *s, const strut_path_piece *piece,
                         strut_path_measure measure, int32_t which, double *y) {
  size_t bytes = 2 * ((size_t)s->n + 1) * sizeof *y;
  double at[2] = {0, piece->length}, place = -1;
  double value[2] = {measure(s, piece->from, piece, which), measure(s, piece->to, piece, which)};
  double scale = fmax(fabs(value[0]), fabs(value[1])), slope = scale / piece->length;
  bool fork = measure == strut_path_measure_eigenvalue;
  double near = (fork ? 10 * FORK : ZERO) * scale;
  strut_arena arena = {0};
  trials t = {0};
  double *end[2] = {strut_arena_allocate(&arena, 1, bytes), strut_arena_allocate(&arena, 1, bytes)};
  if (end[0] && end[1] && make_trials(s, &arena, &t) && value[0] * value[1] <= 0 && scale > 0) {
    memcpy(end[0], piece->from, bytes);
    memcpy(end[1], piece->to, bytes);
    for (int k = 0, last = -1; k < MOST_TRIALS; k++) {
      double share = value[0] / (value[0] - value[1]), before = value[0] - value[1];
      place = at[0] + share * (at[1] - at[0]);
      if (at[1] > at[0]) slope = fabs(before) / (at[1] - at[0]);
      bool found = point_at(s, piece, place, share, end[0], end[1], y);
      double now = found ? measure(s, y, piece, which) : (double)NAN;
      if (!found || !(fabs(now) <= 2 * scale)) { /* it left the path: the last point before */
        if (!fork) place = at[0];
        blend(s, fork ? share : 0.0, end[0], end[1], y);
        break;
      }
      if (fabs(now) <= near || at[1] - at[0] <= NARROW * piece->length) break;
      int side = now * value[1] > 0 || (now == 0 && value[1] != 0) ? 1 : 0;
      at[side] = place, value[side] = now;
      memcpy(end[side], y, bytes);
      if (side == last) value[1 - side] *= 0.5;
      last = side;
    }
    double *rough = end[0];
    memcpy(rough, y, bytes);
    if (fork && !interpolate_fork(s, piece, which, scale, slope, &t, &place, y))
      memcpy(y, rough, bytes);
  }
  strut_arena_free(&arena);
  return place;
}
