/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Reactions of surfaces (engine/model/surfaces.h): the laws of forces_kernel.h, each contact with its own
 * tangent and normal, and several contacts of one node at once.
 */
#pragma once

#include <assert.h>

#include "engine/model/pose.h"
#include "engine/model/state.h"

/**
 * Adds the reactions to state->latest->force; with the energy balance their powers. Friction comes last, and
 * where several contacts of a node stick within Karnopp's band it is found for all of them together.
 */
void strut_surfaces_add_forces(const strut_model *model, const strut_state *state,
                               const double *restrict q, const double *restrict velocity);

/** Velocity of a node against the surface of contact i: what the ground itself moves by is taken off. */
static inline strut_vec2 strut_contact_velocity(const strut_contact_table *contacts, int32_t i,
                                                const double *velocity,
                                                const strut_ground_motion *motion) {
  assert(i >= 0 && i < contacts->count);
  const double *at = velocity + contacts->at[i];
  const strut_ground_motion *own = strut_contact_motion(contacts, i, motion);
  return own ? (strut_vec2){at[0] - own->rate[0], at[1] - own->rate[1]}
             : (strut_vec2){at[0], at[1]};
}

/** Component of (x, y) along a unit vector. */
static inline double strut_component(const double unit[2], double x, double y) {
  return x * unit[0] + y * unit[1];
}

/** Gap and sliding speed of a contact as a state stands. */
void strut_contact_observe(const strut_contact_table *contacts, int32_t i, const strut_state *state,
                           double *gap, double *slip);

/*
 * Friction of elements that press (engine/model/model.h), where they touch.
 *
 * The surfaces slide on each other by b v, b over the coordinates of the element's nodes: friction F there is F b
 * on them, of a foot with its moment on the member. Its law is one without stick, or of bristles, under the force by
 * which the element presses. Bodies of collisions are as their nodes and axes lie: friction has no moment by their thickness.
 */

enum { STRUT_MOST_RUBBING = 6 }; /* coordinates of an element that rubs */

/** How entry `item` slides with its nodes. b: (2 nodes); returns how many these are. */
int32_t strut_rubbing_slide(const strut_model *model, int32_t item, const double *q,
                            double b[STRUT_MOST_RUBBING]);
/** Adds all this friction to the state's force, and its power; after the elements. */
void strut_rubbing_add_forces(const strut_model *model, const strut_state *state, const double *q,
                              const double *velocity);
/** How fast an entry slides at the state [m/s], and the force that presses it [N]; 0 where it does not touch. */
double strut_rubbing_slip(const strut_model *model, const strut_state *state, int32_t item,
                          double *normal);
/** How fast the bristles of an entry straighten as they slide at the state [1/s]; 0 where it has none. */
double strut_rubbing_bristle_decay(const strut_model *model, const strut_state *state,
                                   int32_t item);
/** Writes the forces of feet over those of their nodes' contacts, which touch nothing themselves. */
void strut_rubbing_show_feet(const strut_model *model, const strut_state *state, const double *q,
                             const double *velocity);
