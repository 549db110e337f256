/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How much memory the process holds, to find leaks by: what is done again and again must not add up.
 */
#pragma once

#include <malloc.h>
#include <stddef.h>

/**
 * Bytes that malloc and its kin have handed out, or keep in their caches: compare after some rounds of
 * the same. Under the address sanitizer, which finds leaks by itself, always the same.
 */
static inline size_t heap_in_use(void) {
  struct mallinfo2 now = mallinfo2();
  return now.uordblks + now.hblkhd;
}
