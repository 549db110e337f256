/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Drives: terms that change with time alone, applied to the state, and computed for many evaluations at once.
 */
#pragma once

#include "engine/model/algebra/hot.h"
#include "engine/model/state.h"

/* Forces' terms that change with time alone; those of members and ground are in *_kernel.h. */

/**
 * Driven rest lengths and their rates (6): state->latest->rest, rest_rate. Drives that follow sensors do so at
 * the state's positions and velocities.
 */
void strut_drive_apply(const strut_model *model, const strut_state *state, double t);
/** The same with the sensors as they were evaluated last: the second half of strut_feedback_apply. */
void strut_drive_apply_sensed(const strut_model *model, const strut_state *state, double t,
                              const double *velocity);
/** Inputs of signals: the sensors as they were evaluated last, and the states at velocities v. */
strut_signal_inputs strut_drive_inputs(const strut_model *model, const strut_state *state,
                                       const double *velocity);
/** A signal at time t [s], with the sensors as they were evaluated last, and states at velocities v. */
double strut_drive_signal(const strut_model *model, const strut_state *state,
                          const double *velocity, int32_t signal, double t);
/** Adds the loads that change with time at velocities v (for their power). */
void strut_loads_apply(const strut_model *model, const strut_state *state, double t,
                       const double *restrict velocity);

/** Motion of every ground (grounds) at time t of the signals: 0 of those at rest. */
void strut_grounds_move(const strut_model *model, double t, strut_ground_motion *motion);

/**
 * The first time after t [s] at which a drive, a load or its rate jumps, or something is released;
 * INFINITY if none does. Those after `until` may be left out.
 */
double strut_drive_next_break(const strut_model *model, const strut_state *state, double t,
                              double until);

/** Has the model expressions or pulses, for which steps may have to be shorter? */
bool strut_drive_is_looked_at(const strut_model *model);
/**
 * The longest step from time t [s] of the signals, at most h, over which begin, middle and end show what all of them do;
 * see strut_program_longest_step.
 */
double strut_drive_longest_step(const strut_model *model, const strut_state *state, double t,
                                double h, double faint, double least);

/* Forces and moments of actuators; see engine/model/elements.h. */

/**
 * Adds the actuators' forces at time t [s] and positions q to state->latest->force, and their power at
 * velocities v to the drive's. Notes their sizes in state->latest->actuator_force.
 */
void strut_actuator_forces_apply(const strut_model *model, const strut_state *state, double t,
                                 const double *q, const double *velocity);

/** Sum of what actuators add to a member's own force or a hinge's moment, when last applied; the other one is -1. */
double strut_actuator_force_on(const strut_model *model, const strut_state *state, int32_t member,
                               int32_t hinge);

/*
 * Hot: driven rest lengths for many evaluations to come, for methods that know beforehand when these are:
 * sines are computed by vectors (signal_vector.h), with the bits of strut_drive_apply.
 *
 * Holds for a run of steps, during which neither drives nor time_offset change.
 */

enum { STRUT_DRIVES_AHEAD = 8, STRUT_INSTANTS_AHEAD = 32 };

typedef struct strut_drives_ahead {
  bool used;
  int32_t next, count;                                    /* instants */
  double time[STRUT_INSTANTS_AHEAD];                      /* of the signals [s] */
  double value[STRUT_DRIVES_AHEAD][STRUT_INSTANTS_AHEAD]; /* of each drive [m] */
  double rate[STRUT_DRIVES_AHEAD][STRUT_INSTANTS_AHEAD];  /* [m/s] */
} strut_drives_ahead;

/**
 * The drives' values at the first `count` of drives->time, which the caller has filled up to a whole number of
 * STRUT_LANES.
 */
void strut_drives_ahead_evaluate(const strut_model *model, strut_drives_ahead *drives,
                                 int32_t count);

/*
 * terms: as a copy of a step loop knows them. Drives of rare terms may follow sensors, and are not known
 * beforehand.
 */
STRUT_INLINE void drives_ahead_begin(const strut_model *model, unsigned terms,
                                     strut_drives_ahead *drives) {
  drives->used = terms == STRUT_TERMS_COMMON && model->terms & STRUT_TERM_DRIVE &&
                 model->drives.count <= STRUT_DRIVES_AHEAD;
  drives->next = drives->count = 0;
}

/*
 * row[j] = x, by a store as wide as the loads of members: a wider load than the store before it would have to
 * wait.
 */
STRUT_INLINE void drives_ahead_put(double *row, uint32_t j, double x) {
  const strut_lane_mask place = {0, 1, 2, 3};
  double *group = row + j / STRUT_LANES * STRUT_LANES;
  strut_lanes all = {x, x, x, x};
  strut_lanes_store(
      group, four_choose(place == (long long)(j % STRUT_LANES), all, strut_lanes_load(group)));
}

/* Rest lengths at the next instant, which is time t of the state. */
STRUT_INLINE void drives_ahead_place(const strut_model *model, const strut_state *state,
                                     strut_drives_ahead *drives, double t) {
  const strut_drive_table *table = &model->drives;
  int32_t h = drives->next++;
  for (int32_t i = 0; i < table->count; i++) {
    uint32_t j = (uint32_t)table->member[i];
    /* the first actuator of a member starts from its own rest length, further ones add */
    double rest = table->first[i] ? model->members.rest[j] : state->latest->rest[j];
    double rate = drives->rate[i][h];
    drives_ahead_put(state->latest->rest, j, rest + drives->value[i][h]);
    drives_ahead_put(state->latest->rest_rate, j,
                     table->first[i] ? rate : state->latest->rest_rate[j] + rate);
  }
  state->latest->drive_time = t;
}

/**
 * Rest lengths at time t = step * dt; `step` may be a half. Evaluations are `part` steps apart, and `most` of
 * them are still to come. Does nothing where the state has them already, or where drives cannot be known
 * beforehand.
 */
STRUT_INLINE void drives_ahead_apply(const strut_model *model, const strut_state *state,
                                     strut_drives_ahead *drives, double t, double step, double part,
                                     double dt, int64_t most) {
  if (!drives->used || t == state->latest->drive_time) return;
  if (drives->next == drives->count || drives->time[drives->next] != t + state->time_offset) {
    for (int32_t h = 0; h < STRUT_INSTANTS_AHEAD; h++)
      drives->time[h] = (step + part * (double)h) * dt + state->time_offset;
    strut_drives_ahead_evaluate(model, drives,
                                most < STRUT_INSTANTS_AHEAD ? (int32_t)most : STRUT_INSTANTS_AHEAD);
  }
  drives_ahead_place(model, state, drives, t);
}

/** Foresees the stages of one step of h from t on: 1 to `count`, none of them before the first or after the last. */
STRUT_INLINE void drives_ahead_stages(const strut_model *model, const strut_state *state,
                                      strut_drives_ahead *drives, double t, double h,
                                      const double *part, int32_t count) {
  if (!drives->used) return;
  for (int32_t k = 0; k < (count + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES; k++)
    drives->time[k] = t + part[k < count ? k + 1 : count] * h + state->time_offset;
  strut_drives_ahead_evaluate(model, drives, count);
}

/**
 * Foresees the ends of whole steps of h from step * h on, one after the other, unless the next of them has
 * been: some, since an event may come between.
 */
STRUT_INLINE void drives_ahead_ends(const strut_model *model, const strut_state *state,
                                    strut_drives_ahead *drives, double h) {
  enum { ENDS = 2 * STRUT_LANES };
  double begin = (double)state->step * h;
  if (!drives->used || (drives->next < drives->count &&
                        drives->time[drives->next] == begin + h + state->time_offset))
    return;
  for (int32_t k = 0; k < ENDS; k++)
    drives->time[k] = (double)(state->step + k) * h + h + state->time_offset;
  strut_drives_ahead_evaluate(model, drives, ENDS);
}

/** Rest lengths at time t, if that is the next stage; else strut_drive_apply will do it. */
STRUT_INLINE void drives_ahead_meet(const strut_model *model, const strut_state *state,
                                    strut_drives_ahead *drives, double t) {
  if (!drives->used || t == state->latest->drive_time || drives->next == drives->count) return;
  if (drives->time[drives->next] == t + state->time_offset)
    drives_ahead_place(model, state, drives, t);
}

/* Sensors, and the drives that follow them, at every force evaluation. */

/**
 * Measures all sensors at time t [s], positions q and velocities v, and sets the driven rest lengths
 * and their rates from them. For models with STRUT_TERM_FEEDBACK. The first evaluation since the reset, which is at
 * the start of the motion, takes the first samples and the sides of relays; no later one writes signal memory.
 */
void strut_feedback_apply(const strut_model *model, const strut_state *state, double t,
                          const double *q, const double *velocity);

/** Rates of the internal states at velocities v into `force`, after strut_feedback_apply. */
void strut_feedback_add_rates(const strut_model *model, const strut_state *state, double t,
                              const double *velocity, double *force);

/** The time of the first sample after t [s], or INFINITY if no sample follows. */
double strut_feedback_next_sample(const strut_model *model, double t);
/**
 * Samples the signals that are due at time t [s] of the steps, within the tolerance [s], at the state's
 * positions and velocities. True if there was one.
 */
bool strut_feedback_sample(const strut_model *model, strut_state *state, double t,
                           double tolerance);

/**
 * Starts the signals that wait for the touchdown of a contact, at time t [s] of the steps. True if there
 * was one.
 */
bool strut_feedback_touch(const strut_model *model, strut_state *state, int32_t contact, double t);
/**
 * For methods without events: looks at triggers at the state's positions and velocities, and starts signals whose
 * condition holds now and did not before. True if one has started.
 */
bool strut_feedback_watch(const strut_model *model, strut_state *state, double t);

/* Thresholds: of relays, and of sensors that start signals. Methods with events locate where they are passed. */

/** Before the first step: on which side of their levels the sensors are that start signals, as evaluated last. */
void strut_threshold_begin(const strut_model *model, strut_state *state);
/** How far the signal's input is from its threshold, of sensors as they were evaluated last and internal states at
    velocities v; 1 where it has none any more. Negative beyond it. And its rate, where that is known; else 0. */
double strut_threshold_margin(const strut_model *model, const strut_state *state, int32_t signal,
                              double now, const double *velocity, double *rate);
/** Passes it at time t [s] of the steps: a relay switches, a signal starts, or may start again. */
void strut_threshold_pass(const strut_model *model, strut_state *state, int32_t signal, double t);

/* Relays: signals that switch between two values, when their input passes the upper threshold upwards or
 * the lower one downwards. Methods with events locate that; others switch at the ends of steps.
 */

/** Switches every relay that is not sampled and whose input is beyond its threshold. True if one was. */
bool strut_relays_follow(const strut_model *model, strut_state *state, double t);
