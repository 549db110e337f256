/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Vectors of the plane, sums over arrays, and angles.
 *
 * Lengths are roots of sums of squares, never hypot: that has the same bits on every machine, and the
 * check of scenes keeps coordinates far from where squares overflow.
 */
#pragma once

#include <math.h>
#include <stddef.h>

#define STRUT_PI 3.14159265358979323846
/** A full turn [rad]. */
#define STRUT_TAU 6.283185307179586476925

typedef struct strut_vec2 {
  double x, y;
} strut_vec2;

/** The vector from point a to point b. */
static inline strut_vec2 strut_vec2_between(const double *first, const double *second) {
  return (strut_vec2){second[0] - first[0], second[1] - first[1]};
}

static inline double strut_vec2_length(strut_vec2 d) { return sqrt(d.x * d.x + d.y * d.y); }

/** d / length, or zero where the length is zero. */
static inline strut_vec2 strut_vec2_unit(strut_vec2 d, double length) {
  return length > 0.0 ? (strut_vec2){d.x / length, d.y / length} : (strut_vec2){0.0, 0.0};
}

/** The larger of two numbers, as fmax where neither is NAN, without its call. */
static inline double strut_larger(double one, double other) { return one > other ? one : other; }

/** Distance of the points a and b. */
static inline double strut_distance(const double *first, const double *second) {
  return strut_vec2_length(strut_vec2_between(first, second));
}

/** Distance of the point p from the segment from a to b. */
static inline double strut_distance_to_segment(const double *p, const double *first,
                                               const double *second) {
  double wx = second[0] - first[0], wy = second[1] - first[1], w2 = wx * wx + wy * wy;
  double s = w2 > 0.0 ? ((p[0] - first[0]) * wx + (p[1] - first[1]) * wy) / w2 : 0.0;
  s = fmin(fmax(s, 0.0), 1.0);
  return hypot(p[0] - first[0] - s * wx, p[1] - first[1] - s * wy);
}

/** Sum of x[i] y[i], i < n, in this order. */
static inline double strut_dot(const double *vector, const double *y, ptrdiff_t n) {
  double sum = 0.0;
  for (ptrdiff_t i = 0; i < n; i++) sum += vector[i] * y[i];
  return sum;
}

/** Largest |x[i]|, i < n; 0 if n is 0, NAN if any is NAN. */
static inline double strut_largest_magnitude(const double *vector, ptrdiff_t n) {
  double largest = 0.0;
  for (ptrdiff_t i = 0; i < n && !isnan(largest); i++)
    if (!(fabs(vector[i]) <= largest)) largest = fabs(vector[i]);
  return largest;
}

/* Sine and cosine of an angle in turns, with the same bits on every machine.
 *
 * libm picks another routine where the processor has fused multiply-add, so its last bit may change
 * from machine to machine. These use plain products and sums only. Because the angle comes in turns
 * (cycles), its reduction is exact: a drive of f hertz at t seconds needs the turns f*t, and no
 * multiple of pi is ever subtracted. In a header, since a drive needs them at every force evaluation.
 */

/*
 * Taylor sums for |x| <= pi/4, s = x^2: the first term left out is below 2e-17 in both. The even
 * and the odd powers of s are summed apart, so that neither waits for the other.
 */
static inline double strut_sine_of_small(double x) {
  double s = x * x, ss = s * s;
  double even =
      -1.0 / 6 + ss * (-1.0 / 5040 + ss * (-1.0 / 39916800 + ss * (-1.0 / 1307674368000.0)));
  double odd = 1.0 / 120 + ss * (1.0 / 362880 + ss * (1.0 / 6227020800.0));
  return x + x * (s * (even + s * odd));
}
static inline double strut_cosine_of_small(double x) {
  double s = x * x, ss = s * s;
  double even =
      1.0 / 24 + ss * (1.0 / 40320 + ss * (1.0 / 479001600.0 + ss * (1.0 / 20922789888000.0)));
  double odd = -1.0 / 720 + ss * (-1.0 / 3628800 + ss * (-1.0 / 87178291200.0));
  double half = 0.5 * s, rest = 1.0 - half;
  return rest + (((1.0 - rest) - half) + ss * (even + s * odd));
}

/** sine = sin(2 pi turns), cosine = cos(2 pi turns); error below 1.5 units in the last place of 1. */
static inline void strut_sincos_turns(double turns, double *sine, double *cosine) {
  /* Adding and taking away 1.5 * 2^52 rounds to an integer; above 2^49 turns floor comes first. */
  const double rounder = 6755399441055744.0;
  if (!(turns > -0x1p49 && turns < 0x1p49)) turns -= floor(turns);
  double quarter = (4.0 * turns + rounder) - rounder; /* nearest quarter turn */
  double rest = turns - 0.25 * quarter;               /* exact: in [-1/8, 1/8] */
  double x = STRUT_TAU * rest;
  double s = strut_sine_of_small(x), c = strut_cosine_of_small(x);
  int quadrant = (int)((long long)quarter & 3);
  double first = quadrant & 1 ? c : s, second = quadrant & 1 ? s : c;
  *sine = quadrant & 2 ? -first : first;
  *cosine = (quadrant + 1) & 2 ? -second : second;
}
