/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How stiff small motions can be at most, from the entries of their matrices: bounds, not estimates.
 *
 * For any positive weights z and any masses m with M - diag(m) positive semidefinite, no quotient of
 * |A| over M exceeds the largest (|A| z)_i / (m_i z_i) (Collatz, Wielandt). Weights that a few
 * multiplications by the matrix itself improve make that close. Each pass costs two multiplications.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LIMIT_TANGENT_BOUND_H
#define STRUT_ENGINE_INTEGRATE_LIMIT_TANGENT_BOUND_H

#include <stdbool.h>

#include "engine/forces/tangent.h"
#include "engine/integrate/limit/stability.h"

/** What all motions keep to. */
typedef struct strut_tangent_bound {
  double frequency;         /* none of the undamped is above [rad/s] */
  double rate;              /* largest quotient of D over M [1/s] */
  double of[STRUT_REGIONS]; /* steps that are stable [s]; INFINITY where nothing limits them */
} strut_tangent_bound;

/** The model must have a mass. Scratch is in the arena; false: out of memory. */
STRUT_API bool strut_tangent_bound_find(const strut_model *model, const strut_tangent *tangent,
                                        strut_arena *arena, strut_tangent_bound *bound);

#endif
