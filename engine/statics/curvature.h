/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The Hessian as a descent uses it, dense or by a sparse factor; and the step within a
 * trust region (More and Sorensen).
 */
#ifndef STRUT_ENGINE_STATICS_CURVATURE_H
#define STRUT_ENGINE_STATICS_CURVATURE_H

#include <stdint.h>

#include "engine/statics/minimise.h"

/** A step and the energy that the quadratic model says it releases. */
typedef struct strut_model_step {
  double length;    /* |s| [m] */
  double reduction; /* -(g's + s'Hs/2) [J] */
} strut_model_step;

/** A decomposition of the Hessian: dense or sparse. Rows are those of the potential; all arrays are (n). */
typedef struct strut_curvature {
  /** The workspace that the others take; NULL: out of memory. */
  void *(*create)(const strut_potential *potential);
  /** Decomposes the Hessian at q; false: not finite, or out of memory. */
  bool (*decompose)(void *workspace, const double *q);
  /** The lowest point of the model within |s| <= radius. still [N]: a force within rounding. */
  strut_model_step (*trust_step)(void *workspace, const double *gradient, double radius,
                                 double still, double *step);
  /**
   * Corrects the step s that trust_step returned last by Newton's method in the stiff modes only,
   * with the gradient g at its end: turning bars stretch to second order. False: no stiff modes.
   */
  bool (*rebalance)(void *workspace, const double *gradient, double *step);
  /** The Newton step without the directions that have no stiffness; returns its length. */
  double (*newton_step)(void *workspace, const double *gradient, double *step);
  /** The unit direction of most negative curvature; false if none is negative beyond rounding. */
  bool (*unstable_direction)(void *workspace, double *step);
  void (*free)(void *workspace);
} strut_curvature;

extern const strut_curvature strut_curvature_dense, strut_curvature_sparse;

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

#endif
