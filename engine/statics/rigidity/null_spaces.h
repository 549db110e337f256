/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The rank of an equilibrium matrix, with the gap that decides it, and its two null spaces.
 *
 * Up to STRUT_DENSE_RIGIDITY rows and columns by singular values; above by sparse QR, the diagonal
 * of whose R then stands in for them. Values above STRUT_RANK_TOLERANCE times the largest count
 * towards the rank. Since the columns of A are unit vectors, the size of a structure or of its
 * parts changes nothing.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_NULL_SPACES_H
#define STRUT_ENGINE_STATICS_RIGIDITY_NULL_SPACES_H

#include "engine/statics/rigidity/equilibrium_matrix.h"

enum { STRUT_DENSE_RIGIDITY = 300 };
#define STRUT_RANK_TOLERANCE 1e-9
#define STRUT_WEAK 1e-6

typedef struct strut_null_spaces {
  bool dense; /* by singular values, else by QR */
  int32_t rank;
  double largest;  /* singular value, or diagonal entry of R */
  double kept;     /* the smallest kept; 0 where the rank is 0 */
  double dropped;  /* the largest dropped; 0 if none was; NAN with QR */
  int32_t weak;    /* of those kept, how many are below STRUT_WEAK times the largest; 0 with QR */
  int32_t states;  /* s = columns - rank */
  int32_t motions; /* f = rows - rank */
  double *state;   /* (states, columns) a basis of A t = 0; NULL: too large, or none */
  double *motion;  /* (motions, rows) orthonormal basis of A' d = 0; NULL: too large, or none */
} strut_null_spaces;

/** In the arena. STRUT_OK, STRUT_NO_MEMORY, or STRUT_SINGULAR where the decomposition fails. */
STRUT_API strut_status strut_null_spaces_find(const strut_equilibrium_matrix *a, strut_arena *arena,
                                              strut_null_spaces *spaces, strut_error *error);

#endif
