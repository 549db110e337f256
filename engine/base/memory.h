/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Memory: counted allocation and arenas that are freed as one.
 *
 * All memory of strut itself comes from strut_allocate, so that a test can count allocations and
 * make the n-th one fail. Scenes, documents and models each own one arena.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** count * size zeroed bytes, or NULL (also when the product overflows). Free with strut_release. */
STRUT_API void *strut_allocate(size_t count, size_t size);
/** Grows or shrinks a block of strut_allocate; new bytes are not zeroed. NULL leaves the old one. */
STRUT_API void *strut_reallocate(void *block, size_t count, size_t size);
/**
 * Makes room for one more than `count` items of `size` bytes: `block` is the address of a pointer to a block of
 * strut_allocate, *capacity what it has room for. False: memory is out, and the block is as it was.
 */
STRUT_API bool strut_grow(void *block, size_t *capacity, size_t count, size_t size);
/** Frees a block of strut_allocate; NULL is allowed. */
STRUT_API void strut_release(void *block);

/** Calls of strut_allocate and strut_reallocate since the start of the process (all threads). */
STRUT_API uint64_t strut_allocation_count(void);
/** For tests: lets the next n allocations pass and every later one fail; negative: never fail. */
STRUT_API void strut_fail_allocation_after(int64_t n);

/** A growing store of blocks that are freed together. Zero-initialise it. */
typedef struct strut_arena {
  struct strut_arena_chunk *chunk; /* newest; owned */
  size_t bytes;                    /* total handed out */
} strut_arena;

/** count * size zeroed bytes aligned to 64, owned by the arena; NULL when memory is out. */
STRUT_API void *strut_arena_allocate(strut_arena *arena, size_t count, size_t size);
/** A copy of count * size bytes, likewise. */
STRUT_API void *strut_arena_copy(strut_arena *arena, const void *from, size_t count, size_t size);
/** The address of a pointer, and how many items it gets: zeros, or a copy of `from`. */
typedef struct strut_array {
  void *pointer;
  const void *from;
  size_t count, size;
} strut_array;
#define STRUT_NEW(pointer, count)                                                                  \
  { &(pointer), NULL, (size_t)(count), sizeof *(pointer) }
#define STRUT_COPY(pointer, from, count)                                                           \
  { &(pointer), (from), (size_t)(count), sizeof *(pointer) }
/** Gives arrays to the pointers of all STRUT_NEW and STRUT_COPY listed; false: to some NULL, since memory is out. */
#define STRUT_ALLOCATE(arena, ...)                                                                 \
  strut_arena_arrays(arena, (const strut_array[]){__VA_ARGS__, {NULL, NULL, 0, 0}})
STRUT_API bool strut_arena_arrays(strut_arena *arena, const strut_array *list);
/** The same of pointers to double whose addresses are listed, with `count` zeros each. */
#define STRUT_NUMBERS(arena, count, ...)                                                           \
  strut_arena_numbers(arena, (size_t)(count), (double **[]){__VA_ARGS__, NULL})
STRUT_API bool strut_arena_numbers(strut_arena *arena, size_t count, double **const *list);
/** A copy of the first length bytes of text with a terminating NUL; aligned to 1. */
STRUT_API char *strut_arena_text(strut_arena *arena, const char *text, size_t length);
/** printf into the arena; NULL when memory is out. */
STRUT_API char *strut_arena_format(strut_arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Bytes that strut_arena_store writes. */
STRUT_API size_t strut_arena_stored_size(const strut_arena *arena);
/** Copies the contents of all blocks that were given out to `to`. */
STRUT_API void strut_arena_store(const strut_arena *arena, void *to);
/**
 * Puts the contents back into the blocks, which stand where they stood: pointers between them stay good.
 * Blocks that were given out since keep what they hold.
 */
STRUT_API void strut_arena_restore(strut_arena *arena, const void *from);
/** Frees all blocks; the arena may be used again. */
STRUT_API void strut_arena_free(strut_arena *arena);
