/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Searches among indices. */
#pragma once

#include <stdint.h>

/** The first of (count) ascending numbers that is not below `wanted`; count where all are below. */
static inline int32_t strut_index_find(const int32_t *list, int32_t count, int32_t wanted) {
  int32_t low = 0, high = count;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (list[middle] < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/** The root of i's set, to which `parent` leads from each index of it; shortens the way there. */
static inline int32_t strut_index_root(int32_t *parent, int32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}
