/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Coming to rest before a run: dynamic relaxation with kinetic damping.
 */
#ifndef STRUT_ENGINE_RUN_SETTLE_H
#define STRUT_ENGINE_RUN_SETTLE_H

#include <signal.h>

#include "engine/model/state.h"

/**
 * Lets the structure come to rest with actuators, loads on a signal and belt off, and friction too
 * unless the scene keeps it: it is
 * integrated with the scene's method and step, and all velocities are set to zero whenever the
 * kinetic energy has passed a peak, until every speed and acceleration is below the scene's limits.
 * On STRUT_OK the state's positions are those of rest, its velocities 0, its time 0; *time is the
 * simulated time it took [s]. Else STRUT_NOT_SETTLED, STRUT_DIVERGED, STRUT_INTERRUPTED or
 * STRUT_NO_MEMORY.
 */
strut_status strut_settle_state(const strut_model *model, strut_state *state,
                                const volatile sig_atomic_t *interrupt, double *time,
                                strut_error *error);

#endif
