/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Small dense matrices: eigenvalues and factors.
 *
 * strut_eigen: Householder's reduction to a tridiagonal and QL steps with implicit shifts (Bowdler,
 * Martin, Reinsch and Wilkinson, Handbook for Automatic Computation II). Searches for equilibria
 * spend most of their time there, on matrices of some ten rows, where general libraries mostly
 * administrate.
 */
#ifndef STRUT_ENGINE_STATICS_DENSE_ALGEBRA_H
#define STRUT_ENGINE_STATICS_DENSE_ALGEBRA_H

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_permutation.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/export.h"

/**
 * matrix (n, n), symmetric and finite, becomes the unit eigenvectors, one per row, in no order;
 * value (n) their values; work (n). Errors are some last bits of the largest |value|. False: no
 * convergence, which finite matrices do not show.
 */
STRUT_API bool strut_eigen(double *matrix, int32_t n, double *value, double *work);

/**
 * Of matrix (n, n), which it overwrites: value (n) ascending, and the unit vector of value i as row
 * i of vector (n, n), its largest entry positive. False: out of memory.
 */
bool strut_symmetric_eigen(double *matrix, size_t n, double *value, double *vector);

/**
 * Factors the square matrix in place with row exchanges, as gsl_linalg_LU_solve wants it. A
 * singular matrix leaves a zero on the diagonal.
 */
void strut_lu_factor(gsl_matrix *a, gsl_permutation *order);

#endif
