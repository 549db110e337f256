/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `reach`: the distance of the first node from the segment between the second and the third, whose ends
 * are round [m]. And `offset`, that from the line.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_REACH_H
#define STRUT_ENGINE_FORCES_STRAINS_REACH_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* The nearest point of the segment: its place s in [0, 1], the distance and the unit vector to the node. */
typedef struct strut_reach {
  double s, distance, nx, ny, length;
} strut_reach;

static inline strut_reach strut_reach_of(const uint32_t *at, const double *q) {
  const double *p = q + at[0], *a = q + at[1], *b = q + at[2];
  double wx = b[0] - a[0], wy = b[1] - a[1], w2 = wx * wx + wy * wy;
  double s = w2 > 0.0 ? ((p[0] - a[0]) * wx + (p[1] - a[1]) * wy) / w2 : 0.0;
  s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
  double x = p[0] - a[0] - s * wx, y = p[1] - a[1] - s * wy, distance = sqrt(x * x + y * y);
  double inverse = distance > 0.0 ? 1.0 / distance : 0.0;
  return (strut_reach){s, distance, x * inverse, y * inverse, sqrt(w2)};
}

static inline void strut_reach_gradient(const strut_reach *r, double *b) {
  b[0] = r->nx, b[1] = r->ny;
  b[2] = -(1.0 - r->s) * r->nx, b[3] = -(1.0 - r->s) * r->ny;
  b[4] = -r->s * r->nx, b[5] = -r->s * r->ny;
}

/*
 * Beside the segment, with g the node's motion along it, that is along (tx, ty), and f the segment's turning,
 * the second variation is -2 f g - e f^2; beyond its ends it is that of a distance of two nodes.
 */
static inline void strut_reach_bend(const strut_reach *r, bool beside, double tx, double ty,
                                    double t, double *h) {
  double part[3] = {1.0, -(1.0 - r->s), -r->s}, f[6] = {0}, g[6];
  double turn = r->length > 0.0 ? 1.0 / r->length : 0.0;
  for (int k = 0; k < 3; k++) g[2 * k] = part[k] * tx, g[2 * k + 1] = part[k] * ty;
  f[2] = -turn * r->nx, f[3] = -turn * r->ny, f[4] = turn * r->nx, f[5] = turn * r->ny;
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++)
      h[i * 6 + j] += beside ? -t * (f[i] * g[j] + g[i] * f[j] + r->distance * f[i] * f[j])
                             : t * g[i] * g[j] / r->distance;
}

static inline double strut_strain_reach(const uint32_t *at, int n, const double *q,
                                        double reference, double *b) {
  strut_reach r = strut_reach_of(at, q);
  (void)n, (void)reference;
  strut_reach_gradient(&r, b);
  return r.distance;
}

static inline void strut_strain_reach_bend(const uint32_t *at, int n, const double *q, double t,
                                           double *h) {
  strut_reach r = strut_reach_of(at, q);
  (void)n;
  if (!(r.distance > 0.0)) return;
  double tx = -r.ny, ty = r.nx;
  const double *a = q + at[1], *b = q + at[2];
  if ((b[0] - a[0]) * tx + (b[1] - a[1]) * ty < 0.0) tx = -tx, ty = -ty;
  strut_reach_bend(&r, r.s > 0.0 && r.s < 1.0, tx, ty, t, h);
}

/*
 * The strain `offset`: the distance of the first node from the straight line through the second and the third,
 * positive on the left of the way from one to the other [m].
 */

/* The foot of the node on the line; the line's left normal. */
static inline strut_reach strut_offset_of(const uint32_t *at, const double *q) {
  const double *p = q + at[0], *a = q + at[1], *b = q + at[2];
  double wx = b[0] - a[0], wy = b[1] - a[1], length = sqrt(wx * wx + wy * wy);
  double inverse = length > 0.0 ? 1.0 / length : 0.0;
  double nx = -wy * inverse, ny = wx * inverse, ux = p[0] - a[0], uy = p[1] - a[1];
  return (strut_reach){(ux * ny - uy * nx) * inverse, ux * nx + uy * ny, nx, ny, length};
}

static inline double strut_strain_offset(const uint32_t *at, int n, const double *q,
                                         double reference, double *b) {
  strut_reach r = strut_offset_of(at, q);
  (void)n, (void)reference;
  strut_reach_gradient(&r, b);
  return r.distance;
}

static inline void strut_strain_offset_bend(const uint32_t *at, int n, const double *q, double t,
                                            double *h) {
  strut_reach r = strut_offset_of(at, q);
  (void)n;
  strut_reach_bend(&r, true, r.ny, -r.nx, t, h);
}

#endif
