/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The rigid-body motions of a whole structure that its supports leave free.
 */
#ifndef STRUT_ENGINE_STATICS_RIGID_MOTIONS_H
#define STRUT_ENGINE_STATICS_RIGID_MOTIONS_H

#include "engine/statics/potential.h"

/**
 * Fills up to three orthonormal rows (3, n) of `motion` with motions that move no held coordinate;
 * returns how many there are.
 */
STRUT_API int32_t strut_rigid_motions(const strut_potential *potential, const double *q,
                                      double *motion);

/**
 * Finds the combinations of the first `count` rigid motions that the Hessian resists with no more than
 * `tolerance` [N/m]: they come first then; returns how many. work: (3 n).
 */
int32_t strut_rigid_motions_free(const strut_sparse *hessian, double tolerance, int32_t count,
                                 double *motion, double *work);

/** Eigenvalues, ascending, and eigenvectors, in rows, of a symmetric 3 x 3 matrix (Jacobi). */
STRUT_API void strut_symmetric_3(double matrix[3][3], double value[3], double vector[3][3]);

#endif
