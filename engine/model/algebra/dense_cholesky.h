/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Cholesky factor L (n, n; lower triangle, in rows) of a small dense matrix, such as that by which stuck
 * contacts hold each other.
 */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/model/algebra/hot.h"

/** In place; false if the matrix is not positive definite. */
STRUT_INLINE bool strut_cholesky_factor(int32_t n, double *a) {
  for (int32_t i = 0; i < n; i++) {
    double *row = a + (size_t)i * (size_t)n;
    for (int32_t j = 0; j <= i; j++) {
      const double *left = a + (size_t)j * (size_t)n;
      double sum = row[j];
      for (int32_t k = 0; k < j; k++) sum -= row[k] * left[k];
      if (i == j && !(sum > 0.0)) return false;
      row[j] = i == j ? sqrt(sum) : sum / left[j];
    }
  }
  return true;
}

/** x becomes (L L')^-1 x. */
STRUT_INLINE void strut_cholesky_solve(int32_t n, const double *f, double *vector) {
  for (int32_t i = 0; i < n; i++) {
    for (int32_t j = 0; j < i; j++) vector[i] -= f[i * n + j] * vector[j];
    vector[i] /= f[i * n + i];
  }
  for (int32_t i = n - 1; i >= 0; i--) {
    for (int32_t j = i + 1; j < n; j++) vector[i] -= f[j * n + i] * vector[j];
    vector[i] /= f[i * n + i];
  }
}
