/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eigenvalues of small matrices: closed forms, residuals and orthogonality, awkward scales. */
#include "engine/statics/algebra.h"

#include <float.h>
#include <gsl/gsl_sort.h>

#include "tests/support/check.h"
#include "tests/support/random.h"

enum { MOST = 60 };

static double z[MOST * MOST], a[MOST * MOST], value[MOST], work[MOST];

/* |A v - lambda v| and |v_i . v_j - delta| within some last bits of the largest value. */
static void check(int32_t rows) {
  size_t n = (size_t)rows;
  double largest = 0.0;
  memcpy(z, a, n * n * sizeof *a);
  assert_true(strut_eigen(z, rows, value, work));
  for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(value[i]));
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k < n; k++) {
      double sum = 0.0, dot = 0.0;
      for (size_t j = 0; j < n; j++) sum += a[k * n + j] * z[i * n + j];
      for (size_t j = 0; j < n; j++) dot += z[k * n + j] * z[i * n + j];
      assert_true(fabs(sum - value[i] * z[i * n + k]) <= 8.0 * rows * DBL_EPSILON * largest);
      assert_true(fabs(dot - (i == k)) <= 8.0 * rows * DBL_EPSILON);
    }
  }
}

TEST(random_matrices) {
  uint64_t seed = 1;
  for (int32_t n = 1; n <= MOST; n += n < 12 ? 1 : 7)
    for (int turn = 0; turn < 8; turn++) {
      for (int32_t i = 0; i < n; i++)
        for (int32_t k = 0; k <= i; k++)
          a[i * n + k] = a[k * n + i] = random_between(&seed, -0.5, 0.5);
      check(n);
    }
}

/* Second differences: 2 - 2 cos(k pi / (n + 1)). */
TEST(closed_form) {
  int32_t n = 30;
  memset(a, 0, sizeof a);
  for (int32_t i = 0; i < n; i++) {
    a[i * n + i] = 2.0;
    if (i > 0) a[i * n + i - 1] = a[(i - 1) * n + i] = -1.0;
  }
  check(n);
  gsl_sort(value, 1, (size_t)n);
  for (int32_t k = 1; k <= n; k++)
    assert_true(fabs(value[k - 1] - (2.0 - 2.0 * cos(k * acos(-1.0) / (n + 1)))) < 1e-13);
}

/* Rank one and none, equal values, blocks that are not connected, sizes from 1e-250 to 1e250. */
TEST(awkward) {
  int32_t n = 9;
  memset(a, 0, sizeof a);
  check(n);
  for (int32_t i = 0; i < n; i++) a[i * n + i] = 3.0;
  check(n);
  for (int32_t i = 0; i < n * n; i++) a[i] = 1.0;
  check(n);
  for (int32_t i = 0; i < n; i++)
    for (int32_t k = 0; k < n; k++) a[i * n + k] = (i < 4) == (k < 4) ? 1.0 / (1 + i + k) : 0.0;
  check(n);
  for (double size = 1e-250; size <= 1e250; size *= 1e125) {
    for (int32_t i = 0; i < n; i++)
      for (int32_t k = 0; k < n; k++) a[i * n + k] = size / (1 + i + k);
    check(n);
  }
  for (int32_t i = 0; i < n; i++) /* a stiff spring beside soft ones */
    for (int32_t k = 0; k < n; k++) a[i * n + k] = (i < 2 && k < 2 ? 1e12 : 1.0) / (1 + i + k);
  check(n);
}
