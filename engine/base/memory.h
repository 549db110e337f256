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
/** Could so many bytes be had? Asked before libraries that end the process, or crash, where they find none. */
STRUT_API bool strut_has_memory(size_t bytes);

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
/** A pointer and how many items of its type it gets. */
#define STRUT_NEW(pointer, count) (pointer, count)
/** Gives zeros to the pointers of up to 8 STRUT_NEW; false: to some NULL, since memory is out. */
#define STRUT_ALLOCATE(arena, ...)                                                                 \
  (STRUT_EACH(STRUT_GIVE, arena, __VA_ARGS__) STRUT_EACH(STRUT_GIVEN, arena, __VA_ARGS__) true)
#define STRUT_GIVE(arena, pointer, count)                                                          \
  (pointer) = strut_arena_allocate(arena, (size_t)(count), sizeof *(pointer)),
#define STRUT_GIVEN(arena, pointer, count) (pointer) &&
/** The same with copies of what they point to. */
#define STRUT_DUPLICATE(arena, ...)                                                                \
  (STRUT_EACH(STRUT_COPY, arena, __VA_ARGS__) STRUT_EACH(STRUT_GIVEN, arena, __VA_ARGS__) true)
#define STRUT_COPY(arena, pointer, count)                                                          \
  (pointer) = strut_arena_copy(arena, pointer, (size_t)(count), sizeof *(pointer)),
/* DO(arena, pointer, count) for each. */
#define STRUT_EACH(DO, arena, ...)                                                                 \
  STRUT_9TH(__VA_ARGS__, STRUT_8, STRUT_7, STRUT_6, STRUT_5, STRUT_4, STRUT_3, STRUT_2, STRUT_1,   \
            0)                                                                                     \
  (DO, arena, __VA_ARGS__)
#define STRUT_9TH(a, b, c, d, e, f, g, h, NAME, ...) NAME
#define STRUT_1(DO, A, X) STRUT_DO(DO, A, STRUT_UNPACKED X)
#define STRUT_2(DO, A, X, ...) STRUT_1(DO, A, X) STRUT_1(DO, A, __VA_ARGS__)
#define STRUT_3(DO, A, X, ...) STRUT_1(DO, A, X) STRUT_2(DO, A, __VA_ARGS__)
#define STRUT_4(DO, A, X, ...) STRUT_1(DO, A, X) STRUT_3(DO, A, __VA_ARGS__)
#define STRUT_5(DO, A, X, ...) STRUT_1(DO, A, X) STRUT_4(DO, A, __VA_ARGS__)
#define STRUT_6(DO, A, X, ...) STRUT_1(DO, A, X) STRUT_5(DO, A, __VA_ARGS__)
#define STRUT_7(DO, A, X, ...) STRUT_1(DO, A, X) STRUT_6(DO, A, __VA_ARGS__)
#define STRUT_8(DO, A, X, ...) STRUT_1(DO, A, X) STRUT_7(DO, A, __VA_ARGS__)
#define STRUT_DO(DO, ...) DO(__VA_ARGS__)
#define STRUT_UNPACKED(...) __VA_ARGS__
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
