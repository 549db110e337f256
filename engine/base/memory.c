/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/memory.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CHUNK = 16 * 1024, LARGEST_CHUNK = 1024 * 1024, ALIGNMENT = 64 };

struct strut_arena_chunk {
  struct strut_arena_chunk *previous;
  char *base; /* what strut_allocate gave */
  size_t used, size;
};

static atomic_uint_fast64_t allocation_count;
static atomic_int_fast64_t failure_countdown = -1;

/* True if a test makes this allocation fail. */
static int must_fail(void) {
  atomic_fetch_add_explicit(&allocation_count, 1, memory_order_relaxed);
  if (atomic_load_explicit(&failure_countdown, memory_order_relaxed) < 0) return 0;
  if (atomic_load(&failure_countdown) == 0) return 1;
  atomic_fetch_sub(&failure_countdown, 1);
  return 0;
}

uint64_t strut_allocation_count(void) { return atomic_load(&allocation_count); }

void strut_fail_allocation_after(int64_t n) { atomic_store(&failure_countdown, n < 0 ? -1 : n); }

void *strut_allocate(size_t count, size_t size) {
  if (must_fail() || (size && count > SIZE_MAX / size)) return NULL;
  return calloc(count ? count : 1, size ? size : 1);
}

void *strut_reallocate(void *block, size_t count, size_t size) {
  if (must_fail() || (size && count > SIZE_MAX / size)) return NULL;
  return realloc(block, count * size > 0 ? count * size : 1);
}

bool strut_has_memory(size_t bytes) {
  void *block = strut_allocate(1, bytes);
  strut_release(block);
  return block != NULL;
}

bool strut_grow(void *block, size_t *capacity, size_t count, size_t size) {
  void *items;
  if (count < *capacity) return true;
  size_t more = *capacity ? 2 * *capacity : 16;
  memcpy(&items, block, sizeof items);
  items = strut_reallocate(items, more, size);
  if (!items) return false;
  memcpy(block, &items, sizeof items);
  *capacity = more;
  return true;
}

void strut_release(void *block) { free(block); }

/* Offset of the first byte at or after `used` whose address is a multiple of `alignment`. */
static size_t align_up(const char *base, size_t used, size_t alignment) {
  uintptr_t address = (uintptr_t)base + used;
  return used + (size_t)(-address & (uintptr_t)(alignment - 1));
}

static struct strut_arena_chunk *new_chunk(strut_arena *arena, size_t need) {
  size_t size = arena->chunk ? arena->chunk->size * 2 : FIRST_CHUNK;
  if (size > LARGEST_CHUNK) size = LARGEST_CHUNK;
  if (size < need + ALIGNMENT) size = need + ALIGNMENT;
  struct strut_arena_chunk *chunk = strut_allocate(1, sizeof *chunk + size);
  if (!chunk) return NULL;
  chunk->base = (char *)(chunk + 1);
  chunk->size = size;
  chunk->previous = arena->chunk;
  arena->chunk = chunk;
  return chunk;
}

static void *take(strut_arena *arena, size_t bytes, size_t alignment) {
  struct strut_arena_chunk *chunk = arena->chunk;
  if (bytes > SIZE_MAX / 2) return NULL;
  size_t start = chunk ? align_up(chunk->base, chunk->used, alignment) : 0;
  if (!chunk || start > chunk->size || bytes > chunk->size - start) {
    chunk = new_chunk(arena, bytes);
    if (!chunk) return NULL;
    start = align_up(chunk->base, 0, alignment);
  }
  chunk->used = start + bytes;
  arena->bytes += bytes;
  return chunk->base + start;
}

void *strut_arena_allocate(strut_arena *arena, size_t count, size_t size) {
  if (size && count > SIZE_MAX / size) return NULL;
  return take(arena, count * size, ALIGNMENT);
}

void *strut_arena_copy(strut_arena *arena, const void *from, size_t count, size_t size) {
  void *copy = strut_arena_allocate(arena, count, size);
  if (copy && count) memcpy(copy, from, count * size);
  return copy;
}

bool strut_arena_numbers(strut_arena *arena, size_t count, double **const *list) {
  bool all = true;
  for (; *list; list++) all = (**list = strut_arena_allocate(arena, count, sizeof(double))) && all;
  return all;
}

char *strut_arena_text(strut_arena *arena, const char *text, size_t length) {
  char *copy = take(arena, length + 1, 1);
  if (!copy) return NULL;
  memcpy(copy, text, length);
  copy[length] = '\0';
  return copy;
}

char *strut_arena_format(strut_arena *arena, const char *format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, arguments);
  va_end(arguments);
  char *text = length < 0 ? NULL : take(arena, (size_t)length + 1, 1);
  if (text) vsnprintf(text, (size_t)length + 1, format, again);
  va_end(again);
  return text;
}

/* ---- contents ---- */

/* Before the contents: how many chunks there are, and how much of each is used, the newest first. */
static size_t chunk_count(const strut_arena *arena) {
  size_t count = 0;
  for (const struct strut_arena_chunk *chunk = arena->chunk; chunk; chunk = chunk->previous)
    count++;
  return count;
}

size_t strut_arena_stored_size(const strut_arena *arena) {
  size_t bytes = sizeof(size_t);
  for (const struct strut_arena_chunk *chunk = arena->chunk; chunk; chunk = chunk->previous)
    bytes += sizeof(size_t) + chunk->used;
  return bytes;
}

void strut_arena_store(const strut_arena *arena, void *to) {
  char *at = to;
  size_t count = chunk_count(arena);
  memcpy(at, &count, sizeof count);
  at += sizeof count;
  for (const struct strut_arena_chunk *chunk = arena->chunk; chunk; chunk = chunk->previous) {
    memcpy(at, &chunk->used, sizeof chunk->used);
    memcpy(at + sizeof chunk->used, chunk->base, chunk->used);
    at += sizeof chunk->used + chunk->used;
  }
}

void strut_arena_restore(strut_arena *arena, const void *from) {
  const char *at = from;
  size_t count, now = chunk_count(arena);
  struct strut_arena_chunk *chunk = arena->chunk;
  memcpy(&count, at, sizeof count);
  at += sizeof count;
  for (; now > count; now--) chunk = chunk->previous; /* chunks that came since */
  for (; chunk; chunk = chunk->previous) {
    size_t used;
    memcpy(&used, at, sizeof used);
    memcpy(chunk->base, at + sizeof used, used);
    at += sizeof used + used;
  }
}

void strut_arena_free(strut_arena *arena) {
  struct strut_arena_chunk *chunk = arena->chunk;
  while (chunk) {
    struct strut_arena_chunk *previous = chunk->previous;
    strut_release(chunk);
    chunk = previous;
  }
  arena->chunk = NULL;
  arena->bytes = 0;
}
