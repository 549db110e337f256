/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The sparse matrices of small motions about a shape. */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_LINEAR_MATRICES_H
#define STRUT_ENGINE_STATICS_RIGIDITY_LINEAR_MATRICES_H

#include "engine/model/model.h"
#include "engine/model/sparse.h"

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
STRUT_API strut_status strut_linear_matrices_build(const strut_model *model, const double *q,
                                                   strut_arena *arena,
                                                   strut_linear_matrices *matrices);

#endif
