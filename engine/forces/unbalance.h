/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Rotating masses. A mass m at the distance r from its node, at the angle p from +x, adds m to the node's
 * mass and the force -m r d2e/dt2 with e = (cos p, sin p). Its work is the drive's: what the motor does
 * on the structure, not on the rotor itself.
 */
#ifndef STRUT_ENGINE_FORCES_UNBALANCE_H
#define STRUT_ENGINE_FORCES_UNBALANCE_H

#include "engine/model/state.h"

/** Adds the forces at time t [s] to state->latest.force, and their power at velocities v. */
void strut_unbalance_apply(const strut_model *model, strut_state *state, double t, const double *v);
/** Adds the forces on average over the time from t on for h [s], impulses within it too; u: mean velocity. */
void strut_unbalance_apply_mean(const strut_model *model, strut_state *state, double t, double h,
                                const double *u);
/**
 * The impulses of angular velocities that jump after the time `from` and up to `to` [s], on state->v.
 * True if there were any.
 */
bool strut_unbalance_kick(const strut_model *model, strut_state *state, double from, double to);

#endif
