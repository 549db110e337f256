/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra/linear_solver.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/mixed_bits.h"
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

/* The factor, with arrays in the arena. */
static strut_status fill_factor(const strut_sparse *matrix, strut_arena *arena,
                                strut_factor *factor, strut_error *error) {
  const strut_cholmod_library *cholmod = NULL;
  strut_status status = strut_cholmod_load(&cholmod, error);
  if (status) return status;
  double nonzeros = 0.0; /* counted by the analysis */
  strut_cholmod_columns l;
  int32_t row = -1;
  strut_cholmod_factor *analysed = cholmod->analyse(matrix, &nonzeros);
  if (!analysed)
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory while factorising a matrix");
  status = check_size(matrix->n, nonzeros, error);
  bool made = !status && cholmod->factorise(analysed, matrix, &l);
  if (made && (row = bad_row(&l)) >= 0)
    status = strut_fail(error, STRUT_SINGULAR, "the matrix is not positive definite (row %d of %d)",
                        row, matrix->n);
  else if (made && give_arrays(l.n, (size_t)(l.start[l.n] - l.n), arena, factor))
    copy_into(&l, factor);
  else if (!status)
    status = strut_no_memory(error, "for the factor of a matrix");
  cholmod->free(analysed);
  return status;
}

strut_status strut_factor_create(const strut_sparse *matrix, strut_factor **factor,
                                 strut_error *error) {
  strut_factor *own = *factor = strut_allocate(1, sizeof *own);
  if (!own) return strut_no_memory(error, "for the factor of a matrix");
  strut_status status = fill_factor(matrix, &own->arena, own, error);
  if (status == STRUT_OK) return status;
  strut_factor_free(own);
  *factor = NULL;
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
  strut_factor factor;
  /* the matrix's entries in the factor's order, column by column: row, and place among its values */
  int32_t *start, *row, *from; /* (n + 1), (nonzeros) each */
  double *diagonal, *work;     /* (n) D; (3 n) scratch, the first n 0 between calls */
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

/* The place of each entry of the matrix in the factor's order. */
static void place_entries(const strut_sparse *pattern, strut_ldl *ldl) {
  int32_t n = pattern->n, *place = ldl->next;
  for (int32_t i = 0; i < n; i++) place[ldl->factor.order[i]] = i;
  for (int32_t pass = 0; pass < 2; pass++) {
    for (int32_t j = 0; j < n; j++)
      for (int32_t k = pattern->start[j]; k < pattern->start[j + 1]; k++) {
        int32_t a = place[j], b = place[pattern->row[k]], column = a < b ? a : b;
        if (pass == 0) {
          ldl->start[column + 1]++;
          continue;
        }
        int32_t to = ldl->start[column] + ldl->at[column]++;
        ldl->row[to] = a < b ? b : a;
        ldl->from[to] = k;
      }
    for (int32_t j = 0; j < n && pass == 0; j++) ldl->start[j + 1] += ldl->start[j];
  }
}

strut_status strut_ldl_create(const strut_sparse *pattern, strut_arena *arena, strut_ldl **ldl,
                              strut_error *error) {
  strut_arena scratch = {0};
  strut_sparse example;
  size_t n = (size_t)pattern->n, nonzeros = (size_t)pattern->start[n];
  strut_ldl *own = *ldl = strut_arena_allocate(arena, 1, sizeof *own);
  bool good = own && fill_example(pattern, &example, &scratch);
  strut_status status =
      good ? fill_factor(&example, arena, &own->factor, error) : strut_no_memory(error, "");
  if (!status &&
      !STRUT_ALLOCATE(arena, STRUT_NEW(own->row, nonzeros), STRUT_NEW(own->from, nonzeros),
                      STRUT_NEW(own->head, n), STRUT_NEW(own->next, n), STRUT_NEW(own->at, n),
                      STRUT_NEW(own->start, n + 1), STRUT_NEW(own->diagonal, n),
                      STRUT_NEW(own->work, 3 * n)))
    status = strut_no_memory(error, "");
  strut_arena_free(&scratch);
  if (!status) place_entries(pattern, own);
  if (status) *ldl = NULL;
  return status;
}

/* Column k waits for the row of its entry at ldl->at[k], if there is one left. */
static void wait_for_next(strut_ldl *ldl, int32_t k) {
  if (ldl->at[k] == ldl->factor.start[k + 1]) return;
  int32_t row = ldl->factor.row[ldl->at[k]];
  ldl->next[k] = ldl->head[row];
  ldl->head[row] = k;
}

/* Notes the pivot of a row, which had `before` on its diagonal; false: it cannot be divided by. */
static bool note_pivot(double pivot, double before, int32_t row, strut_inertia *inertia) {
  double size = fabs(pivot), left = before != 0.0 ? size / fabs(before) : 1.0;
  if (!(size > 0) || !isfinite(size)) {
    *inertia = (strut_inertia){.row = row};
    return false;
  }
  inertia->negative += pivot < 0;
  if (left < inertia->smallest) inertia->smallest = left, inertia->row = row;
  inertia->least = fmin(inertia->least, size);
  inertia->largest = fmax(inertia->largest, size);
  return true;
}

/* Column by column, each taking what the ones before it leave (left-looking). */
strut_status strut_ldl_factorise(strut_ldl *ldl, const strut_sparse *matrix, double shift,
                                 strut_inertia *inertia) {
  const strut_factor *factor = &ldl->factor;
  double *restrict work = ldl->work;
  *inertia = (strut_inertia){.row = -1, .smallest = HUGE_VAL, .least = HUGE_VAL};
  for (int32_t j = 0; j < factor->n; j++) ldl->head[j] = -1;
  for (int32_t j = 0; j < factor->n; j++) {
    int32_t row = factor->order[j];
    for (int32_t i = ldl->start[j]; i < ldl->start[j + 1]; i++)
      work[ldl->row[i]] += matrix->value[ldl->from[i]];
    double before = work[j] += shift;
    for (int32_t k = ldl->head[j], following; k >= 0; k = following) {
      following = ldl->next[k];
      double part = factor->value[ldl->at[k]] * ldl->diagonal[k];
      for (int32_t i = ldl->at[k]; i < factor->start[k + 1]; i++)
        work[factor->row[i]] -= factor->value[i] * part;
      ldl->at[k]++;
      wait_for_next(ldl, k);
    }
    double pivot = work[j];
    if (!note_pivot(pivot, before, row, inertia)) {
      memset(work, 0, (size_t)factor->n * sizeof *work);
      return STRUT_SINGULAR;
    }
    work[j] = 0.0;
    ldl->diagonal[j] = pivot;
    factor->inverse_diagonal[j] = 1.0 / pivot;
    for (int32_t i = factor->start[j]; i < factor->start[j + 1]; i++) {
      factor->value[i] = work[factor->row[i]] * factor->inverse_diagonal[j];
      work[factor->row[i]] = 0.0;
    }
    ldl->at[j] = factor->start[j];
    wait_for_next(ldl, j);
  }
  return STRUT_OK;
}

void strut_ldl_solve(strut_ldl *ldl, double *b) {
  const strut_factor *factor = &ldl->factor;
  for (int32_t i = 0; i < factor->n; i++) ldl->work[i] = b[factor->order[i]];
  strut_factor_solve(factor, ldl->work);
  for (int32_t i = 0; i < factor->n; i++) b[factor->order[i]] = ldl->work[i], ldl->work[i] = 0.0;
}

/* The largest column sum of |A|. */
static double norm_of(const strut_sparse *matrix, double *sum) {
  double largest = 0.0;
  for (int32_t j = 0; j < matrix->n; j++) sum[j] = 0.0;
  for (int32_t j = 0; j < matrix->n; j++) {
    sum[j] += fabs(matrix->value[matrix->start[j]]);
    for (int32_t k = matrix->start[j] + 1; k < matrix->start[j + 1]; k++) {
      sum[j] += fabs(matrix->value[k]);
      sum[matrix->row[k]] += fabs(matrix->value[k]);
    }
  }
  for (int32_t j = 0; j < matrix->n; j++) largest = fmax(largest, sum[j]);
  return largest;
}

/* Hager's method: climbs to a column of A^-1 with a large sum; then Higham's second guess. */
double strut_ldl_rcond(strut_ldl *ldl, const strut_sparse *matrix) {
  int32_t n = matrix->n;
  double *x = ldl->work + n, *y = x + n, best = 0.0, other = 0.0, norm = norm_of(matrix, x);
  if (n == 0 || !(norm > 0)) return n == 0 ? 1.0 : 0.0;
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
  return 1.0 / (norm * fmax(best, 2.0 * other / (3.0 * n)));
}

/* Eigenvalues of the matrix + shift below zero; moves a shift that hits one a little. -1: it cannot be factorised. */
static int32_t count_below(strut_ldl *ldl, const strut_sparse *matrix, double *shift) {
  strut_inertia inertia = {0};
  for (int i = 0; i < 4; i++, *shift *= 1.001)
    if (strut_ldl_factorise(ldl, matrix, *shift, &inertia) == STRUT_OK) return inertia.negative;
  return -1;
}

/* Factorises the matrix with approximately the smallest shift that makes it positive definite. */
static bool find_definite_shift(strut_ldl *ldl, const strut_sparse *matrix, double low) {
  const double accuracy = 0.01;
  double high = low;
  int32_t count;
  do {
    low = high;
    high *= 16.0;
    count = count_below(ldl, matrix, &high);
  } while (count > 0 && isfinite(high));
  while (high - low > accuracy * high && count >= 0) {
    double middle = sqrt(low * high);
    count = count_below(ldl, matrix, &middle);
    *(count > 0 ? &low : &high) = middle;
  }
  return count >= 0 && count_below(ldl, matrix, &high) >= 0;
}

/* Scales x to length 1; false where it is zero or not finite. */
static bool normalise(double *vector, int32_t n) {
  double most = 0.0, sum = 0.0;
  for (int32_t i = 0; i < n; i++) most = fmax(most, fabs(vector[i]));
  if (!(most > 0.0) || !isfinite(most)) return false;
  for (int32_t i = 0; i < n; i++) vector[i] /= most, sum += vector[i] * vector[i];
  for (int32_t i = 0; i < n; i++) vector[i] /= sqrt(sum);
  return true;
}

double strut_ldl_lowest(strut_ldl *ldl, const strut_sparse *matrix, double least, double *vector,
                        double *work) {
  enum { ITERATIONS = 40 };
  int32_t n = matrix->n;
  double shift = least, value = 0.0;
  if (count_below(ldl, matrix, &shift) <= 0 || !find_definite_shift(ldl, matrix, least)) return 0.0;
  for (int32_t i = 0; i < n; i++) vector[i] = strut_stirred((uint64_t)i);
  for (int turn = 0; turn < ITERATIONS; turn++) {
    if (!normalise(vector, n)) return 0.0;
    strut_ldl_solve(ldl, vector);
  }
  if (!normalise(vector, n)) return 0.0;
  strut_sparse_multiply(matrix, vector, work);
  for (int32_t i = 0; i < n; i++) value += vector[i] * work[i];
  return value;
}
