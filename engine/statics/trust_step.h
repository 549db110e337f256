/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The lowest point of a quadratic within a radius, given by its eigenvalues (More and Sorensen).
 */
#ifndef STRUT_ENGINE_STATICS_TRUST_STEP_H
#define STRUT_ENGINE_STATICS_TRUST_STEP_H

#include <stdint.h>

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
double strut_trust_step(const strut_quadratic *quadratic, double radius, double *x);

#endif
