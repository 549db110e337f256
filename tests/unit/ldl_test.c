/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors of matrices that need not be positive definite: solutions, signs, condition. */
#include <gsl/gsl_linalg.h>

#include "engine/model/algebra/linear_solver.h"
#include "tests/support/check.h"
#include "tests/support/dense.h"
#include "tests/support/random.h"

enum { N = 40 };

static strut_sparse *random_matrix(uint64_t *r, double lift, strut_arena *arena) {
  strut_triplets triplets = {0};
  assert_true(strut_triplets_reserve(&triplets, 5 * N, arena));
  for (int32_t i = 0; i < N; i++)
    strut_triplets_add(&triplets, i, i, random_between(r, -1, 1) + lift);
  for (int32_t k = 0; k < 3 * N; k++) {
    int32_t i = random_below(r, N), j = random_below(r, N);
    if (i != j) strut_triplets_add(&triplets, i, j, random_between(r, -1, 1));
  }
  return strut_sparse_build(N, &triplets, arena);
}

static int negative_eigenvalues(const strut_sparse *m, double shift) {
  int count = 0;
  OWN_POINTER(gsl_matrix) a = dense_of(m, shift);
  OWN_POINTER(gsl_vector) values = dense_eigenvalues(a, NULL);
  for (size_t i = 0; i < values->size; i++) count += gsl_vector_get(values, i) < 0;
  return count;
}

/* 1 / (|A| |A^-1|) in the 1-norm, from the inverse itself. */
static double true_rcond(const strut_sparse *m) {
  size_t n = (size_t)m->n;
  OWN_POINTER(gsl_matrix) a = dense_of(m, 0), *inverse = gsl_matrix_alloc(n, n);
  gsl_permutation *order = gsl_permutation_alloc(n);
  double norm = 0, inverse_norm = 0;
  int sign;
  for (size_t j = 0; j < n; j++) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += fabs(gsl_matrix_get(a, i, j));
    norm = fmax(norm, sum);
  }
  gsl_linalg_LU_decomp(a, order, &sign);
  gsl_linalg_LU_invert(a, order, inverse);
  for (size_t j = 0; j < n; j++) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += fabs(gsl_matrix_get(inverse, i, j));
    inverse_norm = fmax(inverse_norm, sum);
  }
  gsl_permutation_free(order);
  return 1 / (norm * inverse_norm);
}

TEST(it_solves_and_counts_signs) {
  uint64_t r = 11;
  for (int turn = 0; turn < 40; turn++) {
    OWN(strut_arena) arena = {0};
    strut_sparse *m = random_matrix(&r, random_between(&r, -4, 4), &arena);
    strut_ldl *ldl;
    assert_ok(strut_ldl_create(m, &arena, &ldl, NULL));
    for (int again = 0; again < 3; again++) { /* new numbers, the same pattern */
      double b[N], x[N], back[N], shift = again * random_between(&r, -2, 2);
      strut_inertia inertia;
      for (int32_t k = 0; k < m->start[N] && again == 2; k++) m->value[k] *= 1.5;
      assert_ok(strut_ldl_factorise(ldl, m, shift, &inertia));
      if (inertia.smallest < 1e-4) continue;
      assert_int_equal(inertia.negative, negative_eigenvalues(m, shift));
      for (int i = 0; i < N; i++) b[i] = x[i] = random_between(&r, -1, 1);
      strut_ldl_solve(ldl, x);
      strut_sparse_multiply(m, x, back);
      for (int i = 0; i < N; i++) assert_near(back[i] + shift * x[i], b[i], 1e-8);
    }
  }
}

TEST(its_condition_is_estimated) {
  uint64_t r = 12;
  for (int turn = 0; turn < 40; turn++) {
    OWN(strut_arena) arena = {0};
    strut_sparse *m = random_matrix(&r, 5, &arena);
    strut_ldl *ldl;
    strut_inertia inertia;
    assert_ok(strut_ldl_create(m, &arena, &ldl, NULL));
    assert_ok(strut_ldl_factorise(ldl, m, 0, &inertia));
    double known = true_rcond(m), estimate = strut_ldl_rcond(ldl, m);
    assert_within(estimate, 0.999 * known, 4 * known);
  }
}

/* Springs of 1 and 1e12 in turn: CHOLMOD is content, the estimate is not. */
TEST(an_ill_conditioned_chain_shows) {
  OWN(strut_arena) arena = {0};
  strut_triplets triplets = {0};
  strut_ldl *ldl;
  strut_inertia inertia;
  assert_true(strut_triplets_reserve(&triplets, 4 * N, &arena));
  for (int32_t i = 0; i < N; i++) {
    double stiffness = i % 2 ? 1e12 : 1;
    strut_triplets_add(&triplets, i, i, stiffness);
    if (i == 0) continue;
    strut_triplets_add(&triplets, i - 1, i - 1, stiffness);
    strut_triplets_add(&triplets, i, i - 1, -stiffness);
  }
  strut_sparse *m = strut_sparse_build(N, &triplets, &arena);
  assert_ok(strut_ldl_create(m, &arena, &ldl, NULL));
  assert_ok(strut_ldl_factorise(ldl, m, 0, &inertia));
  assert_within(strut_ldl_rcond(ldl, m), 1e-18, 1e-12);
  assert_true(inertia.smallest < 1e-11);
}

TEST(a_zero_pivot_is_refused_and_a_shift_helps) {
  OWN(strut_arena) arena = {0};
  strut_triplets triplets = {0};
  strut_ldl *ldl;
  strut_inertia inertia;
  double b[2] = {1, 2};
  assert_true(strut_triplets_reserve(&triplets, 2, &arena));
  strut_triplets_add(&triplets, 0, 0, 1);
  strut_sparse *m = strut_sparse_build(2, &triplets, &arena);
  assert_ok(strut_ldl_create(m, &arena, &ldl, NULL));
  assert_int_equal(strut_ldl_factorise(ldl, m, 0, &inertia), STRUT_SINGULAR);
  assert_int_equal(inertia.row, 1);
  assert_ok(strut_ldl_factorise(ldl, m, 1, &inertia));
  strut_ldl_solve(ldl, b);
  assert_all_near(0, b[0], 0.5, b[1], 2);
  assert_ok(strut_ldl_factorise(ldl, m, -0.5, &inertia));
  assert_int_equal(inertia.negative, 1);
}

static strut_status create_and_factorise(strut_sparse *m) {
  OWN(strut_arena) arena = {0};
  strut_ldl *ldl;
  strut_inertia inertia;
  strut_status status = strut_ldl_create(m, &arena, &ldl, NULL);
  return status ? status : strut_ldl_factorise(ldl, m, 0, &inertia);
}

TEST(refused_memory) {
  OWN(strut_arena) arena = {0};
  uint64_t r = 13;
  strut_sparse *m = random_matrix(&r, 5, &arena);
  REFUSE_EACH(n, status, 1) status = refused(n, create_and_factorise(m));
}
