/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Which pulls of a block of members its nodes add up, in rows: a node so loads and stores its force once for
 * several members.
 *
 * All rows of a block are equally long, so that the loop over them has nothing to decide. A node with more
 * pulls has several rows, one with fewer adds -0 as well, which changes no bit. Each node adds its pulls in
 * the order of the table's members.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "engine/base/memory.h"

/**
 * Members are stepped in groups of STRUT_LANES, so tables are padded to a multiple of it; blocks are of whole
 * groups.
 */
enum { STRUT_LANES = 4, STRUT_BLOCK = 64 };
/** The energy balance adds up the powers of so many blocks, and then these sums. */
enum { STRUT_BALANCE_BLOCKS = 16 };

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
 * Where, in a block's numbers, the pull on the first or the second end of its member k stands. Members go by
 * groups: first ends of the even and of the odd ones, then second ends likewise.
 */
static inline uint16_t strut_pull_at(int32_t k, bool second) {
  int32_t group = k / STRUT_LANES, lane = k % STRUT_LANES;
  int32_t pair = 2 * (lane % 2) + lane / 2 + (second ? STRUT_LANES : 0);
  return (uint16_t)(2 * (2 * STRUT_LANES * group + pair));
}

/**
 * Rows of all blocks of `count` members, whose ends have their x at from and to (count). Those with both ends
 * in one place, as padding has them, pull nowhere. NULL: out of memory.
 */
STRUT_API strut_pull_rows *strut_pull_rows_create(strut_arena *arena, int32_t count,
                                                  const uint32_t *from, const uint32_t *to);
