/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the classical Runge-Kutta method for all lanes of a batch; see rk4.c, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LANES_BATCH_RK4_H
#define STRUT_ENGINE_INTEGRATE_LANES_BATCH_RK4_H

#include "engine/forces/lane_kernel.h"
#include "engine/integrate/lanes/batch.h"
#include "engine/integrate/rk4_stages.h"

/* Positions and velocities of the next stage: q + h v, v0 + h a. */
STRUT_LANE_INLINE void batch_stage(size_t n, double ahead, const lane_real *dt,
                                   const double *restrict q0, const double *restrict v0,
                                   const double *restrict v, const double *restrict a,
                                   double *restrict q, double *restrict next) {
  for (size_t i = 0; i < n; i++) {
    LANE_EACH(
        lane_put(q, i, p, lane_rk4_stage(lane_row(q0, i, p), ahead * dt[p], lane_row(v, i, p))));
    LANE_EACH(
        lane_put(next, i, p, lane_rk4_stage(lane_row(v0, i, p), ahead * dt[p], lane_row(a, i, p))));
  }
}

/* z += h/6 (k1 + 2 (k2 + k3) + k4) */
STRUT_LANE_INLINE void batch_combine_row(size_t i, int p, lane_real sixth, double *restrict z,
                                         const double *k1, const double *restrict k2,
                                         const double *restrict k3, const double *restrict k4) {
  lane_put(z, i, p,
           lane_rk4_end(lane_row(z, i, p), sixth, lane_row(k1, i, p),
                        lane_row(k2, i, p) + lane_row(k3, i, p), lane_row(k4, i, p)));
}

STRUT_LANE_INLINE void batch_combine(size_t n, const lane_real *sixth, double *restrict z,
                                     const double *k1, const double *restrict k2,
                                     const double *restrict k3, const double *restrict k4) {
  for (size_t i = 0; i < n; i++) LANE_EACH(batch_combine_row(i, p, sixth[p], z, k1, k2, k3, k4));
}

/* Powers other than those of members and contacts enter the works with the stage's weight. */
STRUT_LANE_INLINE void batch_work(const strut_batch *b, const double *power, double weight,
                                  const lane_real *sixth) {
  for (size_t k = 0; k < STRUT_LANE_POWERS; k++)
    LANE_EACH(lane_put(b->work, k, p,
                       lane_row(b->work, k, p) + weight * sixth[p] * lane_row(power, k, p)));
}

STRUT_LANE_INLINE void batch_rk4_steps(strut_batch *b, int64_t count, bool ledger) {
  const double *ahead = STRUT_RK4_AHEAD, *weight = STRUT_RK4_WEIGHTS;
  /* a copy in this frame, so that no store can be taken to change it */
  strut_lane_tables tables = b->tables;
  double *restrict q = b->q, *restrict v = b->v;
  const double *const at[4] = {q, b->stage_q, b->stage_q, b->stage_q};
  const double *const speed[4] = {v, b->stage_v[1], b->stage_v[2], b->stage_v[3]};
  size_t n = 2 * (size_t)tables.first->node_count;
  lane_real dt[LANE_PARTS], step[LANE_PARTS], sixth[LANE_PARTS];
  LANE_EACH(
      (dt[p] = lane_row(b->dt, 0, p), step[p] = lane_row(b->step, 0, p), sixth[p] = dt[p] / 6.0));
  bool others = ledger && tables.first->plan & (STRUT_TERM_LOADS | STRUT_TERM_ELEMENTS);
  const strut_contact_table *contacts = &tables.first->contacts;
  bool moves = false;
  LANE_EACH(moves |= lane_some(lane_row(tables.ground, STRUT_LANE_BELT, p) != 0.0));
  lane_step_sums sums;
  if (ledger) lane_clear_sums(&sums);
  for (size_t k = 0; k < STRUT_LANE_POWERS && ledger; k++) /* booked ones are not here */
    LANE_EACH(lane_put(tables.power, k, p, (lane_real){0}));
  if (!b->driven) lane_drive(&tables, step, 0.0, dt);
  for (; count > 0; count--) {
    if (ledger) lane_begin_sums(contacts, moves, &sums);
    for (int k = 0; k < 4; k++) {
      /* stages 1 and 3 are at the times of the ones before */
      if (k == 1 || k == 3) lane_drive(&tables, step, ahead[k], dt);
      lane_book book = lane_book_of_stage(&sums, k, moves);
      lane_forces(&tables, at[k], speed[k], ledger ? &book : NULL);
      lane_mass(&tables, b->a[k]);
      if (others) batch_work(b, tables.power, weight[k], sixth);
      if (k < 3)
        batch_stage(n, ahead[k + 1], dt, q, v, speed[k], b->a[k], b->stage_q, b->stage_v[k + 1]);
    }
    if (ledger) LANE_EACH(lane_end_sums(tables.first, &sums, p, moves, sixth[p], b->work));
    batch_combine(n, sixth, q, v, b->stage_v[1], b->stage_v[2], b->stage_v[3]);
    batch_combine(n, sixth, v, b->a[0], b->a[1], b->a[2], b->a[3]);
    LANE_EACH((step[p] += 1.0));
  }
  LANE_EACH(lane_put(b->step, 0, p, step[p]));
}

STRUT_LANE_TARGET
static void batch_rk4_plain(strut_batch *batch, int64_t count) {
  batch_rk4_steps(batch, count, false);
}

STRUT_LANE_TARGET
static void batch_rk4_with_ledger(strut_batch *batch, int64_t count) {
  batch_rk4_steps(batch, count, true);
}

static inline void batch_rk4(strut_batch *batch, int64_t count) {
  if (batch->ledger)
    batch_rk4_with_ledger(batch, count);
  else
    batch_rk4_plain(batch, count);
}

#endif
