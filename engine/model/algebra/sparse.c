/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <string.h>

#include "engine/model/algebra/linear_solver.h"

#include "engine/model/algebra/pull_rows.h"

bool strut_triplets_reserve(strut_triplets *triplets, size_t capacity, strut_arena *arena) {
  triplets->capacity = capacity;
  return STRUT_ALLOCATE(arena, STRUT_NEW(triplets->row, capacity),
                        STRUT_NEW(triplets->column, capacity),
                        STRUT_NEW(triplets->value, capacity));
}

void strut_triplets_add(strut_triplets *triplets, int32_t row, int32_t column, double value) {
  int32_t low = row > column ? column : row;
  assert(triplets->count < triplets->capacity);
  triplets->row[triplets->count] = row > column ? row : column;
  triplets->column[triplets->count] = low;
  triplets->value[triplets->count++] = value;
}

/* A column of more entries, as of a hub, is merged. */
enum { FEW = 32 };

typedef struct entry {
  int32_t row;
  double value;
} entry;

/* Sorts by merging, keeping the order of equals; false: out of memory. */
static bool merge_rows(int32_t *row, double *value, size_t length) {
  entry *from = strut_allocate(2 * length, sizeof *from), *all = from, *to = from + length;
  if (!all) return false;
  for (size_t i = 0; i < length; i++) from[i] = (entry){row[i], value[i]};
  for (size_t width = 1; width < length; width *= 2) {
    for (size_t begin = 0; begin < length; begin += 2 * width) {
      size_t middle = begin + width < length ? begin + width : length;
      size_t end = middle + width < length ? middle + width : length;
      for (size_t k = begin, a = begin, b = middle; k < end; k++)
        to[k] = a < middle && (b >= end || from[a].row <= from[b].row) ? from[a++] : from[b++];
    }
    entry *other = from;
    from = to, to = other;
  }
  for (size_t i = 0; i < length; i++) row[i] = from[i].row, value[i] = from[i].value;
  strut_release(all);
  return true;
}

/* Sorts a column's rows, keeping the order of equals, and sums those; the new length. */
static int32_t tidy_column(int32_t *row, double *value, int32_t length) {
  bool merged = length > FEW && merge_rows(row, value, (size_t)length);
  for (int32_t i = 1; i < length && !merged; i++)
    for (int32_t k = i; k > 0 && row[k - 1] > row[k]; k--) {
      int32_t r = row[k];
      double v = value[k];
      row[k] = row[k - 1], value[k] = value[k - 1];
      row[k - 1] = r, value[k - 1] = v;
    }
  int32_t last = 0;
  for (int32_t i = 1; i < length; i++)
    if (row[i] == row[last])
      value[last] += value[i];
    else
      last++, row[last] = row[i], value[last] = value[i];
  return last + 1;
}

/* Tidies the columns, whose entries then follow each other. */
static void tidy(strut_sparse *matrix) {
  for (int32_t j = 0, begin = 0, at = 0; j < matrix->n; j++) {
    int32_t end = matrix->start[j + 1];
    int32_t length = tidy_column(matrix->row + begin, matrix->value + begin, end - begin);
    memmove(matrix->row + at, matrix->row + begin, (size_t)length * sizeof *matrix->row);
    memmove(matrix->value + at, matrix->value + begin, (size_t)length * sizeof *matrix->value);
    at += length;
    begin = end;
    matrix->start[j + 1] = at;
  }
}

strut_sparse *strut_sparse_build(int32_t n, const strut_triplets *triplets, strut_arena *arena) {
  size_t count = triplets->count + (size_t)n;
  strut_sparse *matrix = strut_arena_allocate(arena, 1, sizeof *matrix);
  if (!matrix) return NULL;
  matrix->n = n;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(matrix->start, (size_t)n + 2), STRUT_NEW(matrix->row, count),
                      STRUT_NEW(matrix->value, count)))
    return NULL;
  int32_t *next = matrix->start + 1; /* shifted by one while filling: becomes start at the end */
  for (size_t k = 0; k < triplets->count; k++) next[triplets->column[k] + 1]++;
  for (int32_t j = 0; j < n; j++) {
    next[j + 1] += next[j] + 1;
    matrix->row[next[j]++] = j;
  }
  for (size_t k = 0; k < triplets->count; k++) {
    int32_t at = next[triplets->column[k]]++;
    matrix->row[at] = triplets->row[k];
    matrix->value[at] = triplets->value[k];
  }
  tidy(matrix);
  return matrix;
}

void strut_sparse_multiply(const strut_sparse *matrix, const double *restrict vector,
                           double *restrict y) {
  memset(y, 0, (size_t)matrix->n * sizeof *y);
  for (int32_t j = 0; j < matrix->n; j++) {
    y[j] += matrix->value[matrix->start[j]] * vector[j];
    for (int32_t k = matrix->start[j] + 1; k < matrix->start[j + 1]; k++) {
      y[matrix->row[k]] += matrix->value[k] * vector[j];
      y[j] += matrix->value[k] * vector[matrix->row[k]];
    }
  }
}

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

static void meet(const block_members *self, block_nodes *nodes, uint32_t at) {
  if (!self->number[at / 2]) {
    nodes->at[nodes->count++] = at;
    self->number[at / 2] = (uint8_t)nodes->count;
  }
  nodes->pulls[self->number[at / 2] - 1]++;
}

static void note(const block_members *self, block_nodes *nodes, uint32_t at, uint16_t pull) {
  int32_t i = self->number[at / 2] - 1;
  nodes->pull[nodes->begin[i] + nodes->pulls[i]++] = pull;
}

static void list_pulls(const block_members *self, block_nodes *nodes) {
  for (int32_t k = 0; k < self->count; k++)
    if (self->from[k] != self->to[k])
      meet(self, nodes, self->from[k]), meet(self, nodes, self->to[k]);
  for (int32_t i = 0, begin = 0; i < nodes->count; i++) {
    nodes->begin[i] = begin;
    begin += nodes->pulls[i];
    nodes->pulls[i] = 0;
  }
  for (int32_t k = 0; k < self->count; k++) {
    if (self->from[k] == self->to[k]) continue;
    note(self, nodes, self->from[k], strut_pull_at(k, false));
    note(self, nodes, self->to[k], strut_pull_at(k, true));
  }
  for (int32_t i = 0; i < nodes->count; i++) self->number[nodes->at[i] / 2] = 0;
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
