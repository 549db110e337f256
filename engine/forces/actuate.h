/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Forces and moments of actuators; see engine/model/actuator_forces.h. */
#ifndef STRUT_ENGINE_FORCES_ACTUATE_H
#define STRUT_ENGINE_FORCES_ACTUATE_H

#include "engine/model/state.h"

/**
 * Adds the actuators' forces at time t [s] and positions q to state->force, and their power at
 * velocities v to the drive's. Notes their sizes in state->actuator_force.
 */
void strut_actuator_forces_apply(const strut_model *model, strut_state *state, double t,
                                 const double *q, const double *v);

/** Sum of the forces that actuators add to a member's own, when last applied; tension positive [N]. */
double strut_actuator_force_on_member(const strut_model *model, const strut_state *state,
                                      int32_t member);
/** Sum of the moments that actuators add to a hinge's own [N m]. */
double strut_actuator_moment_on_hinge(const strut_model *model, const strut_state *state,
                                      int32_t hinge);
/** Adds the forces on all members to `force` (members). */
void strut_actuator_forces_add_tensions(const strut_model *model, const strut_state *state,
                                        double *force);

#endif
