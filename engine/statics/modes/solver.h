/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * (K + shift M) x = b: by a plain factor and corrections where the shift keeps the condition within
 * a double's reach, else by a factor of twice a double's precision.
 *
 * Either way solutions are good to far more than a double holds, and the signs of the factor count
 * the eigenvalues below -shift: a plain factor is one of a matrix that differs by 1e-15 of the
 * largest eigenvalue, which is nothing beside a shift of 1e-10 of it.
 */
#ifndef STRUT_ENGINE_STATICS_MODES_SOLVER_H
#define STRUT_ENGINE_STATICS_MODES_SOLVER_H

#include "engine/statics/modes/extended_factor.h"
#include "engine/statics/modes/vibration.h"

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
} strut_modes_solver;

/** v must outlive it. STRUT_OK or STRUT_NO_MEMORY; strut_modes_solver_free either way. */
strut_status strut_modes_solver_create(const strut_vibration *v, strut_modes_solver *solver,
                                       strut_error *error);
void strut_modes_solver_free(strut_modes_solver *solver);

void strut_modes_factorise(strut_modes_solver *solver, double shift);
/** x (n) becomes (K + shift M)^-1 x. */
void strut_modes_solve(strut_modes_solver *solver, strut_dd *x);

#endif
