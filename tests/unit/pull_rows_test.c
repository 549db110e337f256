/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every node finds the pulls of its members in their order, and nothing else. */
#include "engine/model/algebra/pull_rows.h"

#include "tests/support/check.h"
#include "tests/support/random.h"

enum { MOST = 3 * STRUT_BLOCK + 7, NODES = 300 };

/* Pulls of a node in the order in which rows add them: 2 * member + end. */
typedef struct node_pulls {
  int32_t count, pull[MOST];
} node_pulls;

static void walk_rows(const strut_pull_rows *t, int32_t block, node_pulls *nodes) {
  int32_t end_at[STRUT_NO_PULL];
  for (int32_t k = 0; k < STRUT_BLOCK; k++) {
    end_at[strut_pull_at(k, false)] = 2 * (block * STRUT_BLOCK + k);
    end_at[strut_pull_at(k, true)] = 2 * (block * STRUT_BLOCK + k) + 1;
  }
  assert_in_range(t->width, 1, STRUT_WIDEST_ROW);
  assert_true(t->rows <= STRUT_BLOCK_ENDS && t->rows * t->width <= STRUT_ROW_PULLS);
  for (int32_t i = 0; i < t->rows; i++)
    for (int32_t k = 0; k < t->width; k++) {
      uint16_t pull = t->pull[i * t->width + k];
      node_pulls *node = &nodes[t->at[i] / 2];
      if (pull != STRUT_NO_PULL) node->pull[node->count++] = end_at[pull];
    }
}

static void check(int32_t count, const uint32_t *from, const uint32_t *to) {
  static node_pulls found[NODES], wanted[NODES];
  OWN(strut_arena) arena = {0};
  strut_pull_rows *rows = strut_pull_rows_create(&arena, count, from, to);
  assert_non_null(rows);
  for (int32_t i = 0; i < NODES; i++) found[i].count = wanted[i].count = 0;
  for (int32_t b = 0; b * STRUT_BLOCK < count; b++) walk_rows(&rows[b], b, found);
  for (int32_t j = 0; j < count; j++) {
    node_pulls *a = &wanted[from[j] / 2], *b = &wanted[to[j] / 2];
    if (a == b) continue;
    a->pull[a->count++] = 2 * j;
    b->pull[b->count++] = 2 * j + 1;
  }
  for (int32_t i = 0; i < NODES; i++) {
    assert_int_equal(found[i].count, wanted[i].count);
    for (int32_t k = 0; k < wanted[i].count; k++)
      assert_int_equal(found[i].pull[k], wanted[i].pull[k]);
  }
}

/* From stars of a few nodes to members that hardly meet; some are padding. */
TEST(random_structures) {
  uint64_t r = 7;
  for (int n = 0; n < 2000; n++) {
    uint32_t from[MOST], to[MOST];
    int32_t count = random_below(&r, MOST + 1), nodes = 2 + random_below(&r, NODES - 2);
    if (random_once_in(&r, 2)) nodes = 2 + random_below(&r, 8);
    for (int32_t j = 0; j < count; j++) {
      from[j] = 2 * (uint32_t)random_below(&r, nodes);
      to[j] = 2 * (uint32_t)random_below(&r, nodes);
    }
    check(count, from, to);
  }
}

/* Nodes of a crawler have three or four members: one row each. */
TEST(rows_are_as_long_as_nodes_want_them) {
  static const uint32_t from[9] = {0, 4, 6, 0, 2, 2, 0, 0, 2}, to[9] = {2, 8, 8, 4, 4, 6, 6, 8, 8};
  OWN(strut_arena) arena = {0};
  const strut_pull_rows *rows = strut_pull_rows_create(&arena, 9, from, to);
  assert_non_null(rows);
  assert_all_equal(rows->rows, 5, rows->width, 4);
}
