/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sparse symmetric matrices, their products and their factors, against dense ones. */
#include "engine/model/algebra/linear_solver.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

FREED_BY(strut_factor_free, strut_factor)

enum { N = 60 };

/* The same contributions, many on one place, summed in a full matrix. */
static strut_sparse *random_matrix(uint64_t *r, int32_t n, size_t count, double *dense,
                                   strut_arena *arena) {
  strut_triplets triplets = {0};
  assert_true(strut_triplets_reserve(&triplets, count + (size_t)n, arena));
  memset(dense, 0, (size_t)(n * n) * sizeof *dense);
  for (size_t k = 0; k < count; k++) {
    int32_t i = random_below(r, n), j = random_below(r, n);
    double value = random_between(r, -1, 1);
    strut_triplets_add(&triplets, i, j, value);
    dense[i * n + j] += value;
    if (i != j) dense[j * n + i] += value;
  }
  return strut_sparse_build(n, &triplets, arena);
}

TEST(contributions_are_summed_and_sorted) {
  uint64_t r = 3;
  static double dense[N * N];
  for (int turn = 0; turn < 50; turn++) {
    OWN(strut_arena) arena = {0};
    int32_t n = 1 + random_below(&r, N);
    strut_sparse *m = random_matrix(&r, n, (size_t)random_below(&r, 600), dense, &arena);
    assert_non_null(m);
    assert_all_equal(m->n, n, m->start[0], 0);
    for (int32_t j = 0; j < n; j++) {
      assert_int_equal(m->row[m->start[j]], j); /* the diagonal first, if only as zero */
      for (int32_t k = m->start[j]; k < m->start[j + 1]; k++) {
        if (k > m->start[j]) assert_true(m->row[k] > m->row[k - 1]);
        assert_near(m->value[k], dense[m->row[k] * n + j], 1e-14);
        dense[m->row[k] * n + j] = dense[j * n + m->row[k]] = 0;
      }
    }
    for (int32_t i = 0; i < n * n; i++) assert_true(dense[i] == 0); /* nothing was lost */
  }
}

TEST(product) {
  uint64_t r = 4;
  static double dense[N * N];
  double x[N], y[N];
  for (int turn = 0; turn < 50; turn++) {
    OWN(strut_arena) arena = {0};
    strut_sparse *m = random_matrix(&r, N, 300, dense, &arena);
    for (int i = 0; i < N; i++) x[i] = random_between(&r, -1, 1);
    strut_sparse_multiply(m, x, y);
    for (int i = 0; i < N; i++) {
      double expected = 0;
      for (int j = 0; j < N; j++) expected += dense[i * N + j] * x[j];
      assert_near(y[i], expected, 1e-13);
    }
  }
}

TEST(an_empty_matrix) {
  OWN(strut_arena) arena = {0};
  strut_triplets none = {0};
  strut_sparse *m = strut_sparse_build(0, &none, &arena);
  assert_non_null(m);
  assert_int_equal(m->start[0], 0);
  strut_sparse_multiply(m, NULL, &(double){0});
  m = strut_sparse_build(3, &none, &arena);
  assert_int_equal(m->start[3], 3);
}

/* A positive definite matrix: what is drawn, and on the diagonal more than all of it. */
static strut_sparse *positive(uint64_t *r, double spread, strut_arena *arena) {
  strut_triplets triplets = {0};
  double scale[N];
  assert_true(strut_triplets_reserve(&triplets, 5 * N, arena));
  for (int i = 0; i < N; i++) scale[i] = random_scale(r, 1 / spread, spread);
  for (int32_t i = 0; i < N; i++) strut_triplets_add(&triplets, i, i, 8 * scale[i] * scale[i]);
  for (int k = 0; k < 2 * N; k++) {
    int32_t i = random_below(r, N), j = random_below(r, N);
    if (i != j) strut_triplets_add(&triplets, i, j, random_between(r, -1, 1) * scale[i] * scale[j]);
  }
  return strut_sparse_build(N, &triplets, arena);
}

static void check_factor(double spread) {
  uint64_t r = 5;
  for (int turn = 0; turn < 30; turn++) {
    OWN(strut_arena) arena = {0};
    OWN_POINTER(strut_factor) factor;
    double b[N], x[N], ordered[N], pair[2 * N], back[N], largest[N] = {0};
    strut_sparse *m = positive(&r, spread, &arena);
    assert_ok(strut_factor_create(m, &factor, NULL));
    for (int i = 0; i < N; i++) b[i] = random_between(&r, -1, 1);
    for (int i = 0; i < N; i++) ordered[i] = pair[2 * i] = b[factor->order[i]];
    for (int i = 0; i < N; i++) pair[2 * i + 1] = -2 * ordered[i];
    strut_factor_solve(factor, ordered);
    strut_factor_solve_pair(factor, pair);
    for (int i = 0; i < N; i++) {
      x[factor->order[i]] = ordered[i];
      assert_same_bits(pair[2 * i], ordered[i]);
      assert_true(pair[2 * i + 1] == -2 * ordered[i]);
    }
    strut_sparse_multiply(m, x, back);
    for (int32_t j = 0; j < N; j++) /* |A| |x|, what rounding errors are relative to */
      for (int32_t k = m->start[j]; k < m->start[j + 1]; k++) {
        largest[m->row[k]] += fabs(m->value[k] * x[j]);
        largest[j] += fabs(m->value[k] * x[m->row[k]]);
      }
    for (int i = 0; i < N; i++) assert_near(back[i], b[i], 1e-14 * (largest[i] + fabs(b[i])));
  }
}

TEST(factors_solve) { check_factor(2); }

/* Diagonals from 1e-12 to 1e12: heavy beside light nodes. */
TEST(factors_solve_however_the_scales_differ) { check_factor(1e6); }

TEST(a_singular_matrix_is_refused) {
  for (int bad = 0; bad < 2; bad++) {
    OWN(strut_arena) arena = {0};
    strut_triplets triplets = {0};
    strut_error error = {0};
    strut_factor *factor = NULL;
    assert_true(strut_triplets_reserve(&triplets, 10, &arena));
    for (int32_t i = 0; i < 3; i++) strut_triplets_add(&triplets, i, i, 1);
    strut_triplets_add(&triplets, 1, 2, bad ? 2 : 1); /* indefinite, singular */
    strut_sparse *m = strut_sparse_build(3, &triplets, &arena);
    assert_fails(strut_factor_create(m, &factor, &error), STRUT_SINGULAR, error,
                 "positive definite");
    assert_null(factor);
  }
}

TEST(factors_without_memory) {
  uint64_t r = 6;
  OWN(strut_arena) arena = {0};
  strut_sparse *m = positive(&r, 1, &arena);
  REFUSE_EACH(n, status, 1) {
    OWN_POINTER(strut_factor) factor = NULL;
    status = refused(n, strut_factor_create(m, &factor, NULL));
    if (status) assert_null(factor);
  }
}

/* Two paths and a ring that nothing couples. */
TEST(parts_are_solved_together) {
  enum { PART = 100, PARTS = 3, ALL = PART * PARTS };
  OWN(strut_arena) arena = {0};
  strut_triplets triplets = {0};
  OWN_POINTER(strut_factor) factor;
  double b[ALL], x[ALL], back[ALL];
  assert_true(strut_triplets_reserve(&triplets, 2 * ALL, &arena));
  for (int32_t i = 0; i < ALL; i++) {
    strut_triplets_add(&triplets, i, i, 3.0 + i % 5);
    if (i % PART) strut_triplets_add(&triplets, i, i - 1, 1.0);
  }
  strut_triplets_add(&triplets, ALL - 1, ALL - PART, 0.5);
  strut_sparse *m = strut_sparse_build(ALL, &triplets, &arena);
  REFUSE_EACH(n, status, 1) {
    status = refused(n, strut_factor_create(m, &factor, NULL));
    if (status) assert_null(factor);
  }
  for (int32_t i = 0; i < ALL; i++) b[i] = cos(i);
  for (int32_t i = 0; i < ALL; i++) x[i] = b[factor->order[i]];
  strut_factor_solve(factor, x);
  for (int32_t i = 0; i < ALL; i++) back[factor->order[i]] = x[i];
  strut_sparse_multiply(m, back, x);
  for (int32_t i = 0; i < ALL; i++) assert_near(x[i], b[i], 1e-14);
}
