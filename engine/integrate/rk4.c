/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The classical Runge-Kutta method with a fixed step, as in the paper: forces at every stage. */
#include "engine/forces/history.h"
#include "engine/forces/rigid.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/plain_steps.h"

/* Stage values, (length) each: positions now, velocities of stages 2 to 4, accelerations of all. */
typedef struct rk4_workspace {
  double *q, *v[4], *a[4]; /* v[0] is unused: the first stage's is the state's own */
} rk4_workspace;

static void *rk4_create(const strut_model *model, strut_state *state,
                        const strut_integrator_settings *settings) {
  (void)settings;
  rk4_workspace *self = strut_arena_allocate(&state->arena, 1, sizeof *self);
  if ((model->terms & STRUT_TERM_RIGID) && !strut_rigid_create(model, state)) return NULL;
  bool ready =
      self && STRUT_NUMBERS(&state->arena, model->length, &self->q, &self->v[1], &self->v[2],
                            &self->v[3], &self->a[0], &self->a[1], &self->a[2], &self->a[3]);
  return ready ? self : NULL;
}

/*
 * The step as a loop over its stages, so that the forces stand in it once. Times are n dt, (n + 1/2) dt and
 * (n + 1) dt, never sums. With the energy balance the powers enter the works with the stage's weight: those
 * of members and of level ground once for the whole step, see forces_kernel.h, all others stage by stage.
 */
STRUT_INLINE void run_steps(const strut_model *model, strut_state *state, rk4_workspace *self,
                            double dt, int64_t count, unsigned terms, bool balance, bool rigid) {
  const double *ahead = STRUT_RK4_AHEAD, *weight = STRUT_RK4_WEIGHTS;
  strut_accumulation accumulation = balance ? STRUT_ACCUMULATE_LANES : STRUT_ACCUMULATE_NOTHING;
  double *restrict q = state->q, *restrict v = state->v;
  const double *const at[4] = {q, self->q, self->q, self->q};
  const double *const speed[4] = {v, self->v[1], self->v[2], self->v[3]};
  int32_t n = model->length;
  bool moves = model->terms & terms & STRUT_TERMS_AT_STEP_END;
  bool others = balance && model->terms & terms & ~STRUT_TERMS_IN_LANES;
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++) state->latest->power[p] = 0.0;
  for (int64_t end = state->step + count; state->step < end; state->step++) {
    if (balance) strut_step_balance_begin(model, state);
    for (int k = 0; k < 4; k++) {
      if (balance) state->latest->accumulated = &state->latest->lanes[strut_weight_side(k)];
      double t = ((double)state->step + ahead[k]) * dt;
      forces_kernel(model, state, t, at[k], speed[k], self->a[k], terms, accumulation);
      if (rigid) strut_rigid_accelerate(model, state, at[k], speed[k], self->a[k]);
      for (int p = 0; p < STRUT_POWER_COUNT && others; p++)
        state->work[p] += weight[k] * (dt / 6.0) * state->latest->power[p];
      if (k == 3) break;
      rk4_next_stage(n, ahead[k + 1] * dt, q, v, speed[k], self->a[k], self->q, self->v[k + 1]);
      if (moves)
        strut_support_motion_place(model, state, ((double)state->step + ahead[k + 1]) * dt, self->q,
                                   self->v[k + 1]);
    }
    if (balance) strut_step_balance_end(model, state, dt / 6.0);
    rk4_end_of_step(n, dt, q, v, self->v[1], self->v[2], self->v[3], q);
    rk4_end_of_step(n, dt, v, self->a[0], self->a[1], self->a[2], self->a[3], v);
    if (moves) end_moving_step(model, state, dt);
    if (rigid) strut_rigid_project(model, state, q, v);
    if (model->terms & STRUT_TERM_ELEMENTS) strut_elements_keep_turns(model, state);
    if (model->terms & terms & STRUT_TERM_MEMORY)
      strut_history_renew(model, state, ((double)state->step + 1.0) * dt);
  }
}

STRUT_INLINE void run_elastic(const strut_model *model, strut_state *state, rk4_workspace *self,
                              double dt, int64_t count, unsigned terms, bool balance) {
  run_steps(model, state, self, dt, count, terms, balance, false);
}

STRUT_PLAIN_STEPS(rk4, rk4_workspace, run_elastic)

STRUT_CLONES
static void rk4_rigid(const strut_model *model, strut_state *state, rk4_workspace *w, double dt,
                      int64_t count) {
  run_steps(model, state, w, dt, count, STRUT_TERMS_ALL, state->balance, true);
}

static void rk4_advance(const strut_model *model, strut_state *state, void *workspace, double dt,
                        int64_t count) {
  if (state->rigid)
    rk4_rigid(model, state, workspace, dt, count);
  else
    rk4_plain(model, state, workspace, dt, count);
}

/* Rigid bars keep the lengths they have here. */
static void rk4_restart(const strut_model *model, strut_state *state, void *workspace, double dt) {
  (void)workspace, (void)dt;
  if (state->rigid) strut_rigid_begin(model, state);
}

const strut_integrator strut_integrator_rk4 = {
    .name = "rk4",
    .description = "classical Runge-Kutta, fixed step, forces at every stage",
    .order = 4,
    .lag = 1.0 / 120.0,
    .evaluations = 4,
    .region = STRUT_REGION_RK4,
    .role = STRUT_ROLE_PLAIN,
    .rigid = true,
    .create = rk4_create,
    .restart = rk4_restart,
    .advance = rk4_advance,
};
