/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Limits of the step from the tangent: the Krylov basis, the limits themselves. */
#pragma once

#include <stdbool.h>

#include "engine/forces/tangent.h"
#include "engine/integrate/limit/step_limit.h"

/* A few motions of many that matter for the step: a space of them, and the small problem within.
 *
 * Vectors are over the free coordinates (n) of a tangent. The space keeps vectors orthonormal in
 * the mass, and K and D projected onto them: z^2 + z D + K = 0 of a few rows, symmetric and of the
 * same signs as the large one, so that its eigenvalues lie within the bounds of the large one's.
 */

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
void strut_apply_inverse_mass(strut_krylov_basis *space, double *vector);
/** y = a K x + b D x; x and y apart. */
void strut_tangent_apply(strut_krylov_basis *space, double a, double b, const double *vector,
                         double *y);
/** Takes the space's motions out of x and appends the rest; false where nothing is left or no room. */
bool strut_krylov_basis_add(strut_krylov_basis *space, double *vector);
/** x = the sum of the space's vectors times c (count). */
void strut_krylov_basis_combine(const strut_krylov_basis *space, const double *c, double *vector);
/** The space becomes what the rows of c (rows, count) span; work is (rows). */
void strut_krylov_basis_shrink(strut_krylov_basis *space, const double *c, int rows, double *work);

/**
 * Adds the motions of the largest eigenvalues of M^-1 (a K + b D), found by Lanczos's method: twice
 * the same three-term recurrence, so that no vectors but those wanted are kept. False: no memory.
 */
bool strut_lanczos_limits(strut_krylov_basis *space, double a, double b);

/* The eigenvalues of a space of motions that bind each method's step, and the motions they belong to.
 *
 * Verlet and semi-implicit Euler first fail by motions that change sign at every step, x' = -x. Put
 * into their formulas this is (M - c h D - h^2/4 K) x = 0 with c = 1 (the damper sees v + h a) and
 * 1/2; while that matrix is positive definite, every eigenvalue's quotients k = x*Kx/x*Mx and d keep
 * c h d + h^2/4 k < 1, within which one mode is stable. So their limit is exact also where damping
 * couples the modes. RK4's is that of the eigenvalues z of z^2 M + z D + K.
 */

enum { STRUT_CRITICAL_MODE_PAIRS = 4, STRUT_MOST_BINDING = 4 + 2 * STRUT_CRITICAL_MODE_PAIRS };

/** One motion: coefficients of its real and imaginary parts, and for whom it matters. */
typedef struct strut_critical_mode {
  double a, b;   /* its residual is a K x + b D x; complex: K x + (re + i im) D x */
  double re, im; /* eigenvalue, where it is RK4's */
  bool complex_pair, rk4;
  double *x, *y; /* (most) real and imaginary part */
} strut_critical_mode;

typedef struct strut_tangent_limits {
  double largest_frequency; /* [rad/s] */
  double of[STRUT_REGIONS]; /* [s] */
  bool solved;              /* RK4's from eigenvalues; else by a bound */
  int count;                /* of binding motions */
  strut_critical_mode binding[STRUT_MOST_BINDING];
  double *room; /* their coefficients */
} strut_tangent_limits;

/** In the arena, for spaces of `most` vectors. False: out of memory. */
bool strut_tangent_limits_create(int most, strut_arena *arena, strut_tangent_limits *limits);
/** Of the space as it is; `damped`: D is not zero; rk4: look for RK4's. False: out of memory. */
bool strut_tangent_limits_find(const strut_krylov_basis *space, bool damped, bool rk4,
                               strut_tangent_limits *limits);
