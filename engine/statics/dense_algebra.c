/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/algebra.h"

#include <assert.h>
#include <float.h>
#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/algebra/hot.h"

enum { MOST_STEPS = 80 };

/* Row i becomes the vector of the reflection that clears it, by way of d (its entries) and e. */
STRUT_INLINE void reflect_row(double *z, size_t n, size_t i, double scale, double *diagonal,
                              double *e) {
  double h = 0.0, f, g;
  for (size_t k = 0; k < i; k++) diagonal[k] /= scale, h += diagonal[k] * diagonal[k];
  f = diagonal[i - 1];
  g = f > 0 ? -sqrt(h) : sqrt(h);
  e[i] = scale * g;
  h -= f * g;
  diagonal[i - 1] = f - g;
  for (size_t j = 0; j < i; j++) e[j] = 0.0;
  for (size_t j = 0; j < i; j++) {
    const double *row = z + j * n;
    f = z[i * n + j] = diagonal[j];
    g = e[j] + row[j] * f;
    for (size_t k = j + 1; k < i; k++) {
      g += row[k] * diagonal[k];
      e[k] += row[k] * f;
    }
    e[j] = g;
  }
  f = 0.0;
  for (size_t j = 0; j < i; j++) e[j] /= h, f += e[j] * diagonal[j];
  for (size_t j = 0; j < i; j++) e[j] -= f / (h + h) * diagonal[j];
  for (size_t j = 0; j < i; j++) {
    double *row = z + j * n;
    f = diagonal[j], g = e[j];
    for (size_t k = j; k < i; k++) row[k] -= f * e[k] + g * diagonal[k];
    diagonal[j] = row[i - 1];
    row[i] = 0.0;
  }
  diagonal[i] = h;
}

/* The matrix as diagonal d and off-diagonal e[1..n-1]; z keeps the reflections. */
STRUT_CLONES
static void reduce(double *z, size_t n, double *diagonal, double *e) {
  for (size_t j = 0; j < n; j++) diagonal[j] = z[j * n + n - 1];
  for (size_t i = n - 1; i > 0; i--) {
    double scale = 0.0;
    for (size_t k = 0; k < i; k++) scale += fabs(diagonal[k]);
    if (scale > 0) {
      reflect_row(z, n, i, scale, diagonal, e);
      continue;
    }
    e[i] = diagonal[i - 1];
    for (size_t j = 0; j < i; j++) {
      diagonal[j] = z[j * n + i - 1];
      z[j * n + i] = z[i * n + j] = 0.0;
    }
    diagonal[i] = 0.0;
  }
}

/* The product of the reflections into z, transposed; d becomes the diagonal. */
STRUT_CLONES
static void accumulate(double *z, size_t n, double *diagonal, double *e) {
  for (size_t i = 0; i + 1 < n; i++) {
    double h = diagonal[i + 1], *next = z + (i + 1) * n;
    z[i * n + n - 1] = z[i * n + i];
    z[i * n + i] = 1.0;
    if (h != 0.0) {
      for (size_t k = 0; k <= i; k++) diagonal[k] = next[k] / h;
      for (size_t j = 0; j <= i; j++) {
        double g = 0.0, *row = z + j * n;
        for (size_t k = 0; k <= i; k++) g += next[k] * row[k];
        for (size_t k = 0; k <= i; k++) row[k] -= g * diagonal[k];
      }
    }
    for (size_t k = 0; k <= i; k++) next[k] = 0.0;
  }
  for (size_t j = 0; j < n; j++) {
    diagonal[j] = z[j * n + n - 1];
    z[j * n + n - 1] = 0.0;
  }
  z[n * n - 1] = 1.0;
  for (size_t i = 1; i < n; i++) e[i - 1] = e[i];
  e[n - 1] = 0.0;
}

STRUT_INLINE void rotate(double *lower, double *upper, size_t n, double c, double s) {
  for (size_t k = 0; k < n; k++) {
    double h = upper[k];
    upper[k] = s * lower[k] + c * h;
    lower[k] = c * lower[k] - s * h;
  }
}

/* One QL step on rows l to m; `shift` gathers what was taken off the diagonal. */
STRUT_INLINE void step(double *z, size_t n, size_t l, size_t m, double *diagonal, double *e,
                       double *shift) {
  double g = diagonal[l], p = (diagonal[l + 1] - g) / (2.0 * e[l]), r = sqrt(p * p + 1.0);
  if (!(r <= DBL_MAX)) r = fabs(p);
  if (p < 0) r = -r;
  diagonal[l] = e[l] / (p + r);
  diagonal[l + 1] = e[l] * (p + r);
  double beside = diagonal[l + 1], off = e[l + 1], h = g - diagonal[l];
  for (size_t i = l + 2; i < n; i++) diagonal[i] -= h;
  *shift += h;
  p = diagonal[m];
  double c = 1.0, c2 = 1.0, c3 = 1.0, s = 0.0, s2 = 0.0;
  for (size_t i = m; i-- > l;) {
    c3 = c2, c2 = c, s2 = s;
    g = c * e[i], h = c * p;
    r = sqrt(p * p + e[i] * e[i]);
    e[i + 1] = s * r;
    s = r > 0 ? e[i] / r : 0.0, c = r > 0 ? p / r : 1.0;
    p = c * diagonal[i] - s * g;
    diagonal[i + 1] = h + s * (c * g + s * diagonal[i]);
    rotate(z + i * n, z + (i + 1) * n, n, c, s);
  }
  p = -s * s2 * c3 * off * e[l] / beside;
  e[l] = s * p;
  diagonal[l] = c * p;
}

STRUT_CLONES
static bool diagonalise(double *z, size_t n, double *diagonal, double *e) {
  double shift = 0.0, largest = 0.0;
  for (size_t l = 0; l < n; l++) {
    largest = fmax(largest, fabs(diagonal[l]) + fabs(e[l]));
    size_t m = l;
    while (fabs(e[m]) > DBL_EPSILON * largest) m++; /* the last one is 0 */
    for (int k = 0; m > l && fabs(e[l]) > DBL_EPSILON * largest; k++) {
      if (k == MOST_STEPS) return false;
      step(z, n, l, m, diagonal, e, &shift);
    }
    diagonal[l] += shift;
    e[l] = 0.0;
  }
  return true;
}

/* Scales the matrix by a power of two, which is returned, where squares might overflow or vanish. */
static int scale_matrix(double *matrix, size_t n) {
  double largest = 0.0;
  int power = 0;
  for (size_t i = 0; i < n * n; i++)
    if (fabs(matrix[i]) > largest) largest = fabs(matrix[i]);
  if (largest > 0) frexp(largest, &power);
  if (power <= 400 && power >= -400) return 0;
  for (size_t i = 0; i < n * n; i++) matrix[i] = ldexp(matrix[i], -power);
  return power;
}

bool strut_eigen(double *matrix, int32_t rows, double *value, double *work) {
  assert(rows >= 0);
  size_t n = (size_t)rows;
  if (n == 0) return true;
  int power = scale_matrix(matrix, n);
  reduce(matrix, n, value, work);
  accumulate(matrix, n, value, work);
  if (!diagonalise(matrix, n, value, work)) return false;
  for (size_t i = 0; i < n && power; i++) value[i] = ldexp(value[i], power);
  return true;
}

bool strut_eigen_ascending(double *matrix, int32_t n, double *value, double *vector) {
  size_t rows = (size_t)n, bytes = rows * sizeof *vector;
  if (!strut_eigen(matrix, n, value, vector)) return false; /* its first row is scratch */
  for (size_t i = 0; i < rows; i++) {
    size_t k = i;
    double own = value[i];
    for (; k > 0 && value[k - 1] > own; k--) value[k] = value[k - 1];
    value[k] = own;
    memmove(vector + (k + 1) * rows, vector + k * rows, (i - k) * bytes);
    memcpy(vector + k * rows, matrix + i * rows, bytes);
  }
  return true;
}

/* Fixes the sign of a vector, so that results do not depend on how it was computed. */
static void turn(double *vector, size_t n) {
  size_t largest = 0;
  for (size_t i = 1; i < n; i++)
    if (fabs(vector[i]) > 1.000001 * fabs(vector[largest])) largest = i;
  if (vector[largest] >= 0) return;
  for (size_t i = 0; i < n; i++) vector[i] = -vector[i];
}

bool strut_symmetric_eigen(double *matrix, size_t n, double *value, double *vector) {
  if (n == 0) return true;
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(n);
  if (!work) return false;
  gsl_matrix_view a = gsl_matrix_view_array(matrix, n, n);
  gsl_matrix_view v = gsl_matrix_view_array(vector, n, n);
  gsl_vector_view d = gsl_vector_view_array(value, n);
  bool good = gsl_eigen_symmv(&a.matrix, &d.vector, &v.matrix, work) == 0 &&
              gsl_eigen_symmv_sort(&d.vector, &v.matrix, GSL_EIGEN_SORT_VAL_ASC) == 0 &&
              gsl_matrix_transpose(&v.matrix) == 0;
  gsl_eigen_symmv_free(work);
  for (size_t i = 0; good && i < n; i++) turn(vector + i * n, n);
  return good;
}

gsl_matrix *strut_arena_matrix(strut_arena *arena, size_t rows, size_t columns) {
  gsl_matrix *matrix = strut_arena_allocate(arena, 1, sizeof *matrix);
  double *data = strut_arena_allocate(arena, rows * columns, sizeof *data);
  if (!matrix || !data) return NULL;
  *matrix = (gsl_matrix){.size1 = rows, .size2 = columns, .tda = columns, .data = data};
  return matrix;
}

gsl_vector *strut_arena_vector(strut_arena *arena, size_t size) {
  gsl_vector *vector = strut_arena_allocate(arena, 1, sizeof *vector);
  double *data = strut_arena_allocate(arena, size, sizeof *data);
  if (!vector || !data) return NULL;
  *vector = (gsl_vector){.size = size, .stride = 1, .data = data};
  return vector;
}

gsl_permutation *strut_arena_order(strut_arena *arena, size_t size) {
  gsl_permutation *order = strut_arena_allocate(arena, 1, sizeof *order);
  size_t *data = strut_arena_allocate(arena, size, sizeof *data);
  if (!order || !data) return NULL;
  *order = (gsl_permutation){.size = size, .data = data};
  return order;
}

double strut_remove_shares(const double *rows, size_t count, size_t n, double *vector) {
  for (int twice = 0; twice < 2; twice++)
    for (size_t k = 0; k < count; k++) {
      double share = strut_dot(rows + k * n, vector, (ptrdiff_t)n);
      for (size_t i = 0; i < n; i++) vector[i] -= share * rows[k * n + i];
    }
  return strut_dot(vector, vector, (ptrdiff_t)n);
}

bool strut_solve_rows(gsl_matrix *matrix, gsl_vector *right, gsl_permutation *order,
                      gsl_vector *vector) {
  int sign;
  for (size_t i = 0; i < matrix->size1; i++) {
    gsl_vector_view row = gsl_matrix_row(matrix, i);
    double most = fmax(-gsl_vector_min(&row.vector), gsl_vector_max(&row.vector));
    if (!(most > 0) || !isfinite(most)) return false;
    for (size_t j = 0; j < matrix->size2; j++) *gsl_matrix_ptr(matrix, i, j) /= most;
    *gsl_vector_ptr(right, i) /= most;
  }
  gsl_linalg_LU_decomp(matrix, order, &sign);
  for (size_t i = 0; i < matrix->size1; i++)
    if (gsl_matrix_get(matrix, i, i) == 0.0) return false;
  return gsl_linalg_LU_solve(matrix, order, right, vector) == 0;
}

bool strut_shortest(gsl_matrix *matrix, double cut, gsl_vector *right, gsl_vector *vector) {
  strut_arena arena = {0};
  gsl_matrix *v = strut_arena_matrix(&arena, matrix->size2, matrix->size2);
  gsl_vector *s = strut_arena_vector(&arena, matrix->size2),
             *w = strut_arena_vector(&arena, matrix->size2);
  bool good = v && s && w && gsl_linalg_SV_decomp(matrix, v, s, w) == 0;
  for (int k = 0; k < 2 && good; k++) { /* V' right over the values: once for x, twice for y */
    if (k == 0) gsl_blas_dgemv(CblasTrans, 1.0, v, right, 0.0, w);
    for (size_t i = 0; i < matrix->size2; i++) {
      double value = gsl_vector_get(s, i);
      bool counts = value > cut * gsl_vector_get(s, 0);
      gsl_vector_set(w, i, counts ? gsl_vector_get(w, i) / value : 0.0);
    }
    if (k == 0) gsl_blas_dgemv(CblasNoTrans, 1.0, matrix, w, 0.0, vector);
    if (k == 1) gsl_blas_dgemv(CblasNoTrans, 1.0, v, w, 0.0, right);
  }
  strut_arena_free(&arena);
  return good;
}
