/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/refactor.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

struct strut_refactor {
  strut_factor factor;
  /* the matrix's entries in the factor's order, column by column: row, and place among its values */
  int32_t *start, *row, *from; /* (n + 1), (nonzeros) each */
  double *diagonal, *work;     /* (n) D; scratch, all 0 between calls */
  /* columns waiting for the row of their next entry, as lists */
  int32_t *head, *next, *at; /* (n) each */
};

/* A matrix of the pattern that is positive definite beyond doubt: -1 beside a heavier diagonal. */
static bool fill_example(const strut_sparse *pattern, strut_sparse *example, strut_arena *arena) {
  *example = *pattern;
  example->value =
      strut_arena_allocate(arena, (size_t)pattern->start[pattern->n], sizeof *example->value);
  if (!example->value) return false;
  for (int32_t j = 0; j < pattern->n; j++) example->value[pattern->start[j]] = 1.0;
  for (int32_t j = 0; j < pattern->n; j++)
    for (int32_t k = pattern->start[j] + 1; k < pattern->start[j + 1]; k++) {
      example->value[k] = -1.0;
      example->value[pattern->start[j]] += 1.0;
      example->value[pattern->start[pattern->row[k]]] += 1.0;
    }
  return true;
}

static bool copy_factor(const strut_factor *from, strut_factor *to, strut_arena *arena) {
  size_t n = (size_t)from->n, nonzeros = (size_t)from->start[from->n];
  to->n = from->n;
  to->order = strut_arena_allocate(arena, n, sizeof *to->order);
  to->start = strut_arena_allocate(arena, n + 1, sizeof *to->start);
  to->row = strut_arena_allocate(arena, nonzeros, sizeof *to->row);
  to->value = strut_arena_allocate(arena, nonzeros, sizeof *to->value);
  to->inverse_diagonal = strut_arena_allocate(arena, n, sizeof *to->inverse_diagonal);
  if (!to->order || !to->start || !to->row || !to->value || !to->inverse_diagonal) return false;
  memcpy(to->order, from->order, n * sizeof *to->order);
  memcpy(to->start, from->start, (n + 1) * sizeof *to->start);
  memcpy(to->row, from->row, nonzeros * sizeof *to->row);
  return true;
}

/* Where each entry of the matrix stands in the factor's order. */
static void place_entries(const strut_sparse *pattern, strut_refactor *r) {
  int32_t n = pattern->n, *place = r->next;
  for (int32_t i = 0; i < n; i++) place[r->factor.order[i]] = i;
  for (int32_t pass = 0; pass < 2; pass++) {
    for (int32_t j = 0; j < n; j++)
      for (int32_t k = pattern->start[j]; k < pattern->start[j + 1]; k++) {
        int32_t a = place[j], b = place[pattern->row[k]], column = a < b ? a : b;
        if (pass == 0) {
          r->start[column + 1]++;
          continue;
        }
        int32_t to = r->start[column] + r->at[column]++;
        r->row[to] = a < b ? b : a;
        r->from[to] = k;
      }
    for (int32_t j = 0; j < n && pass == 0; j++) r->start[j + 1] += r->start[j];
  }
}

strut_refactor *strut_refactor_create(const strut_sparse *pattern, strut_arena *arena) {
  strut_refactor *r = strut_arena_allocate(arena, 1, sizeof *r);
  strut_arena scratch = {0};
  strut_sparse example;
  strut_factor *factor = NULL;
  size_t n = (size_t)pattern->n, nonzeros = (size_t)pattern->start[n];
  bool good = r && fill_example(pattern, &example, &scratch) &&
              !strut_factor_create(&example, &factor, NULL) &&
              copy_factor(factor, &r->factor, arena);
  strut_factor_free(factor);
  strut_arena_free(&scratch);
  if (!good) return NULL;
  int32_t **indices[] = {&r->row, &r->from, &r->head, &r->next, &r->at, &r->start};
  size_t counts[] = {nonzeros, nonzeros, n, n, n, n + 1};
  for (size_t i = 0; i < sizeof indices / sizeof indices[0]; i++)
    if (!(*indices[i] = strut_arena_allocate(arena, counts[i], sizeof **indices[i]))) return NULL;
  r->diagonal = strut_arena_allocate(arena, n, sizeof *r->diagonal);
  r->work = strut_arena_allocate(arena, n, sizeof *r->work);
  if (!r->diagonal || !r->work) return NULL;
  place_entries(pattern, r);
  return r;
}

/* Column k waits for the row of its entry at r->at[k], if there is one left. */
static void wait_for_next(strut_refactor *r, int32_t k) {
  if (r->at[k] == r->factor.start[k + 1]) return;
  int32_t row = r->factor.row[r->at[k]];
  r->next[k] = r->head[row];
  r->head[row] = k;
}

/* Column by column, each taking what the ones before it leave (left-looking). */
int32_t strut_refactor_apply(strut_refactor *r, const strut_sparse *matrix) {
  const strut_factor *f = &r->factor;
  double *restrict work = r->work;
  for (int32_t j = 0; j < f->n; j++) r->head[j] = -1;
  for (int32_t j = 0; j < f->n; j++) {
    for (int32_t i = r->start[j]; i < r->start[j + 1]; i++)
      work[r->row[i]] += matrix->value[r->from[i]];
    for (int32_t k = r->head[j], following; k >= 0; k = following) {
      following = r->next[k];
      double part = f->value[r->at[k]] * r->diagonal[k];
      for (int32_t i = r->at[k]; i < f->start[k + 1]; i++) work[f->row[i]] -= f->value[i] * part;
      r->at[k]++;
      wait_for_next(r, k);
    }
    double pivot = work[j];
    if (!(pivot > 0.0) || isinf(pivot)) {
      memset(work, 0, (size_t)f->n * sizeof *work);
      return f->order[j];
    }
    work[j] = 0.0;
    r->diagonal[j] = pivot;
    f->inverse_diagonal[j] = 1.0 / pivot;
    for (int32_t i = f->start[j]; i < f->start[j + 1]; i++) {
      f->value[i] = work[f->row[i]] * f->inverse_diagonal[j];
      work[f->row[i]] = 0.0;
    }
    r->at[j] = f->start[j];
    wait_for_next(r, j);
  }
  return -1;
}

void strut_refactor_solve(strut_refactor *r, double *b) {
  const strut_factor *f = &r->factor;
  for (int32_t i = 0; i < f->n; i++) r->work[i] = b[f->order[i]];
  strut_factor_solve(f, r->work);
  for (int32_t i = 0; i < f->n; i++) b[f->order[i]] = r->work[i], r->work[i] = 0.0;
}
