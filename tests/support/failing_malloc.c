/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Preloaded into a program: the n-th allocation of the whole process fails, libraries' own included.
 *
 * STRUT_FAIL_AT is n, counted from 1 (0 or nothing: none fails); the process writes how many there were
 * into the file STRUT_COUNT_FILE when it ends. Threads count together. Allocations that a library makes
 * itself whose path holds a word of STRUT_SPARE ("libhdf5:libglib") are neither counted nor fail.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* glibc's own, which need no dlsym, which would allocate itself. */
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *block, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

static atomic_long allocations;
static long fail_at;
static char spared[400]; /* words, each ended by a NUL, and an empty one behind the last */

/* Whether the code at this address belongs to a library that is spared. */
static int is_spared(const void *caller) {
  Dl_info where;
  if (!spared[0] || !dladdr(caller, &where) || !where.dli_fname) return 0;
  for (const char *word = spared; *word; word += strlen(word) + 1)
    if (strstr(where.dli_fname, word)) return 1;
  return 0;
}

/* True where this allocation must fail. */
static int must_fail(const void *caller) {
  if (is_spared(caller)) return 0;
  long n = atomic_fetch_add(&allocations, 1) + 1;
  if (n != fail_at) return 0;
  errno = ENOMEM;
  return 1;
}

void *malloc(size_t size) {
  return must_fail(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
  return must_fail(__builtin_return_address(0)) ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
  return size > 0 && must_fail(__builtin_return_address(0)) ? NULL : __libc_realloc(block, size);
}

int posix_memalign(void **block, size_t alignment, size_t size) {
  if (must_fail(__builtin_return_address(0))) return ENOMEM;
  void *got = __libc_memalign(alignment, size);
  if (!got) return ENOMEM;
  *block = got;
  return 0;
}

void *aligned_alloc(size_t alignment, size_t size) {
  return must_fail(__builtin_return_address(0)) ? NULL : __libc_memalign(alignment, size);
}

/* Allocations before this are those of the loader: nobody can go on without them. */
__attribute__((constructor)) static void begin(void) {
  const char *wanted = getenv("STRUT_FAIL_AT"), *spare = getenv("STRUT_SPARE");
  if (spare && strlen(spare) < sizeof spared - 1) strcpy(spared, spare);
  for (size_t i = 0; i < sizeof spared; i++)
    if (spared[i] == ':') spared[i] = '\0';
  atomic_store(&allocations, 0);
  fail_at = wanted ? atol(wanted) : 0;
}

__attribute__((destructor)) static void end(void) {
  const char *path = getenv("STRUT_COUNT_FILE");
  char text[32];
  int file = path ? open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
  if (file < 0) return;
  int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&allocations));
  if (write(file, text, (size_t)length) != length) _exit(99);
  close(file);
}
