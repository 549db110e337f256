/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Semi-implicit (symplectic) Euler with a fixed step: v += h a(q, v), q += h v. Of first order, and
 * the cheapest step there is.
 */
#include "engine/forces/history.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/plain_steps.h"

static void *euler_create(const strut_model *model, strut_state *state,
                          const strut_integrator_settings *settings) {
  (void)settings;
  return strut_arena_allocate(&state->arena, (size_t)model->length, sizeof(double));
}

/* Powers enter the works as they are at the begin of a step. */
STRUT_INLINE void run_steps(const strut_model *model, strut_state *state, double *restrict a,
                            double dt, int64_t count, unsigned terms, bool balance) {
  double *restrict q = state->q, *restrict v = state->v;
  bool moves = model->terms & terms & STRUT_TERMS_AT_STEP_END;
  strut_drives_ahead drives;
  drives_ahead_begin(model, terms, &drives);
  for (int64_t end = state->step + count; state->step < end; state->step++) {
    double step = (double)state->step, t = step * dt;
    drives_ahead_apply(model, state, &drives, t, step, 1.0, dt, end - state->step);
    forces_kernel(model, state, t, q, v, a, terms, balance);
    for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
      state->work[p] += dt * state->latest.power[p];
    for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
      strut_lanes next = strut_lanes_load(v + i) + dt * strut_lanes_load_pairs(a + i);
      strut_lanes_store(v + i, next);
      strut_lanes_store(q + i, strut_lanes_load(q + i) + dt * next);
    }
    if (moves) end_moving_step(model, state, dt);
    if (model->terms & terms & STRUT_TERM_MEMORY)
      strut_history_renew(model, state, ((double)state->step + 1.0) * dt);
  }
}

STRUT_PLAIN_STEPS(euler, double, run_steps)

static void euler_advance(const strut_model *model, strut_state *state, void *workspace, double dt,
                          int64_t count) {
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
