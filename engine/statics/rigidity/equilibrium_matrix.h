/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equilibrium matrix A of a shape: what forces on the nodes the member forces balance.
 *
 * A t = f: member forces t [N], tension positive, hold the loads f [N] on the free coordinates. Its
 * transpose gives the elongations A' d of small displacements d. A column is a member's unit vector
 * from its first node to its second, negative at the first, positive at the second, so that A knows
 * no lengths. Members between held coordinates, or without length, have a column of zeros. A running
 * cable's column is the gradient of its whole length. Behind the members stands a column for each
 * hinge: the gradient of its angle times the model's size, so that its force is moment / size [N]. Then
 * one for each cell: the gradient of its area over the size, so that its force is -pressure times size.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_EQUILIBRIUM_MATRIX_H
#define STRUT_ENGINE_STATICS_RIGIDITY_EQUILIBRIUM_MATRIX_H

#include "engine/model/model.h"

typedef struct strut_equilibrium_matrix {
  int32_t rows;    /* free coordinates */
  int32_t columns; /* members, then hinges, then cells */
  int32_t members;
  double size;         /* of the model, by which hinges' moments are divided [m] */
  int32_t *coordinate; /* (rows) index into coordinate arrays */
  int32_t *row_of;     /* (length) row of a coordinate, -1 where fixed */
  double *
      length; /* (columns) of the members in the shape; of hinges angle * size, of cells area / size [m] */
  double (*direction)[2]; /* (columns) unit vector from first node to second; 0, 0 without length */
  int32_t *curved; /* (columns) element of a running cable, hinge or cell; -1: a straight member */
  double *curvature; /* (columns) largest second derivative of such an element [1/m] */
  double **bend;     /* (columns) its second derivatives / curvature (2 nodes, 2 nodes), or NULL */
  int32_t *start;    /* (columns + 1) A by columns */
  int32_t *row;      /* (start[columns]) ascending within a column */
  double *value;     /* (start[columns]) */
} strut_equilibrium_matrix;

/** Columns of the equilibrium matrix of a model. */
static inline int32_t strut_equilibrium_columns(const strut_model *model) {
  return model->members.count + (int32_t)(model->scene->hinge_count + model->scene->cell_count);
}

/** Is column j a cable? */
static inline bool strut_column_is_cable(const strut_model *model, int32_t j) {
  return j < model->members.count && model->scene->members[j].kind == STRUT_CABLE;
}

/** Force density of column j [N/m]: force / length, or force times curvature; 0 without length. */
static inline double strut_column_density(const strut_equilibrium_matrix *a, int32_t j,
                                          double force) {
  if (a->curved[j] >= 0) return force * a->curvature[j];
  return a->length[j] > 0 ? force / a->length[j] : 0.0;
}

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
