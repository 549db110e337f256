/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot where a scene has sensors. See drives.h. */
#include <assert.h>
#include <math.h>

#include "engine/forces/drives/drives.h"

#include "engine/forces/observe.h"
#include "engine/scene/signal_program.h"

static double input_of(const strut_model *model, const strut_state *state, int32_t signal,
                       double now, const double *velocity) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  strut_signal_inputs in = strut_drive_inputs(model, state, velocity);
  double input, unused;
  in.values_only = true;
  strut_program_evaluate(&model->scene->signals[signal].program, model->scene->signals, &in, now,
                         &input, &unused);
  return input;
}

/* Sets the side of a relay at t = 0. */
static void relay_start(const strut_model *model, const strut_state *state, int32_t signal,
                        double now, const double *velocity) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  const strut_relay *relay = &model->scene->signals[signal].relay;
  double input = input_of(model, state, signal, now, velocity);
  bool above =
      input > relay->upper || (!(input < relay->lower) && relay->on_at_start == relay->on_above);
  state->signals.relay_side[signal] = above ? 1 : -1;
}

/* How far the input is from the threshold that switches the relay; negative beyond it. */
static double relay_margin(const strut_model *model, const strut_state *state, int32_t signal,
                           double now, const double *velocity) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  const strut_relay *relay = &model->scene->signals[signal].relay;
  double input = input_of(model, state, signal, now, velocity);
  return state->signals.relay_side[signal] > 0 ? input - relay->lower : relay->upper - input;
}

/* Switches a relay whose input is beyond its threshold, as when it is sampled. True if it was. */
static bool relay_sample(const strut_model *model, strut_state *state, int32_t signal, double now,
                         const double *velocity) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  if (!(relay_margin(model, state, signal, now, velocity) < 0.0)) return false;
  state->signals.relay_side[signal] = (int8_t)-state->signals.relay_side[signal];
  return true;
}

/*
 * Switches a relay at time t [s] of the steps and the state's positions and velocities. Where what it
 * drives takes its own input past the other threshold at once, state->trouble says so; an input that is
 * there because the switch was located a little early is not.
 */
static void relay_switch(const strut_model *model, strut_state *state, int32_t signal, double t) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  double now = t + state->time_offset;
  state->signals.relay_side[signal] = (int8_t)-state->signals.relay_side[signal];
  double before = relay_margin(model, state, signal, now, state->v);
  strut_drive_apply(model, state, t);
  double margin = relay_margin(model, state, signal, now, state->v);
  if (!(margin < 0.0 && margin < before)) return;
  state->trouble = STRUT_FAILURE_RELAY;
  state->trouble_node = signal;
}

static void sense_all(const strut_model *model, const strut_state *state, bool driven, double t,
                      const double *q, const double *velocity) {
  const strut_feedback_table *feedback = &model->feedback;
  strut_instant instant = {
      .model = model, .state = state, .q = q, .v = velocity, .time = t, .sensed = true};
  for (int32_t i = 0; i < feedback->count; i++) {
    strut_column column = feedback->sensor[i];
    if (strut_column_needs_drives(column) != driven) continue;
    strut_observed seen = strut_observe_at(column.kind)(&instant, column.item, column.other);
    state->latest->sensor[i] = seen.value, state->latest->sensor_rate[i] = seen.rate;
  }
}

static void apply_drives(const strut_model *model, const strut_state *state, double t,
                         const double *q, const double *velocity) {
  const strut_feedback_table *feedback = &model->feedback;
  sense_all(model, state, false, t, q, velocity);
  strut_drive_apply_sensed(model, state, t, velocity);
  if (!feedback->needs_drives) return;
  sense_all(model, state, true, t, q, velocity);
  /* rates of states may follow these sensors, and rates of rest lengths those */
  if (feedback->state_count) strut_drive_apply_sensed(model, state, t, velocity);
}

/* Samples the signals that are due at time t; v: for the states. */
static bool take_samples(const strut_model *model, strut_state *state, double t,
                         const double *velocity, double tolerance) {
  const strut_feedback_table *feedback = &model->feedback;
  const strut_signal_inputs in = strut_drive_inputs(model, state, velocity);
  bool any = false;
  for (int32_t i = 0; i < feedback->sampled_count; i++) {
    int32_t signal = feedback->sampled[i];
    double every = model->scene->signals[signal].every, rate;
    if (!(fabs(t - every * round(t / every)) <= tolerance)) continue;
    if (model->scene->signals[signal].kind == STRUT_RELAY)
      relay_sample(model, state, signal, t, velocity);
    strut_signal_follow_unsampled(model->scene->signals, &in, signal, t,
                                  &state->signals.held[signal], &rate);
    any = true;
  }
  return any;
}

/* Are there sampled signals or relays that have no value yet? */
static bool lacks_memory(const strut_model *model, const strut_state *state) {
  const strut_feedback_table *feedback = &model->feedback;
  return (feedback->sampled_count && isnan(state->signals.held[feedback->sampled[0]])) ||
         (feedback->relay_count && state->signals.relay_side[feedback->relay[0]] == 0);
}

/* The first samples and the sides of relays, at rest lengths without drives; parts before their users. */
static void begin_history(const strut_model *model, const strut_state *state, double t,
                          const double *q, const double *velocity) {
  const strut_signal *signals = model->scene->signals;
  const strut_signal_inputs in = strut_drive_inputs(model, state, velocity);
  double rate;
  sense_all(model, state, false, t, q, velocity);
  sense_all(model, state, true, t, q, velocity);
  for (int32_t i = 0; i < (int32_t)model->scene->signal_count; i++) {
    if (signals[i].kind == STRUT_RELAY) relay_start(model, state, i, t, velocity);
    if (signals[i].every > 0.0)
      strut_signal_follow_unsampled(signals, &in, i, t, &state->signals.held[i], &rate);
  }
}

void strut_feedback_apply(const strut_model *model, const strut_state *state, double t,
                          const double *q, const double *velocity) {
  if (lacks_memory(model, state)) begin_history(model, state, t + state->time_offset, q, velocity);
  apply_drives(model, state, t, q, velocity);
}

void strut_feedback_add_rates(const strut_model *model, const strut_state *state, double t,
                              const double *velocity, double *force) {
  const strut_feedback_table *feedback = &model->feedback;
  const strut_scene *scene = model->scene;
  strut_signal_inputs in = strut_drive_inputs(model, state, velocity);
  double now = t + state->time_offset, value, unused;
  in.values_only = true;
  for (int32_t i = 0; i < (int32_t)scene->state_count; i++) {
    strut_program_evaluate(&scene->states[i].rate, scene->signals, &in, now, &value, &unused);
    force[feedback->base + i] = value;
  }
  for (int32_t k = 0; k < feedback->lag_count; k++) {
    int32_t signal = feedback->lagged[k], index = feedback->lag_of[signal];
    strut_signal_follow_unlagged(scene->signals, &in, signal, now, &value, &unused);
    force[feedback->base + index] = (value - in.state[index]) / scene->signals[signal].lag;
  }
}

double strut_feedback_next_sample(const strut_model *model, double t) {
  const strut_feedback_table *feedback = &model->feedback;
  double first = (double)INFINITY;
  for (int32_t i = 0; i < feedback->sampled_count; i++) {
    double every = model->scene->signals[feedback->sampled[i]].every;
    double next = every * (floor(t / every) + 1.0);
    first = fmin(first, next > t ? next : next + every);
  }
  return first;
}

bool strut_feedback_sample(const strut_model *model, strut_state *state, double t,
                           double tolerance) {
  if (!model->feedback.sampled_count) return false;
  strut_feedback_apply(model, state, t, state->q, state->v);
  return take_samples(model, state, t + state->time_offset, state->v, tolerance);
}

static bool start_signal(const strut_model *model, strut_state *state, int32_t signal, double t) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  const strut_trigger *trigger = &model->scene->signals[signal].trigger;
  if (state->signals.started[signal] < (double)INFINITY && !trigger->each) return false;
  state->signals.started[signal] = t + state->time_offset;
  return true;
}

bool strut_feedback_touch(const strut_model *model, strut_state *state, int32_t contact, double t) {
  assert(contact >= 0 && contact < model->contacts.count);
  const strut_feedback_table *feedback = &model->feedback;
  bool any = false;
  for (int32_t i = 0; i < feedback->trigger_count; i++) {
    const strut_trigger *trigger = &model->scene->signals[feedback->triggered[i]].trigger;
    bool mine = trigger->kind == STRUT_TRIGGER_CONTACT &&
                trigger->item == model->contacts.entry[contact].node;
    if (mine && start_signal(model, state, feedback->triggered[i], t)) any = true;
  }
  return any;
}

/* Does the condition of a trigger hold at the state? */
static bool condition_holds(const strut_model *model, const strut_state *state,
                            const strut_trigger *trigger) {
  if (trigger->kind == STRUT_TRIGGER_CONTACT) {
    strut_instant instant = {.model = model, .state = state, .q = state->q, .v = state->v};
    return strut_observe_item(&instant, STRUT_COLUMN_TOUCHES, trigger->item) > 0.0;
  }
  if (trigger->kind == STRUT_TRIGGER_ABOVE)
    return state->latest->sensor[trigger->item] > trigger->level;
  return trigger->kind == STRUT_TRIGGER_BELOW &&
         state->latest->sensor[trigger->item] < trigger->level;
}

bool strut_feedback_watch(const strut_model *model, strut_state *state, double t) {
  const strut_feedback_table *feedback = &model->feedback;
  bool any = false;
  strut_feedback_apply(model, state, t, state->q, state->v);
  for (int32_t i = 0; i < feedback->trigger_count; i++) {
    int32_t signal = feedback->triggered[i];
    const strut_trigger *trigger = &model->scene->signals[signal].trigger;
    bool holds = condition_holds(model, state, trigger);
    if (holds && state->signals.trigger_was[signal] == 0 && start_signal(model, state, signal, t))
      any = true;
    state->signals.trigger_was[signal] = holds;
  }
  return any;
}

bool strut_relays_follow(const strut_model *model, strut_state *state, double t) {
  const strut_feedback_table *feedback = &model->feedback;
  bool any = false;
  strut_drive_apply(model, state, t);
  for (int32_t i = 0; i < feedback->relay_count && !state->trouble; i++) {
    double margin =
        relay_margin(model, state, feedback->relay[i], t + state->time_offset, state->v);
    if (!(margin < 0.0)) continue;
    relay_switch(model, state, feedback->relay[i], t);
    any = true;
  }
  return any;
}

void strut_threshold_begin(const strut_model *model, strut_state *state) {
  const strut_feedback_table *feedback = &model->feedback;
  for (int32_t i = 0; i < feedback->trigger_count; i++) {
    const strut_trigger *trigger = &model->scene->signals[feedback->triggered[i]].trigger;
    if (trigger->kind != STRUT_TRIGGER_CONTACT &&
        state->signals.trigger_was[feedback->triggered[i]] < 0)
      state->signals.trigger_was[feedback->triggered[i]] = condition_holds(model, state, trigger);
  }
}

double strut_threshold_margin(const strut_model *model, const strut_state *state, int32_t signal,
                              double now, const double *velocity, double *rate) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  const strut_trigger *trigger = &model->scene->signals[signal].trigger;
  *rate = 0.0;
  if (model->scene->signals[signal].kind == STRUT_RELAY && trigger->kind == STRUT_TRIGGER_NONE)
    return relay_margin(model, state, signal, now, velocity);
  if (state->signals.started[signal] < (double)INFINITY && !trigger->each) return 1.0;
  double side = trigger->kind == STRUT_TRIGGER_ABOVE ? -1.0 : 1.0;
  if (state->signals.trigger_was[signal] > 0) side = -side;
  *rate = side * state->latest->sensor_rate[trigger->item];
  return side * (state->latest->sensor[trigger->item] - trigger->level);
}

void strut_threshold_pass(const strut_model *model, strut_state *state, int32_t signal, double t) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  if (model->scene->signals[signal].trigger.kind == STRUT_TRIGGER_NONE) {
    relay_switch(model, state, signal, t);
    return;
  }
  bool holds = !(state->signals.trigger_was[signal] > 0);
  state->signals.trigger_was[signal] = holds;
  if (holds && start_signal(model, state, signal, t)) strut_drive_apply(model, state, t);
}
