/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: elements (model/elements.h) of several models at once, for batch_kernel.h.
 *
 * Operations are those of elements.c lane by lane. Strains and the linear law are computed in vectors,
 * other laws number by number.
 */
#ifndef STRUT_ENGINE_FORCES_BATCH_ELEMENTS_H
#define STRUT_ENGINE_FORCES_BATCH_ELEMENTS_H

#include "engine/forces/batch_vector.h"
#include "engine/forces/elements.h"
#include "engine/forces/strains/angle.h"

/* See strut_strain_path; b: (2 nodes) the gradient. */
STRUT_BATCH_INLINE batch_real batch_path(const uint32_t *at, int32_t nodes,
                                         const double *restrict q, int p, batch_real *b) {
  batch_real sum = {0}, zero = {0};
  b[0] = b[1] = zero;
  for (int32_t k = 0; k + 1 < nodes; k++) {
    batch_real x = batch_row(q, at[k + 1], p) - batch_row(q, at[k], p),
               y = batch_row(q, at[k + 1] + 1, p) - batch_row(q, at[k] + 1, p);
    batch_real length = batch_root(x * x + y * y);
    batch_real inverse = batch_choose(length > zero, 1.0 / length, zero);
    sum += length;
    x *= inverse, y *= inverse;
    b[2 * k] -= x, b[2 * k + 1] -= y;
    b[2 * k + 2] = zero + x, b[2 * k + 3] = zero + y;
  }
  return sum;
}

/* See strut_strain_angle. */
STRUT_BATCH_INLINE batch_real batch_angle(const uint32_t *at, const double *restrict q, int p,
                                          batch_real reference, batch_real *b) {
  batch_real zero = {0}, ox = batch_row(q, at[1], p), oy = batch_row(q, at[1] + 1, p);
  batch_real ux = batch_row(q, at[0], p) - ox, uy = batch_row(q, at[0] + 1, p) - oy;
  batch_real vx = batch_row(q, at[2], p) - ox, vy = batch_row(q, at[2] + 1, p) - oy;
  batch_real u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy;
  batch_real iu = batch_choose(u2 > zero, 1.0 / u2, zero),
             iv = batch_choose(v2 > zero, 1.0 / v2, zero);
  b[0] = iu * uy, b[1] = -iu * ux;
  b[4] = -iv * vy, b[5] = iv * vx;
  b[2] = -b[0] - b[4], b[3] = -b[1] - b[5];
  return batch_direction_near(batch_direction_of(ux * vx + uy * vy, ux * vy - uy * vx), reference);
}

/* strut_batch_takes_model lists the strains that lanes have. */
STRUT_BATCH_INLINE batch_real batch_strain(const strut_batch_tables *t, int32_t i,
                                           const double *restrict q, int p, batch_real *b) {
  const strut_element_table *table = &t->first->elements;
  const strut_element *e = &table->element[i];
  const uint32_t *at = table->at + e->first;
  if (e->strain == STRUT_STRAIN_ANGLE)
    return batch_angle(at, q, p, batch_row(t->elements.turn, (size_t)i, p), b);
  return batch_path(at, e->nodes, q, p, b);
}

/* What an element's law is asked and answers, dampers included. */
typedef struct batch_element {
  batch_real stretch, own_rate,
      rest_rate;                     /* beyond the natural strain; its rate; that of the latter */
  batch_real elastic, force, excess; /* as of strut_law_response; force: with the damper */
} batch_element;

STRUT_BATCH_INLINE void batch_respond(const strut_batch_tables *t, int32_t i, int p,
                                      batch_real strain, batch_real natural, batch_element *x) {
  const strut_element *e = &t->first->elements.element[i];
  batch_real zero = {0};
  x->elastic = batch_row(t->elements.stiffness, (size_t)i, p) * x->stretch;
  x->excess = zero;
  if (e->law == STRUT_LAW_LINEAR) return;
  for (int l = 0; l < BATCH_WIDTH; l++) {
    const strut_model *m = t->model[p * BATCH_WIDTH + l];
    int piece = (int)batch_row(t->elements.piece, (size_t)i, p)[l];
    strut_law_response r =
        strut_law_respond(e->law, &m->elements.element[i].numbers, strain[l], natural[l], piece);
    x->elastic[l] = r.force, x->excess[l] = r.excess;
  }
}

/* Element i as if it acted; b: its gradient. rated: whether its rate matters. */
STRUT_BATCH_INLINE batch_element batch_element_move(const strut_batch_tables *t, int32_t i, int p,
                                                    batch_real strain, const batch_real *b,
                                                    const double *restrict v, bool rated) {
  const strut_element_table *table = &t->first->elements;
  const strut_element *e = &table->element[i];
  const uint32_t *at = table->at + e->first;
  size_t slot = (size_t)(e->slot >= 0 ? e->slot : i);
  batch_real zero = {0}, rate = zero;
  batch_real natural = batch_row(e->slot >= 0 ? t->members.rest : t->elements.natural, slot, p);
  batch_element x = {.stretch = strain - natural,
                     .rest_rate = e->slot >= 0 ? batch_row(t->members.rest_rate, slot, p) : zero};
  for (int32_t k = 0; k < e->nodes && rated; k++)
    rate += b[2 * k] * batch_row(v, at[k], p) + b[2 * k + 1] * batch_row(v, at[k] + 1, p);
  x.own_rate = rate - x.rest_rate;
  batch_respond(t, i, p, strain, natural, &x);
  x.force = x.elastic + batch_row(t->elements.damping, (size_t)i, p) * x.own_rate;
  return x;
}

/* One-sided: it acts in the mode that is frozen, or where strain and force say so; see `exert`. */
STRUT_BATCH_INLINE void batch_carry(const strut_batch_tables *t, int32_t i, int p,
                                    batch_element *x) {
  int8_t carries = t->first->elements.element[i].carries;
  if (!carries) return;
  batch_real zero = {0}, mode = batch_row(t->elements.acts, (size_t)i, p), sign = zero + carries;
  batch_mask beyond = sign * x->stretch > zero, free = mode == zero;
  batch_mask acts = (mode > zero) | (free & beyond & (sign * x->force > zero));
  x->force = batch_choose(acts, x->force, zero);
  x->elastic = batch_choose(acts | beyond, x->elastic, zero);
  x->excess = batch_choose(acts | beyond, x->excess, zero);
}

STRUT_BATCH_INLINE void batch_add_element(strut_batch_tables *t, int32_t i, int p,
                                          const double *restrict q, const double *restrict v,
                                          bool balance, batch_member_powers *powers) {
  const strut_element_table *table = &t->first->elements;
  const strut_element *e = &table->element[i];
  const uint32_t *at = table->at + e->first;
  batch_real b[STRUT_MOST_GRADIENT], strain = batch_strain(t, i, q, p, b);
  batch_put(t->elements.turn, (size_t)i, p, strain);
  batch_element x = batch_element_move(t, i, p, strain, b, v, balance || e->damping > 0.0);
  batch_carry(t, i, p, &x);
  for (int32_t k = 0; k < e->nodes; k++) {
    batch_put(t->force, at[k], p, batch_row(t->force, at[k], p) - x.force * b[2 * k]);
    batch_put(t->force, at[k] + 1, p, batch_row(t->force, at[k] + 1, p) - x.force * b[2 * k + 1]);
  }
  if (!balance) return;
  batch_real drive = (x.excess - x.force) * x.rest_rate, lost = (x.force - x.elastic) * x.own_rate;
  powers->drive += drive, powers->lost += lost;
  powers->exchanged += batch_magnitude(drive) + lost;
}

STRUT_BATCH_INLINE void batch_add_powers(strut_batch_tables *t, int p,
                                         const batch_member_powers *powers) {
  double *power = t->power;
  batch_put(power, STRUT_POWER_DRIVE, p, batch_row(power, STRUT_POWER_DRIVE, p) + powers->drive);
  batch_put(power, STRUT_POWER_MEMBERS, p, batch_row(power, STRUT_POWER_MEMBERS, p) + powers->lost);
  batch_put(power, STRUT_POWER_EXCHANGED, p,
            batch_row(power, STRUT_POWER_EXCHANGED, p) + powers->exchanged);
}

/* Of plain linear hinges a single run sums powers place by place within groups, of others one by one. */
STRUT_BATCH_INLINE void batch_element_block(strut_batch_tables *t, const strut_element_block *block,
                                            int p, const double *restrict q,
                                            const double *restrict v, bool balance) {
  batch_real zero = {0};
  batch_member_powers none = {.drive = zero, .exchanged = zero, .lost = zero}, group[STRUT_LANES];
  bool grouped =
      block->strain == STRUT_STRAIN_ANGLE && block->law == STRUT_LAW_LINEAR && block->both_signs;
  int32_t i = block->begin, end = grouped ? i + (block->end - i) / STRUT_LANES * STRUT_LANES : i;
  for (int l = 0; l < STRUT_LANES; l++) group[l] = none;
  for (; i < end; i++)
    batch_add_element(t, i, p, q, v, balance, &group[(i - block->begin) % STRUT_LANES]);
  for (int l = 0; l < STRUT_LANES && grouped && balance; l++) batch_add_powers(t, p, &group[l]);
  for (; i < block->end; i++) {
    batch_member_powers one = none;
    batch_add_element(t, i, p, q, v, balance, &one);
    if (balance) batch_add_powers(t, p, &one);
  }
}

/* All elements; see strut_elements_add_forces. */
STRUT_BATCH_INLINE void batch_elements(strut_batch_tables *t, const double *restrict q,
                                       const double *restrict v, bool balance) {
  const strut_element_table *table = &t->first->elements;
  for (int32_t b = 0; b < table->block_count; b++)
    BATCH_EACH(batch_element_block(t, &table->block[b], p, q, v, balance));
}

#endif
