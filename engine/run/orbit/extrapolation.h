/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The limit of a sequence from a few of its members: reduced rank extrapolation (Eddy 1979; Mesina
 * 1977; Sidi 1991). Of the differences of successive members the combination with weights of sum 1
 * that is smallest is looked for; the members are then combined by the same weights.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_EXTRAPOLATION_H
#define STRUT_ENGINE_RUN_ORBIT_EXTRAPOLATION_H

#include "engine/run/orbit/period_map.h"

enum { STRUT_EXTRAPOLATION_WINDOW = 5 };

/**
 * weight (count) of the differences d (count, each 2 length + 1), 1 <= count <= the window. False where
 * there are none or they are so large that they would but blow up errors.
 */
bool strut_extrapolation_weights(const strut_period_map *map, double *const *d, int32_t count,
                                 double *weight);

#endif
