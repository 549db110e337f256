/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strain `foot`: how far the middle of a circular arc is out of the ground's line through the origin [m]. The
 * arc, of the given radius, stands on the first of two nodes square to the way to the second, on which its middle
 * lies; of a node alone it has no radius. `axis` is the tangent of half the angle of the ground's normal from +x.
 */
#ifndef STRUT_ENGINE_FORCES_STRAINS_FOOT_H
#define STRUT_ENGINE_FORCES_STRAINS_FOOT_H

#include <math.h>
#include <stdint.h>

/** The arc's member, and the directions of a unit vector along it and across it, to the left. */
typedef struct strut_foot_pose {
  double nx, ny; /* the ground's normal */
  double ux, uy; /* from the foot along the member */
  double along;  /* of the normal along the member */
  double across; /* and across it */
  double turn;   /* radius / length of the member */
} strut_foot_pose;

static inline strut_foot_pose strut_foot_pose_of(const uint32_t *at, int n, const double *q,
                                                 double axis, double radius) {
  double t2 = axis * axis, nx = (1.0 - t2) / (1.0 + t2), ny = 2.0 * axis / (1.0 + t2);
  uint32_t far = at[n - 1];
  double x = q[far] - q[at[0]], y = q[far + 1] - q[at[0] + 1], length = sqrt(x * x + y * y);
  double inverse = length > 0.0 ? 1.0 / length : 0.0, ux = x * inverse, uy = y * inverse;
  return (strut_foot_pose){nx, ny, ux, uy, nx * ux + ny * uy, ny * ux - nx * uy, radius * inverse};
}

static inline double strut_strain_foot(const uint32_t *at, int n, const double *q, double axis,
                                       double radius, double *b) {
  strut_foot_pose f = strut_foot_pose_of(at, n, q, axis, radius);
  double turn = f.turn * f.across;
  b[2] = -turn * f.uy, b[3] = turn * f.ux;
  b[0] = f.nx - b[2], b[1] = f.ny - b[3];
  return f.nx * q[at[0]] + f.ny * q[at[0] + 1] + radius * f.along;
}

/* With p and a the relative motion of the ends across the member and along it. */
static inline void strut_strain_foot_bend(const uint32_t *at, int n, const double *q, double axis,
                                          double radius, double t, double *h) {
  if (n == 1) return;
  strut_foot_pose f = strut_foot_pose_of(at, n, q, axis, radius);
  double x = q[at[1]] - q[at[0]], y = q[at[1] + 1] - q[at[0] + 1], length = sqrt(x * x + y * y);
  double a[4] = {-f.ux, -f.uy, f.ux, f.uy}, p[4] = {f.uy, -f.ux, -f.uy, f.ux};
  double by = length > 0.0 ? t * f.turn / length : 0.0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      h[i * 4 + j] -= by * (f.along * p[i] * p[j] + f.across * (a[i] * p[j] + p[i] * a[j]));
}

#endif
