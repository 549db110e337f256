/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the statics of a shape is made of: null spaces, matrices of small motions, stiffness of nodes.
 */
#pragma once

#include "engine/model/algebra/linear_solver.h"
#include "engine/model/model.h"
#include "engine/statics/rigidity/rigidity.h"

/* Both decompositions that strut_null_spaces_find chooses from. */

strut_status strut_null_spaces_dense(const strut_equilibrium_matrix *matrix, strut_arena *arena,
                                     strut_null_spaces *spaces, strut_error *error);
strut_status strut_null_spaces_sparse(const strut_equilibrium_matrix *matrix, strut_arena *arena,
                                      strut_null_spaces *spaces, strut_error *error);

/* The sparse matrices of small motions about a shape. */

typedef struct strut_linear_matrices {
  int32_t n;               /* free coordinates */
  strut_sparse *mass;      /* [kg] consistent or lumped, as the scene says */
  strut_sparse *elastic;   /* sum of c u u' over members that are not slack [N/m] */
  strut_sparse *geometric; /* sum of (t / L) (1 - u u') over the same [N/m] */
  strut_sparse *contact;   /* of the nodes below the ground's line [N/m]; NULL where none is */
  strut_sparse *damping;   /* of members and of those nodes [N s/m] */
} strut_linear_matrices;

/**
 * At positions q (length), drives at rest, in the arena. A member without length has no direction:
 * nothing of it counts, unless its rest length is zero too; then c acts alike in all directions.
 * STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_linear_matrices_build(const strut_model *model,
                                                   const double *positions, strut_arena *arena,
                                                   strut_linear_matrices *matrices);

/* Static stiffness of nodes: what a small force at a node meets along its direction, 1/(d' K^-1 d).
 *
 * K is that of members, their forces, and closed contacts, which hold along the ground as across it, as
 * sticking friction does. Rigid motions that nothing resists are taken out of the force.
 */

/** Free coordinates at most: K is dense here. */
enum { STRUT_STIFFNESS_COORDINATES = 1000 };

typedef struct strut_node_stiffness strut_node_stiffness;

/**
 * At the shape q, which is an equilibrium. *reason: why there is none, a constant, and *stiffness is
 * NULL; else NULL. The model must outlive it.
 */
STRUT_API strut_status strut_node_stiffness_create(const strut_model *model,
                                                   const double *positions,
                                                   strut_node_stiffness **stiffness,
                                                   const char **reason, strut_error *error);
/** Along the unit vector `direction` [N/m]; NAN where the node cannot move that way. */
STRUT_API double strut_node_stiffness_along(strut_node_stiffness *stiffness, int32_t node,
                                            const double direction[2]);
STRUT_API void strut_node_stiffness_free(strut_node_stiffness *stiffness); /* NULL is allowed */
