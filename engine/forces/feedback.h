/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Sensors, and the drives that follow them, at every force evaluation. */
#ifndef STRUT_ENGINE_FORCES_FEEDBACK_H
#define STRUT_ENGINE_FORCES_FEEDBACK_H

#include "engine/model/state.h"

/**
 * Measures all sensors at time t [s], positions q and velocities v, and sets the driven rest lengths
 * and their rates from them. For models with STRUT_TERM_FEEDBACK.
 */
void strut_feedback_apply(const strut_model *model, strut_state *state, double t, const double *q,
                          const double *v);

/** Rates of the internal states at velocities v into `force`, after strut_feedback_apply. */
void strut_feedback_add_rates(const strut_model *model, strut_state *state, double t,
                              const double *v, double *force);

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
 * Looks at triggers at the state's positions and velocities, and starts signals whose condition holds now
 * and did not before; those of contacts only where `contacts` is true. True if one has started.
 */
bool strut_feedback_watch(const strut_model *model, strut_state *state, double t, bool contacts);

#endif
