/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * L D L' of a sparse symmetric matrix in twice a double's precision, positive definite or not.
 *
 * For matrices whose condition a double cannot bear. CHOLMOD gives the order and the pattern; the
 * numbers are ours. There is no pivoting: that D holds as many negative numbers as the matrix has
 * negative eigenvalues (Sylvester) is true as long as no pivot is lost in the rounding, and then
 * `weakest` says so.
 */
#ifndef STRUT_ENGINE_STATICS_MODES_EXTENDED_FACTOR_H
#define STRUT_ENGINE_STATICS_MODES_EXTENDED_FACTOR_H

#include "engine/base/double_double.h"
#include "engine/model/linear_solver.h"

typedef struct strut_extended_factor {
  int32_t n;
  const strut_factor *pattern; /* order, and the places of L */
  strut_dd *value;             /* L without its diagonal, in the pattern's places */
  strut_dd *diagonal;          /* (n) D */
  int32_t negative;            /* entries of D below zero */
  int32_t weakest;             /* row of the matrix whose pivot lost most */
  double loss;                 /* that pivot, relative to what it was computed from */
  strut_factor *owned;
  strut_dd *work;     /* (n) */
  int32_t *inverse;   /* (n) where a row of the matrix stands in the order */
  int32_t *next, *at; /* lists of columns while factorising */
} strut_extended_factor;

/** Order and memory for matrices of that pattern. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_extended_create(const strut_sparse *pattern, strut_extended_factor **factor,
                                   strut_error *error);
void strut_extended_free(strut_extended_factor *factor);

/**
 * Factorises K + shift M, both in the places of `pattern` (the one it was created with); M NULL: K
 * alone. A pivot of zero is replaced by one at the edge of rounding.
 */
void strut_extended_factorise(strut_extended_factor *factor, const strut_sparse *pattern,
                              const strut_dd *k, const double *m, double shift);

/** x becomes the solution of A x = x. */
void strut_extended_solve(const strut_extended_factor *factor, strut_dd *x);

#endif
