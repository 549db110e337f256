/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cell of a structure that repeats: its nodes among those of its neighbours, and its equilibrium. */
#include <float.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/curvature.h"
#include "engine/statics/modes/parts.h"

static const double SAME_PLACE = 1e-6; /* distance, in shorter steps of the lattice */
static const double FARTHEST = 1e6;    /* steps between nodes of one cell */

/* ---- nodes ---- */

/* Whole steps from point a to point b; false where they lie otherwise. */
static bool steps_between(const strut_scene *scene, const double a[2], const double b[2],
                          int32_t steps[2]) {
  const double(*s)[2] = scene->lattice, d[2] = {b[0] - a[0], b[1] - a[1]};
  double count[2] = {0.0, 0.0}, shorter = hypot(s[0][0], s[0][1]);
  if (scene->lattice_count == 2) {
    double area = s[0][0] * s[1][1] - s[0][1] * s[1][0];
    count[0] = (d[0] * s[1][1] - d[1] * s[1][0]) / area;
    count[1] = (s[0][0] * d[1] - s[0][1] * d[0]) / area;
    shorter = fmin(shorter, hypot(s[1][0], s[1][1]));
  } else {
    count[0] = (d[0] * s[0][0] + d[1] * s[0][1]) / (shorter * shorter);
  }
  if (!(fabs(count[0]) < FARTHEST && fabs(count[1]) < FARTHEST)) return false;
  double left[2] = {d[0], d[1]};
  for (int k = 0; k < scene->lattice_count; k++) {
    steps[k] = (int32_t)lround(count[k]);
    for (int c = 0; c < 2; c++) left[c] -= steps[k] * s[k][c];
  }
  return hypot(left[0], left[1]) <= SAME_PLACE * shorter;
}

/* Finds the first node that node i repeats, and whether a second one in the same place could be meant. */
static strut_status find_owner(strut_lattice_cell *cell, int32_t i, strut_error *error) {
  const strut_scene *scene = cell->model->scene;
  int32_t steps[2] = {0, 0};
  cell->owner[i] = i;
  for (int32_t k = 0; k < i; k++) {
    if (cell->owner[k] != k ||
        !steps_between(scene, scene->nodes[k].position, scene->nodes[i].position, steps))
      continue;
    if (steps[0] == 0 && steps[1] == 0) continue; /* two nodes in one place */
    if (cell->owner[i] != i)
      return strut_fail(
          error, STRUT_BAD_SCENE,
          "--wave: node '%s' lies whole steps of the lattice from both '%s' and '%s', which "
          "are drawn in one place, so it is not clear whose image it is; draw one of "
          "them elsewhere in the cell",
          scene->nodes[i].name, scene->nodes[cell->owner[i]].name, scene->nodes[k].name);
    cell->owner[i] = k;
    memcpy(cell->shift[i], steps, sizeof steps);
    cell->images++;
  }
  return STRUT_OK;
}

/* Does every step of the lattice lead from some node to another? */
static strut_status check_steps(const strut_lattice_cell *cell, strut_error *error) {
  const strut_scene *scene = cell->model->scene;
  for (int k = 0; k < scene->lattice_count; k++) {
    bool used = false;
    for (int32_t i = 0; i < cell->model->node_count; i++) used = used || cell->shift[i][k] != 0;
    if (!used)
      return strut_fail(
          error, STRUT_BAD_SCENE,
          "--wave: no node lies a step [%g m, %g m] of the lattice from another one, so "
          "nothing ties the cell to the next; draw the nodes of the next cell at which "
          "members of this one end",
          scene->lattice[k][0], scene->lattice[k][1]);
  }
  return STRUT_OK;
}

/* A coordinate is held where that of any image is. */
static void number_rows(strut_lattice_cell *cell) {
  const strut_scene *scene = cell->model->scene;
  int32_t nodes = cell->model->node_count;
  memset(cell->row, 0, (size_t)cell->model->length * sizeof *cell->row);
  for (int32_t i = 0; i < nodes; i++)
    for (int32_t c = 0; c < 2; c++)
      if (scene->nodes[i].fixed[c]) cell->row[2 * cell->owner[i] + c] = -1;
  for (int32_t i = 0; i < 2 * nodes; i++) {
    if (cell->owner[i / 2] != i / 2 || cell->row[i] < 0) continue;
    cell->first[cell->n] = i;
    cell->row[i] = cell->n++;
  }
  for (int32_t i = 0; i < 2 * nodes; i++) cell->row[i] = cell->row[2 * cell->owner[i / 2] + i % 2];
}

strut_status strut_lattice_cell_create(const strut_model *model, strut_arena *arena,
                                       strut_lattice_cell *cell, strut_error *error) {
  size_t nodes = (size_t)model->node_count, length = (size_t)model->length;
  *cell = (strut_lattice_cell){
      .model = model,
      .owner = strut_arena_allocate(arena, nodes, sizeof *cell->owner),
      .shift = strut_arena_allocate(arena, nodes, sizeof *cell->shift),
      .row = strut_arena_allocate(arena, length, sizeof *cell->row),
      .first = strut_arena_allocate(arena, length, sizeof *cell->first),
  };
  if (!cell->owner || !cell->shift || !cell->row || !cell->first) return strut_no_memory(error, "");
  if (model->scene->lattice_count == 0)
    return strut_fail(error, STRUT_USAGE,
                      "--wave needs 'lattice' in the scene, the steps by which the structure "
                      "repeats, such as lattice: [[100 mm, 0]]");
  strut_status status = STRUT_OK;
  for (int32_t i = 0; i < model->node_count && status == STRUT_OK; i++)
    status = find_owner(cell, i, error);
  if (status == STRUT_OK) status = check_steps(cell, error);
  if (status != STRUT_OK) return status;
  number_rows(cell);
  if (cell->n == 0)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "--wave: no node is free to move, so there are no waves");
  if (cell->n > STRUT_MOST_BANDS)
    return strut_fail(
        error, STRUT_BAD_SCENE,
        "--wave: the cell has %d coordinates; waves are computed for at most %d. Choose the "
        "smallest part of the structure that repeats",
        (int)cell->n, (int)STRUT_MOST_BANDS);
  return STRUT_OK;
}

/* ---- equilibrium ---- */

enum { MOST_TRIALS = 300 };

/* Newton's method within a trust region, over the coordinates of the cell. */
typedef struct descent {
  const strut_lattice_cell *cell;
  strut_potential *potential;
  strut_sparse *hessian;
  gsl_matrix *matrix, *vectors;
  gsl_vector *values;
  gsl_eigen_symmv_workspace *workspace;
  double *force;                   /* (length) [N] */
  double *gradient, *part, *share; /* (n) */
  uint8_t *idle;                   /* (n) */
  double *trial;                   /* (length) [m] */
  double largest;                  /* of the gradient [N] */
  double noise;                    /* of the gradient, by rounding [N] */
  strut_arena arena;
} descent;

static bool allocate(descent *d) {
  size_t n = (size_t)d->cell->n, length = (size_t)d->cell->model->length;
  d->hessian = strut_potential_matrix(d->potential, &d->arena);
  d->force = strut_arena_allocate(&d->arena, length, sizeof(double));
  d->trial = strut_arena_allocate(&d->arena, length, sizeof(double));
  d->gradient = strut_arena_allocate(&d->arena, n, sizeof(double));
  d->part = strut_arena_allocate(&d->arena, n, sizeof(double));
  d->share = strut_arena_allocate(&d->arena, n, sizeof(double));
  d->idle = strut_arena_allocate(&d->arena, n, 1);
  d->matrix = gsl_matrix_alloc(n, n);
  d->vectors = gsl_matrix_alloc(n, n);
  d->values = gsl_vector_alloc(n);
  d->workspace = gsl_eigen_symmv_alloc(n);
  return d->hessian && d->force && d->trial && d->gradient && d->part && d->share && d->idle &&
         d->matrix && d->vectors && d->values && d->workspace;
}

static void release(descent *d) {
  if (d->matrix) gsl_matrix_free(d->matrix);
  if (d->vectors) gsl_matrix_free(d->vectors);
  if (d->values) gsl_vector_free(d->values);
  if (d->workspace) gsl_eigen_symmv_free(d->workspace);
  strut_potential_free(d->potential);
  strut_arena_free(&d->arena);
}

/* The gradient at q; returns its largest entry. */
static double evaluate(descent *d, const double *q) {
  const strut_lattice_cell *cell = d->cell;
  double largest = 0.0;
  strut_potential_force(d->potential, q, d->force);
  memset(d->gradient, 0, (size_t)cell->n * sizeof(double));
  for (int32_t i = 0; i < cell->model->length; i++)
    if (cell->row[i] >= 0) d->gradient[cell->row[i]] -= d->force[i];
  for (int32_t r = 0; r < cell->n; r++)
    if (!(fabs(d->gradient[r]) <= largest)) largest = fabs(d->gradient[r]);
  return largest;
}

/* Eigenvalues of the cell's stiffness at q, and the gradient's share of each eigenvector. */
static bool decompose(descent *d, const double *q, strut_quadratic *quadratic) {
  const strut_lattice_cell *cell = d->cell;
  const strut_sparse *h = d->hessian;
  size_t n = (size_t)cell->n;
  strut_potential_hessian(d->potential, q, d->hessian);
  gsl_matrix_set_zero(d->matrix);
  for (int32_t j = 0; j < h->n; j++)
    for (int32_t at = h->start[j]; at < h->start[j + 1]; at++) {
      int32_t a = cell->row[d->potential->coordinate[h->row[at]]];
      int32_t b = cell->row[d->potential->coordinate[j]];
      if (a < 0 || b < 0) continue;
      *gsl_matrix_ptr(d->matrix, (size_t)a, (size_t)b) += h->value[at];
      if (h->row[at] != j) *gsl_matrix_ptr(d->matrix, (size_t)b, (size_t)a) += h->value[at];
    }
  for (size_t i = 0; i < n * n; i++)
    if (!isfinite(d->matrix->data[i])) return false;
  if (gsl_eigen_symmv(d->matrix, d->values, d->vectors, d->workspace)) return false;
  double scale = 0.0;
  for (size_t i = 0; i < n; i++) scale = fmax(scale, fabs(gsl_vector_get(d->values, i)));
  for (size_t i = 0; i < n; i++) {
    d->part[i] = 0.0;
    for (size_t k = 0; k < n; k++) d->part[i] += gsl_matrix_get(d->vectors, k, i) * d->gradient[k];
    d->idle[i] = fabs(gsl_vector_get(d->values, i)) <= 1e-11 * scale &&
                 fabs(d->part[i]) <= (double)n * d->noise;
  }
  *quadratic = (strut_quadratic){cell->n, d->values->data, d->part, d->idle, scale, 1e-12 * scale};
  return true;
}

/* The trial shape after the shares of each eigenvector; returns what the model says it releases [J]. */
static double move(descent *d, const strut_quadratic *quadratic, const double *q) {
  const strut_lattice_cell *cell = d->cell;
  double reduction = 0.0;
  memcpy(d->trial, q, (size_t)cell->model->length * sizeof *q);
  for (int32_t i = 0; i < cell->n; i++)
    reduction -= d->share[i] * (d->part[i] + 0.5 * quadratic->value[i] * d->share[i]);
  for (int32_t k = 0; k < cell->model->length; k++)
    for (int32_t i = 0; i < cell->n && cell->row[k] >= 0; i++)
      d->trial[k] += d->share[i] * gsl_matrix_get(d->vectors, (size_t)cell->row[k], (size_t)i);
  return reduction;
}

static strut_status descend(descent *d, const strut_experiment *experiment, double *q,
                            strut_error *error) {
  const double(*step)[2] = d->cell->model->scene->lattice;
  double radius = 0.1 * hypot(step[0][0], step[0][1]),
         energy = strut_potential_value(d->potential, q);
  strut_quadratic quadratic = {0};
  bool fresh = true;
  d->largest = evaluate(d, q);
  for (int trial = 0; trial < MOST_TRIALS && !strut_experiment_interrupted(experiment); trial++) {
    d->noise = 16.0 * strut_potential_rounding(d->potential, q);
    if (d->largest <= d->noise) return STRUT_OK;
    if (fresh && !decompose(d, q, &quadratic)) break;
    strut_trust_step(&quadratic, radius, d->share);
    double hoped = move(d, &quadratic, q), before = d->largest;
    double released = energy - strut_potential_value(d->potential, d->trial);
    double largest = evaluate(d, d->trial);
    fresh = released > 1e-3 * hoped ||
            largest < 0.5 * before; /* where energies only differ by rounding */
    radius *= released > 0.5 * hoped || (fresh && largest < 0.5 * before) ? 2.0
              : fresh                                                     ? 1.0
                                                                          : 0.25;
    if (fresh) {
      memcpy(q, d->trial, (size_t)d->cell->model->length * sizeof *q);
      energy -= released;
      d->largest = largest;
    } else {
      evaluate(d, q);
    }
  }
  if (strut_experiment_interrupted(experiment))
    return strut_experiment_end(experiment, STRUT_OK, error);
  int32_t worst = 0;
  for (int32_t r = 0; r < d->cell->n; r++)
    if (fabs(d->gradient[r]) > fabs(d->gradient[worst])) worst = r;
  return strut_fail(
      error, STRUT_NOT_SETTLED,
      "the repeated structure finds no equilibrium near this shape: a force of %.3g N "
      "stays on node '%s'. Draw the cell in equilibrium among its neighbours, or hold "
      "what loads move",
      fabs(d->gradient[worst]), d->cell->model->scene->nodes[d->cell->first[worst] / 2].name);
}

strut_status strut_lattice_cell_settle(const strut_lattice_cell *cell,
                                       const strut_experiment *experiment, double *q,
                                       double *residual, strut_error *error) {
  const strut_scene *scene = cell->model->scene;
  descent d = {.cell = cell};
  for (int32_t i = 0; i < cell->model->length;
       i++) { /* images lie whole steps away, to all digits */
    int32_t owner = cell->owner[i / 2];
    if (owner == i / 2) continue;
    q[i] = q[2 * owner + i % 2];
    for (int k = 0; k < scene->lattice_count; k++)
      q[i] += cell->shift[i / 2][k] * scene->lattice[k][i % 2];
  }
  strut_status status = strut_potential_create(cell->model, NULL, false, &d.potential, error);
  if (status == STRUT_OK && !allocate(&d)) status = strut_no_memory(error, "");
  if (status == STRUT_OK) status = descend(&d, experiment, q, error);
  *residual = d.largest;
  release(&d);
  return status;
}
