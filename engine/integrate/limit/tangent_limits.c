/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/limit/tangent_limits.h"

#include <gsl/gsl_eigen.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/mass.h"

bool strut_tangent_limits_create(int most, strut_arena *arena, strut_tangent_limits *limits) {
  size_t m = (size_t)most;
  limits->room = strut_arena_allocate(arena, 2 * STRUT_MOST_BINDING * m, sizeof(double));
  for (size_t i = 0; limits->room && i < STRUT_MOST_BINDING; i++) {
    limits->binding[i].x = limits->room + 2 * i * m;
    limits->binding[i].y = limits->room + (2 * i + 1) * m;
  }
  return limits->room != NULL;
}

/* Symmetric eigenproblems of the projected matrices. */
typedef struct symmetric {
  size_t m;
  gsl_matrix *matrix, *vectors;
  gsl_vector *values;
  gsl_eigen_symmv_workspace *w;
} symmetric;

/*
 * Fills in a K + b D, times a power of two that makes the largest entry about 1. Returns by which
 * power they are too small then; INT_MAX where some entry is no finite number: GSL would not end.
 */
static int fill(symmetric *self, const strut_krylov_basis *space, double a, double b) {
  size_t m = self->m, row = (size_t)space->most;
  double most = 0.0, poison = 0.0;
  int power = 0;
  for (size_t i = 0; i < m; i++)
    for (size_t j = 0; j < m; j++) {
      double x = a * space->stiffness[i * row + j] + b * space->damping[i * row + j];
      poison += x - x;
      most = fmax(most, fabs(x));
      gsl_matrix_set(self->matrix, i, j, x);
    }
  if (poison != 0.0) return INT_MAX;
  frexp(most, &power);
  for (size_t i = 0; i < m * m; i++) self->matrix->data[i] = ldexp(self->matrix->data[i], -power);
  return power;
}

/* The largest eigenvalue of a K + b D with its vector; infinite where the matrix is. */
static double largest(symmetric *self, const strut_krylov_basis *space, double a, double b,
                      double *vector) {
  size_t m = self->m, top = 0;
  for (size_t i = 0; i < m; i++) vector[i] = i == 0;
  int power = fill(self, space, a, b);
  if (power == INT_MAX) return HUGE_VAL;
  if (gsl_eigen_symmv(self->matrix, self->values, self->vectors, self->w)) return 0.0;
  top = gsl_vector_max_index(self->values);
  for (size_t i = 0; i < m; i++) vector[i] = gsl_matrix_get(self->vectors, i, top);
  return ldexp(gsl_vector_get(self->values, top), power);
}

static double quotient(const double *small, size_t row, const double *vector, size_t m) {
  double sum = 0.0;
  for (size_t i = 0; i < m; i++)
    for (size_t j = 0; j < m; j++) sum += vector[i] * small[i * row + j] * vector[j];
  return sum;
}

/* The step at which c h D + h^2/4 K first has the eigenvalue 1, from above, by the quotients of each motion. */
static double tangent_limits_flip(symmetric *self, const strut_krylov_basis *space, double c,
                                  double h, double *vector) {
  size_t row = (size_t)space->most;
  for (int i = 0; i < 50 && h < HUGE_VAL; i++) {
    if (!(largest(self, space, 0.25 * h * h, c * h, vector) > 0.0)) break;
    double k = quotient(space->stiffness, row, vector, self->m);
    double d = c * quotient(space->damping, row, vector, self->m);
    double next = 2.0 / (d + sqrt(fmax(0.0, d * d + k)));
    bool done = !(next < h * (1.0 - 1e-13));
    h = fmin(h, next);
    if (done) break;
  }
  return h;
}

static strut_critical_mode *another(strut_tangent_limits *limits) {
  strut_critical_mode *one = &limits->binding[limits->count++];
  one->rk4 = one->complex_pair = false;
  return one;
}

/* Frequency, Verlet and Euler; the most negative real part there can be is returned. */
static double find_symmetric(symmetric *self, const strut_krylov_basis *space, bool damped,
                             strut_tangent_limits *limits) {
  strut_critical_mode *one = another(limits);
  double square = largest(self, space, 1.0, 0.0, one->x), rate = 0.0;
  one->a = 1.0, one->b = 0.0;
  limits->largest_frequency = sqrt(fmax(0.0, square));
  double swing = square > 0.0 ? 2.0 / sqrt(square) : HUGE_VAL;
  limits->of[STRUT_REGION_VERLET] = limits->of[STRUT_REGION_EULER] = swing;
  if (!damped) return 0.0;
  one = another(limits);
  rate = fmax(0.0, largest(self, space, 0.0, 1.0, one->x));
  one->a = 0.0, one->b = 1.0;
  for (int euler = 0; euler < 2; euler++) {
    double c = euler ? 0.5 : 1.0, h = fmin(swing, rate > 0.0 ? 1.0 / (c * rate) : HUGE_VAL);
    one = another(limits);
    h = tangent_limits_flip(self, space, c, h, one->x);
    one->a = 0.25 * h * h, one->b = c * h;
    if (!(h < HUGE_VAL)) limits->count--;
    limits->of[euler ? STRUT_REGION_EULER : STRUT_REGION_VERLET] = h;
  }
  return rate;
}

/* Keeps the eigenvalue among those that bind most, the most binding first. */
static void insert(size_t which, double limit, size_t *index, double *limits, int *count) {
  int at = *count < STRUT_CRITICAL_MODE_PAIRS ? (*count)++ : STRUT_CRITICAL_MODE_PAIRS;
  for (; at > 0 && limits[at - 1] > limit; at--)
    if (at < STRUT_CRITICAL_MODE_PAIRS) index[at] = index[at - 1], limits[at] = limits[at - 1];
  if (at < STRUT_CRITICAL_MODE_PAIRS) index[at] = which, limits[at] = limit;
}

static void take_pairs(const gsl_vector_complex *values, const gsl_matrix_complex *vectors,
                       double omega, strut_tangent_limits *limits) {
  size_t m = values->size / 2, index[STRUT_CRITICAL_MODE_PAIRS];
  double step[STRUT_CRITICAL_MODE_PAIRS];
  int count = 0;
  for (size_t i = 0; i < 2 * m; i++) {
    gsl_complex z = gsl_vector_complex_get(values, i);
    double h = strut_rk4_limit(omega * GSL_REAL(z), omega * GSL_IMAG(z));
    if (GSL_IMAG(z) >= 0.0 && h < HUGE_VAL) insert(i, h, index, step, &count);
  }
  limits->of[STRUT_REGION_RK4] = count > 0 ? step[0] : HUGE_VAL;
  for (int k = 0; k < count; k++) {
    strut_critical_mode *one = another(limits);
    gsl_complex z = gsl_vector_complex_get(values, index[k]);
    one->rk4 = true, one->complex_pair = GSL_IMAG(z) != 0.0;
    one->re = omega * GSL_REAL(z), one->im = omega * GSL_IMAG(z);
    for (size_t i = 0; i < m; i++) {
      gsl_complex x = gsl_matrix_complex_get(vectors, i, index[k]);
      one->x[i] = GSL_REAL(x), one->y[i] = GSL_IMAG(x);
    }
  }
}

static bool is_finite(const gsl_matrix *matrix) {
  double poison = 0.0;
  for (size_t i = 0; i < matrix->size1 * matrix->tda; i++)
    poison += matrix->data[i] - matrix->data[i];
  return poison == 0.0;
}

/* All eigenvalues of [0 w; -K/w, -D] / w: scaled so that its two halves are of one size. */
static bool find_rk4(const strut_krylov_basis *space, double omega, strut_tangent_limits *limits) {
  size_t m = (size_t)space->count, row = (size_t)space->most;
  gsl_matrix *system = gsl_matrix_calloc(2 * m, 2 * m);
  gsl_vector_complex *values = gsl_vector_complex_alloc(2 * m);
  gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(2 * m, 2 * m);
  gsl_eigen_nonsymmv_workspace *workspace = gsl_eigen_nonsymmv_alloc(2 * m);
  bool room = system && values && vectors && workspace;
  for (size_t i = 0; room && i < m; i++) {
    gsl_matrix_set(system, i, m + i, 1.0);
    for (size_t j = 0; j < m; j++) {
      gsl_matrix_set(system, m + i, j, -space->stiffness[i * row + j] / omega / omega);
      gsl_matrix_set(system, m + i, m + j, -space->damping[i * row + j] / omega);
    }
  }
  limits->solved =
      room && is_finite(system) && !gsl_eigen_nonsymmv(system, values, vectors, workspace);
  if (limits->solved) take_pairs(values, vectors, omega, limits);
  gsl_eigen_nonsymmv_free(workspace);
  gsl_matrix_complex_free(vectors);
  gsl_vector_complex_free(values);
  gsl_matrix_free(system);
  return room;
}

bool strut_tangent_limits_find(const strut_krylov_basis *space, bool damped, bool rk4,
                               strut_tangent_limits *limits) {
  limits->count = 0;
  limits->solved = true;
  for (int region = 0; region < STRUT_REGIONS; region++) limits->of[region] = HUGE_VAL;
  limits->largest_frequency = 0.0;
  if (space->count == 0) return true;
  size_t m = (size_t)space->count;
  symmetric s = {.m = m,
                 .matrix = gsl_matrix_alloc(m, m),
                 .vectors = gsl_matrix_alloc(m, m),
                 .values = gsl_vector_alloc(m),
                 .w = gsl_eigen_symmv_alloc(m)};
  bool good = s.matrix && s.vectors && s.values && s.w;
  if (good) {
    double rate = find_symmetric(&s, space, damped, limits), omega = limits->largest_frequency;
    /* the stability of RK4 for eigenvalues of any direction, where they are unknown */
    double bound = fmin(omega > 0.0 ? 2.6 / omega : HUGE_VAL, strut_rk4_limit(-rate, 0.0));
    if (!damped)
      limits->of[STRUT_REGION_RK4] = strut_rk4_limit(0.0, omega);
    else if (rk4 && fmax(omega, rate) > 0.0)
      good = find_rk4(space, fmax(omega, rate), limits);
    if (good && !limits->solved) limits->of[STRUT_REGION_RK4] = bound;
  }
  gsl_matrix_free(s.matrix);
  gsl_matrix_free(s.vectors);
  gsl_vector_free(s.values);
  gsl_eigen_symmv_free(s.w);
  return good;
}
