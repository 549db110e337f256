/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `angle`: the angle at the second of three nodes, counter-clockwise from the first to the
 * third, or from +x to the way from the first to the second of two [rad]. It is the one nearest to
 * `reference`, so that it is continuous over whole turns.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_ANGLE_H
#define STRUT_ENGINE_FORCES_STRAINS_ANGLE_H

#include <stdint.h>

#include "engine/base/vec.h"
#include "engine/forces/strains/direction.h"

static inline double strut_strain_angle(const uint32_t *at, int n, const double *q,
                                        double reference, double *b) {
  if (n == 2) {
    double x = q[at[1]] - q[at[0]], y = q[at[1] + 1] - q[at[0] + 1], r2 = x * x + y * y;
    double inverse = r2 > 0.0 ? 1.0 / r2 : 0.0;
    b[0] = inverse * y, b[1] = -inverse * x, b[2] = -b[0], b[3] = -b[1];
    return strut_law_direction_near(strut_law_direction_of(x, y), reference);
  }
  const double *a = q + at[0], *o = q + at[1], *c = q + at[2];
  double ux = a[0] - o[0], uy = a[1] - o[1], vx = c[0] - o[0], vy = c[1] - o[1];
  double u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
  double iu = u2 > 0.0 ? 1.0 / u2 : 0.0, iv = v2 > 0.0 ? 1.0 / v2 : 0.0;
  double angle = strut_law_direction_of(ux * vx + uy * vy, ux * vy - uy * vx);
  b[0] = iu * uy, b[1] = -iu * ux;
  b[4] = -iv * vy, b[5] = iv * vx;
  b[2] = -b[0] - b[4], b[3] = -b[1] - b[5];
  return strut_law_direction_near(angle, reference);
}

/* Of the direction of an arm (x, y) from node o of n, second derivatives 2 x y / r^4 and (y^2 - x^2) / r^4. */
static inline void strut_strain_angle_arm(const uint32_t *at, int n, const double *q, int o,
                                          int arm, double t, double *h) {
  const double *end = q + at[arm], *from = q + at[o];
  double x = end[0] - from[0], y = end[1] - from[1], r2 = x * x + y * y;
  double part = r2 > 0.0 ? t / (r2 * r2) : 0.0, own = 2.0 * part * x * y,
         mixed = part * (y * y - x * x);
  const double block[2][2] = {{own, mixed}, {mixed, -own}};
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      h[(2 * arm + i) * 2 * n + 2 * arm + j] += block[i][j];
      h[(2 * o + i) * 2 * n + 2 * o + j] += block[i][j];
      h[(2 * arm + i) * 2 * n + 2 * o + j] -= block[i][j];
      h[(2 * o + i) * 2 * n + 2 * arm + j] -= block[i][j];
    }
}

static inline void strut_strain_angle_bend(const uint32_t *at, int n, const double *q, double t,
                                           double *h) {
  strut_strain_angle_arm(at, n, q, n - 2, n - 1, t, h);
  if (n > 2) strut_strain_angle_arm(at, n, q, 1, 0, -t, h);
}

#endif
