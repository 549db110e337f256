/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot where a scene has sensors. See feedback.h. */
#include "engine/forces/drives/feedback.h"

#include <assert.h>
#include <math.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/observe.h"
#include "engine/scene/signal_program.h"

static void sense_all(const strut_model *model, const strut_state *state, bool driven, double t,
                      const double *q, const double *v) {
  const strut_feedback_table *f = &model->feedback;
  strut_instant instant = {
      .model = model, .state = state, .q = q, .v = v, .time = t, .sensed = true};
  for (int32_t i = 0; i < f->count; i++) {
    strut_column column = f->sensor[i];
    if (strut_column_needs_drives(column) != driven) continue;
    strut_observed seen = strut_observe_at(column.kind)(&instant, column.item, column.other);
    state->latest->sensor[i] = seen.value, state->latest->sensor_rate[i] = seen.rate;
  }
}

static void apply_drives(const strut_model *model, const strut_state *state, double t,
                         const double *q, const double *v) {
  const strut_feedback_table *f = &model->feedback;
  sense_all(model, state, false, t, q, v);
  strut_drive_apply_sensed(model, state, t, v);
  if (!f->needs_drives) return;
  sense_all(model, state, true, t, q, v);
  /* rates of states may follow these sensors, and rates of rest lengths those */
  if (f->state_count) strut_drive_apply_sensed(model, state, t, v);
}

/* Samples the signals that are due at time t; v: for the states. */
static bool take_samples(const strut_model *model, strut_state *state, double t, const double *v,
                         double tolerance) {
  const strut_feedback_table *f = &model->feedback;
  const strut_signal_inputs in = strut_drive_inputs(model, state, v);
  bool any = false;
  for (int32_t i = 0; i < f->sampled_count; i++) {
    int32_t signal = f->sampled[i];
    double every = model->scene->signals[signal].every, rate;
    if (!(fabs(t - every * round(t / every)) <= tolerance)) continue;
    if (model->scene->signals[signal].kind == STRUT_RELAY)
      strut_relay_sample(model, state, signal, t, v);
    strut_signal_follow_unsampled(model->scene->signals, &in, signal, t,
                                  &state->signals.held[signal], &rate);
    any = true;
  }
  return any;
}

/* Are there sampled signals or relays that have no value yet? */
static bool lacks_memory(const strut_model *model, const strut_state *state) {
  const strut_feedback_table *f = &model->feedback;
  return (f->sampled_count && isnan(state->signals.held[f->sampled[0]])) ||
         (f->relay_count && state->signals.relay_side[f->relay[0]] == 0);
}

/* The first samples and the sides of relays, at rest lengths without drives; parts before their users. */
static void begin_history(const strut_model *model, const strut_state *state, double t,
                          const double *q, const double *v) {
  const strut_signal *signals = model->scene->signals;
  const strut_signal_inputs in = strut_drive_inputs(model, state, v);
  double rate;
  sense_all(model, state, false, t, q, v);
  sense_all(model, state, true, t, q, v);
  for (int32_t i = 0; i < (int32_t)model->scene->signal_count; i++) {
    if (signals[i].kind == STRUT_RELAY) strut_relay_start(model, state, i, t, v);
    if (signals[i].every > 0.0)
      strut_signal_follow_unsampled(signals, &in, i, t, &state->signals.held[i], &rate);
  }
}

void strut_feedback_apply(const strut_model *model, const strut_state *state, double t,
                          const double *q, const double *v) {
  if (lacks_memory(model, state)) begin_history(model, state, t + state->time_offset, q, v);
  apply_drives(model, state, t, q, v);
}

void strut_feedback_add_rates(const strut_model *model, const strut_state *state, double t,
                              const double *v, double *force) {
  const strut_feedback_table *f = &model->feedback;
  const strut_scene *scene = model->scene;
  strut_signal_inputs in = strut_drive_inputs(model, state, v);
  double now = t + state->time_offset, value, unused;
  in.values_only = true;
  for (int32_t i = 0; i < (int32_t)scene->state_count; i++) {
    strut_program_evaluate(&scene->states[i].rate, scene->signals, &in, now, &value, &unused);
    force[f->base + i] = value;
  }
  for (int32_t k = 0; k < f->lag_count; k++) {
    int32_t signal = f->lagged[k], index = f->lag_of[signal];
    strut_signal_follow_unlagged(scene->signals, &in, signal, now, &value, &unused);
    force[f->base + index] = (value - in.state[index]) / scene->signals[signal].lag;
  }
}

double strut_feedback_next_sample(const strut_model *model, double t) {
  const strut_feedback_table *f = &model->feedback;
  double first = (double)INFINITY;
  for (int32_t i = 0; i < f->sampled_count; i++) {
    double every = model->scene->signals[f->sampled[i]].every;
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
  const strut_feedback_table *f = &model->feedback;
  bool any = false;
  for (int32_t i = 0; i < f->trigger_count; i++) {
    const strut_trigger *trigger = &model->scene->signals[f->triggered[i]].trigger;
    bool mine = trigger->kind == STRUT_TRIGGER_CONTACT &&
                trigger->item == model->contacts.entry[contact].node;
    if (mine && start_signal(model, state, f->triggered[i], t)) any = true;
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
  const strut_feedback_table *f = &model->feedback;
  bool any = false;
  strut_feedback_apply(model, state, t, state->q, state->v);
  for (int32_t i = 0; i < f->trigger_count; i++) {
    int32_t signal = f->triggered[i];
    const strut_trigger *trigger = &model->scene->signals[signal].trigger;
    bool holds = condition_holds(model, state, trigger);
    if (holds && state->signals.trigger_was[signal] == 0 && start_signal(model, state, signal, t))
      any = true;
    state->signals.trigger_was[signal] = holds;
  }
  return any;
}

static double input_of(const strut_model *model, const strut_state *state, int32_t signal,
                       double now, const double *v) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  strut_signal_inputs in = strut_drive_inputs(model, state, v);
  double input, unused;
  in.values_only = true;
  strut_program_evaluate(&model->scene->signals[signal].program, model->scene->signals, &in, now,
                         &input, &unused);
  return input;
}

void strut_relay_start(const strut_model *model, const strut_state *state, int32_t signal,
                       double now, const double *v) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  const strut_relay *r = &model->scene->signals[signal].relay;
  double input = input_of(model, state, signal, now, v);
  bool above = input > r->upper || (!(input < r->lower) && r->on_at_start == r->on_above);
  state->signals.relay_side[signal] = above ? 1 : -1;
}

double strut_relay_margin(const strut_model *model, const strut_state *state, int32_t signal,
                          double now, const double *v) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  const strut_relay *r = &model->scene->signals[signal].relay;
  double input = input_of(model, state, signal, now, v);
  return state->signals.relay_side[signal] > 0 ? input - r->lower : r->upper - input;
}

bool strut_relay_sample(const strut_model *model, strut_state *state, int32_t signal, double now,
                        const double *v) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  if (!(strut_relay_margin(model, state, signal, now, v) < 0.0)) return false;
  state->signals.relay_side[signal] = (int8_t)-state->signals.relay_side[signal];
  return true;
}

void strut_relay_switch(const strut_model *model, strut_state *state, int32_t signal, double t) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  state->signals.relay_side[signal] = (int8_t)-state->signals.relay_side[signal];
  strut_drive_apply(model, state, t);
  if (!(strut_relay_margin(model, state, signal, t + state->time_offset, state->v) < 0.0)) return;
  state->trouble = STRUT_FAILURE_RELAY;
  state->trouble_node = signal;
}

bool strut_relays_follow(const strut_model *model, strut_state *state, double t) {
  const strut_feedback_table *f = &model->feedback;
  bool any = false;
  strut_drive_apply(model, state, t);
  for (int32_t i = 0; i < f->relay_count && !state->trouble; i++) {
    double margin = strut_relay_margin(model, state, f->relay[i], t + state->time_offset, state->v);
    if (!(margin < 0.0)) continue;
    strut_relay_switch(model, state, f->relay[i], t);
    any = true;
  }
  return any;
}

void strut_threshold_begin(const strut_model *model, strut_state *state) {
  const strut_feedback_table *f = &model->feedback;
  for (int32_t i = 0; i < f->trigger_count; i++) {
    const strut_trigger *trigger = &model->scene->signals[f->triggered[i]].trigger;
    if (trigger->kind != STRUT_TRIGGER_CONTACT && state->signals.trigger_was[f->triggered[i]] < 0)
      state->signals.trigger_was[f->triggered[i]] = condition_holds(model, state, trigger);
  }
}

double strut_threshold_margin(const strut_model *model, const strut_state *state, int32_t signal,
                              double now, const double *v, double *rate) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  const strut_trigger *trigger = &model->scene->signals[signal].trigger;
  *rate = 0.0;
  if (model->scene->signals[signal].kind == STRUT_RELAY && trigger->kind == STRUT_TRIGGER_NONE)
    return strut_relay_margin(model, state, signal, now, v);
  if (state->signals.started[signal] < (double)INFINITY && !trigger->each) return 1.0;
  double side = trigger->kind == STRUT_TRIGGER_ABOVE ? -1.0 : 1.0;
  if (state->signals.trigger_was[signal] > 0) side = -side;
  *rate = side * state->latest->sensor_rate[trigger->item];
  return side * (state->latest->sensor[trigger->item] - trigger->level);
}

void strut_threshold_pass(const strut_model *model, strut_state *state, int32_t signal, double t) {
  assert(signal >= 0 && signal < (int32_t)model->scene->signal_count);
  if (model->scene->signals[signal].trigger.kind == STRUT_TRIGGER_NONE) {
    strut_relay_switch(model, state, signal, t);
    return;
  }
  bool holds = !(state->signals.trigger_was[signal] > 0);
  state->signals.trigger_was[signal] = holds;
  if (holds && start_signal(model, state, signal, t)) strut_drive_apply(model, state, t);
}
