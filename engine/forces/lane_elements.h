/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: elements (model/elements.h) of several models at once, for lane_kernel.h.
 *
 * Operations are those of elements.c lane by lane. Strains and the linear law are computed in vectors,
 * other laws number by number.
 */
#ifndef STRUT_ENGINE_FORCES_LANE_ELEMENTS_H
#define STRUT_ENGINE_FORCES_LANE_ELEMENTS_H

#include "engine/forces/elements.h"
#include "engine/forces/lane_vector.h"
#include "engine/forces/strains/angle.h"

/* See strut_strain_path; b: (2 nodes) the gradient. */
STRUT_LANE_INLINE lane_real lane_path(const uint32_t *at, int32_t nodes, const double *restrict q,
                                      int p, lane_real *b) {
  lane_real sum = {0}, zero = {0};
  b[0] = b[1] = zero;
  for (int32_t k = 0; k + 1 < nodes; k++) {
    lane_real x = lane_row(q, at[k + 1], p) - lane_row(q, at[k], p),
              y = lane_row(q, at[k + 1] + 1, p) - lane_row(q, at[k] + 1, p);
    lane_real length = lane_root(x * x + y * y);
    lane_real inverse = lane_choose(length > zero, 1.0 / length, zero);
    sum += length;
    x *= inverse, y *= inverse;
    b[2 * k] -= x, b[2 * k + 1] -= y;
    b[2 * k + 2] = zero + x, b[2 * k + 3] = zero + y;
  }
  return sum;
}

/* See strut_strain_angle. */
STRUT_LANE_INLINE lane_real lane_angle(const uint32_t *at, const double *restrict q, int p,
                                       lane_real reference, lane_real *b) {
  lane_real zero = {0}, ox = lane_row(q, at[1], p), oy = lane_row(q, at[1] + 1, p);
  lane_real ux = lane_row(q, at[0], p) - ox, uy = lane_row(q, at[0] + 1, p) - oy;
  lane_real vx = lane_row(q, at[2], p) - ox, vy = lane_row(q, at[2] + 1, p) - oy;
  lane_real u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
  lane_real iu = lane_choose(u2 > zero, 1.0 / u2, zero),
            iv = lane_choose(v2 > zero, 1.0 / v2, zero);
  b[0] = iu * uy, b[1] = -iu * ux;
  b[4] = -iv * vy, b[5] = iv * vx;
  b[2] = -b[0] - b[4], b[3] = -b[1] - b[5];
  return lane_direction_near(lane_direction_of(ux * vx + uy * vy, ux * vy - uy * vx), reference);
}

/* strut_lanes_possible lists the strains that lanes have. */
STRUT_LANE_INLINE lane_real lane_strain(const strut_lane_tables *t, int32_t i,
                                        const double *restrict q, int p, lane_real *b) {
  const strut_element_table *table = &t->first->elements;
  const strut_element *e = &table->element[i];
  const uint32_t *at = table->at + e->first;
  if (e->strain == STRUT_STRAIN_ANGLE)
    return lane_angle(at, q, p, lane_row(t->element_turn, (size_t)i, p), b);
  return lane_path(at, e->nodes, q, p, b);
}

/* What an element's law is asked and answers, dampers included. */
typedef struct lane_element {
  lane_real stretch, own_rate,
      rest_rate;                    /* beyond the natural strain; its rate; that of the latter */
  lane_real elastic, force, excess; /* as of strut_law_response; force: with the damper */
} lane_element;

STRUT_LANE_INLINE void lane_respond(const strut_lane_tables *t, int32_t i, int p, lane_real strain,
                                    lane_real natural, lane_element *x) {
  const strut_element *e = &t->first->elements.element[i];
  lane_real zero = {0};
  x->elastic = lane_row(t->element_stiffness, (size_t)i, p) * x->stretch;
  x->excess = zero;
  if (e->law == STRUT_LAW_LINEAR) return;
  for (int l = 0; l < LANE_WIDTH; l++) {
    const strut_model *m = t->model[p * LANE_WIDTH + l];
    int piece = (int)lane_row(t->element_piece, (size_t)i, p)[l];
    strut_law_response r =
        strut_law_respond(e->law, &m->elements.element[i].numbers, strain[l], natural[l], piece);
    x->elastic[l] = r.force, x->excess[l] = r.excess;
  }
}

/* Element i as if it acted; b: its gradient. rated: whether its rate matters. */
STRUT_LANE_INLINE lane_element lane_element_move(const strut_lane_tables *t, int32_t i, int p,
                                                 lane_real strain, const lane_real *b,
                                                 const double *restrict v, bool rated) {
  const strut_element_table *table = &t->first->elements;
  const strut_element *e = &table->element[i];
  const uint32_t *at = table->at + e->first;
  size_t slot = (size_t)(e->slot >= 0 ? e->slot : i);
  lane_real zero = {0}, rate = zero;
  lane_real natural = lane_row(e->slot >= 0 ? t->rest : t->element_natural, slot, p);
  lane_element x = {.stretch = strain - natural,
                    .rest_rate = e->slot >= 0 ? lane_row(t->rest_rate, slot, p) : zero};
  for (int32_t k = 0; k < e->nodes && rated; k++)
    rate += b[2 * k] * lane_row(v, at[k], p) + b[2 * k + 1] * lane_row(v, at[k] + 1, p);
  x.own_rate = rate - x.rest_rate;
  lane_respond(t, i, p, strain, natural, &x);
  x.force = x.elastic + lane_row(t->element_damping, (size_t)i, p) * x.own_rate;
  return x;
}

/* One-sided: it acts in the mode that is frozen, or where strain and force say so; see `exert`. */
STRUT_LANE_INLINE void lane_carry(const strut_lane_tables *t, int32_t i, int p, lane_element *x) {
  int8_t carries = t->first->elements.element[i].carries;
  if (!carries) return;
  lane_real zero = {0}, mode = lane_row(t->element_acts, (size_t)i, p), sign = zero + carries;
  lane_mask beyond = sign * x->stretch > zero, free = mode == zero;
  lane_mask acts = (mode > zero) | (free & beyond & (sign * x->force > zero));
  x->force = lane_choose(acts, x->force, zero);
  x->elastic = lane_choose(acts | beyond, x->elastic, zero);
  x->excess = lane_choose(acts | beyond, x->excess, zero);
}

STRUT_LANE_INLINE void lane_add_element(strut_lane_tables *t, int32_t i, int p,
                                        const double *restrict q, const double *restrict v,
                                        bool ledger, lane_member_powers *powers) {
  const strut_element_table *table = &t->first->elements;
  const strut_element *e = &table->element[i];
  const uint32_t *at = table->at + e->first;
  lane_real b[STRUT_MOST_GRADIENT], strain = lane_strain(t, i, q, p, b);
  lane_put(t->element_turn, (size_t)i, p, strain);
  lane_element x = lane_element_move(t, i, p, strain, b, v, ledger || e->damping > 0.0);
  lane_carry(t, i, p, &x);
  for (int32_t k = 0; k < e->nodes; k++) {
    lane_put(t->force, at[k], p, lane_row(t->force, at[k], p) - x.force * b[2 * k]);
    lane_put(t->force, at[k] + 1, p, lane_row(t->force, at[k] + 1, p) - x.force * b[2 * k + 1]);
  }
  if (!ledger) return;
  lane_real drive = (x.excess - x.force) * x.rest_rate, lost = (x.force - x.elastic) * x.own_rate;
  powers->drive += drive, powers->lost += lost;
  powers->exchanged += lane_magnitude(drive) + lost;
}

STRUT_LANE_INLINE void lane_add_powers(strut_lane_tables *t, int p,
                                       const lane_member_powers *powers) {
  double *power = t->power;
  lane_put(power, STRUT_POWER_DRIVE, p, lane_row(power, STRUT_POWER_DRIVE, p) + powers->drive);
  lane_put(power, STRUT_POWER_MEMBERS, p, lane_row(power, STRUT_POWER_MEMBERS, p) + powers->lost);
  lane_put(power, STRUT_POWER_EXCHANGED, p,
           lane_row(power, STRUT_POWER_EXCHANGED, p) + powers->exchanged);
}

/* Of plain linear hinges a single run sums powers place by place within groups, of others one by one. */
STRUT_LANE_INLINE void lane_element_block(strut_lane_tables *t, const strut_element_block *block,
                                          int p, const double *restrict q, const double *restrict v,
                                          bool ledger) {
  lane_real zero = {0};
  lane_member_powers none = {.drive = zero, .exchanged = zero, .lost = zero}, group[STRUT_LANES];
  bool grouped =
      block->strain == STRUT_STRAIN_ANGLE && block->law == STRUT_LAW_LINEAR && block->both_signs;
  int32_t i = block->begin, end = grouped ? i + (block->end - i) / STRUT_LANES * STRUT_LANES : i;
  for (int l = 0; l < STRUT_LANES; l++) group[l] = none;
  for (; i < end; i++)
    lane_add_element(t, i, p, q, v, ledger, &group[(i - block->begin) % STRUT_LANES]);
  for (int l = 0; l < STRUT_LANES && grouped && ledger; l++) lane_add_powers(t, p, &group[l]);
  for (; i < block->end; i++) {
    lane_member_powers one = none;
    lane_add_element(t, i, p, q, v, ledger, &one);
    if (ledger) lane_add_powers(t, p, &one);
  }
}

/* All elements; see strut_elements_add_forces. */
STRUT_LANE_INLINE void lane_elements(strut_lane_tables *t, const double *restrict q,
                                     const double *restrict v, bool ledger) {
  const strut_element_table *table = &t->first->elements;
  for (int32_t b = 0; b < table->block_count; b++)
    LANE_EACH(lane_element_block(t, &table->block[b], p, q, v, ledger));
}

#endif
