/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/stress_matrix.h"

#include <math.h>

#include "engine/statics/dense_algebra.h"

/* Eigenvalues and sums this small beside the largest are rounding. */
static const double ROUNDING = 1e-9;

/* Motion of a node of a member along x or y; 0 where held. */
static double moved(const strut_equilibrium_matrix *a, const double *motion, uint32_t at) {
  int32_t row = a->row_of[at];
  return row < 0 ? 0.0 : motion[row];
}

/* x' bend y of a running cable or a hinge. */
static double bend_form(const strut_model *model, const strut_equilibrium_matrix *a, int32_t j,
                        const double *x, const double *y) {
  const strut_element *e = &model->elements.element[a->curved[j]];
  const uint32_t *at = model->elements.at + e->first;
  int32_t n = 2 * e->nodes;
  double sum = 0.0;
  for (int32_t r = 0; r < n; r++) {
    double left = moved(a, x, at[r / 2] + (uint32_t)(r % 2));
    for (int32_t c = 0; c < n && left != 0.0; c++)
      sum += left * a->bend[j][r * n + c] * moved(a, y, at[c / 2] + (uint32_t)(c % 2));
  }
  return sum;
}

double strut_stress_form(const strut_model *model, const strut_equilibrium_matrix *a,
                         const double *density, const double *x, const double *y) {
  double sum = 0.0;
  for (int32_t j = 0; j < a->columns; j++) {
    if (density[j] == 0.0) continue;
    if (a->curved[j] >= 0) {
      sum += density[j] * bend_form(model, a, j, x, y);
      continue;
    }
    uint32_t from = model->members.from[j], to = model->members.to[j];
    double dx = moved(a, x, to) - moved(a, x, from);
    double dy = moved(a, x, to + 1) - moved(a, x, from + 1);
    double ex = moved(a, y, to) - moved(a, y, from);
    double ey = moved(a, y, to + 1) - moved(a, y, from + 1);
    sum += density[j] * (dx * ex + dy * ey);
  }
  return sum;
}

void strut_stress_form_on(const strut_model *model, const strut_equilibrium_matrix *a,
                          const double *density, const double *motion, int32_t count,
                          double *form) {
  size_t n = (size_t)count, rows = (size_t)a->rows;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++)
      form[i * n + k] = form[k * n + i] =
          strut_stress_form(model, a, density, motion + i * rows, motion + k * rows);
}

/* Do the densities balance at every node, held ones too? Then supports have nothing to carry. */
static bool balances_alone(const strut_model *model, const strut_equilibrium_matrix *a,
                           const double *force, double *sum) {
  double largest = 0.0;
  for (int32_t j = 0; j < a->members; j++) {
    uint32_t from = model->members.from[j], to = model->members.to[j];
    largest = fmax(largest, fabs(force[j]));
    for (uint32_t k = 0; k < 2; k++) {
      sum[from + k] += force[j] * a->direction[j][k];
      sum[to + k] -= force[j] * a->direction[j][k];
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
static void fill(const strut_model *model, const strut_equilibrium_matrix *a, const double *force,
                 bool supported, int32_t *row, double *matrix, size_t n) {
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
static bool lies_on_conic(const strut_equilibrium_matrix *a) {
  double gram[9] = {0}, value[3], vector[9];
  for (int32_t j = 0; j < a->members; j++) {
    if (a->curved[j] >= 0) continue;
    double x = a->direction[j][0], y = a->direction[j][1], row[3] = {x * x, 2 * x * y, y * y};
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
static void judge(const strut_equilibrium_matrix *a, const double *force,
                  strut_stress_matrix *stress) {
  double largest = 0.0;
  for (int32_t j = 0; j < a->members; j++)
    if (a->length[j] > 0) largest = fmax(largest, fabs(force[j]) / a->length[j]);
  stress->positive = largest > 0;
  for (int32_t i = 0; i < stress->count; i++) {
    if (fabs(stress->eigenvalues[i]) <= ROUNDING * largest) stress->nullity++;
    if (stress->eigenvalues[i] < -ROUNDING * largest) stress->positive = false;
  }
  bool least = stress->supported ? stress->nullity == 0 : stress->nullity == 3;
  stress->super_stable = stress->positive && least && (stress->supported || !stress->on_conic);
}

/* Does a running cable or a hinge carry a part of the forces? Its energy is no quadratic form. */
static bool are_elements_loaded(const strut_equilibrium_matrix *a, const double *force) {
  double largest = 0.0;
  for (int32_t j = 0; j < a->columns; j++) largest = fmax(largest, fabs(force[j]));
  for (int32_t j = 0; j < a->columns; j++)
    if (a->curved[j] >= 0 && fabs(force[j]) > ROUNDING * largest) return true;
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
  double *sum = strut_arena_allocate(&scratch, most, sizeof *sum);
  int32_t *row = strut_arena_allocate(&scratch, most, sizeof *row);
  double *matrix = strut_arena_allocate(&scratch, most * most, sizeof *matrix);
  double *vector = strut_arena_allocate(&scratch, most * most, sizeof *vector);
  stress->eigenvalues = strut_arena_allocate(arena, most, sizeof(double));
  if (sum && row && matrix && vector && stress->eigenvalues) {
    for (int32_t i = 0; i < model->node_count; i++) row[i] = -1;
    stress->supported = !balances_alone(model, a, force, sum);
    stress->count = stress->supported ? a->rows : count_nodes(model, row);
    fill(model, a, force, stress->supported, row, matrix, (size_t)stress->count);
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
