/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * (K + shift M) x = b: by a plain factor and corrections where the shift keeps the condition within
 * a double's reach, else by a factor L D L' of twice a double's precision.
 *
 * Either way solutions are good to far more than a double holds, and the signs of the factor count
 * the eigenvalues below -shift: a plain factor is one of a matrix that differs by 1e-15 of the
 * largest eigenvalue, which is nothing beside a shift of 1e-10 of it.
 *
 * For the extended factor CHOLMOD gives the order and the pattern; the arithmetic is in solver.c.
 * There is no pivoting: that D has as many negative entries as the matrix has negative eigenvalues
 * (Sylvester) holds as long as no pivot is lost in rounding; `weakest` and `loss` report that.
 */
#ifndef STRUT_ENGINE_STATICS_MODES_SOLVER_H
#define STRUT_ENGINE_STATICS_MODES_SOLVER_H

#include <signal.h>

#include "engine/base/double_double.h"
#include "engine/model/linear_solver.h"
#include "engine/statics/modes/vibration.h"

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

typedef struct strut_modes_solver {
  const strut_vibration *v;
  strut_ldl *plain;
  strut_extended_factor *extended;
  strut_sparse sum; /* K + shift M as doubles, in the pattern's places */
  bool is_plain;    /* which of the two was factorised last */
  double shift;
  int32_t negative; /* eigenvalues below -shift */
  int32_t weakest;  /* row whose pivot lost most, and what is left of it, relative */
  double loss;
  strut_dd *b, *r, *mx; /* (n) each */
  double *step;         /* (n) */
  strut_arena arena;
  const volatile sig_atomic_t
      *interrupt; /* once set, nothing more is factorised or solved; or NULL */
} strut_modes_solver;

/** v must outlive it. STRUT_OK or STRUT_NO_MEMORY; strut_modes_solver_free either way. */
strut_status strut_modes_solver_create(const strut_vibration *v, strut_modes_solver *solver,
                                       strut_error *error);
void strut_modes_solver_free(strut_modes_solver *solver);

void strut_modes_factorise(strut_modes_solver *solver, double shift);
/** x (n) becomes (K + shift M)^-1 x. */
void strut_modes_solve(strut_modes_solver *solver, strut_dd *x);

#endif
