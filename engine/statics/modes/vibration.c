/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/forces/tangent.h"
#include "engine/model/pose.h"

static const double EDGE =
    8.0; /* last bits that a length and a rest length are known to, together */

static void place_member(strut_vibration *v, int32_t j) {
  const strut_member_table *t = &v->model->members;
  strut_vibration_member *m = &v->member[j];
  uint32_t a = t->from[j], b = t->to[j];
  double dx = v->q[b] - v->q[a], dy = v->q[b + 1] - v->q[a + 1];
  double x = v->low[b] - v->low[a], y = v->low[b + 1] - v->low[a + 1];
  m->length = hypot(dx + x, dy + y);
  bool any = m->length > 0;
  m->ux = any ? (dx + x) / m->length : 0.0;
  m->uy = any ? (dy + y) / m->length : 0.0;
  m->stretch = hypot(dx, dy) - t->rest[j] + (m->ux * x + m->uy * y);
  m->taut = m->state ? m->state > 0 : m->stretch > t->slack[j];
  /* of zero length and zero rest length: an isotropic spring */
  if (any)
    m->across = m->stretch * t->stiffness[j] / m->length;
  else
    m->across = t->rest[j] > 0 ? 0.0 : t->stiffness[j];
}

static void add_member(strut_vibration *v, int32_t j) {
  const strut_vibration_member *m = &v->member[j];
  const strut_member_table *t = &v->model->members;
  if (!m->taut) return;
  const strut_vec2 along = {m->ux, m->uy};
  const strut_stiffness_block spring = strut_block_of(t->stiffness[j], m->across, along);
  const strut_stiffness_block damper = strut_block_of(t->damping[j], 0.0, along);
  const int32_t *place = v->shape->place + STRUT_MEMBER_ENTRIES * j;
  strut_block_scatter(&spring, STRUT_MEMBER_ENTRIES, place, v->k);
  strut_block_scatter(&damper, STRUT_MEMBER_ENTRIES, place, v->d);
}

bool strut_vibration_pose(const strut_vibration *v, int32_t i, strut_element_pose *pose) {
  const strut_element *e = &v->model->elements.element[i];
  const uint32_t *at = v->model->elements.at + e->first;
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0}, low[STRUT_MOST_GRADIENT];
  double change = 0.0;
  int32_t n = 2 * e->nodes;
  bool any = false;
  strut_element_evaluate(v->model, i, v->model->members.rest, v->q, (double)NAN, pose);
  if (v->idle[i]) pose->acts = false;
  for (int32_t k = 0; k < n; k++) {
    low[k] = v->low[at[k / 2] + (uint32_t)(k % 2)];
    any = any || low[k] != 0.0;
    change += pose->b[k] * low[k];
  }
  if (!any || !pose->acts) return pose->acts;
  strut_element_bend(v->model, i, v->q, 1.0, bend);
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++) pose->b[r] += bend[r * n + c] * low[c];
  pose->strain += change;
  pose->force += pose->slope * change;
  return true;
}

/* Is a length the natural one to its last bits? */
static bool is_at_edge(double stretch, double length, double natural) {
  return fabs(stretch) <= EDGE * DBL_EPSILON * (fabs(length) + fabs(natural));
}

bool strut_vibration_is_borderline(const strut_vibration *v, int32_t j) {
  const strut_vibration_member *m = &v->member[j];
  const strut_member_table *t = &v->model->members;
  return t->slack[j] > -HUGE_VAL && is_at_edge(m->stretch, m->length, t->rest[j]);
}

bool strut_vibration_element_is_borderline(const strut_vibration *v, int32_t i) {
  const strut_element *e = &v->model->elements.element[i];
  strut_element_pose pose;
  strut_element_evaluate(v->model, i, v->model->members.rest, v->q, (double)NAN, &pose);
  return e->carries && is_at_edge(pose.strain - pose.natural, pose.strain, pose.natural);
}

/* Do the nodes of a strain alone decide it, so that it feels no shift? A foot's is one above the ground. */
static bool is_relative(const strut_element *e) { return e->strain != STRUT_STRAIN_FOOT; }

static void add_element(strut_vibration *v, int32_t i) {
  const strut_element *e = &v->model->elements.element[i];
  const int32_t *place = v->shape->place + strut_places_of_elements(v->model);
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0};
  double d[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_element_pose pose;
  if (!strut_vibration_pose(v, i, &pose)) return;
  strut_element_bend(v->model, i, v->q, pose.force, k);
  int32_t n = 2 * e->nodes;
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++) {
      d[r * n + c] = e->damping * pose.b[r] * pose.b[c];
      k[r * n + c] += pose.slope * pose.b[r] * pose.b[c];
    }
  strut_element_scatter(v->model, i, k, place, v->k);
  strut_element_scatter(v->model, i, d, place, v->d);
}

strut_contact_pose strut_vibration_contact(const strut_vibration *v, int32_t i) {
  strut_contact_pose pose = strut_contact_pose_at(&v->model->contacts, i, v->q, NULL, -1);
  const double *low = v->low + v->model->contacts.at[i];
  pose.gap += low[0] * pose.axes.normal[0] + low[1] * pose.axes.normal[1];
  return pose;
}

static void add_contact(strut_vibration *v, int32_t i) {
  const strut_contact_table *c = &v->model->contacts;
  if (!v->closed[i]) return;
  const strut_contact_pose pose = strut_vibration_contact(v, i);
  const double *n = pose.axes.normal, *t = pose.axes.tangent;
  double across = c->entry[i].stiffness * pose.gap * pose.curvature;
  const int32_t *place =
      v->shape->place + strut_places_of_contacts(v->model) + STRUT_CONTACT_ENTRIES * i;
  for (int a = 0; a < 2; a++)
    for (int b = 0; b <= a; b++, place++) {
      if (*place < 0) continue;
      v->k[*place] += c->entry[i].stiffness * n[a] * n[b] + across * t[a] * t[b];
      v->d[*place] += c->entry[i].damping * n[a] * n[b];
    }
}

/* Where they are at t = 0. */
static void add_sliding_masses(strut_vibration *v) {
  for (int32_t i = 0; i < v->model->sliding.count; i++) {
    const strut_sliding_item *s = &v->model->sliding.item[i];
    const int32_t *place = v->shape->place + STRUT_MEMBER_ENTRIES * s->member;
    const double part[2] = {1.0 - s->start, s->start};
    for (int k = 0; k < STRUT_MEMBER_ENTRIES; k++) {
      const strut_block_entry *e = &strut_block_entries[k];
      if (place[k] < 0 || e->part == 1) continue;
      v->m[place[k]] += s->mass * part[e->row / 2] * part[e->column / 2];
    }
  }
}

static void add_masses(strut_vibration *v) {
  const strut_model *model = v->model;
  const strut_member_table *t = &model->members;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  const int32_t *place = v->shape->place;
  for (int32_t j = 0; j < t->count; j++)
    for (int i = 0; i < STRUT_MEMBER_ENTRIES; i++, place++) {
      const strut_block_entry *e = &strut_block_entries[i];
      if (*place < 0 || e->part == 1 || !(t->mass[j] > 0)) continue; /* x and y are apart */
      if (!e->opposite)
        v->m[*place] += consistent ? t->mass[j] / 3.0 : t->mass[j] / 2.0;
      else if (consistent)
        v->m[*place] += t->mass[j] / 6.0;
    }
  const strut_sparse *a = v->shape->pattern;
  for (int32_t i = 0; i < v->n; i++) {
    v->m[a->start[i]] += model->point_mass[v->shape->coordinate[i] / 2];
    v->own_mass[i] = v->m[a->start[i]];
  }
  add_sliding_masses(v);
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
  const strut_sparse *a = v->shape->pattern;
  memset(v->k, 0, (size_t)a->start[v->n] * sizeof *v->k);
  memset(v->d, 0, (size_t)a->start[v->n] * sizeof *v->d);
  for (int32_t j = 0; j < v->model->members.count; j++) {
    place_member(v, j);
    add_member(v, j);
  }
  for (int32_t i = 0; i < v->model->elements.count; i++) add_element(v, i);
  for (int32_t i = 0; i < v->model->contacts.count; i++) add_contact(v, i);
  bound_spectrum(v);
}

static bool allocate(strut_vibration *v) {
  const strut_model *model = v->model;
  size_t n = (size_t)v->n, entries = (size_t)v->shape->pattern->start[n];
  v->q = strut_arena_allocate(&v->arena, (size_t)model->length, sizeof *v->q);
  v->member = strut_arena_allocate(&v->arena, (size_t)model->members.count, sizeof *v->member);
  v->closed = strut_arena_allocate(&v->arena, (size_t)model->contacts.count, sizeof *v->closed);
  v->k = strut_arena_allocate(&v->arena, entries, sizeof *v->k);
  v->m = strut_arena_allocate(&v->arena, entries, sizeof *v->m);
  v->d = strut_arena_allocate(&v->arena, entries, sizeof *v->d);
  v->low = strut_arena_allocate(&v->arena, (size_t)model->length, sizeof *v->low);
  v->mass = strut_arena_allocate(&v->arena, n, sizeof *v->mass);
  v->own_mass = strut_arena_allocate(&v->arena, n, sizeof *v->own_mass);
  v->work = strut_arena_allocate(&v->arena, n, sizeof *v->work);
  v->idle = strut_arena_allocate(&v->arena, (size_t)model->elements.count, sizeof *v->idle);
  return v->idle && v->low && v->q && v->member && v->closed && v->k && v->m && v->d && v->mass &&
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

static void add_to(double *force, int32_t row, double value) {
  if (row >= 0) force[row] += value;
}

void strut_vibration_force(const strut_vibration *v, double *force) {
  const strut_model *model = v->model;
  const strut_member_table *t = &model->members;
  const int32_t *row_of = v->shape->row_of;
  for (int32_t i = 0; i < v->n; i++) force[i] = v->shape->force[v->shape->coordinate[i]];
  for (int32_t j = 0; j < t->count; j++) {
    const strut_vibration_member *m = &v->member[j];
    if (!m->taut) continue;
    double x = t->stiffness[j] * m->stretch * m->ux, y = t->stiffness[j] * m->stretch * m->uy;
    add_to(force, row_of[t->from[j]], x);
    add_to(force, row_of[t->from[j] + 1], y);
    add_to(force, row_of[t->to[j]], -x);
    add_to(force, row_of[t->to[j] + 1], -y);
  }
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    strut_element_pose pose;
    if (!strut_vibration_pose(v, i, &pose)) continue;
    for (int32_t k = 0; k < 2 * e->nodes; k++)
      add_to(force, row_of[model->elements.at[e->first + k / 2] + (uint32_t)(k % 2)],
             -pose.b[k] * pose.force);
  }
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    if (!v->closed[i]) continue;
    const strut_contact_pose pose = strut_vibration_contact(v, i);
    for (uint32_t k = 0; k < 2; k++)
      add_to(force, row_of[c->at[i] + k], -c->entry[i].stiffness * pose.gap * pose.axes.normal[k]);
  }
}

void strut_vibration_multiply(const strut_vibration *v, const double *matrix, const double *x,
                              double *y) {
  strut_sparse a = *v->shape->pattern;
  a.value = (double *)matrix; /* only read */
  strut_sparse_multiply(&a, x, y);
}

strut_end_displacement strut_vibration_spread(const strut_vibration *v, int32_t j,
                                              const double *x) {
  const strut_member_table *t = &v->model->members;
  const int32_t *row_of = v->shape->row_of;
  double d[2];
  for (uint32_t c = 0; c < 2; c++) {
    int32_t a = row_of[t->from[j] + c], b = row_of[t->to[j] + c];
    d[c] = (b >= 0 ? x[b] : 0.0) - (a >= 0 ? x[a] : 0.0);
  }
  double ux = v->member[j].ux, uy = v->member[j].uy;
  return (strut_end_displacement){ux * d[0] + uy * d[1], ux * d[1] - uy * d[0]};
}

double strut_vibration_relative(const strut_vibration *v, int32_t element, int32_t k,
                                const double *x) {
  const strut_element *e = &v->model->elements.element[element];
  const uint32_t *at = v->model->elements.at + e->first;
  uint32_t axis = (uint32_t)(k % 2);
  int32_t own = v->shape->row_of[at[k / 2] + axis];
  int32_t last = is_relative(e) ? v->shape->row_of[at[e->nodes - 1] + axis] : -1;
  return (own >= 0 ? x[own] : 0.0) - (last >= 0 ? x[last] : 0.0);
}

double strut_vibration_strain(const strut_vibration *v, int32_t element,
                              const strut_element_pose *pose, const double *x) {
  const strut_element *e = &v->model->elements.element[element];
  double sum = 0.0;
  int32_t nodes = is_relative(e) ? e->nodes - 1 : e->nodes;
  for (int32_t k = 0; k < 2 * nodes; k++)
    sum += pose->b[k] * strut_vibration_relative(v, element, k, x);
  return sum;
}

/* Relative rounding of a difference of coordinates, and of an energy made of it. */
static const double BITS = 2.0 * DBL_EPSILON;

/* Adds k along^2, where `along` was made of motions of size `far`. */
static void add_square(double stiffness, double along, double far, strut_vibration_energy *sum) {
  double bits = BITS * far;
  sum->value += stiffness * along * along;
  sum->rounding += fabs(stiffness) * bits * (2.0 * fabs(along) + bits);
}

static void add_member_energy(const strut_vibration *v, int32_t j, const double *x,
                              strut_vibration_energy *sum) {
  const strut_vibration_member *m = &v->member[j];
  if (!m->taut) return;
  const strut_end_displacement d = strut_vibration_spread(v, j, x);
  double across = m->across * d.across * d.across;
  add_square(v->model->members.stiffness[j], d.along, hypot(d.along, d.across), sum);
  sum->value += across;
  sum->rounding += BITS * fabs(across);
}

static void add_element_energy(const strut_vibration *v, int32_t i, const double *x,
                               strut_vibration_energy *sum) {
  const strut_element *e = &v->model->elements.element[i];
  const uint32_t *at = v->model->elements.at + e->first;
  strut_element_pose pose;
  if (!strut_vibration_pose(v, i, &pose)) return;
  double far = 0.0, blur = BITS; /* relative, of second derivatives */
  for (int32_t k = 0; k < e->nodes && e->strain == STRUT_STRAIN_ANGLE; k++) {
    const double *place = v->q + at[k];
    blur += 2.0 * hypot(pose.b[2 * k], pose.b[2 * k + 1]) * strut_coordinate_rounding(place, place);
  }
  for (int32_t k = 0; k < 2 * e->nodes; k++)
    far += fabs(pose.b[k] * strut_vibration_relative(v, i, k, x));
  const strut_element_bow bow = strut_vibration_bow(v, i, x);
  add_square(pose.slope, strut_vibration_strain(v, i, &pose, x), far, sum);
  sum->value += pose.force * bow.sum;
  sum->rounding += blur * fabs(pose.force) * bow.size;
}

static void add_contact_energy(const strut_vibration *v, int32_t i, const double *x,
                               strut_vibration_energy *sum) {
  const strut_contact_table *c = &v->model->contacts;
  if (!v->closed[i]) return;
  const strut_contact_pose pose = strut_vibration_contact(v, i);
  const double *n = pose.axes.normal, *t = pose.axes.tangent;
  double d[2], stiffness = c->entry[i].stiffness;
  for (uint32_t k = 0; k < 2; k++) {
    int32_t row = v->shape->row_of[c->at[i] + k];
    d[k] = row >= 0 ? x[row] : 0.0;
  }
  add_square(stiffness, n[0] * d[0] + n[1] * d[1], hypot(d[0], d[1]), sum);
  add_square(stiffness * pose.gap * pose.curvature, t[0] * d[0] + t[1] * d[1], hypot(d[0], d[1]),
             sum);
}

strut_element_bow strut_vibration_bow(const strut_vibration *v, int32_t i, const double *x) {
  const strut_element *e = &v->model->elements.element[i];
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0};
  strut_element_bow bow = {0.0, 0.0};
  strut_element_bend(v->model, i, v->q, 1.0, bend);
  int32_t n = 2 * e->nodes;
  for (int32_t r = 0; r < n; r++) {
    double own = strut_vibration_relative(v, i, r, x);
    for (int32_t c = 0; c < n; c++) {
      double part = own * bend[r * n + c] * strut_vibration_relative(v, i, c, x);
      bow.sum += part, bow.size += fabs(part);
    }
  }
  return bow;
}

strut_vibration_energy strut_vibration_energy_of(const strut_vibration *v, const double *x) {
  strut_vibration_energy sum = {0.0, 0.0};
  for (int32_t j = 0; j < v->model->members.count; j++) add_member_energy(v, j, x, &sum);
  for (int32_t i = 0; i < v->model->elements.count; i++) add_element_energy(v, i, x, &sum);
  for (int32_t i = 0; i < v->model->contacts.count; i++) add_contact_energy(v, i, x, &sum);
  return sum;
}
