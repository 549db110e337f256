/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The seam around SPQR: a rank-revealing A E = Q R of a sparse matrix, with Q as its reflections.
 *
 * Only sparse_qr.c sees SuiteSparseQR_C.h. An explicit Q would be dense.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_SPARSE_QR_H
#define STRUT_ENGINE_STATICS_RIGIDITY_SPARSE_QR_H

#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"

typedef struct strut_sparse_qr strut_sparse_qr;

/**
 * Factorises A: (rows, columns), by columns as strut_equilibrium_matrix. Columns that keep a norm
 * of `tolerance` or less beside those before them count as dependent. STRUT_NO_MEMORY, or
 * STRUT_SINGULAR where SPQR fails for another reason.
 */
strut_status strut_sparse_qr_create(int32_t rows, int32_t columns, const int32_t *start,
                                    const int32_t *row, const double *value, double tolerance,
                                    strut_sparse_qr **qr, strut_error *error);
void strut_sparse_qr_free(strut_sparse_qr *qr);

int32_t strut_sparse_qr_rank(const strut_sparse_qr *qr);
/** Smallest and largest diagonal entry of R, absolute; 0 where the rank is 0. */
void strut_sparse_qr_diagonal(const strut_sparse_qr *qr, double *smallest, double *largest);

/**
 * The i-th vector of an orthonormal basis of what A' maps to zero, 0 <= i < rows - rank: y (rows).
 */
void strut_sparse_qr_left_null(const strut_sparse_qr *qr, int32_t i, double *y);

/**
 * The i-th vector of a basis of what A maps to zero, 0 <= i < columns - rank: x (columns), 1 at a
 * dependent column of its own, 0 at the other dependent ones.
 */
void strut_sparse_qr_null(const strut_sparse_qr *qr, int32_t i, double *x);

#endif
