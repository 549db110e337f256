/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Vectors of the plane, sums over arrays, and the constants of angles.
 *
 * Lengths are roots of sums of squares, never hypot: that has the same bits on every machine, and the
 * check of scenes keeps coordinates far from where squares overflow.
 */
#ifndef STRUT_ENGINE_BASE_VEC_H
#define STRUT_ENGINE_BASE_VEC_H

#include <math.h>
#include <stddef.h>

#define STRUT_PI 3.14159265358979323846
/** A full turn [rad]. */
#define STRUT_TAU 6.283185307179586476925

typedef struct strut_vec2 {
  double x, y;
} strut_vec2;

/** The vector from point a to point b. */
static inline strut_vec2 strut_vec2_between(const double *a, const double *b) {
  return (strut_vec2){b[0] - a[0], b[1] - a[1]};
}

static inline double strut_vec2_length(strut_vec2 d) { return sqrt(d.x * d.x + d.y * d.y); }

/** d / length, or zero where the length is zero. */
static inline strut_vec2 strut_vec2_unit(strut_vec2 d, double length) {
  return length > 0.0 ? (strut_vec2){d.x / length, d.y / length} : (strut_vec2){0.0, 0.0};
}

/** Distance of the points a and b. */
static inline double strut_distance(const double *a, const double *b) {
  return strut_vec2_length(strut_vec2_between(a, b));
}

/** Sum of x[i] y[i], i < n, in this order. */
static inline double strut_dot(const double *x, const double *y, ptrdiff_t n) {
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < n; i++) sum += x[i] * y[i];
  return sum;
}

/** Largest |x[i]|, i < n; 0 if n is 0, NAN if any is NAN. */
static inline double strut_largest_magnitude(const double *x, ptrdiff_t n) {
  double largest = 0.0;
  for (ptrdiff_t i = 0; i < n && !isnan(largest); i++)
    if (!(fabs(x[i]) <= largest)) largest = fabs(x[i]);
  return largest;
}

#endif
