/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Cables that rub at their guides, in the equations of a path that keeps friction.
 *
 * Which material lies between which guides is what the last point of the path left; what slips since then
 * follows from the tensions (capstan.h), so that forces depend on positions alone and their derivatives are
 * found by differences.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/capstan.h"
#include "engine/statics/path/path_parts.h"

static const double STEP = 1e-7; /* of the size: differences */

bool strut_path_rubs(const strut_path_system *system, int32_t i) {
  return system->elements.material && strut_has_capstan(&system->model->elements.element[i]);
}

bool strut_path_has_rubbing(const strut_path_system *system) { return system->elements.material; }

/* The cable at the latest place with the numbers of some terms and the materials that the path remembers. */
static void find_in(const strut_path_system *system, const strut_path_terms *terms, int32_t i,
                    strut_capstan_rest *rest) {
  const strut_element *element = &system->model->elements.element[i];
  size_t bytes = ((size_t)element->nodes - 1) * sizeof(double);
  memcpy(terms->rest + element->slot + 1, system->elements.material + element->slot + 1, bytes);
  strut_capstan_find_rest(terms->laws, i, terms->rest, system->latest.q, rest);
}

/* How its forces on its nodes change with the parameter where these stay. */
static void find_rate(const strut_path_system *system, int32_t i, double *rate) {
  strut_capstan_rest low, high;
  find_in(system, &system->parameter.low, i, &low);
  find_in(system, &system->parameter.high, i, &high);
  for (int32_t k = 0; k < 2 * system->model->elements.element[i].nodes; k++)
    rate[k] = (high.force[k] - low.force[k]) / system->parameter.apart;
}

void strut_path_add_rubbing(strut_path_system *system, int32_t i) {
  const strut_element *element = &system->model->elements.element[i];
  strut_force *force = strut_path_element_force(system, i);
  double rate[STRUT_MOST_GRADIENT], h = STEP * system->size;
  int32_t n = 2 * element->nodes;
  strut_capstan_rest here, low, high;
  find_in(system, &system->equations.terms, i, &here);
  force->pose.force = here.tension[0];
  find_rate(system, i, rate);
  for (int32_t b = 0; b < n; b++) {
    uint32_t at = strut_force_coordinate(force, b);
    int32_t column = system->potential->row_of[at];
    double q = system->latest.q[at],
           moved = column < 0 ? system->equations.rates.position[at] : 0.0;
    if (column < 0 && moved == 0.0) continue;
    system->latest.q[at] = q - h;
    find_in(system, &system->equations.terms, i, &low);
    system->latest.q[at] = q + h;
    find_in(system, &system->equations.terms, i, &high);
    system->latest.q[at] = q;
    for (int32_t a = 0; a < n; a++) {
      int32_t row = system->potential->row_of[strut_force_coordinate(force, a)];
      double slope = (high.force[a] - low.force[a]) / (2.0 * h);
      rate[a] += slope * moved;
      if (row >= 0 && column >= 0)
        *gsl_matrix_ptr(system->algebra.hessian, (size_t)row, (size_t)column) -= slope;
    }
  }
  for (int32_t a = 0; a < n; a++) {
    int32_t row = system->potential->row_of[strut_force_coordinate(force, a)];
    system->latest.forces = fmax(system->latest.forces, fabs(here.force[a]));
    if (row >= 0) system->latest.g[row] -= here.force[a], system->latest.slope[row] -= rate[a];
  }
}

void strut_path_rubbing_reactions(const strut_path_system *system, int32_t i, double *reaction) {
  const strut_force *force = strut_path_element_force(system, i);
  strut_capstan_rest here;
  find_in(system, &system->equations.terms, i, &here);
  for (int32_t k = 0; k < 2 * force->nodes; k++)
    reaction[strut_force_coordinate(force, k)] -= here.force[k];
}

/* Says where a cable begins to slip over a guide, or to stick to it. */
static void report_guide(strut_path_walk *walk, int32_t i, int32_t k, int mode) {
  const strut_path_system *system = &walk->system;
  const strut_scene *scene = system->model->scene;
  const strut_element *element = &system->model->elements.element[i];
  int32_t node = strut_member_node(&scene->members[element->item], (size_t)k + 1);
  char detail[300];
  snprintf(detail, sizeof detail, "%s %s %s", scene->members[element->item].name,
           mode == STRUT_GUIDE_STICKS ? "sticks to" : "slips over", scene->nodes[node].name);
  strut_path_add_event(walk, mode == STRUT_GUIDE_STICKS ? STRUT_PATH_STICK : STRUT_PATH_SLIP,
                       walk->y, node, walk->negative, walk->negative, detail);
}

void strut_path_keep_guides(strut_path_walk *walk) {
  strut_path_system *system = &walk->system;
  if (!system->elements.material || !strut_path_evaluate(system, walk->y)) return;
  for (int32_t i = 0; i < system->model->elements.count; i++) {
    const strut_element *element = &system->model->elements.element[i];
    strut_capstan_rest now;
    if (!strut_path_rubs(system, i) || !system->elements.element[i].acts) continue;
    find_in(system, &system->equations.terms, i, &now);
    for (int32_t k = 0; k + 2 < element->nodes; k++) {
      int *mode = &system->elements.guide_mode[element->slot + 1 + k];
      if (walk->path->point_count == 0) continue; /* nothing has moved yet */
      if (*mode != now.mode[k]) report_guide(walk, i, k, now.mode[k]);
      *mode = now.mode[k];
    }
    memcpy(system->elements.material + element->slot + 1, now.material,
           ((size_t)element->nodes - 1) * sizeof *now.material);
  }
}
