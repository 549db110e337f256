/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/modes/parts.h"

#include "engine/base/vec.h"
#include "engine/model/mass.h"
#include "engine/statics/algebra.h"

static const double EDGE = 8.0; /* last bits to which a length and a rest length are known */

/* Member j with `low`; does it pull or push? */
static bool place_member(const strut_vibration *vibration, int32_t j, strut_force *force) {
  const strut_member_table *members = &vibration->model->members;
  const double *from = vibration->q + members->from[j], *to = vibration->q + members->to[j];
  const strut_vec2 low =
      strut_vec2_between(vibration->low + members->from[j], vibration->low + members->to[j]);
  double dx = to[0] - from[0], dy = to[1] - from[1], length = hypot(dx + low.x, dy + low.y);
  bool any = length > 0;
  strut_vec2 unit = {any ? (dx + low.x) / length : 0.0, any ? (dy + low.y) / length : 0.0};
  double stretch = hypot(dx, dy) - members->rest[j] + (unit.x * low.x + unit.y * low.y);
  /* of zero length and zero rest length: an isotropic spring */
  double across = any                    ? stretch * members->stiffness[j] / length
                  : members->rest[j] > 0 ? 0.0
                                         : members->stiffness[j];
  strut_force_set_member(members->stiffness[j], across, unit, length, stretch, force);
  return vibration->state[j] ? vibration->state[j] > 0 : stretch > members->slack[j];
}

/* Strain, force and gradient of an element, with `low` to first order; does it act? */
static bool place_element(const strut_vibration *vibration, strut_force *force) {
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT], low[STRUT_MOST_GRADIENT];
  strut_element_pose *pose = &force->pose;
  double change = 0.0;
  int32_t n = 2 * force->nodes;
  bool any = false;
  strut_element_evaluate(vibration->model, force->index, vibration->model->members.rest,
                         vibration->q, (double)NAN, pose);
  if (vibration->state[vibration->model->members.count + force->index] < 0) pose->acts = false;
  for (int32_t k = 0; k < n; k++) {
    low[k] = vibration->low[strut_force_coordinate(force, k)];
    any = any || low[k] != 0.0;
    change += pose->b[k] * low[k];
  }
  if (!any || !pose->acts) return pose->acts;
  memset(bend, 0, (size_t)(n * n) * sizeof *bend);
  strut_element_bend(vibration->model, force->index, vibration->q, 1.0, bend);
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++) pose->b[r] += bend[r * n + c] * low[c];
  pose->strain += change;
  pose->force += pose->slope * change;
  return true;
}

bool strut_vibration_force_at(const strut_vibration *vibration, int32_t number,
                              strut_force *force) {
  strut_force_begin(vibration->model, number, force);
  if (force->kind == STRUT_FORCE_MEMBER) return place_member(vibration, number, force);
  if (force->kind == STRUT_FORCE_ELEMENT) return place_element(vibration, force);
  const strut_contact_table *contacts = &vibration->model->contacts;
  strut_contact_pose pose = strut_contact_pose_at(contacts, force->index, vibration->q, NULL, -1);
  const double *low = vibration->low + force->at[0];
  pose.gap += low[0] * pose.axes.normal[0] + low[1] * pose.axes.normal[1];
  strut_force_set_contact(contacts->entry[force->index].stiffness, &pose, force);
  return vibration->closed[force->index];
}

bool strut_vibration_is_borderline(const strut_vibration *vibration, int32_t number) {
  strut_force force;
  strut_vibration_force_at(vibration, number, &force);
  const strut_element_pose *pose = &force.pose;
  double beyond = pose->strain - pose->natural;
  bool one_sided;
  if (force.kind == STRUT_FORCE_MEMBER) {
    if (!(pose->slope > 0.0)) return false; /* an element acts in its place */
    one_sided = vibration->model->members.slack[number] > -HUGE_VAL;
    beyond = pose->force / pose->slope;
  } else {
    one_sided = vibration->model->elements.element[force.index].carries;
  }
  return one_sided &&
         fabs(beyond) <= EDGE * DBL_EPSILON * (fabs(pose->strain) + fabs(pose->natural));
}

/* M in the pattern's places: masses on top of zeros there. */
static bool add_masses(strut_vibration *vibration, strut_arena *arena) {
  const strut_model *model = vibration->model;
  const strut_sparse *matrix = vibration->shape->pattern;
  const int32_t *row_of = vibration->shape->row_of;
  strut_triplets sum = {0};
  strut_arena scratch = {0};
  strut_sparse *mass = NULL;
  size_t most = strut_tangent_entries(model, true) + strut_mass_entries(model);
  if (strut_triplets_reserve(&sum, most, &scratch)) {
    strut_tangent_add_pattern(model, row_of, true, &sum);
    strut_mass_add(model, row_of, 1.0, true, &sum); /* sliding ones where they are at t = 0 */
    mass = strut_sparse_build(vibration->n, &sum, arena);
  }
  strut_arena_free(&scratch);
  if (!mass) return false;
  assert(mass->start[mass->n] == matrix->start[matrix->n]);
  vibration->m = mass->value;
  for (int32_t j = 0; j < vibration->n; j++) {
    vibration->own_mass[j] = vibration->m[matrix->start[j]];
    for (int32_t at = matrix->start[j]; at < matrix->start[j + 1]; at++) {
      vibration->mass[j] += vibration->m[at];
      if (matrix->row[at] != j) vibration->mass[matrix->row[at]] += vibration->m[at];
    }
  }
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *item = &model->sliding.item[i];
    for (uint32_t k = 0; k < 4; k++) {
      int32_t row = row_of[item->at[k / 2] + k % 2];
      double part = k < 2 ? 1.0 - item->start : item->start;
      if (row >= 0) vibration->own_mass[row] -= item->mass * part * part;
    }
  }
  for (int32_t i = 0; i < vibration->n; i++) vibration->massive += vibration->mass[i] > 0;
  return true;
}

/* x'Kx over x'Mx is at most that of the worst member or node: M >= half of its diagonal without sliding
   masses. */
static void bound_spectrum(strut_vibration *vibration) {
  const strut_sparse *matrix = vibration->shape->pattern;
  double *sum = vibration->work;
  memset(sum, 0, (size_t)vibration->n * sizeof *sum);
  for (int32_t j = 0; j < vibration->n; j++)
    for (int32_t at = matrix->start[j]; at < matrix->start[j + 1]; at++) {
      sum[j] += fabs(vibration->k[at]);
      if (matrix->row[at] != j) sum[matrix->row[at]] += fabs(vibration->k[at]);
    }
  vibration->largest = 0.0;
  for (int32_t i = 0; i < vibration->n; i++) {
    double bound = vibration->mass[i] > 0 ? 2.0 * sum[i] / vibration->own_mass[i] : 0.0;
    if (!(bound <= vibration->largest)) vibration->largest = bound; /* what is no number shows */
  }
}

void strut_vibration_update(strut_vibration *vibration) {
  double matrix[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_force force;
  const strut_sparse *a = vibration->shape->pattern;
  memset(vibration->k, 0, (size_t)a->start[vibration->n] * sizeof *vibration->k);
  memset(vibration->d, 0, (size_t)a->start[vibration->n] * sizeof *vibration->d);
  for (int32_t i = 0; i < strut_force_count(vibration->model, true); i++) {
    if (!strut_vibration_force_at(vibration, i, &force)) continue;
    strut_force_stiffness(vibration->model, &force, vibration->q, matrix);
    strut_force_scatter(&force, matrix, vibration->shape->place, vibration->k);
    strut_force_square(&force, force.damping, matrix);
    strut_force_scatter(&force, matrix, vibration->shape->place, vibration->d);
  }
  bound_spectrum(vibration);
}

static bool allocate(strut_vibration *vibration, strut_arena *arena) {
  const strut_model *model = vibration->model;
  size_t n = (size_t)vibration->n, entries = (size_t)vibration->shape->pattern->start[n];
  return STRUT_ALLOCATE(arena, STRUT_NEW(vibration->closed, model->contacts.count),
                        STRUT_NEW(vibration->state, (size_t)strut_force_count(model, false))) &&
         STRUT_NUMBERS(arena, model->length, &vibration->q, &vibration->low) &&
         STRUT_NUMBERS(arena, entries, &vibration->k, &vibration->d) &&
         STRUT_NUMBERS(arena, n, &vibration->mass, &vibration->own_mass, &vibration->work) &&
         add_masses(vibration, arena);
}

strut_status strut_vibration_create(const strut_model *model, const double *q,
                                    const int32_t *closed, int32_t closed_count,
                                    const uint8_t *held, strut_arena *arena,
                                    strut_vibration **vibration, strut_error *error) {
  strut_vibration *v = *vibration = strut_arena_allocate(arena, 1, sizeof *v);
  if (!v) return strut_no_memory(error, "");
  v->model = model;
  strut_status status = strut_potential_create(model, held, true, arena, &v->shape, error);
  if (status != STRUT_OK) return status;
  v->n = v->shape->n;
  if (!allocate(v, arena)) return strut_no_memory(error, "");
  memcpy(v->q, q, (size_t)model->length * sizeof *q);
  for (int32_t i = 0; i < model->contacts.count; i++)
    for (int32_t k = 0; k < closed_count; k++)
      if (model->contacts.entry[i].node == closed[k])
        v->closed[i] = !model->contacts.surface || strut_contact_gap(&model->contacts, i, q) < 0.0;
  strut_vibration_update(v);
  return STRUT_OK;
}

void strut_vibration_force(const strut_vibration *vibration, double *sum) {
  strut_force force;
  for (int32_t i = 0; i < vibration->n; i++)
    sum[i] = vibration->shape->force[vibration->shape->coordinate[i]];
  for (int32_t i = 0; i < strut_force_count(vibration->model, true); i++) {
    if (!strut_vibration_force_at(vibration, i, &force)) continue;
    for (int32_t k = 0; k < 2 * force.nodes; k++) {
      int32_t row = vibration->shape->row_of[strut_force_coordinate(&force, k)];
      if (row >= 0) sum[row] -= force.pose.force * force.pose.b[k];
    }
  }
}

void strut_vibration_multiply(const strut_vibration *vibration, const double *matrix,
                              const double *vector, double *y) {
  strut_sparse a = *vibration->shape->pattern;
  a.value = (double *)matrix; /* only read */
  strut_sparse_multiply(&a, vector, y);
}

/* How coordinate k of a force moves, beside that of its last node if its nodes alone decide its strain. */
static double relative_motion(const strut_vibration *vibration, const strut_force *force, int32_t k,
                              const double *vector) {
  bool foot = force->kind == STRUT_FORCE_ELEMENT &&
              vibration->model->elements.element[force->index].strain == STRUT_STRAIN_FOOT;
  bool grounded = foot || force->kind == STRUT_FORCE_CONTACT;
  const int32_t *row_of = vibration->shape->row_of;
  int32_t own = row_of[strut_force_coordinate(force, k)];
  int32_t last =
      grounded ? -1 : row_of[strut_force_coordinate(force, 2 * force->nodes - 2 + k % 2)];
  return (own >= 0 ? vector[own] : 0.0) - (last >= 0 ? vector[last] : 0.0);
}

static double change_along(const strut_vibration *vibration, const strut_force *force,
                           const double *b, const double *vector) {
  double sum = 0.0;
  for (int32_t k = 0; k < 2 * force->nodes; k++)
    sum += b[k] * relative_motion(vibration, force, k, vector);
  return sum;
}

double strut_vibration_strain(const strut_vibration *vibration, const strut_force *force,
                              const double *vector) {
  return change_along(vibration, force, force->pose.b, vector);
}

/* Relative rounding of a difference of coordinates, and of an energy made of it. */
static const double BITS = 2.0 * DBL_EPSILON;

/* Adds k along^2, where `along` was made of motions of size `far`. */
static void add_square(double stiffness, double along, double far, strut_vibration_energy *sum) {
  double bits = BITS * far;
  sum->value += stiffness * along * along;
  sum->rounding += fabs(stiffness) * bits * (2.0 * fabs(along) + bits);
}

/* What the force of an element adds by bending the strain, whose second derivatives are known to `blur`. */
static void add_bow(const strut_vibration *vibration, const strut_force *force,
                    const double *vector, strut_vibration_energy *sum) {
  double blur = BITS;
  bool angle = vibration->model->elements.element[force->index].strain == STRUT_STRAIN_ANGLE;
  for (int32_t k = 0; k < force->nodes && angle; k++) {
    const double *place = vibration->q + force->at[k], *b = &force->pose.b[2 * k];
    blur += 2.0 * hypot(b[0], b[1]) * strut_coordinate_rounding(place, place);
  }
  const strut_strain_bow bow = strut_vibration_bow(vibration, force, vector);
  sum->value += force->pose.force * bow.sum;
  sum->rounding += blur * fabs(force->pose.force) * bow.size;
}

static void add_energy(const strut_vibration *vibration, const strut_force *force,
                       const double *vector, strut_vibration_energy *sum) {
  double far = 0.0;
  for (int32_t k = 0; k < 2 * force->nodes; k += 2) {
    const double *b = &force->pose.b[k];
    double d[2] = {relative_motion(vibration, force, k, vector),
                   relative_motion(vibration, force, k + 1, vector)};
    far += force->kind == STRUT_FORCE_ELEMENT ? fabs(b[0] * d[0]) + fabs(b[1] * d[1])
                                              : hypot(d[0], d[1]);
  }
  add_square(force->pose.slope, strut_vibration_strain(vibration, force, vector), far, sum);
  if (force->kind == STRUT_FORCE_ELEMENT)
    add_bow(vibration, force, vector, sum);
  else if (force->across != 0.0)
    add_square(force->across, change_along(vibration, force, force->side, vector), far, sum);
}

strut_strain_bow strut_vibration_bow(const strut_vibration *vibration, const strut_force *force,
                                     const double *vector) {
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_strain_bow bow = {0.0, 0.0};
  int32_t n = 2 * force->nodes;
  if (force->kind == STRUT_FORCE_MEMBER) {
    double across = change_along(vibration, force, force->side, vector);
    if (force->pose.strain > 0) bow.sum = bow.size = across * across / force->pose.strain;
    return bow;
  }
  memset(bend, 0, (size_t)(n * n) * sizeof *bend);
  strut_element_bend(vibration->model, force->index, vibration->q, 1.0, bend);
  for (int32_t r = 0; r < n; r++) {
    double own = relative_motion(vibration, force, r, vector);
    for (int32_t c = 0; c < n; c++) {
      double part = own * bend[r * n + c] * relative_motion(vibration, force, c, vector);
      bow.sum += part, bow.size += fabs(part);
    }
  }
  return bow;
}

strut_vibration_energy strut_vibration_energy_of(const strut_vibration *vibration,
                                                 const double *vector) {
  strut_vibration_energy sum = {0.0, 0.0};
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(vibration->model, true); i++)
    if (strut_vibration_force_at(vibration, i, &force)) add_energy(vibration, &force, vector, &sum);
  return sum;
}

enum { MOST_SHIFTS = 4 }; /* where one is an eigenvalue to the last bit */

strut_status strut_modes_solver_create(const strut_vibration *vibration, strut_modes_solver *solver,
                                       strut_error *error) {
  size_t entries = (size_t)vibration->shape->pattern->start[vibration->n];
  *solver = (strut_modes_solver){.v = vibration, .sum = *vibration->shape->pattern};
  solver->sum.value = strut_arena_allocate(&solver->arena, entries, sizeof(double));
  if (!solver->sum.value) return strut_no_memory(error, "");
  return strut_ldl_create(vibration->shape->pattern, &solver->arena, &solver->ldl, error);
}

void strut_modes_solver_free(strut_modes_solver *solver) {
  strut_arena_free(&solver->arena);
  *solver = (strut_modes_solver){0};
}

static bool is_interrupted(const strut_modes_solver *solver) {
  return solver->interrupt && *solver->interrupt;
}

void strut_modes_factorise(strut_modes_solver *solver, double shift) {
  const strut_vibration *vibration = solver->v;
  strut_status status = STRUT_SINGULAR;
  for (int i = 0; i < MOST_SHIFTS && status == STRUT_SINGULAR && !is_interrupted(solver); i++) {
    for (int32_t at = 0; at < solver->sum.start[vibration->n]; at++)
      solver->sum.value[at] = vibration->k[at] + shift * vibration->m[at];
    status = strut_ldl_factorise(solver->ldl, &solver->sum, 0.0, &solver->inertia);
    shift *= 1.0 + 1e-3;
  }
  if (status != STRUT_OK) solver->inertia.smallest = 0.0;
}

void strut_modes_solve(strut_modes_solver *solver, double *vector) {
  if (is_interrupted(solver)) return;
  if (solver->inertia.smallest > 0.0)
    strut_ldl_solve(solver->ldl, vector);
  else
    memset(vector, 0, (size_t)solver->v->n * sizeof *vector);
}
