/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/paper/reference_statics.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

static const double G = 9.81;
/* Table 1: i1, i2, lambda_0 [mm], c [N/m], m [g]. */
static const struct {
  int i1, i2;
  double rest, c, mass;
} table1[9] = {{1, 2, 100, 1e6, 100}, {3, 5, 20, 1e6, 20}, {4, 5, 20, 1e6, 20},
               {1, 3, 20, 3000, 0},   {2, 3, 20, 3000, 0}, {2, 4, 20, 3000, 0},
               {1, 4, 20, 3000, 0},   {1, 5, 10, 1e4, 0},  {2, 5, 10, 1e4, 0}};

double statics_energy(const statics *s, const double q[STATICS]) {
  double sum = 0;
  for (int j = 0; j < 9; j++) {
    const double *a = q + 2 * (table1[j].i1 - 1), *b = q + 2 * (table1[j].i2 - 1);
    double stretch = hypot(b[0] - a[0], b[1] - a[1]) - 1e-3 * table1[j].rest;
    sum += table1[j].c / 2 * stretch * stretch + 1e-3 * table1[j].mass * G * (a[1] + b[1]) / 2;
  }
  for (int i = 0; i < 5; i++)
    if (q[2 * i + 1] < 0) sum += s->ground / 2 * q[2 * i + 1] * q[2 * i + 1];
  return sum;
}

void statics_reaction(const statics *s, const double q[STATICS], double r[STATICS]) {
  for (int k = 0; k < STATICS; k++) r[k] = 0;
  for (int j = 0; j < 9; j++) {
    int a = 2 * (table1[j].i1 - 1), b = 2 * (table1[j].i2 - 1);
    double dx = q[b] - q[a], dy = q[b + 1] - q[a + 1], length = hypot(dx, dy);
    double force = table1[j].c * (length - 1e-3 * table1[j].rest);
    double half = 1e-3 * table1[j].mass * G / 2;
    double fx = length > 0 ? force * dx / length : 0, fy = length > 0 ? force * dy / length : 0;
    r[a] -= fx, r[a + 1] -= fy - half, r[b] += fx, r[b + 1] += fy + half;
  }
  for (int i = 0; i < 5; i++)
    if (q[2 * i + 1] < 0) r[2 * i + 1] += s->ground * q[2 * i + 1];
}

void statics_gradient(const statics *s, const double q[STATICS], double g[STATICS]) {
  statics_reaction(s, q, g);
  for (int k = 0; k < STATICS; k++)
    if (s->held[k]) g[k] = 0;
}

int statics_eigenvalues(const statics *s, const double q[STATICS], double value[STATICS],
                        double vector[STATICS][STATICS]) {
  double a[STATICS][STATICS], v[STATICS][STATICS], x[STATICS], up[STATICS], down[STATICS];
  int free[STATICS], n = 0;
  const double h = 1e-7;
  for (int k = 0; k < STATICS; k++)
    if (!s->held[k]) free[n++] = k;
  for (int i = 0; i < n; i++) {
    memcpy(x, q, sizeof x);
    x[free[i]] = q[free[i]] + h;
    statics_gradient(s, x, up);
    x[free[i]] = q[free[i]] - h;
    statics_gradient(s, x, down);
    for (int j = 0; j < n; j++) a[i][j] = (up[free[j]] - down[free[j]]) / (2 * h);
  }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) a[i][j] = a[j][i] = (a[i][j] + a[j][i]) / 2;
  gsl_matrix_view matrix = gsl_matrix_view_array_with_tda(a[0], (size_t)n, (size_t)n, STATICS);
  gsl_matrix_view vectors = gsl_matrix_view_array_with_tda(v[0], (size_t)n, (size_t)n, STATICS);
  gsl_vector_view values = gsl_vector_view_array(value, (size_t)n);
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc((size_t)n);
  gsl_eigen_symmv(&matrix.matrix, &values.vector, &vectors.matrix, work);
  gsl_eigen_symmv_sort(&values.vector, &vectors.matrix, GSL_EIGEN_SORT_VAL_ASC);
  gsl_eigen_symmv_free(work);
  memset(vector, 0, STATICS * sizeof *vector);
  for (int i = 0; i < n; i++)
    for (int k = 0; k < n; k++) vector[i][free[k]] = v[k][i];
  return n;
}

static double norm(const double g[STATICS]) {
  double sum = 0;
  for (int k = 0; k < STATICS; k++) sum += g[k] * g[k];
  return sqrt(sum);
}

/* Newton's step, every curvature counted as upward, at most far. */
static void newton(const statics *s, const double q[STATICS], double far, double step[STATICS]) {
  double value[STATICS], vector[STATICS][STATICS], g[STATICS];
  int n = statics_eigenvalues(s, q, value, vector);
  statics_gradient(s, q, g);
  for (int k = 0; k < STATICS; k++) step[k] = 0;
  for (int i = 0; i < n; i++) {
    double along = 0, flat = 1e-3;
    for (int k = 0; k < STATICS; k++) along += g[k] * vector[i][k];
    if (fabs(value[i]) < flat) continue; /* along level ground nothing changes */
    for (int k = 0; k < STATICS; k++) step[k] -= along / fabs(value[i]) * vector[i][k];
  }
  double length = norm(step);
  for (int k = 0; k < STATICS && length > far; k++) step[k] *= far / length;
}

static bool still(const statics *s, const double q[STATICS]) {
  double g[STATICS];
  statics_gradient(s, q, g);
  return norm(g) < 1e-8;
}

bool statics_descend(const statics *s, double q[STATICS]) {
  double far = 0.02, here = statics_energy(s, q), value[STATICS], vector[STATICS][STATICS];
  for (int round = 0; round < 400; round++) {
    double step[STATICS], x[STATICS];
    newton(s, q, far, step);
    for (int k = 0; k < STATICS; k++) x[k] = q[k] + step[k];
    double there = statics_energy(s, x);
    if (still(s, x) && fabs(there - here) < 1e-9) {
      memcpy(q, x, sizeof x);
      int n = statics_eigenvalues(s, q, value, vector);
      return n == 0 || value[0] > -1e-3;
    }
    if (there < here) {
      memcpy(q, x, sizeof x);
      here = there;
      far = fmin(2 * far, 0.02);
    } else {
      far /= 4;
    }
    if (far < 1e-15) return false;
  }
  return false;
}

bool statics_congruent(const double a[STATICS], const double b[STATICS], double within) {
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < i; j++) {
      double la = hypot(a[2 * i] - a[2 * j], a[2 * i + 1] - a[2 * j + 1]);
      double lb = hypot(b[2 * i] - b[2 * j], b[2 * i + 1] - b[2 * j + 1]);
      if (!(fabs(la - lb) <= within)) return false;
    }
  return true;
}
