/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/sparse_qr.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "engine/model/algebra_calls.h"

/* A column of the squeezed R is live where it reaches one row further down than those before it. */
struct strut_sparse_qr {
  cholmod_common common;
  cholmod_sparse *r, *h; /* H: reflections, one per column, in the order of permuted rows */
  cholmod_dense *tau;    /* of the reflections */
  int64_t *order;        /* (columns) column of A at position k in R; NULL: identity */
  int64_t *place;        /* (rows) where a row of A stands among the permuted ones */
  int32_t rows, columns, rank;
  int32_t *live; /* (rank) column of R with the diagonal of row k */
  int32_t *dead; /* (columns - rank) the others */
  double *work;  /* (rows) */
};

static cholmod_sparse *copy_matrix(strut_sparse_qr *qr, const int32_t *start, const int32_t *row,
                                   const double *value) {
  size_t count = (size_t)start[qr->columns];
  cholmod_sparse *a = cholmod_l_allocate_sparse(
      (size_t)qr->rows, (size_t)qr->columns, count ? count : 1, 1, 1, 0, CHOLMOD_REAL, &qr->common);
  if (!a) return NULL;
  int64_t *p = a->p, *i = a->i;
  for (int32_t j = 0; j <= qr->columns; j++) p[j] = start[j];
  for (size_t k = 0; k < count; k++) i[k] = row[k];
  memcpy(a->x, value, count * sizeof *value);
  return a;
}

/* Row of the last entry of a column of R, -1 where it is empty; rows need not be sorted. */
static int64_t last_entry(const cholmod_sparse *r, int32_t column, double *value) {
  const int64_t *p = r->p, *i = r->i;
  const double *x = r->x;
  int64_t last = -1;
  for (int64_t k = p[column]; k < p[column + 1]; k++)
    if (i[k] > last) last = i[k], *value = x[k];
  return last;
}

static void tell_columns(strut_sparse_qr *qr) {
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

static bool factorise(strut_sparse_qr *qr, cholmod_sparse *a, double tolerance) {
  int64_t rank = SuiteSparseQR_C(SPQR_ORDERING_DEFAULT, tolerance, 0, 0, a, NULL, NULL, NULL, NULL,
                                 &qr->r, &qr->order, &qr->h, &qr->place, &qr->tau, &qr->common);
  if (rank < 0 || !qr->r || !qr->h || !qr->tau) return false;
  qr->rank = (int32_t)rank;
  qr->live = strut_allocate((size_t)rank + 1, sizeof *qr->live);
  qr->dead = strut_allocate((size_t)(qr->columns - rank) + 1, sizeof *qr->dead);
  qr->work = strut_allocate((size_t)qr->rows + 1, sizeof *qr->work);
  if (!qr->live || !qr->dead || !qr->work) {
    qr->common.status = CHOLMOD_OUT_OF_MEMORY;
    return false;
  }
  tell_columns(qr);
  return true;
}

strut_status strut_sparse_qr_create(int32_t rows, int32_t columns, const int32_t *start,
                                    const int32_t *row, const double *value, double tolerance,
                                    strut_sparse_qr **result, strut_error *error) {
  *result = NULL;
  strut_status status = strut_algebra_load(error);
  if (status) return status;
  strut_sparse_qr *qr = *result = strut_allocate(1, sizeof *qr);
  if (!qr) return strut_no_memory(error, "");
  cholmod_l_start(&qr->common);
  qr->common.print = 0;
  qr->common.error_handler = NULL;
  qr->common.SPQR_nthreads = 1;
  qr->rows = rows, qr->columns = columns;
  cholmod_sparse *a = copy_matrix(qr, start, row, value);
  strut_algebra_begin();
  bool done = a && factorise(qr, a, tolerance);
  strut_algebra_end();
  bool memory =
      qr->common.status == CHOLMOD_OUT_OF_MEMORY || qr->common.status == CHOLMOD_TOO_LARGE;
  cholmod_l_free_sparse(&a, &qr->common);
  if (done) return STRUT_OK;
  strut_sparse_qr_free(qr);
  *result = NULL;
  if (memory) return strut_no_memory(error, "");
  return strut_fail(error, STRUT_SINGULAR, "the equilibrium matrix could not be factorised");
}

void strut_sparse_qr_free(strut_sparse_qr *qr) {
  if (!qr) return;
  cholmod_l_free_sparse(&qr->r, &qr->common);
  cholmod_l_free_sparse(&qr->h, &qr->common);
  cholmod_l_free_dense(&qr->tau, &qr->common);
  cholmod_l_free((size_t)qr->columns, sizeof *qr->order, qr->order, &qr->common);
  cholmod_l_free((size_t)qr->rows, sizeof *qr->place, qr->place, &qr->common);
  cholmod_l_finish(&qr->common);
  strut_release(qr->live);
  strut_release(qr->dead);
  strut_release(qr->work);
  strut_release(qr);
}

int32_t strut_sparse_qr_rank(const strut_sparse_qr *qr) { return qr->rank; }

void strut_sparse_qr_diagonal(const strut_sparse_qr *qr, double *smallest, double *largest) {
  *smallest = *largest = 0.0;
  for (int32_t k = 0; k < qr->rank; k++) {
    double value = 0.0;
    last_entry(qr->r, qr->live[k], &value);
    value = fabs(value);
    if (k == 0 || value < *smallest) *smallest = value;
    if (value > *largest) *largest = value;
  }
}

/* Q e: the reflections in reverse, then the rows back to where A has them. */
void strut_sparse_qr_left_null(const strut_sparse_qr *qr, int32_t i, double *y) {
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
void strut_sparse_qr_null(const strut_sparse_qr *qr, int32_t i, double *x) {
  const int64_t *p = qr->r->p, *at = qr->r->i;
  const double *r = qr->r->x;
  double *w = qr->work;
  int32_t dead = qr->dead[i];
  memset(w, 0, (size_t)qr->rows * sizeof *w);
  memset(x, 0, (size_t)qr->columns * sizeof *x);
  for (int64_t k = p[dead]; k < p[dead + 1]; k++) w[at[k]] = -r[k];
  x[qr->order ? qr->order[dead] : dead] = 1.0;
  for (int32_t k = qr->rank - 1; k >= 0; k--) {
    int32_t column = qr->live[k];
    double pivot = 1.0;
    last_entry(qr->r, column, &pivot);
    double value = w[k] / pivot;
    if (value == 0.0) continue;
    for (int64_t m = p[column]; m < p[column + 1]; m++)
      if (at[m] != k) w[at[m]] -= value * r[m];
    x[qr->order ? qr->order[column] : column] = value;
  }
}
