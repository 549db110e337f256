/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/curve.h"

#include <assert.h>

/* Straight pieces of a Bezier curve, and of a rounded corner: forces are off by some 1e-5 of what they span. */
enum { BEZIER_PIECES = 500, CORNER_PIECES = 60 };

/* Points on one side, or all where nothing is mirrored. */
static size_t own_points(const strut_law *law) {
  if (law->bezier) return BEZIER_PIECES + 1;
  if (law->rounding > 0.0) return 2 + (law->count - 2) * (CORNER_PIECES + 1);
  return law->count;
}

size_t strut_curve_points(const strut_law *law) {
  return law->mirrored ? 2 * own_points(law) - 1 : own_points(law);
}

/* By de Casteljau's construction. */
static void bezier_point(const strut_law *law, double t, double point[2]) {
  double a[2 * STRUT_MOST_CONTROL_POINTS];
  assert(law->count >= 1 && law->count <= STRUT_MOST_CONTROL_POINTS);
  for (size_t k = 0; k < law->count; k++) a[2 * k] = law->x[k], a[2 * k + 1] = law->force[k];
  for (size_t left = law->count - 1; left > 0; left--)
    for (size_t k = 0; k < 2 * left; k++) a[k] += t * (a[k + 2] - a[k]);
  point[0] = a[0], point[1] = a[1];
}

/* On the parabola that touches the two pieces at corner c, half of `rounding` of each from it. */
static void corner_point(const strut_law *law, size_t c, double t, double point[2]) {
  const double *list[2] = {law->x, law->force};
  for (int k = 0; k < 2; k++) {
    double at = list[k][c], half = 0.5 * law->rounding;
    double before = half * (list[k][c - 1] - at), after = half * (list[k][c + 1] - at);
    point[k] = at + (1.0 - t) * (1.0 - t) * before + t * t * after;
  }
}

static void own_point(const strut_law *law, size_t i, double point[2]) {
  size_t in_corner = CORNER_PIECES + 1, last = own_points(law) - 1;
  if (law->bezier) {
    bezier_point(law, (double)i / BEZIER_PIECES, point);
  } else if (law->rounding > 0.0 && i > 0 && i < last) {
    corner_point(law, 1 + (i - 1) / in_corner, (double)((i - 1) % in_corner) / CORNER_PIECES,
                 point);
  } else {
    size_t at = i == last ? law->count - 1 : i;
    point[0] = law->x[at], point[1] = law->force[at];
  }
}

void strut_curve_point(const strut_law *law, size_t i, double point[2]) {
  assert(i < strut_curve_points(law));
  size_t origin = law->mirrored ? own_points(law) - 1 : 0;
  own_point(law, i < origin ? origin - i : i - origin, point);
  if (i < origin) point[0] = -point[0], point[1] = -point[1];
}

/* Folds turn by the way on which the force falls: clockwise from the right to the left, and back. */
static const char *fault_of_folds(const strut_law *law) {
  size_t count = strut_curve_points(law);
  double at[2], to[2], before[2] = {0.0, 0.0};
  strut_curve_point(law, 0, at);
  for (size_t i = 1; i < count; i++, at[0] = to[0], at[1] = to[1]) {
    strut_curve_point(law, i, to);
    double step[2] = {to[0] - at[0], to[1] - at[1]};
    if (step[0] == 0.0) return "has two points with the same x one after the other";
    if ((i == 1 || i == count - 1) && step[0] < 0.0)
      return "begins or ends backwards; x must grow along its first and its last piece, which go "
             "on";
    double turn = before[0] * step[1] - before[1] * step[0];
    if (i > 1 && before[0] * step[0] < 0.0 && turn * step[0] <= 0.0)
      return "folds back where its force rises, as no spring can; at a fold the force must fall";
    before[0] = step[0], before[1] = step[1];
  }
  return NULL;
}

const char *strut_curve_fault(const strut_law *law) {
  if (law->bezier && law->count > STRUT_MOST_CONTROL_POINTS)
    return "has more than 64 control points";
  if (law->mirrored && !(law->x[0] == 0.0 && law->force[0] == 0.0))
    return "is mirrored, so that its first point must be [0, 0]";
  if (!(law->rounding >= 0.0 && law->rounding < 1.0)) return "needs a rounding from 0 to below 1";
  if (law->kind == STRUT_LAW_FOLDING) return fault_of_folds(law);
  for (size_t i = 1; i < law->count; i++)
    if (!(law->x[i] > law->x[i - 1])) return "needs points with increasing x";
  return NULL;
}
