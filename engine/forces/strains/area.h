/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Strain `area`: the area of a polygon of nodes, positive counter-clockwise [m^2]. */
#ifndef STRUT_ENGINE_FORCES_STRAINS_AREA_H
#define STRUT_ENGINE_FORCES_STRAINS_AREA_H

#include <stdint.h>

/* Summed from differences: far from the origin digits would be lost. */
static inline double strut_strain_area(const uint32_t *at, int n, const double *q, double reference,
                                       double *b) {
  double twice = 0.0;
  const double *origin = q + at[0];
  (void)reference;
  for (int k = 0; k < n; k++) {
    const double *before = q + at[k ? k - 1 : n - 1], *p = q + at[k],
                 *after = q + at[k + 1 < n ? k + 1 : 0];
    b[2 * k] = 0.5 * (after[1] - before[1]);
    b[2 * k + 1] = 0.5 * (before[0] - after[0]);
    twice +=
        (p[0] - origin[0]) * (after[1] - origin[1]) - (after[0] - origin[0]) * (p[1] - origin[1]);
  }
  return 0.5 * twice;
}

static inline void strut_strain_area_bend(const uint32_t *at, int n, const double *q, double t,
                                          double *h) {
  int side = 2 * n;
  (void)at, (void)q;
  for (int k = 0; k < n; k++) {
    int after = k + 1 < n ? k + 1 : 0;
    h[2 * k * side + 2 * after + 1] += 0.5 * t;
    h[(2 * after + 1) * side + 2 * k] += 0.5 * t;
    h[2 * after * side + 2 * k + 1] -= 0.5 * t;
    h[(2 * k + 1) * side + 2 * after] -= 0.5 * t;
  }
}

#endif
