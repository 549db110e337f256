/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Walking along a mechanism with all lengths kept: the test that it is a finite one.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_FINITE_MOTION_H
#define STRUT_ENGINE_STATICS_RIGIDITY_FINITE_MOTION_H

#include "engine/statics/rigidity/equilibrium_matrix.h"

/** Largest number of members that a walk takes on: each step solves a dense system of that size. */
enum { STRUT_WALK_MEMBERS = 200 };

typedef struct strut_walk {
  bool arrived;  /* all the way, with lengths kept */
  double moved;  /* largest change of a distance between two nodes at the end [m] */
  double strain; /* largest relative change of a member's length on the way */
} strut_walk;

/**
 * Walks from q (length) along the motion (rows of A at q) in steps of a hundredth of the model's
 * size, returning to the lengths by Newton's method after each. STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_finite_motion_walk(const strut_model *model, const double *q,
                                                const double *motion, strut_walk *walk);

#endif
