/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Friction of feet (engine/model/feet.h) at their points of contact, with its moment on the member.
 *
 * The point of contact of an arc that rolls moves along the ground by b v, b over the coordinates of the two
 * nodes: friction F there is -F b on them. Its law is one without stick, under the normal force of the foot's
 * element.
 */
#ifndef STRUT_ENGINE_FORCES_FEET_H
#define STRUT_ENGINE_FORCES_FEET_H

#include "engine/model/state.h"

/** How the point of contact of a foot slides with its two nodes. b: (4). */
void strut_foot_slide(const strut_model *model, int32_t foot, const double *q, double b[4]);
/** Adds the friction of all feet to the state's force, and its power; after the elements. */
void strut_feet_add_forces(const strut_model *model, strut_state *state, const double *q,
                           const double *v);
/** Writes the forces of feet over those of their nodes' contacts, which touch nothing themselves. */
void strut_feet_show(const strut_model *model, strut_state *state, const double *q,
                     const double *v);

#endif
