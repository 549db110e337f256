/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

#include "engine/base/vec.h"
#include "engine/model/pose.h"
#include "engine/statics/algebra.h"
#include "engine/statics/potential.h"
#include "engine/statics/rigidity/rigidity_parts.h"

/* Eigenvalues and sums this small beside the largest are rounding. */
static const double ROUNDING = 1e-9;

/* Motion of a node of a member along x or y; 0 where held. */
static double moved(const strut_equilibrium_matrix *matrix, const double *motion, uint32_t at) {
  int32_t row = matrix->row_of[at];
  return row < 0 ? 0.0 : motion[row];
}

/* x' bend y of a running cable or a hinge. */
static double bend_form(const strut_model *model, const strut_equilibrium_matrix *matrix, int32_t j,
                        const double *vector, const double *y) {
  const strut_element *element = &model->elements.element[matrix->curved[j]];
  const uint32_t *at = model->elements.at + element->first;
  int32_t n = 2 * element->nodes;
  double sum = 0.0;
  for (int32_t r = 0; r < n; r++) {
    double left = moved(matrix, vector, at[r / 2] + (uint32_t)(r % 2));
    for (int32_t c = 0; c < n && left != 0.0; c++)
      sum += left * matrix->bend[j][r * n + c] * moved(matrix, y, at[c / 2] + (uint32_t)(c % 2));
  }
  return sum;
}

double strut_stress_form(const strut_model *model, const strut_equilibrium_matrix *matrix,
                         const double *density, const double *vector, const double *y) {
  double sum = 0.0;
  for (int32_t j = 0; j < matrix->columns; j++) {
    if (density[j] == 0.0) continue;
    if (matrix->curved[j] >= 0) {
      sum += density[j] * bend_form(model, matrix, j, vector, y);
      continue;
    }
    uint32_t from = model->members.from[j], to = model->members.to[j];
    double dx = moved(matrix, vector, to) - moved(matrix, vector, from);
    double dy = moved(matrix, vector, to + 1) - moved(matrix, vector, from + 1);
    double ex = moved(matrix, y, to) - moved(matrix, y, from);
    double ey = moved(matrix, y, to + 1) - moved(matrix, y, from + 1);
    sum += density[j] * (dx * ex + dy * ey);
  }
  return sum;
}

void strut_stress_form_on(const strut_model *model, const strut_equilibrium_matrix *matrix,
                          const double *density, const double *motion, int32_t count,
                          double *form) {
  size_t n = (size_t)count, rows = (size_t)matrix->rows;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++)
      form[i * n + k] = form[k * n + i] =
          strut_stress_form(model, matrix, density, motion + i * rows, motion + k * rows);
}

/* Do the densities balance at every node, held ones too? Then supports have nothing to carry. */
static bool balances_alone(const strut_model *model, const strut_equilibrium_matrix *matrix,
                           const double *force, double *sum) {
  double largest = 0.0;
  for (int32_t j = 0; j < matrix->members; j++) {
    uint32_t from = model->members.from[j], to = model->members.to[j];
    largest = fmax(largest, fabs(force[j]));
    for (uint32_t k = 0; k < 2; k++) {
      sum[from + k] += force[j] * matrix->direction[j][k];
      sum[to + k] -= force[j] * matrix->direction[j][k];
    }
  }
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    if (fabs(sum[at]) > ROUNDING * largest) return false;
  return true;
}

static void add_density(double *matrix, size_t n, int32_t i, int32_t k, double density) {
  if (i >= 0) matrix[(size_t)i * n + (size_t)i] += density;
  if (k >= 0) matrix[(size_t)k * n + (size_t)k] += density;
  if (i < 0 || k < 0) return;
  matrix[(size_t)i * n + (size_t)k] -= density;
  matrix[(size_t)k * n + (size_t)i] -= density;
}

/* Nodes that a member meets get a row each; with supports free coordinates are the rows. */
static void fill_matrix(const strut_model *model, const strut_equilibrium_matrix *a,
                        const double *force, bool supported, int32_t *row, double *matrix,
                        size_t n) {
  int32_t nodes = 0;
  for (int32_t j = 0; j < a->members; j++) {
    uint32_t from = model->members.from[j], to = model->members.to[j];
    double density = a->length[j] > 0 ? force[j] / a->length[j] : 0.0;
    if (supported) {
      for (uint32_t k = 0; k < 2; k++)
        add_density(matrix, n, a->row_of[from + k], a->row_of[to + k], density);
      continue;
    }
    if (row[from / 2] < 0) row[from / 2] = nodes++;
    if (row[to / 2] < 0) row[to / 2] = nodes++;
    add_density(matrix, n, row[from / 2], row[to / 2], density);
  }
}

/* Is there a symmetric Q with u' Q u = 0 for all members that carry force? */
static bool lies_on_conic(const strut_equilibrium_matrix *matrix) {
  double gram[9] = {0}, value[3], vector[9];
  for (int32_t j = 0; j < matrix->members; j++) {
    if (matrix->curved[j] >= 0) continue;
    double x = matrix->direction[j][0], y = matrix->direction[j][1],
           row[3] = {x * x, 2 * x * y, y * y};
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) gram[3 * i + k] += row[i] * row[k];
  }
  return !strut_symmetric_eigen(gram, 3, value, vector) || value[0] <= ROUNDING * value[2];
}

static int32_t count_nodes(const strut_model *model, int32_t *row) {
  int32_t nodes = 0;
  for (int32_t j = 0; j < model->members.count; j++) {
    uint32_t end[2] = {model->members.from[j] / 2, model->members.to[j] / 2};
    for (int k = 0; k < 2; k++)
      if (row[end[k]] < 0) row[end[k]] = nodes++;
  }
  for (int32_t i = 0; i < model->node_count; i++) row[i] = -1;
  return nodes;
}

/* Densities may cancel at every node: eigenvalues are small beside them, not beside themselves. */
static void judge(const strut_equilibrium_matrix *matrix, const double *force,
                  strut_stress_matrix *stress) {
  double largest = 0.0;
  for (int32_t j = 0; j < matrix->members; j++)
    if (matrix->length[j] > 0) largest = fmax(largest, fabs(force[j]) / matrix->length[j]);
  stress->positive = largest > 0;
  for (int32_t i = 0; i < stress->count; i++) {
    if (fabs(stress->eigenvalues[i]) <= ROUNDING * largest) stress->nullity++;
    if (stress->eigenvalues[i] < -ROUNDING * largest) stress->positive = false;
  }
  bool least = stress->supported ? stress->nullity == 0 : stress->nullity == 3;
  stress->super_stable = stress->positive && least && (stress->supported || !stress->on_conic);
}

/* Does a running cable or a hinge carry a part of the forces? Its energy is no quadratic form. */
static bool are_elements_loaded(const strut_equilibrium_matrix *matrix, const double *force) {
  double largest = strut_largest_magnitude(force, matrix->columns);
  for (int32_t j = 0; j < matrix->columns; j++)
    if (matrix->curved[j] >= 0 && fabs(force[j]) > ROUNDING * largest) return true;
  return false;
}

strut_status strut_stress_matrix_judge(const strut_model *model, const strut_equilibrium_matrix *a,
                                       const double *force, strut_arena *arena,
                                       strut_stress_matrix *stress) {
  *stress = (strut_stress_matrix){0};
  stress->by_elements = are_elements_loaded(a, force);
  if (model->node_count > STRUT_DENSE_STRESS || stress->by_elements) return STRUT_OK;
  strut_arena scratch = {0};
  strut_status status = STRUT_NO_MEMORY;
  size_t most = (size_t)model->length;
  double *sum, *matrix, *vector;
  int32_t *row = strut_arena_allocate(&scratch, most, sizeof *row);
  if (row && STRUT_NUMBERS(&scratch, most, &sum) &&
      STRUT_NUMBERS(&scratch, most * most, &matrix, &vector) &&
      STRUT_NUMBERS(arena, most, &stress->eigenvalues)) {
    for (int32_t i = 0; i < model->node_count; i++) row[i] = -1;
    stress->supported = !balances_alone(model, a, force, sum);
    stress->count = stress->supported ? a->rows : count_nodes(model, row);
    fill_matrix(model, a, force, stress->supported, row, matrix, (size_t)stress->count);
    stress->on_conic = lies_on_conic(a);
    if (strut_symmetric_eigen(matrix, (size_t)stress->count, stress->eigenvalues, vector)) {
      stress->tested = true;
      judge(a, force, stress);
      status = STRUT_OK;
    }
  }
  strut_arena_free(&scratch);
  return status;
}

static const double NOTHING = 1e-9, PIVOT = 1e-12;

typedef strut_node_stiffness stiff;
struct strut_node_stiffness {
  size_t n;
  double *k;     /* (n, n) K, then its Cholesky factor in the lower triangle */
  double *rigid; /* (rigid_count, n) orthonormal */
  int32_t rigid_count;
  double *load; /* (3, n); (n) of them a load */
  strut_potential *potential;
  strut_arena arena;
};

/* Adds to K a contact stiffness along the ground, equal to that normal to it. */
static void hold_contacts(stiff *self, const strut_model *model, const double *positions,
                          const int32_t *row_of) {
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t i = 0; i < contacts->count; i++) {
    uint32_t at = contacts->at[i];
    const strut_contact_pose pose = strut_contact_pose_at(contacts, i, positions, NULL, -1);
    const double *t = pose.axes.tangent;
    if (!(pose.gap < 0)) continue;
    for (uint32_t a = 0; a < 2; a++)
      for (uint32_t b = 0; b < 2; b++)
        if (row_of[at + a] >= 0 && row_of[at + b] >= 0)
          self->k[(size_t)row_of[at + a] * self->n + (size_t)row_of[at + b]] +=
              contacts->entry[i].stiffness * t[a] * t[b];
  }
}

/* Finds the rigid motions without stiffness in K, as combinations, and adds stiffness against them. */
static void lift_rigid(stiff *self) {
  size_t n = self->n;
  double largest = 0.0;
  gsl_matrix_view k = gsl_matrix_view_array(self->k, n, n);
  for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(self->k[i * n + i]));
  for (size_t m = 0; m < (size_t)self->rigid_count; m++) {
    gsl_vector_view x = gsl_vector_view_array(self->rigid + m * n, n);
    gsl_vector_view image = gsl_vector_view_array(self->load + m * n, n);
    gsl_blas_dsymv(CblasLower, 1.0, &k.matrix, &x.vector, 0.0, &image.vector);
  }
  self->rigid_count = strut_rigid_motions_free((int32_t)n, NOTHING * largest, self->rigid_count,
                                               self->rigid, self->load);
  for (size_t m = 0; m < (size_t)self->rigid_count; m++) {
    gsl_vector_view x = gsl_vector_view_array(self->rigid + m * n, n);
    gsl_blas_dsyr(CblasLower, largest, &x.vector, &k.matrix);
  }
}

/* False where K is not positive definite. */
static bool factorise(stiff *self) {
  gsl_matrix_view k = gsl_matrix_view_array(self->k, self->n, self->n);
  for (size_t i = 0; i < self->n; i++) self->load[i] = self->k[i * self->n + i];
  bool good = gsl_linalg_cholesky_decomp1(&k.matrix) == 0;
  for (size_t i = 0; i < self->n && good; i++) {
    double root = self->k[i * self->n + i];
    good = root * root > PIVOT * self->load[i];
  }
  return good;
}

double strut_node_stiffness_along(stiff *self, int32_t node, const double direction[2]) {
  const int32_t *row_of = &self->potential->row_of[2 * node];
  for (size_t i = 0; i < self->n; i++) self->load[i] = 0.0;
  for (int d = 0; d < 2; d++)
    if (row_of[d] >= 0) self->load[row_of[d]] = direction[d];
  for (int32_t m = 0; m < self->rigid_count; m++) {
    const double *x = self->rigid + (size_t)m * self->n;
    double along = 0.0;
    for (int d = 0; d < 2; d++)
      if (row_of[d] >= 0) along += direction[d] * x[row_of[d]];
    for (size_t i = 0; i < self->n; i++) self->load[i] -= along * x[i];
  }
  gsl_matrix_view factor = gsl_matrix_view_array(self->k, self->n, self->n);
  gsl_vector_view load = gsl_vector_view_array(self->load, self->n);
  gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, &factor.matrix, &load.vector);
  double compliance = strut_dot(self->load, self->load, (ptrdiff_t)self->n);
  return compliance > 0.0 ? 1.0 / compliance : (double)NAN;
}

/* K at q, with its rigid motions lifted, factored; or why not. */
static strut_status fill_stiffness(stiff *self, const strut_model *model, const double *positions,
                                   const char **reason) {
  strut_sparse *matrix = strut_potential_matrix(self->potential, &self->arena);
  if (!matrix || !STRUT_NUMBERS(&self->arena, self->n * self->n, &self->k) ||
      !STRUT_NUMBERS(&self->arena, 3 * self->n, &self->rigid, &self->load))
    return STRUT_NO_MEMORY;
  strut_potential_hessian_above(self->potential, positions, -HUGE_VAL, matrix);
  for (int32_t j = 0; j < matrix->n; j++)
    for (int32_t at = matrix->start[j]; at < matrix->start[j + 1]; at++) {
      size_t r = (size_t)matrix->row[at], c = (size_t)j;
      self->k[r * self->n + c] = self->k[c * self->n + r] = matrix->value[at];
    }
  hold_contacts(self, model, positions, self->potential->row_of);
  self->rigid_count = strut_rigid_motions(self->potential, positions, NULL, self->rigid);
  lift_rigid(self);
  if (!factorise(self)) *reason = "a motion has no stiffness";
  return STRUT_OK;
}

strut_status strut_node_stiffness_create(const strut_model *model, const double *positions,
                                         stiff **to, const char **reason, strut_error *error) {
  stiff *self = strut_allocate(1, sizeof *self);
  *to = NULL;
  *reason = NULL;
  if (!self) return strut_no_memory(error, "");
  strut_status status =
      strut_potential_create(model, NULL, true, &self->arena, &self->potential, error);
  if (!status) self->n = (size_t)self->potential->n;
  if (!status && self->n == 0) *reason = "nothing can move";
  if (!status && self->n > STRUT_STIFFNESS_COORDINATES) *reason = "more than 1000 free coordinates";
  if (!status && !*reason) status = fill_stiffness(self, model, positions, reason);
  if (status == STRUT_NO_MEMORY) strut_no_memory(error, "");
  if (status || *reason)
    strut_node_stiffness_free(self);
  else
    *to = self;
  return status;
}

void strut_node_stiffness_free(stiff *self) {
  if (!self) return;
  strut_arena_free(&self->arena);
  strut_release(self);
}
