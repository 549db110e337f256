/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * All forces of a model at one instant, summed in a fixed order, and the acceleration they give.
 *
 * Only the terms in the model's terms are evaluated. Coordinate arrays are (length).
 */
#pragma once

#include "engine/model/state.h"

/**
 * a = M^-1 (constant + loads - K - C + contact), equation (10), at time t [s], positions q [m] and
 * velocities v [m/s], which need not be the state's own. Fills state->latest->force, normal, friction, rest
 * and, with the energy balance, power. The model must have a mass.
 */
STRUT_API void strut_forces_acceleration(const strut_model *model, const strut_state *state,
                                         double t, const double *restrict q,
                                         const double *restrict velocity,
                                         double *restrict acceleration);

/** The same without the mass: leaves the net forces in state->latest->force. */
STRUT_API void strut_forces_evaluate(const strut_model *model, const strut_state *state, double t,
                                     const double *restrict q, const double *restrict velocity);

/**
 * The forces at the state itself at time t [s], for recording and measuring: contact forces are those
 * that a method with events holds, and the evaluation is not counted.
 */
STRUT_API void strut_forces_observe(const strut_model *model, const strut_state *state, double t);

/** Shows the contact forces that a method with events holds in normal and friction; false: it holds none. */
STRUT_API bool strut_forces_show_held(const strut_model *model, const strut_state *state);

/** One member: length [m], its rate [m/s], force [N] (tension positive). */
typedef struct strut_member_values {
  double length, rate, force;
} strut_member_values;
/** At positions q and velocities v, with the state's rest lengths; without the forces that hold rigid
    bars and those of actuators. */
STRUT_API strut_member_values strut_member_measure_at(const strut_model *model,
                                                      const strut_state *state, int32_t member,
                                                      const double *q, const double *velocity);

/* The energies that a state stores, and the work that constant loads have done. */

/** All in [J]. */
typedef struct strut_energies {
  double kinetic; /* v'Mv / 2 with the scene's mass model */
  double elastic; /* first term of (13); slack cables store nothing; driven rest lengths count */
  double gravity; /* second term of (13), for any gravity vector; zero at the origin */
  double contact; /* of the ground's springs */
} strut_energies;

/** Energies at the state's q and v, with the driven rest lengths at time t [s]. */
STRUT_API strut_energies strut_energy_evaluate(const strut_model *model, const strut_state *state,
                                               double t);

/** The same at positions q and velocities v, with the state's rest lengths as they are. */
STRUT_API strut_energies strut_energy_evaluate_at(const strut_model *model,
                                                  const strut_state *state, const double *q,
                                                  const double *velocity);

/** The first of them alone, at velocities v (length) [J]. */
STRUT_API double strut_energy_kinetic(const strut_model *model, const double *velocity);

/** Sum of constant load times position [J], gravity left out: its change is the work of the loads. */
STRUT_API double strut_energy_load_potential(const strut_model *model, const strut_state *state);

/** Work of the constant loads since strut_energy_reset_load_work, which must have been called [J]. */
STRUT_API double strut_energy_load_work(const strut_model *model, const strut_state *state);
/** Makes the state's present positions those from which the loads' work counts. */
STRUT_API void strut_energy_reset_load_work(const strut_model *model, strut_state *state);

/* Velocities that jump, where something changes its speed at once. */

/**
 * The velocities answer to the impulses that state->latest->force holds [N s]; with the energy balance the
 * work that these do is that of `power`. Needs state->buffers->support_answer.
 */
STRUT_API void strut_impulse_apply(const strut_model *model, strut_state *state, strut_power power);
