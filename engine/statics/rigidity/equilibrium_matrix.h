/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equilibrium matrix A of a shape: what forces on the nodes the member forces balance.
 *
 * A t = f: member forces t [N], tension positive, hold the loads f [N] on the free coordinates. Its
 * transpose gives the elongations A' d of small displacements d. A column is a member's unit vector
 * from its first node to its second, negative at the first, positive at the second, so that A knows
 * no lengths. Members between held coordinates, or without length, have a column of zeros.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_EQUILIBRIUM_MATRIX_H
#define STRUT_ENGINE_STATICS_RIGIDITY_EQUILIBRIUM_MATRIX_H

#include "engine/model/model.h"

typedef struct strut_equilibrium_matrix {
  int32_t rows;           /* free coordinates */
  int32_t columns;        /* members */
  int32_t *coordinate;    /* (rows) index into coordinate arrays */
  int32_t *row_of;        /* (length) row of a coordinate, -1 where fixed */
  double *length;         /* (columns) of the members in the shape [m] */
  double (*direction)[2]; /* (columns) unit vector from first node to second; 0, 0 without length */
  int32_t *start;         /* (columns + 1) A by columns */
  int32_t *row;           /* (start[columns]) ascending within a column */
  double *value;          /* (start[columns]) */
} strut_equilibrium_matrix;

/** A of the positions q (length), in the arena. STRUT_OK or STRUT_NO_MEMORY. */
STRUT_API strut_status strut_equilibrium_matrix_build(const strut_model *model, const double *q,
                                                      strut_arena *arena,
                                                      strut_equilibrium_matrix *a);

/** y (rows) = A t for t (columns). */
STRUT_API void strut_equilibrium_multiply(const strut_equilibrium_matrix *a, const double *t,
                                          double *y);
/** e (columns) = A' d for d (rows). */
STRUT_API void strut_equilibrium_elongate(const strut_equilibrium_matrix *a, const double *d,
                                          double *e);

/** A as (rows, columns) row by row into dense, which holds zeros. */
STRUT_API void strut_equilibrium_dense(const strut_equilibrium_matrix *a, double *dense);

#endif
