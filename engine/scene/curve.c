/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>

#include "engine/scene/law.h"

#include "engine/base/memory.h"
#include "engine/base/vec.h"

/* Cubic pieces between two folds of a Bezier curve and of a rounded corner, and points at which folds are sought. */
enum {
  BEZIER_PIECES = 60,
  CORNER_PIECES = 20,
  SCANNED = 1024,
  MOST_FOLDS = STRUT_MOST_CONTROL_POINTS
};
/* A fold's place on the curve is good to this. */
static const double FOUND = 1e-15;

/* A Bezier curve: a whole law, or the parabola at a rounded corner. */
typedef struct bezier {
  size_t count;
  double x[STRUT_MOST_CONTROL_POINTS], force[STRUT_MOST_CONTROL_POINTS];
} bezier;

/* Value and derivative at t, by de Casteljau's construction. */
static double along(const double *control, size_t count, double t, double *rate) {
  double a[STRUT_MOST_CONTROL_POINTS];
  assert(count >= 2 && count <= STRUT_MOST_CONTROL_POINTS);
  for (size_t k = 0; k < count; k++) a[k] = control[k];
  for (size_t left = count - 1; left > 1; left--)
    for (size_t k = 0; k < left; k++) a[k] += t * (a[k + 1] - a[k]);
  *rate = (double)(count - 1) * (a[1] - a[0]);
  return a[0] + t * (a[1] - a[0]);
}

static double x_rate(const bezier *self, double t) {
  double rate;
  along(self->x, self->count, t, &rate);
  return rate;
}

static strut_curve_point point_at(const bezier *self, double t, bool fold) {
  double dx, df;
  strut_curve_point p = {.x = along(self->x, self->count, t, &dx),
                         .force = along(self->force, self->count, t, &df)};
  p.slope = fold || dx == 0.0 ? (double)NAN : df / dx;
  return p;
}

/* Where x turns, by bisection between points that show a change of its way; ascending. */
static size_t find_folds(const bezier *self, double fold[MOST_FOLDS]) {
  size_t count = 0, scanned = self->count > 3 ? SCANNED : 1;
  double before = x_rate(self, 0.0);
  for (size_t i = 1; i <= scanned && count < MOST_FOLDS; i++) {
    double low = (double)(i - 1) / (double)scanned, high = (double)i / (double)scanned;
    double now = x_rate(self, high);
    if (before * now < 0.0) {
      while (high - low > FOUND) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        *(x_rate(self, middle) * before > 0.0 ? &low : &high) = middle;
      }
      fold[count++] = 0.5 * (low + high);
    }
    if (now != 0.0) before = now;
  }
  return count;
}

/*
 * Points from the begin of a curve to its end, close to each other beside folds, where the slope is infinite:
 * there the pieces at a fold are so short that they may be straight.
 */
static size_t trace(const bezier *self, int pieces, strut_curve_point *point) {
  double fold[MOST_FOLDS + 1], from = 0.0;
  size_t folds = find_folds(self, fold), count = 0;
  fold[folds] = 1.0;
  point[count++] = point_at(self, 0.0, false);
  for (size_t f = 0; f <= folds; from = fold[f++])
    for (int i = 1; i <= pieces; i++) {
      double share = 0.5 * (1.0 - cos(STRUT_PI * i / pieces)), end = fold[f];
      double t = i == pieces ? end : from + share * (end - from);
      point[count++] = point_at(self, t, i == pieces && f < folds);
    }
  return count;
}

static bool is_bezier(const strut_law *law) { return law->source == STRUT_LAW_CONTROL_POINTS; }

static bool is_smooth(const strut_law *law) { return is_bezier(law) || law->rounding > 0.0; }

/* Points that one side has at most, or all where nothing is mirrored. */
static size_t own_room(const strut_law *law) {
  if (is_bezier(law)) return 3 + (MOST_FOLDS + 1) * BEZIER_PIECES;
  if (law->rounding > 0.0) return 2 + law->count * (2 * CORNER_PIECES + 1);
  return law->count;
}

size_t strut_curve_room(const strut_law *law) { return 2 * own_room(law); }

/* The parabola that touches the two pieces at corner c, half of `rounding` of each from it. */
static bezier corner_of(const strut_law *law, size_t c) {
  const double *list[2] = {law->x, law->force};
  bezier b = {.count = 3};
  for (int k = 0; k < 2; k++) {
    double *to = k ? b.force : b.x, at = list[k][c], half = 0.5 * law->rounding;
    to[0] = at + half * (list[k][c - 1] - at);
    to[1] = at;
    to[2] = at + half * (list[k][c + 1] - at);
  }
  return b;
}

/* As it goes straight on at an end: one more point, `way` beyond it. */
static strut_curve_point beyond(strut_curve_point end, double way) {
  return (strut_curve_point){end.x + way, end.force + way * end.slope, end.slope};
}

static size_t trace_own(const strut_law *law, strut_curve_point *point) {
  const strut_curve_point first = {law->x[0], law->force[0], (double)NAN};
  const strut_curve_point last = {law->x[law->count - 1], law->force[law->count - 1], (double)NAN};
  size_t count = 0;
  if (is_bezier(law)) {
    bezier b = {.count = law->count};
    for (size_t k = 0; k < law->count; k++) b.x[k] = law->x[k], b.force[k] = law->force[k];
    count = law->mirrored ? 0 : 1;
    count += trace(&b, BEZIER_PIECES, point + count);
    double size = fabs(point[count - 1].x - first.x) + fabs(last.x);
    if (!law->mirrored) point[0] = beyond(point[1], -size);
    point[count] = beyond(point[count - 1], size);
    return count + 1;
  }
  if (!(law->rounding > 0.0)) {
    for (size_t i = 0; i < law->count; i++)
      point[i] = (strut_curve_point){law->x[i], law->force[i], (double)NAN};
    return law->count;
  }
  point[count++] = first;
  for (size_t c = 1; c + 1 < law->count; c++) {
    bezier b = corner_of(law, c);
    count += trace(&b, CORNER_PIECES, point + count);
  }
  point[count++] = last;
  return count;
}

size_t strut_curve_trace(const strut_law *law, strut_curve_point *point) {
  size_t own = trace_own(law, point);
  if (!law->mirrored) return own;
  for (size_t i = own; i-- > 0;) point[own - 1 + i] = point[i];
  for (size_t i = 0; i + 1 < own; i++) {
    strut_curve_point p = point[2 * (own - 1) - i];
    point[i] = (strut_curve_point){-p.x, -p.force, p.slope};
  }
  return 2 * own - 1;
}

/* Folds turn by the way on which the force falls: clockwise from the right to the left, and back. */
static const char *fault_of_folds(const strut_curve_point *point, size_t count) {
  double before[2] = {0.0, 0.0};
  for (size_t i = 1; i < count; i++) {
    double step[2] = {point[i].x - point[i - 1].x, point[i].force - point[i - 1].force};
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

/* Of a Bezier curve whose x does not grow at its ends nothing could go on. */
static const char *fault_of_control(const strut_law *law) {
  size_t n = law->count;
  if (n > STRUT_MOST_CONTROL_POINTS) return "has more than 64 control points";
  if (!(law->x[1] > law->x[0]) || !(law->x[n - 1] > law->x[n - 2]))
    return "begins or ends backwards; x must grow along its first and its last piece, which go on";
  return NULL;
}

const char *strut_curve_fault(const strut_law *law) {
  if (law->mirrored && !(law->x[0] == 0.0 && law->force[0] == 0.0))
    return "is mirrored, so that its first point must be [0, 0]";
  if (!(law->rounding >= 0.0 && law->rounding < 1.0)) return "needs a rounding from 0 to below 1";
  const char *fault = is_bezier(law) ? fault_of_control(law) : NULL;
  if (law->kind == STRUT_LAW_FOLDING && !fault) {
    strut_curve_point *point = strut_allocate(strut_curve_room(law), sizeof *point);
    if (point) fault = fault_of_folds(point, strut_curve_trace(law, point));
    strut_release(point);
    return fault;
  }
  for (size_t i = 1; i < law->count && !fault && !is_smooth(law); i++)
    if (!(law->x[i] > law->x[i - 1])) fault = "needs points with increasing x";
  return fault;
}
