/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra/linear_solver.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/model/algebra/cholmod_factor.h"
#include "engine/model/algebra/hot.h"

strut_status strut_linear_solver_load(strut_error *error) {
  const strut_cholmod_library *cholmod;
  return strut_cholmod_load(&cholmod, error);
}

static bool give_arrays(int32_t n, size_t nonzeros, strut_arena *arena, strut_factor *factor) {
  factor->n = n;
  return STRUT_ALLOCATE(arena, STRUT_NEW(factor->order, n), STRUT_NEW(factor->start, n + 1),
                        STRUT_NEW(factor->row, nonzeros), STRUT_NEW(factor->value, nonzeros),
                        STRUT_NEW(factor->inverse_diagonal, n));
}

static strut_factor *allocate_factor(int32_t n, size_t nonzeros) {
  strut_factor *factor = strut_allocate(1, sizeof *factor);
  if (!factor) return NULL;
  if (give_arrays(n, nonzeros, &factor->arena, factor)) return factor;
  strut_factor_free(factor);
  return NULL;
}

/* CHOLMOD keeps D as the first entry of each column of L; we keep 1/D apart. */
static void copy_into(const strut_cholmod_columns *columns, strut_factor *factor) {
  const int *start = columns->start, *row = columns->row, *order = columns->order;
  const double *value = columns->value;
  int32_t n = factor->n;
  assert(n == columns->n);
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
}

static strut_factor *copy_out(const strut_cholmod_columns *columns) {
  strut_factor *factor =
      allocate_factor(columns->n, (size_t)(columns->start[columns->n] - columns->n));
  if (factor) copy_into(columns, factor);
  return factor;
}

/* ---- factors ---- */

/*
 * The row of A at which it shows not to be positive definite, or -1. CHOLMOD's L D L' stops at a
 * zero in D only, so the signs are checked here.
 */
static int32_t bad_row(const strut_cholmod_columns *columns) {
  if (columns->finished < columns->n) return columns->order[columns->finished];
  for (int32_t j = 0; j < columns->n; j++)
    if (!(columns->value[columns->start[j]] > 0)) return columns->order[j];
  return -1;
}

/* Columns of the factor begin at 32-bit indices. */
static strut_status check_size(int32_t rows, double nonzeros, strut_error *error) {
  if (nonzeros <= (double)INT32_MAX) return STRUT_OK;
  return strut_fail(error, STRUT_NO_MEMORY,
                    "the factor of a matrix of %d rows would have %.3g nonzeros, more than can be "
                    "counted; lumped masses need none",
                    (int)rows, nonzeros);
}

strut_status strut_factor_create(const strut_sparse *matrix, strut_factor **factor,
                                 strut_error *error) {
  *factor = NULL;
  const strut_cholmod_library *cholmod = NULL;
  strut_status status = strut_cholmod_load(&cholmod, error);
  if (status) return status;
  double nonzeros = 0.0; /* counted by the analysis */
  strut_cholmod_columns l;
  strut_cholmod_factor *analysed = cholmod->analyse(matrix, &nonzeros);
  if (!analysed)
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory while factorising a matrix");
  status = check_size(matrix->n, nonzeros, error);
  if (!status && cholmod->factorise(analysed, matrix, 0.0, &l)) {
    int32_t row = bad_row(&l);
    if (row < 0) *factor = copy_out(&l);
    if (row >= 0)
      status = strut_fail(error, STRUT_SINGULAR,
                          "the matrix is not positive definite (row %d of %d)", row, matrix->n);
  }
  if (!*factor && !status) status = strut_no_memory(error, "for the factor of a matrix");
  cholmod->free(analysed);
  return status;
}

void strut_factor_free(strut_factor *factor) {
  if (!factor) return;
  strut_arena_free(&factor->arena);
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
  const int32_t *restrict start = factor->start, *restrict row = factor->row;
  const double *restrict value = factor->value, *restrict inverse = factor->inverse_diagonal;
  int32_t n = factor->n;
  for (int32_t j = 0; j < n; j++) {
    strut_pair x = strut_pair_load(b + 2 * j);
    for (int32_t k = start[j]; k < start[j + 1]; k++)
      strut_pair_store(b + 2 * row[k], strut_pair_load(b + 2 * row[k]) - value[k] * x);
  }
  for (int32_t j = n - 1; j >= 0; j--) {
    strut_pair x = strut_pair_load(b + 2 * j) * inverse[j];
    for (int32_t k = start[j]; k < start[j + 1]; k++)
      x -= value[k] * strut_pair_load(b + 2 * row[k]);
    strut_pair_store(b + 2 * j, x);
  }
}

struct strut_ldl {
  const strut_cholmod_library *cholmod;
  strut_cholmod_factor *analysed;
  strut_factor *factor; /* of what was factorised last; NULL before */
  double *work;         /* (3 n) */
  double norm;          /* |A + shift I|_1 of it */
};

strut_status strut_ldl_create(const strut_sparse *pattern, strut_ldl **ldl, strut_error *error) {
  *ldl = NULL;
  const strut_cholmod_library *cholmod = NULL;
  strut_status status = strut_cholmod_load(&cholmod, error);
  if (status) return status;
  strut_ldl *l = *ldl = strut_allocate(1, sizeof *l);
  if (!l) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  double nonzeros = 0.0;
  l->cholmod = cholmod;
  l->analysed = cholmod->analyse(pattern, &nonzeros);
  l->work = strut_allocate(3 * (size_t)pattern->n, sizeof *l->work);
  status = l->analysed && l->work
               ? check_size(pattern->n, nonzeros, error)
               : strut_fail(error, STRUT_NO_MEMORY, "out of memory while analysing a matrix");
  if (status == STRUT_OK) return status;
  strut_ldl_free(l);
  *ldl = NULL;
  return status;
}

void strut_ldl_free(strut_ldl *ldl) {
  if (!ldl) return;
  ldl->cholmod->free(ldl->analysed);
  strut_factor_free(ldl->factor);
  strut_release(ldl->work);
  strut_release(ldl);
}

/* The largest column sum of |A + shift I|. */
static double norm_of(const strut_sparse *matrix, double shift, double *sum) {
  double largest = 0.0;
  for (int32_t j = 0; j < matrix->n; j++) sum[j] = 0.0;
  for (int32_t j = 0; j < matrix->n; j++) {
    sum[j] += fabs(matrix->value[matrix->start[j]] + shift);
    for (int32_t k = matrix->start[j] + 1; k < matrix->start[j + 1]; k++) {
      sum[j] += fabs(matrix->value[k]);
      sum[matrix->row[k]] += fabs(matrix->value[k]);
    }
  }
  for (int32_t j = 0; j < matrix->n; j++) largest = fmax(largest, sum[j]);
  return largest;
}

/* False where a pivot cannot be divided by. */
static bool read_inertia(const strut_cholmod_columns *columns, const strut_sparse *matrix,
                         double shift, strut_inertia *inertia) {
  *inertia = (strut_inertia){.row = -1, .smallest = HUGE_VAL, .least = HUGE_VAL};
  if (columns->finished < columns->n) {
    inertia->row = columns->order[columns->finished];
    inertia->smallest = inertia->least = 0.0;
    return false;
  }
  for (int32_t j = 0; j < columns->n; j++) {
    int32_t row = columns->order[j];
    double d = columns->value[columns->start[j]], size = fabs(d);
    double before = fabs(matrix->value[matrix->start[row]] + shift);
    double left = before > 0 ? size / before : 1.0;
    if (!(size > 0) || !isfinite(size)) {
      *inertia = (strut_inertia){.row = row};
      return false;
    }
    if (d < 0) inertia->negative++;
    if (left < inertia->smallest) inertia->smallest = left, inertia->row = row;
    inertia->least = fmin(inertia->least, size);
    inertia->largest = fmax(inertia->largest, size);
  }
  return true;
}

strut_status strut_ldl_factorise(strut_ldl *ldl, const strut_sparse *matrix, double shift,
                                 strut_inertia *inertia) {
  strut_cholmod_columns l;
  strut_status status = STRUT_NO_MEMORY;
  *inertia = (strut_inertia){.row = -1};
  ldl->norm = norm_of(matrix, shift, ldl->work);
  if (ldl->cholmod->factorise(ldl->analysed, matrix, shift, &l)) {
    bool good = read_inertia(&l, matrix, shift, inertia);
    if (!ldl->factor) ldl->factor = allocate_factor(matrix->n, (size_t)(l.start[l.n] - matrix->n));
    if (ldl->factor && good) copy_into(&l, ldl->factor);
    if (ldl->factor) status = good ? STRUT_OK : STRUT_SINGULAR;
  }
  ldl->cholmod->forget(ldl->analysed);
  return status;
}

void strut_ldl_solve(strut_ldl *ldl, double *b) {
  const strut_factor *factor = ldl->factor;
  double *x = ldl->work;
  for (int32_t i = 0; i < factor->n; i++) x[i] = b[factor->order[i]];
  strut_factor_solve(factor, x);
  for (int32_t i = 0; i < factor->n; i++) b[factor->order[i]] = x[i];
}

/* Hager's method: climbs to a column of A^-1 with a large sum; then Higham's second guess. */
double strut_ldl_rcond(strut_ldl *ldl) {
  int32_t n = ldl->factor->n;
  double *x = ldl->work + n, *y = ldl->work + 2 * (size_t)n, best = 0.0, other = 0.0;
  if (n == 0 || !(ldl->norm > 0)) return n == 0 ? 1.0 : 0.0;
  for (int32_t i = 0; i < n; i++) x[i] = 1.0 / n;
  for (int turn = 0; turn < 5; turn++) {
    double sum = 0.0;
    int32_t at = 0;
    strut_ldl_solve(ldl, x);
    for (int32_t i = 0; i < n; i++) sum += fabs(x[i]);
    if (turn > 0 && !(sum > best)) break;
    best = sum;
    for (int32_t i = 0; i < n; i++) y[i] = x[i] < 0 ? -1.0 : 1.0;
    strut_ldl_solve(ldl, y);
    for (int32_t i = 0; i < n; i++)
      if (fabs(y[i]) > fabs(y[at])) at = i;
    for (int32_t i = 0; i < n; i++) x[i] = i == at ? 1.0 : 0.0;
  }
  for (int32_t i = 0; i < n; i++)
    x[i] = (i % 2 ? -1.0 : 1.0) * (1.0 + (n > 1 ? (double)i / (n - 1) : 0.0));
  strut_ldl_solve(ldl, x);
  for (int32_t i = 0; i < n; i++) other += fabs(x[i]);
  return 1.0 / (ldl->norm * fmax(best, 2.0 * other / (3.0 * n)));
}

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
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(example->value, (size_t)pattern->start[pattern->n])))
    return false;
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
  if (!give_arrays(from->n, nonzeros, arena, to)) return false;
  memcpy(to->order, from->order, n * sizeof *to->order);
  memcpy(to->start, from->start, (n + 1) * sizeof *to->start);
  memcpy(to->row, from->row, nonzeros * sizeof *to->row);
  return true;
}

/* The place of each entry of the matrix in the factor's order. */
static void place_entries(const strut_sparse *pattern, strut_refactor *refactor) {
  int32_t n = pattern->n, *place = refactor->next;
  for (int32_t i = 0; i < n; i++) place[refactor->factor.order[i]] = i;
  for (int32_t pass = 0; pass < 2; pass++) {
    for (int32_t j = 0; j < n; j++)
      for (int32_t k = pattern->start[j]; k < pattern->start[j + 1]; k++) {
        int32_t a = place[j], b = place[pattern->row[k]], column = a < b ? a : b;
        if (pass == 0) {
          refactor->start[column + 1]++;
          continue;
        }
        int32_t to = refactor->start[column] + refactor->at[column]++;
        refactor->row[to] = a < b ? b : a;
        refactor->from[to] = k;
      }
    for (int32_t j = 0; j < n && pass == 0; j++) refactor->start[j + 1] += refactor->start[j];
  }
}

strut_refactor *strut_refactor_create(const strut_sparse *pattern, strut_arena *arena) {
  strut_refactor *refactor = strut_arena_allocate(arena, 1, sizeof *refactor);
  strut_arena scratch = {0};
  strut_sparse example;
  strut_factor *factor = NULL;
  size_t n = (size_t)pattern->n, nonzeros = (size_t)pattern->start[n];
  bool good = refactor && fill_example(pattern, &example, &scratch) &&
              !strut_factor_create(&example, &factor, NULL) &&
              copy_factor(factor, &refactor->factor, arena);
  strut_factor_free(factor);
  strut_arena_free(&scratch);
  if (!good) return NULL;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(refactor->row, nonzeros),
                      STRUT_NEW(refactor->from, nonzeros), STRUT_NEW(refactor->head, n),
                      STRUT_NEW(refactor->next, n), STRUT_NEW(refactor->at, n),
                      STRUT_NEW(refactor->start, n + 1), STRUT_NEW(refactor->diagonal, n),
                      STRUT_NEW(refactor->work, n)))
    return NULL;
  place_entries(pattern, refactor);
  return refactor;
}

/* Column k waits for the row of its entry at r->at[k], if there is one left. */
static void wait_for_next(strut_refactor *refactor, int32_t k) {
  if (refactor->at[k] == refactor->factor.start[k + 1]) return;
  int32_t row = refactor->factor.row[refactor->at[k]];
  refactor->next[k] = refactor->head[row];
  refactor->head[row] = k;
}

/* Column by column, each taking what the ones before it leave (left-looking). */
int32_t strut_refactor_apply(strut_refactor *refactor, const strut_sparse *matrix) {
  const strut_factor *factor = &refactor->factor;
  double *restrict work = refactor->work;
  for (int32_t j = 0; j < factor->n; j++) refactor->head[j] = -1;
  for (int32_t j = 0; j < factor->n; j++) {
    for (int32_t i = refactor->start[j]; i < refactor->start[j + 1]; i++)
      work[refactor->row[i]] += matrix->value[refactor->from[i]];
    for (int32_t k = refactor->head[j], following; k >= 0; k = following) {
      following = refactor->next[k];
      double part = factor->value[refactor->at[k]] * refactor->diagonal[k];
      for (int32_t i = refactor->at[k]; i < factor->start[k + 1]; i++)
        work[factor->row[i]] -= factor->value[i] * part;
      refactor->at[k]++;
      wait_for_next(refactor, k);
    }
    double pivot = work[j];
    if (!(pivot > 0.0) || isinf(pivot)) {
      memset(work, 0, (size_t)factor->n * sizeof *work);
      return factor->order[j];
    }
    work[j] = 0.0;
    refactor->diagonal[j] = pivot;
    factor->inverse_diagonal[j] = 1.0 / pivot;
    for (int32_t i = factor->start[j]; i < factor->start[j + 1]; i++) {
      factor->value[i] = work[factor->row[i]] * factor->inverse_diagonal[j];
      work[factor->row[i]] = 0.0;
    }
    refactor->at[j] = factor->start[j];
    wait_for_next(refactor, j);
  }
  return -1;
}

void strut_refactor_solve(strut_refactor *refactor, double *b) {
  const strut_factor *factor = &refactor->factor;
  for (int32_t i = 0; i < factor->n; i++) refactor->work[i] = b[factor->order[i]];
  strut_factor_solve(factor, refactor->work);
  for (int32_t i = 0; i < factor->n; i++)
    b[factor->order[i]] = refactor->work[i], refactor->work[i] = 0.0;
}
