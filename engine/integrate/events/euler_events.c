/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Semi-implicit Euler between events: the cheapest step there is, of first order. */
#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/integrator.h"

STRUT_INLINE void take(const strut_model *model, const strut_state *state,
                       strut_event_stepper *stepper, double t, double h, unsigned terms,
                       bool balance) {
  for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
    strut_lanes v =
        strut_lanes_load(stepper->now->v + i) + h * strut_lanes_load_pairs(stepper->now->a + i);
    strut_lanes_store(stepper->next->v + i, v);
    strut_lanes_store(stepper->next->q + i, strut_lanes_load(stepper->now->q + i) + h * v);
  }
  if (model->terms & terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(model, state, t + h, stepper->next->q, stepper->next->v);
  evaluate_step_end(model, state, stepper, t + h, stepper->next, terms, balance);
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
    stepper->gained[p] = 0.5 * h * (stepper->now->power[p] + stepper->next->power[p]);
}

STRUT_EVENT_TRIAL(euler_events, take)

static const strut_step_formula formula = {.trial = euler_events_trial};

static void *create(const strut_model *model, strut_state *state,
                    const strut_integrator_settings *settings) {
  strut_event_stepper *stepper = strut_event_stepper_create(model, state, &formula, settings);
  if (stepper && !(settings->refine > 0.0)) stepper->control.refine = 1.0;
  return stepper;
}

const strut_integrator strut_integrator_euler_events = {
    .name = "euler-events",
    .description = "semi-implicit Euler from event to event, fixed step",
    .order = 1,
    .lag = 1.0 / 24.0,
    .evaluations = 1,
    .region = STRUT_REGION_EULER,
    .create = create,
    STRUT_STEPS_TO_EVENTS,
};
