/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/forces/tangent.h"

static const double EDGE =
    8.0; /* last bits that a length and a rest length are known to, together */

static void place_member(strut_vibration *v, int32_t j) {
  const strut_member_table *t = &v->model->members;
  strut_vibration_member *m = &v->member[j];
  uint32_t a = t->from[j], b = t->to[j];
  strut_dd dx = dd_sub(v->q[b], v->q[a]), dy = dd_sub(v->q[b + 1], v->q[a + 1]);
  strut_dd length = dd_length(dx, dy);
  bool any = length.hi > 0;
  m->length = length.hi;
  m->stretch = dd_sub(length, dd_of(t->rest[j]));
  m->taut = m->state ? m->state > 0 : dd_double(m->stretch) > t->slack[j];
  m->ux = any ? dd_div(dx, length) : dd_of(0.0);
  m->uy = any ? dd_div(dy, length) : dd_of(0.0);
  /* of zero length and zero rest length: an isotropic spring */
  if (any)
    m->across = dd_div(dd_scale(m->stretch, t->stiffness[j]), length);
  else
    m->across = dd_of(t->rest[j] > 0 ? 0.0 : t->stiffness[j]);
}

static void add_member(strut_vibration *v, int32_t j) {
  const strut_vibration_member *m = &v->member[j];
  if (!m->taut) return;
  strut_dd along = dd_sub(dd_of(v->model->members.stiffness[j]), m->across);
  strut_dd block[3] = {dd_add(m->across, dd_mul(along, dd_mul(m->ux, m->ux))),
                       dd_mul(along, dd_mul(m->ux, m->uy)),
                       dd_add(m->across, dd_mul(along, dd_mul(m->uy, m->uy)))};
  const strut_stiffness_block damper =
      strut_block_of(v->model->members.damping[j], 0.0, (strut_vec2){m->ux.hi, m->uy.hi});
  const int32_t *place = v->shape->place + STRUT_MEMBER_ENTRIES * j;
  for (int i = 0; i < STRUT_MEMBER_ENTRIES; i++, place++) {
    const strut_block_entry *e = &strut_block_entries[i];
    if (*place < 0) continue;
    strut_dd part = e->opposite ? dd_negative(block[e->part]) : block[e->part];
    v->k[*place] = dd_add(v->k[*place], part);
  }
  strut_block_scatter(&damper, STRUT_MEMBER_ENTRIES, place - STRUT_MEMBER_ENTRIES, v->d);
}

/* Elements have strains and gradients in a double, which rounds their directions alone. */
typedef struct element_sum {
  strut_vibration *vibration;
  strut_dd *force; /* NULL: stiffness and damping */
} element_sum;

bool strut_vibration_pose(const strut_vibration *v, int32_t i, strut_element_pose *pose) {
  const strut_element *e = &v->model->elements.element[i];
  const uint32_t *at = v->model->elements.at + e->first;
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0}, low[STRUT_MOST_GRADIENT];
  double change = 0.0;
  int32_t n = 2 * e->nodes;
  bool any = false;
  strut_element_evaluate(v->model, i, v->model->members.rest, v->rounded, (double)NAN, pose);
  if (v->idle[i]) pose->acts = false;
  for (int32_t k = 0; k < n; k++) {
    low[k] = v->q[at[k / 2] + (uint32_t)(k % 2)].lo;
    any = any || low[k] != 0.0;
    change += pose->b[k] * low[k];
  }
  if (!any || !pose->acts) return pose->acts;
  strut_element_bend(v->model, i, v->rounded, 1.0, bend);
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
  return t->slack[j] > -HUGE_VAL && is_at_edge(dd_double(m->stretch), m->length, t->rest[j]);
}

bool strut_vibration_element_is_borderline(const strut_vibration *v, int32_t i) {
  const strut_element *e = &v->model->elements.element[i];
  strut_element_pose pose;
  strut_element_evaluate(v->model, i, v->model->members.rest, v->rounded, (double)NAN, &pose);
  return e->carries && is_at_edge(pose.strain - pose.natural, pose.strain, pose.natural);
}

/* Do the nodes of a strain alone decide it, so that it feels no shift? A foot's is one above the ground. */
static bool is_relative(const strut_element *e) { return e->strain != STRUT_STRAIN_FOOT; }

/* The gradient with a last node that makes its sum vanish to all digits: a shift costs nothing. */
static void balance_gradient(const strut_element *e, const strut_element_pose *pose, strut_dd *b) {
  int32_t nodes = e->nodes;
  for (int32_t k = 0; k < 2 * nodes; k++) b[k] = dd_of(pose->b[k]);
  for (int32_t c = 0; c < 2 && is_relative(e); c++) {
    strut_dd sum = dd_of(0.0);
    for (int32_t k = 0; k + 1 < nodes; k++) sum = dd_add(sum, b[2 * k + c]);
    b[2 * (nodes - 1) + c] = dd_negative(sum);
  }
}

/* Entry r, c of a second derivative, those of one node from the others', likewise. */
static strut_dd balanced_entry(const double *k, int32_t n, int32_t r, int32_t c) {
  if (r / 2 != c / 2) return dd_of(k[r * n + c]);
  strut_dd sum = dd_of(0.0);
  for (int32_t other = c % 2; other < n; other += 2)
    if (other / 2 != c / 2) sum = dd_sub(sum, dd_of(k[r * n + other]));
  return sum;
}

static void add_element(void *context, int32_t i, const strut_element_pose *rounded) {
  strut_vibration *v = ((const element_sum *)context)->vibration;
  strut_element_pose sharp, *pose = &sharp;
  (void)rounded;
  if (!strut_vibration_pose(v, i, pose)) return;
  const strut_element *e = &v->model->elements.element[i];
  const int32_t *place = v->shape->place + strut_places_of_elements(v->model);
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  int32_t n = 2 * e->nodes;
  memset(k, 0, sizeof k);
  strut_element_bend(v->model, i, v->rounded, pose->force, k);
  const int32_t *own = place + e->place;
  strut_dd b[STRUT_MOST_GRADIENT];
  balance_gradient(e, pose, b);
  const uint32_t *at = v->model->elements.at + e->first;
  for (int32_t r = 0; r < n;
       r++) /* a sum of squares to all digits, so that soft motions stay soft */
    for (int32_t c = 0; c <= r; c++, own++) {
      if (*own < 0) continue;
      bool both = r != c && at[r / 2] == at[c / 2] && r % 2 == c % 2; /* a node met twice */
      strut_dd entry = dd_scale(dd_mul(b[r], b[c]), pose->slope);
      entry = dd_add(entry, balanced_entry(k, n, r, c));
      v->k[*own] = dd_add(v->k[*own], both ? dd_add(entry, entry) : entry);
    }
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++) k[r * n + c] = e->damping * pose->b[r] * pose->b[c];
  strut_element_scatter(v->model, i, k, place, v->d);
}

static void add_element_force(void *context, int32_t i, const strut_element_pose *rounded) {
  const element_sum *s = context;
  strut_element_pose sharp, *pose = &sharp;
  (void)rounded;
  if (!strut_vibration_pose(s->vibration, i, pose)) return;
  const strut_element_table *t = &s->vibration->model->elements;
  const strut_element *e = &t->element[i];
  strut_dd b[STRUT_MOST_GRADIENT];
  balance_gradient(e, pose, b);
  for (int32_t k = 0; k < 2 * e->nodes; k++) {
    int32_t row = s->vibration->shape->row_of[t->at[e->first + k / 2] + (uint32_t)(k % 2)];
    if (row >= 0) s->force[row] = dd_sub(s->force[row], dd_scale(b[k], pose->force));
  }
}

static void add_elements(strut_vibration *v) {
  element_sum sum = {v, NULL};
  if (!v->model->elements.count) return;
  for (int32_t i = 0; i < v->model->length; i++) v->rounded[i] = dd_double(v->q[i]);
  strut_elements_visit(v->model, v->model->members.rest, v->rounded, -HUGE_VAL, false, &sum,
                       add_element);
}

strut_contact_pose strut_vibration_contact(const strut_vibration *v, int32_t i) {
  const strut_contact_table *c = &v->model->contacts;
  double q[2] = {dd_double(v->q[c->at[i]]), dd_double(v->q[c->at[i] + 1])};
  strut_contact_pose pose = {.axes = c->axes};
  if (c->surface) strut_surface_find(&c->surface[c->surface_of[i]], q, -1, &pose);
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
      strut_dd nn = dd_product(n[a], n[b]);
      v->k[*place] = dd_add(v->k[*place], dd_scale(nn, c->entry[i].stiffness));
      if (pose.curvature != 0.0)
        v->k[*place] = dd_add(v->k[*place], dd_scale(dd_product(t[a], t[b]), across));
      v->d[*place] += c->entry[i].damping * nn.hi;
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
  double *sum = (double *)v->work;
  memset(sum, 0, (size_t)v->n * sizeof *sum);
  for (int32_t j = 0; j < v->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      sum[j] += fabs(v->k[at].hi);
      if (a->row[at] != j) sum[a->row[at]] += fabs(v->k[at].hi);
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
  add_elements(v);
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
  v->rounded = strut_arena_allocate(&v->arena, (size_t)model->length, sizeof *v->rounded);
  v->mass = strut_arena_allocate(&v->arena, n, sizeof *v->mass);
  v->own_mass = strut_arena_allocate(&v->arena, n, sizeof *v->own_mass);
  v->work = strut_arena_allocate(&v->arena, n, sizeof *v->work);
  v->idle = strut_arena_allocate(&v->arena, (size_t)model->elements.count, sizeof *v->idle);
  return v->idle && v->rounded && v->q && v->member && v->closed && v->k && v->m && v->d &&
         v->mass && v->own_mass && v->work;
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
  for (int32_t i = 0; i < model->length; i++) v->q[i] = dd_of(q[i]);
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

static void add_to(strut_dd *force, int32_t row, strut_dd value) {
  if (row >= 0) force[row] = dd_add(force[row], value);
}

void strut_vibration_force(const strut_vibration *v, strut_dd *force) {
  const strut_model *model = v->model;
  const strut_member_table *t = &model->members;
  const int32_t *row_of = v->shape->row_of;
  for (int32_t i = 0; i < v->n; i++) force[i] = dd_of(v->shape->force[v->shape->coordinate[i]]);
  for (int32_t j = 0; j < t->count; j++) {
    const strut_vibration_member *m = &v->member[j];
    if (!m->taut) continue;
    strut_dd pull = dd_scale(m->stretch, t->stiffness[j]);
    strut_dd x = dd_mul(pull, m->ux), y = dd_mul(pull, m->uy);
    add_to(force, row_of[t->from[j]], x);
    add_to(force, row_of[t->from[j] + 1], y);
    add_to(force, row_of[t->to[j]], dd_negative(x));
    add_to(force, row_of[t->to[j] + 1], dd_negative(y));
  }
  element_sum elements = {(strut_vibration *)v, force};
  strut_elements_visit(model, t->rest, v->rounded, -HUGE_VAL, false, &elements, add_element_force);
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    if (!v->closed[i]) continue;
    uint32_t at = c->at[i];
    const strut_contact_pose pose = strut_vibration_contact(v, i);
    const double *n = pose.axes.normal;
    strut_dd gap =
        dd_add(dd_scale(v->q[at], n[0]), dd_scale(dd_sub(v->q[at + 1], dd_of(c->height)), n[1]));
    if (c->surface) gap = dd_of(pose.gap);
    strut_dd push = dd_scale(gap, -c->entry[i].stiffness);
    add_to(force, row_of[at], dd_scale(push, n[0]));
    add_to(force, row_of[at + 1], dd_scale(push, n[1]));
  }
}

void strut_vibration_stiffness(const strut_vibration *v, const strut_dd *x, strut_dd *y) {
  const strut_sparse *a = v->shape->pattern;
  for (int32_t i = 0; i < v->n; i++) y[i] = dd_of(0.0);
  for (int32_t j = 0; j < v->n; j++) {
    strut_dd sum = dd_mul(v->k[a->start[j]], x[j]);
    for (int32_t at = a->start[j] + 1; at < a->start[j + 1]; at++) {
      y[a->row[at]] = dd_add(y[a->row[at]], dd_mul(v->k[at], x[j]));
      sum = dd_add(sum, dd_mul(v->k[at], x[a->row[at]]));
    }
    y[j] = dd_add(y[j], sum);
  }
}

void strut_vibration_mass(const strut_vibration *v, const strut_dd *x, strut_dd *y) {
  const strut_sparse *a = v->shape->pattern;
  for (int32_t i = 0; i < v->n; i++) y[i] = dd_of(0.0);
  for (int32_t j = 0; j < v->n; j++) {
    strut_dd sum = dd_scale(x[j], v->m[a->start[j]]);
    for (int32_t at = a->start[j] + 1; at < a->start[j + 1]; at++) {
      if (!(v->m[at] > 0)) continue;
      y[a->row[at]] = dd_add(y[a->row[at]], dd_scale(x[j], v->m[at]));
      sum = dd_add(sum, dd_scale(x[a->row[at]], v->m[at]));
    }
    y[j] = dd_add(y[j], sum);
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
  double ux = v->member[j].ux.hi, uy = v->member[j].uy.hi;
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
