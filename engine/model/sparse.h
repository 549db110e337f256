/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Symmetric sparse matrices put together from contributions that may fall on the same place.
 */
#ifndef STRUT_ENGINE_MODEL_SPARSE_H
#define STRUT_ENGINE_MODEL_SPARSE_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/model/linear_solver.h"

/**
 * Collects contributions; zero-initialise, then strut_triplets_reserve. Those outside of the columns
 * [first, end) are left out; end 0: none are. `counting`: they are counted, and not kept.
 */
typedef struct strut_triplets {
  size_t count, capacity;
  int32_t first, end;
  bool counting;
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

/**
 * The same some columns at a time, in their order, so that the contributions need not all be in memory: an
 * n x n matrix without columns, for `capacity` contributions in all; then for each stretch of columns
 * [triplets->first, triplets->end) their contributions, which may be forgotten afterwards.
 */
strut_sparse *strut_sparse_begin(int32_t n, size_t capacity, strut_arena *arena);
void strut_sparse_append(strut_sparse *matrix, const strut_triplets *triplets);

/** A copy in another arena, which takes no more than its entries: a built one takes all contributions. */
strut_sparse *strut_sparse_copy(const strut_sparse *matrix, strut_arena *arena);

/** y = A x with the whole symmetric matrix. */
STRUT_API void strut_sparse_multiply(const strut_sparse *matrix, const double *restrict x,
                                     double *restrict y);

/* Which pulls of a block of members its nodes add up, in rows: a node so loads and stores its force once for several
 * members.
 *
 * All rows of a block are equally long, so that the loop over them has nothing to decide. A node with more pulls has
 * several rows, one with fewer adds -0 as well, which changes no bit. Each node adds its pulls in the order of the
 * table's members.
 */

/** Members are stepped in groups of STRUT_LANES, so tables are padded to a multiple of it; blocks are of whole groups. */
enum { STRUT_LANES = 4, STRUT_BLOCK = 64 };
/** The energy balance adds up the powers of so many blocks, and then these sums: threads share the work. */
enum { STRUT_LEDGER_BLOCKS = 16 };

enum {
  STRUT_BLOCK_ENDS = 2 * STRUT_BLOCK,
  STRUT_NO_PULL =
      2 * STRUT_BLOCK_ENDS, /* where -0 stands, behind x and y of the pull on each end */
  STRUT_PULL_NUMBERS = STRUT_NO_PULL + 2, /* that a block leaves */
  STRUT_WIDEST_ROW = 6,
  STRUT_ROW_PULLS = 3 * STRUT_BLOCK_ENDS / 2 /* room for those of a block, -0 included */
};

/** Of one block. */
typedef struct strut_pull_rows {
  uint16_t rows, width;           /* width: pulls of each, 1 to STRUT_WIDEST_ROW */
  uint16_t pull[STRUT_ROW_PULLS]; /* (rows, width) where they stand, see strut_pull_at */
  uint32_t at[STRUT_BLOCK_ENDS];  /* (rows) where the row's node has its x in coordinate arrays */
} strut_pull_rows;

/**
 * Where, in a block's numbers, the pull on the first or the second end of its member k stands. Members go by groups:
 * first ends of the even and of the odd ones, then second ends likewise.
 */
static inline uint16_t strut_pull_at(int32_t k, bool second) {
  int32_t group = k / STRUT_LANES, lane = k % STRUT_LANES;
  int32_t pair = 2 * (lane % 2) + lane / 2 + (second ? STRUT_LANES : 0);
  return (uint16_t)(2 * (2 * STRUT_LANES * group + pair));
}

/**
 * Rows of all blocks of `count` members, whose ends have their x at from and to (count). Those with both ends in one
 * place, as padding has them, pull nowhere. NULL: out of memory.
 */
STRUT_API strut_pull_rows *strut_pull_rows_create(strut_arena *arena, int32_t count,
                                                  const uint32_t *from, const uint32_t *to);

#endif
