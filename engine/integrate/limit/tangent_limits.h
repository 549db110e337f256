/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The eigenvalues of a space of motions that bind each method's step, and the motions they belong to.
 *
 * Verlet and semi-implicit Euler first fail by motions that change sign at every step, x' = -x. Put
 * into their formulas this is (M - c h D - h^2/4 K) x = 0 with c = 1 (the damper sees v + h a) and
 * 1/2; while that matrix is positive definite, every eigenvalue's quotients k = x*Kx/x*Mx and d keep
 * c h d + h^2/4 k < 1, within which one mode is stable. So their limit is exact also where damping
 * couples the modes. RK4's is that of the eigenvalues z of z^2 M + z D + K.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LIMIT_TANGENT_LIMITS_H
#define STRUT_ENGINE_INTEGRATE_LIMIT_TANGENT_LIMITS_H

#include "engine/integrate/limit/krylov_basis.h"
#include "engine/integrate/limit/stability.h"

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

#endif
