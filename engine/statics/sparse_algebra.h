/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What statics needs of SPQR and ARPACK: a rank-revealing A E = Q R of a sparse matrix, and the lowest eigenpairs
 * of K x = z M x by shift-invert Lanczos.
 *
 * Only sparse_algebra.c sees their headers. Q is kept as its reflections, since an explicit one would be dense.
 * ARPACK keeps its state in static variables, so that one lock lets one search run at a time. While either works,
 * the BLAS beneath them uses one thread.
 */
#ifndef STRUT_ENGINE_STATICS_SPARSE_ALGEBRA_H
#define STRUT_ENGINE_STATICS_SPARSE_ALGEBRA_H

#include <signal.h>
#include <stdint.h>

#include "engine/base/library.h"

typedef struct strut_sparse_qr strut_sparse_qr;

typedef struct strut_lanczos_problem {
  int32_t n;
  double shift; /* below all eigenvalues */
  void *context;
  void (*solve)(void *context, double *x);                 /* x becomes (K - shift M)^-1 x */
  void (*mass)(void *context, const double *x, double *y); /* y = M x */
  const volatile sig_atomic_t *interrupt; /* ends it with STRUT_INTERRUPTED; or NULL */
} strut_lanczos_problem;

typedef struct strut_sparse_algebra_library {
  strut_library_stamp stamp;
  /**
   * Factorises A: (rows, columns), by columns as strut_equilibrium_matrix. Columns that keep a norm
   * of `tolerance` or less beside those before them count as dependent. STRUT_NO_MEMORY, or
   * STRUT_SINGULAR where SPQR fails for another reason.
   */
  strut_status (*create_qr)(int32_t rows, int32_t columns, const int32_t *start, const int32_t *row,
                            const double *value, double tolerance, strut_sparse_qr **qr,
                            strut_error *error);
  void (*free_qr)(strut_sparse_qr *qr);
  int32_t (*rank)(const strut_sparse_qr *qr);
  /** Smallest and largest diagonal entry of R, absolute; 0 where the rank is 0. */
  void (*diagonal)(const strut_sparse_qr *qr, double *smallest, double *largest);
  /**
   * The i-th vector of an orthonormal basis of what A' maps to zero, 0 <= i < rows - rank: y (rows).
   */
  void (*left_null)(const strut_sparse_qr *qr, int32_t i, double *y);
  /**
   * The i-th vector of a basis of what A maps to zero, 0 <= i < columns - rank: x (columns), 1 at a
   * dependent column of its own, 0 at the other dependent ones.
   */
  void (*null)(const strut_sparse_qr *qr, int32_t i, double *x);
  /**
   * The `count` eigenvalues next above the shift, ascending, and their vectors (count, n) with
   * x'Mx = 1. count < n. The start vector is always the same. STRUT_SINGULAR where it does not
   * converge, STRUT_NO_MEMORY.
   */
  strut_status (*lowest_eigenpairs)(const strut_lanczos_problem *problem, int32_t count,
                                    double *value, double *vector, strut_error *error);
} strut_sparse_algebra_library;

/** Fails where the libraries cannot be loaded (engine/base/library.h). */
strut_status strut_sparse_algebra_load(const strut_sparse_algebra_library **library,
                                       strut_error *error);

#endif
