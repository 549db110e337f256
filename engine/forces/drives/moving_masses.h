/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What moves in the structure by signals: masses along members, masses out of balance, and supports. */
#pragma once

#include "engine/model/state.h"

/* Masses that slide along members as their signals say; see model.h.
 *
 * A mass m at x = N q, N = (1 - s, s), adds m N'N to the mass matrix and the force
 * N'm (g - 2 s' (v_b - v_a) - s'' (q_b - q_a)). With the constant matrix M factored, a = M^-1 f becomes
 * a - M^-1 N' (1/m + N M^-1 N')^-1 N a, for several of them with a small dense matrix. The drive gives
 * m (x'' - g) along the member, times s' (q_b - q_a).
 */

/** Puts the moving masses where they are at time t [s], and factors what the acceleration needs. */
void strut_sliding_masses_place(const strut_model *model, const strut_state *state, double t);
/** Does that, and adds their forces at positions q and velocities v to state->latest->force. */
void strut_sliding_masses_apply(const strut_model *model, const strut_state *state, double t,
                                const double *q, const double *velocity);
/** From a = M^-1 f (length) to the acceleration with the moving masses, as they have been placed. */
void strut_sliding_masses_correct(const strut_model *model, const strut_state *state,
                                  double *acceleration);
/** Adds the power of what drives them along their members, with the acceleration a. */
void strut_sliding_masses_add_power(const strut_model *model, const strut_state *state,
                                    const double *q, const double *velocity,
                                    const double *acceleration);
/** Adds what kinetic and gravity energies of the moving masses are more than at their start. */
void strut_sliding_masses_add_energies(const strut_model *model, const strut_state *state,
                                       const double *q, const double *velocity, double *kinetic,
                                       double *gravity);
/** Mass moment beyond that of the weights of the nodes, sum of m x, of one coordinate [kg m]; for the centre
    of mass. */
double strut_sliding_masses_moment(const strut_model *model, const strut_state *state, int axis,
                                   const double *q);
/** Its rate [kg m/s]. */
double strut_sliding_masses_momentum(const strut_model *model, const strut_state *state, int axis,
                                     const double *q, const double *velocity);

/* Rotating masses. A mass m at the distance r from its node, at the angle p from +x, adds m to the node's
 * mass and the force -m r d2e/dt2 with e = (cos p, sin p). Its work is the drive's: what the motor does
 * on the structure, not on the rotor itself.
 */

/** Adds the forces at time t [s] to state->latest->force, and their power at velocities v. */
void strut_unbalance_apply(const strut_model *model, const strut_state *state, double t,
                           const double *velocity);
/** Adds the forces on average over the time from t on for h [s], impulses within it too; u: mean velocity. */
void strut_unbalance_apply_mean(const strut_model *model, const strut_state *state, double t,
                                double h, const double *u);
/*
 * Supports that move, as methods step them; see model.h.
 *
 * Their positions and velocities are those of their signals at every stage. The reaction on moved
 * coordinates c is R = M_cf a_f + M_cc a_c - F_c. Its work is that of the energy balance's power
 * -a_c' M_cf v_f - F_c' v_c, which needs no a_f, and the change of v_c' M_cf v_f + v_c' M_cc v_c / 2.
 */

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
 * The impulses of velocities along members, of supports and of angular velocities that jump after the time `from`
 * and up to `to` [s], on state->v: free neighbours of a support answer by -M_ff^-1 M_fc times its jump. True if
 * there were any. Places sliding masses at the time `to`.
 */
bool strut_moving_kick(const strut_model *model, strut_state *state, double from, double to);

/** Work of the supports since strut_energy_reset_load_work [J]. */
double strut_support_motion_work(const strut_model *model, const strut_state *state);
/** Makes the present velocities those from which that work counts. */
void strut_support_motion_reset_work(const strut_model *model, strut_state *state);
