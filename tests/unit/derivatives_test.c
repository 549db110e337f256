/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives by differences against formulas: errors that hold, kinks, jumps, bounds and the number of evaluations. */
#include <math.h>
#include <stdatomic.h>

#include "engine/base/derivatives.h"
#include "tests/support/test.h"

enum { COUNT = 3, OUTPUTS = 9 };
static atomic_int calls;

/* Smooth; an extremum in all; small noise; two kinks; missing below; a jump; a change that rounding hides; a count. */
static strut_status functions(void *context, const double *p, double *y, double *errors,
                              strut_error *error) {
  (void)context, (void)error;
  calls++;
  double x = p[0], u = p[1], w = p[2], noise = 1e-9 * sin(1e12 * (x + u + w));
  if (x < 0.0 || w > 3.0) return strut_fail(error, STRUT_USAGE, "out of range");
  y[0] = exp(x) * sin(u) + w * w * w;
  y[1] = (x + u + w - 6.0) * (x + u + w - 6.0) + 10.0;
  y[2] = x * u * w + noise, errors[2] = 1e-9;
  y[3] = fmax(x - 1.0, 0.0) + u;
  y[4] = fabs((x - 1.0) - (u - 2.0)) + w;
  y[5] = sqrt(w - 3.0);
  y[6] = x > 1.0 ? 7.0 : 5.0;
  y[7] = 1e12 + x;
  y[8] = 3.0, errors[8] = 0.0;
  return STRUT_OK;
}

static const strut_derivatives_parameter usual[COUNT] = {
    {1.0, 0.0, 9.0, 0.0}, {2.0, -9.0, 9.0, 0.0}, {3.0, 0.0, 3.0, 0.0}};

static void find(const strut_derivatives_parameter *by, strut_derivative d[OUTPUTS][COUNT]) {
  const strut_derivatives_task task = {.parameter_count = COUNT,
                                       .output_count = OUTPUTS,
                                       .parameters = by,
                                       .evaluate = functions,
                                       .threads = 2};
  calls = 0;
  assert_int_equal(strut_derivatives_find(&task, d[0], NULL), STRUT_OK);
  assert_int_equal(calls, 2 * COUNT + 3);
}

static void expect(strut_derivative d, double value, double within) {
  assert_int_equal(d.verdict, STRUT_DERIVATIVE_THERE);
  assert_true(fabs(d.value - value) <= d.error && d.error <= within);
}

/* The third parameter is at the end of its range. */
TEST(formulas) {
  strut_derivative d[OUTPUTS][COUNT];
  find(usual, d);
  expect(d[0][0], exp(1.0) * sin(2.0), 1e-3);
  expect(d[0][1], exp(1.0) * cos(2.0), 1e-3);
  expect(d[0][2], 27.0, 1e-3);
  for (int i = 0; i < COUNT; i++) expect(d[1][i], 0.0, 0.01);
  expect(d[2][0], 6.0, 1e-2);
  expect(d[2][2], 2.0, 1e-2);
}

TEST(a_point_that_fails_says_why) {
  const strut_derivatives_parameter by[] = {usual[0], usual[1], {3.0, 0.0, 9.0, 0.0}};
  strut_derivative d[OUTPUTS][COUNT];
  strut_error error = {0};
  const strut_derivatives_task task = {COUNT, OUTPUTS, by, functions, NULL, NULL, NULL, 1};
  assert_int_equal(strut_derivatives_find(&task, d[0], &error), STRUT_OK);
  assert_int_equal(d[0][2].verdict, STRUT_DERIVATIVE_UNKNOWN);
  assert_string_equal(error.message, "out of range");
}

TEST(kinks) {
  strut_derivative d[OUTPUTS][COUNT];
  find(usual, d);
  assert_int_equal(d[3][0].verdict, STRUT_DERIVATIVE_NONE);
  expect(d[3][1], 1.0, 1.0);
  assert_int_equal(d[4][0].verdict, STRUT_DERIVATIVE_NONE);
  assert_int_equal(d[4][1].verdict, STRUT_DERIVATIVE_NONE);
  expect(d[4][2], 1.0, 1.0);
  assert_int_equal(d[5][2].verdict, STRUT_DERIVATIVE_UNKNOWN);
  assert_string_equal(strut_derivative_words(d[3][0].verdict), "not differentiable here");
}

TEST(jumps_and_what_rounding_hides) {
  strut_derivative d[OUTPUTS][COUNT];
  find(usual, d);
  assert_int_equal(d[6][0].verdict, STRUT_DERIVATIVE_NONE);
  expect(d[7][0], 1.0, 1e3);
  expect(d[8][0], 0.0, 0.0);
}
