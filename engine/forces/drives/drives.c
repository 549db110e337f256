/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot: what changes with time alone: driven rest lengths (6) and loads on a signal. */
#include "engine/forces/drives/drives.h"

#include <math.h>

#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/history.h"
#include "engine/forces/strains/strains.h"
#include "engine/scene/signal_program.h"

strut_signal_inputs strut_drive_inputs(const strut_model *model, const strut_state *state,
                                       const double *velocity) {
  return (strut_signal_inputs){.sensor = state->latest->sensor,
                               .sensor_rate = state->latest->sensor_rate,
                               .state = velocity + model->feedback.base,
                               .states = model->scene->states,
                               .lag_of = model->feedback.lag_of,
                               .held = state->signals.held,
                               .started = state->signals.started,
                               .kinks = state->modes.kinks,
                               .relay_side = state->signals.relay_side};
}

/* The signal of a drive or a load now. */
static void evaluate(const strut_model *model, const strut_state *state, const double *velocity,
                     int32_t signal, double t, double *value, double *rate) {
  const strut_signal *signals = model->scene->signals;
  if (!(model->terms & STRUT_TERM_FEEDBACK)) {
    strut_signal_evaluate(signals, signal, t, value, rate);
    return;
  }
  const strut_signal_inputs in = strut_drive_inputs(model, state, velocity);
  strut_signal_follow(signals, &in, signal, t, value, rate);
}

double strut_drive_signal(const strut_model *model, const strut_state *state,
                          const double *velocity, int32_t signal, double t) {
  double value, rate;
  evaluate(model, state, velocity, signal, t, &value, &rate);
  return value;
}

/* Rest lengths as the signals ask; `sensed`: they may read sensors. */
static inline void drive_rest_lengths(const strut_model *model, const strut_state *state, double t,
                                      const double *velocity, bool sensed) {
  const strut_drive_table *table = &model->drives;
  const strut_signal *signals = model->scene->signals;
  double *restrict rest = state->latest->rest, *restrict rest_rate = state->latest->rest_rate;
  for (int32_t i = 0; i < table->count; i++) {
    double value, rate;
    int32_t member = table->member[i];
    if (sensed)
      evaluate(model, state, velocity, table->signal[i], t + state->time_offset, &value, &rate);
    else
      strut_signal_evaluate(signals, table->signal[i], t + state->time_offset, &value, &rate);
    /* the first actuator of a member starts from its own rest length, further ones add */
    rest[member] = (table->first[i] ? model->members.rest[member] : rest[member]) + value;
    rest_rate[member] = table->first[i] ? rate : rest_rate[member] + rate;
  }
}

void strut_drive_apply(const strut_model *model, const strut_state *state, double t) {
  if (!(model->terms & STRUT_TERMS_RARE)) {
    state->latest->drive_time = t;
    drive_rest_lengths(model, state, t, NULL, false);
  } else if (model->terms & STRUT_TERM_FEEDBACK) {
    strut_feedback_apply(model, state, t, state->q, state->v);
  } else {
    strut_drive_apply_sensed(model, state, t, state->v);
  }
}

/* Friction as the signals ask. */
static void drive_grips(const strut_model *model, const strut_state *state, double t,
                        const double *velocity) {
  for (int32_t i = 0; i < model->contacts.count; i++) {
    strut_friction *friction = &state->latest->grip[i].friction;
    if (friction->driven)
      strut_friction_drive(friction, strut_drive_signal(model, state, velocity, friction->signal,
                                                        t + state->time_offset));
  }
}

void strut_drive_apply_sensed(const strut_model *model, const strut_state *state, double t,
                              const double *velocity) {
  state->latest->drive_time = t;
  if (model->terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_place(model, state, t);
  if (state->latest->ground_motion)
    strut_grounds_move(model, t + state->time_offset, state->latest->ground_motion);
  if (state->latest->grip) drive_grips(model, state, t, velocity);
  drive_rest_lengths(model, state, t, velocity, true);
  if (model->terms & STRUT_TERM_MEMORY) strut_history_follow(model, state);
}

void strut_grounds_move(const strut_model *model, double t, strut_ground_motion *motion) {
  const strut_scene *scene = model->scene;
  for (size_t g = 0; g < scene->ground_count; g++)
    for (int c = 0; c < 2; c++) {
      strut_ground_motion *ground_motion = &motion[g];
      const strut_ground *ground = &scene->grounds[g];
      ground_motion->place[c] = ground_motion->rate[c] = ground_motion->bend[c] = 0.0;
      if (!ground->moves[c]) continue;
      strut_signal_evaluate(scene->signals, ground->motion[c], t, &ground_motion->place[c],
                            &ground_motion->rate[c]);
      ground_motion->bend[c] = strut_signal_acceleration(scene->signals, ground->motion[c], t);
    }
}

void strut_loads_apply(const strut_model *model, const strut_state *state, double t,
                       const double *restrict velocity) {
  const strut_load_table *loads = &model->loads;
  for (int32_t i = 0; i < loads->count; i++) {
    double factor, rate;
    evaluate(model, state, velocity, loads->signal[i], t + state->time_offset, &factor, &rate);
    if (loads->slot[i] >= 0) { /* its element exerts it */
      state->latest->rest[loads->slot[i]] = factor * loads->x[i];
      continue;
    }
    int32_t at = 2 * loads->node[i];
    double px = factor * loads->x[i], py = factor * loads->y[i];
    state->latest->force[at] += px;
    state->latest->force[at + 1] += py;
    if (!state->balance) continue;
    double power = px * velocity[at] + py * velocity[at + 1];
    strut_power_add(state->latest->power, STRUT_POWER_LOAD, power);
  }
}

/* The earlier of `first` and the next break of a signal. */
static double earlier_break(const strut_model *model, const strut_state *state, int32_t signal,
                            double t, double first) {
  return fmin(first, strut_signal_next_break_since(model->scene->signals, state->signals.started,
                                                   signal, t, first));
}

/* Of what never follows the motion. */
static double next_break_of_motions(const strut_model *model, const strut_state *state, double t,
                                    double first) {
  const strut_scene *scene = model->scene;
  for (int32_t i = 0; i < model->support_motion.count; i++)
    first = earlier_break(model, state, model->support_motion.item[i].signal, t, first);
  for (size_t i = 0; i < scene->unbalance_count; i++)
    if (scene->unbalances[i].signal >= 0)
      first = earlier_break(model, state, scene->unbalances[i].signal, t, first);
  for (int32_t k = 0; k < model->sliding.moving_count; k++)
    first =
        earlier_break(model, state, model->sliding.item[model->sliding.moving[k]].signal, t, first);
  for (size_t g = 0; g < scene->ground_count && model->contacts.moves; g++)
    for (int c = 0; c < 2; c++)
      if (scene->grounds[g].moves[c])
        first = earlier_break(model, state, scene->grounds[g].motion[c], t, first);
  return first;
}

double strut_drive_next_break(const strut_model *model, const strut_state *state, double t,
                              double until) {
  double first = fmin(until, strut_feedback_next_sample(model, t));
  for (int32_t i = 0; i < model->elements.breakable_count; i++)
    if (model->elements.breakable[i].time > t)
      first = fmin(first, model->elements.breakable[i].time);
  first = next_break_of_motions(model, state, t, first);
  for (int32_t i = 0; i < model->drives.count; i++)
    first = earlier_break(model, state, model->drives.signal[i], t, first);
  for (int32_t i = 0; i < model->loads.count; i++)
    first = earlier_break(model, state, model->loads.signal[i], t, first);
  for (int32_t i = 0; i < model->contacts.count && model->contacts.grips; i++)
    if (model->contacts.entry[i].friction.driven)
      first = earlier_break(model, state, model->contacts.entry[i].friction.signal, t, first);
  for (int32_t i = 0; i < model->actuator_forces.count; i++)
    first = earlier_break(model, state, model->actuator_forces.item[i].signal, t, first);
  for (size_t i = 0; i < model->scene->state_count; i++)
    first = fmin(first, strut_program_next_break(model->scene->signals, state->signals.started,
                                                 &model->scene->states[i].rate, t, first));
  return first;
}

bool strut_drive_is_looked_at(const strut_model *model) {
  const strut_scene *scene = model->scene;
  bool any = scene->state_count > 0;
  for (size_t i = 0; i < scene->signal_count; i++)
    any = any || strut_signal_is_looked_at(&scene->signals[i]);
  return any;
}

double strut_drive_longest_step(const strut_model *model, const strut_state *state, double t,
                                double h, double faint, double least) {
  const strut_scene *scene = model->scene;
  const strut_signal_inputs now = strut_drive_inputs(model, state, state->v);
  const strut_signal_inputs *in = model->terms & STRUT_TERM_FEEDBACK ? &now : NULL;
  for (size_t i = 0; i < scene->signal_count; i++)
    h = strut_signal_longest_step(scene->signals, in, (int32_t)i, t, h, faint, least);
  for (size_t i = 0; i < scene->state_count; i++)
    h = strut_program_longest_step(&scene->states[i].rate, scene->signals, in, t, h, faint, least);
  return h;
}

/* de/dq of the strain that the force works on. */
static void gradient_of(const strut_actuator_force *force, const uint32_t *at, const double *q,
                        double *second) {
  if (force->strain == STRUT_STRAIN_ANGLE)
    strut_strain_angle(at, force->nodes, q, 0.0, second);
  else
    strut_strain_path(at, force->nodes, q, 0.0, second);
}

void strut_actuator_forces_apply(const strut_model *model, const strut_state *state, double t,
                                 const double *q, const double *velocity) {
  const strut_actuator_force_table *table = &model->actuator_forces;
  for (int32_t i = 0; i < table->count; i++) {
    const strut_actuator_force *force = &table->item[i];
    const uint32_t *at = table->at + force->first;
    double b[2 * STRUT_MOST_ELEMENT_NODES], size, speed = 0.0;
    size = strut_drive_signal(model, state, velocity, force->signal, t + state->time_offset);
    gradient_of(force, at, q, b);
    state->latest->actuator_force[i] = size;
    for (int32_t k = 0; k < force->nodes; k++) {
      state->latest->force[at[k]] -= size * b[2 * k];
      state->latest->force[at[k] + 1] -= size * b[2 * k + 1];
      speed += b[2 * k] * velocity[at[k]] + b[2 * k + 1] * velocity[at[k] + 1];
    }
    if (!state->balance) continue;
    strut_power_add(state->latest->power, STRUT_POWER_DRIVE, -size * speed);
  }
}

double strut_actuator_force_on(const strut_model *model, const strut_state *state, int32_t member,
                               int32_t hinge) {
  const strut_actuator_force_table *table = &model->actuator_forces;
  double sum = 0.0;
  for (int32_t i = 0; i < table->count; i++)
    if (table->item[i].member == member && table->item[i].hinge == hinge)
      sum += state->latest->actuator_force[i];
  return sum;
}
