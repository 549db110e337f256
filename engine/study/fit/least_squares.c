/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/fit/least_squares.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <string.h>

const char *const strut_fit_ends[STRUT_FIT_END_COUNT] = {"converged", "stuck", "failed", "none",
                                                         "not finished"};

/* Gradients, and changes of the sum, at which the method ends, relative. */
static const double FLAT = 1e-15;

/*
 * How strongly points outside of the box are drawn back, in lengths of the first residuals per unit of a parameter.
 * Residuals do not change there, so that any such force ends on the bound.
 */
static const double DRAWN = 10.0;

/* A parameter so many of the changes at which the method ends away from a bound, or half a step, is on it. */
static const double CLOSE = 100.0;

/* Each residual where there are none: worse than any that is one, and its square is still a number. */
static const double NONE = 1e150;

/*
 * Where steps become short the sum should fall by less than its mean, where they end otherwise by less than this part of
 * it; unless it is EXACT of what it was.
 */
static const double MUCH = 1e-2, EXACT = 1e-12;

/* Singular values below this part of the largest are 0. */
static const double SINGULAR = 1e-12;

/* A problem while it is solved. */
typedef struct solver {
  const strut_least_squares *problem;
  double *low, *high;   /* (parameters) the box, in which one that is held has no room */
  double *at;           /* (parameters) within the box */
  double *outside;      /* (parameters) how far from there the method is */
  double *ahead, *back; /* (count) residuals beside a point */
  double *derivative;   /* (count) */
  double *known; /* (count) at the latest point that had some: where the matrix is asked for */
  double drawn;  /* residuals per unit outside of the box */
  bool lost;     /* residuals end there while they get smaller */
} solver;

/* False: memory is out. */
static bool begin(solver *self, const strut_least_squares *problem, const double *parameters,
                  strut_arena *arena) {
  size_t n = problem->parameters, count = problem->count;
  *self = (solver){.problem = problem,
                   .low = strut_arena_copy(arena, problem->low, n, sizeof(double)),
                   .high = strut_arena_copy(arena, problem->high, n, sizeof(double)),
                   .at = strut_arena_copy(arena, parameters, n, sizeof(double))};
  bool fine =
      self->low && self->high && self->at && STRUT_NUMBERS(arena, n, &self->outside) &&
      STRUT_NUMBERS(arena, count, &self->ahead, &self->back, &self->derivative, &self->known);
  if (fine && problem->held >= 0)
    self->low[problem->held] = self->high[problem->held] = parameters[problem->held];
  return fine;
}

/* Goes to the nearest point of the box. */
static void enter_box(solver *self, const gsl_vector *x) {
  for (size_t i = 0; i < self->problem->parameters; i++) {
    double value = gsl_vector_get(x, i);
    self->at[i] = fmin(fmax(value, self->low[i]), self->high[i]);
    self->outside[i] = value - self->at[i];
  }
}

static bool evaluate(solver *self, double *residual) {
  bool fine = self->problem->residuals(self->problem->context, self->at, residual);
  for (size_t i = 0; i < self->problem->count && fine; i++) fine = isfinite(residual[i]);
  return fine;
}

static int find_residuals(const gsl_vector *x, void *context, gsl_vector *f) {
  solver *self = context;
  size_t count = self->problem->count;
  enter_box(self, x);
  if (evaluate(self, f->data))
    memcpy(self->known, f->data, count * sizeof *self->known);
  else
    for (size_t i = 0; i < count; i++) f->data[i] = NONE;
  for (size_t i = 0; i < self->problem->parameters; i++)
    f->data[count + i] = self->drawn * self->outside[i];
  return GSL_SUCCESS;
}

/* Residuals where parameter i is moved to `beside`; where there are none it stays, and they are those known. */
static const double *look_beside(solver *self, size_t i, double *beside, double *residual) {
  double at = self->at[i];
  self->at[i] = *beside;
  bool fine = *beside != at && evaluate(self, residual);
  self->at[i] = at;
  if (fine) return residual;
  *beside = at;
  return self->known;
}

/* The derivative by parameter i, and how far that could be looked at to both sides: 0, 0 where it could not. */
static void differentiate(solver *self, size_t i, double side[2]) {
  double at = self->at[i], h = self->problem->step * fmax(fabs(at), 1.0);
  double low = fmax(at - h, self->low[i]), high = fmin(at + h, self->high[i]);
  const double *ahead = look_beside(self, i, &high, self->ahead);
  bool enough = self->problem->one_sided && high > at;
  double first = enough ? at : low;
  const double *back = look_beside(self, i, &first, self->back);
  for (size_t j = 0; j < self->problem->count; j++)
    self->derivative[j] = high > first ? (ahead[j] - back[j]) / (high - first) : 0.0;
  side[0] = at - (enough ? low : first);
  side[1] = high - at;
}

/*
 * Does parameter i stay where it is? It is outside of the box, where residuals do not depend on it; or they get smaller
 * where it cannot go: out of the box, or to where there are none. Else its derivative is there, 0 where it is held.
 */
static bool is_stopped(solver *self, size_t i) {
  double at = self->at[i], side[2], slope = 0.0;
  double near = fmin(CLOSE * self->problem->near, 0.5 * self->problem->step) * fmax(fabs(at), 1.0);
  if (fabs(self->outside[i]) > near) return true;
  differentiate(self, i, side);
  for (size_t j = 0; j < self->problem->count; j++) slope += self->derivative[j] * self->known[j];
  if (slope == 0.0 || side[slope < 0.0] > near) return false;
  if (at - self->low[i] > near && self->high[i] - at > near) self->lost = true;
  return true;
}

/* A parameter that is stopped is drawn to the box, while others go their way. */
static int find_jacobian(const gsl_vector *x, void *context, gsl_matrix *jacobian) {
  solver *self = context;
  size_t count = self->problem->count;
  gsl_matrix_set_zero(jacobian);
  self->lost = false;
  enter_box(self, x);
  for (size_t i = 0; i < self->problem->parameters; i++) {
    bool stopped = is_stopped(self, i);
    for (size_t j = 0; j < count && !stopped; j++)
      gsl_matrix_set(jacobian, j, i, self->derivative[j]);
    if (stopped) gsl_matrix_set(jacobian, count + i, i, self->drawn);
  }
  return GSL_SUCCESS;
}

static double sum_of_squares(const double *residual, size_t count) {
  double sum = 0.0;
  for (size_t i = 0; i < count; i++) sum += residual[i] * residual[i];
  return sum;
}

/* By how much the sum of squares would fall by a step of at most 1 along each singular direction; -1: memory is out. */
static double find_fall(const gsl_matrix *jacobian, const gsl_vector *residual) {
  strut_arena arena = {0};
  strut_fit_spectrum spectrum;
  size_t rows = jacobian->size1, n = jacobian->size2;
  double *left = strut_arena_copy(&arena, jacobian->data, rows * n, sizeof *left);
  bool fine = left && strut_fit_spectrum_find(left, rows, n, &arena, &spectrum);
  double fall = fine ? 0.0 : -1.0;
  for (size_t k = 0; k < n && fine; k++) {
    gsl_vector_const_view side = gsl_vector_const_view_array_with_stride(left + k, n, rows);
    double part, s = spectrum.singular[k];
    gsl_blas_ddot(&side.vector, residual, &part);
    part = fabs(part);
    fall += part < s ? part * part : s * (2.0 * part - s);
  }
  strut_arena_free(&arena);
  return fall;
}

/*
 * Iterates until steps are short, or none makes the sum smaller. It has not converged where steps ran out, or their
 * number did, while the sum should still fall.
 */
static strut_status iterate(solver *self, strut_fit_solution *solution) {
  const strut_least_squares *problem = self->problem;
  gsl_multifit_nlinear_parameters settings = gsl_multifit_nlinear_default_parameters();
  gsl_multifit_nlinear_fdf system = {.f = find_residuals,
                                     .df = find_jacobian,
                                     .n = problem->count + problem->parameters,
                                     .p = problem->parameters,
                                     .params = self};
  double at[STRUT_LEAST_SQUARES_MOST], first = sum_of_squares(self->known, problem->count);
  int info = 0;
  settings.solver = gsl_multifit_nlinear_solver_svd;
  self->drawn = DRAWN * sqrt(first);
  memcpy(at, self->at, problem->parameters * sizeof *at);
  gsl_vector_view x = gsl_vector_view_array(at, problem->parameters);
  gsl_multifit_nlinear_workspace *workspace =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &settings, system.n, system.p);
  if (!workspace) return STRUT_NO_MEMORY;
  bool fine = !gsl_multifit_nlinear_init(&x.vector, &system, workspace);
  bool more = fine && gsl_multifit_nlinear_driver((size_t)problem->most_steps, problem->near, FLAT,
                                                  FLAT, NULL, NULL, &info, workspace);
  const gsl_vector *residual = gsl_multifit_nlinear_residual(workspace);
  double sum = sum_of_squares(residual->data, residual->size);
  double fall = fine ? find_fall(gsl_multifit_nlinear_jac(workspace), residual) : -1.0;
  bool least = fall <= (more ? MUCH : 1.0) * sum / (double)problem->count || sum <= EXACT * first;
  enter_box(self, gsl_multifit_nlinear_position(workspace));
  solution->sum = sum_of_squares(residual->data, problem->count);
  solution->end = fall >= 0.0 && least && !self->lost ? STRUT_FIT_CONVERGED : STRUT_FIT_STUCK;
  gsl_multifit_nlinear_free(workspace);
  return STRUT_OK;
}

strut_status strut_least_squares_solve(const strut_least_squares *problem, double *parameters,
                                       strut_fit_solution *solution) {
  strut_arena arena = {0};
  solver self;
  strut_status status = STRUT_NO_MEMORY;
  *solution = (strut_fit_solution){.end = STRUT_FIT_FAILED, .sum = HUGE_VAL};
  if (begin(&self, problem, parameters, &arena)) {
    status = evaluate(&self, self.known) ? iterate(&self, solution) : STRUT_OK;
    memcpy(parameters, self.at, problem->parameters * sizeof *parameters);
  }
  strut_arena_free(&arena);
  return status;
}

bool strut_least_squares_jacobian(const strut_least_squares *problem, const double *parameters,
                                  double *residual, double *jacobian) {
  strut_arena arena = {0};
  solver self;
  double side[2];
  bool fine = begin(&self, problem, parameters, &arena) && evaluate(&self, self.known);
  for (size_t i = 0; i < problem->parameters && fine; i++) {
    differentiate(&self, i, side);
    fine = side[0] + side[1] > 0.0;
    for (size_t j = 0; j < problem->count; j++)
      jacobian[j * problem->parameters + i] = self.derivative[j];
  }
  if (fine) memcpy(residual, self.known, problem->count * sizeof *residual);
  strut_arena_free(&arena);
  return fine;
}

/* V diag(1 / s^2) V'; a parameter that takes part in a direction of no singular value has no variance. */
static void fill_covariance(strut_fit_spectrum *spectrum) {
  size_t n = spectrum->parameters;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      double sum = 0.0;
      for (size_t k = 0; k < n; k++) {
        double s = spectrum->singular[k],
               part = spectrum->direction[k * n + i] * spectrum->direction[k * n + j];
        bool none = s <= SINGULAR * spectrum->singular[0];
        if (!none) sum += part / (s * s);
        if (none && i == j && part > SINGULAR) sum = HUGE_VAL;
      }
      spectrum->covariance[i * n + j] = sum;
    }
}

bool strut_fit_spectrum_find(double *jacobian, size_t count, size_t parameters, strut_arena *arena,
                             strut_fit_spectrum *spectrum) {
  size_t n = parameters;
  *spectrum = (strut_fit_spectrum){.parameters = n};
  double *work;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(spectrum->singular, n), STRUT_NEW(work, n),
                      STRUT_NEW(spectrum->direction, n * n),
                      STRUT_NEW(spectrum->covariance, n * n)))
    return false;
  gsl_matrix_view matrix = gsl_matrix_view_array(jacobian, count, n);
  gsl_matrix_view directions = gsl_matrix_view_array(spectrum->direction, n, n);
  gsl_vector_view singular = gsl_vector_view_array(spectrum->singular, n);
  gsl_vector_view scratch = gsl_vector_view_array(work, n);
  if (gsl_linalg_SV_decomp(&matrix.matrix, &directions.matrix, &singular.vector, &scratch.vector))
    return false;
  gsl_matrix_transpose(&directions.matrix);
  fill_covariance(spectrum);
  return true;
}
