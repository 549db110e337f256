/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A few motions of many that matter for the step: a space of them, and the small problem within.
 *
 * Vectors are over the free coordinates (n) of a tangent. The space keeps vectors orthonormal in
 * the mass, and K and D projected onto them: z^2 + z D + K = 0 of a few rows, symmetric and of the
 * same signs as the large one, so that its eigenvalues lie within the bounds of the large one's.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LIMIT_KRYLOV_BASIS_H
#define STRUT_ENGINE_INTEGRATE_LIMIT_KRYLOV_BASIS_H

#include <stdbool.h>

#include "engine/forces/tangent.h"

typedef struct strut_krylov_basis {
  const strut_model *model;
  const strut_tangent *tangent;
  int count, most;             /* vectors it has, and has room for */
  double *vector;              /* (most, n) */
  double *stiffness, *damping; /* (most, most) projected [1/s^2], [1/s]; the leading count rows */
  double *image;               /* (n) scratch */
  double *node;                /* (3, length) scratch */
} strut_krylov_basis;

/** In the arena, empty. False: out of memory. */
bool strut_krylov_basis_create(const strut_model *model, const strut_tangent *tangent, int most,
                               strut_arena *arena, strut_krylov_basis *space);
/** x becomes M^-1 x, through what rigid bars allow. */
void strut_apply_inverse_mass(strut_krylov_basis *space, double *x);
/** y = M x. */
void strut_tangent_mass(strut_krylov_basis *space, const double *x, double *y);
/** y = a K x + b D x; x and y apart. */
void strut_tangent_apply(strut_krylov_basis *space, double a, double b, const double *x, double *y);
/** Takes the space's motions out of x and appends the rest; false where nothing is left or no room. */
bool strut_krylov_basis_add(strut_krylov_basis *space, double *x);
/** x = the sum of the space's vectors times c (count). */
void strut_krylov_basis_combine(const strut_krylov_basis *space, const double *c, double *x);
/** The space becomes what the rows of c (rows, count) span; c is changed, work is (most). */
void strut_krylov_basis_shrink(strut_krylov_basis *space, double *c, int rows, double *work);

/**
 * Adds the motions of the largest eigenvalues of M^-1 (a K + b D), found by Lanczos's method: twice
 * the same three-term recurrence, so that no vectors but those wanted are kept. False: no memory.
 */
bool strut_lanczos_limits(strut_krylov_basis *space, double a, double b);

#endif
