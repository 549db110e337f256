/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/form/parts.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/equilibria/equilibria_parts.h"

/*
 * Weighted least squares under equations and lower bounds, by an active set. Steps are taken in the
 * null space of the equations, from a point that satisfies everything.
 */

enum { ROUNDS = 1000 };

static const double CUT = 1e-11;  /* of the largest singular value */
static const double ZERO = 1e-12; /* of a step, of a multiplier */

/* Columns that A maps to nothing: (count, k); NULL: out of memory. */
static gsl_matrix *null_space(int32_t rows, int32_t count, const double *equations,
                              strut_arena *arena) {
  size_t n = (size_t)count, m = (size_t)rows, tall = m > n ? m : n, k = 0;
  gsl_matrix *a = strut_arena_matrix(arena, tall, n), *v = strut_arena_matrix(arena, n, n);
  gsl_vector *s = strut_arena_vector(arena, n), *w = strut_arena_vector(arena, n);
  if (!a || !v || !s || !w) return NULL;
  for (size_t i = 0; i < m; i++)
    for (size_t j = 0; j < n; j++) gsl_matrix_set(a, i, j, equations[i * n + j]);
  gsl_linalg_SV_decomp(a, v, s, w);
  while (k < n && gsl_vector_get(s, k) > CUT * gsl_vector_get(s, 0)) k++;
  gsl_matrix *basis = strut_arena_matrix(arena, n, n - k);
  for (size_t i = 0; i < n && basis; i++)
    for (size_t j = k; j < n; j++) gsl_matrix_set(basis, i, j - k, gsl_matrix_get(v, i, j));
  return basis;
}

typedef struct problem {
  size_t count, free; /* unknowns; columns of the basis in use */
  const gsl_matrix *basis;
  const double *weight, *low;
  double *x;
  uint8_t *active;
  gsl_matrix *system;
  gsl_vector *right, *solution;
  gsl_permutation *order;
} problem;

/* The step (free) to the least sum with the active bounds kept, and their multipliers behind it. */
static size_t find_step(problem *p) {
  size_t size = p->free;
  gsl_matrix_set_zero(p->system);
  gsl_vector_set_zero(p->right);
  for (size_t i = 0; i < p->count; i++) {
    double square = p->weight[i] * p->weight[i];
    for (size_t a = 0; a < p->free; a++) {
      double za = gsl_matrix_get(p->basis, i, a);
      *gsl_vector_ptr(p->right, a) -= square * p->x[i] * za;
      for (size_t b = 0; b < p->free; b++)
        *gsl_matrix_ptr(p->system, a, b) += square * za * gsl_matrix_get(p->basis, i, b);
    }
    if (!p->active[i]) continue;
    for (size_t a = 0; a < p->free; a++) {
      gsl_matrix_set(p->system, a, size, gsl_matrix_get(p->basis, i, a));
      gsl_matrix_set(p->system, size, a, gsl_matrix_get(p->basis, i, a));
    }
    size++;
  }
  return size;
}

static bool solve_step(problem *p, size_t size) {
  gsl_matrix_view a = gsl_matrix_submatrix(p->system, 0, 0, size, size);
  gsl_vector_view b = gsl_vector_subvector(p->right, 0, size);
  gsl_vector_view x = gsl_vector_subvector(p->solution, 0, size);
  gsl_permutation order = {size, p->order->data};
  return strut_solve_rows(&a.matrix, &b.vector, &order, &x.vector);
}

static double step_component(const problem *p, size_t i) {
  double sum = 0;
  for (size_t a = 0; a < p->free; a++)
    sum += gsl_matrix_get(p->basis, i, a) * gsl_vector_get(p->solution, a);
  return sum;
}

/*
 * Steps as far as the bounds allow; a bound that stops the step becomes active. True: nothing
 * moved.
 */
static bool advance_to_bound(problem *p) {
  double share = 1, most = 0, scale = 0;
  size_t stop = p->count;
  for (size_t i = 0; i < p->count; i++) {
    double step = step_component(p, i), room = p->low[i] - p->x[i];
    most = fmax(most, fabs(step)), scale = fmax(scale, fabs(p->x[i]));
    if (p->active[i] || !(step < 0) || !isfinite(room)) continue;
    if (room / step < share) share = fmax(room / step, 0), stop = i;
  }
  for (size_t i = 0; i < p->count; i++) p->x[i] += share * step_component(p, i);
  if (stop < p->count) p->active[stop] = 1, p->x[stop] = p->low[stop];
  return stop == p->count && most <= ZERO * scale;
}

/* Releases the active bound with the worst multiplier; false if all signs are right. */
static bool release_bound(problem *p) {
  size_t at = p->free, worst = p->count;
  double least = 0, scale = 0;
  for (size_t i = 0; i < p->count; i++) {
    if (!p->active[i]) continue;
    double multiplier = gsl_vector_get(p->solution, at++);
    scale = fmax(scale, fabs(multiplier));
    if (multiplier > least) least = multiplier, worst = i;
  }
  if (worst == p->count || least <= ZERO * scale) return false;
  p->active[worst] = 0;
  return true;
}

bool strut_bounded_squares(int32_t rows, int32_t count, const double *equations,
                           const double *weight, const double *low, double *x) {
  size_t n = (size_t)count;
  strut_arena arena = {0};
  gsl_matrix *basis = null_space(rows, count, equations, &arena);
  problem p = {.count = n,
               .free = basis ? basis->size2 : 0,
               .basis = basis,
               .weight = weight,
               .low = low,
               .x = x};
  size_t room = p.free + n + 1;
  p.active = strut_arena_allocate(&arena, n, 1);
  p.system = strut_arena_matrix(&arena, room, room);
  p.right = strut_arena_vector(&arena, room);
  p.solution = strut_arena_vector(&arena, room);
  p.order = strut_arena_order(&arena, room);
  bool good = basis && p.active && p.system && p.right && p.solution && p.order;
  for (int k = 0; k < ROUNDS && good && p.free > 0; k++) {
    if (!solve_step(&p, find_step(&p))) break;
    if (advance_to_bound(&p) && !release_bound(&p)) break;
  }
  strut_arena_free(&arena);
  return good;
}

/*
 * Forces that hold the drawn shape: unknown are the members' forces, tension p and compression m
 * apart, the ground's pushes, the largest magnitude z, and what is missing at each coordinate.
 */

enum { PASSES = 6 };

static const double SUNK = 1e-15;   /* of the size: deeper is another pass */
static const double SHARE = 0.01;   /* of weight or stiffness: least tension where none is asked */
static const double MISSING = 1e-8; /* of the forces: what rounding may leave */
static const double SLACKEN = 1e-9; /* of z, so that its least value stays within reach */

/* Columns of the programme: tensions, compressions, pushes, z, missing up, missing down. */
typedef struct columns {
  int32_t members, contacts, n;
  int32_t pull, push, ground, most, up, down, count;
} columns;

typedef struct prestress {
  strut_former *f;
  columns at;
  strut_linear_program program;
  double scale; /* [N] of one in the programme */
  double least; /* tension of a cable [N] */
  double *x;
} prestress;

static bool can_carry(const strut_member *m) { return m->stiffness > 0 || m->axial_stiffness > 0; }

static double least_tension(const strut_former *f) {
  double least = HUGE_VAL;
  if (f->options->least_tension > 0 || f->options->least_density > 0)
    return f->options->least_tension;
  if (f->potential->force_scale > 0) return SHARE * f->potential->force_scale;
  for (int32_t j = 0; j < f->model->members.count; j++) {
    strut_rest rest;
    if (f->scene->members[j].kind != STRUT_CABLE) continue;
    if (!strut_member_rest(f->scene, (size_t)j, &rest) || !(rest.stiffness > 0)) continue;
    least = fmin(least, SHARE * rest.stiffness * rest.drawn_length);
  }
  return isfinite(least) ? least : 0.0;
}

static columns number_columns(const strut_former *f) {
  columns at = {.members = f->model->members.count,
                .contacts = f->model->contacts.count,
                .n = f->potential->n};
  at.pull = 0, at.push = at.members, at.ground = 2 * at.members;
  at.most = at.ground + at.contacts, at.up = at.most + 1;
  at.down = at.up + at.n, at.count = at.down + at.n;
  return at;
}

/* Net force on each free coordinate = 0; then p + m <= z for each member. */
static void fill_rows(prestress *p) {
  const strut_former *f = p->f;
  const columns *at = &p->at;
  const int32_t *row_of = f->potential->row_of;
  for (int32_t j = 0; j < at->members; j++) {
    const strut_member *m = &f->scene->members[j];
    const double *a = f->scene->nodes[m->node[0]].start;
    const double *b = f->scene->nodes[m->node[1]].start;
    double length = strut_distance(a, b);
    for (int c = 0; c < 2 && length > 0; c++) {
      double u = (b[c] - a[c]) / length;
      int32_t row[2] = {row_of[2 * m->node[0] + c], row_of[2 * m->node[1] + c]};
      for (int end = 0; end < 2; end++) {
        if (row[end] < 0) continue;
        strut_linear_program_add(&p->program, row[end], at->pull + j, end ? -u : u);
        strut_linear_program_add(&p->program, row[end], at->push + j, end ? u : -u);
      }
    }
    strut_linear_program_add(&p->program, at->n + j, at->pull + j, 1);
    strut_linear_program_add(&p->program, at->n + j, at->push + j, 1);
    strut_linear_program_add(&p->program, at->n + j, at->most, -1);
    p->program.row_low[at->n + j] = -HUGE_VAL;
  }
  const strut_contact_table *c = &f->model->contacts;
  for (int32_t i = 0; i < at->contacts; i++) {
    const strut_contact_pose pose = strut_form_contact_as_drawn(f, i);
    for (int k = 0; k < 2; k++) {
      int32_t row = row_of[c->at[i] + (uint32_t)k];
      if (row >= 0) strut_linear_program_add(&p->program, row, at->ground + i, pose.axes.normal[k]);
    }
  }
  for (int32_t i = 0; i < at->n; i++) {
    double force = f->potential->force[f->potential->coordinate[i]] / p->scale;
    strut_linear_program_add(&p->program, i, at->up + i, 1);
    strut_linear_program_add(&p->program, i, at->down + i, -1);
    p->program.row_low[i] = p->program.row_high[i] = -force;
  }
}

static void fill_bounds(prestress *p) {
  const columns *at = &p->at;
  for (int32_t j = 0; j < at->members; j++) {
    const strut_member *m = &p->f->scene->members[j];
    bool cable = m->kind == STRUT_CABLE, carries = can_carry(m);
    double least =
        fmax(p->least, p->f->options->least_density * strut_form_length(p->f->scene, (size_t)j));
    p->program.low[at->pull + j] = cable && carries ? least / p->scale : 0;
    if (!carries) p->program.high[at->pull + j] = 0;
    if (cable || !carries) p->program.high[at->push + j] = 0;
  }
  for (int32_t i = 0; i < at->contacts; i++)
    if (!strut_form_touches(p->f, i)) p->program.high[at->ground + i] = 0;
}

static void set_costs(prestress *p, int32_t from, int32_t to, double cost) {
  for (int32_t j = from; j < to; j++) p->program.cost[j] = cost;
}

static strut_status solve_program(prestress *p, double *sum, strut_error *error) {
  strut_linear_program_end end;
  p->program.interrupt = p->f->experiment->interrupt;
  strut_status status = strut_linear_program_solve(&p->program, p->x, sum, &end);
  if (status == STRUT_INTERRUPTED) return strut_fail(error, status, "interrupted");
  if (status) return strut_fail(error, status, "out of memory");
  if (end == STRUT_PROGRAM_OPTIMAL) return STRUT_OK;
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the linear programme for the members' forces could not be solved");
}

static bool has_cables(const strut_former *f) {
  for (size_t j = 0; j < f->scene->member_count; j++)
    if (f->scene->members[j].kind == STRUT_CABLE) return true;
  return false;
}

/* Reports the nodes that lack a force, and the largest missing force. */
static strut_status cannot_hold(const prestress *p, strut_error *error) {
  const strut_former *f = p->f;
  const columns *at = &p->at;
  uint8_t *marked = strut_allocate(f->scene->node_count, 1);
  char names[200];
  double worst = 0;
  if (!marked) return strut_no_memory(error, "");
  for (int32_t i = 0; i < at->n; i++) {
    double missing = fmax(p->x[at->up + i], p->x[at->down + i]);
    if (missing > MISSING) marked[f->potential->coordinate[i] / 2] = 1;
    worst = fmax(worst, missing);
  }
  strut_list_nodes(f->scene, marked, sizeof names, names);
  strut_release(marked);
  char cables[80] = "";
  if (f->options->least_density > 0)
    snprintf(cables, sizeof cables, " with every cable at %.4g N/m or more",
             f->options->least_density);
  if (p->least > 0)
    snprintf(cables, sizeof cables, " with every cable at %.4g N or more", p->least);
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "no forces%s hold the drawn shape: at %s up to %.4g N are missing; change the "
                    "shape, add members or supports",
                    has_cables(f) ? cables : "", names, worst * p->scale);
}

/* Checks that some forces hold the shape, then minimises the objective over them. */
static strut_status find_forces(prestress *p, strut_error *error) {
  const columns *at = &p->at;
  double sum = 0;
  set_costs(p, at->up, at->count, 1);
  strut_status status = solve_program(p, &sum, error);
  if (status) return status;
  if (sum > MISSING * (1 + (double)at->n)) return cannot_hold(p, error);
  set_costs(p, at->up, at->count, 0);
  for (int32_t j = at->up; j < at->count; j++) p->program.high[j] = 0;
  if (p->f->options->objective == STRUT_FORM_LARGEST) {
    p->program.cost[at->most] = 1;
    status = solve_program(p, &sum, error);
    if (status) return status;
    p->program.cost[at->most] = 0;
    p->program.high[at->most] = sum * (1 + SLACKEN) + 1e-12;
  }
  set_costs(p, at->pull, at->ground, 1);
  return solve_program(p, &sum, error);
}

/* From forces that hold the shape to those whose cables have the least squares of densities. */
static bool minimise_squares(prestress *p) {
  const strut_former *f = p->f;
  const columns *at = &p->at;
  const double faint = 1e-5; /* bars and contacts decide only what cables leave open */
  int32_t count = at->members + at->contacts;
  strut_arena arena = {0};
  double *matrix = strut_arena_allocate(&arena, (size_t)at->n * (size_t)count, sizeof *matrix);
  double *weight = strut_arena_allocate(&arena, (size_t)count, sizeof *weight);
  double *low = strut_arena_allocate(&arena, (size_t)count, sizeof *low);
  double *x = strut_arena_allocate(&arena, (size_t)count, sizeof *x);
  bool good = matrix && weight && low && x;
  for (size_t k = 0; k < p->program.entry_count && good; k++) {
    int32_t row = p->program.entry_row[k], column = p->program.entry_column[k];
    if (row >= at->n) continue;
    if (column < at->members) matrix[row * count + column] = p->program.entry[k];
    if (column >= at->ground && column < at->most)
      matrix[row * count + at->members + column - at->ground] = p->program.entry[k];
  }
  for (int32_t j = 0; j < at->members && good; j++) {
    const strut_member *m = &f->scene->members[j];
    double length = strut_form_length(f->scene, (size_t)j);
    bool cable = m->kind == STRUT_CABLE;
    weight[j] = (cable ? 1.0 : faint) * f->size / (length > 0 ? length : f->size);
    low[j] = cable ? p->program.low[at->pull + j] : -HUGE_VAL;
    x[j] = p->x[at->pull + j] - p->x[at->push + j];
    if (!can_carry(m))
      for (int32_t i = 0; i < at->n; i++) matrix[i * count + j] = 0;
  }
  for (int32_t i = 0; i < at->contacts && good; i++) {
    weight[at->members + i] = faint;
    x[at->members + i] = p->x[at->ground + i];
    for (int32_t k = 0; k < at->n && !strut_form_touches(f, i); k++)
      matrix[k * count + at->members + i] = 0;
  }
  good = good && strut_bounded_squares(at->n, count, matrix, weight, low, x);
  for (int32_t j = 0; j < count && good; j++) {
    if (j >= at->members) p->x[at->ground + j - at->members] = x[j];
    if (j < at->members) p->x[at->pull + j] = x[j], p->x[at->push + j] = 0;
  }
  strut_arena_free(&arena);
  return good;
}

/*
 * Moves nodes into the ground to the depth that their contact force needs; returns the largest move
 * [m].
 */
static double sink_nodes(prestress *p) {
  const strut_contact_table *c = &p->f->model->contacts;
  double moved = 0;
  for (int32_t i = 0; i < p->at.contacts; i++) {
    strut_node *node = &p->f->scene->nodes[c->entry[i].node];
    double push = p->scale * p->x[p->at.ground + i];
    const strut_contact_pose pose = strut_form_contact(p->f, i, node->start);
    double sinks = push / c->entry[i].stiffness + pose.gap;
    for (int k = 0; k < 2 && push > 0; k++) {
      double start = node->start[k] - sinks * pose.axes.normal[k];
      if (node->fixed[k]) continue;
      moved = fmax(moved, fabs(start - node->start[k]));
      node->start[k] = start;
    }
  }
  return moved;
}

static strut_status set_forces(prestress *p, strut_error *error) {
  const columns *at = &p->at;
  strut_status status = STRUT_OK;
  for (int32_t j = 0; j < at->members && status == STRUT_OK; j++)
    status = strut_form_set_force(p->f, (size_t)j,
                                  p->scale * (p->x[at->pull + j] - p->x[at->push + j]), error);
  return status;
}

/* Computes the forces for the start positions. */
static strut_status compute_forces(prestress *p, strut_error *error) {
  const columns *at = &p->at;
  size_t entries = 11 * (size_t)at->members + 2 * (size_t)at->contacts + 2 * (size_t)at->n;
  strut_arena arena = {0};
  strut_status status = STRUT_NO_MEMORY;
  if (strut_linear_program_create(&p->program, at->n + at->members, at->count, entries, &arena)) {
    fill_rows(p);
    fill_bounds(p);
    status = find_forces(p, error);
    if (status == STRUT_OK && p->f->options->objective == STRUT_FORM_SQUARES &&
        !minimise_squares(p))
      status = strut_no_memory(error, "");
  } else {
    strut_fail(error, status, "out of memory");
  }
  strut_arena_free(&arena);
  return status;
}

strut_status strut_form_prestress(strut_former *f, strut_error *error) {
  prestress p = {.f = f, .at = number_columns(f), .least = least_tension(f)};
  p.scale = fmax(f->potential->force_scale, fmax(p.least, f->options->least_density * f->size));
  if (!(p.scale > 0)) p.scale = 1.0;
  f->form->least_tension = p.least;
  p.x = strut_arena_allocate(&f->arena, (size_t)p.at.count, sizeof *p.x);
  if (!p.x) return strut_no_memory(error, "");
  for (size_t i = 0; i < f->scene->node_count; i++)
    memcpy(f->scene->nodes[i].start, f->scene->nodes[i].position, sizeof f->scene->nodes[i].start);
  strut_status status = STRUT_OK;
  for (int k = 0; k < PASSES && status == STRUT_OK; k++) { /* sinking turns members a little */
    status = compute_forces(&p, error);
    if (status == STRUT_OK && sink_nodes(&p) <= SUNK * f->size) break;
  }
  return status == STRUT_OK ? set_forces(&p, error) : status;
}
