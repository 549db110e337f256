/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/memory.h"

#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "engine/base/memory_limit.h"

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
  for (const struct strut_arena_chunk *c = arena->chunk; c; c = c->previous) count++;
  return count;
}

size_t strut_arena_stored_size(const strut_arena *arena) {
  size_t bytes = sizeof(size_t);
  for (const struct strut_arena_chunk *c = arena->chunk; c; c = c->previous)
    bytes += sizeof(size_t) + c->used;
  return bytes;
}

void strut_arena_store(const strut_arena *arena, void *to) {
  char *at = to;
  size_t count = chunk_count(arena);
  memcpy(at, &count, sizeof count);
  at += sizeof count;
  for (const struct strut_arena_chunk *c = arena->chunk; c; c = c->previous) {
    memcpy(at, &c->used, sizeof c->used);
    memcpy(at + sizeof c->used, c->base, c->used);
    at += sizeof c->used + c->used;
  }
}

void strut_arena_restore(strut_arena *arena, const void *from) {
  const char *at = from;
  size_t count, now = chunk_count(arena);
  struct strut_arena_chunk *c = arena->chunk;
  memcpy(&count, at, sizeof count);
  at += sizeof count;
  for (; now > count; now--) c = c->previous; /* chunks that came since */
  for (; c; c = c->previous) {
    size_t used;
    memcpy(&used, at, sizeof used);
    memcpy(c->base, at + sizeof used, used);
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

static double of_process(int resource) {
  struct rlimit limit;
  if (getrlimit(resource, &limit) || limit.rlim_cur == RLIM_INFINITY) return HUGE_VAL;
  return (double)limit.rlim_cur;
}

static double of_machine(void) {
  double page = (double)sysconf(_SC_PAGESIZE), pages = (double)sysconf(_SC_PHYS_PAGES);
  return page > 0 && pages > 0 ? page * pages : HUGE_VAL;
}

/* A container's, where the file is there and holds a number ("max": no limit). */
static double of_group(void) {
  static const char *const files[] = {"/sys/fs/cgroup/memory.max",
                                      "/sys/fs/cgroup/memory/memory.limit_in_bytes"};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    double bytes = 0.0;
    FILE *file = fopen(files[i], "r");
    int got = file ? fscanf(file, "%lf", &bytes) : 0;
    if (file) fclose(file);
    if (got == 1 && bytes > 0.0) return bytes;
  }
  return HUGE_VAL;
}

double strut_memory_most(const char **whose) {
  const struct {
    double bytes;
    const char *whose;
  } bound[] = {{of_machine(), "the machine has"},
               {of_group(), "the machine has for this container"},
               {of_process(RLIMIT_AS), "the process may have (ulimit -v)"},
               {of_process(RLIMIT_DATA), "the process may have (ulimit -d)"}};
  size_t least = 0;
  for (size_t i = 1; i < sizeof bound / sizeof bound[0]; i++)
    if (bound[i].bytes < bound[least].bytes) least = i;
  *whose = bound[least].whose;
  return bound[least].bytes;
}

/* Smaller requests are not checked: every process has this much. */
static const double ALWAYS = 16e6;

static strut_status say(const char *begin, double bytes, const char *what, strut_error *error) {
  const char *whose;
  double most = strut_memory_most(&whose);
  int digits = bytes < 1e7 ? 2 : 0;
  if (!(most < HUGE_VAL))
    return strut_fail(error, STRUT_NO_MEMORY, "%s%s needs at least %.*f MB of memory", begin, what,
                      digits, bytes / 1e6);
  return strut_fail(error, STRUT_NO_MEMORY,
                    "%s%s needs at least %.*f MB of memory, and %s %.0f MB; simplify the scene or "
                    "allow more",
                    begin, what, digits, bytes / 1e6, whose, most / 1e6);
}

strut_status strut_memory_check(double bytes, const char *what, strut_error *error) {
  const char *whose;
  return bytes <= ALWAYS || bytes <= strut_memory_most(&whose) ? STRUT_OK
                                                               : say("", bytes, what, error);
}

strut_status strut_memory_fail(double bytes, const char *what, strut_error *error) {
  return say("out of memory: ", bytes, what, error);
}
