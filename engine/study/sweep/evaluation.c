/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sweep/sweep_parts.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "engine/scene/things.h"
#include "engine/statics/rigidity/rigidity_parts.h"
#include "engine/statics/search/critical.h"

static int32_t find_node(const strut_scene *scene, const char *name) {
  return strut_thing_find(scene, STRUT_THING_NODE, name);
}

strut_status strut_goals_check(const strut_study *study, const strut_scene *scene,
                               strut_study_fault *fault, strut_error *error) {
  const char *node = study->goal.stiffness_node, *like = study->goal.like;
  const strut_configuration *configuration = like ? strut_configuration_named(scene, like) : NULL;
  const char *lack = "the model has no node";
  *fault = (strut_study_fault){0};
  for (size_t i = 0; i < study->goal.shape_count; i++)
    if (find_node(scene, study->goal.shape_nodes[i]) < 0)
      *fault = (strut_study_fault){"shape", study->goal.shape_nodes[i]};
  if (node && find_node(scene, node) < 0) *fault = (strut_study_fault){"stiffness_at", node};
  if (!fault->key && like && !(configuration && configuration->shaped)) {
    *fault = (strut_study_fault){"like", like};
    lack = configuration ? "the model gives no positions for configuration"
                         : "the model has no configuration";
  }
  if (!fault->key) return STRUT_OK;
  return strut_fail(error, STRUT_BAD_SCENE, "'%s' of the study: %s '%.60s'", fault->key, lack,
                    fault->name);
}

/* The i-th pair of a node's place and of the place that is wanted; false: no such node. */
static bool find_pair(const strut_study *study, const strut_scene *scene,
                      const strut_configuration *like, const double *positions, size_t i,
                      double is[2], double wanted[2]) {
  int32_t node = like ? (int32_t)i : find_node(scene, study->goal.shape_nodes[i]);
  if (node < 0) return false;
  memcpy(is, positions + 2 * node, 2 * sizeof *is);
  memcpy(wanted, like ? like->position[i] : study->goal.shape[i], 2 * sizeof *wanted);
  return true;
}

double strut_goals_shape_distance(const strut_study *study, const strut_scene *scene,
                                  const double *positions) {
  const strut_configuration *like =
      study->goal.like ? strut_configuration_named(scene, study->goal.like) : NULL;
  size_t count = like ? scene->node_count : study->goal.like ? 0 : study->goal.shape_count;
  double a[2], b[2], middle_a[2] = {0.0, 0.0}, middle_b[2] = {0.0, 0.0};
  double square = 0.0, dot = 0.0, cross = 0.0, n = (double)count;
  for (size_t i = 0; i < count; i++) {
    if (!find_pair(study, scene, like, positions, i, a, b)) return (double)NAN;
    for (int d = 0; d < 2; d++) middle_a[d] += a[d] / n, middle_b[d] += b[d] / n;
  }
  for (size_t i = 0; i < count; i++) {
    find_pair(study, scene, like, positions, i, a, b);
    for (int d = 0; d < 2; d++) a[d] -= middle_a[d], b[d] -= middle_b[d];
    dot += a[0] * b[0] + a[1] * b[1];
    cross += a[0] * b[1] - a[1] * b[0];
  }
  double size = hypot(dot, cross), c = size > 0.0 ? dot / size : 1.0;
  double s = size > 0.0 ? cross / size : 0.0;
  for (size_t i = 0; i < count; i++) {
    find_pair(study, scene, like, positions, i, a, b);
    for (int d = 0; d < 2; d++) a[d] -= middle_a[d], b[d] -= middle_b[d];
    double x = c * a[0] - s * a[1] - b[0], y = s * a[0] + c * a[1] - b[1];
    square += x * x + y * y;
  }
  return count ? sqrt(square / n) : (double)NAN;
}

/* Does the curve from point i - 1 to point i go on in that direction, without an event? */
static bool is_smooth(const strut_path *path, size_t i, double direction) {
  double u0 = path->points[i - 1].at.factor, u = path->points[i].at.factor;
  for (size_t k = 0; k < path->event_count; k++) {
    double at = path->events[k].at.factor;
    if (at >= fmin(u0, u) && at <= fmax(u0, u)) return false;
  }
  return (u - u0) * direction > 0.0;
}

double strut_goals_force_at(const strut_path *path, double displacement) {
  const strut_path_point *points = path->points;
  for (size_t i = 0; i < path->point_count && path->coordinate >= 0; i++) {
    double u = points[i].at.factor, u0 = points[i ? i - 1 : i].at.factor, force = 0.0;
    if (u == displacement) return points[i].at.reaction[path->coordinate];
    if (!i || !((u0 - displacement) * (u - displacement) < 0.0)) continue;
    bool smooth = is_smooth(path, i, u - u0); /* then by the polynomial of up to four points */
    size_t first = i - 1 - (smooth && i > 1 && is_smooth(path, i - 1, u - u0));
    size_t last = i + (smooth && i + 1 < path->point_count && is_smooth(path, i + 1, u - u0));
    for (size_t k = first; k <= last; k++) {
      double part = points[k].at.reaction[path->coordinate];
      for (size_t other = first; other <= last; other++)
        if (other != k)
          part *= (displacement - points[other].at.factor) /
                  (points[k].at.factor - points[other].at.factor);
      force += part;
    }
    return force;
  }
  return (double)NAN;
}

double strut_goals_curve_distance(const strut_study *study, const strut_path *path) {
  double square = 0.0;
  if (!study->goal.curve_count) return (double)NAN;
  for (size_t i = 0; i < study->goal.curve_count; i++) {
    double away = strut_goals_force_at(path, study->goal.curve[i][0]) - study->goal.curve[i][1];
    square += away * away;
  }
  return sqrt(square / (double)study->goal.curve_count);
}

strut_status strut_goals_stiffness(const strut_study *study, const strut_model *model,
                                   const double *positions, double *stiffness, strut_error *error) {
  strut_node_stiffness *node_stiffness;
  const char *reason;
  int32_t node =
      study->goal.stiffness_node ? find_node(model->scene, study->goal.stiffness_node) : -1;
  *stiffness = (double)NAN;
  if (node < 0) return STRUT_OK;
  strut_status status =
      strut_node_stiffness_create(model, positions, &node_stiffness, &reason, error);
  if (status || !node_stiffness) return status;
  double direction[2] = {cos(study->goal.stiffness_direction),
                         sin(study->goal.stiffness_direction)};
  for (int i = 0; i < 2; i++) /* 90 degrees are along y alone */
    if (fabs(direction[i]) < DBL_EPSILON) direction[i] = 0.0;
  *stiffness = strut_node_stiffness_along(node_stiffness, node, direction);
  strut_node_stiffness_free(node_stiffness);
  return STRUT_OK;
}

int32_t *strut_standing_states(const strut_equilibria *equilibria, strut_arena *arena,
                               size_t *count) {
  const strut_equilibrium *list = equilibria->list;
  int32_t *states = strut_arena_allocate(arena, equilibria->count + 1, sizeof *states);
  *count = 0;
  for (size_t i = 0; i < equilibria->count && states; i++) {
    size_t k = *count;
    if (list[i].outcome != STRUT_OUTCOME_STANDS) continue;
    for (; k > 0 && list[states[k - 1]].energy > list[i].energy; k--) states[k] = states[k - 1];
    states[k] = (int32_t)i;
    ++*count;
  }
  return states;
}

const strut_mode *strut_elastic_mode(const strut_modes *modes, size_t i) {
  for (size_t k = 0; k < modes->count; k++)
    if ((modes->list[k].kind == STRUT_MODE_ELASTIC || modes->list[k].kind == STRUT_MODE_UNKNOWN) &&
        i-- == 0)
      return &modes->list[k];
  return NULL;
}

/* Maximum number of cached structures; beyond that each point searches for itself. */
enum { MOST_KEPT = 256 };
static const double NEAR = 0.1; /* of the structure's size */

/* The equilibrium of one configuration. */
typedef struct found {
  bool known;
  strut_status status;
  strut_error error;
  double *q; /* (2 node_count) of strut_allocate */
} found;

/* One structure, identified by all numbers that determine its equilibria. */
typedef struct structure {
  double *key; /* of strut_allocate */
  size_t length, capacity;
  bool failed; /* memory was out */
  size_t count;
  found *configurations; /* (count) */
  pthread_mutex_t lock;  /* of configurations */
} structure;

struct strut_equilibrium_cache {
  pthread_mutex_t lock;
  size_t count;
  structure *kept[MOST_KEPT];
};

static void add(void *context, double value) {
  structure *self = context;
  if (self->failed || !strut_grow(&self->key, &self->capacity, self->length, sizeof value))
    self->failed = true;
  else
    self->key[self->length++] = value;
}

static void free_structure(structure *self) {
  for (size_t i = 0; self->configurations && i < self->count; i++)
    strut_release(self->configurations[i].q);
  if (self->configurations) pthread_mutex_destroy(&self->lock);
  strut_release(self->configurations);
  strut_release(self->key);
  strut_release(self);
}

/* NULL: memory is out. */
static structure *describe(const strut_setup *setup) {
  const strut_scene *scene = &setup->scene;
  structure *self = strut_allocate(1, sizeof *self);
  if (!self) return NULL;
  self->count = scene->configuration_count;
  strut_setup_at_rest(setup, add, self);
  if (!self->failed)
    self->configurations = strut_allocate(self->count, sizeof *self->configurations);
  if (self->configurations && pthread_mutex_init(&self->lock, NULL) == 0) return self;
  strut_release(self->configurations);
  self->configurations = NULL;
  free_structure(self);
  return NULL;
}

static bool alike(const structure *first, const structure *second) {
  return first->count == second->count && first->length == second->length &&
         memcmp(first->key, second->key, first->length * sizeof *first->key) == 0;
}

/* The structure of a scene, kept or new; *own: the caller frees it. NULL: memory is out. */
static structure *structure_of(strut_equilibrium_cache *standing, const strut_setup *setup,
                               bool *own) {
  structure *self = describe(setup), *same = NULL;
  *own = false;
  if (!self) return NULL;
  pthread_mutex_lock(&standing->lock);
  for (size_t i = 0; i < standing->count && !same; i++)
    if (alike(standing->kept[i], self)) same = standing->kept[i];
  if (!same && standing->count < MOST_KEPT)
    standing->kept[standing->count++] = self;
  else
    *own = !same;
  pthread_mutex_unlock(&standing->lock);
  if (same) free_structure(self);
  return same ? same : self;
}

static void find_equilibrium(const strut_setup *setup, size_t configuration, found *self) {
  const strut_scene *scene = &setup->scene;
  strut_model *model = NULL;
  strut_arena arena = {0};
  strut_rest_state stand;
  size_t size = 2 * scene->node_count;
  self->known = true;
  self->status = strut_model_compile(scene, &model, &self->error);
  if (!self->status)
    self->status =
        strut_rest_state_find(model, &setup->experiment, scene->configurations[configuration].name,
                              &arena, &stand, &self->error);
  if (!self->status && !(self->q = strut_allocate(size, sizeof *self->q)))
    self->status = strut_fail(&self->error, STRUT_NO_MEMORY, "out of memory");
  if (!self->status) memcpy(self->q, stand.q, size * sizeof *self->q);
  if (self->status == STRUT_NO_MEMORY) self->known = false; /* retry later */
  strut_arena_free(&arena);
  strut_model_free(model);
}

/*
 * The equilibrium of a configuration; its positions are valid as long as the structure. A copy, since another
 * thread searches again where memory was out.
 */
static found find(structure *self, const strut_setup *setup, size_t configuration) {
  found *f = &self->configurations[configuration];
  pthread_mutex_lock(&self->lock);
  if (!f->known) find_equilibrium(setup, configuration, f);
  found copy = *f;
  pthread_mutex_unlock(&self->lock);
  return copy;
}

strut_equilibrium_cache *strut_equilibrium_cache_create(void) {
  strut_equilibrium_cache *standing = strut_allocate(1, sizeof *standing);
  if (standing && pthread_mutex_init(&standing->lock, NULL) == 0) return standing;
  strut_release(standing);
  return NULL;
}

void strut_equilibrium_cache_free(strut_equilibrium_cache *standing) {
  if (!standing) return;
  for (size_t i = 0; i < standing->count; i++) free_structure(standing->kept[i]);
  pthread_mutex_destroy(&standing->lock);
  strut_release(standing);
}

strut_status strut_equilibrium_cache_resolve(strut_equilibrium_cache *standing, strut_setup *setup,
                                             strut_error *error) {
  strut_scene *scene = &setup->scene;
  bool own;
  if (scene->start_equilibrium < 0) return STRUT_OK;
  structure *self = structure_of(standing, setup, &own);
  if (!self) return strut_no_memory(error, "");
  const found f = find(self, setup, (size_t)scene->start_equilibrium);
  strut_status status = f.status;
  if (status) strut_fail(error, status, "%s", f.error.message);
  for (size_t i = 0; i < scene->node_count && !status; i++)
    for (size_t c = 0; c < 2; c++)
      if (!scene->nodes[i].fixed[c]) scene->nodes[i].start[c] = f.q[2 * i + c];
  if (!status) scene->start_equilibrium = -1;
  if (own) free_structure(self);
  return status;
}

static double extent(const double *positions, size_t nodes) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < 2 * nodes; i++) {
    low[i % 2] = fmin(low[i % 2], positions[i]);
    high[i % 2] = fmax(high[i % 2], positions[i]);
  }
  return fmax(high[0] - low[0], high[1] - low[1]);
}

/* *index: -1 where none is near. STRUT_OK or STRUT_NO_MEMORY. */
static strut_status nearest(structure *self, const strut_setup *setup, const double *positions,
                            int32_t *index, strut_error *error) {
  const strut_scene *scene = &setup->scene;
  const strut_model shape = {.node_count = (int32_t)scene->node_count};
  double least = HUGE_VAL;
  for (size_t i = 0; i < scene->configuration_count; i++) {
    const found f = find(self, setup, i);
    if (f.status == STRUT_NO_MEMORY) return strut_fail(error, f.status, "%s", f.error.message);
    if (f.status) continue;
    double d = strut_shape_distance(&shape, f.q, positions, !scene->configurations[i].shaped, NULL);
    if (!(d < least) || d > NEAR * extent(f.q, scene->node_count)) continue;
    least = d;
    *index = (int32_t)i;
  }
  return STRUT_OK;
}

/* The nearest configuration must not depend on the start of the run. */
strut_status strut_equilibrium_cache_nearest(strut_equilibrium_cache *standing,
                                             const strut_setup *setup, const double *positions,
                                             int32_t *index, strut_error *error) {
  bool own = false;
  const strut_scene *scene = &setup->scene;
  strut_setup drawn = *setup; /* shares all but its nodes */
  *index = -1;
  if (scene->configuration_count == 0) return STRUT_OK;
  drawn.scene.start_equilibrium = -1;
  drawn.scene.nodes = strut_allocate(scene->node_count, sizeof *drawn.scene.nodes);
  for (size_t i = 0; drawn.scene.nodes && i < scene->node_count; i++) {
    drawn.scene.nodes[i] = scene->nodes[i];
    for (size_t c = 0; c < 2; c++)
      if (!drawn.scene.nodes[i].fixed[c])
        drawn.scene.nodes[i].start[c] = drawn.scene.nodes[i].position[c];
  }
  structure *self = drawn.scene.nodes ? structure_of(standing, &drawn, &own) : NULL;
  strut_status status =
      self ? nearest(self, &drawn, positions, index, error) : strut_no_memory(error, "");
  strut_release(drawn.scene.nodes);
  if (own) free_structure(self);
  return status;
}
