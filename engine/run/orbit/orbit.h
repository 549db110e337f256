/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * An accurate periodic motion from a cheap one, by defect correction on the period map.
 *
 * Let C and F be the period maps of a cheap and of an accurate method, and y a fixed point of C. F
 * leaves the defect r = F(y) - y. To first order the fixed point of F is y + sum_k J^k r, J being the
 * maps' common derivative; and J^k r is what C makes of the disturbance r after k periods. So one
 * accurate period and some cheap ones give the accurate orbit and its velocity. Repeating it with
 * the defect at the new point makes the error quadratically smaller, and measures it.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_ORBIT_H
#define STRUT_ENGINE_RUN_ORBIT_ORBIT_H

#include "engine/run/orbit/period_map.h"

typedef struct strut_orbit {
  double *y;         /* (2 length + 1) cheap fixed point in, accurate one out */
  double velocity;   /* [m/s] */
  double correction; /* of the velocity by the latest correction [m/s] */
  double defect;     /* of shape and velocities at y before it: the largest of positions over the
                        size, velocities over size times 2 pi f */
  bool converged;    /* the disturbance died out */
} strut_orbit;

/**
 * One correction. `base` (2 length + 1): the fixed point of `cheap`, where `travel` is what it goes in
 * one application [m]; enough: travel per period that no longer matters [m]. STRUT_OK or STRUT_NO_MEMORY; `converged` is false where the disturbance did
 * not die out or the motion was lost, and then y and velocity are as before.
 */
strut_status strut_orbit_correct(strut_period_map *cheap, strut_period_map *accurate,
                                 const double *base, double travel, double enough,
                                 strut_orbit *orbit);

/**
 * The fixed point that a sequence of applications of the map tends to, by extrapolation from y
 * (2 length + 1), which should be near it. enough: travel per application that may be missing [m].
 * On success y is the fixed point and *travel what it goes [m]; *found is false where it could not be
 * found so. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_orbit_limit(strut_period_map *map, double enough, double *y, double *travel,
                               bool *found);

#endif
