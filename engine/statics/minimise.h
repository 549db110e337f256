/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * From a shape downhill to a stationary point of the potential: Newton's method in a trust region.
 *
 * Steps by the Hessian's sparse L D L' factor, shifted until it is positive definite; up to
 * STRUT_DENSE_STATICS free coordinates by its modes where it is singular: directions without stiffness
 * and without force (free bodies, mechanisms) are left alone.
 * Deterministic.
 */
#pragma once

#include <stdint.h>

#include "engine/base/flag.h"
#include "engine/statics/potential.h"

enum { STRUT_DENSE_STATICS = 120 };

typedef enum strut_descent_end {
  STRUT_DESCENT_REACHED,  /* the gradient is zero to what rounding allows */
  STRUT_DESCENT_RUNAWAY,  /* the energy falls without end: q left all bounds */
  STRUT_DESCENT_EXHAUSTED /* no progress within the iterations allowed */
} strut_descent_end;

typedef struct strut_descent {
  strut_descent_end end;
  int32_t iterations;
  double residual; /* largest entry of g at the end [N] */
  double rounding; /* strut_potential_rounding there [N] */
  double step;     /* length of the last Newton step: how far q may still be off [m] */
} strut_descent;

/** Memory of descents on one potential, for one thread at a time, in the arena. */
typedef struct strut_minimiser strut_minimiser;
STRUT_API strut_status strut_minimiser_create(const strut_potential *potential, strut_arena *arena,
                                              strut_minimiser **minimiser, strut_error *error);

/** Descents end as exhausted soon after the flag is set. NULL: no flag. */
void strut_minimiser_watch(strut_minimiser *minimiser, const strut_flag *interrupt);

/** Descents end on a saddle, too, if they come upon one. */
void strut_minimiser_stay(strut_minimiser *minimiser);

/** Calls `visit` with every point q (length) that a descent keeps, its start and its end too; NULL: nothing. */
void strut_minimiser_visit(strut_minimiser *minimiser,
                           void (*visit)(void *context, const double *q), void *context);

/**
 * Moves q (length) downhill to a point where g = 0, never uphill. It may end on a saddle only if
 * the start lies exactly on its ridge; then it leaves along the unstable direction. At the end it
 * is polished until |g| is a few times the rounding.
 */
STRUT_API strut_descent strut_minimise(strut_minimiser *minimiser, double *q);

/**
 * Plain Newton steps to the nearest stationary point of any kind, for a q that is close already.
 */
STRUT_API strut_descent strut_polish(strut_minimiser *minimiser, double *q);

/** Hessians decomposed so far: a measure of the work done. */
int64_t strut_minimiser_hessian_count(const strut_minimiser *minimiser);

/**
 * From a saddle at q down one side (+1 or -1) of direction (length), by steps short enough to stay
 * in the valley they began in; true if q has reached a minimum.
 */
bool strut_descend_along(strut_minimiser *minimiser, const double *direction, double side,
                         double *q);

/**
 * From q by short steps, which pass over no well that is wider than a hundredth of the structure.
 */
strut_descent_end strut_descend_gently(strut_minimiser *minimiser, double *q);

/* The Hessian as a descent uses it, and the step within a trust region (More and Sorensen). */

/** A step and the energy that the quadratic model says it releases. */
typedef struct strut_model_step {
  double length;    /* |s| [m] */
  double reduction; /* -(g's + s'Hs/2) [J] */
} strut_model_step;

/** A decomposition of the Hessian. Rows are those of the potential; all arrays are (n). */
typedef struct strut_curvature strut_curvature;
/** In the arena. */
strut_status strut_curvature_create(const strut_potential *potential, strut_arena *arena,
                                    strut_curvature **curvature, strut_error *error);
/** Decomposes the Hessian at q, which stays there until the next call; false: not finite, or out of memory. */
bool strut_curvature_decompose(strut_curvature *curvature, const double *q);
/** The lowest point of the model within |s| <= radius, or nearly so. still [N]: a force within rounding. */
strut_model_step strut_curvature_trust_step(strut_curvature *curvature, const double *gradient,
                                            double radius, double still, double *step);
/**
 * Corrects the step that trust_step returned last by Newton's method in the stiff modes only, with the
 * gradient at its end: turning bars stretch to second order. False: no stiff modes.
 */
bool strut_curvature_rebalance(strut_curvature *curvature, const double *gradient, double *step);
/** The Newton step without the directions that have no stiffness; returns its length. */
double strut_curvature_newton_step(strut_curvature *curvature, const double *gradient,
                                   double *step);
/** The unit direction of most negative curvature; false if none is negative beyond rounding. */
bool strut_curvature_unstable_direction(strut_curvature *curvature, double *step);

/** q(x) = sum part x + value x^2 / 2, one term for each mode, in any order. */
typedef struct strut_quadratic {
  int32_t n;
  const double *value; /* (n) [N/m] */
  const double *part;  /* (n) the gradient's share of each mode [N] */
  const uint8_t *idle; /* (n) 1: the mode has neither stiffness nor force, and is left alone */
  double scale;        /* largest |value| */
  double noise;        /* error of the lowest value */
} strut_quadratic;

/**
 * x (n): the step's share of each mode; |x| <= radius. Returns the multiplier mu >= 0: the step is
 * that of Newton for the values + mu, and modes much stiffer than mu do not feel the radius.
 */
double strut_trust_step(const strut_quadratic *quadratic, double radius, double *vector);
