/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Eigenvalues and eigenvectors of small dense symmetric matrices, many of them, fast.
 *
 * Householder's reduction to a tridiagonal and QL steps with implicit shifts (Bowdler, Martin,
 * Reinsch and Wilkinson, Handbook for Automatic Computation II). Searches for equilibria spend most
 * of their time here, on matrices of some ten rows, where general libraries mostly administrate.
 */
#ifndef STRUT_ENGINE_STATICS_EIGEN_H
#define STRUT_ENGINE_STATICS_EIGEN_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/base/export.h"

/**
 * matrix (n, n), symmetric and finite, becomes the unit eigenvectors, one per row, in no order;
 * value (n) their values; work (n). Errors are some last bits of the largest |value|. False: no
 * convergence, which finite matrices do not show.
 */
STRUT_API bool strut_eigen(double *matrix, int32_t n, double *value, double *work);

#endif
