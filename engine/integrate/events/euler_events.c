/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Semi-implicit Euler between events: the cheapest step there is, of first order. */
#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/integrator.h"

STRUT_INLINE void take(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double h, unsigned terms, bool balance) {
  for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
    strut_lanes v = strut_lanes_load(l->now->v + i) + h * strut_lanes_load_pairs(l->now->a + i);
    strut_lanes_store(l->next->v + i, v);
    strut_lanes_store(l->next->q + i, strut_lanes_load(l->now->q + i) + h * v);
  }
  if (model->terms & terms & STRUT_TERM_SUPPORT_MOTION)
    strut_support_motion_place(model, state, t + h, l->next->q, l->next->v);
  evaluate_step_end(model, state, l, t + h, l->next, terms, balance);
  for (int p = 0; p < STRUT_POWER_COUNT && balance; p++)
    l->gained[p] = 0.5 * h * (l->now->power[p] + l->next->power[p]);
}

STRUT_EVENT_TRIAL(euler_events, take)

static const strut_step_formula stepper = {.trial = euler_events_trial};

static void *create(const strut_model *model, strut_state *state,
                    const strut_integrator_settings *settings) {
  strut_event_stepper *l = strut_event_stepper_create(model, state, &stepper, settings);
  if (l && !(settings->refine > 0.0)) l->refine = 1.0;
  return l;
}

const strut_integrator strut_integrator_euler_events = {
    .name = "euler-events",
    .description = "semi-implicit Euler from event to event, fixed step",
    .order = 1,
    .lag = 1.0 / 24.0,
    .evaluations = 1,
    .region = STRUT_REGION_EULER,
    .events = true,
    .create = create,
    .restart = strut_event_stepper_restart,
    .advance = strut_event_stepper_advance,
    .observe = strut_event_stepper_observe,
};
