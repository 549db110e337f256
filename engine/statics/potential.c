/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/potential.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Entries of the lower triangle of a member's 4 x 4 block, and of a contact's 2 x 2 one. */
enum { MEMBER_ENTRIES = 10, CONTACT_ENTRIES = 3 };

static void number_coordinates(strut_potential *p, const uint8_t *held) {
  const strut_model *model = p->model;
  for (int32_t at = 0; at < model->length; at++) {
    bool free = at < 2 * model->node_count && !model->fixed[at] && !(held && held[at]);
    p->row_of[at] = free ? p->n : -1;
    if (free) p->coordinate[p->n++] = at;
  }
}

static void sum_forces(strut_potential *p) {
  const strut_model *model = p->model;
  const strut_scene *scene = model->scene;
  double g = hypot(scene->gravity[0], scene->gravity[1]);
  if (model->constant_force)
    memcpy(p->force, model->constant_force, (size_t)model->length * sizeof *p->force);
  for (int32_t i = 0; i < model->node_count; i++) p->force_scale += g * model->weight[i];
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal < 0)
      p->force_scale += hypot(scene->loads[i].force[0], scene->loads[i].force[1]);
}

/* The rows of a member's x and y at one end, x and y at the other. */
static void member_rows(const strut_potential *p, int32_t j, int32_t row[4]) {
  uint32_t a = p->model->members.from[j], b = p->model->members.to[j];
  row[0] = p->row_of[a], row[1] = p->row_of[a + 1];
  row[2] = p->row_of[b], row[3] = p->row_of[b + 1];
}

static void add_pattern(const int32_t *row, int count, strut_triplets *sum) {
  for (int i = 0; i < count; i++)
    for (int j = 0; j <= i; j++)
      if (row[i] >= 0 && row[j] >= 0) strut_triplets_add(sum, row[i], row[j], 0.0);
}

/* Where entry (row, column) stands in the pattern's values; it is there. */
static int32_t find_place(const strut_sparse *pattern, int32_t row, int32_t column) {
  int32_t low = pattern->start[column], high = pattern->start[column + 1] - 1;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (pattern->row[middle] < row)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static int32_t *find_places(const strut_potential *p, const int32_t *row, int count,
                            int32_t *place) {
  for (int i = 0; i < count; i++)
    for (int j = 0; j <= i; j++, place++) {
      bool there = row[i] >= 0 && row[j] >= 0;
      *place = !there            ? -1
               : row[i] > row[j] ? find_place(p->pattern, row[i], row[j])
                                 : find_place(p->pattern, row[j], row[i]);
    }
  return place;
}

static bool make_pattern(strut_potential *p) {
  const strut_model *model = p->model;
  size_t members = (size_t)model->members.count, contacts = (size_t)model->contacts.count;
  size_t most = MEMBER_ENTRIES * members + CONTACT_ENTRIES * contacts;
  strut_arena scratch = {0};
  strut_triplets sum = {0};
  p->place = strut_arena_allocate(&p->arena, most, sizeof *p->place);
  if (p->place && strut_triplets_reserve(&sum, most, &scratch)) {
    int32_t row[4];
    for (int32_t j = 0; j < model->members.count; j++) {
      member_rows(p, j, row);
      add_pattern(row, 4, &sum);
    }
    for (int32_t i = 0; i < model->contacts.count; i++)
      add_pattern(p->row_of + model->contacts.at[i], 2, &sum);
    p->pattern = strut_sparse_build(p->n, &sum, &p->arena);
  }
  strut_arena_free(&scratch);
  if (!p->pattern) return false;
  int32_t *place = p->place, row[4];
  for (int32_t j = 0; j < model->members.count; j++) {
    member_rows(p, j, row);
    place = find_places(p, row, 4, place);
  }
  for (int32_t i = 0; i < model->contacts.count; i++)
    place = find_places(p, p->row_of + model->contacts.at[i], 2, place);
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
    number_coordinates(p, held);
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

/* A member as it lies. */
typedef struct pose {
  double length, stretch;
  double ux, uy; /* from its first node to the second; 0 where it has no length */
  bool taut;     /* pulls or pushes */
} pose;

static inline pose pose_of(const strut_member_table *t, int32_t j, const double *q) {
  const double *a = q + t->from[j], *b = q + t->to[j];
  double dx = b[0] - a[0], dy = b[1] - a[1], length = sqrt(dx * dx + dy * dy);
  pose m = {.length = length, .stretch = length - t->rest[j]};
  m.taut = m.stretch > t->slack[j];
  if (length > 0) m.ux = dx / length, m.uy = dy / length;
  return m;
}

/* How far a contact's node lies above the ground, below 0 where it touches. */
static inline double gap_of(const strut_contact_table *c, int32_t i, const double *q) {
  const double *at = q + c->at[i];
  return at[0] * c->normal[0] + (at[1] - c->height) * c->normal[1];
}

static double elastic_energy(const strut_potential *p, const double *q) {
  const strut_member_table *t = &p->model->members;
  double sum = 0.0;
  for (int32_t j = 0; j < t->count; j++) {
    pose m = pose_of(t, j, q);
    if (m.taut) sum += 0.5 * t->stiffness[j] * m.stretch * m.stretch;
  }
  return sum;
}

double strut_potential_value(const strut_potential *p, const double *q) {
  const strut_contact_table *c = &p->model->contacts;
  double sum = elastic_energy(p, q), work = 0.0;
  for (int32_t at = 0; at < 2 * p->model->node_count; at++) work += p->force[at] * q[at];
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    double gap = gap_of(c, i, q);
    if (gap < 0.0) sum += 0.5 * c->entry[i].stiffness * gap * gap;
  }
  return sum - work;
}

double strut_potential_energy(const strut_potential *p, const double *q) {
  const double *g = p->model->scene->gravity, *weight = p->model->weight;
  double sum = 0.0;
  for (int32_t i = 0; i < p->model->node_count; i++)
    sum += weight[i] * (g[0] * q[2 * i] + g[1] * q[2 * i + 1]);
  return elastic_energy(p, q) - sum;
}

void strut_potential_force(const strut_potential *p, const double *q, double *force) {
  const strut_member_table *t = &p->model->members;
  const strut_contact_table *c = &p->model->contacts;
  memcpy(force, p->force, (size_t)p->model->length * sizeof *force);
  for (int32_t j = 0; j < t->count; j++) {
    pose m = pose_of(t, j, q);
    if (!m.taut) continue;
    double tension = t->stiffness[j] * m.stretch, fx = tension * m.ux, fy = tension * m.uy;
    double *a = force + t->from[j], *b = force + t->to[j];
    a[0] += fx, a[1] += fy, b[0] -= fx, b[1] -= fy;
  }
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    double gap = gap_of(c, i, q), *f = force + c->at[i];
    if (!(gap < 0.0)) continue;
    double push = -c->entry[i].stiffness * gap;
    f[0] += push * c->normal[0], f[1] += push * c->normal[1];
  }
}

/* The same sums in the same order as the force, kept where they are free. */
void strut_potential_gradient(const strut_potential *p, const double *q, double *g) {
  const strut_member_table *t = &p->model->members;
  const strut_contact_table *c = &p->model->contacts;
  const int32_t *row = p->row_of;
  for (int32_t i = 0; i < p->n; i++) g[i] = -p->force[p->coordinate[i]];
  for (int32_t j = 0; j < t->count; j++) {
    pose m = pose_of(t, j, q);
    if (!m.taut) continue;
    double tension = t->stiffness[j] * m.stretch, fx = tension * m.ux, fy = tension * m.uy;
    const int32_t *a = row + t->from[j], *b = row + t->to[j];
    if (a[0] >= 0) g[a[0]] -= fx;
    if (a[1] >= 0) g[a[1]] -= fy;
    if (b[0] >= 0) g[b[0]] += fx;
    if (b[1] >= 0) g[b[1]] += fy;
  }
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    double gap = gap_of(c, i, q);
    const int32_t *a = row + c->at[i];
    if (!(gap < 0.0)) continue;
    double push = -c->entry[i].stiffness * gap;
    if (a[0] >= 0) g[a[0]] -= push * c->normal[0];
    if (a[1] >= 0) g[a[1]] -= push * c->normal[1];
  }
}

/* What |q| may be off by in its last bit, where a member's ends are. */
static double last_bit(const double *a, const double *b) {
  double size = fmax(fmax(fabs(a[0]), fabs(a[1])), fmax(fabs(b[0]), fabs(b[1])));
  return size * DBL_EPSILON;
}

double strut_potential_rounding(const strut_potential *p, const double *q) {
  const strut_member_table *t = &p->model->members;
  const strut_contact_table *c = &p->model->contacts;
  double largest = 0.0, forces = 0.0;
  for (int32_t at = 0; at < 2 * p->model->node_count; at++)
    if (p->row_of[at] >= 0) forces = fmax(forces, fabs(p->force[at]));
  for (int32_t j = 0; j < t->count; j++) {
    const int32_t *a = p->row_of + t->from[j], *b = p->row_of + t->to[j];
    pose m = pose_of(t, j, q);
    if (!m.taut || (a[0] < 0 && a[1] < 0 && b[0] < 0 && b[1] < 0)) continue;
    double bit = last_bit(q + t->from[j], q + t->to[j]);
    largest = fmax(largest, t->stiffness[j] * (bit + fabs(m.stretch) * DBL_EPSILON));
  }
  for (int32_t i = 0; i < c->count && p->ground; i++) {
    const double *at = q + c->at[i];
    double gap = gap_of(c, i, q);
    if (gap < 0.0) largest = fmax(largest, c->entry[i].stiffness * last_bit(at, at));
  }
  return largest + forces * DBL_EPSILON;
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

void strut_potential_hessian_above(const strut_potential *p, const double *q, double least,
                                   strut_sparse *hessian) {
  const strut_member_table *t = &p->model->members;
  const strut_contact_table *c = &p->model->contacts;
  const int32_t *place = p->place;
  double *value = hessian->value;
  memset(value, 0, (size_t)hessian->start[hessian->n] * sizeof *value);
  for (int32_t j = 0; j < t->count; j++, place += MEMBER_ENTRIES) {
    pose m = pose_of(t, j, q);
    if (!m.taut || (t->slack[j] == 0.0 && t->stiffness[j] * m.stretch <= least)) continue;
    /* of zero length and zero rest length: a spring alike in all directions */
    double across = m.length > 0     ? t->stiffness[j] * m.stretch / m.length
                    : t->rest[j] > 0 ? 0.0
                                     : t->stiffness[j];
    double along = t->stiffness[j] - across;
    double xx = across + along * m.ux * m.ux, xy = along * m.ux * m.uy;
    double yy = across + along * m.uy * m.uy;
    const double block[MEMBER_ENTRIES] = {xx, xy, yy, -xx, -xy, xx, -xy, -yy, xy, yy};
    for (int k = 0; k < MEMBER_ENTRIES; k++)
      if (place[k] >= 0) value[place[k]] += block[k];
  }
  for (int32_t i = 0; i < c->count && p->ground; i++, place += CONTACT_ENTRIES) {
    double gap = gap_of(c, i, q), stiffness = c->entry[i].stiffness;
    if (!(gap < 0.0) || -stiffness * gap <= least) continue;
    double nx = c->normal[0], ny = c->normal[1];
    const double block[CONTACT_ENTRIES] = {stiffness * nx * nx, stiffness * nx * ny,
                                           stiffness * ny * ny};
    for (int k = 0; k < CONTACT_ENTRIES; k++)
      if (place[k] >= 0) value[place[k]] += block[k];
  }
}
