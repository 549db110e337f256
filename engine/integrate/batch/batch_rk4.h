/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the classical Runge-Kutta method for all lanes of a batch; see rk4.c, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_BATCH_BATCH_RK4_H
#define STRUT_ENGINE_INTEGRATE_BATCH_BATCH_RK4_H

#include "engine/forces/batch_kernel.h"
#include "engine/integrate/batch/batch.h"
#include "engine/integrate/rk4_stages.h"

/* Positions and velocities of the next stage: q + h v, v0 + h a. */
STRUT_BATCH_INLINE void batch_stage(size_t n, double ahead, const batch_real *dt,
                                    const double *restrict q0, const double *restrict v0,
                                    const double *restrict v, const double *restrict a,
                                    double *restrict q, double *restrict next) {
  for (size_t i = 0; i < n; i++) {
    BATCH_EACH(batch_put(q, i, p,
                         batch_rk4_stage(batch_row(q0, i, p), ahead * dt[p], batch_row(v, i, p))));
    BATCH_EACH(batch_put(next, i, p,
                         batch_rk4_stage(batch_row(v0, i, p), ahead * dt[p], batch_row(a, i, p))));
  }
}

/* z += h/6 (k1 + 2 (k2 + k3) + k4) */
STRUT_BATCH_INLINE void batch_combine_row(size_t i, int p, batch_real sixth, double *restrict z,
                                          const double *k1, const double *restrict k2,
                                          const double *restrict k3, const double *restrict k4) {
  batch_put(z, i, p,
            batch_rk4_end(batch_row(z, i, p), sixth, batch_row(k1, i, p),
                          batch_row(k2, i, p) + batch_row(k3, i, p), batch_row(k4, i, p)));
}

STRUT_BATCH_INLINE void batch_combine(size_t n, const batch_real *sixth, double *restrict z,
                                      const double *k1, const double *restrict k2,
                                      const double *restrict k3, const double *restrict k4) {
  for (size_t i = 0; i < n; i++) BATCH_EACH(batch_combine_row(i, p, sixth[p], z, k1, k2, k3, k4));
}

/* Powers other than those of members and contacts enter the works with the stage's weight. */
STRUT_BATCH_INLINE void batch_work(const strut_batch *b, const double *power, double weight,
                                   const batch_real *sixth) {
  for (size_t k = 0; k < STRUT_BATCH_POWERS; k++)
    BATCH_EACH(batch_put(b->work, k, p,
                         batch_row(b->work, k, p) + weight * sixth[p] * batch_row(power, k, p)));
}

STRUT_BATCH_INLINE void batch_rk4_steps(strut_batch *b, int64_t count, bool balance) {
  const double *ahead = STRUT_RK4_AHEAD, *weight = STRUT_RK4_WEIGHTS;
  /* a copy in this frame, so that no store can be taken to change it */
  strut_batch_tables tables = b->tables;
  double *restrict q = b->q, *restrict v = b->v;
  const double *const at[4] = {q, b->stage_q, b->stage_q, b->stage_q};
  const double *const speed[4] = {v, b->stage_v[1], b->stage_v[2], b->stage_v[3]};
  size_t n = 2 * (size_t)tables.first->node_count;
  batch_real dt[BATCH_PARTS], step[BATCH_PARTS], sixth[BATCH_PARTS];
  BATCH_EACH(
      (dt[p] = batch_row(b->dt, 0, p), step[p] = batch_row(b->step, 0, p), sixth[p] = dt[p] / 6.0));
  bool others = balance && tables.first->terms & (STRUT_TERM_LOADS | STRUT_TERM_ELEMENTS);
  const strut_contact_table *contacts = &tables.first->contacts;
  bool moves = false;
  BATCH_EACH(moves |= batch_some(batch_row(tables.ground.line, STRUT_BATCH_BELT, p) != 0.0));
  batch_step_sums sums;
  if (balance) batch_clear_sums(&sums);
  for (size_t k = 0; k < STRUT_BATCH_POWERS && balance; k++) /* accumulated ones are not here */
    BATCH_EACH(batch_put(tables.power, k, p, (batch_real){0}));
  if (!b->driven) batch_drive(&tables, step, 0.0, dt);
  for (; count > 0; count--) {
    if (balance) batch_begin_sums(contacts, moves, &sums);
    for (int k = 0; k < 4; k++) {
      /* stages 1 and 3 are at the times of the ones before */
      if (k == 1 || k == 3) batch_drive(&tables, step, ahead[k], dt);
      batch_sums stage = batch_sums_of_stage(&sums, k, moves);
      batch_forces(&tables, at[k], speed[k], balance ? &stage : NULL);
      batch_mass(&tables, b->a[k]);
      if (others) batch_work(b, tables.power, weight[k], sixth);
      if (k < 3)
        batch_stage(n, ahead[k + 1], dt, q, v, speed[k], b->a[k], b->stage_q, b->stage_v[k + 1]);
    }
    if (balance) BATCH_EACH(batch_end_sums(tables.first, &sums, p, moves, sixth[p], b->work));
    batch_combine(n, sixth, q, v, b->stage_v[1], b->stage_v[2], b->stage_v[3]);
    batch_combine(n, sixth, v, b->a[0], b->a[1], b->a[2], b->a[3]);
    BATCH_EACH((step[p] += 1.0));
  }
  BATCH_EACH(batch_put(b->step, 0, p, step[p]));
}

STRUT_BATCH_TARGET
static void batch_rk4_plain(strut_batch *batch, int64_t count) {
  batch_rk4_steps(batch, count, false);
}

STRUT_BATCH_TARGET
static void batch_rk4_with_balance(strut_batch *batch, int64_t count) {
  batch_rk4_steps(batch, count, true);
}

static inline void batch_rk4(strut_batch *batch, int64_t count) {
  if (batch->balance)
    batch_rk4_with_balance(batch, count);
  else
    batch_rk4_plain(batch, count);
}

#endif
