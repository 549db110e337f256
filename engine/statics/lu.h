/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Factors of a small dense matrix that need no memory: gsl_linalg_LU_decomp takes some and does not
 * look whether it got it.
 */
#ifndef STRUT_ENGINE_STATICS_LU_H
#define STRUT_ENGINE_STATICS_LU_H

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_permutation.h>

/**
 * Factors the square matrix in place with row exchanges, as gsl_linalg_LU_solve wants it. A singular
 * matrix leaves a zero on the diagonal.
 */
void strut_lu_factor(gsl_matrix *a, gsl_permutation *order);

#endif
