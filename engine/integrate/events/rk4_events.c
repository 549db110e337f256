/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The classical Runge-Kutta method between events: each step within one smooth set of modes, so
 * that the fourth order holds through contact, friction and slack cables.
 */
#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/integrator.h"
#include "engine/integrate/plain_steps.h"

/* Positions, then velocities and accelerations of the stages 2 to 4. */
enum { Q, V, A = V + 3, STAGES = A + 3 };

STRUT_INLINE void gain(const strut_state *state, strut_event_stepper *stepper, double weight) {
  for (int p = 0; p < STRUT_POWER_COUNT; p++)
    stepper->gained[p] += weight * state->latest->power[p];
}

STRUT_INLINE void take(const strut_model *model, const strut_state *state,
                       strut_event_stepper *stepper, double t, double h, unsigned terms,
                       bool balance) {
  const double *ahead = STRUT_RK4_AHEAD, *weight = STRUT_RK4_WEIGHTS;
  double **w = stepper->stage;
  const double *const v[4] = {stepper->now->v, w[V], w[V + 1], w[V + 2]};
  double *const a[4] = {stepper->now->a, w[A], w[A + 1], w[A + 2]};
  int32_t n = model->length;
  bool moves = model->terms & terms & STRUT_TERM_SUPPORT_MOTION;
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
    stepper->gained[p] = h / 6.0 * stepper->now->power[p];
  for (int k = 1; k < 4; k++) {
    rk4_next_stage(n, ahead[k] * h, stepper->now->q, stepper->now->v, v[k - 1], a[k - 1], w[Q],
                   w[V + k - 1]);
    if (moves) strut_support_motion_place(model, state, t + ahead[k] * h, w[Q], w[V + k - 1]);
    accelerate_in_modes(model, state, stepper, t + ahead[k] * h, w[Q], v[k], a[k], stepper->next,
                        terms, balance);
    if (balance) gain(state, stepper, weight[k] * h / 6.0);
  }
  rk4_end_of_step(n, h, stepper->now->q, v[0], v[1], v[2], v[3], stepper->next->q);
  rk4_end_of_step(n, h, stepper->now->v, a[0], a[1], a[2], a[3], stepper->next->v);
  if (moves) strut_support_motion_place(model, state, t + h, stepper->next->q, stepper->next->v);
  evaluate_step_end(model, state, stepper, t + h, stepper->next, terms, balance);
}

STRUT_EVENT_TRIAL(rk4_events, take)

static const strut_tableau tableau = {
    .stages = 4,
    .order = 4,
    .ahead = {0.0, 0.5, 0.5, 1.0},
    .weight = {{0}, {0.5}, {0.0, 0.5}, {0.0, 0.0, 1.0}, {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}}};
static const strut_step_formula formula = {
    .trial = rk4_events_trial, .stages = STAGES, .exact = true, .tableau = &tableau};

static void *create(const strut_model *model, strut_state *state,
                    const strut_integrator_settings *settings) {
  strut_event_stepper *stepper = strut_event_stepper_create(model, state, &formula, settings);
  if (stepper && !(settings->refine > 0.0)) stepper->control.refine = 1.0;
  return stepper;
}

const strut_integrator strut_integrator_rk4_events = {
    .name = "rk4-events",
    .description = "classical Runge-Kutta from event to event, fixed step",
    .order = 4,
    .lag = 1.0 / 120.0,
    .evaluations = 4,
    .region = STRUT_REGION_RK4,
    .role = STRUT_ROLE_EXACT_STICK,
    .create = create,
    STRUT_STEPS_TO_EVENTS,
    .tangent = true,
};
