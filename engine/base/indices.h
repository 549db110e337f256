/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Searches among indices, and trees over consecutive items. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
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

/* A binary tree over consecutive items, in an array: node k has its children at 2 k + 1 and 2 k + 2. */

enum { STRUT_SUBTREE_LEAF = 8 }; /* most items of a leaf */

/** Items begin .. end - 1, below node `at`. */
typedef struct strut_subtree {
  size_t at, begin, end;
} strut_subtree;

static inline bool strut_subtree_is_leaf(strut_subtree r) {
  return r.end - r.begin <= STRUT_SUBTREE_LEAF;
}

static inline strut_subtree strut_subtree_child(strut_subtree r, int which) {
  size_t middle = r.begin + (r.end - r.begin) / 2;
  return which ? (strut_subtree){2 * r.at + 2, middle, r.end}
               : (strut_subtree){2 * r.at + 1, r.begin, middle};
}

/** Nodes of a tree over `count` items. */
static inline size_t strut_subtree_nodes(size_t count) {
  size_t nodes = 1;
  for (; count > STRUT_SUBTREE_LEAF; count -= count / 2) nodes = 2 * nodes + 1;
  return nodes;
}
