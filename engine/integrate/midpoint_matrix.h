/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The matrix of an implicit midpoint step, M + h^2/2 dK, over the free coordinates: its pattern once,
 * then its numbers and its factor as often as they are wanted, without asking for memory.
 */
#ifndef STRUT_ENGINE_INTEGRATE_MIDPOINT_MATRIX_H
#define STRUT_ENGINE_INTEGRATE_MIDPOINT_MATRIX_H

#include "engine/forces/discrete_gradient.h"
#include "engine/forces/tangent.h"
#include "engine/model/linear_solver.h"
#include "engine/model/sparse.h"

typedef struct strut_midpoint_matrix {
  int32_t n;           /* free coordinates */
  int32_t *coordinate; /* (n) where they stand in coordinate arrays */
  strut_sparse *matrix;
  double *mass;           /* M at the matrix's places */
  int32_t *place;         /* (members, STRUT_MEMBER_ENTRIES) into its values; -1 where supported */
  strut_refactor *factor; /* NULL where nothing is free */
  double *lightness;      /* (members) inverse masses of their free ends, added [1/kg] */
  strut_vec2 *direction;  /* (members) that the factor was made with */
  double *slope;          /* (members) likewise */
} strut_midpoint_matrix;

/** In the arena; false: out of memory. */
bool strut_midpoint_matrix_create(const strut_model *model, strut_arena *arena,
                                  strut_midpoint_matrix *m);
/**
 * Builds and factorises it for the step as it was evaluated last, to positions q (length) with rest
 * lengths `rest` (slots). `tension` (members): what turns
 * with a member; where that leaves no positive definite matrix, or with `stiff`, compression is left
 * out, which makes it one. False: not even then.
 */
bool strut_midpoint_matrix_update(const strut_model *model, const strut_discrete_gradient *step,
                                  const double *rest, const double *q, const double *tension,
                                  bool stiff, strut_midpoint_matrix *m);
/**
 * Would the factor mislead? A stiff member that has turned by an angle a since, whose force it takes
 * for one along the old direction, moves its ends aside so far that its length changes by
 * (h^2/2 slope sin^2 a / mass) times what was to be undone; and a cable may have gone slack or taut.
 */
bool strut_midpoint_matrix_stale(const strut_model *model, const strut_discrete_gradient *step,
                                 const strut_midpoint_matrix *m);
/** product (n) = M x (length). */
void strut_midpoint_matrix_mass(const strut_midpoint_matrix *m, const double *x, double *product);

#endif
