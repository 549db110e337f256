/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `angle`: the angle at the second of three nodes, counter-clockwise from the first to the
 * third [rad]. It is the one nearest to `reference`, so that it is continuous over whole turns.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_ANGLE_H
#define STRUT_ENGINE_FORCES_STRAINS_ANGLE_H

#include <math.h>
#include <stdint.h>

#include "engine/base/vec.h"
#include "engine/model/hot.h"

/**
 * Defines, for numbers of a vector type: PREFIX_angle_of, the directions of the vectors (x, y) [rad], in
 * [-pi, pi]: atan2 with the same bits on every machine, within 4 DBL_EPSILON of the angle
 * (tests/unit/elements_test.c), where within an octant the vector is turned back by 0, 1 or 2 times pi/8;
 * and PREFIX_angle_near, the angle that differs from `angle` by whole turns and is nearest to `reference`.
 * The series is that of atan t / t - 1 for |t| <= tan(pi/16), whose next term is below 1e-18.
 */
#define STRUT_DEFINE_ANGLE(inlined, number, mask, PREFIX, choose, magnitude)                       \
  inlined number PREFIX##_angle_series(number z) {                                                 \
    number z2 = z * z, z4 = z2 * z2, z8 = z4 * z4;                                                 \
    number a = (-1.0 / 3.0 + z * (1.0 / 5.0)) + z2 * (-1.0 / 7.0 + z * (1.0 / 9.0));               \
    number b = (-1.0 / 11.0 + z * (1.0 / 13.0)) + z2 * (-1.0 / 15.0 + z * (1.0 / 17.0));           \
    number c = (-1.0 / 19.0 + z * (1.0 / 21.0)) + z2 * (-1.0 / 23.0 + z * (1.0 / 25.0));           \
    return z * (a + z4 * b + z8 * c);                                                              \
  }                                                                                                \
  inlined number PREFIX##_angle_of(number x, number y) {                                           \
    const number zero = {0}, one = zero + 1.0;                                                     \
    number ax = magnitude(x), ay = magnitude(y);                                                   \
    mask steep = ay > ax;                                                                          \
    number big = choose(steep, ay, ax), small = choose(steep, ax, ay);                             \
    mask once = small > 0.198912367379658 * big,                                                   \
         twice = small > 0.6681786379192989 * big; /* tan pi/16, tan 3 pi/16 */                    \
    number c =                                                                                     \
        choose(twice, zero + 0.7071067811865476, choose(once, zero + 0.9238795325112867, one));    \
    number s =                                                                                     \
        choose(twice, zero + 0.7071067811865476, choose(once, zero + 0.3826834323650898, zero));   \
    number base =                                                                                  \
        choose(twice, zero + 0.25 * STRUT_PI, choose(once, zero + 0.125 * STRUT_PI, zero));        \
    number across = small * c - big * s, along = big * c + small * s;                              \
    number t = across / choose(along > zero, along, one);                                          \
    number angle = base + (t + t * PREFIX##_angle_series(t * t));                                  \
    angle = choose(steep, 0.5 * STRUT_PI - angle, angle);                                          \
    angle = choose(x < zero, STRUT_PI - angle, angle);                                             \
    return choose(y < zero, -angle, angle);                                                        \
  }                                                                                                \
  inlined number PREFIX##_angle_near(number angle, number reference) {                             \
    const double rounder =                                                                         \
        6755399441055744.0; /* of numbers of this size units are the last bits */                  \
    number turns = (reference - angle) * (1.0 / STRUT_TAU);                                        \
    return angle + STRUT_TAU * ((turns + rounder) - rounder);                                      \
  }

STRUT_DEFINE_ANGLE(STRUT_INLINE, strut_lanes, strut_lane_mask, strut, strut_lanes_choose,
                   strut_lanes_magnitude)

static inline double strut_strain_angle(const uint32_t *at, int n, const double *q,
                                        double reference, double *b) {
  const double *a = q + at[0], *o = q + at[1], *c = q + at[2];
  double ux = a[0] - o[0], uy = a[1] - o[1], vx = c[0] - o[0], vy = c[1] - o[1];
  double u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
  double iu = u2 > 0.0 ? 1.0 / u2 : 0.0, iv = v2 > 0.0 ? 1.0 / v2 : 0.0;
  strut_lanes angle =
      strut_angle_of((strut_lanes){ux * vx + uy * vy}, (strut_lanes){ux * vy - uy * vx});
  (void)n;
  b[0] = iu * uy, b[1] = -iu * ux;
  b[4] = -iv * vy, b[5] = iv * vx;
  b[2] = -b[0] - b[4], b[3] = -b[1] - b[5];
  return strut_angle_near(angle, (strut_lanes){reference})[0];
}

/* Of the direction of an arm (x, y), second derivatives 2 x y / r^4 and (y^2 - x^2) / r^4. */
static inline void strut_strain_angle_arm(const uint32_t *at, const double *q, int arm, double t,
                                          double *h) {
  const double *end = q + at[arm], *o = q + at[1];
  double x = end[0] - o[0], y = end[1] - o[1], r2 = x * x + y * y;
  double part = r2 > 0.0 ? t / (r2 * r2) : 0.0, own = 2.0 * part * x * y,
         mixed = part * (y * y - x * x);
  const double block[2][2] = {{own, mixed}, {mixed, -own}};
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      h[(2 * arm + i) * 6 + 2 * arm + j] += block[i][j];
      h[(2 + i) * 6 + 2 + j] += block[i][j];
      h[(2 * arm + i) * 6 + 2 + j] -= block[i][j];
      h[(2 + i) * 6 + 2 * arm + j] -= block[i][j];
    }
}

static inline void strut_strain_angle_bend(const uint32_t *at, int n, const double *q, double t,
                                           double *h) {
  (void)n;
  strut_strain_angle_arm(at, q, 2, t, h);
  strut_strain_angle_arm(at, q, 0, -t, h);
}

#endif
