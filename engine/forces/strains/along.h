/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `along`: how far the second of two nodes is ahead of the first in a direction [m]. `axis` is the
 * tangent of half the direction's angle from +x: 0 is x, 1 is y, both to the last bit.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_ALONG_H
#define STRUT_ENGINE_FORCES_STRAINS_ALONG_H

#include <stdint.h>

static inline double strut_strain_along(const uint32_t *at, int n, const double *q, double axis,
                                        double *b) {
  double t2 = axis * axis, x = (1.0 - t2) / (1.0 + t2), y = 2.0 * axis / (1.0 + t2);
  (void)n;
  b[0] = -x, b[1] = -y, b[2] = x, b[3] = y;
  return x * (q[at[1]] - q[at[0]]) + y * (q[at[1] + 1] - q[at[0] + 1]);
}

/* It is linear in the positions. */
static inline void strut_strain_along_bend(const uint32_t *at, int n, const double *q, double t,
                                           double *h) {
  (void)at, (void)n, (void)q, (void)t, (void)h;
}

#endif
