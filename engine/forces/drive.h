/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Forces' terms that change with time alone; those of members and ground are in *_kernel.h. */
#ifndef STRUT_ENGINE_FORCES_DRIVE_H
#define STRUT_ENGINE_FORCES_DRIVE_H

#include "engine/model/state.h"

/**
 * Driven rest lengths and their rates (6): state->rest, rest_rate. Drives that follow sensors do so at
 * the state's positions and velocities.
 */
void strut_drive_apply(const strut_model *model, strut_state *state, double t);
/** The same with the sensors as they were evaluated last: the second half of strut_feedback_apply. */
void strut_drive_apply_sensed(const strut_model *model, strut_state *state, double t,
                              const double *v);
/** Inputs of signals: the sensors as they were evaluated last, and the states at velocities v. */
strut_signal_inputs strut_drive_inputs(const strut_model *model, const strut_state *state,
                                       const double *v);
/** A signal at time t [s], with the sensors as they were evaluated last, and states at velocities v. */
double strut_drive_signal(const strut_model *model, const strut_state *state, const double *v,
                          int32_t signal, double t);
/** Adds the loads that change with time at velocities v (for their power). */
void strut_loads_apply(const strut_model *model, strut_state *state, double t,
                       const double *restrict v);

/** Motion of every ground (grounds) at time t of the signals: 0 of those at rest. */
void strut_grounds_move(const strut_model *model, double t, strut_ground_motion *motion);

/**
 * The first time after t [s] at which a drive, a load or its rate jumps, or something is released;
 * INFINITY if none does.
 */
double strut_drive_next_break(const strut_model *model, const strut_state *state, double t);

#endif
