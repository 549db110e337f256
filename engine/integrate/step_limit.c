/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/step_limit.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "engine/forces/stiffness.h"

/* |R(z)| of RK4 for z = x + i y, R(z) = 1 + z (1 + z/2 (1 + z/3 (1 + z/4))). */
static double growth(double x, double y) {
  double re = 1.0, im = 0.0;
  for (int k = 4; k >= 1; k--) {
    double next = 1.0 + (re * x - im * y) / k;
    im = (re * y + im * x) / k;
    re = next;
  }
  return hypot(re, im);
}

double strut_rk4_limit(double re, double im) {
  double size = hypot(re, im);
  if (!(size > 0)) return HUGE_VAL;
  if (re > 0) re = 0, size = fabs(im); /* a motion that grows by itself says nothing of the step */
  if (!(size > 0)) return HUGE_VAL;
  double x = re / size, y = im / size;
  double inside = 0.0, outside = 3.5; /* RK4's region lies within |z| < 3.5 */
  for (double r = 0.05; r < 3.5; r += 0.05) {
    if (growth(r * x, r * y) > 1.0 + 1e-12) {
      outside = r;
      break;
    }
    inside = r;
  }
  for (int i = 0; i < 60; i++) {
    double middle = 0.5 * (inside + outside);
    if (growth(middle * x, middle * y) > 1.0 + 1e-12)
      outside = middle;
    else
      inside = middle;
  }
  return inside / size;
}

/* A free-coordinate vector to node arrays, through M^-1, and back. */
static void divide_by_mass(const strut_model *model, const strut_tangent *tangent, double *x,
                           double *work) {
  size_t both = (size_t)model->length;
  double *force = work, *acceleration = work + both, *scratch = work + 2 * both;
  memset(force, 0, both * sizeof *force);
  for (int32_t i = 0; i < tangent->n; i++) force[tangent->coordinate[i]] = x[i];
  strut_mass_solve(model, force, acceleration, scratch);
  for (int32_t i = 0; i < tangent->n; i++) x[i] = acceleration[tangent->coordinate[i]];
}

/*
 * The largest eigenvalue of M^-1 A for a symmetric A by power iteration, a little too large rather
 * than too small: the largest of the last Rayleigh-like quotients plus two per cent.
 */
static double largest_eigenvalue(const strut_model *model, const strut_tangent *tangent,
                                 const strut_sparse *matrix, double *x, double *y, double *work) {
  int32_t n = tangent->n;
  double value = 0.0;
  for (int32_t i = 0; i < n; i++) x[i] = 1.0 + 0.5 * sin(1.7 * i) * ((i % 2) ? -1 : 1);
  for (int iteration = 0; iteration < 200; iteration++) {
    strut_sparse_multiply(matrix, x, y);
    divide_by_mass(model, tangent, y, work);
    double dot = 0.0, norm = 0.0, length = 0.0;
    for (int32_t i = 0; i < n; i++) dot += x[i] * y[i], norm += x[i] * x[i], length += y[i] * y[i];
    if (!(length > 0)) return 0.0;
    double next = fmax(dot / norm, sqrt(length / norm) * 0.98);
    for (int32_t i = 0; i < n; i++) x[i] = y[i] / sqrt(length);
    if (iteration > 20 && fabs(next - value) < 1e-4 * next) return 1.02 * next;
    value = next;
  }
  return 1.02 * value;
}

static strut_status estimate(const strut_model *model, const strut_tangent *tangent,
                             strut_arena *arena, strut_step_limit *limit) {
  size_t n = (size_t)tangent->n, both = (size_t)model->length;
  double *x = strut_arena_allocate(arena, n, sizeof *x);
  double *y = strut_arena_allocate(arena, n, sizeof *y);
  double *work = strut_arena_allocate(arena, 3 * both, sizeof *work);
  if (!x || !y || !work) return STRUT_NO_MEMORY;
  double square = largest_eigenvalue(model, tangent, tangent->stiffness, x, y, work);
  double rate = largest_eigenvalue(model, tangent, tangent->damping, x, y, work);
  double omega = sqrt(fmax(square, 0.0));
  limit->largest_frequency = omega;
  /* As if the stiffest and the most damped motion were one and the same: the worst case. */
  double half = 0.5 * rate, under = square - half * half;
  double oscillating = omega > 0 ? 2.6 / omega : HUGE_VAL;
  double decaying = under < 0 ? strut_rk4_limit(-half - sqrt(-under), 0.0) : HUGE_VAL;
  if (!(rate > 0) && omega > 0) oscillating = strut_rk4_limit(0.0, omega);
  limit->limit = fmin(oscillating, decaying);
  return STRUT_OK;
}

/* Dense M^-1 A of the free coordinates, column by column, times -1, into the block at (row, column). */
static void fill_block(const strut_model *model, const strut_tangent *tangent,
                       const strut_sparse *matrix, gsl_matrix *system, size_t column, double *x,
                       double *y, double *work) {
  size_t n = (size_t)tangent->n;
  for (size_t j = 0; j < n; j++) {
    memset(x, 0, n * sizeof *x);
    x[j] = 1.0;
    strut_sparse_multiply(matrix, x, y);
    divide_by_mass(model, tangent, y, work);
    for (size_t i = 0; i < n; i++) gsl_matrix_set(system, n + i, column + j, -y[i]);
  }
}

static void read_spectrum(const gsl_vector_complex *values, strut_step_limit *limit) {
  limit->limit = HUGE_VAL;
  for (size_t i = 0; i < values->size; i++) {
    gsl_complex z = gsl_vector_complex_get(values, i);
    limit->limit = fmin(limit->limit, strut_rk4_limit(GSL_REAL(z), GSL_IMAG(z)));
  }
}

/* All eigenvalues of the first-order system [0 1; -M^-1 K, -M^-1 D]. */
static strut_status solve_exactly(const strut_model *model, const strut_tangent *tangent,
                                  strut_arena *arena, strut_step_limit *limit) {
  size_t n = (size_t)tangent->n, both = (size_t)model->length;
  double *x = strut_arena_allocate(arena, n, sizeof *x);
  double *y = strut_arena_allocate(arena, n, sizeof *y);
  double *work = strut_arena_allocate(arena, 3 * both, sizeof *work);
  gsl_matrix *system = gsl_matrix_calloc(2 * n, 2 * n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(2 * n);
  gsl_eigen_nonsymm_workspace *w = gsl_eigen_nonsymm_alloc(2 * n);
  strut_status status = STRUT_NO_MEMORY;
  if (x && y && work && system && values && w) {
    for (size_t i = 0; i < n; i++) gsl_matrix_set(system, i, n + i, 1.0);
    fill_block(model, tangent, tangent->stiffness, system, 0, x, y, work);
    fill_block(model, tangent, tangent->damping, system, n, x, y, work);
    limit->largest_frequency =
        sqrt(fmax(largest_eigenvalue(model, tangent, tangent->stiffness, x, y, work) / 1.02, 0.0));
    if (gsl_eigen_nonsymm(system, values, w) == 0) {
      read_spectrum(values, limit);
      limit->exact = true;
      status = STRUT_OK;
    } else {
      status = estimate(model, tangent, arena, limit);
    }
  }
  gsl_matrix_free(system);
  gsl_vector_complex_free(values);
  gsl_eigen_nonsymm_free(w);
  return status;
}

strut_status strut_step_limit_estimate(const strut_model *model, strut_step_limit *limit,
                                       strut_error *error) {
  strut_arena arena = {0};
  strut_tangent tangent;
  *limit = (strut_step_limit){0.0, HUGE_VAL, true};
  strut_status status = strut_tangent_assemble(model, model->start, model->members.rest,
                                               STRUT_CLOSED_ALL, &arena, &tangent);
  if (!status && tangent.n > 0)
    status = tangent.n <= STRUT_EXACT_LIMIT ? solve_exactly(model, &tangent, &arena, limit)
                                            : estimate(model, &tangent, &arena, limit);
  strut_arena_free(&arena);
  return status ? strut_fail(error, status, "out of memory") : STRUT_OK;
}
