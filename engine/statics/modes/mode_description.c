/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"

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

static void motion_of(const strut_vibration *vibration, const double *vector, int32_t node,
                      double d[2]) {
  for (int c = 0; c < 2; c++) {
    int32_t row = vibration->shape->row_of[2 * node + c];
    d[c] = row >= 0 ? vector[row] : 0.0;
  }
}

static int32_t largest_node(const strut_vibration *vibration, const double *vector, double d[2]) {
  double most = -1.0, here[2];
  d[0] = d[1] = 0.0;
  int32_t node = 0;
  for (int32_t i = 0; i < vibration->model->node_count; i++) {
    motion_of(vibration, vector, i, here);
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
static int name_side(const strut_vibration *vibration, const double *vector, int32_t leader,
                     const double lead[2], int side, const char *before, strut_mode *mode) {
  int count = 0;
  double least = MOVES * hypot(lead[0], lead[1]), d[2];
  for (int32_t k = -1; k < vibration->model->node_count; k++) {
    int32_t i = k < 0 ? leader : k;
    if (k == leader || (k < 0 && side != 1)) continue;
    motion_of(vibration, vector, i, d);
    if (hypot(d[0], d[1]) < least || side_of(lead, d) != side) continue;
    if (count < MOST_NODES)
      append_text(mode, "%s%s", count ? ", " : before, vibration->model->scene->nodes[i].name);
    count++;
  }
  if (count > MOST_NODES) append_text(mode, " and %d more", count - MOST_NODES);
  return count;
}

static void describe_nodes(const strut_vibration *vibration, const double *vector,
                           strut_mode *mode) {
  double lead[2];
  int32_t leader = largest_node(vibration, vector, lead);
  int count = name_side(vibration, vector, leader, lead, 1, "", mode);
  append_text(mode, count == 1 ? " moves%s" : " move%s", direction_text(lead));
  name_side(vibration, vector, leader, lead, -1, " against ", mode);
  if (name_side(vibration, vector, leader, lead, 0, ", ", mode) > 0) append_text(mode, " sideways");
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
  const strut_element *element = &model->elements.element[force->index];
  if (element->role == STRUT_ELEMENT_LOAD || element->role == STRUT_ELEMENT_CONTACT) return -1;
  strut_thing thing = strut_element_thing(element->role);
  for (int k = 0; kinds[k] != thing; k++) before += strut_thing_count(model->scene, kinds[k]);
  return (int32_t)before + element->item;
}

static const char *name_of_item(const strut_scene *scene, size_t j) {
  int k = 0;
  for (size_t count; j >= (count = strut_thing_count(scene, kinds[k])); k++) j -= count;
  return strut_thing_name(scene, kinds[k], j);
}

/* Energies of slopes, not of bends of strains, in a motion; `energy` of the items, a member's with those of its elements. */
static energies find_energies(const strut_vibration *vibration, const double *vector,
                              double *energy) {
  energies e = {0};
  strut_force force;
  for (int32_t i = 0; i < strut_force_count(vibration->model, true); i++) {
    if (!strut_vibration_force_at(vibration, i, &force)) continue;
    double along = strut_vibration_strain(vibration, &force, vector),
           own = force.pose.slope * along * along;
    bool ground = force.kind == STRUT_FORCE_CONTACT;
    int32_t item = ground ? -1 : item_of(vibration->model, &force);
    if (ground) e.ground += own;
    if (item >= 0) energy[item] += own, e.members += own;
  }
  e.all = e.members + e.ground;
  return e;
}

static void describe_members(const strut_vibration *vibration, const double *energy,
                             const energies *self, strut_mode *mode) {
  const strut_scene *scene = vibration->model->scene;
  int32_t named[MOST_MEMBERS], items = count_items(vibration->model);
  int count = 0;
  for (; count < MOST_MEMBERS; count++) {
    double most = COUNTS * self->all;
    named[count] = -1;
    for (int32_t j = 0; j < items; j++) {
      bool known = false;
      for (int k = 0; k < count; k++) known = known || named[k] == j;
      if (!known && energy[j] > most) most = energy[j] * (1 + 1e-9), named[count] = j;
    }
    int32_t j = named[count];
    if (j < 0) break;
    append_text(mode, "%s%s %.0f %%", count ? ", " : "; ", name_of_item(scene, (size_t)j),
                100.0 * energy[j] / self->all);
  }
  if (self->ground > 0.05 * self->all)
    append_text(mode, "%sthe ground %.0f %%", count++ ? ", " : "; ",
                100.0 * self->ground / self->all);
  if (count) append_text(mode, " of the energy");
}

static void describe_rigid(const strut_vibration *vibration, const double *vector,
                           strut_mode *mode) {
  double first[2], d[2];
  largest_node(vibration, vector, first);
  bool shift = true;
  for (int32_t i = 0; i < vibration->model->node_count; i++) {
    motion_of(vibration, vector, i, d);
    shift = shift && hypot(d[0] - first[0], d[1] - first[1]) < 1e-6 * hypot(first[0], first[1]);
  }
  const char *way = direction_text(first);
  if (shift)
    append_text(mode, "the structure moves%s", *way ? way : " freely");
  else
    append_text(mode, "the structure rotates freely");
}

/* Members that the mechanism would stretch one way, and let go the other. */
static void describe_idle(const strut_modes_work *work, const double *vector, strut_mode *mode) {
  const strut_vibration *vibration = work->v;
  double lead[2];
  largest_node(vibration, vector, lead);
  strut_force force;
  int32_t count = 0, first = -1;
  for (int32_t j = 0; j < vibration->model->members.count; j++) {
    if (work->idleness[j] != STRUT_JUST_TAUT) continue;
    strut_vibration_force_at(vibration, j, &force);
    if (fabs(strut_vibration_strain(vibration, &force, vector)) <= 1e-6 * hypot(lead[0], lead[1]))
      continue;
    if (!count++) first = j;
  }
  mode->just_taut = count;
  if (count == 1)
    append_text(mode, ", as '%.24s' is just taut", vibration->model->scene->members[first].name);
  if (count > 1) append_text(mode, ", as %d members are just taut", (int)count);
}

void strut_modes_describe(const strut_modes_work *work, const double *vector, strut_mode *mode) {
  const strut_vibration *vibration = work->v;
  mode->description[0] = '\0';
  if (mode->kind == STRUT_MODE_RIGID) {
    describe_rigid(vibration, vector, mode);
    return;
  }
  describe_nodes(vibration, vector, mode);
  if (mode->kind == STRUT_MODE_MECHANISM) {
    append_text(mode, "; no stiffness resists");
    describe_idle(work, vector, mode);
    return;
  }
  if (mode->kind == STRUT_MODE_UNKNOWN) {
    append_text(mode, "; rounding hides its frequency");
    if (mode->angular_frequency > 0)
      append_text(mode, ", about %.3g Hz", mode->angular_frequency / STRUT_TAU);
    return;
  }
  size_t items = (size_t)count_items(vibration->model);
  double *energy = strut_allocate(items + 1, sizeof *energy);
  if (!energy) return; /* the mode stays, with fewer words */
  energies e = find_energies(vibration, vector, energy);
  strut_vibration_multiply(vibration, vibration->m, vector, vibration->work);
  double stiffness = mode->eigenvalue * strut_dot(vector, vibration->work, vibration->n);
  bool geometric = e.all < 0.5 * fabs(stiffness);
  if (geometric)
    append_text(mode, "; %.0f %% of the stiffness is geometric",
                fmin(100.0 * (1.0 - e.all / fabs(stiffness)), 100.0));
  if (!(e.all < 0.01 * fabs(stiffness))) describe_members(vibration, energy, &e, mode);
  strut_release(energy);
}
