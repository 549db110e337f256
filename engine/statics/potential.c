/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/potential.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/forces/tangent.h"

static void sum_forces(strut_potential *p) {
  const strut_model *model = p->model;
  const strut_scene *scene = model->scene;
  double g = hypot(scene->gravity[0], scene->gravity[1]);
  if (model->constant_force)
    memcpy(p->force, model->constant_force, (size_t)model->length * sizeof *p->force);
  for (int32_t i = 0; i < model->node_count; i++) p->force_scale += g * model->weight[i];
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal < 0)
      p->force_scale += hypot(scene->loads[i].force[0], scene->loads[i].force[1]) +
                        fabs(scene->loads[i].moment) / (model->size > 0 ? model->size : 1.0);
}

static bool make_pattern(strut_potential *p) {
  const strut_model *model = p->model;
  size_t most = strut_tangent_entries(model, true);
  strut_arena scratch = {0};
  strut_triplets sum = {0};
  p->place = strut_arena_allocate(&p->arena, most, sizeof *p->place);
  if (p->place && strut_triplets_reserve(&sum, most, &scratch)) {
    strut_tangent_add_pattern(model, p->row_of, true, &sum);
    p->pattern = strut_sparse_build(p->n, &sum, &p->arena);
  }
  strut_arena_free(&scratch);
  if (!p->pattern) return false;
  strut_tangent_find_places(model, p->row_of, true, p->pattern, p->place);
  return true;
}

strut_status strut_potential_create(const strut_model *model, const uint8_t *held, bool ground,
                                    strut_potential **potential, strut_error *error) {
  size_t length = (size_t)model->length;
  strut_potential *p = *potential = strut_allocate(1, sizeof *p);
  if (!p) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  p->model = model;
  p->ground = ground;
  p->coordinate = strut_arena_allocate(&p->arena, length, sizeof *p->coordinate);
  p->row_of = strut_arena_allocate(&p->arena, length, sizeof *p->row_of);
  p->force = strut_arena_allocate(&p->arena, length, sizeof *p->force);
  if (p->coordinate && p->row_of && p->force) {
    p->n = strut_number_free(model, held, p->row_of, p->coordinate);
    sum_forces(p);
    if (make_pattern(p)) return STRUT_OK;
  }
  strut_potential_free(p);
  *potential = NULL;
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
}

void strut_potential_free(strut_potential *potential) {
  if (!potential) return;
  strut_arena_free(&potential->arena);
  strut_release(potential);
}

static double elastic_energy(const strut_potential *p, const double *q) {
  const strut_member_table *t = &p->model->members;
  double sum = 0.0;
  for (int32_t j = 0; j < t->count; j++) {
    strut_member_pose m = strut_member_pose_at(t, t->rest, j, q);
    sum += strut_member_elastic_energy(t, j, &m);
  }
  if (p->model->elements.count) sum += strut_elements_energy(p->model, t->rest, NULL, q, NULL);
  return sum;
}

double strut_potential_value(const strut_potential *p, const double *q) {
  return strut_potential_value_near(p, q, q);
}

double strut_potential_value_near(const strut_potential *p, const double *q, const double *near) {
  const strut_contact_table *c = &p->model->contacts;
  double sum = elastic_energy(p, q), work = 0.0;
  for (int32_t at = 0; at < 2 * p->model->node_count; at++) work += p->force[at] * q[at];
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    double gap = strut_contact_gap(c, i, q);
    if (gap < 0.0) sum += 0.5 * c->entry[i].stiffness * gap * gap;
  }
  return sum - work + strut_couples_potential(p->model, near, q);
}

double strut_potential_energy(const strut_potential *p, const double *q) {
  const double *g = p->model->scene->gravity, *weight = p->model->weight;
  double sum = 0.0;
  for (int32_t i = 0; i < p->model->node_count; i++)
    sum += weight[i] * (g[0] * q[2 * i] + g[1] * q[2 * i + 1]);
  return elastic_energy(p, q) - sum;
}

/* Forces of elements: added to (length) forces, or taken from a gradient over the free rows. */
typedef struct element_sum {
  const strut_potential *potential;
  double *sum;
  bool gradient;
} element_sum;

static void add_element_force(void *context, int32_t element, const strut_element_pose *pose) {
  const element_sum *s = context;
  const strut_element_table *t = &s->potential->model->elements;
  const strut_element *e = &t->element[element];
  for (int32_t k = 0; k < 2 * e->nodes; k++) {
    uint32_t at = t->at[e->first + k / 2] + (uint32_t)(k % 2);
    int32_t row = s->potential->row_of[at];
    if (!s->gradient)
      s->sum[at] -= pose->force * pose->b[k];
    else if (row >= 0)
      s->sum[row] += pose->force * pose->b[k];
  }
}

void strut_potential_force(const strut_potential *p, const double *q, double *force) {
  const strut_member_table *t = &p->model->members;
  const strut_contact_table *c = &p->model->contacts;
  memcpy(force, p->force, (size_t)p->model->length * sizeof *force);
  for (int32_t j = 0; j < t->count; j++) {
    strut_member_pose m = strut_member_pose_at(t, t->rest, j, q);
    if (!m.taut) continue;
    double tension = t->stiffness[j] * m.stretch, fx = tension * m.unit.x, fy = tension * m.unit.y;
    double *a = force + t->from[j], *b = force + t->to[j];
    a[0] += fx, a[1] += fy, b[0] -= fx, b[1] -= fy;
  }
  element_sum elements = {p, force, false};
  strut_elements_visit(p->model, t->rest, q, -HUGE_VAL, false, &elements, add_element_force);
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    strut_contact_pose pose = strut_contact_pose_at(c, i, q, NULL, -1);
    double *f = force + c->at[i];
    if (!(pose.gap < 0.0)) continue;
    double push = -c->entry[i].stiffness * pose.gap;
    f[0] += push * pose.axes.normal[0], f[1] += push * pose.axes.normal[1];
  }
}

/* The same sums in the same order as the force, kept where they are free. */
void strut_potential_gradient(const strut_potential *p, const double *q, double *g) {
  const strut_member_table *t = &p->model->members;
  const strut_contact_table *c = &p->model->contacts;
  const int32_t *row = p->row_of;
  for (int32_t i = 0; i < p->n; i++) g[i] = -p->force[p->coordinate[i]];
  for (int32_t j = 0; j < t->count; j++) {
    strut_member_pose m = strut_member_pose_at(t, t->rest, j, q);
    if (!m.taut) continue;
    double tension = t->stiffness[j] * m.stretch, fx = tension * m.unit.x, fy = tension * m.unit.y;
    const int32_t *a = row + t->from[j], *b = row + t->to[j];
    if (a[0] >= 0) g[a[0]] -= fx;
    if (a[1] >= 0) g[a[1]] -= fy;
    if (b[0] >= 0) g[b[0]] += fx;
    if (b[1] >= 0) g[b[1]] += fy;
  }
  element_sum elements = {p, g, true};
  strut_elements_visit(p->model, t->rest, q, -HUGE_VAL, false, &elements, add_element_force);
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    strut_contact_pose pose = strut_contact_pose_at(c, i, q, NULL, -1);
    const int32_t *a = row + c->at[i];
    if (!(pose.gap < 0.0)) continue;
    double push = -c->entry[i].stiffness * pose.gap;
    if (a[0] >= 0) g[a[0]] -= push * pose.axes.normal[0];
    if (a[1] >= 0) g[a[1]] -= push * pose.axes.normal[1];
  }
}

typedef struct rounding_sum {
  const strut_potential *potential;
  const double *q;
  double largest;
} rounding_sum;

/* The last bits of the coordinates, through the gradient to the strain, and back to a force. */
static void add_element_rounding(void *context, int32_t element, const strut_element_pose *pose) {
  rounding_sum *s = context;
  const strut_element_table *t = &s->potential->model->elements;
  const strut_element *e = &t->element[element];
  double bits = fabs(pose->strain) * DBL_EPSILON, steepest = 0.0;
  for (int32_t k = 0; k < e->nodes; k++) {
    const double *at = s->q + t->at[e->first + k];
    double slope = fmax(fabs(pose->b[2 * k]), fabs(pose->b[2 * k + 1]));
    bits = fmax(bits, slope * strut_coordinate_rounding(at, at));
    steepest = fmax(steepest, slope);
  }
  double force = fabs(pose->slope) * bits + fabs(pose->force) * DBL_EPSILON;
  s->largest = fmax(s->largest, steepest * force);
}

double strut_potential_rounding(const strut_potential *p, const double *q) {
  const strut_member_table *t = &p->model->members;
  const strut_contact_table *c = &p->model->contacts;
  double largest = 0.0, forces = 0.0;
  for (int32_t at = 0; at < 2 * p->model->node_count; at++)
    if (p->row_of[at] >= 0) forces = fmax(forces, fabs(p->force[at]));
  for (int32_t j = 0; j < t->count; j++) {
    const int32_t *a = p->row_of + t->from[j], *b = p->row_of + t->to[j];
    strut_member_pose m = strut_member_pose_at(t, t->rest, j, q);
    if (!m.taut || (a[0] < 0 && a[1] < 0 && b[0] < 0 && b[1] < 0)) continue;
    double bit = strut_coordinate_rounding(q + t->from[j], q + t->to[j]);
    largest = fmax(largest, t->stiffness[j] * (bit + fabs(m.stretch) * DBL_EPSILON));
  }
  rounding_sum elements = {p, q, largest};
  strut_elements_visit(p->model, t->rest, q, -HUGE_VAL, false, &elements, add_element_rounding);
  largest = elements.largest;
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    const double *at = q + c->at[i];
    double gap = strut_contact_gap(c, i, q);
    if (gap < 0.0)
      largest = fmax(largest, c->entry[i].stiffness * strut_coordinate_rounding(at, at));
  }
  return largest + forces * DBL_EPSILON;
}

double strut_stiffest(const strut_model *model) {
  double stiffest = 0.0;
  for (int32_t j = 0; j < model->members.count; j++)
    stiffest = fmax(stiffest, model->members.stiffness[j]);
  for (int32_t i = 0; i < model->elements.count; i++)
    stiffest = fmax(stiffest, strut_element_stiffest(model, i));
  return stiffest;
}

strut_sparse *strut_potential_matrix(const strut_potential *p, strut_arena *arena) {
  const strut_sparse *pattern = p->pattern;
  strut_sparse *matrix = strut_arena_allocate(arena, 1, sizeof *matrix);
  if (!matrix) return NULL;
  *matrix = *pattern; /* rows and columns are shared: they never change */
  matrix->value = strut_arena_allocate(arena, (size_t)pattern->start[p->n], sizeof(double));
  return matrix->value ? matrix : NULL;
}

void strut_potential_hessian(const strut_potential *p, const double *q, strut_sparse *hessian) {
  strut_potential_hessian_above(p, q, 0.0, hessian);
}

typedef struct hessian_sum {
  const strut_potential *potential;
  const double *q;
  double *value;
} hessian_sum;

static void add_member(void *context, int32_t j, const strut_member_tangent *m) {
  const hessian_sum *sum = context;
  const strut_stiffness_block block = strut_block_of(m->along, m->across, m->pose.unit);
  const int32_t *place = sum->potential->place + STRUT_MEMBER_ENTRIES * j;
  strut_block_scatter(&block, STRUT_MEMBER_ENTRIES, place, sum->value);
}

static void add_element(void *context, int32_t i, const strut_element_pose *pose) {
  const hessian_sum *sum = context;
  const strut_model *model = sum->potential->model;
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  strut_element_stiffness(model, i, pose, sum->q, k);
  strut_element_scatter(model, i, k, sum->potential->place + strut_places_of_elements(model),
                        sum->value);
}

static void add_contact(void *context, int32_t i, const strut_closed_contact *contact) {
  const hessian_sum *sum = context;
  const strut_model *model = sum->potential->model;
  const strut_stiffness_block block =
      strut_block_of_pose(contact->stiffness, contact->across, &contact->axes);
  const int32_t *place = sum->potential->place + strut_places_of_contacts(model);
  strut_block_scatter(&block, STRUT_CONTACT_ENTRIES, place + STRUT_CONTACT_ENTRIES * i, sum->value);
}

void strut_potential_hessian_above(const strut_potential *p, const double *q, double least,
                                   strut_sparse *hessian) {
  assert(hessian->n == p->n);
  hessian_sum sum = {p, q, hessian->value};
  memset(sum.value, 0, (size_t)hessian->start[hessian->n] * sizeof *sum.value);
  strut_tangent_visit(p->model, q, p->model->members.rest, least,
                      p->ground ? STRUT_CLOSED_TOUCHING : STRUT_CLOSED_NONE, &sum, add_member,
                      add_element, add_contact);
}
