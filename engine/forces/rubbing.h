/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Friction of elements that press (engine/model/model.h), where they touch.
 *
 * The surfaces slide on each other by b v, b over the coordinates of the element's nodes: friction F there is F b
 * on them, of a foot with its moment on the member. Its law is one without stick, or of bristles, under the force by
 * which the element presses. Bodies of collisions are as their nodes and axes lie: friction has no moment by their thickness.
 */
#ifndef STRUT_ENGINE_FORCES_RUBBING_H
#define STRUT_ENGINE_FORCES_RUBBING_H

#include "engine/model/state.h"

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

#endif
