/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Arrays over time as blocks of few bytes: page.h says how.
 */
#ifndef STRUT_ENGINE_OUTPUT_PAGE_PAGE_BLOCKS_H
#define STRUT_ENGINE_OUTPUT_PAGE_PAGE_BLOCKS_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/export.h"

/** An array (frames, columns) of which every so many-th frame is taken, and the last. */
typedef struct strut_rows {
  const double *values; /* finite */
  size_t frames, columns, every;
} strut_rows;

/** How many frames are taken. */
STRUT_API size_t strut_rows_taken(const strut_rows *rows);
/** Where the i-th of them begins. */
STRUT_API const double *strut_rows_at(const strut_rows *rows, size_t i);
/** The largest magnitude among all frames. */
STRUT_API double strut_rows_largest(const strut_rows *rows);

/** As many quanta as a value may have at most: so that no number of a block reaches 2^53. */
#define STRUT_MOST_QUANTA 562949953421312.0 /* 2^49 */

/**
 * The largest number of the form 1, 2 or 5 times a power of ten that is not above `wanted`; but
 * never so small that a value of magnitude `largest` has more than STRUT_MOST_QUANTA of it.
 */
STRUT_API double strut_round_quantum(double wanted, double largest);
/** Whether every value of rows is a whole multiple of `quantum`, to the last bits of a double. */
STRUT_API bool strut_rows_multiples(const strut_rows *rows, double quantum);

/** The bytes of a block before they become base64. */
typedef struct strut_block {
  double quantum;
  size_t columns, size;
  unsigned char *bytes; /* (size) deflated; owned */
} strut_block;

/** False when memory is out. No value may be more than STRUT_MOST_QUANTA quanta. */
STRUT_API bool strut_block_encode(const strut_rows *rows, double quantum, strut_block *block);
/** A zeroed block is allowed; it is zeroed again. */
STRUT_API void strut_block_free(strut_block *block);

#endif
