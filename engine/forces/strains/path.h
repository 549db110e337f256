/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `path`: the sum of the distances from node to node [m], of a cable that runs through guides. A segment
 * without length has no direction and adds no gradient. And `length`, that of one segment.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_PATH_H
#define STRUT_ENGINE_FORCES_STRAINS_PATH_H

#include <math.h>
#include <stdint.h>

static inline double strut_strain_path(const uint32_t *at, int n, const double *q, double reference,
                                       double *b) {
  double sum = 0.0;
  (void)reference;
  for (int k = 0; k < 2 * n; k++) b[k] = 0.0;
  for (int k = 0; k + 1 < n; k++) {
    double x = q[at[k + 1]] - q[at[k]], y = q[at[k + 1] + 1] - q[at[k] + 1];
    double length = sqrt(x * x + y * y), inverse = length > 0.0 ? 1.0 / length : 0.0;
    sum += length;
    x *= inverse, y *= inverse;
    b[2 * k] -= x, b[2 * k + 1] -= y;
    b[2 * k + 2] += x, b[2 * k + 3] += y;
  }
  return sum;
}

/* (1 - u u') / length of each segment, which couples its two ends. */
static inline void strut_strain_path_bend(const uint32_t *at, int n, const double *q, double t,
                                          double *h) {
  for (int k = 0; k + 1 < n; k++) {
    double x = q[at[k + 1]] - q[at[k]], y = q[at[k + 1] + 1] - q[at[k] + 1];
    double length = sqrt(x * x + y * y);
    if (!(length > 0.0)) continue;
    double part = t / (length * length * length);
    const double block[2][2] = {{part * y * y, -part * x * y}, {-part * x * y, part * x * x}};
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++)
        h[(2 * k + i) * 2 * n + 2 * k + j] += (i / 2 == j / 2 ? 1.0 : -1.0) * block[i % 2][j % 2];
  }
}

/* The strain `length`: the distance of two nodes [m]. */
static inline double strut_strain_length(const uint32_t *at, int n, const double *q,
                                         double reference, double *b) {
  (void)n;
  return strut_strain_path(at, 2, q, reference, b);
}

static inline void strut_strain_length_bend(const uint32_t *at, int n, const double *q, double t,
                                            double *h) {
  (void)n;
  strut_strain_path_bend(at, 2, q, t, h);
}

#endif
