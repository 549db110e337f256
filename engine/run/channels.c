/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/recording.h"

#include <assert.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/drives/support_motion.h"
#include "engine/forces/energy.h"
#include "engine/forces/forces.h"

static bool create_pair(strut_measured_pair *pair, size_t things, strut_arena *arena) {
  pair->first = strut_arena_allocate(arena, things, sizeof(double));
  pair->second = strut_arena_allocate(arena, things, sizeof(double));
  return pair->first && pair->second;
}

bool strut_channel_view_create(const strut_model *model, strut_arena *arena,
                               strut_channel_view *view) {
  const strut_scene *scene = model->scene;
  int32_t *hinge = strut_arena_allocate(arena, scene->hinge_count, sizeof *hinge);
  int32_t *cell = strut_arena_allocate(arena, scene->cell_count, sizeof *cell);
  size_t nodes = scene->node_count;
  *view = (strut_channel_view){.model = model, .hinge = hinge, .cell = cell};
  view->momentum = strut_arena_allocate(arena, 2 * nodes, sizeof(double));
  view->relative_velocity = strut_arena_allocate(arena, 2 * nodes, sizeof(double));
  if (!hinge || !cell || !view->momentum || !view->relative_velocity ||
      !create_pair(&view->members, scene->member_count, arena) ||
      !create_pair(&view->hinges, scene->hinge_count, arena) ||
      !create_pair(&view->cells, scene->cell_count, arena))
    return false;
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    if (e->role == STRUT_ELEMENT_HINGE) hinge[e->item] = i;
    if (e->role == STRUT_ELEMENT_CELL) cell[e->item] = i;
  }
  return true;
}

void strut_channel_view_show(strut_channel_view *view, strut_state *state, double t) {
  view->state = state;
  view->time = t;
  view->observed = false;
  view->members.fresh = view->hinges.fresh = view->cells.fresh = false;
}

/* ---- what several channels need, each once for a state ---- */

static void observe_forces(strut_channel_view *v) {
  if (!v->observed) strut_forces_observe(v->model, v->state, v->time);
  v->observed = true;
}

static const strut_measured_pair *measure_members(strut_channel_view *v) {
  strut_measured_pair *pair = &v->members;
  observe_forces(v);
  if (!pair->fresh) strut_members_measure(v->model, v->state, pair->first, pair->second);
  pair->fresh = true;
  return pair;
}

static const strut_measured_pair *measure_hinges(strut_channel_view *v) {
  strut_measured_pair *pair = &v->hinges;
  observe_forces(v);
  for (size_t i = 0; i < v->model->scene->hinge_count && !pair->fresh; i++) {
    strut_hinge_values values = strut_hinge_measure(v->model, v->state, v->hinge[i]);
    pair->first[i] = values.angle;
    pair->second[i] = values.moment;
  }
  pair->fresh = true;
  return pair;
}

static const strut_measured_pair *measure_cells(strut_channel_view *v) {
  strut_measured_pair *pair = &v->cells;
  observe_forces(v);
  for (size_t i = 0; i < v->model->scene->cell_count && !pair->fresh; i++) {
    strut_cell_values values = strut_cell_measure(v->model, v->state, v->cell[i]);
    pair->first[i] = values.area;
    pair->second[i] = values.pressure;
  }
  pair->fresh = true;
  return pair;
}

/* ---- one function for each row of the table ---- */

static void record_position(strut_channel_view *v, double *out) {
  memcpy(out, v->state->q, 2 * v->model->scene->node_count * sizeof *out);
}

static void record_velocity(strut_channel_view *v, double *out) {
  memcpy(out, v->state->v, 2 * v->model->scene->node_count * sizeof *out);
}

static void record_length(strut_channel_view *v, double *out) {
  memcpy(out, measure_members(v)->first, v->model->scene->member_count * sizeof *out);
}

static void record_force(strut_channel_view *v, double *out) {
  memcpy(out, measure_members(v)->second, v->model->scene->member_count * sizeof *out);
}

static void record_angle(strut_channel_view *v, double *out) {
  memcpy(out, measure_hinges(v)->first, v->model->scene->hinge_count * sizeof *out);
}

static void record_moment(strut_channel_view *v, double *out) {
  memcpy(out, measure_hinges(v)->second, v->model->scene->hinge_count * sizeof *out);
}

static void record_area(strut_channel_view *v, double *out) {
  memcpy(out, measure_cells(v)->first, v->model->scene->cell_count * sizeof *out);
}

static void record_pressure(strut_channel_view *v, double *out) {
  memcpy(out, measure_cells(v)->second, v->model->scene->cell_count * sizeof *out);
}

static void record_contact(strut_channel_view *v, double *out) {
  observe_forces(v);
  for (int32_t i = 0; i < v->model->contacts.count; i++) {
    out[2 * i] = v->state->latest->normal[i];
    out[2 * i + 1] = v->state->latest->friction[i];
  }
}

static void record_energy(strut_channel_view *v, double *out) {
  const strut_model *model = v->model;
  observe_forces(v);
  strut_energies stored = strut_energy_evaluate(model, v->state, v->time);
  const double *w = v->state->work;
  double values[] = {
      stored.kinetic,         stored.elastic,
      stored.gravity,         stored.contact,
      w[STRUT_POWER_DRIVE],   w[STRUT_POWER_LOAD] + strut_energy_load_work(model, v->state),
      w[STRUT_POWER_BELT],    strut_support_motion_work(model, v->state),
      w[STRUT_POWER_MEMBERS], w[STRUT_POWER_CONTACT],
      w[STRUT_POWER_FRICTION]};
  static_assert(sizeof values / sizeof values[0] == STRUT_ENERGIES, "one number for each name");
  memcpy(out, values, sizeof values);
}

/*
 * momentum = M u of each node at velocities u (nodes, 2), with the model's mass matrix, lumped or consistent,
 * of all nodes, supported ones too. Masses that slide add their speed along their lines at the positions q;
 * without it where q is NULL. Forces must have been observed where some mass slides.
 */
static void multiply_by_mass(const strut_channel_view *v, const double *u, const double *q,
                             double *momentum) {
  const strut_model *model = v->model;
  const strut_member_table *t = &model->members;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  double own = consistent ? 1.0 / 3.0 : 0.5, other = consistent ? 1.0 / 6.0 : 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) momentum[i] = model->point_mass[i / 2] * u[i];
  for (int32_t j = 0; j < t->count; j++)
    for (uint32_t c = 0; c < 2; c++) {
      uint32_t a = t->from[j] + c, b = t->to[j] + c;
      momentum[a] += t->mass[j] * (own * u[a] + other * u[b]);
      momentum[b] += t->mass[j] * (own * u[b] + other * u[a]);
    }
  for (int32_t j = 0, k = 0; j < model->sliding.count; j++) {
    const strut_sliding_item *s = &model->sliding.item[j];
    strut_sliding_motion motion = {.share = s->start};
    if (s->signal >= 0) motion = v->state->latest->sliding[k++];
    for (uint32_t c = 0; c < 2; c++) {
      uint32_t a = s->at[0] + c, b = s->at[1] + c;
      double speed = (1.0 - motion.share) * u[a] + motion.share * u[b];
      if (q) speed += motion.rate * (q[b] - q[a]);
      momentum[a] += (1.0 - motion.share) * s->mass * speed;
      momentum[b] += motion.share * s->mass * speed;
    }
  }
}

/* Sums of x and of y, of weights times values or of the values alone, over the total; all (nodes, 2). */
static strut_vec2 mean(const strut_model *model, const double *weights, const double *values,
                       double total) {
  double sum[2] = {0.0, 0.0};
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    sum[i % 2] += (weights ? weights[i] : 1.0) * values[i];
  return total > 0.0 ? (strut_vec2){sum[0] / total, sum[1] / total} : (strut_vec2){0.0, 0.0};
}

/*
 * (r - c) x p of each node, and their sum: r its position, p its part of M (v - v_c), c and v_c the centre of
 * mass and its velocity. Since M couples x to x and y to y alike, forces within the structure leave the sum
 * as it is.
 */
static void record_angular_momentum(strut_channel_view *v, double *out) {
  const strut_model *model = v->model;
  const double *q = v->state->q;
  double *p = v->momentum, *u = v->relative_velocity, total = 0.0;
  int32_t n = model->node_count;
  if (model->sliding.moving_count) observe_forces(v);
  for (int32_t i = 0; i < 2 * n; i++) u[i] = 1.0;
  multiply_by_mass(v, u, NULL, p); /* masses, in x and in y */
  for (int32_t i = 0; i < n; i++) total += p[2 * i];
  strut_vec2 centre = mean(model, p, q, total);
  multiply_by_mass(v, v->state->v, q, p);
  strut_vec2 velocity = mean(model, NULL, p, total);
  for (int32_t i = 0; i < n; i++) {
    u[2 * i] = v->state->v[2 * i] - velocity.x;
    u[2 * i + 1] = v->state->v[2 * i + 1] - velocity.y;
  }
  multiply_by_mass(v, u, q, p);
  out[n] = 0.0;
  for (int32_t i = 0; i < n; i++) {
    out[i] = (q[2 * i] - centre.x) * p[2 * i + 1] - (q[2 * i + 1] - centre.y) * p[2 * i];
    out[n] += out[i];
  }
}

void strut_channel_record(strut_channel_view *view, strut_channel id, double *out) {
  switch (id) {
#define RECORD(NAME, name, ...)                                                                    \
  case STRUT_CHANNEL_##NAME: record_##name(view, out); break;
    STRUT_CHANNEL_TABLE(RECORD)
#undef RECORD
  }
}
