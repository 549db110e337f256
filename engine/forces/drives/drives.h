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
