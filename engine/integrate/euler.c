/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Semi-implicit (symplectic) Euler with a fixed step: v += h a(q, v), q += h v. Of first order, and
 * the cheapest step there is.
 */
#include "engine/forces/forces_kernel.h"
#include "engine/integrate/integrator.h"

static void *euler_create(const strut_model *model, strut_state *state) {
  return strut_arena_allocate(&state->arena, (size_t)model->length, sizeof(double));
}

/* Powers enter the works as they are at the begin of a step. */
STRUT_INLINE void run_steps(const strut_model *model, strut_state *state, double *restrict a,
                            double dt, int64_t count, bool ledger) {
  double *restrict q = state->q, *restrict v = state->v;
  for (int64_t end = state->step + count; state->step < end; state->step++) {
    forces_kernel(model, state, (double)state->step * dt, q, v, a, ledger);
    for (int p = 0; p < STRUT_POWER_COUNT && ledger; p++) state->work[p] += dt * state->power[p];
    for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
      strut_lanes next = strut_lanes_load(v + i) + dt * strut_lanes_load_pairs(a + i);
      strut_lanes_store(v + i, next);
      strut_lanes_store(q + i, strut_lanes_load(q + i) + dt * next);
    }
  }
}

STRUT_CLONES
static void euler_plain(const strut_model *model, strut_state *state, double *a, double dt,
                        int64_t count) {
  run_steps(model, state, a, dt, count, false);
}

STRUT_CLONES
static void euler_with_ledger(const strut_model *model, strut_state *state, double *a, double dt,
                              int64_t count) {
  run_steps(model, state, a, dt, count, true);
}

static void euler_advance(const strut_model *model, strut_state *state, void *workspace, double dt,
                          int64_t count) {
  if (state->ledger)
    euler_with_ledger(model, state, workspace, dt, count);
  else
    euler_plain(model, state, workspace, dt, count);
}

const strut_integrator strut_integrator_euler = {
    .name = "euler",
    .description = "semi-implicit Euler, fixed step",
    .order = 1,
    .evaluations = 1,
    .region = STRUT_REGION_EULER,
    .create = euler_create,
    .advance = euler_advance,
};
