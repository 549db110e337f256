/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The program's own malloc and kin stand before the C library's, for all libraries in it. Under the
 * address sanitizer, which is there before us, its hook counts instead.
 */
#include "tests/support/allocations.h"

#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/resource.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNDER_SANITIZER 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define UNDER_SANITIZER 1
#endif

static atomic_uint_fast64_t calls;

#if defined(UNDER_SANITIZER)

int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void *, size_t),
                                              void (*on_free)(const volatile void *));

static void count_one(const volatile void *block, size_t size) {
  (void)block;
  (void)size;
  atomic_fetch_add(&calls, 1);
}

static void ignore(const volatile void *block) { (void)block; }

uint64_t allocations_so_far(void) {
  static atomic_bool installed;
  if (!atomic_exchange(&installed, 1)) __sanitizer_install_malloc_and_free_hooks(count_one, ignore);
  return atomic_load(&calls);
}

#else

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

uint64_t allocations_so_far(void) { return atomic_load(&calls); }

void *malloc(size_t size) {
  atomic_fetch_add(&calls, 1);
  return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
  atomic_fetch_add(&calls, 1);
  return __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
  atomic_fetch_add(&calls, 1);
  return __libc_realloc(block, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
  atomic_fetch_add(&calls, 1);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size) {
  atomic_fetch_add(&calls, 1);
  void *got = __libc_memalign(alignment, size);
  if (!got) return ENOMEM;
  *block = got;
  return 0;
}

#endif

long resident(void) {
  struct rusage usage;
  return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss : 0;
}
