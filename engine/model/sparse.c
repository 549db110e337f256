/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/sparse.h"

#include <assert.h>
#include <string.h>

bool strut_triplets_reserve(strut_triplets *triplets, size_t capacity, strut_arena *arena) {
  triplets->row = strut_arena_allocate(arena, capacity, sizeof *triplets->row);
  triplets->column = strut_arena_allocate(arena, capacity, sizeof *triplets->column);
  triplets->value = strut_arena_allocate(arena, capacity, sizeof *triplets->value);
  triplets->capacity = capacity;
  return triplets->row && triplets->column && triplets->value;
}

void strut_triplets_add(strut_triplets *triplets, int32_t row, int32_t column, double value) {
  int32_t low = row > column ? column : row;
  if (triplets->end && (low < triplets->first || low >= triplets->end)) return;
  if (triplets->counting) {
    triplets->count++;
    return;
  }
  assert(triplets->count < triplets->capacity);
  triplets->row[triplets->count] = row > column ? row : column;
  triplets->column[triplets->count] = low;
  triplets->value[triplets->count++] = value;
}

/* Sorts a column's few rows, keeping the order of equals, and sums those; the new length. */
static int32_t tidy_column(int32_t *row, double *value, int32_t length) {
  for (int32_t i = 1; i < length; i++)
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

/* Tidies the columns [first, last), whose entries follow those before. */
static void tidy(strut_sparse *m, int32_t first, int32_t last) {
  int32_t at = m->start[first];
  for (int32_t j = first, begin = at; j < last; j++) {
    int32_t end = m->start[j + 1];
    int32_t length = tidy_column(m->row + begin, m->value + begin, end - begin);
    memmove(m->row + at, m->row + begin, (size_t)length * sizeof *m->row);
    memmove(m->value + at, m->value + begin, (size_t)length * sizeof *m->value);
    at += length;
    begin = end;
    m->start[j + 1] = at;
  }
}

/* Fills the columns [first, end); `start` is set up to `first`, and zero behind. */
static void fill_columns(strut_sparse *m, int32_t first, int32_t end,
                         const strut_triplets *triplets) {
  int32_t *next = m->start + 1; /* shifted by one while filling: becomes start at the end */
  next[first] = m->start[first];
  for (size_t k = 0; k < triplets->count; k++) next[triplets->column[k] + 1]++;
  for (int32_t j = first; j < end; j++) next[j + 1] += next[j] + 1;
  for (int32_t j = first; j < end; j++) {
    m->value[next[j]] = 0.0;
    m->row[next[j]++] = j;
  }
  for (size_t k = 0; k < triplets->count; k++) {
    int32_t at = next[triplets->column[k]]++;
    m->row[at] = triplets->row[k];
    m->value[at] = triplets->value[k];
  }
  tidy(m, first, end);
}

strut_sparse *strut_sparse_begin(int32_t n, size_t capacity, strut_arena *arena) {
  size_t count = capacity + (size_t)n;
  strut_sparse *m = strut_arena_allocate(arena, 1, sizeof *m);
  if (!m) return NULL;
  m->n = n;
  m->start = strut_arena_allocate(arena, (size_t)n + 2, sizeof *m->start);
  m->row = strut_arena_allocate(arena, count, sizeof *m->row);
  m->value = strut_arena_allocate(arena, count, sizeof *m->value);
  return m->start && m->row && m->value ? m : NULL;
}

void strut_sparse_append(strut_sparse *matrix, const strut_triplets *triplets) {
  fill_columns(matrix, triplets->first, triplets->end, triplets);
}

strut_sparse *strut_sparse_build(int32_t n, const strut_triplets *triplets, strut_arena *arena) {
  strut_sparse *m = strut_sparse_begin(n, triplets->count, arena);
  if (m) fill_columns(m, 0, n, triplets);
  return m;
}

strut_sparse *strut_sparse_copy(const strut_sparse *matrix, strut_arena *arena) {
  size_t n = (size_t)matrix->n, entries = (size_t)matrix->start[n];
  strut_sparse *m = strut_arena_allocate(arena, 1, sizeof *m);
  if (!m) return NULL;
  m->n = matrix->n;
  m->start = strut_arena_allocate(arena, n + 1, sizeof *m->start);
  m->row = strut_arena_allocate(arena, entries, sizeof *m->row);
  m->value = strut_arena_allocate(arena, entries, sizeof *m->value);
  if (!m->start || !m->row || !m->value) return NULL;
  memcpy(m->start, matrix->start, (n + 1) * sizeof *m->start);
  memcpy(m->row, matrix->row, entries * sizeof *m->row);
  memcpy(m->value, matrix->value, entries * sizeof *m->value);
  return m;
}

void strut_sparse_multiply(const strut_sparse *matrix, const double *restrict x,
                           double *restrict y) {
  memset(y, 0, (size_t)matrix->n * sizeof *y);
  for (int32_t j = 0; j < matrix->n; j++) {
    y[j] += matrix->value[matrix->start[j]] * x[j];
    for (int32_t k = matrix->start[j] + 1; k < matrix->start[j + 1]; k++) {
      y[matrix->row[k]] += matrix->value[k] * x[j];
      y[j] += matrix->value[k] * x[matrix->row[k]];
    }
  }
}
