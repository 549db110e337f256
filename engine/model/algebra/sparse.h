/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Symmetric sparse matrices put together from contributions that may fall on the same place.
 */
#ifndef STRUT_ENGINE_MODEL_ALGEBRA_SPARSE_H
#define STRUT_ENGINE_MODEL_ALGEBRA_SPARSE_H

#include <stdbool.h>

#include "engine/base/memory.h"
#include "engine/model/algebra/linear_solver.h"

/** Collects contributions; zero-initialise, then strut_triplets_reserve. */
typedef struct strut_triplets {
  size_t count, capacity;
  int32_t *row, *column;
  double *value;
} strut_triplets;

/** Room for `capacity` contributions in the arena; false: out of memory. */
bool strut_triplets_reserve(strut_triplets *triplets, size_t capacity, strut_arena *arena);

/** Adds value at (row, column) and, being symmetric, at (column, row). Give each pair once. */
void strut_triplets_add(strut_triplets *triplets, int32_t row, int32_t column, double value);

/**
 * The n x n matrix, in the arena: lower triangle, columns sorted, contributions summed in the order
 * they were added. Every diagonal entry exists, if only as zero. NULL: out of memory.
 */
strut_sparse *strut_sparse_build(int32_t n, const strut_triplets *triplets, strut_arena *arena);

/** y = A x with the whole symmetric matrix. */
STRUT_API void strut_sparse_multiply(const strut_sparse *matrix, const double *restrict vector,
                                     double *restrict y);

#endif
