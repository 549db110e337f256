/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Finishing a periodic motion by Newton's method on the period map, and its Floquet multipliers.
 *
 * The map's derivative is taken by central differences, one free coordinate and velocity after the
 * other: that is 2 periods for each, hence only for structures with few nodes. Where the structure
 * travels, shifts along the ground are neutral; that direction is held, and its multiplier, which is
 * 1, is left out. With contacts the map has a derivative only where no touchdown grazes and the
 * method locates events; elsewhere the residual shows how far it came.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_SHOOTING_H
#define STRUT_ENGINE_RUN_ORBIT_SHOOTING_H

#include "engine/run/orbit/period_map.h"

enum { STRUT_MOST_SHOT = 96 }; /* free coordinates and velocities */

/**
 * y (2 length + 1), near a fixed point in, becomes the fixed point; *travel what it goes in one
 * application [m]. Fills shot, iterations, reason, residual (the largest change of shape and
 * velocities over one application, in sizes and sizes times 2 pi f) and the multipliers of `found`.
 * Where Newton's method does not get nearer, y is as before, `shot` is false and `reason` says why.
 * STRUT_OK, STRUT_INTERRUPTED where the map was (y is as before) or STRUT_NO_MEMORY.
 */
strut_status strut_shoot(strut_period_map *map, double *y, double *travel,
                         strut_steady_summary *found);

#endif
