/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counted allocation, allocations that fail on demand, and arenas. */
#include <stdbool.h>

#include "tests/support/check.h"

static bool all_zero(const void *block, size_t size) {
  const unsigned char *byte = block;
  for (size_t i = 0; i < size; i++)
    if (byte[i]) return false;
  return true;
}

TEST(blocks_are_zeroed_and_counted) {
  uint64_t before = strut_allocation_count();
  RELEASED int *block = strut_allocate(1000, sizeof *block);
  assert_non_null(block);
  assert_true(all_zero(block, 1000 * sizeof *block));
  block[999] = 7;
  block = strut_reallocate(block, 100000, sizeof *block);
  assert_non_null(block);
  assert_all_equal(block[999], 7, strut_allocation_count(), before + 2);
  strut_release(NULL);
}

TEST(nothing_is_a_block_too) {
  void *none = strut_allocate(0, 8), *also = strut_allocate(8, 0);
  assert_true(none && also);
  none = strut_reallocate(none, 0, 8);
  assert_non_null(none);
  strut_release(none);
  strut_release(also);
}

TEST(sizes_that_overflow_are_refused) {
  OWN(strut_arena) arena = {0};
  RELEASED void *block = strut_allocate(1, 1);
  assert_null(strut_allocate(SIZE_MAX / 2, 3));
  assert_null(strut_reallocate(block, SIZE_MAX / 2, 3));
  assert_null(strut_arena_allocate(&arena, SIZE_MAX / 2, 3));
  assert_null(strut_arena_allocate(&arena, SIZE_MAX - 10, 1));
}

TEST(allocations_fail_on_demand) {
  OWN(strut_arena) arena = {0};
  strut_fail_allocation_after(2);
  void *a = strut_allocate(1, 1), *b = strut_allocate(1, 1);
  void *c = strut_allocate(1, 1), *d = strut_allocate(1, 1);
  void *grown = strut_reallocate(a, 100, 1);
  void *from_arena = strut_arena_allocate(&arena, 1, 1);
  strut_fail_allocation_after(-1);
  assert_true(a && b);
  assert_true(!c && !d && !grown && !from_arena); /* every later one */
  RELEASED void *again = strut_allocate(1, 1);
  assert_non_null(again);
  strut_release(a);
  strut_release(b);
}

TEST(arena_blocks_are_aligned_zeroed_and_apart) {
  enum { BLOCKS = 400 };
  static unsigned char *block[BLOCKS];
  strut_arena arena = {0};
  size_t bytes = 0;
  for (size_t i = 0; i < BLOCKS; i++) {
    size_t size = (i * 7919) % 30000 + (i % 50 ? 0 : 2000000);
    block[i] = strut_arena_allocate(&arena, size, 1);
    assert_non_null(block[i]);
    assert_int_equal((uintptr_t)block[i] % 64, 0);
    assert_true(all_zero(block[i], size));
    memset(block[i], (int)(i % 255) + 1, size);
    bytes += size;
    if (i % 3 == 0) assert_string_equal(strut_arena_text(&arena, "abcdef", 3), "abc"), bytes += 4;
  }
  assert_int_equal(arena.bytes, bytes);
  for (size_t i = 0; i < BLOCKS; i++) {
    size_t size = (i * 7919) % 30000 + (i % 50 ? 0 : 2000000);
    for (size_t k = 0; k < size; k++) assert_true(block[i][k] == i % 255 + 1);
  }
  strut_arena_free(&arena);
  assert_int_equal(arena.bytes, 0);
  assert_non_null(strut_arena_allocate(&arena, 10, 10)); /* it may be used again */
  strut_arena_free(&arena);
  strut_arena_free(&arena);
}

TEST(small_blocks_share_an_allocation) {
  OWN(strut_arena) arena = {0};
  uint64_t before = strut_allocation_count();
  for (int i = 0; i < 100; i++) assert_non_null(strut_arena_allocate(&arena, 1, 8));
  assert_int_equal(strut_allocation_count(), before + 1);
}

TEST(arena_texts) {
  OWN(strut_arena) arena = {0};
  char long_text[5000];
  memset(long_text, 'x', sizeof long_text - 1);
  long_text[sizeof long_text - 1] = '\0';
  assert_string_equal(strut_arena_text(&arena, "", 0), "");
  assert_string_equal(strut_arena_format(&arena, "%s %d", "node", 5), "node 5");
  for (int i = 0; i < 10; i++)
    assert_string_equal(strut_arena_format(&arena, "%s", long_text), long_text);
}
