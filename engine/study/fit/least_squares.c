/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/fit/least_squares.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <string.h>

/* Gradients, and changes of the sum, at which the method ends, relative. */
static const double FLAT = 1e-15;

/* How strongly points outside of the box are drawn back, in residuals per unit of a parameter. */
static const double DRAWN = 1e6;

/* Where there are no residuals each counts as so much more than it was at the last point that had some. */
static const double WORSE = 1e3;

/* Singular values below this part of the largest are 0. */
static const double SINGULAR = 1e-12;

/* A problem while it is solved, with the parameters that are not held. */
typedef struct solver {
  const strut_least_squares *problem;
  size_t free;          /* parameters */
  double *at;           /* (parameters) of the problem, within the box */
  double *ahead, *back; /* (count) residuals beside a point */
  double *known;        /* (count) at the latest point that had some */
  int64_t evaluations;
} solver;

static bool is_held(const solver *self, size_t i) { return (int32_t)i == self->problem->held; }

/* The nearest point of the box, and how far the parameters are outside (free). */
static void enter_box(solver *self, const gsl_vector *x, double *outside) {
  for (size_t i = 0, k = 0; i < self->problem->parameters; i++) {
    if (is_held(self, i)) continue;
    double value = gsl_vector_get(x, k);
    self->at[i] = fmin(fmax(value, self->problem->low[i]), self->problem->high[i]);
    outside[k++] = value - self->at[i];
  }
}

static bool evaluate(solver *self, double *residual) {
  self->evaluations++;
  if (!self->problem->residuals(self->problem->context, self->at, residual)) return false;
  for (size_t i = 0; i < self->problem->count; i++)
    if (!isfinite(residual[i])) return false;
  return true;
}

static int find_residuals(const gsl_vector *x, void *context, gsl_vector *f) {
  solver *self = context;
  size_t count = self->problem->count;
  double outside[STRUT_LEAST_SQUARES_MOST];
  enter_box(self, x, outside);
  if (evaluate(self, f->data))
    memcpy(self->known, f->data, count * sizeof *self->known);
  else
    for (size_t i = 0; i < count; i++) f->data[i] = WORSE * (1.0 + fabs(self->known[i]));
  for (size_t k = 0; k < self->free; k++) f->data[count + k] = DRAWN * outside[k];
  return GSL_SUCCESS;
}

/* Steps beside a parameter, both within the box. */
static void step_beside(const strut_least_squares *problem, size_t i, double at, double beside[2]) {
  double h = problem->step * fmax(fabs(at), 1.0);
  beside[0] = fmax(at - h, problem->low[i]);
  beside[1] = fmin(at + h, problem->high[i]);
}

/* The derivative by parameter i into column k of a matrix of that many columns. False: there is none. */
static bool differentiate(solver *self, size_t i, double *matrix, size_t columns, size_t k) {
  const strut_least_squares *problem = self->problem;
  double at = self->at[i], beside[2];
  double *derivative = self->ahead;
  if (!problem->derivative || !problem->derivative(problem->context, self->at, i, derivative)) {
    step_beside(problem, i, at, beside);
    self->at[i] = beside[0];
    bool below = evaluate(self, self->back);
    self->at[i] = beside[1];
    bool above = evaluate(self, self->ahead);
    self->at[i] = at;
    if (below == above && !below) return false;
    if (!below) beside[0] = at, below = evaluate(self, self->back); /* on one side alone */
    if (!above) beside[1] = at, above = evaluate(self, self->ahead);
    if (!below || !above) return false;
    for (size_t j = 0; j < problem->count; j++)
      derivative[j] = (self->ahead[j] - self->back[j]) / (beside[1] - beside[0]);
  }
  for (size_t j = 0; j < problem->count; j++) matrix[j * columns + k] = derivative[j];
  return true;
}

static int find_jacobian(const gsl_vector *x, void *context, gsl_matrix *jacobian) {
  solver *self = context;
  size_t count = self->problem->count;
  double outside[STRUT_LEAST_SQUARES_MOST];
  gsl_matrix_set_zero(jacobian);
  enter_box(self, x, outside);
  for (size_t i = 0, k = 0; i < self->problem->parameters; i++) {
    if (is_held(self, i)) continue;
    if (outside[k] != 0.0)
      gsl_matrix_set(jacobian, count + k, k, DRAWN);
    else if (!differentiate(self, i, jacobian->data, jacobian->tda, k))
      return GSL_EFAILED;
    k++;
  }
  return GSL_SUCCESS;
}

static bool allocate(solver *self, strut_arena *arena) {
  size_t count = self->problem->count;
  self->at = strut_arena_allocate(arena, self->problem->parameters, sizeof *self->at);
  self->ahead = strut_arena_allocate(arena, count, sizeof *self->ahead);
  self->back = strut_arena_allocate(arena, count, sizeof *self->back);
  self->known = strut_arena_allocate(arena, count, sizeof *self->known);
  return self->at && self->ahead && self->back && self->known;
}

static double sum_of_squares(const double *residual, size_t count) {
  double sum = 0.0;
  for (size_t i = 0; i < count; i++) sum += residual[i] * residual[i];
  return sum;
}

/* Solves for the free parameters in x. */
static strut_status iterate(solver *self, gsl_vector *x, strut_fit_solution *solution) {
  gsl_multifit_nlinear_parameters settings = gsl_multifit_nlinear_default_parameters();
  gsl_multifit_nlinear_fdf system = {.f = find_residuals,
                                     .df = find_jacobian,
                                     .n = self->problem->count + self->free,
                                     .p = self->free,
                                     .params = self};
  int info = 0;
  settings.solver = gsl_multifit_nlinear_solver_svd;
  gsl_multifit_nlinear_workspace *workspace =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &settings, system.n, system.p);
  if (!workspace) return STRUT_NO_MEMORY;
  int status = gsl_multifit_nlinear_init(x, &system, workspace);
  if (!status)
    status = gsl_multifit_nlinear_driver((size_t)self->problem->most_steps, self->problem->near,
                                         FLAT, FLAT, NULL, NULL, &info, workspace);
  gsl_vector_memcpy(x, gsl_multifit_nlinear_position(workspace));
  solution->steps = (int64_t)gsl_multifit_nlinear_niter(workspace);
  solution->sum =
      sum_of_squares(gsl_multifit_nlinear_residual(workspace)->data, self->problem->count);
  solution->end = status ? STRUT_FIT_STUCK : STRUT_FIT_CONVERGED;
  gsl_multifit_nlinear_free(workspace);
  return STRUT_OK;
}

strut_status strut_least_squares_solve(const strut_least_squares *problem, double *parameters,
                                       strut_fit_solution *solution) {
  strut_arena arena = {0};
  solver self = {.problem = problem, .free = problem->parameters - (problem->held >= 0)};
  strut_status status = STRUT_OK;
  *solution = (strut_fit_solution){.end = STRUT_FIT_FAILED, .sum = HUGE_VAL};
  if (!allocate(&self, &arena)) {
    strut_arena_free(&arena);
    return STRUT_NO_MEMORY;
  }
  memcpy(self.at, parameters, problem->parameters * sizeof *parameters);
  if (evaluate(&self, self.known)) {
    solution->sum = sum_of_squares(self.known, problem->count);
    solution->end = STRUT_FIT_CONVERGED;
    gsl_vector *x = self.free ? gsl_vector_alloc(self.free) : NULL;
    for (size_t i = 0, k = 0; x && i < problem->parameters; i++)
      if (!is_held(&self, i)) gsl_vector_set(x, k++, parameters[i]);
    double outside[STRUT_LEAST_SQUARES_MOST];
    if (self.free) status = x ? iterate(&self, x, solution) : STRUT_NO_MEMORY;
    if (x) enter_box(&self, x, outside);
    gsl_vector_free(x);
    memcpy(parameters, self.at, problem->parameters * sizeof *parameters);
  }
  solution->evaluations = self.evaluations;
  strut_arena_free(&arena);
  return status;
}

bool strut_least_squares_jacobian(const strut_least_squares *problem, const double *parameters,
                                  double *residual, double *jacobian) {
  strut_arena arena = {0};
  solver self = {.problem = problem};
  bool fine = allocate(&self, &arena);
  if (fine) memcpy(self.at, parameters, problem->parameters * sizeof *parameters);
  fine = fine && evaluate(&self, residual);
  for (size_t i = 0; i < problem->parameters && fine; i++)
    fine = differentiate(&self, i, jacobian, problem->parameters, i);
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
  spectrum->singular = strut_arena_allocate(arena, n, sizeof(double));
  spectrum->direction = strut_arena_allocate(arena, n * n, sizeof(double));
  spectrum->covariance = strut_arena_allocate(arena, n * n, sizeof(double));
  double *work = strut_arena_allocate(arena, n, sizeof *work);
  if (!spectrum->singular || !spectrum->direction || !spectrum->covariance || !work) return false;
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
