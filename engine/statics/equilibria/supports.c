/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/equilibria/equilibria_parts.h"

#include "engine/base/vec.h"
#include "engine/model/pose.h"
#include "engine/scene/things.h"
#include "engine/statics/algebra.h"

/* A structure is moved to the origin where it is this many of its sizes away: digits would be lost. */
static const double FAR = 100.0;

/* Turns vectors counterclockwise by the angle of c, s; the identity is exact. */
static void turn_vectors(double c, double s, size_t count, double *xy) {
  if (s == 0.0 && c == 1.0) return;
  for (size_t i = 0; i < count; i++, xy += 2) {
    double x = xy[0], y = xy[1];
    xy[0] = c * x - s * y;
    xy[1] = s * x + c * y;
  }
}

void strut_level_frame_place(const strut_level_frame *level, size_t count, double *xy) {
  strut_level_frame_to_original(level, count, xy);
  for (size_t i = 0; i < 2 * count; i++) xy[i] += level->shift[i % 2];
}

void strut_level_frame_to_original(const strut_level_frame *level, size_t count, double *xy) {
  turn_vectors(level->cosine, level->sine, count, xy);
}

static void level_frame_from_original(const strut_level_frame *level, size_t count, double *xy) {
  turn_vectors(level->cosine, -level->sine, count, xy);
}

double strut_level_frame_work(const strut_level_frame *level, const double *weight) {
  const strut_scene *scene = &level->scene;
  double force[2] = {0.0, 0.0};
  for (size_t i = 0; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) force[c] += weight[i] * scene->gravity[c];
  for (size_t i = 0; i < scene->load_count; i++)
    for (int c = 0; c < 2; c++) force[c] += scene->loads[i].force[c];
  strut_level_frame_to_original(level, 1, force);
  return force[0] * level->shift[0] + force[1] * level->shift[1];
}

/* A node that is held in x alone or in y alone has no such support in turned coordinates. */
static int32_t find_oblique_node(const strut_scene *scene) {
  if (!scene->ground.present || scene->ground.slope == 0.0) return -1;
  for (size_t i = 0; i < scene->node_count; i++)
    if (scene->nodes[i].fixed[0] != scene->nodes[i].fixed[1]) return (int32_t)i;
  return -1;
}

static bool copy_arrays(strut_level_frame *level) {
  strut_scene *scene = &level->scene;
  if (!STRUT_DUPLICATE(&level->arena, STRUT_NEW(scene->nodes, scene->node_count),
                       STRUT_NEW(scene->members, scene->member_count),
                       STRUT_NEW(scene->hinges, scene->hinge_count),
                       STRUT_NEW(scene->contacts, scene->contact_count),
                       STRUT_NEW(scene->loads, scene->load_count),
                       STRUT_NEW(scene->configurations, scene->configuration_count)))
    return false;
  for (size_t i = 0; i < scene->configuration_count; i++) {
    strut_configuration *configuration = &scene->configurations[i];
    if (configuration->position)
      configuration->position =
          strut_arena_copy(&level->arena, configuration->position, scene->node_count,
                           sizeof *configuration->position);
    if (configuration->shaped && !configuration->position) return false;
  }
  return true;
}

/* Rest lengths and angles as resolved in the original, so that turning changes no bit of them. */
static void keep_rest_lengths(const strut_scene *original, strut_scene *scene) {
  for (size_t j = 0; j < scene->member_count; j++) {
    strut_rest rest;
    if (!strut_member_rest(original, j, &rest)) continue;
    scene->members[j].rest_kind = STRUT_REST_LENGTH;
    scene->members[j].rest_value = rest.length;
    scene->members[j].stiffness = rest.stiffness;
    scene->members[j].axial_stiffness = 0.0;
  }
  for (size_t i = 0; i < scene->hinge_count; i++)
    scene->hinges[i].rest_angle = strut_hinge_rest(original, i);
}

static bool remove_motion(strut_scene *scene, strut_arena *arena) {
  size_t kept = 0;
  if (!strut_scene_hold_sliding_masses(scene, arena)) return false;
  scene->actuator_count = 0;
  strut_scene_hold_supports(scene, true);
  strut_scene_stop_unbalances(scene);
  scene->ground.belt_speed = 0.0;
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal < 0) scene->loads[kept++] = scene->loads[i];
  scene->load_count = kept;
  for (size_t i = 0; i < scene->contact_count; i++)
    scene->contacts[i].friction.law = STRUT_FRICTION_NONE;
  for (size_t i = 0; i < scene->node_count; i++)
    scene->nodes[i].velocity[0] = scene->nodes[i].velocity[1] = 0.0;
  return true;
}

/* Moves a structure far from the origin there. */
static bool bring_near(strut_level_frame *level) {
  strut_scene *scene = &level->scene;
  double size = 0.0, far = 0.0, by[2];
  for (size_t i = 0; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) {
      size = fmax(size, fabs(scene->nodes[i].position[c] - scene->nodes[0].position[c]));
      far = fmax(far, fabs(scene->nodes[i].position[c]));
    }
  if (!(far > FAR * size) || !(size > 0.0)) return true;
  for (int c = 0; c < 2; c++) {
    level->shift[c] = scene->nodes[0].position[c];
    by[c] = -level->shift[c];
  }
  return strut_scene_shift(scene, by, &level->arena);
}

/* Turns a force, of which rounding leaves no part along or across the ground where there is none. */
static void turn_force(const strut_level_frame *level, double force[2]) {
  level_frame_from_original(level, 1, force);
  double least = 16.0 * DBL_EPSILON * hypot(force[0], force[1]);
  for (int c = 0; c < 2; c++)
    if (fabs(force[c]) < least) force[c] = 0.0;
}

static void make_level(strut_level_frame *level) {
  strut_scene *scene = &level->scene;
  if (level->sine == 0.0) return;
  scene->ground.height *= level->cosine;
  scene->ground.slope = 0.0;
  turn_force(level, scene->gravity);
  for (size_t i = 0; i < scene->node_count; i++) {
    level_frame_from_original(level, 1, scene->nodes[i].position);
    level_frame_from_original(level, 1, scene->nodes[i].start);
  }
  for (size_t i = 0; i < scene->load_count; i++) turn_force(level, scene->loads[i].force);
  for (size_t i = 0; i < scene->configuration_count; i++)
    if (scene->configurations[i].position)
      level_frame_from_original(level, scene->node_count, scene->configurations[i].position[0]);
}

strut_status strut_level_frame_create(const strut_scene *original, strut_level_frame *level,
                                      strut_error *error) {
  *level = (strut_level_frame){
      .scene = *original, .cosine = 1.0, .oblique_node = find_oblique_node(original)};
  level->scene.arena = (strut_arena){0};
  if (!copy_arrays(level) || !strut_scene_stop_grounds(&level->scene, &level->arena)) {
    strut_level_frame_free(level);
    return strut_no_memory(error, "");
  }
  if (original->ground.present && level->oblique_node < 0 && original->ground.slope != 0.0) {
    level->cosine = cos(original->ground.slope);
    level->sine = sin(original->ground.slope);
  }
  keep_rest_lengths(original, &level->scene);
  if (!remove_motion(&level->scene, &level->arena) || !bring_near(level)) {
    strut_level_frame_free(level);
    return strut_no_memory(error, "");
  }
  make_level(level);
  return STRUT_OK;
}

void strut_level_frame_free(strut_level_frame *level) {
  strut_arena_free(&level->arena);
  memset(level, 0, sizeof *level);
}

/* Rank of the rows (1, 0, -y) and (0, 1, x) of coordinates: of all nodes, or of those held. */
static int rank_of_rigid(const strut_scene *scene, bool only_fixed) {
  double gram[9] = {0}, value[3], vector[9], size = 0.0;
  const double *origin = scene->nodes[0].position;
  for (size_t i = 0; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) size = fmax(size, fabs(scene->nodes[i].position[c] - origin[c]));
  for (size_t i = 0; i < scene->node_count && size > 0; i++)
    for (int c = 0; c < 2; c++) {
      if (only_fixed && !scene->nodes[i].fixed[c]) continue;
      double x = (scene->nodes[i].position[0] - origin[0]) / size;
      double y = (scene->nodes[i].position[1] - origin[1]) / size;
      const double row[3] = {c == 0, c == 1, c == 0 ? -y : x};
      for (int k = 0; k < 9; k++) gram[k] += row[k / 3] * row[k % 3];
    }
  if (!strut_symmetric_eigen(gram, 3, value, vector)) return 0;
  int rank = 0;
  for (int k = 0; k < 3; k++) rank += value[k] > 1e-12 * (1.0 + value[2]);
  return rank;
}

static bool may_touch(const strut_scene *scene, int32_t node) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].node == node) return true;
  return false;
}

static strut_status use_requested_set(const strut_scene *scene, const strut_node_set *wanted,
                                      strut_arena *arena, strut_supports *supports,
                                      strut_error *error) {
  for (size_t i = 0; i < wanted->count; i++) {
    int32_t node = wanted->node[i];
    if (!may_touch(scene, node))
      return strut_fail(
          error, STRUT_USAGE,
          "node '%s' is no contact node, so it cannot be a support; name contact nodes",
          scene->nodes[node].name);
  }
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(supports->sets, 1))) return strut_no_memory(error, "");
  supports->sets[0] = *wanted;
  supports->count = 1;
  return STRUT_OK;
}

/* Every set of one contact node, or of two. */
static strut_status use_all_sets(const strut_scene *scene, size_t size, strut_arena *arena,
                                 strut_supports *supports, strut_error *error) {
  size_t n = scene->contact_count, count = size == 1 ? n : n * (n - 1) / 2, at = 0;
  supports->many = count > STRUT_MOST_SUPPORTS;
  if (supports->many || n < size) return STRUT_OK;
  supports->sets = strut_arena_allocate(arena, count, sizeof *supports->sets);
  int32_t *node = strut_arena_allocate(arena, count * size, sizeof *node);
  if (!supports->sets || !node) return strut_no_memory(error, "");
  for (size_t i = 0; i < n; i++)
    for (size_t j = size == 1 ? n - 1 : i + 1; j < n; j++, at++) {
      node[at * size] = scene->contacts[i].node;
      if (size == 2) node[2 * at + 1] = scene->contacts[j].node;
      supports->sets[at] = (strut_node_set){size, node + at * size};
    }
  supports->count = count;
  return STRUT_OK;
}

strut_status strut_supports_choose(const strut_scene *level, const strut_search *search,
                                   const strut_node_set *wanted, strut_arena *arena,
                                   strut_supports *supports, strut_error *error) {
  size_t held[2] = {0};
  for (size_t i = 0; i < 2 * level->node_count; i++)
    held[i % 2] += level->nodes[i / 2].fixed[i % 2];
  *supports = (strut_supports){.loose = held[0] + held[1] == 0};
  if (!level->ground.present || level->contact_count == 0) {
    if (!wanted) return STRUT_OK;
    return strut_fail(error, STRUT_USAGE, "the scene has no ground that supports could replace");
  }
  supports->pin = held[0] == 0;
  if (wanted) return use_requested_set(level, wanted, arena, supports, error);
  if (search->support_count) {
    supports->sets = search->supports;
    supports->count = search->support_count;
    return STRUT_OK;
  }
  int motions = rank_of_rigid(level, false) - rank_of_rigid(level, true);
  int size = motions - (supports->pin ? 1 : 0);
  if (size <= 0 || 2 * level->node_count - held[0] - held[1] <= (size_t)motions) return STRUT_OK;
  return use_all_sets(level, size == 1 ? 1 : 2, arena, supports, error);
}

void strut_supports_hold(const strut_supports *supports, const strut_node_set *set, uint8_t *held) {
  for (size_t i = 0; i < set->count; i++) held[2 * set->node[i] + 1] = 1;
  if (supports->pin && set->count) held[2 * set->node[0]] = 1;
}

/* Turns and moves the shape so that `a` comes to x, height and `b` level with it, on its side. */
static void lay_on_ground(const strut_scene *level, int32_t a, int32_t b, double x, double height,
                          double (*shape)[2]) {
  strut_vec2 d = strut_vec2_between(shape[a], shape[b]);
  double length = strut_vec2_length(d), from[2] = {shape[a][0], shape[a][1]};
  double c = length > 0 ? fabs(d.x) / length : 1, s = length > 0 ? d.y / length : 0;
  if (d.x < 0) s = -s;
  for (size_t i = 0; i < level->node_count; i++) {
    double rx = shape[i][0] - from[0], ry = shape[i][1] - from[1];
    shape[i][0] = x + c * rx + s * ry;
    shape[i][1] = height - s * rx + c * ry;
  }
}

void strut_supports_place(const strut_supports *supports, const strut_scene *level,
                          const strut_node_set *set, double (*shape)[2]) {
  assert(set->count == 0 || set->node);
  if (set->count == 0) return;
  int32_t a = set->node[0], b = set->node[set->count > 1 ? 1 : 0];
  double x = level->nodes[a].position[0], height = level->ground.height;
  if (supports->loose) lay_on_ground(level, a, b, x, height, shape);
  if (supports->pin) shape[a][0] = x;
  for (size_t i = 0; i < set->count; i++) shape[set->node[i]][1] = height;
}

/*
 * Shapes that friction alone holds along the ground.
 *
 * With friction there are as many equilibria as there are ways to share the pull along the ground among the
 * contacts. Listed is the one that needs least of it: all contacts use the same part of what they can hold, so that
 * it stands whenever some equilibrium on these contacts does.
 */

/* Changes of friction, over all forces, that are none; rounds until there are no others. */
static const double SAME = 1e-13;
enum { ROUNDS = 100 };

/* The sum of all forces from outside on coordinates along the ground (0) or across (1). */
static double sum_forces(const strut_equilibrium_search *search, int32_t component) {
  double sum = 0.0;
  for (int32_t i = 0; i < search->model->node_count; i++)
    sum += search->potential->force[2 * i + component];
  return sum;
}

strut_status strut_equilibrium_search_grips(strut_equilibrium_search *search,
                                            const strut_scene *scene, bool *hold) {
  double along = sum_forces(search, 0), press = -sum_forces(search, 1), most = 0.0;
  int32_t count = search->model->contacts.count;
  *hold = false;
  if (!search->supports.pin || search->model->contacts.surface) return STRUT_OK;
  double *grip = search->grip =
      strut_arena_allocate(&search->out->arena, (size_t)count, sizeof *grip);
  if (!grip) return strut_no_memory(search->error, "");
  for (int32_t i = 0; i < count; i++) {
    strut_friction friction = scene->contacts[i].friction;
    strut_scene_stop_grip(scene, &friction);
    if (strut_friction_has_band(friction.law) || strut_friction_is_exact(friction.law))
      grip[i] = strut_friction_static(&friction, along);
    most = fmax(most, grip[i]);
  }
  *hold = most * press >= fabs(along);
  return STRUT_OK;
}

/* A structure held at one contact, which the others help by their friction. */
typedef struct grip_search {
  const strut_equilibrium_search *search;
  strut_potential *potential;
  strut_minimiser *minimiser;
  int32_t pin;      /* node */
  double *friction; /* (contacts) [N] */
  double *q;        /* (length) */
  double used;      /* part of what all contacts could hold */
} grip_search;

static double push_at(const strut_equilibrium_search *search, int32_t i, const double *positions) {
  const strut_contact_table *contacts = &search->model->contacts;
  return fmax(0.0, -contacts->entry[i].stiffness * strut_contact_gap(contacts, i, positions));
}

/* Shares the pull along the ground among the contacts; returns the largest change of a force [N]. */
static double share(grip_search *self, double along) {
  const strut_equilibrium_search *search = self->search;
  const strut_contact_table *contacts = &search->model->contacts;
  double all = 0.0, change = 0.0;
  for (int32_t i = 0; i < contacts->count; i++)
    all += search->grip[i] * push_at(search, i, self->q);
  if (!(all > 0.0)) return HUGE_VAL;
  self->used = fabs(along) / all;
  for (int32_t i = 0; i < contacts->count; i++) {
    double now = -along * search->grip[i] * push_at(search, i, self->q) / all;
    if (contacts->entry[i].node == self->pin) continue;
    change = fmax(change, fabs(now - self->friction[i]));
    self->potential->force[contacts->at[i]] += now - self->friction[i];
    self->friction[i] = now;
  }
  return change;
}

/* Moves g->q to the equilibrium; false if no equilibrium is near it. */
static bool find_rest(grip_search *self, double along, double *residual) {
  double scale = self->search->potential->force_scale;
  for (int turn = 0; turn < ROUNDS; turn++) {
    strut_descent descent = strut_minimise(self->minimiser, self->q);
    if (descent.end == STRUT_DESCENT_RUNAWAY) return false;
    *residual = descent.residual;
    if (share(self, along) <= SAME * scale) return descent.end == STRUT_DESCENT_REACHED;
  }
  return false;
}

static bool create(grip_search *self, const double *from, strut_arena *scratch) {
  size_t length = (size_t)self->search->model->length;
  uint8_t *held = strut_arena_allocate(scratch, length, 1);
  self->friction = strut_arena_allocate(scratch, (size_t)self->search->model->contacts.count,
                                        sizeof *self->friction);
  if (!held || !self->friction) return false;
  held[2 * self->pin] = 1;
  memcpy(self->q, from, length * sizeof *self->q);
  return strut_potential_create(self->search->model, held, true, scratch, &self->potential, NULL) ==
             STRUT_OK &&
         strut_minimiser_create(self->potential, scratch, &self->minimiser, NULL) == STRUT_OK;
}

static strut_status accept(strut_equilibrium_search *search, strut_candidate_equilibrium *candidate,
                           const grip_search *self) {
  strut_equilibrium *equilibrium = &candidate->e;
  double press = 0.0;
  strut_status status = strut_equilibrium_search_contacts(search, self->q, equilibrium);
  for (int32_t i = 0; i < equilibrium->contact_count; i++) press += equilibrium->normal[i];
  if (status || !(self->used <= 1.0 + SAME)) return status;
  equilibrium->friction = fabs(sum_forces(search, 0)) / press;
  equilibrium->rest = self->q;
  equilibrium->rest_energy = strut_potential_energy(search->potential, self->q);
  equilibrium->outcome = strut_equilibrium_search_stands(search, candidate, self->q)
                             ? STRUT_OUTCOME_STANDS
                             : STRUT_OUTCOME_TIPS;
  return STRUT_OK;
}

strut_status strut_equilibrium_search_hold(strut_equilibrium_search *search,
                                           strut_candidate_equilibrium *candidate) {
  strut_arena scratch = {0};
  size_t length = (size_t)search->model->length;
  grip_search g = {.search = search, .pin = candidate->e.supports->node[0]};
  g.q = strut_arena_allocate(&search->out->arena, length, sizeof *g.q);
  strut_status status =
      g.q && create(&g, candidate->e.point.q, &scratch) ? STRUT_OK : STRUT_NO_MEMORY;
  if (status) strut_no_memory(search->error, "");
  candidate->e.outcome = STRUT_OUTCOME_NO_REST;
  if (!status && find_rest(&g, sum_forces(search, 0), &candidate->e.rest_residual))
    status = accept(search, candidate, &g);
  strut_arena_free(&scratch);
  return status;
}
