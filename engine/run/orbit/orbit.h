/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * An accurate periodic motion from a coarse one, by defect correction on the period map.
 *
 * Let C and F be the period maps of a coarse and of an accurate method, and y a fixed point of C. F
 * leaves the defect r = F(y) - y. To first order the fixed point of F is y + sum_k J^k r, with J
 * the common derivative of the maps; and J^k r is the disturbance r after k periods of C. So one
 * accurate period and some coarse ones give the accurate orbit and its velocity. A repetition with
 * the defect at the new point reduces the error quadratically, and measures it.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_ORBIT_H
#define STRUT_ENGINE_RUN_ORBIT_ORBIT_H

#include "engine/run/orbit/period_map.h"

typedef struct strut_orbit {
  double *y;         /* (2 length + 1) coarse fixed point in, accurate one out */
  double velocity;   /* [m/s] */
  double correction; /* change of the velocity by the latest correction [m/s] */
  double
      defect; /* defect of y before it: the largest of positions over the size, velocities over size times 2 pi f */
  bool converged; /* the disturbance decayed */
} strut_orbit;

/**
 * Corrects the orbit once. `base` (2 length + 1): the fixed point of `coarse`; travel: of one
 * application there [m]; enough: negligible travel per period [m]. STRUT_OK or STRUT_NO_MEMORY;
 * `converged` is false where the disturbance did not decay or the motion was lost, and then y and
 * velocity are unchanged.
 */
strut_status strut_orbit_correct(strut_period_map *coarse, strut_period_map *reference,
                                 const double *base, double travel, double enough,
                                 strut_orbit *orbit);

/** How far an extrapolation goes, and how it ended. */
typedef struct strut_extrapolation {
  double enough; /* acceptable error of the travel per application [m] */
  double fall;   /* part of a cycle's first difference that its last must be to continue [1] */
  int cycles;    /* most extrapolations */
  bool found;    /* the fixed point */
  bool unsteady; /* applications, or their extrapolation, lead away */
} strut_extrapolation;

/**
 * Extrapolates the sequence of applications of the map from y (2 length + 1) to its fixed point. Where it is found, y
 * is the fixed point and *travel its travel [m]. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_orbit_limit(strut_period_map *map, strut_extrapolation *to, double *y,
                               double *travel);

#endif
