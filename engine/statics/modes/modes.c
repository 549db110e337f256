/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/modes/modes.h"

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

static void describe_mode(const strut_modes_work *work, const double *vector, strut_mode *mode) {
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

/* The shape about which the structure vibrates. */

/*
 * A structure that nothing holds never comes to rest, but if it is drawn in equilibrium its modes
 * are valid: some are the free motions.
 */
static strut_status modes_shape(const strut_model *model, const strut_experiment *experiment,
                                const char *name, strut_arena *arena, strut_rest_state *rest,
                                strut_error *error) {
  strut_status status = strut_rest_state_find(model, experiment, name, arena, rest, error);
  if (status != STRUT_NOT_SETTLED || (name && strcmp(name, "start") != 0)) return status;
  strut_rest_state drawn = {0};
  strut_error ignored = {0};
  if (strut_rest_state_find(model, experiment, "drawn", arena, &drawn, &ignored) != STRUT_OK ||
      !drawn.at_rest)
    return status;
  *rest = drawn;
  return STRUT_OK;
}

static const double ENOUGH = 1e-8;   /* relative error of an eigenvalue that is worth printing */
static const double HIDDEN = 1e-18;  /* error that could hide one, of the largest */
static const double LARGEST = 1e150; /* eigenvalue; products of two of them are numbers */

const char *strut_mode_kind_name(strut_mode_kind kind) {
  static const char *const names[] = {"rigid-body", "mechanism", "elastic", "unstable", "unknown"};
  assert((size_t)kind < sizeof names / sizeof names[0]);
  return names[kind];
}

/* Nodes that touch, held along the ground: only where that is one coordinate. */
static strut_status hold_stuck(const strut_model *model, const strut_rest_state *rest,
                               uint8_t *held, strut_error *error) {
  const double *tangent = model->contacts.tangent;
  if (rest->closed_count && tangent[0] != 0 && tangent[1] != 0)
    return strut_fail(error, STRUT_USAGE,
                      "--stuck needs a level ground; make this one level and turn gravity instead");
  for (int32_t i = 0; i < rest->closed_count; i++)
    held[2 * rest->closed[i] + (tangent[0] != 0 ? 0 : 1)] = 1;
  return STRUT_OK;
}

static strut_status check_problem(strut_modes_work *work, strut_error *error) {
  const strut_vibration *vibration = work->v;
  if (vibration->n == 0 || vibration->massive == 0)
    return strut_fail(
        error, STRUT_BAD_SCENE,
        vibration->n == 0
            ? "no node is free to move, so there are no modes"
            : "no free node has mass, so there are no modes; give nodes or members a mass");
  if (!isfinite(vibration->largest) || vibration->largest > LARGEST)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "stiffnesses are so large beside the masses that frequencies cannot be "
                      "computed; check their units");
  if (vibration->massive == vibration->n) return STRUT_OK;
  strut_modes_factorise(&work->solver, STRUT_FIRM * vibration->largest);
  const strut_inertia *inertia = &work->solver.inertia;
  if (inertia->smallest > 1e-13 || vibration->mass[inertia->row] > 0) return STRUT_OK;
  return strut_fail(
      error, STRUT_SINGULAR,
      "node '%s' has no mass and can move without stiffness, so it has no frequency; "
      "give it a mass or hold it",
      vibration->model->scene->nodes[vibration->shape->coordinate[inertia->row] / 2].name);
}

static double mass_product(const strut_modes_work *work, const double *vector, const double *y) {
  strut_vibration_multiply(work->v, work->v->m, vector, work->v->work);
  return strut_dot(y, work->v->work, work->v->n);
}

/* Takes from x its shares in the first `count` of the vectors; returns what is left, squared. */
static double remove_shares(const strut_modes_work *work, const double *vectors, int32_t count,
                            double *vector) {
  size_t n = (size_t)work->v->n;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t k = 0; k < count; k++) {
      const double *y = vectors + (size_t)k * n;
      double share = mass_product(work, vector, y);
      for (size_t i = 0; i < n; i++) vector[i] -= share * y[i];
    }
  return mass_product(work, vector, vector);
}

/* The rigid motions that supports and closed contacts leave, orthonormal in the mass. */
static strut_status find_rigid(strut_modes_work *work, strut_error *error) {
  const strut_vibration *vibration = work->v;
  size_t n = (size_t)vibration->n;
  work->rigid = strut_arena_allocate(work->arena, 3 * n, sizeof *work->rigid);
  if (!work->rigid) return strut_no_memory(error, "");
  int32_t count =
      strut_rigid_motions(vibration->shape, vibration->q, vibration->closed, work->rigid);
  work->rigid_count = 0;
  for (int32_t k = 0; k < count; k++) {
    double *x = work->rigid + (size_t)work->rigid_count * n;
    memmove(x, work->rigid + (size_t)k * n, n * sizeof *x);
    double square = remove_shares(work, work->rigid, work->rigid_count, x);
    if (!(square > 0)) continue;
    for (size_t i = 0; i < n; i++) x[i] /= sqrt(square);
    work->rigid_count++;
  }
  return STRUT_OK;
}

/*
 * The motions without stiffness, rearranged: first the rigid ones among them, then the rest.
 * Returns how many are rigid, or -1 when memory is out.
 */
static int32_t sort_zeros(strut_modes_work *work, double *zero, int32_t count) {
  size_t n = (size_t)work->v->n;
  strut_arena scratch = {0};
  double *basis = strut_arena_allocate(&scratch, ((size_t)count + 1) * n, sizeof *basis);
  double *x = basis + (size_t)count * n;
  int32_t rigid = 0, found = 0;
  if (!basis) return -1;
  for (int32_t r = 0; r < work->rigid_count && found < count; r++) {
    memcpy(x, work->rigid + (size_t)r * n, n * sizeof *x);
    if (remove_shares(work, zero, count, x) > 1e-8) continue;
    memcpy(basis + (size_t)found++ * n, work->rigid + (size_t)r * n, n * sizeof *x);
  }
  rigid = found;
  for (; found < count; found++) { /* of the rest always the one that adds most */
    double most = -1.0, *next = basis + (size_t)found * n;
    for (int32_t k = 0; k < count; k++) {
      memcpy(x, zero + (size_t)k * n, n * sizeof *x);
      double left = remove_shares(work, basis, found, x);
      if (left > most) most = left, memcpy(next, x, n * sizeof *x);
    }
    for (size_t i = 0; i < n && most > 0; i++) next[i] /= sqrt(most);
  }
  memcpy(zero, basis, (size_t)count * n * sizeof *zero);
  strut_arena_free(&scratch);
  return rigid;
}

/* Kinds by value. Zeros are mechanisms, unless they may as well be soft. */
static strut_mode_kind *find_kinds(strut_modes_work *work, strut_error *error) {
  strut_eigen_set *set = &work->set;
  strut_mode_kind *kind = strut_arena_allocate(work->arena, (size_t)set->count, sizeof *kind);
  int32_t first = -1, zeros = 0;
  double hidden = 0.0;
  for (int32_t i = 0; i < set->count && kind; i++) {
    double value = fabs(set->value[i]), wrong = set->noise[i] + set->error[i];
    kind[i] = set->value[i] < 0 ? STRUT_MODE_UNSTABLE : STRUT_MODE_ELASTIC;
    if (wrong > ENOUGH * value) kind[i] = STRUT_MODE_UNKNOWN;
    if (value > 4.0 * wrong + 1e-22 * work->v->largest) continue;
    if (first < 0) first = i;
    zeros = i - first + 1;
    hidden = fmax(hidden, set->error[i]);
  }
  int32_t rigid = 0;
  if (kind && zeros > 0)
    rigid = sort_zeros(work, set->vector + (size_t)first * (size_t)set->n, zeros);
  if (!kind || rigid < 0) {
    strut_no_memory(error, "");
    return NULL;
  }
  bool known = hidden <= HIDDEN * work->v->largest;
  for (int32_t i = first; i < first + zeros; i++) {
    kind[i] = i - first < rigid ? STRUT_MODE_RIGID
              : known           ? STRUT_MODE_MECHANISM
                                : STRUT_MODE_UNKNOWN;
    set->error[i] = fmax(fabs(set->value[i]), set->error[i]);
    set->value[i] = 0.0;
  }
  return kind;
}

static double condition_of(const strut_modes_work *work, bool dense) {
  const strut_eigen_set *set = &work->set;
  double top = dense ? set->value[set->count - 1] : work->v->largest, low = HUGE_VAL;
  for (int32_t i = 0; i < set->count; i++)
    if (set->value[i] != 0) low = fmin(low, fabs(set->value[i]));
  return top / low;
}

static strut_status fill_mode(strut_modes_work *work, int32_t i, strut_mode_kind kind,
                              strut_mode *mode) {
  const strut_eigen_set *set = &work->set;
  const strut_vibration *vibration = work->v;
  const double *x = set->vector + (size_t)i * (size_t)vibration->n;
  double value = set->value[i], largest = 0.0;
  double beside = value != 0 ? fabs(value) : vibration->largest > 0 ? vibration->largest : 1.0;
  mode->shape = strut_arena_allocate(work->arena, (size_t)vibration->model->length, sizeof(double));
  if (!mode->shape) return STRUT_NO_MEMORY;
  mode->kind = kind;
  mode->eigenvalue = value;
  mode->angular_frequency = value > 0 ? sqrt(value) : 0.0;
  mode->damping_ratio = value > 0 ? 0.0 : (double)NAN;
  mode->residual = value != 0 ? set->residual[i] : set->error[i] / beside;
  mode->error = (set->error[i] + set->noise[i]) / beside;
  if (value != 0) mode->error = fmax(mode->error, DBL_EPSILON); /* it is handed out as a double */
  for (int32_t k = 0; k < vibration->n; k++)
    if (fabs(x[k]) > fabs(largest) * (1 + 1e-9)) largest = x[k];
  for (int32_t k = 0; k < vibration->n; k++)
    mode->shape[vibration->shape->coordinate[k]] = x[k] / largest;
  describe_mode(work, x, mode);
  return STRUT_OK;
}

/* What rounding hides is not given. */
static void hide_unknown(strut_modes *modes) {
  for (size_t i = 0; i < modes->count; i++) {
    strut_mode *mode = &modes->list[i];
    if (mode->kind != STRUT_MODE_UNKNOWN) continue;
    mode->eigenvalue = mode->angular_frequency = mode->damping_ratio = (double)NAN;
    mode->damped_frequency = mode->decay_rate = (double)NAN;
  }
}

static strut_status fill_modes(strut_modes_work *work, int32_t wanted, strut_modes *modes,
                               strut_error *error) {
  strut_eigen_set *set = &work->set;
  size_t found = (size_t)set->count;
  strut_mode_kind *kind = find_kinds(work, error);
  if (!kind) return STRUT_NO_MEMORY;
  modes->list = strut_arena_allocate(work->arena, found, sizeof *modes->list);
  if (!modes->list) return strut_no_memory(error, "");
  modes->condition = condition_of(work, modes->dense);
  modes->count = found < (size_t)wanted ? found : (size_t)wanted;
  for (size_t i = 0; i < found; i++)
    if (fill_mode(work, (int32_t)i, kind[i], &modes->list[i])) return strut_no_memory(error, "");
  modes->damped_exactly =
      modes->dense && set->count <= STRUT_DAMPED_MODES && work->v->massive == work->v->n;
  strut_status status = strut_modes_damping(work, modes->damped_exactly, modes->list, error);
  hide_unknown(modes);
  return status;
}

static strut_status solve_modes(strut_modes_work *work, int32_t wanted, strut_modes *modes,
                                strut_error *error) {
  const strut_vibration *vibration = work->v;
  strut_status status = strut_modes_solver_create(vibration, &work->solver, error);
  work->solver.interrupt = work->experiment->interrupt;
  if (status == STRUT_OK) status = check_problem(work, error);
  if (status != STRUT_OK) return status;
  status = strut_modes_loosen(work, modes->at_rest, error);
  modes->idleness = work->idleness;
  if (status == STRUT_OK && modes->at_rest) status = strut_modes_settle(work, error);
  if (status != STRUT_OK) return status;
  modes->coordinates = vibration->n;
  status = strut_experiment_end(work->experiment, status, error);
  if (status != STRUT_OK) return status;
  status = modes->dense ? strut_modes_dense(work, error) : strut_modes_sparse(work, wanted, error);
  if (status == STRUT_OK) status = strut_modes_noise(work, modes->at_rest, error);
  if (status == STRUT_OK) status = find_rigid(work, error);
  if (status == STRUT_OK) status = strut_modes_measure(work, error);
  return status ? status : fill_modes(work, wanted, modes, error);
}

/* What acts in a run, but not in modes. */
static const char *left_out(const strut_model *model) {
  bool feedback = strut_scene_has_feedback(model->scene), maxwell = model->feedback.maxwell_count;
  return feedback && maxwell ? "the feedback of sensors and Maxwell branches, which have relaxed"
         : feedback          ? "the feedback of sensors"
         : maxwell           ? "Maxwell branches, which have relaxed"
                             : NULL;
}

strut_status strut_modes_find(const strut_model *model, const strut_experiment *experiment,
                              const strut_modes_options *options, strut_modes *modes,
                              strut_error *error) {
  strut_rest_state rest = {0};
  *modes = (strut_modes){0};
  strut_modes_work work = {.arena = &modes->arena, .experiment = experiment};
  strut_status status = modes_shape(model, experiment, options->at, &modes->arena, &rest, error);
  if (status != STRUT_OK) return status;
  modes->at = rest.name;
  modes->left_out = left_out(model);
  modes->q = rest.q;
  modes->at_rest = rest.at_rest;
  modes->settle = rest.settle;
  modes->closed = rest.closed;
  modes->closed_count = rest.closed_count;
  uint8_t *held = strut_arena_allocate(&modes->arena, (size_t)model->length, sizeof *held);
  if (!held) return strut_no_memory(error, "");
  if (options->stuck) status = hold_stuck(model, &rest, held, error);
  if (status == STRUT_OK)
    status = strut_vibration_create(model, rest.q, rest.closed, rest.closed_count, held,
                                    &modes->arena, &work.v, error);
  if (status == STRUT_OK) {
    modes->dense = work.v->n <= STRUT_DENSE_MODES && !options->sparse;
    int32_t usual = modes->dense ? STRUT_DENSE_MODES : STRUT_SPARSE_MODES;
    status = solve_modes(&work, options->count > 0 ? options->count : usual, modes, error);
  }
  strut_modes_solver_free(&work.solver);
  return strut_experiment_end(experiment, status, error);
}

void strut_modes_free(strut_modes *modes) {
  strut_arena_free(&modes->arena);
  *modes = (strut_modes){0};
}
