/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear programmes with answers by hand; least squares under bounds against every active set. */
#include <gsl/gsl_linalg.h>

#include "engine/statics/algebra.h"
#include "engine/statics/form/parts.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

/* Most of 3 x + 2 y with x + y <= 4, x + 3 y <= 6, x <= 3: x = 3, y = 1. */
static void make_known(strut_linear_program *p, strut_arena *arena) {
  assert_true(strut_linear_program_create(p, 2, 2, 4, arena));
  strut_linear_program_add(p, 0, 0, 1);
  strut_linear_program_add(p, 0, 1, 1);
  strut_linear_program_add(p, 1, 0, 1);
  strut_linear_program_add(p, 1, 1, 3);
  p->row_low[0] = p->row_low[1] = -HUGE_VAL;
  p->row_high[0] = 4, p->row_high[1] = 6;
  p->high[0] = 3;
  p->cost[0] = -3, p->cost[1] = -2;
}

TEST(optimum) {
  OWN(strut_arena) arena = {0};
  strut_linear_program p;
  strut_linear_program_end end;
  double x[2], sum;
  make_known(&p, &arena);
  assert_ok(strut_linear_program_solve(&p, x, &sum, &end));
  assert_int_equal(end, STRUT_PROGRAM_OPTIMAL);
  assert_all_near(1e-12, x[0], 3, x[1], 1, sum, -11);
  p.low[1] = 1.5; /* then x = 1.5: x + 3 y <= 6 */
  assert_ok(strut_linear_program_solve(&p, x, &sum, &end));
  assert_all_near(1e-12, x[0], 1.5, sum, -7.5);
}

TEST(no_optimum) {
  OWN(strut_arena) arena = {0};
  strut_linear_program p;
  strut_linear_program_end end = STRUT_PROGRAM_OPTIMAL;
  double x[2], sum;
  make_known(&p, &arena);
  p.low[1] = 5;
  assert_ok(strut_linear_program_solve(&p, x, &sum, &end));
  assert_int_equal(end, STRUT_PROGRAM_INFEASIBLE);
  p.low[1] = 0, p.row_high[0] = p.row_high[1] = p.high[0] = HUGE_VAL;
  assert_ok(strut_linear_program_solve(&p, x, &sum, &end));
  assert_int_equal(end, STRUT_PROGRAM_UNBOUNDED);
}

enum { COUNT = 5, ROWS = 2 };

/*
 * Least sum of (w x)^2 with A x = b and x = low at the bits of `active`, by the equations of Lagrange;
 * HUGE_VAL where that leaves the bounds.
 */
static double least_with(const double *a, const double *b, const double *w, const double *low,
                         unsigned active, double *x) {
  size_t size = COUNT + ROWS, n = 0, at[COUNT];
  for (size_t j = 0; j < COUNT; j++) {
    if (active & (1u << j)) size++;
    at[j] = n++;
  }
  gsl_matrix *m = gsl_matrix_calloc(size, size);
  gsl_vector *r = gsl_vector_calloc(size), *s = gsl_vector_alloc(size);
  gsl_permutation *order = gsl_permutation_alloc(size);
  size_t row = COUNT;
  int sign;
  for (size_t j = 0; j < COUNT; j++) gsl_matrix_set(m, j, j, w[j] * w[j]);
  for (size_t i = 0; i < ROWS; i++, row++) {
    for (size_t j = 0; j < COUNT; j++) {
      gsl_matrix_set(m, row, j, a[i * COUNT + j]);
      gsl_matrix_set(m, j, row, a[i * COUNT + j]);
    }
    gsl_vector_set(r, row, b[i]);
  }
  for (size_t j = 0; j < COUNT; j++) {
    if (!(active & (1u << j))) continue;
    gsl_matrix_set(m, row, at[j], 1), gsl_matrix_set(m, at[j], row, 1);
    gsl_vector_set(r, row++, low[j]);
  }
  gsl_linalg_LU_decomp(m, order, &sign);
  double sum = 0;
  bool good = fabs(gsl_linalg_LU_det(m, sign)) > 1e-9;
  if (good) gsl_linalg_LU_solve(m, order, r, s);
  for (size_t j = 0; j < COUNT && good; j++) {
    x[j] = gsl_vector_get(s, j);
    good = x[j] >= low[j] - 1e-12;
    sum += w[j] * w[j] * x[j] * x[j];
  }
  gsl_matrix_free(m);
  gsl_vector_free(r);
  gsl_vector_free(s);
  gsl_permutation_free(order);
  return good ? sum : HUGE_VAL;
}

TEST(bounded_squares) {
  uint64_t seed = 7;
  for (int round = 0; round < 200; round++) {
    double a[ROWS * COUNT], b[ROWS] = {0}, w[COUNT], low[COUNT], x[COUNT], best[COUNT], y[COUNT];
    double least = HUGE_VAL;
    for (size_t i = 0; i < ROWS * COUNT; i++) a[i] = random_between(&seed, -1, 1);
    for (size_t j = 0; j < COUNT; j++) {
      w[j] = random_between(&seed, 0.5, 2), low[j] = random_between(&seed, -1, 1);
      x[j] = low[j] + random_between(&seed, 0, 2);
      for (size_t i = 0; i < ROWS; i++) b[i] += a[i * COUNT + j] * x[j];
    }
    for (unsigned active = 0; active < 1u << COUNT; active++) {
      double sum = least_with(a, b, w, low, active, y);
      if (sum < least) least = sum, memcpy(best, y, sizeof best);
    }
    assert_true(strut_bounded_squares(ROWS, COUNT, a, w, low, x));
    for (size_t j = 0; j < COUNT; j++) assert_near(x[j], best[j], 1e-8);
  }
}
