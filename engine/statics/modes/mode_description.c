/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"

/* The motions of the plane as a whole that supports and closed contacts leave free. */

/* A motion (a, b, w): a - w (y - y0) / size in x, b + w (x - x0) / size in y. */
typedef struct pivot {
  double x, y, size;
} pivot;

static pivot middle_of(const strut_vibration *v) {
  pivot c = {0.0, 0.0, v->model->size > 0 ? v->model->size : 1.0};
  for (int32_t i = 0; i < v->model->node_count; i++) c.x += v->q[2 * i], c.y += v->q[2 * i + 1];
  c.x /= v->model->node_count;
  c.y /= v->model->node_count;
  return c;
}

/* Adds what holding direction (nx, ny) at coordinates `at` forbids: g += row row'. */
static void add_constraint(const strut_vibration *v, const pivot *c, int32_t at, double nx,
                           double ny, gsl_matrix *g) {
  double x = (v->q[at] - c->x) / c->size, y = (v->q[at + 1] - c->y) / c->size;
  double row[3] = {nx, ny, ny * x - nx * y};
  for (size_t i = 0; i < 3; i++)
    for (size_t k = 0; k < 3; k++)
      gsl_matrix_set(g, i, k, gsl_matrix_get(g, i, k) + row[i] * row[k]);
}

static void add_constraints(const strut_vibration *v, const pivot *c, gsl_matrix *g) {
  const strut_model *model = v->model;
  strut_force force;
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    if (v->shape->row_of[at] < 0) add_constraint(v, c, at & ~1, at % 2 == 0, at % 2 != 0, g);
  for (int32_t i = strut_force_count(model, false); i < strut_force_count(model, true); i++)
    if (strut_vibration_force_at(v, i, &force))
      add_constraint(v, c, (int32_t)force.at[0], force.pose.b[0], force.pose.b[1], g);
}

static void fill_motion(const strut_vibration *v, const pivot *c, const double motion[3],
                        double *x) {
  for (int32_t i = 0; i < v->n; i++) {
    int32_t at = v->shape->coordinate[i], node = at / 2;
    if (at % 2)
      x[i] = motion[1] + motion[2] * (v->q[2 * node] - c->x) / c->size;
    else
      x[i] = motion[0] - motion[2] * (v->q[2 * node + 1] - c->y) / c->size;
  }
}

/* Gram and Schmidt, twice, in the product of the mass; false: nothing is left of x. */
static bool orthonormalise(const strut_modes_work *work, double *x, double *product) {
  const strut_vibration *v = work->v;
  double square = 0.0;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t k = 0; k <= work->rigid_count; k++) {
      const double *y = k < work->rigid_count ? work->rigid + (size_t)k * (size_t)v->n : x;
      double share = 0.0;
      strut_vibration_multiply(v, v->m, x, product);
      for (int32_t i = 0; i < v->n; i++) share += y[i] * product[i];
      square = share;
      for (int32_t i = 0; i < v->n && k < work->rigid_count; i++) x[i] -= share * y[i];
    }
  if (!(square > 0)) return false;
  for (int32_t i = 0; i < v->n; i++) x[i] /= sqrt(square);
  return true;
}

strut_status strut_modes_rigid(strut_modes_work *work, strut_error *error) {
  const strut_vibration *v = work->v;
  pivot c = middle_of(v);
  work->rigid_count = 0;
  work->rigid = strut_arena_allocate(work->arena, 3 * (size_t)v->n, sizeof *work->rigid);
  gsl_matrix *g = gsl_matrix_calloc(3, 3), *vector = gsl_matrix_alloc(3, 3);
  gsl_vector *value = gsl_vector_alloc(3);
  gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(3);
  bool good = work->rigid && g && vector && value && w;
  if (good) {
    add_constraints(v, &c, g);
    double trace = gsl_matrix_get(g, 0, 0) + gsl_matrix_get(g, 1, 1) + gsl_matrix_get(g, 2, 2);
    good = gsl_eigen_symmv(g, value, vector, w) == 0 &&
           gsl_eigen_symmv_sort(value, vector, GSL_EIGEN_SORT_VAL_ASC) == 0;
    for (size_t i = 0; i < 3 && good; i++) {
      if (gsl_vector_get(value, i) > 1e-12 * trace) break;
      double motion[3], *x = work->rigid + (size_t)work->rigid_count * (size_t)v->n;
      for (size_t k = 0; k < 3; k++) motion[k] = gsl_matrix_get(vector, k, i);
      fill_motion(v, &c, motion, x);
      if (orthonormalise(work, x, v->work)) work->rigid_count++;
    }
  }
  gsl_matrix_free(g);
  gsl_matrix_free(vector);
  gsl_vector_free(value);
  gsl_eigen_symmv_free(w);
  return good ? STRUT_OK : strut_no_memory(error, "");
}

/* Description of a mode in words, from its computed quantities. */

enum { MOST_NODES = 3, MOST_MEMBERS = 3 };

static const double MOVES = 0.5;  /* share of the largest amplitude from which a node is named */
static const double COUNTS = 0.1; /* share of the energy from which a member is named */

static void append_text(strut_mode *mode, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void append_text(strut_mode *mode, const char *format, ...) {
  size_t used = strlen(mode->description), room = sizeof mode->description - used;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(mode->description + used, room, format, arguments);
  va_end(arguments);
}

static void motion_of(const strut_vibration *v, const double *x, int32_t node, double d[2]) {
  for (int c = 0; c < 2; c++) {
    int32_t row = v->shape->row_of[2 * node + c];
    d[c] = row >= 0 ? x[row] : 0.0;
  }
}

static int32_t largest_node(const strut_vibration *v, const double *x, double d[2]) {
  double most = -1.0, here[2];
  d[0] = d[1] = 0.0;
  int32_t node = 0;
  for (int32_t i = 0; i < v->model->node_count; i++) {
    motion_of(v, x, i, here);
    if (hypot(here[0], here[1]) <= most * (1 + 1e-9)) continue; /* of equal ones the first */
    most = hypot(here[0], here[1]), node = i, d[0] = here[0], d[1] = here[1];
  }
  return node;
}

static const char *direction_text(const double d[2]) {
  double size = hypot(d[0], d[1]);
  if (fabs(d[0]) > 0.95 * size) return " along x";
  if (fabs(d[1]) > 0.95 * size) return " along y";
  return "";
}

/* Direction relative to the leading motion: 1 along it, -1 against it, 0 across. */
static int side_of(const double lead[2], const double d[2]) {
  double cosine = (lead[0] * d[0] + lead[1] * d[1]) / (hypot(lead[0], lead[1]) * hypot(d[0], d[1]));
  return cosine > 0.5 ? 1 : cosine < -0.5 ? -1 : 0;
}

/* Names the nodes of one side, the leading one first; returns how many there are. */
static int name_side(const strut_vibration *v, const double *x, int32_t leader,
                     const double lead[2], int side, const char *before, strut_mode *mode) {
  int count = 0;
  double least = MOVES * hypot(lead[0], lead[1]), d[2];
  for (int32_t k = -1; k < v->model->node_count; k++) {
    int32_t i = k < 0 ? leader : k;
    if (k == leader || (k < 0 && side != 1)) continue;
    motion_of(v, x, i, d);
    if (hypot(d[0], d[1]) < least || side_of(lead, d) != side) continue;
    if (count < MOST_NODES)
      append_text(mode, "%s%s", count ? ", " : before, v->model->scene->nodes[i].name);
    count++;
  }
  if (count > MOST_NODES) append_text(mode, " and %d more", count - MOST_NODES);
  return count;
}

static void describe_nodes(const strut_vibration *v, const double *x, strut_mode *mode) {
  double lead[2];
  int32_t leader = largest_node(v, x, lead);
  int count = name_side(v, x, leader, lead, 1, "", mode);
  append_text(mode, count == 1 ? " moves%s" : " move%s", direction_text(lead));
  name_side(v, x, leader, lead, -1, " against ", mode);
  if (name_side(v, x, leader, lead, 0, ", ", mode) > 0) append_text(mode, " sideways");
}

/* Energies of half a stiffness each: stretch of the members, closed contacts. */
typedef struct energies {
  double members, ground, all;
} energies;

/* Things that store energy: items, in this order. */
static const strut_thing kinds[] = {STRUT_THING_MEMBER,    STRUT_THING_HINGE,    STRUT_THING_CELL,
                                    STRUT_THING_COLLISION, STRUT_THING_DISTANCE, STRUT_THING_FOOT};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

static int32_t count_items(const strut_model *model) {
  size_t count = 0;
  for (int k = 0; k < KIND_COUNT; k++) count += strut_thing_count(model->scene, kinds[k]);
  return (int32_t)count;
}

/* -1: a load, or bristles. */
static int32_t item_of(const strut_model *model, const strut_force *force) {
  size_t before = 0;
  if (force->kind == STRUT_FORCE_MEMBER) return force->index;
  const strut_element *e = &model->elements.element[force->index];
  if (e->role == STRUT_ELEMENT_LOAD || e->role == STRUT_ELEMENT_CONTACT) return -1;
  strut_thing thing = strut_element_thing(e->role);
  for (int k = 0; kinds[k] != thing; k++) before += strut_thing_count(model->scene, kinds[k]);
  return (int32_t)before + e->item;
}

static const char *name_of_item(const strut_scene *scene, size_t j) {
  int k = 0;
  for (size_t count; j >= (count = strut_thing_count(scene, kinds[k])); k++) j -= count;
  return strut_thing_name(scene, kinds[k], j);
}

/* Energies of slopes, not of bends of strains, in a motion; `energy` of the items, a member's with those of its elements. */
static energies find_energies(const strut_vibration *v, const double *x, double *energy) {
  energies e = {0};
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(v->model, true); i++) {
    if (!strut_vibration_force_at(v, i, &force)) continue;
    double along = strut_vibration_strain(v, &force, x), own = force.pose.slope * along * along;
    bool ground = force.kind == STRUT_FORCE_CONTACT;
    int32_t item = ground ? -1 : item_of(v->model, &force);
    if (ground) e.ground += own;
    if (item >= 0) energy[item] += own, e.members += own;
  }
  e.all = e.members + e.ground;
  return e;
}

static void describe_members(const strut_vibration *v, const double *energy, const energies *e,
                             strut_mode *mode) {
  const strut_scene *scene = v->model->scene;
  int32_t named[MOST_MEMBERS], items = count_items(v->model);
  int count = 0;
  for (; count < MOST_MEMBERS; count++) {
    double most = COUNTS * e->all;
    named[count] = -1;
    for (int32_t j = 0; j < items; j++) {
      bool known = false;
      for (int k = 0; k < count; k++) known = known || named[k] == j;
      if (!known && energy[j] > most) most = energy[j] * (1 + 1e-9), named[count] = j;
    }
    int32_t j = named[count];
    if (j < 0) break;
    append_text(mode, "%s%s %.0f %%", count ? ", " : "; ", name_of_item(scene, (size_t)j),
                100.0 * energy[j] / e->all);
  }
  if (e->ground > 0.05 * e->all)
    append_text(mode, "%sthe ground %.0f %%", count++ ? ", " : "; ", 100.0 * e->ground / e->all);
  if (count) append_text(mode, " of the energy");
}

static void describe_rigid(const strut_vibration *v, const double *x, strut_mode *mode) {
  double first[2], d[2];
  largest_node(v, x, first);
  bool shift = true;
  for (int32_t i = 0; i < v->model->node_count; i++) {
    motion_of(v, x, i, d);
    shift = shift && hypot(d[0] - first[0], d[1] - first[1]) < 1e-6 * hypot(first[0], first[1]);
  }
  const char *way = direction_text(first);
  if (shift)
    append_text(mode, "the structure moves%s", *way ? way : " freely");
  else
    append_text(mode, "the structure rotates freely");
}

/* Members that the mechanism would stretch one way, and let go the other. */
static void describe_idle(const strut_modes_work *work, const double *x, strut_mode *mode) {
  const strut_vibration *v = work->v;
  double lead[2];
  largest_node(v, x, lead);
  strut_force force;
  int32_t count = 0, first = -1;
  for (int32_t j = 0; j < v->model->members.count; j++) {
    if (work->idleness[j] != STRUT_JUST_TAUT) continue;
    strut_vibration_force_at(v, j, &force);
    if (fabs(strut_vibration_strain(v, &force, x)) <= 1e-6 * hypot(lead[0], lead[1])) continue;
    if (!count++) first = j;
  }
  mode->just_taut = count;
  if (count == 1)
    append_text(mode, ", as '%.24s' is just taut", v->model->scene->members[first].name);
  if (count > 1) append_text(mode, ", as %d members are just taut", (int)count);
}

void strut_modes_describe(const strut_modes_work *work, const double *x, strut_mode *mode) {
  const strut_vibration *v = work->v;
  mode->description[0] = '\0';
  if (mode->kind == STRUT_MODE_RIGID) {
    describe_rigid(v, x, mode);
    return;
  }
  describe_nodes(v, x, mode);
  if (mode->kind == STRUT_MODE_MECHANISM) {
    append_text(mode, "; no stiffness resists");
    describe_idle(work, x, mode);
    return;
  }
  if (mode->kind == STRUT_MODE_UNKNOWN) {
    append_text(mode, "; rounding hides its frequency");
    if (mode->angular_frequency > 0)
      append_text(mode, ", about %.3g Hz", mode->angular_frequency / STRUT_TAU);
    return;
  }
  size_t items = (size_t)count_items(v->model);
  double *energy = strut_allocate(items + 1, sizeof *energy);
  if (!energy) return; /* the mode stays, with fewer words */
  energies e = find_energies(v, x, energy);
  double mass = 0.0, *product = v->work;
  strut_vibration_multiply(v, v->m, x, product);
  for (int32_t i = 0; i < v->n; i++) mass += x[i] * product[i];
  double stiffness = mode->eigenvalue * mass;
  bool geometric = e.all < 0.5 * fabs(stiffness);
  if (geometric)
    append_text(mode, "; %.0f %% of the stiffness is geometric",
                fmin(100.0 * (1.0 - e.all / fabs(stiffness)), 100.0));
  if (!(e.all < 0.01 * fabs(stiffness))) describe_members(v, energy, &e, mode);
  strut_release(energy);
}
