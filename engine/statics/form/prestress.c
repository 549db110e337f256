/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/form/parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/equilibria/equilibria_parts.h"

/*
 * Weighted least squares under equations and lower bounds, by an active set: from a point that satisfies everything
 * towards the least sum with the active bounds kept, as far as the others allow.
 */

enum { ROUNDS = 1000 };

static const double CUT = 1e-11;  /* of the largest singular value */
static const double ZERO = 1e-12; /* of a step, of a multiplier */

typedef struct squares {
  size_t rows, count;
  const double *equations, *weight, *low;
  double *x;
  uint8_t *active;
  gsl_matrix *matrix;         /* (count at least, rows) of x times weight; zero where active */
  gsl_vector *right, *target; /* then the equations' multipliers; x times weight where it leads */
} squares;

/* The point with the least sum; or, of `left`, the shortest step by which the equations hold again. */
static bool find_target(squares *self, const double *left) {
  gsl_matrix_set_zero(self->matrix);
  for (size_t r = 0; r < self->rows; r++) {
    double sum = left ? left[r] : 0.0;
    for (size_t i = 0; i < self->count; i++) {
      double entry = self->active[i] ? 0.0 : self->equations[r * self->count + i];
      gsl_matrix_set(self->matrix, i, r, entry / self->weight[i]);
      sum += left ? -self->equations[r * self->count + i] * self->x[i] : entry * self->x[i];
    }
    gsl_vector_set(self->right, r, sum);
  }
  return strut_shortest(self->matrix, CUT, self->right, self->target);
}

/* Goes there as far as the bounds allow; a bound that stops it becomes active. True: nothing moved. */
static bool advance_to_bound(squares *self) {
  double share = 1, most = 0, scale = 0;
  size_t stop = self->count;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < self->count; i++) {
      double step = gsl_vector_get(self->target, i) / self->weight[i] - self->x[i],
             room = self->low[i] - self->x[i];
      if (self->active[i]) continue;
      if (pass == 1) self->x[i] += share * step;
      most = fmax(most, fabs(step)), scale = fmax(scale, fabs(self->x[i]));
      if (pass == 0 && step < 0 && room / step < share) share = fmax(room / step, 0), stop = i;
    }
  if (stop < self->count) self->active[stop] = 1, self->x[stop] = self->low[stop];
  return stop == self->count && most <= ZERO * scale;
}

/* Releases the active bound with the worst multiplier; false if all signs are right. */
static bool release_bound(squares *self) {
  size_t worst = self->count;
  double least = 0, scale = 0;
  for (size_t i = 0; i < self->count; i++) {
    double slope = self->weight[i] * self->weight[i] * self->x[i];
    scale = fmax(scale, fabs(slope));
    for (size_t r = 0; r < self->rows; r++)
      slope -= self->equations[r * self->count + i] * gsl_vector_get(self->right, r);
    if (self->active[i] && slope < least) least = slope, worst = i;
  }
  if (worst == self->count || least >= -ZERO * scale) return false;
  self->active[worst] = 0;
  return true;
}

bool strut_bounded_squares(int32_t rows, int32_t count, const double *equations,
                           const double *weight, const double *low, double *vector) {
  size_t n = (size_t)count, m = (size_t)rows, tall = m > n ? m : n;
  strut_arena arena = {0};
  squares s = {m, n, equations, weight, low, vector, NULL, NULL, NULL, NULL};
  s.active = strut_arena_allocate(&arena, n, 1);
  s.matrix = strut_arena_matrix(&arena, tall, m);
  s.right = strut_arena_vector(&arena, m);
  s.target = strut_arena_vector(&arena, tall);
  double *sum = strut_arena_allocate(&arena, m, sizeof *sum);
  bool good = s.active && s.matrix && s.right && s.target && sum;
  for (size_t r = 0; r < m && good; r++) sum[r] = strut_dot(equations + r * n, vector, count);
  for (int k = 0; k < ROUNDS && good; k++) {
    good = find_target(&s, NULL);
    if (good && advance_to_bound(&s) && !release_bound(&s)) break;
  }
  good = good && find_target(&s, sum);
  for (size_t i = 0; i < n && good; i++) vector[i] += gsl_vector_get(s.target, i) / weight[i];
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

static bool can_carry(const strut_member *member) {
  return member->stiffness > 0 || member->axial_stiffness > 0;
}

static double least_tension(const strut_former *former) {
  double least = HUGE_VAL;
  if (former->options->least_tension > 0 || former->options->least_density > 0)
    return former->options->least_tension;
  if (former->potential->force_scale > 0) return SHARE * former->potential->force_scale;
  for (int32_t j = 0; j < former->model->members.count; j++) {
    strut_rest rest;
    if (former->scene->members[j].kind != STRUT_CABLE) continue;
    if (!strut_member_rest(former->scene, (size_t)j, &rest) || !(rest.stiffness > 0)) continue;
    least = fmin(least, SHARE * rest.stiffness * rest.drawn_length);
  }
  return isfinite(least) ? least : 0.0;
}

static columns number_columns(const strut_former *former) {
  columns at = {.members = former->model->members.count,
                .contacts = former->model->contacts.count,
                .n = former->potential->n};
  at.pull = 0, at.push = at.members, at.ground = 2 * at.members;
  at.most = at.ground + at.contacts, at.up = at.most + 1;
  at.down = at.up + at.n, at.count = at.down + at.n;
  return at;
}

/* Net force on each free coordinate = 0; then p + m <= z for each member. */
static void fill_rows(prestress *self) {
  const strut_former *former = self->f;
  const columns *at = &self->at;
  const int32_t *row_of = former->potential->row_of;
  for (int32_t j = 0; j < at->members; j++) {
    const strut_member *member = &former->scene->members[j];
    const double *a = former->scene->nodes[member->node[0]].start;
    const double *b = former->scene->nodes[member->node[1]].start;
    double length = strut_distance(a, b);
    for (int c = 0; c < 2 && length > 0; c++) {
      double u = (b[c] - a[c]) / length;
      int32_t row[2] = {row_of[2 * member->node[0] + c], row_of[2 * member->node[1] + c]};
      for (int end = 0; end < 2; end++) {
        if (row[end] < 0) continue;
        strut_linear_program_add(&self->program, row[end], at->pull + j, end ? -u : u);
        strut_linear_program_add(&self->program, row[end], at->push + j, end ? u : -u);
      }
    }
    strut_linear_program_add(&self->program, at->n + j, at->pull + j, 1);
    strut_linear_program_add(&self->program, at->n + j, at->push + j, 1);
    strut_linear_program_add(&self->program, at->n + j, at->most, -1);
    self->program.row_low[at->n + j] = -HUGE_VAL;
  }
  const strut_contact_table *contacts = &former->model->contacts;
  for (int32_t i = 0; i < at->contacts; i++) {
    const strut_contact_pose pose = strut_form_contact_as_drawn(former, i);
    for (int k = 0; k < 2; k++) {
      int32_t row = row_of[contacts->at[i] + (uint32_t)k];
      if (row >= 0)
        strut_linear_program_add(&self->program, row, at->ground + i, pose.axes.normal[k]);
    }
  }
  for (int32_t i = 0; i < at->n; i++) {
    double force = former->potential->force[former->potential->coordinate[i]] / self->scale;
    strut_linear_program_add(&self->program, i, at->up + i, 1);
    strut_linear_program_add(&self->program, i, at->down + i, -1);
    self->program.row_low[i] = self->program.row_high[i] = -force;
  }
}

static void fill_bounds(prestress *self) {
  const columns *at = &self->at;
  for (int32_t j = 0; j < at->members; j++) {
    const strut_member *member = &self->f->scene->members[j];
    bool cable = member->kind == STRUT_CABLE, carries = can_carry(member);
    double least = fmax(self->least, self->f->options->least_density *
                                         strut_form_length(self->f->scene, (size_t)j));
    self->program.low[at->pull + j] = cable && carries ? least / self->scale : 0;
    if (!carries) self->program.high[at->pull + j] = 0;
    if (cable || !carries) self->program.high[at->push + j] = 0;
  }
  for (int32_t i = 0; i < at->contacts; i++)
    if (!strut_form_touches(self->f, i)) self->program.high[at->ground + i] = 0;
}

static void set_costs(prestress *self, int32_t from, int32_t to, double cost) {
  for (int32_t j = from; j < to; j++) self->program.cost[j] = cost;
}

static strut_status solve_program(prestress *self, double *sum, strut_error *error) {
  strut_linear_program_end end;
  self->program.interrupt = self->f->experiment->interrupt;
  strut_status status = strut_linear_program_solve(&self->program, self->x, sum, &end);
  if (status == STRUT_INTERRUPTED) return strut_fail(error, status, "interrupted");
  if (status) return strut_fail(error, status, "out of memory");
  if (end == STRUT_PROGRAM_OPTIMAL) return STRUT_OK;
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the linear programme for the members' forces could not be solved");
}

static bool has_cables(const strut_former *former) {
  for (size_t j = 0; j < former->scene->member_count; j++)
    if (former->scene->members[j].kind == STRUT_CABLE) return true;
  return false;
}

/* Reports the nodes that lack a force, and the largest missing force. */
static strut_status cannot_hold(const prestress *self, strut_error *error) {
  const strut_former *former = self->f;
  const columns *at = &self->at;
  uint8_t *marked = strut_allocate(former->scene->node_count, 1);
  char names[200];
  double worst = 0;
  if (!marked) return strut_no_memory(error, "");
  for (int32_t i = 0; i < at->n; i++) {
    double missing = fmax(self->x[at->up + i], self->x[at->down + i]);
    if (missing > MISSING) marked[former->potential->coordinate[i] / 2] = 1;
    worst = fmax(worst, missing);
  }
  strut_list_nodes(former->scene, marked, sizeof names, names);
  strut_release(marked);
  char cables[80] = "";
  if (former->options->least_density > 0)
    snprintf(cables, sizeof cables, " with every cable at %.4g N/m or more",
             former->options->least_density);
  if (self->least > 0)
    snprintf(cables, sizeof cables, " with every cable at %.4g N or more", self->least);
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "no forces%s hold the drawn shape: at %s up to %.4g N are missing; change the "
                    "shape, add members or supports",
                    has_cables(former) ? cables : "", names, worst * self->scale);
}

/* Checks that some forces hold the shape, then minimises the objective over them. */
static strut_status find_forces(prestress *self, strut_error *error) {
  const columns *at = &self->at;
  double sum = 0;
  set_costs(self, at->up, at->count, 1);
  strut_status status = solve_program(self, &sum, error);
  if (status) return status;
  if (sum > MISSING * (1 + (double)at->n)) return cannot_hold(self, error);
  set_costs(self, at->up, at->count, 0);
  for (int32_t j = at->up; j < at->count; j++) self->program.high[j] = 0;
  if (self->f->options->objective == STRUT_FORM_LARGEST) {
    self->program.cost[at->most] = 1;
    status = solve_program(self, &sum, error);
    if (status) return status;
    self->program.cost[at->most] = 0;
    self->program.high[at->most] = sum * (1 + SLACKEN) + 1e-12;
  }
  set_costs(self, at->pull, at->ground, 1);
  return solve_program(self, &sum, error);
}

/* From forces that hold the shape to those whose cables have the least squares of densities. */
static bool minimise_squares(prestress *self) {
  const strut_former *former = self->f;
  const columns *at = &self->at;
  const double faint = 1e-5; /* bars and contacts decide only what cables leave open */
  int32_t count = at->members + at->contacts;
  strut_arena arena = {0};
  double *matrix, *weight, *low, *x;
  bool good = STRUT_NUMBERS(&arena, count, &weight, &low, &x) &&
              STRUT_NUMBERS(&arena, (size_t)at->n * (size_t)count, &matrix);
  for (size_t k = 1; k <= self->program.entry_count && good; k++) {
    int32_t row = self->program.entry_row[k] - 1, column = self->program.entry_column[k] - 1;
    if (row >= at->n) continue;
    if (column < at->members) matrix[row * count + column] = self->program.entry[k];
    if (column >= at->ground && column < at->most)
      matrix[row * count + at->members + column - at->ground] = self->program.entry[k];
  }
  for (int32_t j = 0; j < at->members && good; j++) {
    const strut_member *member = &former->scene->members[j];
    double length = strut_form_length(former->scene, (size_t)j);
    bool cable = member->kind == STRUT_CABLE;
    weight[j] = (cable ? 1.0 : faint) * former->size / (length > 0 ? length : former->size);
    low[j] = cable ? self->program.low[at->pull + j] : -HUGE_VAL;
    x[j] = self->x[at->pull + j] - self->x[at->push + j];
    if (!can_carry(member))
      for (int32_t i = 0; i < at->n; i++) matrix[i * count + j] = 0;
  }
  for (int32_t i = 0; i < at->contacts && good; i++) {
    weight[at->members + i] = faint;
    x[at->members + i] = self->x[at->ground + i];
    for (int32_t k = 0; k < at->n && !strut_form_touches(former, i); k++)
      matrix[k * count + at->members + i] = 0;
  }
  good = good && strut_bounded_squares(at->n, count, matrix, weight, low, x);
  for (int32_t j = 0; j < count && good; j++) {
    if (j >= at->members) self->x[at->ground + j - at->members] = x[j];
    if (j < at->members) self->x[at->pull + j] = x[j], self->x[at->push + j] = 0;
  }
  strut_arena_free(&arena);
  return good;
}

/*
 * Moves nodes into the ground to the depth that their contact force needs; returns the largest move
 * [m].
 */
static double sink_nodes(prestress *self) {
  const strut_contact_table *contacts = &self->f->model->contacts;
  double moved = 0;
  for (int32_t i = 0; i < self->at.contacts; i++) {
    strut_node *node = &self->f->scene->nodes[contacts->entry[i].node];
    double push = self->scale * self->x[self->at.ground + i];
    const strut_contact_pose pose = strut_form_contact(self->f, i, node->start);
    double sinks = push / contacts->entry[i].stiffness + pose.gap;
    for (int k = 0; k < 2 && push > 0; k++) {
      double start = node->start[k] - sinks * pose.axes.normal[k];
      if (node->fixed[k]) continue;
      moved = fmax(moved, fabs(start - node->start[k]));
      node->start[k] = start;
    }
  }
  return moved;
}

static strut_status set_forces(prestress *self, strut_error *error) {
  const columns *at = &self->at;
  strut_status status = STRUT_OK;
  for (int32_t j = 0; j < at->members && status == STRUT_OK; j++)
    status = strut_form_set_force(
        self->f, (size_t)j, self->scale * (self->x[at->pull + j] - self->x[at->push + j]), error);
  return status;
}

/* Computes the forces for the start positions. */
static strut_status compute_forces(prestress *self, strut_error *error) {
  const columns *at = &self->at;
  size_t entries = 11 * (size_t)at->members + 2 * (size_t)at->contacts + 2 * (size_t)at->n;
  strut_arena arena = {0};
  strut_status status = STRUT_NO_MEMORY;
  if (strut_linear_program_create(&self->program, at->n + at->members, at->count, entries,
                                  &arena)) {
    fill_rows(self);
    fill_bounds(self);
    status = find_forces(self, error);
    if (status == STRUT_OK && self->f->options->objective == STRUT_FORM_SQUARES &&
        !minimise_squares(self))
      status = strut_no_memory(error, "");
  } else {
    strut_fail(error, status, "out of memory");
  }
  strut_arena_free(&arena);
  return status;
}

strut_status strut_form_prestress(strut_former *former, strut_error *error) {
  prestress p = {.f = former, .at = number_columns(former), .least = least_tension(former)};
  p.scale = fmax(former->potential->force_scale,
                 fmax(p.least, former->options->least_density * former->size));
  if (!(p.scale > 0)) p.scale = 1.0;
  former->form->least_tension = p.least;
  p.x = strut_arena_allocate(&former->arena, (size_t)p.at.count, sizeof *p.x);
  if (!p.x) return strut_no_memory(error, "");
  for (size_t i = 0; i < former->scene->node_count; i++)
    memcpy(former->scene->nodes[i].start, former->scene->nodes[i].position,
           sizeof former->scene->nodes[i].start);
  strut_status status = STRUT_OK;
  for (int k = 0; k < PASSES && status == STRUT_OK; k++) { /* sinking turns members a little */
    status = compute_forces(&p, error);
    if (status == STRUT_OK && sink_nodes(&p) <= SUNK * former->size) break;
  }
  return status == STRUT_OK ? set_forces(&p, error) : status;
}
