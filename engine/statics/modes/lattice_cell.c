/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cell of a structure that repeats: its nodes among those of its neighbours, and its equilibrium. */
#include <math.h>
#include <string.h>

#include "engine/statics/minimise.h"
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

static const double MOST_LEFT = 16.0; /* force that rounding may leave, over the least */

static strut_status not_found(const strut_lattice_cell *cell, const double *gradient,
                              strut_error *error) {
  int32_t worst = 0;
  for (int32_t r = 0; r < cell->n; r++)
    if (fabs(gradient[r]) > fabs(gradient[worst])) worst = r;
  return strut_fail(
      error, STRUT_NOT_SETTLED,
      "the repeated structure finds no equilibrium near this shape: a force of %.3g N "
      "stays on node '%s'. Draw the cell in equilibrium among its neighbours, or hold "
      "what loads move",
      fabs(gradient[worst]), cell->model->scene->nodes[cell->first[worst] / 2].name);
}

/* Images lie whole steps away, to all digits. */
static void place_images(const strut_lattice_cell *cell, double *q) {
  const strut_scene *scene = cell->model->scene;
  for (int32_t i = 0; i < cell->model->length; i++) {
    int32_t owner = cell->owner[i / 2];
    if (owner == i / 2) continue;
    q[i] = q[2 * owner + i % 2];
    for (int k = 0; k < scene->lattice_count; k++)
      q[i] += cell->shift[i / 2][k] * scene->lattice[k][i % 2];
  }
}

strut_status strut_lattice_cell_settle(const strut_lattice_cell *cell,
                                       const strut_experiment *experiment, double *q,
                                       double *residual, strut_error *error) {
  strut_potential *potential = NULL;
  strut_minimiser *minimiser = NULL;
  double *gradient = strut_allocate((size_t)cell->n, sizeof *gradient);
  strut_status status =
      gradient ? strut_potential_create_tied(cell->model, cell->row, cell->n, &potential, error)
               : strut_no_memory(error, "");
  if (status == STRUT_OK) status = strut_minimiser_create(potential, &minimiser, error);
  if (status == STRUT_OK) {
    strut_minimiser_watch(minimiser, experiment->interrupt);
    strut_minimiser_stay(minimiser);
    place_images(cell, q);
    strut_descent descent = strut_minimise(minimiser, q, 0.0);
    *residual = descent.residual;
    status = strut_experiment_end(experiment, status, error);
    strut_potential_gradient(potential, q, gradient);
    if (status == STRUT_OK && !(descent.residual <= MOST_LEFT * descent.rounding))
      status = not_found(cell, gradient, error);
  }
  strut_minimiser_free(minimiser);
  strut_potential_free(potential);
  strut_release(gradient);
  return status;
}
