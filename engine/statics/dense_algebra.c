/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/algebra.h"

#include <assert.h>
#include <float.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stddef.h>

#include "engine/base/vec.h"
#include "engine/model/algebra/hot.h"

enum { MOST_STEPS = 80 };

/* Row i becomes the vector of the reflection that clears it, by way of d (its entries) and e. */
STRUT_INLINE void reflect_row(double *z, size_t n, size_t i, double scale, double *d, double *e) {
  double h = 0.0, f, g;
  for (size_t k = 0; k < i; k++) d[k] /= scale, h += d[k] * d[k];
  f = d[i - 1];
  g = f > 0 ? -sqrt(h) : sqrt(h);
  e[i] = scale * g;
  h -= f * g;
  d[i - 1] = f - g;
  for (size_t j = 0; j < i; j++) e[j] = 0.0;
  for (size_t j = 0; j < i; j++) {
    const double *row = z + j * n;
    f = z[i * n + j] = d[j];
    g = e[j] + row[j] * f;
    for (size_t k = j + 1; k < i; k++) {
      g += row[k] * d[k];
      e[k] += row[k] * f;
    }
    e[j] = g;
  }
  f = 0.0;
  for (size_t j = 0; j < i; j++) e[j] /= h, f += e[j] * d[j];
  for (size_t j = 0; j < i; j++) e[j] -= f / (h + h) * d[j];
  for (size_t j = 0; j < i; j++) {
    double *row = z + j * n;
    f = d[j], g = e[j];
    for (size_t k = j; k < i; k++) row[k] -= f * e[k] + g * d[k];
    d[j] = row[i - 1];
    row[i] = 0.0;
  }
  d[i] = h;
}

/* The matrix as diagonal d and off-diagonal e[1..n-1]; z keeps the reflections. */
STRUT_CLONES
static void reduce(double *z, size_t n, double *d, double *e) {
  for (size_t j = 0; j < n; j++) d[j] = z[j * n + n - 1];
  for (size_t i = n - 1; i > 0; i--) {
    double scale = 0.0;
    for (size_t k = 0; k < i; k++) scale += fabs(d[k]);
    if (scale > 0) {
      reflect_row(z, n, i, scale, d, e);
      continue;
    }
    e[i] = d[i - 1];
    for (size_t j = 0; j < i; j++) {
      d[j] = z[j * n + i - 1];
      z[j * n + i] = z[i * n + j] = 0.0;
    }
    d[i] = 0.0;
  }
}

/* The product of the reflections into z, transposed; d becomes the diagonal. */
STRUT_CLONES
static void accumulate(double *z, size_t n, double *d, double *e) {
  for (size_t i = 0; i + 1 < n; i++) {
    double h = d[i + 1], *next = z + (i + 1) * n;
    z[i * n + n - 1] = z[i * n + i];
    z[i * n + i] = 1.0;
    if (h != 0.0) {
      for (size_t k = 0; k <= i; k++) d[k] = next[k] / h;
      for (size_t j = 0; j <= i; j++) {
        double g = 0.0, *row = z + j * n;
        for (size_t k = 0; k <= i; k++) g += next[k] * row[k];
        for (size_t k = 0; k <= i; k++) row[k] -= g * d[k];
      }
    }
    for (size_t k = 0; k <= i; k++) next[k] = 0.0;
  }
  for (size_t j = 0; j < n; j++) {
    d[j] = z[j * n + n - 1];
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
STRUT_INLINE void step(double *z, size_t n, size_t l, size_t m, double *d, double *e,
                       double *shift) {
  double g = d[l], p = (d[l + 1] - g) / (2.0 * e[l]), r = sqrt(p * p + 1.0);
  if (!(r <= DBL_MAX)) r = fabs(p);
  if (p < 0) r = -r;
  d[l] = e[l] / (p + r);
  d[l + 1] = e[l] * (p + r);
  double beside = d[l + 1], off = e[l + 1], h = g - d[l];
  for (size_t i = l + 2; i < n; i++) d[i] -= h;
  *shift += h;
  p = d[m];
  double c = 1.0, c2 = 1.0, c3 = 1.0, s = 0.0, s2 = 0.0;
  for (size_t i = m; i-- > l;) {
    c3 = c2, c2 = c, s2 = s;
    g = c * e[i], h = c * p;
    r = sqrt(p * p + e[i] * e[i]);
    e[i + 1] = s * r;
    s = r > 0 ? e[i] / r : 0.0, c = r > 0 ? p / r : 1.0;
    p = c * d[i] - s * g;
    d[i + 1] = h + s * (c * g + s * d[i]);
    rotate(z + i * n, z + (i + 1) * n, n, c, s);
  }
  p = -s * s2 * c3 * off * e[l] / beside;
  e[l] = s * p;
  d[l] = c * p;
}

STRUT_CLONES
static bool diagonalise(double *z, size_t n, double *d, double *e) {
  double shift = 0.0, largest = 0.0;
  for (size_t l = 0; l < n; l++) {
    largest = fmax(largest, fabs(d[l]) + fabs(e[l]));
    size_t m = l;
    while (fabs(e[m]) > DBL_EPSILON * largest) m++; /* the last one is 0 */
    for (int k = 0; m > l && fabs(e[l]) > DBL_EPSILON * largest; k++) {
      if (k == MOST_STEPS) return false;
      step(z, n, l, m, d, e, &shift);
    }
    d[l] += shift;
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

bool strut_tridiagonal_create(strut_tridiagonal *t, int32_t rows, strut_arena *arena) {
  size_t n = (size_t)rows;
  *t = (strut_tridiagonal){.n = rows, .z = strut_arena_allocate(arena, n * n, sizeof *t->z)};
  double **line[] = {&t->height, &t->work, &t->diagonal, &t->beside, &t->pivot, &t->ratio};
  bool good = t->z != NULL;
  for (size_t i = 0; i < sizeof line / sizeof line[0]; i++)
    good = good && (*line[i] = strut_arena_allocate(arena, n, sizeof(double)));
  return good;
}

void strut_tridiagonal_reduce(strut_tridiagonal *t) {
  size_t n = (size_t)t->n;
  double before = 0.0;
  t->bound = 0.0;
  if (n == 0) return;
  t->power = scale_matrix(t->z, n);
  reduce(t->z, n, t->height, t->work);
  for (size_t i = 0; i < n; i++) {
    t->diagonal[i] = ldexp(t->z[i * n + i], t->power);
    t->beside[i] = i + 1 < n ? ldexp(t->work[i + 1], t->power) : 0.0;
    t->bound = fmax(t->bound, fabs(t->diagonal[i]) + fabs(t->beside[i]) + before);
    before = fabs(t->beside[i]);
  }
}

bool strut_tridiagonal_eigen(strut_tridiagonal *t, double *value) {
  size_t n = (size_t)t->n;
  if (n == 0) return true;
  accumulate(t->z, n, t->height, t->work);
  if (!diagonalise(t->z, n, t->height, t->work)) return false;
  for (size_t i = 0; i < n; i++) value[i] = ldexp(t->height[i], t->power);
  return true;
}

/* x without twice its share along the reflection of row i. */
STRUT_INLINE void reflect(const strut_tridiagonal *t, size_t i, double *x) {
  const double *row = t->z + i * (size_t)t->n;
  if (t->height[i] == 0.0) return;
  double share = strut_dot(row, x, (ptrdiff_t)i) / t->height[i];
  for (size_t k = 0; k < i; k++) x[k] -= share * row[k];
}

void strut_tridiagonal_enter(const strut_tridiagonal *t, double *x) {
  for (size_t i = (size_t)t->n; i-- > 1;) reflect(t, i, x);
}

void strut_tridiagonal_leave(const strut_tridiagonal *t, double *x) {
  for (size_t i = 1; i < (size_t)t->n; i++) reflect(t, i, x);
}

int32_t strut_tridiagonal_factor(strut_tridiagonal *t, double shift) {
  int32_t negative = 0;
  double taken = 0.0;
  for (int32_t i = 0; i < t->n; i++) {
    double pivot = t->diagonal[i] + shift - taken;
    if (pivot == 0.0) pivot = -DBL_MIN;
    negative += !(pivot > 0.0);
    t->pivot[i] = pivot;
    t->ratio[i] = t->beside[i] / pivot;
    taken = t->ratio[i] * t->beside[i];
  }
  return negative;
}

double strut_tridiagonal_form(const strut_tridiagonal *t, const double *x) {
  double sum = 0.0, y = 0.0;
  for (int32_t i = 0; i < t->n; i++) {
    y = x[i] - (i > 0 ? t->ratio[i - 1] * y : 0.0);
    sum += y * y / t->pivot[i];
  }
  return sum;
}

void strut_tridiagonal_solve(const strut_tridiagonal *t, double *x) {
  for (int32_t i = 1; i < t->n; i++) x[i] -= t->ratio[i - 1] * x[i - 1];
  for (int32_t i = 0; i < t->n; i++) x[i] /= t->pivot[i];
  for (int32_t i = t->n - 1; i-- > 0;) x[i] -= t->ratio[i] * x[i + 1];
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

double strut_remove_shares(const double *rows, size_t count, size_t n, double *x) {
  for (int twice = 0; twice < 2; twice++)
    for (size_t k = 0; k < count; k++) {
      double share = strut_dot(rows + k * n, x, (ptrdiff_t)n);
      for (size_t i = 0; i < n; i++) x[i] -= share * rows[k * n + i];
    }
  return strut_dot(x, x, (ptrdiff_t)n);
}

bool strut_solve_rows(gsl_matrix *a, gsl_vector *right, gsl_permutation *order, gsl_vector *x) {
  int sign;
  for (size_t i = 0; i < a->size1; i++) {
    gsl_vector_view row = gsl_matrix_row(a, i);
    double most = fmax(-gsl_vector_min(&row.vector), gsl_vector_max(&row.vector));
    if (!(most > 0) || !isfinite(most)) return false;
    for (size_t j = 0; j < a->size2; j++) *gsl_matrix_ptr(a, i, j) /= most;
    *gsl_vector_ptr(right, i) /= most;
  }
  gsl_linalg_LU_decomp(a, order, &sign);
  for (size_t i = 0; i < a->size1; i++)
    if (gsl_matrix_get(a, i, i) == 0.0) return false;
  return gsl_linalg_LU_solve(a, order, right, x) == 0;
}
