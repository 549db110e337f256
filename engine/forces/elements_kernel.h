/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: elements that come in great numbers, in vectors: linear hinges, four at a time, and the segments
 * of a running cable. Bits are those of the loops of elements.c.
 */
#ifndef STRUT_ENGINE_FORCES_ELEMENTS_KERNEL_H
#define STRUT_ENGINE_FORCES_ELEMENTS_KERNEL_H

#include "engine/forces/elements.h"
#include "engine/forces/members_kernel.h"

/* One node of each of four hinges. */
typedef struct hinge_nodes {
  strut_lanes x, y;
} hinge_nodes;

/* Number `node` of those of four hinges, which `at` lists three by three. */
STRUT_INLINE hinge_nodes gather_hinges(const double *restrict p, const uint32_t *restrict at,
                                       int node) {
  strut_lanes even = strut_lanes_join(p + at[node], p + at[6 + node]);
  strut_lanes odd = strut_lanes_join(p + at[3 + node], p + at[9 + node]);
  return (hinge_nodes){__builtin_shufflevector(even, odd, 0, 4, 2, 6),
                       __builtin_shufflevector(even, odd, 1, 5, 3, 7)};
}

STRUT_INLINE void pull_node(double *f, strut_pair pull) {
  strut_pair_store(f, strut_pair_load(f) - pull);
}

/* Sums of what drives and dampers of hinges do [W]. */
typedef struct hinge_powers {
  strut_lanes drive, lost, exchanged;
} hinge_powers;

/* Four linear hinges that carry both signs, from element i on: what add_angle_linear does. */
STRUT_INLINE void add_four_hinges(const strut_element_table *elements, const strut_state *state,
                                  int32_t i, const uint32_t *restrict at, const double *restrict q,
                                  const double *restrict v, double *restrict force,
                                  hinge_powers *powers) {
  const strut_lanes zero = {0};
  hinge_nodes a = gather_hinges(q, at, 0), o = gather_hinges(q, at, 1), c = gather_hinges(q, at, 2);
  strut_lanes ux = a.x - o.x, uy = a.y - o.y, vx = c.x - o.x, vy = c.y - o.y;
  strut_lanes u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
  strut_lanes iu = four_choose(u2 > zero, 1.0 / u2, zero);
  strut_lanes iv = four_choose(v2 > zero, 1.0 / v2, zero);
  strut_lanes strain = four_direction_near(four_direction_of(ux * vx + uy * vy, ux * vy - uy * vx),
                                           strut_lanes_load(state->history.turn + i));
  strut_lanes ax = iu * uy, ay = -iu * ux, cx = -iv * vy, cy = iv * vx, bx = -ax - cx,
              by = -ay - cy;
  strut_lanes natural, rest_rate;
  for (int l = 0; l < STRUT_LANES; l++)
    natural[l] = state->latest->rest[elements->slot[i + l]],
    rest_rate[l] = state->latest->rest_rate[elements->slot[i + l]];
  hinge_nodes wa = gather_hinges(v, at, 0), wo = gather_hinges(v, at, 1),
              wc = gather_hinges(v, at, 2);
  strut_lanes own =
      (ax * wa.x + ay * wa.y) + (bx * wo.x + by * wo.y) + (cx * wc.x + cy * wc.y) - rest_rate;
  strut_lanes elastic = strut_lanes_load(elements->stiffness + i) * (strain - natural);
  strut_lanes moment = elastic + strut_lanes_load(elements->damping + i) * own;
  ax *= moment, ay *= moment, bx *= moment, by *= moment, cx *= moment, cy *= moment;
  for (int l = 0; l < STRUT_LANES; l++) { /* hinge by hinge, so that sums keep their order */
    pull_node(force + at[3 * l], (strut_pair){ax[l], ay[l]});
    pull_node(force + at[3 * l + 1], (strut_pair){bx[l], by[l]});
    pull_node(force + at[3 * l + 2], (strut_pair){cx[l], cy[l]});
  }
  strut_lanes drive = -moment * rest_rate, lost = (moment - elastic) * own;
  powers->drive += drive, powers->lost += lost;
  powers->exchanged += four_magnitude(drive) + lost;
}

/* Segment k's unit vector enters the gradient at both of its ends. */
STRUT_INLINE void lay_segment(strut_pair *pair, int32_t k, strut_pair unit) {
  const strut_pair zero = {0};
  pair[k] -= unit;
  pair[k + 1] = zero + unit;
}

/* Strain `path` and its gradient b (nodes), four segments at a time; see strut_strain_path. */
STRUT_INLINE double measure_path(const uint32_t *restrict at, int32_t nodes,
                                 const double *restrict q, strut_pair *restrict pair) {
  const strut_lanes zero = {0};
  double sum = 0.0;
  int32_t k = 0;
  pair[0] = (strut_pair){0};
  for (; k + STRUT_LANES < nodes; k += STRUT_LANES) {
    member_vectors d = members_gather(q, at + k, at + k + 1);
    strut_lanes length = four_root(d.x * d.x + d.y * d.y);
    strut_lanes inverse = four_choose(length > zero, 1.0 / length, zero);
    d.x *= inverse, d.y *= inverse;
    for (int32_t l = 0; l < STRUT_LANES; l++) {
      sum += length[l];
      lay_segment(pair, k + l, (strut_pair){d.x[l], d.y[l]});
    }
  }
  for (; k + 1 < nodes; k++) {
    strut_pair d = strut_pair_load(q + at[k + 1]) - strut_pair_load(q + at[k]);
    double length = sqrt(d[0] * d[0] + d[1] * d[1]), inverse = length > 0.0 ? 1.0 / length : 0.0;
    sum += length;
    lay_segment(pair, k, d * inverse);
  }
  return sum;
}

/* Rate of a path at velocities v. */
STRUT_INLINE double path_rate(const uint32_t *restrict at, int32_t nodes, const double *restrict v,
                              const strut_pair *restrict pair) {
  double rate = 0.0;
  for (int32_t k = 0; k < nodes; k++) {
    strut_pair part = pair[k] * strut_pair_load(v + at[k]);
    rate += part[0] + part[1];
  }
  return rate;
}

STRUT_INLINE void pull_path(const uint32_t *restrict at, int32_t nodes, double *restrict force,
                            const strut_pair *restrict pair, double tension) {
  for (int32_t k = 0; k < nodes; k++) pull_node(force + at[k], tension * pair[k]);
}

#endif
