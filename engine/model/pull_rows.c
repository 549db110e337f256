/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/pull_rows.h"

/* The pulls on the nodes of a block, node by node, as these are met. */
typedef struct block_nodes {
  int32_t count;
  uint32_t at[STRUT_BLOCK_ENDS];
  int32_t pulls[STRUT_BLOCK_ENDS], begin[STRUT_BLOCK_ENDS]; /* of each, in: */
  uint16_t pull[STRUT_BLOCK_ENDS];
} block_nodes;

/* Members of a block, and for each node 1 + its number in the block; 0: none yet. */
typedef struct block_members {
  int32_t count;
  const uint32_t *from, *to;
  uint8_t *number;
} block_members;

static void meet(const block_members *m, block_nodes *nodes, uint32_t at) {
  if (!m->number[at / 2]) {
    nodes->at[nodes->count++] = at;
    m->number[at / 2] = (uint8_t)nodes->count;
  }
  nodes->pulls[m->number[at / 2] - 1]++;
}

static void note(const block_members *m, block_nodes *nodes, uint32_t at, uint16_t pull) {
  int32_t i = m->number[at / 2] - 1;
  nodes->pull[nodes->begin[i] + nodes->pulls[i]++] = pull;
}

static void list_pulls(const block_members *m, block_nodes *nodes) {
  for (int32_t k = 0; k < m->count; k++)
    if (m->from[k] != m->to[k]) meet(m, nodes, m->from[k]), meet(m, nodes, m->to[k]);
  for (int32_t i = 0, begin = 0; i < nodes->count; i++) {
    nodes->begin[i] = begin;
    begin += nodes->pulls[i];
    nodes->pulls[i] = 0;
  }
  for (int32_t k = 0; k < m->count; k++) {
    if (m->from[k] == m->to[k]) continue;
    note(m, nodes, m->from[k], strut_pull_at(k, false));
    note(m, nodes, m->to[k], strut_pull_at(k, true));
  }
  for (int32_t i = 0; i < nodes->count; i++) m->number[nodes->at[i] / 2] = 0;
}

static int32_t rows_of(const block_nodes *nodes, int32_t width) {
  int32_t rows = 0;
  for (int32_t i = 0; i < nodes->count; i++) rows += (nodes->pulls[i] + width - 1) / width;
  return rows;
}

/* The width that takes fewest instructions: 2 for each pull, and 5 for each row. */
static int32_t best_width(const block_nodes *nodes) {
  int32_t best = 1, least = INT32_MAX;
  for (int32_t width = 1; width <= STRUT_WIDEST_ROW; width++) {
    int32_t rows = rows_of(nodes, width), cost = rows * (2 * width + 5);
    if (cost >= least || rows * width > STRUT_ROW_PULLS) continue;
    least = cost, best = width;
  }
  return best;
}

/* The first row of all nodes, then the second of those that have one: none waits for the one before. */
static void list_rows(const block_nodes *nodes, strut_pull_rows *rows) {
  int32_t width = best_width(nodes), row = 0, before = -1;
  for (int32_t begin = 0; row > before; begin += width) {
    before = row;
    for (int32_t i = 0; i < nodes->count; i++) {
      if (nodes->pulls[i] <= begin) continue;
      rows->at[row] = nodes->at[i];
      for (int32_t k = 0; k < width; k++)
        rows->pull[row * width + k] = begin + k < nodes->pulls[i]
                                          ? nodes->pull[nodes->begin[i] + begin + k]
                                          : (uint16_t)STRUT_NO_PULL;
      row++;
    }
  }
  rows->rows = (uint16_t)row, rows->width = (uint16_t)width;
}

/* Scratch: 0 for each node up to the last one with a member. NULL: out of memory. */
static uint8_t *make_numbers(int32_t count, const uint32_t *from, const uint32_t *to) {
  uint32_t last = 0;
  for (int32_t k = 0; k < count; k++) {
    if (from[k] > last) last = from[k];
    if (to[k] > last) last = to[k];
  }
  return strut_allocate((size_t)last / 2 + 1, 1);
}

strut_pull_rows *strut_pull_rows_create(strut_arena *arena, int32_t count, const uint32_t *from,
                                        const uint32_t *to) {
  int32_t blocks = (count + STRUT_BLOCK - 1) / STRUT_BLOCK;
  strut_pull_rows *rows = strut_arena_allocate(arena, (size_t)blocks, sizeof *rows);
  uint8_t *number = make_numbers(count, from, to);
  bool good = rows && number;
  for (int32_t b = 0; b < blocks && good; b++) {
    int32_t begin = b * STRUT_BLOCK, left = count - begin;
    const block_members members = {.count = left < STRUT_BLOCK ? left : STRUT_BLOCK,
                                   .from = from + begin,
                                   .to = to + begin,
                                   .number = number};
    block_nodes nodes = {0};
    list_pulls(&members, &nodes);
    list_rows(&nodes, &rows[b]);
  }
  strut_release(number);
  return good ? rows : NULL;
}
