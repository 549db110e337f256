/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Relays: signals that switch between two values, when their input passes the upper threshold upwards or
 * the lower one downwards. Methods with events locate that; others switch at the ends of steps.
 */
#ifndef STRUT_ENGINE_FORCES_RELAY_H
#define STRUT_ENGINE_FORCES_RELAY_H

#include "engine/model/state.h"

/*
 * Of the functions below, those with a time `now` [s] of the signals take the sensors as they were
 * evaluated last, and internal states at velocities v.
 */

/** Sets the side of a relay at t = 0. */
void strut_relay_start(const strut_model *model, strut_state *state, int32_t signal, double now,
                       const double *v);
/** How far the input is from the threshold that switches the relay; negative beyond it. */
double strut_relay_margin(const strut_model *model, const strut_state *state, int32_t signal,
                          double now, const double *v);
/** Switches a relay whose input is beyond its threshold, as when it is sampled. True if it was. */
bool strut_relay_sample(const strut_model *model, strut_state *state, int32_t signal, double now,
                        const double *v);

/**
 * Switches a relay at time t [s] of the steps and the state's positions and velocities. Where what it
 * drives takes its own input past the other threshold at once, state->trouble says so.
 */
void strut_relay_switch(const strut_model *model, strut_state *state, int32_t signal, double t);
/** Switches every relay that is not sampled and whose input is beyond its threshold. True if one was. */
bool strut_relays_follow(const strut_model *model, strut_state *state, double t);

#endif
