/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The seam around SuiteSparse: a sparse symmetric matrix and its L D L' factor.
 *
 * Only linear_solver.c sees cholmod.h. The factor is simplicial, so that its bits do not depend on
 * the installed BLAS, and is copied out, so that solving in the step loop allocates nothing.
 */
#ifndef STRUT_ENGINE_MODEL_LINEAR_SOLVER_H
#define STRUT_ENGINE_MODEL_LINEAR_SOLVER_H

#include <stdint.h>

#include "engine/base/status.h"

/** Lower triangle of a symmetric n x n matrix, compressed columns, rows ascending, diagonal first. */
typedef struct strut_sparse {
  int32_t n;
  int32_t *start;  /* (n + 1) */
  int32_t *row;    /* (start[n]) */
  double *value;   /* (start[n]) */
} strut_sparse;

/** P A P' = L D L' with unit lower L. */
typedef struct strut_factor {
  int32_t n;
  int32_t *order;  /* (n) order[i] = the row of A that stands at i */
  int32_t *start;  /* (n + 1) columns of L without the diagonal */
  int32_t *row;
  double *value;
  double *inverse_diagonal; /* (n) 1 / D */
} strut_factor;

/**
 * Factorises a positive definite matrix. STRUT_SINGULAR with the row if it is not, STRUT_NO_MEMORY.
 */
strut_status strut_factor_create(const strut_sparse *matrix, strut_factor **factor,
                                 strut_error *error);
void strut_factor_free(strut_factor *factor);

/** Solves in place in the factor's order: b (n) becomes A^-1 b. */
void strut_factor_solve(const strut_factor *factor, double *restrict b);
/** The same for two right-hand sides side by side: b is (n, 2), row by row. */
void strut_factor_solve_pair(const strut_factor *factor, double *restrict b);

#endif
