/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Velocities that jump, where something changes its speed at once.
 */
#ifndef STRUT_ENGINE_FORCES_IMPULSE_H
#define STRUT_ENGINE_FORCES_IMPULSE_H

#include "engine/model/state.h"

/**
 * The velocities answer to the impulses that state->force holds [N s]; with the ledger the work that these do
 * is that of `power`. Needs state->support_answer.
 */
void strut_impulse_apply(const strut_model *model, strut_state *state, strut_power power);

#endif
