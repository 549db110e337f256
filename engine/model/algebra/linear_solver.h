/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A sparse symmetric matrix and its L D L' factor, which CHOLMOD computes (cholmod_factor.h). The factor is
 * copied out, so that solving in the step loop allocates nothing.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"

/** Lower triangle of a symmetric n x n matrix, compressed columns, rows ascending, diagonal first. */
typedef struct strut_sparse {
  int32_t n;
  int32_t *start; /* (n + 1) */
  int32_t *row;   /* (start[n]) */
  double *value;  /* (start[n]) */
} strut_sparse;

/** P A P' = L D L' with unit lower L. */
typedef struct strut_factor {
  int32_t n;
  int32_t *order; /* (n) order[i] = the row of A that stands at i */
  int32_t *start; /* (n + 1) columns of L without the diagonal */
  int32_t *row;
  double *value;
  double *inverse_diagonal; /* (n) 1 / D */
  strut_arena arena;        /* of strut_factor_create's */
} strut_factor;

/** Loads what computes factors; fails where that cannot be loaded. */
strut_status strut_linear_solver_load(strut_error *error);

/**
 * Factorises a positive definite matrix. STRUT_SINGULAR with the row if it is not. STRUT_NO_MEMORY,
 * before its numbers are computed where the factor cannot be held (room.h).
 */
strut_status strut_factor_create(const strut_sparse *matrix, strut_factor **factor,
                                 strut_error *error);
void strut_factor_free(strut_factor *factor);

/** Solves in place in the factor's order: b (n) becomes A^-1 b. */
void strut_factor_solve(const strut_factor *factor, double *restrict b);
/** The same for two right-hand sides side by side: b is (n, 2), row by row. */
void strut_factor_solve_pair(const strut_factor *factor, double *restrict b);

/**
 * L D L' of a matrix that need not be positive definite, factorised again and again with the same
 * pattern. Rows and columns are never swapped for the sake of the numbers, so the signs of D count
 * the negative eigenvalues only where no pivot is much smaller than the diagonal it came from.
 */
typedef struct strut_ldl strut_ldl;

typedef struct strut_inertia {
  int32_t negative; /* entries of D below zero: as many as eigenvalues, if `smallest` is large */
  int32_t row;      /* of A, at the pivot that `smallest` belongs to */
  double smallest;  /* least |D| / |its diagonal in A| (1 for a diagonal of 0): what the
                           subtractions left; 0: no factor, rounding (1e-16) and little above: the
                           pivot is noise */
  double least, largest; /* |D| */
} strut_inertia;

/** Orders and analyses a pattern, in the arena; its numbers do not matter. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_ldl_create(const strut_sparse *pattern, strut_arena *arena, strut_ldl **ldl,
                              strut_error *error);
/**
 * Factorises matrix + shift * I, without asking for memory. STRUT_SINGULAR where a pivot is zero to the last bit or
 * not finite (then nothing can be solved).
 */
strut_status strut_ldl_factorise(strut_ldl *ldl, const strut_sparse *matrix, double shift,
                                 strut_inertia *inertia);
/** b (n) becomes (matrix + shift I)^-1 b, in the matrix's own order. */
void strut_ldl_solve(strut_ldl *ldl, double *b);
/**
 * Estimate of 1 / (|A| |A^-1|) in the 1-norm of the matrix, which was factorised last without a shift, by a few
 * solves (Hager, Higham); it is seldom off by more than a factor of 3. Solutions lose that many digits.
 */
double strut_ldl_rcond(strut_ldl *ldl, const strut_sparse *matrix);
/**
 * The lowest eigenvalue where it is below -least, else 0, and its unit vector (n), by inverse iteration; `work` (n).
 */
double strut_ldl_lowest(strut_ldl *ldl, const strut_sparse *matrix, double least, double *vector,
                        double *work);

/* Symmetric sparse matrices put together from contributions that may fall on the same place. */

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
