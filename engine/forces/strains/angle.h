/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `angle`: the angle at the second of three nodes, counter-clockwise from the first to the
 * third [rad]. It is the one nearest to `reference`, so that it is continuous over whole turns.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_ANGLE_H
#define STRUT_ENGINE_FORCES_STRAINS_ANGLE_H

#include <stdint.h>

#include "engine/base/vec.h"
#include "engine/forces/strains/direction.h"

static inline double strut_strain_angle(const uint32_t *at, int n, const double *q,
                                        double reference, double *b) {
  const double *a = q + at[0], *o = q + at[1], *c = q + at[2];
  double ux = a[0] - o[0], uy = a[1] - o[1], vx = c[0] - o[0], vy = c[1] - o[1];
  double u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
  double iu = u2 > 0.0 ? 1.0 / u2 : 0.0, iv = v2 > 0.0 ? 1.0 / v2 : 0.0;
  double angle = strut_law_direction_of(ux * vx + uy * vy, ux * vy - uy * vx);
  (void)n;
  b[0] = iu * uy, b[1] = -iu * ux;
  b[4] = -iv * vy, b[5] = iv * vx;
  b[2] = -b[0] - b[4], b[3] = -b[1] - b[5];
  return strut_law_direction_near(angle, reference);
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
