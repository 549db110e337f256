/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Each strain's value with its gradient b (2n), and t times its second derivative, added to h (2n x 2n). */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "engine/base/vec.h"
#include "engine/forces/strains/direction.h"
#include "engine/scene/wrap.h"

/*
 * Strain `path`: the sum of the distances from node to node [m], of a cable that runs through guides. A segment
 * without length has no direction and adds no gradient. And `length`, that of one segment.
 */
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

/*
 * Strain `along`: how far the second of two nodes is ahead of the first in a direction [m]. `axis` is the
 * tangent of half the direction's angle from +x: 0 is x, 1 is y, both to the last bit.
 */

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

/* Strain `area`: the area of a polygon of nodes, positive counter-clockwise [m^2]. */

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

/*
 * Strain `wrap`: the length of a cable over guides of a radius [m], engine/scene/wrap.h. `axis` has a bit for each
 * guide that is to the right. As the cable touches each circle along a tangent, neither gradient nor second derivative
 * know of the arcs: they are those of its straight segments.
 */

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

/*
 * Strain `foot`: how far the middle of a circular arc is out of the ground's line through the origin [m]. The
 * arc, of the given radius, stands on the first of two nodes square to the way to the second, on which its middle
 * lies; of a node alone it has no radius. `axis` is the tangent of half the angle of the ground's normal from +x.
 */

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

/*
 * Strain `reach`: the distance of the first node from the segment between the second and the third, whose ends
 * are round [m]. And `offset`, that from the line.
 */

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

/*
 * Strain `angle`: the angle at the second of three nodes, counter-clockwise from the first to the
 * third, or from +x to the way from the first to the second of two [rad]. It is the one nearest to
 * `reference`, so that it is continuous over whole turns.
 */

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
