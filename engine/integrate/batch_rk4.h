/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the classical Runge-Kutta method for all lanes of a batch; see rk4.c, whose operations these are.
 */
#ifndef STRUT_ENGINE_INTEGRATE_BATCH_RK4_H
#define STRUT_ENGINE_INTEGRATE_BATCH_RK4_H

#include "engine/forces/lane_kernel.h"
#include "engine/integrate/batch.h"

/* Positions and velocities of the next stage: q + h v, v0 + h a. */
STRUT_LANE_INLINE void batch_stage(size_t n, lane_real h, const double *restrict q0,
                                   const double *restrict v0, const double *restrict v,
                                   const double *restrict a, double *restrict q,
                                   double *restrict next) {
  for (size_t i = 0; i < n; i++) {
    lane_put(q, i, lane_row(q0, i) + h * lane_row(v, i));
    lane_put(next, i, lane_row(v0, i) + h * lane_row(a, i));
  }
}

/* z += h/6 (k1 + 2 (k2 + k3) + k4) */
STRUT_LANE_INLINE void batch_combine(size_t n, lane_real sixth, double *restrict z,
                                     const double *k1, const double *restrict k2,
                                     const double *restrict k3, const double *restrict k4) {
  for (size_t i = 0; i < n; i++) {
    lane_real inner = lane_row(k2, i) + lane_row(k3, i);
    lane_real sum = lane_row(k1, i) + 2.0 * inner + lane_row(k4, i);
    lane_put(z, i, lane_row(z, i) + sixth * sum);
  }
}

STRUT_LANE_INLINE void batch_rk4_steps(strut_batch *b, int64_t count, bool ledger) {
  static const double ahead[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1, 2, 2, 1};
  /* a copy in this frame, so that no store can be taken to change it */
  strut_lane_tables tables = b->tables;
  double *restrict q = b->q, *restrict v = b->v;
  const double *const at[4] = {q, b->stage_q, b->stage_q, b->stage_q};
  const double *const speed[4] = {v, b->stage_v[1], b->stage_v[2], b->stage_v[3]};
  size_t n = 2 * (size_t)tables.first->node_count;
  lane_real dt = lane_load(b->dt), step = lane_load(b->step), sixth = dt / 6.0;
  if (!b->driven) lane_drive(&tables, step * dt);
  for (; count > 0; count--, step += 1.0) {
    for (int k = 0; k < 4; k++) {
      /* stages 1 and 3 are at the times of the ones before */
      if (k == 1 || k == 3) lane_drive(&tables, (step + ahead[k]) * dt);
      lane_forces(&tables, at[k], speed[k], ledger);
      lane_mass(&tables, b->a[k]);
      for (size_t p = 0; p < STRUT_POWER_COUNT && ledger; p++)
        lane_put(b->work, p, lane_row(b->work, p) + weight[k] * sixth * lane_row(tables.power, p));
      if (k < 3)
        batch_stage(n, ahead[k + 1] * dt, q, v, speed[k], b->a[k], b->stage_q, b->stage_v[k + 1]);
    }
    batch_combine(n, sixth, q, v, b->stage_v[1], b->stage_v[2], b->stage_v[3]);
    batch_combine(n, sixth, v, b->a[0], b->a[1], b->a[2], b->a[3]);
  }
  lane_store(b->step, step);
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
