/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symplectic methods with a fixed step: semi-implicit Euler, and velocity Verlet. */
#include "engine/forces/history.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/plain_steps.h"

/* Semi-implicit (symplectic) Euler: v += h a(q, v), q += h v. Of first order, the cheapest step there is. */

static void *euler_create(const strut_model *model, strut_state *state,
                          const strut_integrator_settings *settings) {
  (void)settings;
  return strut_arena_allocate(&state->arena, (size_t)model->length, sizeof(double));
}

/* Powers enter the works as they are at the begin of a step. */
STRUT_INLINE void euler_steps(const strut_model *model, strut_state *state,
                              double *restrict acceleration, double dt, int64_t count,
                              unsigned terms, bool balance) {
  double *restrict q = state->q, *restrict v = state->v;
  bool moves = model->terms & terms & STRUT_TERMS_AT_STEP_END;
  for (int64_t end = state->step + count; state->step < end; state->step++) {
    double t = (double)state->step * dt;
    forces_kernel(model, state, t, q, v, acceleration, terms, balance);
    for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
      state->work[p] += dt * state->latest->power[p];
    for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
      strut_lanes next = strut_lanes_load(v + i) + dt * strut_lanes_load_pairs(acceleration + i);
      strut_lanes_store(v + i, next);
      strut_lanes_store(q + i, strut_lanes_load(q + i) + dt * next);
    }
    if (moves) end_moving_step(model, state, dt);
    if (model->terms & STRUT_TERM_ELEMENTS) strut_elements_keep_turns(model, state);
    if (model->terms & terms & STRUT_TERM_MEMORY)
      strut_history_renew(model, state, ((double)state->step + 1.0) * dt);
  }
}

STRUT_PLAIN_STEPS(euler, double, euler_steps)

static void euler_advance(const strut_model *model, strut_state *state, void *workspace, double dt,
                          int64_t count) {
  euler_plain(model, state, workspace, dt, count);
}

const strut_integrator strut_integrator_euler = {
    .name = "euler",
    .description = "semi-implicit Euler, fixed step",
    .order = 1,
    .lag = 1.0 / 24.0,
    .evaluations = 1,
    .region = STRUT_REGION_EULER,
    .create = euler_create,
    .advance = euler_advance,
};

/* Velocity Verlet with a fixed step; forces see the predicted velocity v + h a, which keeps the second order. */

/* Accelerations at both ends of a step, predicted velocities, and the powers at its begin. */
typedef struct verlet_workspace {
  double *a, *next, *predicted;
  double power[STRUT_POWER_ROOM];
  bool started;
} verlet_workspace;

static void *verlet_create(const strut_model *model, strut_state *state,
                           const strut_integrator_settings *settings) {
  (void)settings;
  verlet_workspace *self = strut_arena_allocate(&state->arena, 1, sizeof *self);
  bool ready =
      self && STRUT_NUMBERS(&state->arena, model->length, &self->a, &self->next, &self->predicted);
  return ready ? self : NULL;
}

static void verlet_restart(const strut_model *model, strut_state *state, void *workspace,
                           double dt) {
  verlet_workspace *self = workspace;
  strut_forces_acceleration(model, state, (double)state->step * dt, state->q, state->v, self->a);
  for (int p = 0; p < STRUT_POWER_COUNT; p++) self->power[p] = state->latest->power[p];
  self->started = true;
}

STRUT_INLINE void verlet_steps(const strut_model *model, strut_state *state, verlet_workspace *self,
                               double dt, int64_t count, unsigned terms, bool balance) {
  double *restrict q = state->q, *restrict v = state->v, *restrict predicted = self->predicted;
  double half = 0.5 * dt;
  int32_t n = model->length;
  bool moves = model->terms & terms & STRUT_TERMS_AT_STEP_END;
  for (int64_t end = state->step + count; state->step < end; state->step++) {
    double *a = self->a, *next = self->next;
    for (int32_t i = 0; i < n; i += STRUT_LANES) {
      strut_lanes rate = strut_lanes_load(v + i), bend = strut_lanes_load_pairs(a + i);
      strut_lanes_store(q + i, strut_lanes_load(q + i) + dt * (rate + half * bend));
      strut_lanes_store(predicted + i, rate + dt * bend);
    }
    double t = ((double)state->step + 1.0) * dt;
    if (moves) strut_support_motion_place(model, state, t, q, predicted);
    forces_kernel(model, state, t, q, predicted, next, terms, balance);
    for (int32_t i = 0; i < n; i += STRUT_LANES)
      strut_lanes_store(v + i, strut_lanes_load(v + i) + half * (strut_lanes_load(a + i) +
                                                                 strut_lanes_load_pairs(next + i)));
    if (moves) end_moving_step(model, state, dt);
    if (model->terms & STRUT_TERM_ELEMENTS) strut_elements_keep_turns(model, state);
    for (int p = 0; p < STRUT_POWER_COUNT && balance; p++) {
      state->work[p] += half * (self->power[p] + state->latest->power[p]);
      self->power[p] = state->latest->power[p];
    }
    self->a = next, self->next = a;
    if (model->terms & terms & STRUT_TERM_MEMORY && strut_history_renew(model, state, t)) {
      forces_kernel(model, state, t, q, v, self->a, terms, balance);
      for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
        self->power[p] = state->latest->power[p];
    }
  }
}

STRUT_PLAIN_STEPS(verlet, verlet_workspace, verlet_steps)

static void verlet_advance(const strut_model *model, strut_state *state, void *workspace, double dt,
                           int64_t count) {
  verlet_workspace *self = workspace;
  if (!self->started) verlet_restart(model, state, workspace, dt);
  verlet_plain(model, state, self, dt, count);
}

const strut_integrator strut_integrator_verlet = {
    .name = "verlet",
    .description = "velocity Verlet, fixed step",
    .order = 2,
    .lag = 1.0 / 24.0,
    .evaluations = 1,
    .region = STRUT_REGION_VERLET,
    .create = verlet_create,
    .restart = verlet_restart,
    .advance = verlet_advance,
};
