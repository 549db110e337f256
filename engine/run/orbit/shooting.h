/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Shooting: completes a periodic motion by Newton's method on the period map, with its Floquet
 * multipliers.
 *
 * The derivative of the map is taken by central differences, one free coordinate and velocity after
 * the other: two periods each, hence only for small structures. Where the structure travels, shifts
 * along the ground are neutral; that direction is held, and its multiplier, 1, is left out. With
 * contacts the map is differentiable only where no touchdown grazes and the method locates events;
 * elsewhere the residual shows the accuracy reached.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_SHOOTING_H
#define STRUT_ENGINE_RUN_ORBIT_SHOOTING_H

#include "engine/run/orbit/period_map.h"

enum { STRUT_MOST_SHOT = 96 }; /* most free coordinates and velocities */

/**
 * x (n) becomes a^-1 x by elimination with pivots; a (n, n), row by row, is lost. False where a pivot is not
 * above `least`.
 */
bool strut_solve_dense(double *a, double *x, size_t n, double least);

/**
 * Moves y (2 length + 1), near a fixed point, to the fixed point; *travel is its travel in one
 * application [m]. Fills shot, iterations, reason, residual (the largest change of shape and
 * velocities over one application, in sizes and sizes times 2 pi f) and the multipliers of `found`.
 * Where Newton's method does not converge, y is unchanged, `shot` is false and `reason` is the
 * cause. STRUT_OK, STRUT_INTERRUPTED (y is unchanged) or STRUT_NO_MEMORY.
 */
strut_status strut_shoot(strut_period_map *map, double *y, double *travel,
                         strut_steady_summary *found);

#endif
