/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/null_spaces.h"

#include <assert.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "engine/statics/rigidity/null_space_methods.h"
#include "engine/statics/sparse_algebra.h"

/* Bases with more vectors, or more numbers, than these are for nobody to read. */
enum { MOST_VECTORS = 200, MOST_NUMBERS = 4000000 };

/* T = U S V' of the tall one of A and A'. */
typedef struct tall {
  size_t rows, columns;
  bool turned; /* T = A' */
  double *u, *v, *s, *work;
} tall;

static bool allocate_tall(const strut_equilibrium_matrix *a, strut_arena *arena, tall *t) {
  t->turned = a->columns > a->rows;
  t->rows = (size_t)(t->turned ? a->columns : a->rows);
  t->columns = (size_t)(t->turned ? a->rows : a->columns);
  t->u = strut_arena_allocate(arena, t->rows * t->columns + 1, sizeof(double));
  t->v = strut_arena_allocate(arena, t->columns * t->columns + 1, sizeof(double));
  t->s = strut_arena_allocate(arena, t->columns + 1, sizeof(double));
  t->work = strut_arena_allocate(arena, t->columns + 1, sizeof(double));
  return t->u && t->v && t->s && t->work;
}

static void fill_tall(const strut_equilibrium_matrix *a, tall *t) {
  for (int32_t j = 0; j < a->columns; j++)
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++) {
      size_t row = (size_t)(t->turned ? j : a->row[k]);
      size_t column = (size_t)(t->turned ? a->row[k] : j);
      t->u[row * t->columns + column] = a->value[k];
    }
}

/* Not by GSL's one-sided Jacobi: it stops early where several values are zero. */
static int decompose(tall *t) {
  gsl_matrix_view u = gsl_matrix_view_array(t->u, t->rows, t->columns);
  gsl_matrix_view v = gsl_matrix_view_array(t->v, t->columns, t->columns);
  gsl_vector_view s = gsl_vector_view_array(t->s, t->columns);
  gsl_vector_view work = gsl_vector_view_array(t->work, t->columns);
  return gsl_linalg_SV_decomp(&u.matrix, &v.matrix, &s.vector, &work.vector);
}

static void decide_rank(const tall *t, strut_null_spaces *spaces) {
  int32_t rank = 0, count = (int32_t)t->columns;
  spaces->largest = t->s[0];
  while (rank < count && t->s[rank] > STRUT_RANK_TOLERANCE * t->s[0]) rank++;
  spaces->rank = rank;
  spaces->kept = rank > 0 ? t->s[rank - 1] : 0.0;
  spaces->dropped = rank < count ? t->s[rank] : 0.0;
  for (int32_t i = 0; i < rank; i++) spaces->weak += t->s[i] < STRUT_WEAK * t->s[0];
}

/* The right singular vectors of the values dropped, row by row. */
static double *right_null(const tall *t, size_t rank, strut_arena *arena) {
  size_t n = t->columns, count = n - rank;
  double *basis = strut_arena_allocate(arena, count * n + 1, sizeof *basis);
  for (size_t i = 0; basis && i < count; i++)
    for (size_t k = 0; k < n; k++) basis[i * n + k] = t->v[k * n + rank + i];
  return basis;
}

/* Basis orthogonal to the left singular vectors kept: the last columns of the Q of their QR. */
static double *left_null(const tall *t, size_t rank, strut_arena *scratch, strut_arena *arena) {
  size_t m = t->rows, count = m - rank;
  double *basis = strut_arena_allocate(arena, count * m + 1, sizeof *basis);
  double *qr = strut_arena_allocate(scratch, m * rank + 1, sizeof *qr);
  double *tau = strut_arena_allocate(scratch, rank + 1, sizeof *tau);
  double *unit = strut_arena_allocate(scratch, m, sizeof *unit);
  if (!basis || !qr || !tau || !unit) return NULL;
  for (size_t i = 0; i < m; i++)
    for (size_t k = 0; k < rank; k++) qr[i * rank + k] = t->u[i * t->columns + k];
  if (rank > 0) {
    gsl_matrix_view view = gsl_matrix_view_array(qr, m, rank);
    gsl_vector_view scale = gsl_vector_view_array(tau, rank);
    if (gsl_linalg_QR_decomp(&view.matrix, &scale.vector) != 0) return NULL;
  }
  for (size_t i = 0; i < count; i++) {
    memset(unit, 0, m * sizeof *unit);
    unit[rank + i] = 1.0;
    gsl_vector_view e = gsl_vector_view_array(unit, m);
    if (rank > 0) {
      gsl_matrix_view view = gsl_matrix_view_array(qr, m, rank);
      gsl_vector_view scale = gsl_vector_view_array(tau, rank);
      gsl_linalg_QR_Qvec(&view.matrix, &scale.vector, &e.vector);
    }
    memcpy(basis + i * m, unit, m * sizeof *unit);
  }
  return basis;
}

/* Without rows or columns: rank 0, and unit vectors. */
static strut_status trivial(const strut_equilibrium_matrix *a, strut_arena *arena,
                            strut_null_spaces *spaces, strut_error *error) {
  size_t n = (size_t)(a->columns + a->rows);
  spaces->states = a->columns, spaces->motions = a->rows;
  if (n > MOST_VECTORS) return STRUT_OK;
  double *basis = strut_arena_allocate(arena, n * n + 1, sizeof *basis);
  if (!basis) return strut_no_memory(error, "");
  for (size_t i = 0; i < n; i++) basis[i * n + i] = 1.0;
  spaces->state = a->columns ? basis : NULL;
  spaces->motion = a->rows ? basis : NULL;
  return STRUT_OK;
}

strut_status strut_null_spaces_dense(const strut_equilibrium_matrix *a, strut_arena *arena,
                                     strut_null_spaces *spaces, strut_error *error) {
  *spaces = (strut_null_spaces){.dense = true};
  if (a->rows == 0 || a->columns == 0) return trivial(a, arena, spaces, error);
  strut_arena scratch = {0};
  strut_status status = STRUT_OK;
  tall t = {0};
  if (!allocate_tall(a, &scratch, &t)) {
    status = strut_no_memory(error, "");
  } else {
    fill_tall(a, &t);
    if (decompose(&t) != 0)
      status = strut_fail(error, STRUT_SINGULAR,
                          "the singular values of the equilibrium matrix did not converge");
  }
  if (status == STRUT_OK) {
    decide_rank(&t, spaces);
    size_t rank = (size_t)spaces->rank;
    double *right = right_null(&t, rank, arena), *left = left_null(&t, rank, &scratch, arena);
    spaces->states = a->columns - spaces->rank, spaces->motions = a->rows - spaces->rank;
    spaces->state = t.turned ? left : right, spaces->motion = t.turned ? right : left;
    if (!right || !left) status = strut_no_memory(error, "");
  }
  strut_arena_free(&scratch);
  return status;
}

static bool few(int32_t count, int32_t length) {
  return count > 0 && count <= MOST_VECTORS && (int64_t)count * length <= MOST_NUMBERS;
}

strut_status strut_null_spaces_sparse(const strut_equilibrium_matrix *a, strut_arena *arena,
                                      strut_null_spaces *spaces, strut_error *error) {
  *spaces = (strut_null_spaces){.dropped = (double)NAN};
  if (a->rows == 0 || a->columns == 0) return trivial(a, arena, spaces, error);
  strut_sparse_qr *qr = NULL;
  const strut_sparse_algebra_library *sparse = NULL;
  strut_status status = strut_sparse_algebra_load(&sparse, error);
  if (status != STRUT_OK) return status;
  status = sparse->create_qr(a->rows, a->columns, a->start, a->row, a->value,
                             STRUT_RANK_TOLERANCE * sqrt(2.0), &qr, error);
  if (status != STRUT_OK) return status;
  size_t rows = (size_t)a->rows, columns = (size_t)a->columns;
  spaces->rank = sparse->rank(qr);
  sparse->diagonal(qr, &spaces->kept, &spaces->largest);
  spaces->states = a->columns - spaces->rank, spaces->motions = a->rows - spaces->rank;
  if (few(spaces->states, a->columns)) {
    spaces->state = strut_arena_allocate(arena, (size_t)spaces->states * columns, sizeof(double));
    if (!spaces->state) status = strut_no_memory(error, "");
  }
  if (few(spaces->motions, a->rows)) {
    spaces->motion = strut_arena_allocate(arena, (size_t)spaces->motions * rows, sizeof(double));
    if (!spaces->motion) status = strut_no_memory(error, "");
  }
  for (int32_t i = 0; i < spaces->states && spaces->state; i++)
    sparse->null(qr, i, spaces->state + (size_t)i * columns);
  for (int32_t i = 0; i < spaces->motions && spaces->motion; i++)
    sparse->left_null(qr, i, spaces->motion + (size_t)i * rows);
  sparse->free_qr(qr);
  return status;
}

strut_status strut_null_spaces_find(const strut_equilibrium_matrix *a, strut_arena *arena,
                                    strut_null_spaces *spaces, strut_error *error) {
  assert(a->rows >= 0 && a->columns >= 0);
  int32_t most = a->rows > a->columns ? a->rows : a->columns;
  return most <= STRUT_DENSE_RIGIDITY ? strut_null_spaces_dense(a, arena, spaces, error)
                                      : strut_null_spaces_sparse(a, arena, spaces, error);
}
