/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Velocity Verlet between events: one evaluation a step, implicit ground dampers, shorter steps after a touchdown. */
#include "engine/integrate/events/contacts/implicit_ground.h"
#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/integrator.h"

enum { PREDICTED, STAGES };

static void predict(const strut_model *model, strut_event_stepper *stepper, double h) {
  const double *restrict q = stepper->now->q, *restrict v = stepper->now->v,
                         *restrict a = stepper->now->a;
  double *restrict next = stepper->next->q, *restrict speed = stepper->stage[PREDICTED],
                   half = 0.5 * h;
  for (int32_t i = 0; i < model->length; i += STRUT_LANES) {
    strut_lanes rate = strut_lanes_load(v + i), bend = strut_lanes_load(a + i);
    strut_lanes_store(next + i, strut_lanes_load(q + i) + h * (rate + half * bend));
    strut_lanes_store(speed + i, rate + h * bend);
  }
}

STRUT_INLINE void correct(int32_t n, double h, const double *restrict velocity,
                          const double *restrict a0, const double *restrict a1,
                          double *restrict next) {
  double half = 0.5 * h;
  for (int32_t i = 0; i < n; i += STRUT_LANES)
    strut_lanes_store(next + i,
                      strut_lanes_load(velocity + i) +
                          half * (strut_lanes_load(a0 + i) + strut_lanes_load_pairs(a1 + i)));
}

STRUT_LOOP void take(const strut_model *model, const strut_state *state,
                     strut_event_stepper *stepper, double t, double h, unsigned terms,
                     bool balance) {
  int32_t n = model->length;
  double *predicted = stepper->stage[PREDICTED], *a1 = stepper->next->a;
  bool moves = model->terms & terms & STRUT_TERM_SUPPORT_MOTION;
  bool sliding = model->terms & terms & STRUT_TERM_SLIDING_MASS;
  if (moves) strut_support_motion_place(model, state, t + h, stepper->next->q, predicted);
  forces_in_modes(model, state, stepper, t + h, stepper->next->q, predicted, terms, balance);
  keep_structure_forces(model, state, stepper->next, balance);
  keep_ground_motion(model, state, stepper->next, terms);
  if (!stepper->active.closed_count) {
    divide_by_mass(model, state, a1, terms);
  } else if (stepper->active.all_sliding) {
    mass_kernel(model, state->latest->force, a1, state->buffers->mass_solve);
    implicit_ground_slides(model, stepper, h, a1);
  } else if (stepper->active.decoupled) {
    mass_kernel(model, state->latest->force, a1, state->buffers->mass_solve);
    implicit_ground_decoupled(model, stepper, h, predicted, state->latest->force, a1);
  } else {
    add_contact_forces(model, stepper, stepper->next->q, predicted, state->latest->force, false,
                       stepper->next, terms);
    divide_by_mass(model, state, a1, terms);
    if (sliding) strut_refresh_compliances(model, state, stepper);
    implicit_ground_together(model, stepper, h, a1, terms);
  }
  correct(n, h, stepper->now->v, stepper->now->a, a1, stepper->next->v);
  if (moves) strut_support_motion_place(model, state, t + h, stepper->next->q, stepper->next->v);
  if (stepper->active.closed_count && stepper->active.decoupled)
    implicit_ground_leave(model, state, stepper, balance);
  else if (stepper->active.closed_count)
    implicit_ground_finish(model, state, stepper, terms, balance);
  if (!stepper->active.all_sliding) settle_band_ties(model, stepper);
  if (balance && sliding)
    strut_sliding_masses_add_power(model, state, stepper->next->q, stepper->next->v, a1);
  for (int p = 0; p < STRUT_POWER_ROOM && balance; p += STRUT_LANES) {
    strut_lanes power = strut_lanes_load(state->latest->power + p);
    strut_lanes_store(stepper->next->power + p, power);
    strut_lanes_store(stepper->gained + p,
                      0.5 * h * (strut_lanes_load(stepper->now->power + p) + power));
  }
}

STRUT_EVENT_TRIAL(verlet_events, take)

/* Does a contact open or close within the step that has been predicted? */
STRUT_INLINE bool crosses(const strut_contact_table *c, const strut_event_stepper *stepper,
                          const double *restrict q) {
  const uint32_t *restrict at = c->at;
  const double *restrict outward = stepper->modes.outward, *restrict height = q + 1;
  const double slope = c->normal[0], rise = c->normal[1], ground = c->height;
  double lowest = 0.0;
  for (int32_t i = 0, count = c->count; i < count; i++) {
    double above = height[at[i]] - ground;
    double gap = outward[i] * (slope == 0.0 ? above : q[at[i]] * slope + above * rise);
    lowest = gap < lowest ? gap : lowest;
  }
  return lowest < 0.0;
}

/* Does what stepper->next says contradict a mode? */
STRUT_INLINE bool contradicts(const strut_model *model, const strut_state *state,
                              strut_event_stepper *stepper, double h) {
  if (stepper->active.all_sliding) {
    const strut_sliding_contact *contact = stepper->active.sliding;
    for (const strut_sliding_contact *end = contact + stepper->active.closed_count; contact < end;
         contact++)
      if (contact->side * stepper->next->touch[contact->index].slip < contact->edge) return true;
  }
  for (int32_t k = 0; k < stepper->active.closed_count && !stepper->active.all_sliding; k++) {
    int32_t i = stepper->active.closed[k];
    if (contradicting_event(&stepper->contacts.entry[i], &stepper->modes, i,
                            &stepper->next->touch[i]))
      return true;
  }
  return (stepper->laws.count || strut_turns_due(state, stepper)) &&
         (strut_event_first(model, state, stepper, h).kind ||
          strut_event_between(model, state, stepper, h) > 0.0);
}

STRUT_INLINE void advance_predicted(const strut_model *model, strut_state *state,
                                    strut_event_stepper *stepper, double dt, int64_t end,
                                    unsigned terms, bool balance) {
  while (state->step < end) {
    double t = (double)state->step * dt + stepper->done, h = next_step_size(state, stepper, dt);
    if (t + h + state->time_offset > stepper->next_break - STRUT_AT_BREAK * dt) return;
    if (shown_step_size(model, state, stepper, h, dt) < h) return;
    t = evaluation_time(stepper, t, dt);
    predict(model, stepper, h);
    if (crosses(&model->contacts, stepper, stepper->next->q)) return;
    take(model, state, stepper, t, h, terms, balance);
    stepper->tried = contradicts(model, state, stepper, h);
    if (stepper->tried) return;
    accept_step(model, state, stepper, balance);
    advance_within_grid(state, stepper, h, dt);
  }
}

STRUT_COPIES(verlet_advance_until_event, advance_predicted,
             (const strut_model *model, strut_state *state, strut_event_stepper *stepper, double dt,
              int64_t end),
             model, state, stepper, dt, end)

static const strut_step_formula formula = {.trial = verlet_events_trial,
                                           .stages = STAGES,
                                           .predict = predict,
                                           .advance_until_event = verlet_advance_until_event};

static void *create(const strut_model *model, strut_state *state,
                    const strut_integrator_settings *settings) {
  return strut_event_stepper_create(model, state, &formula, settings);
}

const strut_integrator strut_integrator_verlet_events = {
    .name = "verlet-events",
    .description =
        "velocity Verlet from event to event, implicit ground dampers, shorter steps "
        "after a touchdown",
    .order = 2,
    .lag = 1.0 / 24.0,
    .evaluations = 1,
    .region = STRUT_REGION_VERLET,
    .role = STRUT_ROLE_COARSE,
    .implicit_damper = true,
    .create = create,
    STRUT_STEPS_TO_EVENTS,
};

/* Semi-implicit Euler between events: the cheapest step there is, of first order. */

STRUT_INLINE void take_euler(const strut_model *model, const strut_state *state,
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

STRUT_EVENT_TRIAL(euler_events, take_euler)

static const strut_step_formula euler_formula = {.trial = euler_events_trial};

static void *create_euler(const strut_model *model, strut_state *state,
                          const strut_integrator_settings *settings) {
  strut_event_stepper *stepper = strut_event_stepper_create(model, state, &euler_formula, settings);
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
    .create = create_euler,
    STRUT_STEPS_TO_EVENTS,
};
