/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Climbs from a shape to a stationary point with a given number of unstable directions.
 *
 * The potential is turned upside down along the modes that are followed (image function), so that a
 * trust-region descent ends on a saddle: along the softest modes, or along the one that leans most
 * on a given direction.
 */
#ifndef STRUT_ENGINE_STATICS_SEARCH_SADDLE_H
#define STRUT_ENGINE_STATICS_SEARCH_SADDLE_H

#include "engine/statics/minimise.h"

typedef struct strut_climber strut_climber;
/** For one thread at a time. NULL: out of memory. */
strut_climber *strut_climber_create(const strut_potential *potential);
/** Hessians decomposed so far: a measure of the work done. */
int64_t strut_climber_hessian_count(const strut_climber *climber);
void strut_climber_free(strut_climber *climber);

/**
 * Moves q (length) up along `index` >= 1 modes and down all others. direction (n), or NULL: which
 * mode to follow first, with index 1. True if g = 0 there to what rounding allows.
 */
bool strut_climb(strut_climber *climber, int32_t index, const double *direction, double *q);

/**
 * Moves q by `far` along mode number `mode` of its Hessian, ascending, idle ones not counted, to
 * start a climb; that direction is written to direction (n). False if there are fewer modes.
 */
bool strut_climb_away(strut_climber *climber, int32_t mode, double far, double *q,
                      double *direction);

#endif
