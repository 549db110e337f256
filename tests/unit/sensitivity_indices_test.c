/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensitivity indices of made-up results: closed forms, missing ones, and results that hardly vary. */
#include "engine/study/sensitivity/sensitivity.h"
#include "tests/support/random.h"
#include "tests/support/test.h"

enum { SAMPLES = 4096, FEW = 24 };

/* f = 2 x + y on the unit square: variances 4/12 and 1/12. */
TEST(linear) {
  static double row[SAMPLES][4];
  strut_estimate first[2], total[2];
  uint64_t seed = 7;
  size_t used;
  for (size_t j = 0; j < SAMPLES; j++) {
    double a[2], b[2];
    for (int k = 0; k < 2; k++) {
      a[k] = random_between(&seed, 0, 1);
      b[k] = random_between(&seed, 0, 1);
    }
    row[j][0] = 2 * a[0] + a[1];
    row[j][1] = 2 * b[0] + a[1];
    row[j][2] = 2 * a[0] + b[1];
    row[j][3] = 2 * b[0] + b[1];
  }
  assert_ok(strut_sensitivity_indices(row[0], SAMPLES, 2, 1, first, total, &used));
  assert_int_equal(used, SAMPLES);
  for (int k = 0; k < 2; k++) {
    double exact = k ? 0.2 : 0.8;
    assert_all(fabs(first[k].value - exact) < 4 * first[k].error,
               fabs(total[k].value - exact) < 4 * total[k].error,
               first[k].error < 0.03 && total[k].error < 0.03,
               first[k].low < first[k].value && first[k].value < first[k].high);
  }
}

/*
 * All base samples but one have the same result at A and B: about a third of the resamples are without that one,
 * and have no variance but the rounding of the mean. They give no indices.
 */
TEST(one_differs) {
  for (size_t n = 5; n <= FEW; n++) {
    double row[FEW][4];
    strut_estimate first[2], total[2];
    size_t used;
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < 4; k++) row[j][k] = k == 1 ? 0.1 + 0.01 * (double)(j % 3) : 0.1;
    row[3][0] = row[3][2] = 0.3;
    assert_ok(strut_sensitivity_indices(row[0], n, 2, 1, first, total, &used));
    assert_int_equal(used, n);
    for (int k = 0; k < 2; k++) {
      assert_true(fabs(first[k].low) < 10 && fabs(first[k].high) < 10);
      assert_true(total[k].low >= 0 && total[k].high < 10);
    }
  }
}

TEST(missing_and_constant) {
  double row[FEW][3];
  strut_estimate first, total;
  size_t used;
  for (size_t j = 0; j < FEW; j++)
    for (size_t k = 0; k < 3; k++) row[j][k] = 0.7;
  assert_ok(strut_sensitivity_indices(row[0], FEW, 1, 1, &first, &total, &used));
  assert_int_equal(used, FEW);
  assert_true(isnan(first.value) && isnan(total.value));
  for (size_t j = 0; j < FEW; j++) row[j][1] = (double)j;
  row[3][2] = (double)NAN;
  row[9][0] = (double)INFINITY;
  assert_ok(strut_sensitivity_indices(row[0], FEW, 1, 1, &first, &total, &used));
  assert_int_equal(used, FEW - 2);
}
