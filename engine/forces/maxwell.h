/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Maxwell branches of members: a spring k and a dashpot c in a row. The force F is an internal state,
 * F' = k (u' - F / c), with the rate u' of the member's length beyond its rest length. F^2 / 2k is stored
 * and F^2 / c lost.
 */
#ifndef STRUT_ENGINE_FORCES_MAXWELL_H
#define STRUT_ENGINE_FORCES_MAXWELL_H

#include "engine/model/state.h"

/**
 * Adds the forces of all branches at q and v and the rates of these forces to `force`, and with the
 * ledger their powers. The driven rest lengths must be those of this instant.
 */
void strut_maxwell_apply(const strut_model *model, strut_state *state, const double *q,
                         const double *v, double *force);
/** Force of the branch of a member, tension positive [N]; 0 without one. */
double strut_maxwell_force(const strut_model *model, const double *v, int32_t member);
/** Energy stored in all of them [J]. */
double strut_maxwell_energy(const strut_model *model, const double *v);

#endif
