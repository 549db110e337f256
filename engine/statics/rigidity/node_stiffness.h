/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Static stiffness of nodes: what a small force at a node meets along its direction, 1/(d' K^-1 d).
 *
 * K is that of members, their forces, and closed contacts, which hold along the ground as across it, as
 * sticking friction does. Rigid motions that nothing resists are taken out of the force.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_NODE_STIFFNESS_H
#define STRUT_ENGINE_STATICS_RIGIDITY_NODE_STIFFNESS_H

#include "engine/model/model.h"

/** Free coordinates at most: K is dense here. */
enum { STRUT_STIFFNESS_COORDINATES = 1000 };

typedef struct strut_node_stiffness strut_node_stiffness;

/**
 * At the shape q, which is an equilibrium. *reason: why there is none, a constant, and *stiffness is
 * NULL; else NULL. The model must outlive it.
 */
STRUT_API strut_status strut_node_stiffness_create(const strut_model *model, const double *q,
                                                   strut_node_stiffness **stiffness,
                                                   const char **reason, strut_error *error);
/** Along the unit vector `direction` [N/m]; NAN where the node cannot move that way. */
STRUT_API double strut_node_stiffness_along(strut_node_stiffness *stiffness, int32_t node,
                                            const double direction[2]);
STRUT_API void strut_node_stiffness_free(strut_node_stiffness *stiffness); /* NULL is allowed */

#endif
