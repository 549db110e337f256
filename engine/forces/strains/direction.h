/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Directions of vectors, with the same bits on every machine; one text for all kernels, see
 * engine/scene/laws/words.h.
 */
#include "engine/scene/laws/words.h"

/* atan t / t - 1 over z = t^2, |t| <= tan(pi/16): the next term is below 1e-18. */
LAW_INLINE real LAW(direction_series)(real z) {
  real z2 = z * z, z4 = z2 * z2, z8 = z4 * z4;
  real a = (-1.0 / 3.0 + z * (1.0 / 5.0)) + z2 * (-1.0 / 7.0 + z * (1.0 / 9.0));
  real b = (-1.0 / 11.0 + z * (1.0 / 13.0)) + z2 * (-1.0 / 15.0 + z * (1.0 / 17.0));
  real c = (-1.0 / 19.0 + z * (1.0 / 21.0)) + z2 * (-1.0 / 23.0 + z * (1.0 / 25.0));
  return z * (a + z4 * b + z8 * c);
}

/* The value for the octant's first, second or last part, to whose middle a vector is turned back. */
LAW_INLINE real LAW(direction_part)(mask once, mask twice, double none, double one, double two) {
  return choose(twice, all(two), choose(once, all(one), all(none)));
}

/**
 * The directions of the vectors (x, y) [rad], in [-pi, pi]: atan2, within 4 DBL_EPSILON
 * (tests/unit/elements_test.c). Within an octant the vector is turned back by 0, 1 or 2 times pi/8.
 */
LAW_INLINE real LAW(direction_of)(real x, real y) {
  real zero = all(0.0), ax = magnitude(x), ay = magnitude(y);
  mask steep = less(ax, ay);
  real big = choose(steep, ay, ax), small = choose(steep, ax, ay);
  mask once = less(0.198912367379658 * big, small);
  mask twice = less(0.6681786379192989 * big, small); /* tan pi/16, tan 3 pi/16 */
  real c = LAW(direction_part)(once, twice, 1.0, 0.9238795325112867, 0.7071067811865476);
  real s = LAW(direction_part)(once, twice, 0.0, 0.3826834323650898, 0.7071067811865476);
  real base = LAW(direction_part)(once, twice, 0.0, 0.125 * STRUT_PI, 0.25 * STRUT_PI);
  real across = small * c - big * s, along = big * c + small * s;
  real t = across / choose(less(zero, along), along, all(1.0));
  real angle = base + (t + t * LAW(direction_series)(t * t));
  angle = choose(steep, 0.5 * STRUT_PI - angle, angle);
  angle = choose(less(x, zero), STRUT_PI - angle, angle);
  return choose(less(y, zero), -angle, angle);
}

/** The angle that differs from `angle` by whole turns and is nearest to `reference`. */
LAW_INLINE real LAW(direction_near)(real angle, real reference) {
  return angle + STRUT_TAU * whole((reference - angle) * (1.0 / STRUT_TAU));
}

#include "engine/scene/laws/words_end.h"
