/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Eigenvalues and vectors of a small symmetric matrix, by GSL.
 */
#ifndef STRUT_ENGINE_STATICS_SYMMETRIC_H
#define STRUT_ENGINE_STATICS_SYMMETRIC_H

#include <stdbool.h>
#include <stddef.h>

/**
 * Of matrix (n, n), which it overwrites: value (n) ascending, and the unit vector of value i as row
 * i of vector (n, n), its largest entry positive. False: out of memory.
 */
bool strut_symmetric_eigen(double *matrix, size_t n, double *value, double *vector);

#endif
