/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The motion of a page: arrays over time as compact blocks, in the format that page.h describes.
 */
#ifndef STRUT_ENGINE_OUTPUT_PAGE_PAGE_MOTION_H
#define STRUT_ENGINE_OUTPUT_PAGE_PAGE_MOTION_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/output/buffer.h"
#include "engine/output/page/page.h"

/** An array (frames, columns) of which every `every`-th frame is used, and the last. */
typedef struct strut_rows {
  const double *values; /* finite */
  size_t frames, columns, every;
} strut_rows;

/** The number of frames used. */
STRUT_API size_t strut_rows_taken(const strut_rows *rows);
/** Offset of the i-th series. */
STRUT_API const double *strut_rows_at(const strut_rows *rows, size_t i);
/** The largest magnitude among all frames. */
STRUT_API double strut_rows_largest(const strut_rows *rows);

/** As many quanta as a value may have at most: so that no number of a block reaches 2^53. */
#define STRUT_MOST_QUANTA 562949953421312.0 /* 2^49 */

/**
 * The largest number of the form 1, 2 or 5 times a power of ten that is not above `wanted`; but
 * large enough that `largest` has at most STRUT_MOST_QUANTA of it.
 */
STRUT_API double strut_round_quantum(double wanted, double largest);
/** True if every value of rows is a whole multiple of `quantum`, to the last bits of a double. */
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

/**
 * Appends the value of the key motion, about `room` bytes of it, or null. Frames from the first
 * that is not finite, or far out of all bounds, are left out; then as many evenly as it takes.
 */
void strut_page_add_motion(strut_buffer *buffer, const strut_page *page, size_t room,
                           strut_page_frames *frames);

#endif
