/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Which elements may act: of many collisions, those whose bodies are near (Verlet's list).
 *
 * Two bodies that are apart come nearer by at most twice the longest way that a node goes. So a list of all that
 * are within reach serves until a node has gone half of that. Elements that are not listed exert nothing, so the
 * forces are the same, bit by bit, whenever the list was made.
 */
#pragma once

#include "engine/model/state.h"

/** The elements that may act at q, for a model with elements.scattered. Until the next call with the same state. */
const strut_nearby *strut_nearby_at(const strut_model *model, const strut_state *state,
                                    const double *q);
/** The same, for all positions within `way` of q [m]; NULL: the list does not reach as far. */
const strut_nearby *strut_nearby_around(const strut_model *model, const strut_state *state,
                                        const double *q, double way);
/** The list that serves at q already; or NULL, which stands for all elements. */
const strut_nearby *strut_nearby_serving(const strut_model *model, const strut_state *state,
                                         const double *q);
/** Is the element of a collision whose bodies are not near at q; `soon`: nor within the list's way? */
bool strut_nearby_is_far(const strut_model *model, int32_t element, const double *q, bool soon);
/** The least distance at q between the surfaces of two bodies of a collision, negative where they press [m]; which
    element's. */
double strut_nearby_least_gap(const strut_model *model, const strut_state *state, const double *q,
                              int32_t *which);
/** The place in the list of the first element that is not below `element`. */
int32_t strut_nearby_find(const strut_nearby *near, int32_t element);
