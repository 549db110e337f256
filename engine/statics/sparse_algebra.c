/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/algebra.h"

#include <SuiteSparseQR_C.h>
#include <arpack.h>
#include <assert.h>
#include <cholmod.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <string.h>

#include "engine/base/mixed_bits.h"

/* ---- one thread for the BLAS, whose sums have other bits with several ---- */

/* Found among the libraries that the others need, if the BLAS is OpenBLAS; else NULL. */
extern void openblas_set_num_threads(int count) __attribute__((weak));
extern int openblas_get_num_threads(void) __attribute__((weak));

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int inside, threads_before;

static void begin_single_thread(void) {
  if (!openblas_set_num_threads || !openblas_get_num_threads) return;
  pthread_mutex_lock(&lock);
  if (inside++ == 0) {
    threads_before = openblas_get_num_threads();
    openblas_set_num_threads(1);
  }
  pthread_mutex_unlock(&lock);
}

static void end_single_thread(void) {
  if (!openblas_set_num_threads || !openblas_get_num_threads) return;
  pthread_mutex_lock(&lock);
  assert(inside > 0);
  if (--inside == 0) openblas_set_num_threads(threads_before);
  pthread_mutex_unlock(&lock);
}

/* ---- rank-revealing QR, by SPQR ---- */

/* A column of the squeezed R is live where it reaches one row further down than those before it. */
typedef struct sparse_qr {
  cholmod_common common;
  cholmod_sparse *r, *h; /* H: reflections, one per column, in the order of permuted rows */
  cholmod_dense *tau;    /* of the reflections */
  int64_t *order;        /* (columns) column of A at position k in R; NULL: identity */
  int64_t *place;        /* (rows) where a row of A stands among the permuted ones */
  int32_t rows, columns, rank;
  int32_t *live; /* (rank) column of R with the diagonal of row k */
  int32_t *dead; /* (columns - rank) the others */
  double *work;  /* (rows) */
  strut_arena arena;
} sparse_qr;

static cholmod_sparse *copy_matrix(sparse_qr *qr, const strut_sparse_columns *columns) {
  size_t count = (size_t)columns->start[qr->columns];
  cholmod_sparse *matrix = cholmod_l_allocate_sparse(
      (size_t)qr->rows, (size_t)qr->columns, count ? count : 1, 1, 1, 0, CHOLMOD_REAL, &qr->common);
  if (!matrix) return NULL;
  int64_t *p = matrix->p, *i = matrix->i;
  for (int32_t j = 0; j <= qr->columns; j++) p[j] = columns->start[j];
  for (size_t k = 0; k < count; k++) i[k] = columns->row[k];
  memcpy(matrix->x, columns->value, count * sizeof *columns->value);
  return matrix;
}

/* Row of the last entry of a column of R, -1 where it is empty; rows need not be sorted. */
static int64_t last_entry(const cholmod_sparse *matrix, int32_t column, double *value) {
  const int64_t *p = matrix->p, *i = matrix->i;
  const double *x = matrix->x;
  int64_t last = -1;
  for (int64_t k = p[column]; k < p[column + 1]; k++)
    if (i[k] > last) last = i[k], *value = x[k];
  return last;
}

static void sort_columns(sparse_qr *qr) {
  int32_t live = 0, dead = 0;
  double value = 0.0;
  for (int32_t j = 0; j < qr->columns; j++) {
    bool step = live < qr->rank && last_entry(qr->r, j, &value) == live;
    if (step)
      qr->live[live++] = j;
    else if (dead < qr->columns - qr->rank)
      qr->dead[dead++] = j;
  }
}

static bool factorise(sparse_qr *qr, cholmod_sparse *matrix, double tolerance) {
  int64_t rank =
      SuiteSparseQR_C(SPQR_ORDERING_DEFAULT, tolerance, 0, 0, matrix, NULL, NULL, NULL, NULL,
                      &qr->r, &qr->order, &qr->h, &qr->place, &qr->tau, &qr->common);
  if (rank < 0 || !qr->r || !qr->h || !qr->tau) return false;
  qr->rank = (int32_t)rank;
  qr->live = strut_arena_allocate(&qr->arena, (size_t)rank, sizeof *qr->live);
  qr->dead = strut_arena_allocate(&qr->arena, (size_t)(qr->columns - rank), sizeof *qr->dead);
  qr->work = strut_arena_allocate(&qr->arena, (size_t)qr->rows, sizeof *qr->work);
  if (!qr->live || !qr->dead || !qr->work) {
    qr->common.status = CHOLMOD_OUT_OF_MEMORY;
    return false;
  }
  sort_columns(qr);
  return true;
}

static void free_qr(sparse_qr *qr) {
  cholmod_l_free_sparse(&qr->r, &qr->common);
  cholmod_l_free_sparse(&qr->h, &qr->common);
  cholmod_l_free_dense(&qr->tau, &qr->common);
  cholmod_l_free((size_t)qr->columns, sizeof *qr->order, qr->order, &qr->common);
  cholmod_l_free((size_t)qr->rows, sizeof *qr->place, qr->place, &qr->common);
  cholmod_l_finish(&qr->common);
  strut_arena_free(&qr->arena);
}

static void find_diagonal(const sparse_qr *qr, strut_sparse_null_spaces *spaces) {
  for (int32_t k = 0; k < qr->rank; k++) {
    double value = 0.0;
    last_entry(qr->r, qr->live[k], &value);
    value = fabs(value);
    if (k == 0 || value < spaces->smallest) spaces->smallest = value;
    spaces->largest = fmax(spaces->largest, value);
  }
}

/* Q e: the reflections in reverse, then the rows back to where A has them. */
static void find_left_null(const sparse_qr *qr, int32_t i, double *y) {
  assert(i >= 0 && i < qr->rows - qr->rank);
  const int64_t *p = qr->h->p, *at = qr->h->i;
  const double *h = qr->h->x, *tau = qr->tau->x;
  double *w = qr->work;
  memset(w, 0, (size_t)qr->rows * sizeof *w);
  w[qr->rank + i] = 1.0;
  for (int64_t j = (int64_t)qr->h->ncol - 1; j >= 0; j--) {
    double sum = 0.0;
    for (int64_t k = p[j]; k < p[j + 1]; k++) sum += h[k] * w[at[k]];
    sum *= tau[j];
    for (int64_t k = p[j]; k < p[j + 1]; k++) w[at[k]] -= sum * h[k];
  }
  for (int32_t k = 0; k < qr->rows; k++) y[k] = w[qr->place ? qr->place[k] : k];
}

/* Back substitution: R of the live columns times x is minus the dead column. */
static void find_null(const sparse_qr *qr, int32_t i, double *vector) {
  assert(i >= 0 && i < qr->columns - qr->rank);
  const int64_t *p = qr->r->p, *at = qr->r->i;
  const double *r = qr->r->x;
  double *w = qr->work;
  int32_t dead = qr->dead[i];
  memset(w, 0, (size_t)qr->rows * sizeof *w);
  memset(vector, 0, (size_t)qr->columns * sizeof *vector);
  for (int64_t k = p[dead]; k < p[dead + 1]; k++) w[at[k]] = -r[k];
  vector[qr->order ? qr->order[dead] : dead] = 1.0;
  for (int32_t k = qr->rank - 1; k >= 0; k--) {
    int32_t column = qr->live[k];
    double pivot = 1.0;
    last_entry(qr->r, column, &pivot);
    double value = w[k] / pivot;
    if (value == 0.0) continue;
    for (int64_t m = p[column]; m < p[column + 1]; m++)
      if (at[m] != k) w[at[m]] -= value * r[m];
    vector[qr->order ? qr->order[column] : column] = value;
  }
}

/* `count` vectors of `length` numbers each, unless they are too many; false: out of memory. */
static bool make_basis(const sparse_qr *qr, int32_t count, int32_t length,
                       void (*find)(const sparse_qr *qr, int32_t i, double *vector),
                       const strut_sparse_null_spaces *spaces, strut_arena *arena, double **basis) {
  if (!count || count > spaces->most_vectors || (int64_t)count * length > spaces->most_numbers)
    return true;
  *basis = strut_arena_allocate(arena, (size_t)count * (size_t)length, sizeof **basis);
  for (int32_t i = 0; i < count && *basis; i++) find(qr, i, *basis + (size_t)i * (size_t)length);
  return *basis;
}

static strut_status find_null_spaces(const strut_sparse_columns *columns, double tolerance,
                                     strut_arena *arena, strut_sparse_null_spaces *spaces,
                                     strut_error *error) {
  sparse_qr qr = {.rows = columns->rows, .columns = columns->columns};
  cholmod_l_start(&qr.common);
  qr.common.print = 0;
  qr.common.error_handler = NULL;
  qr.common.SPQR_nthreads = 1;
  cholmod_sparse *a = copy_matrix(&qr, columns);
  begin_single_thread();
  bool done = a && factorise(&qr, a, tolerance);
  end_single_thread();
  bool memory = qr.common.status == CHOLMOD_OUT_OF_MEMORY || qr.common.status == CHOLMOD_TOO_LARGE;
  cholmod_l_free_sparse(&a, &qr.common);
  if (done) {
    spaces->rank = qr.rank;
    find_diagonal(&qr, spaces);
    memory =
        !make_basis(&qr, qr.columns - qr.rank, qr.columns, find_null, spaces, arena,
                    &spaces->null) ||
        !make_basis(&qr, qr.rows - qr.rank, qr.rows, find_left_null, spaces, arena, &spaces->left);
  }
  free_qr(&qr);
  if (memory) return strut_no_memory(error, "");
  return done ? STRUT_OK
              : strut_fail(error, STRUT_SINGULAR, "the equilibrium matrix could not be factorised");
}

/* ---- lowest eigenpairs, by ARPACK ---- */

enum {
  INTERRUPTED = 1000, /* no code of ARPACK's */
  SHIFT_INVERT = 3,
  MOST_RESTARTS = 2000,
  LEAST_VECTORS = 40
};

/* Relative error of the vectors; that of the eigenvalues is its square. */
static const double GOOD = 1e-11;

static pthread_mutex_t arpack_lock = PTHREAD_MUTEX_INITIALIZER;

typedef struct search {
  int32_t n, wanted, vectors;
  double *residual, *basis, *work, *small, *value;
  a_int *select, parameter[11], pointer[14];
} search;

static bool allocate_search(search *self, strut_arena *arena) {
  size_t n = (size_t)self->n, p = (size_t)self->vectors;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(self->select, p)) ||
      !STRUT_NUMBERS(arena, n, &self->residual) || !STRUT_NUMBERS(arena, n * p, &self->basis) ||
      !STRUT_NUMBERS(arena, 3 * n, &self->work) ||
      !STRUT_NUMBERS(arena, p * (p + 8), &self->small) || !STRUT_NUMBERS(arena, p, &self->value))
    return false;
  for (int32_t i = 0; i < self->n; i++) self->residual[i] = strut_stirred((uint64_t)i);
  self->parameter[0] = 1; /* ARPACK chooses the shifts of its restarts */
  self->parameter[2] = MOST_RESTARTS;
  self->parameter[6] = SHIFT_INVERT;
  return true;
}

/* ARPACK asks for products until it is done; its pointers count from 1. */
static a_int iterate(const strut_lanczos_problem *problem, search *self) {
  a_int task = 0, info = 1; /* the residual is ours */
  a_int small = self->vectors * (self->vectors + 8);
  for (;;) {
    if (problem->interrupt && *problem->interrupt) return INTERRUPTED;
    dsaupd_c(&task, "G", self->n, "LM", self->wanted, GOOD, self->residual, self->vectors,
             self->basis, self->n, self->parameter, self->pointer, self->work, self->small, small,
             &info);
    double *x = self->work + self->pointer[0] - 1, *y = self->work + self->pointer[1] - 1;
    if (task == 2) {
      problem->mass(problem->context, x, y);
    } else if (task == -1) {
      problem->mass(problem->context, x, y);
      problem->solve(problem->context, y);
    } else if (task == 1) {
      memcpy(y, self->work + self->pointer[2] - 1, (size_t)self->n * sizeof *y);
      problem->solve(problem->context, y);
    } else {
      return info;
    }
  }
}

static a_int extract_pairs(const strut_lanczos_problem *problem, search *self) {
  a_int info = 0, small = self->vectors * (self->vectors + 8);
  dseupd_c(1, "A", self->select, self->value, self->basis, self->n, problem->shift, "G", self->n,
           "LM", self->wanted, GOOD, self->residual, self->vectors, self->basis, self->n,
           self->parameter, self->pointer, self->work, self->small, small, &info);
  return info;
}

static void copy_sorted(const search *self, double *value, double *vector) {
  for (int32_t i = 0; i < self->wanted; i++) {
    int32_t rank = 0;
    for (int32_t k = 0; k < self->wanted; k++)
      rank += self->value[k] < self->value[i] || (self->value[k] == self->value[i] && k < i);
    value[rank] = self->value[i];
    memcpy(vector + (size_t)rank * (size_t)self->n, self->basis + (size_t)i * (size_t)self->n,
           (size_t)self->n * sizeof *vector);
  }
}

static strut_status find_lowest(const strut_lanczos_problem *problem, int32_t count, double *value,
                                double *vector, strut_error *error) {
  assert(count > 0 && count < problem->n);
  strut_arena arena = {0};
  search s = {.n = problem->n, .wanted = count};
  s.vectors = 2 * count + 10 > LEAST_VECTORS ? 2 * count + 10 : LEAST_VECTORS;
  if (s.vectors > s.n) s.vectors = s.n;
  strut_status status = STRUT_OK;
  if (!allocate_search(&s, &arena)) {
    status = strut_no_memory(error, "");
  } else {
    pthread_mutex_lock(&arpack_lock);
    begin_single_thread();
    a_int info = iterate(problem, &s);
    if (info == 0) info = extract_pairs(problem, &s);
    end_single_thread();
    pthread_mutex_unlock(&arpack_lock);
    if (info == INTERRUPTED)
      status = strut_fail(error, STRUT_INTERRUPTED, "interrupted");
    else if (info != 0 || s.parameter[4] < count)
      status = strut_fail(error, STRUT_SINGULAR,
                          "Lanczos's method found %d of the %d lowest modes (ARPACK code %d)",
                          (int)s.parameter[4], (int)count, (int)info);
    else
      copy_sorted(&s, value, vector);
  }
  strut_arena_free(&arena);
  return status;
}

/* ---- the table ---- */

extern STRUT_API const strut_sparse_algebra_library strut_sparse_algebra_table;
const strut_sparse_algebra_library strut_sparse_algebra_table = {
    .stamp = STRUT_LIBRARY_STAMP(strut_sparse_algebra_library),
    .null_spaces = find_null_spaces,
    .lowest_eigenpairs = find_lowest,
};

strut_status strut_sparse_algebra_load(const strut_sparse_algebra_library **library,
                                       strut_error *error) {
  (void)error;
  *library = &strut_sparse_algebra_table;
  return STRUT_OK;
}
