/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Supports that move, as methods step them; see engine/model/support_motion.h.
 *
 * Their positions and velocities are those of their signals at every stage. The reaction on moved
 * coordinates c is R = M_cf a_f + M_cc a_c - F_c. Its work is that of the energy balance's power
 * -a_c' M_cf v_f - F_c' v_c, which needs no a_f, and the change of v_c' M_cf v_f + v_c' M_cc v_c / 2.
 */
#ifndef STRUT_ENGINE_FORCES_DRIVES_SUPPORT_MOTION_H
#define STRUT_ENGINE_FORCES_DRIVES_SUPPORT_MOTION_H

#include "engine/model/state.h"

/** Puts the moved coordinates of q and v (length) where their signals are at time t [s]. */
void strut_support_motion_place(const strut_model *model, const strut_state *state, double t,
                                double *q, double *velocity);
/**
 * Adds -M_fc a_c at time t to state->latest->force, and the power of the supports at velocities v. Comes after
 * all forces that act on moved coordinates.
 */
void strut_support_motion_apply(const strut_model *model, const strut_state *state, double t,
                                const double *velocity);
/** The same on average over a step of h [s] that changes the moved velocities from `before` to `after`
    (moved coordinates), with mean velocities u. */
void strut_support_motion_apply_mean(const strut_model *model, const strut_state *state, double h,
                                     const double *before, const double *after, const double *u);
/**
 * The impulse of velocities that jump after the time `from` and up to `to` [s]: free neighbours answer
 * by -M_ff^-1 M_fc times the jump. True if there was one.
 */
bool strut_support_motion_kick(const strut_model *model, strut_state *state, double from,
                               double to);

/** Work of the supports since strut_energy_reset_load_work [J]. */
double strut_support_motion_work(const strut_model *model, const strut_state *state);
/** Makes the present velocities those from which that work counts. */
void strut_support_motion_reset_work(const strut_model *model, strut_state *state);

#endif
