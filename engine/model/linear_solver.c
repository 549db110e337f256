/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/linear_solver.h"

#include <cholmod.h>
#include <string.h>

#include "engine/base/memory.h"

static void start_cholmod(cholmod_common *common) {
  cholmod_start(common);
  common->supernodal = CHOLMOD_SIMPLICIAL;
  common->final_ll = 0;
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_AMD;
  common->postorder = 1;
  common->print = 0;
  common->error_handler = NULL;
}

/* A view of our matrix as CHOLMOD's; nothing is copied. */
static cholmod_sparse view(const strut_sparse *matrix) {
  cholmod_sparse result = {0};
  result.nrow = result.ncol = (size_t)matrix->n;
  result.nzmax = (size_t)matrix->start[matrix->n];
  result.p = matrix->start;
  result.i = matrix->row;
  result.x = matrix->value;
  result.stype = -1;
  result.itype = CHOLMOD_INT;
  result.xtype = CHOLMOD_REAL;
  result.dtype = CHOLMOD_DOUBLE;
  result.sorted = 1;
  result.packed = 1;
  return result;
}

static strut_factor *allocate_factor(int32_t n, size_t nonzeros) {
  strut_factor *factor = strut_allocate(1, sizeof *factor);
  if (!factor) return NULL;
  factor->n = n;
  factor->order = strut_allocate((size_t)n, sizeof *factor->order);
  factor->start = strut_allocate((size_t)n + 1, sizeof *factor->start);
  factor->row = strut_allocate(nonzeros, sizeof *factor->row);
  factor->value = strut_allocate(nonzeros, sizeof *factor->value);
  factor->inverse_diagonal = strut_allocate((size_t)n, sizeof *factor->inverse_diagonal);
  if (factor->order && factor->start && factor->row && factor->value && factor->inverse_diagonal)
    return factor;
  strut_factor_free(factor);
  return NULL;
}

/* CHOLMOD keeps D as the first entry of each column of L; we keep 1/D apart. */
static strut_factor *copy_out(const cholmod_factor *l) {
  const int *start = l->p, *row = l->i, *order = l->Perm;
  const double *value = l->x;
  int32_t n = (int32_t)l->n;
  strut_factor *factor = allocate_factor(n, (size_t)(start[n] - n));
  if (!factor) return NULL;
  memcpy(factor->order, order, (size_t)n * sizeof *factor->order);
  int32_t at = 0;
  for (int32_t j = 0; j < n; j++) {
    factor->start[j] = at;
    factor->inverse_diagonal[j] = 1.0 / value[start[j]];
    for (int32_t k = start[j] + 1; k < start[j + 1]; k++, at++) {
      factor->row[at] = row[k];
      factor->value[at] = value[k];
    }
  }
  factor->start[n] = at;
  return factor;
}

/*
 * The row of A at which it shows not to be positive definite, or -1. CHOLMOD's L D L' stops at a
 * zero in D only, so the signs are looked at here.
 */
static int32_t bad_row(const cholmod_factor *l) {
  const int *start = l->p, *order = l->Perm;
  const double *value = l->x;
  if (l->minor < l->n) return order[l->minor];
  for (size_t j = 0; j < l->n; j++)
    if (!(value[start[j]] > 0)) return order[j];
  return -1;
}

strut_status strut_factor_create(const strut_sparse *matrix, strut_factor **factor,
                                 strut_error *error) {
  cholmod_common common;
  start_cholmod(&common);
  cholmod_sparse a = view(matrix);
  cholmod_factor *l = cholmod_analyze(&a, &common);
  strut_status status = STRUT_OK;
  *factor = NULL;
  if (l && cholmod_factorize(&a, l, &common) && common.status >= CHOLMOD_OK &&
      cholmod_change_factor(CHOLMOD_REAL, 0, 0, 1, 1, l, &common)) {
    int32_t row = bad_row(l);
    if (row < 0)
      *factor = copy_out(l);
    else
      status = strut_fail(error, STRUT_SINGULAR,
                          "the matrix is not positive definite (row %d of %d)", row, matrix->n);
  }
  if (!*factor && status == STRUT_OK)
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory while factorising a matrix");
  cholmod_free_factor(&l, &common);
  cholmod_finish(&common);
  return status;
}

void strut_factor_free(strut_factor *factor) {
  if (!factor) return;
  strut_release(factor->order);
  strut_release(factor->start);
  strut_release(factor->row);
  strut_release(factor->value);
  strut_release(factor->inverse_diagonal);
  strut_release(factor);
}

void strut_factor_solve(const strut_factor *factor, double *restrict b) {
  const int32_t *start = factor->start, *row = factor->row;
  const double *value = factor->value;
  for (int32_t j = 0; j < factor->n; j++)
    for (int32_t k = start[j]; k < start[j + 1]; k++) b[row[k]] -= value[k] * b[j];
  for (int32_t j = factor->n - 1; j >= 0; j--) {
    double sum = b[j] * factor->inverse_diagonal[j];
    for (int32_t k = start[j]; k < start[j + 1]; k++) sum -= value[k] * b[row[k]];
    b[j] = sum;
  }
}

void strut_factor_solve_pair(const strut_factor *factor, double *restrict b) {
  const int32_t *start = factor->start, *row = factor->row;
  const double *value = factor->value;
  for (int32_t j = 0; j < factor->n; j++) {
    double x = b[2 * j], y = b[2 * j + 1];
    for (int32_t k = start[j]; k < start[j + 1]; k++) {
      b[2 * row[k]] -= value[k] * x;
      b[2 * row[k] + 1] -= value[k] * y;
    }
  }
  for (int32_t j = factor->n - 1; j >= 0; j--) {
    double x = b[2 * j] * factor->inverse_diagonal[j];
    double y = b[2 * j + 1] * factor->inverse_diagonal[j];
    for (int32_t k = start[j]; k < start[j + 1]; k++) {
      x -= value[k] * b[2 * row[k]];
      y -= value[k] * b[2 * row[k] + 1];
    }
    b[2 * j] = x;
    b[2 * j + 1] = y;
  }
}
