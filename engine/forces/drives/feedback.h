/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Sensors, and the drives that follow them, at every force evaluation. */
#ifndef STRUT_ENGINE_FORCES_DRIVES_FEEDBACK_H
#define STRUT_ENGINE_FORCES_DRIVES_FEEDBACK_H

#include "engine/model/state.h"

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

/** The first sample after t [s]; INFINITY: there is none. */
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

#endif
