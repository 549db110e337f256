/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What linear_solver.c needs of CHOLMOD: the order, the pattern and the numbers of a sparse L D L'.
 *
 * Only cholmod_factor.c sees cholmod.h. The factor is simplicial, so that its bits do not depend on the
 * installed BLAS.
 */
#pragma once

#include <stdbool.h>

#include "engine/base/library.h"
#include "engine/model/algebra/linear_solver.h"

/** The order and pattern of a factor, and its numbers from `factorise` on. */
typedef struct strut_cholmod_factor strut_cholmod_factor;

/** A view of the numbers: columns of L whose first entry is that of D; P A P' = L D L'. */
typedef struct strut_cholmod_columns {
  int32_t n, finished; /* columns before the first pivot of 0: n where there is none */
  const int *order;    /* (n) the row of A that stands at i */
  const int *start;    /* (n + 1) */
  const int *row;      /* (start[n]) */
  const double *value; /* (start[n]) */
} strut_cholmod_columns;

typedef struct strut_cholmod_library {
  strut_library_stamp stamp;
  /** Orders and analyses a pattern; *nonzeros of the factor. NULL: out of memory. */
  strut_cholmod_factor *(*analyse)(const strut_sparse *pattern, double *nonzeros);
  /** Factorises the matrix, once. False: out of memory. */
  bool (*factorise)(strut_cholmod_factor *factor, const strut_sparse *matrix,
                    strut_cholmod_columns *columns);
  /** Frees all; NULL is allowed. */
  void (*free)(strut_cholmod_factor *factor);
} strut_cholmod_library;

/** Fails where the library cannot be loaded (engine/base/library.h). */
strut_status strut_cholmod_load(const strut_cholmod_library **library, strut_error *error);
