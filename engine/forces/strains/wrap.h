/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `wrap`: the length of a cable over guides of a radius [m], engine/scene/wrap.h. `axis` has a bit for each
 * guide that is to the right. As the cable touches each circle along a tangent, neither gradient nor second derivative
 * know of the arcs: they are those of its straight segments.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_WRAP_H
#define STRUT_ENGINE_FORCES_STRAINS_WRAP_H

#include "engine/scene/wrap.h"

static inline double strut_strain_wrap_find(const uint32_t *at, int n, const double *q, double axis,
                                            double radius, strut_wrap *w) {
  double p[STRUT_MOST_WRAPPED][2];
  for (int k = 0; k < n; k++) p[k][0] = q[at[k]], p[k][1] = q[at[k] + 1];
  return strut_wrap_find((const double(*)[2])p, n, (uint32_t)axis, radius, w);
}

static inline double strut_strain_wrap(const uint32_t *at, int n, const double *q, double axis,
                                       double radius, double *b) {
  strut_wrap w;
  double length = strut_strain_wrap_find(at, n, q, axis, radius, &w);
  for (int k = 0; k < 2 * n; k++) b[k] = 0.0;
  for (int k = 0; k + 1 < w.count; k++) {
    int from = 2 * w.node[k], to = 2 * w.node[k + 1];
    b[from] -= w.ux[k], b[from + 1] -= w.uy[k];
    b[to] += w.ux[k], b[to + 1] += w.uy[k];
  }
  return length;
}

static inline void strut_strain_wrap_bend(const uint32_t *at, int n, const double *q, double axis,
                                          double radius, double t, double *h) {
  strut_wrap w;
  strut_strain_wrap_find(at, n, q, axis, radius, &w);
  for (int k = 0; k + 1 < w.count; k++) {
    if (!(w.free[k] > 0.0)) continue;
    const double across[2] = {-w.uy[k], w.ux[k]};
    const int node[2] = {w.node[k], w.node[k + 1]};
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++)
        h[(2 * node[i / 2] + i % 2) * 2 * n + 2 * node[j / 2] + j % 2] +=
            (i / 2 == j / 2 ? t : -t) * across[i % 2] * across[j % 2] / w.free[k];
  }
}

#endif
