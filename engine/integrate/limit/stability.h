/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Largest stable steps of the explicit methods for one damped mode, z^2 + d z + k = 0.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LIMIT_STABILITY_H
#define STRUT_ENGINE_INTEGRATE_LIMIT_STABILITY_H

#include "engine/integrate/integrator.h"

/** Largest h with |R(h lambda)| <= 1 for RK4's R and lambda = re + i im, re <= 0; INFINITY at 0. */
STRUT_API double strut_rk4_limit(double re, double im);

/**
 * Velocity Verlet with velocity-dependent forces at the predicted velocity v + h a. k [1/s^2], d [1/s].
 * 2/omega without damping.
 */
STRUT_API double strut_verlet_limit(double k, double d);

/** Semi-implicit Euler: (sqrt(d^2 + 4 k) - d) / k. */
STRUT_API double strut_euler_limit(double k, double d);

/** The limit of a region for an eigenvalue re + i im of a mode with k and d. */
STRUT_API double strut_region_limit(strut_region region, double re, double im, double k, double d);

/**
 * Data of a region that the monitor of the step limit uses. A step h is stable where no motion's
 * quotient of h^2 stiff K + h damp D exceeds 1, for each of the sets.
 */
typedef struct strut_region_data {
  int sets; /* 0: every step is stable */
  struct {
    double stiff, damp;
  } set[2];
  double growth;      /* at a ratio 1 + e of the limit motions grow by e times this per step, in
                         logarithms, at least */
  bool by_eigenvalue; /* the limit takes eigenvalues of the damped problem; else K and D suffice */
} strut_region_data;
const strut_region_data *strut_region_at(strut_region region);

#endif
