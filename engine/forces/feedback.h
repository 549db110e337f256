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

#endif
