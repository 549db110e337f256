/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The force density method (Schek 1974): with densities q = force / length equilibrium is linear in
 * the positions, D x = f. Where that determines no shape, the nearest pair of shape and densities.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/form/parts.h"

static const double DETERMINED = 1e-12; /* least reciprocal condition of D */
static const double SOUND = 1e-9;       /* least pivot that is no noise */
static const double BEYOND = 1e3;       /* sizes: a solution out there is none */
enum { RIGID_MOTIONS = 3 };

typedef struct density_problem {
  strut_former *f;
  double *q;     /* (members) [N/m] */
  double *x;     /* (2 nodes) [m] */
  uint8_t *held; /* (2 nodes) 1: keeps its coordinate, by a support or the ground */
} density_problem;

static strut_status read_densities(density_problem *p, strut_error *error) {
  strut_scene *scene = p->f->scene;
  double largest = 0;
  for (size_t j = 0; j < scene->member_count; j++) {
    strut_rest rest;
    const strut_member *m = &scene->members[j];
    if (!strut_member_rest(scene, j, &rest)) continue;
    bool given = m->rest_kind == STRUT_REST_FORCE_DENSITY;
    p->q[j] = given ? m->rest_value : rest.force_density;
    largest = fmax(largest, fabs(p->q[j]));
    if (m->kind == STRUT_CABLE && p->q[j] < 0)
      return strut_fail(error, STRUT_NOT_SETTLED,
                        "cable %s is given the force density %.4g N/m, but cables only pull",
                        m->name, p->q[j]);
  }
  if (largest > 0) return STRUT_OK;
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "no member has a force density: give some with force_density or pretension");
}

/* Supports, and nodes that are drawn on level ground, keep their coordinates. Their number. */
static int32_t mark_held(density_problem *p) {
  const strut_former *f = p->f;
  const strut_contact_table *c = &f->model->contacts;
  int32_t count = 0;
  for (size_t i = 0; i < f->scene->node_count; i++)
    for (size_t k = 0; k < 2; k++) {
      p->held[2 * i + k] = f->scene->nodes[i].fixed[k];
      p->x[2 * i + k] = f->scene->nodes[i].position[k];
    }
  for (int32_t i = 0; i < c->count; i++)
    if (strut_form_touches(f, i) && c->normal[0] == 0) p->held[c->at[i] + 1] = 1;
  for (size_t i = 0; i < 2 * f->scene->node_count; i++) count += p->held[i];
  return count;
}

/* D of one axis on the nodes that are free in it, and the forces on them (right). */
static strut_sparse *assemble(const density_problem *p, int axis, const int32_t *row_of, int32_t n,
                              double *right, strut_arena *arena) {
  const strut_scene *scene = p->f->scene;
  strut_triplets sum = {0};
  if (!strut_triplets_reserve(&sum, 3 * scene->member_count, arena)) return NULL;
  for (size_t i = 0; i < scene->node_count; i++)
    if (row_of[i] >= 0) right[row_of[i]] = p->f->potential->force[2 * i + (size_t)axis];
  for (size_t j = 0; j < scene->member_count; j++) {
    const int32_t *node = scene->members[j].node;
    int32_t a = row_of[node[0]], b = row_of[node[1]];
    if (a >= 0) strut_triplets_add(&sum, a, a, p->q[j]);
    if (b >= 0) strut_triplets_add(&sum, b, b, p->q[j]);
    if (a >= 0 && b >= 0) strut_triplets_add(&sum, a > b ? a : b, a > b ? b : a, -p->q[j]);
    if (a >= 0 && b < 0) right[a] += p->q[j] * p->x[2 * node[1] + axis];
    if (b >= 0 && a < 0) right[b] += p->q[j] * p->x[2 * node[0] + axis];
  }
  return strut_sparse_build(n, &sum, arena);
}

/* One axis: STRUT_SINGULAR where D determines nothing. */
static strut_status solve_axis(density_problem *p, int axis) {
  size_t nodes = p->f->scene->node_count;
  strut_arena arena = {0};
  strut_ldl *ldl = NULL;
  strut_inertia inertia;
  int32_t n = 0;
  int32_t *row_of = strut_arena_allocate(&arena, nodes, sizeof *row_of);
  double *right = strut_arena_allocate(&arena, nodes, sizeof *right);
  strut_sparse *matrix = NULL;
  for (size_t i = 0; i < nodes && row_of; i++) row_of[i] = p->held[2 * i + (size_t)axis] ? -1 : n++;
  if (row_of && right && n > 0) matrix = assemble(p, axis, row_of, n, right, &arena);
  strut_status status = !row_of || !right ? STRUT_NO_MEMORY : STRUT_OK;
  if (n > 0 && status == STRUT_OK) {
    status = matrix ? strut_ldl_create(matrix, &ldl, NULL) : STRUT_NO_MEMORY;
    if (status == STRUT_OK) status = strut_ldl_factorise(ldl, matrix, 0.0, &inertia);
    if (status == STRUT_OK && (inertia.smallest < SOUND || strut_ldl_rcond(ldl) < DETERMINED))
      status = STRUT_SINGULAR;
    if (status == STRUT_OK) strut_ldl_solve(ldl, right);
    for (size_t i = 0; i < nodes && status == STRUT_OK; i++) {
      if (row_of[i] < 0) continue;
      double x = right[row_of[i]];
      if (!(fabs(x - p->x[2 * i + (size_t)axis]) <= BEYOND * p->f->size)) status = STRUT_SINGULAR;
    }
    for (size_t i = 0; i < nodes && status == STRUT_OK; i++)
      if (row_of[i] >= 0) p->x[2 * i + (size_t)axis] = right[row_of[i]];
  }
  strut_ldl_free(ldl);
  strut_arena_free(&arena);
  return status;
}

static strut_status solve(density_problem *p, int32_t held, strut_error *error) {
  size_t nodes = p->f->scene->node_count;
  bool standing = held <= RIGID_MOTIONS;
  strut_status status = STRUT_SINGULAR;
  if (!standing) {
    status = solve_axis(p, 0);
    if (status == STRUT_OK) status = solve_axis(p, 1);
  }
  if (status == STRUT_NO_MEMORY) return strut_fail(error, status, "out of memory");
  if (status == STRUT_OK) return status;
  for (size_t i = 0; i < 2 * nodes; i++) p->x[i] = p->f->scene->nodes[i / 2].position[i % 2];
  return strut_form_nearest(p->f, p->held, standing, p->x, p->q, error);
}

static strut_status apply(density_problem *p, strut_error *error) {
  strut_scene *scene = p->f->scene;
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < scene->node_count; i++)
    for (size_t k = 0; k < 2; k++)
      scene->nodes[i].position[k] = scene->nodes[i].start[k] = p->x[2 * i + k];
  for (size_t j = 0; j < scene->member_count && status == STRUT_OK; j++) {
    const double *a = scene->nodes[scene->members[j].node[0]].position;
    const double *b = scene->nodes[scene->members[j].node[1]].position;
    double force = p->q[j] * strut_distance(a, b);
    if (scene->members[j].kind == STRUT_CABLE && force < 0)
      return strut_fail(error, STRUT_NOT_SETTLED,
                        "the nearest densities in equilibrium make cable %s push (%.4g N/m); "
                        "--from prestress keeps the drawn shape instead",
                        scene->members[j].name, p->q[j]);
    status = strut_form_set_force(p->f, j, force, error);
  }
  return status;
}

strut_status strut_form_densities(strut_former *f, strut_error *error) {
  size_t nodes = f->scene->node_count, members = f->scene->member_count;
  density_problem p = {.f = f,
                       .q = strut_arena_allocate(&f->arena, members, sizeof(double)),
                       .x = strut_arena_allocate(&f->arena, 2 * nodes, sizeof(double)),
                       .held = strut_arena_allocate(&f->arena, 2 * nodes, 1)};
  double *given = strut_arena_allocate(&f->arena, members, sizeof *given);
  if (!p.q || !p.x || !p.held || !given) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  strut_status status = read_densities(&p, error);
  if (status) return status;
  memcpy(given, p.q, members * sizeof *given);
  status = solve(&p, mark_held(&p), error);
  double largest = 0, change = 0;
  for (size_t j = 0; j < members; j++) {
    largest = fmax(largest, fabs(given[j]));
    change = fmax(change, fabs(p.q[j] - given[j]));
  }
  f->form->density_change = change / largest;
  return status == STRUT_OK ? apply(&p, error) : status;
}
