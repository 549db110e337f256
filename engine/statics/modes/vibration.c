/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"

static const double EDGE =
    8.0; /* last bits that a length and a rest length are known to, together */

/* Member j with `low`; does it pull or push? */
static bool place_member(const strut_vibration *v, int32_t j, strut_force *force) {
  const strut_member_table *t = &v->model->members;
  const double *from = v->q + t->from[j], *to = v->q + t->to[j];
  const strut_vec2 low = strut_vec2_between(v->low + t->from[j], v->low + t->to[j]);
  double dx = to[0] - from[0], dy = to[1] - from[1], length = hypot(dx + low.x, dy + low.y);
  bool any = length > 0;
  strut_vec2 unit = {any ? (dx + low.x) / length : 0.0, any ? (dy + low.y) / length : 0.0};
  double stretch = hypot(dx, dy) - t->rest[j] + (unit.x * low.x + unit.y * low.y);
  /* of zero length and zero rest length: an isotropic spring */
  double across = any ? stretch * t->stiffness[j] / length : t->rest[j] > 0 ? 0.0 : t->stiffness[j];
  strut_force_set_member(t->stiffness[j], across, unit, length, stretch, force);
  return v->state[j] ? v->state[j] > 0 : stretch > t->slack[j];
}

/* Strain, force and gradient of an element, with `low` to first order; does it act? */
static bool place_element(const strut_vibration *v, strut_force *force) {
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT], low[STRUT_MOST_GRADIENT];
  strut_element_pose *pose = &force->pose;
  double change = 0.0;
  int32_t n = 2 * force->nodes;
  bool any = false;
  strut_element_evaluate(v->model, force->index, v->model->members.rest, v->q, (double)NAN, pose);
  if (v->state[v->model->members.count + force->index] < 0) pose->acts = false;
  for (int32_t k = 0; k < n; k++) {
    low[k] = v->low[strut_force_coordinate(force, k)];
    any = any || low[k] != 0.0;
    change += pose->b[k] * low[k];
  }
  if (!any || !pose->acts) return pose->acts;
  memset(bend, 0, (size_t)(n * n) * sizeof *bend);
  strut_element_bend(v->model, force->index, v->q, 1.0, bend);
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++) pose->b[r] += bend[r * n + c] * low[c];
  pose->strain += change;
  pose->force += pose->slope * change;
  return true;
}

bool strut_vibration_force_at(const strut_vibration *v, int32_t number, strut_force *force) {
  strut_force_begin(v->model, number, force);
  if (force->kind == STRUT_FORCE_MEMBER) return place_member(v, number, force);
  if (force->kind == STRUT_FORCE_ELEMENT) return place_element(v, force);
  const strut_contact_table *contacts = &v->model->contacts;
  strut_contact_pose pose = strut_contact_pose_at(contacts, force->index, v->q, NULL, -1);
  const double *low = v->low + force->at[0];
  pose.gap += low[0] * pose.axes.normal[0] + low[1] * pose.axes.normal[1];
  strut_force_set_contact(contacts->entry[force->index].stiffness, &pose, force);
  return v->closed[force->index];
}

bool strut_vibration_is_borderline(const strut_vibration *v, int32_t number) {
  strut_force force;
  strut_vibration_force_at(v, number, &force);
  const strut_element_pose *pose = &force.pose;
  double beyond = pose->strain - pose->natural;
  bool one_sided;
  if (force.kind == STRUT_FORCE_MEMBER) {
    if (!(pose->slope > 0.0)) return false; /* an element acts in its place */
    one_sided = v->model->members.slack[number] > -HUGE_VAL;
    beyond = pose->force / pose->slope;
  } else {
    one_sided = v->model->elements.element[force.index].carries;
  }
  return one_sided &&
         fabs(beyond) <= EDGE * DBL_EPSILON * (fabs(pose->strain) + fabs(pose->natural));
}

/* Masses of a member's ends, and what both share, along x and y alike. */
static void add_ends(strut_vibration *v, int32_t member, double first, double second,
                     double shared) {
  strut_force force;
  double mass[16] = {0};
  strut_force_begin(v->model, member, &force);
  for (int k = 0; k < 2; k++) {
    mass[5 * k] = first, mass[5 * k + 10] = second;
    mass[5 * k + 8] = shared;
  }
  strut_force_scatter(&force, mass, v->shape->place, v->m);
}

static void add_masses(strut_vibration *v) {
  const strut_model *model = v->model;
  const double *mass = model->members.mass;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  for (int32_t j = 0; j < model->members.count; j++) {
    double own = consistent ? mass[j] / 3.0 : mass[j] / 2.0;
    if (mass[j] > 0) add_ends(v, j, own, own, consistent ? mass[j] / 6.0 : 0.0);
  }
  const strut_sparse *a = v->shape->pattern;
  for (int32_t i = 0; i < v->n; i++) {
    v->m[a->start[i]] += model->point_mass[v->shape->coordinate[i] / 2];
    v->own_mass[i] = v->m[a->start[i]];
  }
  for (int32_t i = 0; i < model->sliding.count; i++) { /* where they are at t = 0 */
    const strut_sliding_item *item = &model->sliding.item[i];
    double far = item->start, near = 1.0 - far;
    add_ends(v, item->member, item->mass * near * near, item->mass * far * far,
             item->mass * near * far);
  }
  for (int32_t j = 0; j < v->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      v->mass[j] += v->m[at];
      if (a->row[at] != j) v->mass[a->row[at]] += v->m[at];
    }
  for (int32_t i = 0; i < v->n; i++) v->massive += v->mass[i] > 0;
}

/* x'Kx over x'Mx is at most that of the worst member or node: M >= half of its diagonal without sliding
   masses. */
static void bound_spectrum(strut_vibration *v) {
  const strut_sparse *a = v->shape->pattern;
  double *sum = v->work;
  memset(sum, 0, (size_t)v->n * sizeof *sum);
  for (int32_t j = 0; j < v->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      sum[j] += fabs(v->k[at]);
      if (a->row[at] != j) sum[a->row[at]] += fabs(v->k[at]);
    }
  v->largest = 0.0;
  for (int32_t i = 0; i < v->n; i++) {
    double bound = v->mass[i] > 0 ? 2.0 * sum[i] / v->own_mass[i] : 0.0;
    if (!(bound <= v->largest)) v->largest = bound; /* what is no number shows */
  }
}

void strut_vibration_update(strut_vibration *v) {
  double matrix[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_force force;
  const strut_sparse *a = v->shape->pattern;
  memset(v->k, 0, (size_t)a->start[v->n] * sizeof *v->k);
  memset(v->d, 0, (size_t)a->start[v->n] * sizeof *v->d);
  for (int32_t i = 0; i < strut_force_count(v->model, true); i++) {
    if (!strut_vibration_force_at(v, i, &force)) continue;
    strut_force_stiffness(v->model, &force, v->q, matrix);
    strut_force_scatter(&force, matrix, v->shape->place, v->k);
    strut_force_square(&force, force.damping, matrix);
    strut_force_scatter(&force, matrix, v->shape->place, v->d);
  }
  bound_spectrum(v);
}

static bool allocate(strut_vibration *v) {
  const strut_model *model = v->model;
  size_t n = (size_t)v->n, entries = (size_t)v->shape->pattern->start[n];
  v->q = strut_arena_allocate(&v->arena, (size_t)model->length, sizeof *v->q);
  v->closed = strut_arena_allocate(&v->arena, (size_t)model->contacts.count, sizeof *v->closed);
  v->k = strut_arena_allocate(&v->arena, entries, sizeof *v->k);
  v->m = strut_arena_allocate(&v->arena, entries, sizeof *v->m);
  v->d = strut_arena_allocate(&v->arena, entries, sizeof *v->d);
  v->low = strut_arena_allocate(&v->arena, (size_t)model->length, sizeof *v->low);
  v->mass = strut_arena_allocate(&v->arena, n, sizeof *v->mass);
  v->own_mass = strut_arena_allocate(&v->arena, n, sizeof *v->own_mass);
  v->work = strut_arena_allocate(&v->arena, n, sizeof *v->work);
  v->state = strut_arena_allocate(&v->arena, (size_t)strut_force_count(model, false), 1);
  return v->state && v->low && v->q && v->closed && v->k && v->m && v->d && v->mass &&
         v->own_mass && v->work;
}

strut_status strut_vibration_create(const strut_model *model, const double *q,
                                    const int32_t *closed, int32_t closed_count,
                                    const uint8_t *held, strut_vibration **vibration,
                                    strut_error *error) {
  strut_vibration *v = *vibration = strut_allocate(1, sizeof *v);
  if (!v) return strut_no_memory(error, "");
  v->model = model;
  strut_status status = strut_potential_create(model, held, true, &v->shape, error);
  if (status == STRUT_OK) v->n = v->shape->n;
  if (status == STRUT_OK && !allocate(v)) status = strut_no_memory(error, "");
  if (status != STRUT_OK) {
    strut_vibration_free(v);
    *vibration = NULL;
    return status;
  }
  memcpy(v->q, q, (size_t)model->length * sizeof *q);
  for (int32_t i = 0; i < model->contacts.count; i++)
    for (int32_t k = 0; k < closed_count; k++)
      if (model->contacts.entry[i].node == closed[k])
        v->closed[i] = !model->contacts.surface || strut_contact_gap(&model->contacts, i, q) < 0.0;
  add_masses(v);
  strut_vibration_update(v);
  return STRUT_OK;
}

void strut_vibration_free(strut_vibration *vibration) {
  if (!vibration) return;
  strut_potential_free(vibration->shape);
  strut_arena_free(&vibration->arena);
  strut_release(vibration);
}

void strut_vibration_force(const strut_vibration *v, double *sum) {
  strut_force force;
  for (int32_t i = 0; i < v->n; i++) sum[i] = v->shape->force[v->shape->coordinate[i]];
  for (int32_t i = 0; i < strut_force_count(v->model, true); i++) {
    if (!strut_vibration_force_at(v, i, &force)) continue;
    for (int32_t k = 0; k < 2 * force.nodes; k++) {
      int32_t row = v->shape->row_of[strut_force_coordinate(&force, k)];
      if (row >= 0) sum[row] -= force.pose.force * force.pose.b[k];
    }
  }
}

void strut_vibration_multiply(const strut_vibration *v, const double *matrix, const double *x,
                              double *y) {
  strut_sparse a = *v->shape->pattern;
  a.value = (double *)matrix; /* only read */
  strut_sparse_multiply(&a, x, y);
}

/* How coordinate k of a force moves, beside that of its last node if its nodes alone decide its strain. */
static double relative_motion(const strut_vibration *v, const strut_force *force, int32_t k,
                              const double *x) {
  bool foot = force->kind == STRUT_FORCE_ELEMENT &&
              v->model->elements.element[force->index].strain == STRUT_STRAIN_FOOT;
  bool grounded = foot || force->kind == STRUT_FORCE_CONTACT;
  const int32_t *row_of = v->shape->row_of;
  int32_t own = row_of[strut_force_coordinate(force, k)];
  int32_t last =
      grounded ? -1 : row_of[strut_force_coordinate(force, 2 * force->nodes - 2 + k % 2)];
  return (own >= 0 ? x[own] : 0.0) - (last >= 0 ? x[last] : 0.0);
}

static double change_along(const strut_vibration *v, const strut_force *force, const double *b,
                           const double *x) {
  double sum = 0.0;
  for (int32_t k = 0; k < 2 * force->nodes; k++) sum += b[k] * relative_motion(v, force, k, x);
  return sum;
}

double strut_vibration_strain(const strut_vibration *v, const strut_force *force, const double *x) {
  return change_along(v, force, force->pose.b, x);
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
static void add_bow(const strut_vibration *v, const strut_force *force, const double *x,
                    strut_vibration_energy *sum) {
  double blur = BITS;
  bool angle = v->model->elements.element[force->index].strain == STRUT_STRAIN_ANGLE;
  for (int32_t k = 0; k < force->nodes && angle; k++) {
    const double *place = v->q + force->at[k], *b = &force->pose.b[2 * k];
    blur += 2.0 * hypot(b[0], b[1]) * strut_coordinate_rounding(place, place);
  }
  const strut_strain_bow bow = strut_vibration_bow(v, force, x);
  sum->value += force->pose.force * bow.sum;
  sum->rounding += blur * fabs(force->pose.force) * bow.size;
}

static void add_energy(const strut_vibration *v, const strut_force *force, const double *x,
                       strut_vibration_energy *sum) {
  double far = 0.0;
  for (int32_t k = 0; k < 2 * force->nodes; k += 2) {
    const double *b = &force->pose.b[k];
    double d[2] = {relative_motion(v, force, k, x), relative_motion(v, force, k + 1, x)};
    far += force->kind == STRUT_FORCE_ELEMENT ? fabs(b[0] * d[0]) + fabs(b[1] * d[1])
                                              : hypot(d[0], d[1]);
  }
  add_square(force->pose.slope, strut_vibration_strain(v, force, x), far, sum);
  if (force->kind == STRUT_FORCE_ELEMENT)
    add_bow(v, force, x, sum);
  else if (force->across != 0.0)
    add_square(force->across, change_along(v, force, force->side, x), far, sum);
}

strut_strain_bow strut_vibration_bow(const strut_vibration *v, const strut_force *force,
                                     const double *x) {
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_strain_bow bow = {0.0, 0.0};
  int32_t n = 2 * force->nodes;
  if (force->kind == STRUT_FORCE_MEMBER) {
    double across = change_along(v, force, force->side, x);
    if (force->pose.strain > 0) bow.sum = bow.size = across * across / force->pose.strain;
    return bow;
  }
  memset(bend, 0, (size_t)(n * n) * sizeof *bend);
  strut_element_bend(v->model, force->index, v->q, 1.0, bend);
  for (int32_t r = 0; r < n; r++) {
    double own = relative_motion(v, force, r, x);
    for (int32_t c = 0; c < n; c++) {
      double part = own * bend[r * n + c] * relative_motion(v, force, c, x);
      bow.sum += part, bow.size += fabs(part);
    }
  }
  return bow;
}

strut_vibration_energy strut_vibration_energy_of(const strut_vibration *v, const double *x) {
  strut_vibration_energy sum = {0.0, 0.0};
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(v->model, true); i++)
    if (strut_vibration_force_at(v, i, &force)) add_energy(v, &force, x, &sum);
  return sum;
}
