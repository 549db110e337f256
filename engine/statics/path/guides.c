/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Cables that rub at their guides, in the equations of a path that keeps friction.
 *
 * Which material lies between which guides is what the last point of the path left; what slips since then
 * follows from the tensions (capstan.h), so that forces depend on positions alone and their derivatives are
 * found by differences.
 */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/capstan.h"
#include "engine/statics/path/path_parts.h"

static const double STEP = 1e-7; /* of the size: differences */

bool strut_path_rubs(const strut_path_system *s, int32_t i) {
  return s->elements.material && strut_has_capstan(&s->model->elements.element[i]);
}

bool strut_path_guides_create(strut_path_system *s, const strut_path *after) {
  const strut_element_table *t = &s->model->elements;
  size_t slots = (size_t)s->model->members.slots;
  bool some = false;
  for (int32_t i = 0; i < t->count; i++) some = some || strut_has_capstan(&t->element[i]);
  if (!some) return true;
  s->elements.material = strut_arena_copy(&s->arena, s->model->members.rest, slots, sizeof(double));
  s->elements.guide_mode = strut_arena_allocate(&s->arena, slots, sizeof *s->elements.guide_mode);
  if (s->elements.guide_mode && after && after->guide_mode)
    memcpy(s->elements.guide_mode, after->guide_mode, slots * sizeof *after->guide_mode);
  return s->elements.material && s->elements.guide_mode;
}

bool strut_path_has_rubbing(const strut_path_system *s) { return s->elements.material; }

/* The cable at q with the numbers of some terms and the materials that the path remembers. */
static void find_in(const strut_path_system *s, const strut_path_terms *terms, int32_t i,
                    const double *q, strut_capstan_rest *rest) {
  const strut_element *e = &s->model->elements.element[i];
  size_t bytes = ((size_t)e->nodes - 1) * sizeof(double);
  memcpy(terms->rest + e->slot + 1, s->elements.material + e->slot + 1, bytes);
  strut_capstan_find_rest(terms->laws, i, terms->rest, q, rest);
}

/* How its forces on its nodes change with the parameter where these stay. */
static void find_rate(strut_path_system *s, int32_t i, double *rate) {
  const strut_path_parameter *p = &s->parameter;
  const strut_element *e = &s->model->elements.element[i];
  strut_path_terms *terms = &s->equations.terms;
  strut_capstan_rest low, high;
  double apart = p->apart, by = s->equations.rates.rest[e->base];
  memset(rate, 0, 2 * (size_t)e->nodes * sizeof *rate);
  if (p->options->over != STRUT_PATH_OVER_SCENE && by == 0.0) return;
  if (p->options->over == STRUT_PATH_OVER_SCENE) {
    find_in(s, &p->low, i, s->latest.q, &low);
    find_in(s, &p->high, i, s->latest.q, &high);
    by = 1.0;
  } else {
    double whole = terms->rest[e->base];
    apart = 2.0 * STEP * s->size;
    terms->rest[e->base] = whole - STEP * s->size;
    find_in(s, terms, i, s->latest.q, &low);
    terms->rest[e->base] = whole + STEP * s->size;
    find_in(s, terms, i, s->latest.q, &high);
    terms->rest[e->base] = whole;
  }
  for (int32_t k = 0; k < 2 * e->nodes; k++) rate[k] = by * (high.force[k] - low.force[k]) / apart;
}

void strut_path_add_rubbing(strut_path_system *s, int32_t i) {
  const strut_element *e = &s->model->elements.element[i];
  strut_force *force = strut_path_element_force(s, i);
  double rate[STRUT_MOST_GRADIENT], h = STEP * s->size;
  int32_t n = 2 * e->nodes;
  strut_capstan_rest here, low, high;
  find_in(s, &s->equations.terms, i, s->latest.q, &here);
  force->pose.force = here.tension[0];
  find_rate(s, i, rate);
  for (int32_t b = 0; b < n; b++) {
    uint32_t at = strut_force_coordinate(force, b);
    int32_t column = s->potential->row_of[at];
    double q = s->latest.q[at], moved = column < 0 ? s->equations.rates.position[at] : 0.0;
    if (column < 0 && moved == 0.0) continue;
    s->latest.q[at] = q - h;
    find_in(s, &s->equations.terms, i, s->latest.q, &low);
    s->latest.q[at] = q + h;
    find_in(s, &s->equations.terms, i, s->latest.q, &high);
    s->latest.q[at] = q;
    for (int32_t a = 0; a < n; a++) {
      int32_t row = s->potential->row_of[strut_force_coordinate(force, a)];
      double slope = (high.force[a] - low.force[a]) / (2.0 * h);
      rate[a] += slope * moved;
      if (row >= 0 && column >= 0)
        *gsl_matrix_ptr(s->algebra.hessian, (size_t)row, (size_t)column) -= slope;
    }
  }
  for (int32_t a = 0; a < n; a++) {
    int32_t row = s->potential->row_of[strut_force_coordinate(force, a)];
    s->latest.forces = fmax(s->latest.forces, fabs(here.force[a]));
    if (row >= 0) s->latest.g[row] -= here.force[a], s->latest.slope[row] -= rate[a];
  }
}

void strut_path_rubbing_reactions(const strut_path_system *s, int32_t i, double *reaction) {
  const strut_force *force = strut_path_element_force(s, i);
  strut_capstan_rest here;
  find_in(s, &s->equations.terms, i, s->latest.q, &here);
  for (int32_t k = 0; k < 2 * force->nodes; k++)
    reaction[strut_force_coordinate(force, k)] -= here.force[k];
}

/* Says where a cable begins to slip over a guide, or to stick to it. */
static void report_guide(strut_path_walk *w, int32_t i, int32_t k, int mode) {
  const strut_path_system *s = &w->system;
  const strut_scene *scene = s->model->scene;
  const strut_element *e = &s->model->elements.element[i];
  int32_t node = strut_member_node(&scene->members[e->item], (size_t)k + 1);
  char detail[300];
  snprintf(detail, sizeof detail, "%s %s %s", scene->members[e->item].name,
           mode == STRUT_GUIDE_STICKS ? "sticks to" : "slips over", scene->nodes[node].name);
  strut_path_add_event(w, mode == STRUT_GUIDE_STICKS ? STRUT_PATH_STICK : STRUT_PATH_SLIP, w->y,
                       node, w->negative, w->negative, detail);
}

void strut_path_keep_guides(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  if (!s->elements.material || !strut_path_evaluate(s, w->y)) return;
  for (int32_t i = 0; i < s->model->elements.count; i++) {
    const strut_element *e = &s->model->elements.element[i];
    strut_capstan_rest now;
    if (!strut_path_rubs(s, i) || !s->elements.element[i].acts) continue;
    find_in(s, &s->equations.terms, i, s->latest.q, &now);
    for (int32_t k = 0; k + 2 < e->nodes; k++) {
      int *mode = &s->elements.guide_mode[e->slot + 1 + k];
      if (w->path->point_count == 0) continue; /* nothing has moved yet */
      if (*mode != now.mode[k]) report_guide(w, i, k, now.mode[k]);
      *mode = now.mode[k];
    }
    memcpy(s->elements.material + e->slot + 1, now.material,
           ((size_t)e->nodes - 1) * sizeof *now.material);
  }
}
