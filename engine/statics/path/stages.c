/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A path in stages: each is a path of its own, of a scene that keeps what those before it left. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/things.h"
#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

/* What the stages so far left. */
typedef struct stages {
  const strut_model *model; /* as drawn */
  const strut_experiment *experiment;
  const strut_path_options *usual;
  double *q;                 /* (length) the equilibrium */
  double *factor;            /* (loads) of those that a stage names, from 0; of others 1 */
  uint8_t *staged;           /* (loads) 1 where a stage names it */
  double *drive;             /* (actuators) value */
  double *moved;             /* (length) displacement that a stage gave to a coordinate */
  uint8_t *held;             /* (length) 1 where it is held, by supports or a stage */
  const double *reaction;    /* (length) of the last stage, or NULL */
  strut_path *path;          /* (experiment->stage_count) */
  strut_arena arena, single; /* for all stages; for one */
} stages;

static bool create_stages(stages *self) {
  const strut_scene *scene = self->model->scene;
  const strut_experiment *experiment = self->experiment;
  size_t length = (size_t)self->model->length;
  strut_arena *arena = &self->arena;
  self->staged = strut_arena_allocate(arena, scene->load_count, sizeof *self->staged);
  self->held = strut_arena_copy(arena, self->model->fixed, length, sizeof *self->held);
  self->path = strut_allocate(experiment->stage_count, sizeof *self->path);
  if (!self->staged || !self->held || !self->path ||
      !strut_arena_numbers(arena, length, (double **[]){&self->q, &self->moved, NULL}) ||
      !strut_arena_numbers(arena, scene->load_count, (double **[]){&self->factor, NULL}) ||
      !strut_arena_numbers(arena, scene->actuator_count, (double **[]){&self->drive, NULL}))
    return false;
  for (size_t i = 0; i < scene->load_count; i++) {
    self->factor[i] = 1.0;
    for (size_t k = 0; k < experiment->stage_count; k++)
      if (experiment->stages[k].load &&
          strut_path_names_load(experiment->stages[k].load, scene->loads[i].name))
        self->factor[i] = 0.0, self->staged[i] = 1;
  }
  return true;
}

/* Options of stage k from where its parameter is. */
static strut_path_options options_of(stages *self, size_t k) {
  const strut_path_stage *stage = &self->experiment->stages[k];
  const strut_scene *scene = self->model->scene;
  bool last = k + 1 == self->experiment->stage_count;
  strut_path_options o = {.over = STRUT_PATH_OVER_LOAD,
                          .until = stage->until,
                          .start = k ? self->q : NULL,
                          .after = k ? &self->path[k - 1] : NULL,
                          .at = k ? NULL : self->usual->at,
                          .branches = last ? self->usual->branches : 0,
                          .friction = self->usual->friction,
                          .steps = stage->steps ? stage->steps : self->usual->steps};
  if (stage->load) {
    o.load = stage->load;
    for (size_t i = 0; i < scene->load_count; i++)
      if (strut_path_names_load(stage->load, scene->loads[i].name)) o.from = self->factor[i];
  } else if (stage->release) {
    o.load = strut_arena_format(&self->single, "reaction of %s", stage->release);
    o.from = 1.0;
  } else {
    o.over = STRUT_PATH_OVER_ACTUATOR;
    o.index = strut_thing_find(scene, STRUT_THING_ACTUATOR, stage->over);
    if (o.index >= 0) {
      o.from = self->drive[o.index];
    } else {
      o.over = STRUT_PATH_OVER_COORDINATE;
      o.index = strut_coordinate_find(scene, stage->over);
      o.from = self->moved[o.index];
    }
  }
  if (stage->stop >= 0) o.stop = (strut_path_stop){true, stage->stop, stage->stop_distance};
  return o;
}

/* Loads at their factors, but the one that is followed; of a release, the reaction as one more. */
static bool set_loads(stages *self, const strut_path_stage *stage,
                      const strut_path_options *options, strut_scene *scene) {
  strut_load *loads = strut_arena_allocate(&self->single, scene->load_count + 1, sizeof *loads);
  if (!loads) return false;
  for (size_t i = 0; i < scene->load_count; i++) {
    loads[i] = scene->loads[i];
    if (stage->load && strut_path_names_load(stage->load, loads[i].name)) continue;
    if (self->staged[i]) loads[i].signal = -1;
    strut_load_scale(&loads[i], self->factor[i]);
  }
  scene->loads = loads;
  if (!stage->release) return true;
  int32_t at = strut_coordinate_find(scene, stage->release);
  strut_load *reaction = &loads[scene->load_count++];
  *reaction = (strut_load){.name = options->load, .node = at / 2, .signal = -1};
  reaction->force[at % 2] = self->reaction[at];
  return options->load != NULL;
}

/* Coordinates that are held where they are. */
static bool set_supports(stages *self, strut_scene *scene) {
  strut_node *nodes =
      strut_arena_copy(&self->single, scene->nodes, scene->node_count, sizeof *nodes);
  if (!nodes) return false;
  for (size_t i = 0; i < 2 * scene->node_count; i++) {
    nodes[i / 2].fixed[i % 2] = self->held[i];
    if (self->held[i]) nodes[i / 2].start[i % 2] = self->q[i];
  }
  scene->nodes = nodes;
  return true;
}

/* What a stage holds and lets go. A coordinate that is followed is held by the path itself. */
static void change_supports(stages *self, const strut_path_stage *stage,
                            const strut_path_options *options) {
  for (size_t i = 0; i < stage->hold_count; i++)
    if (!(options->over == STRUT_PATH_OVER_COORDINATE && options->index == stage->hold[i]))
      self->held[stage->hold[i]] = 1;
  if (stage->release) {
    int32_t at = strut_coordinate_find(self->model->scene, stage->release);
    self->held[at] = 0;
    self->moved[at] = 0.0;
  }
}

/* Keeps where the stage ended for the next. */
static void keep_end(stages *self, const strut_path_stage *stage, const strut_path_options *options,
                     const strut_path *path) {
  const strut_path_point *end = &path->points[path->point_count - 1];
  memcpy(self->q, end->at.q, (size_t)self->model->length * sizeof *self->q);
  self->reaction = end->at.reaction;
  for (size_t i = 0; i < self->model->scene->load_count && stage->load; i++)
    if (strut_path_names_load(stage->load, self->model->scene->loads[i].name))
      self->factor[i] = end->at.factor;
  if (options->over == STRUT_PATH_OVER_ACTUATOR) self->drive[options->index] = end->at.factor;
  if (options->over == STRUT_PATH_OVER_COORDINATE)
    self->held[options->index] = 1, self->moved[options->index] = end->at.factor;
}

/* Follows stage k into s->path[k]. */
static strut_status follow_stage(stages *self, size_t k, strut_path_options *options,
                                 strut_error *error) {
  const strut_path_stage *stage = &self->experiment->stages[k];
  strut_scene scene = *self->model->scene;
  strut_model *model = NULL;
  *options = options_of(self, k);
  if (!k) memcpy(self->q, self->model->start, (size_t)self->model->length * sizeof *self->q);
  change_supports(self, stage, options);
  bool made = set_loads(self, stage, options, &scene) && set_supports(self, &scene);
  strut_status status = made ? STRUT_OK : strut_no_memory(error, "");
  for (size_t i = 0; i < scene.actuator_count && status == STRUT_OK; i++)
    if (self->drive[i] != 0 &&
        !(options->over == STRUT_PATH_OVER_ACTUATOR && options->index == (int32_t)i))
      status = strut_path_set_actuator(self->model, (int32_t)i, self->drive[i], &self->single,
                                       &scene, error);
  if (status == STRUT_OK) status = strut_model_compile(&scene, &model, error);
  if (status == STRUT_OK)
    status = strut_path_follow(model, self->experiment, options, &self->path[k], error);
  if (status == STRUT_OK) keep_end(self, stage, options, &self->path[k]);
  strut_model_free(model);
  return status;
}

/* All stages show the same coordinates as held. */
static bool join_held(stages *self, size_t count) {
  size_t length = (size_t)self->model->length;
  uint8_t *held = strut_arena_allocate(&self->path[count - 1].arena, length, sizeof *held);
  if (!held) return false;
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < length; i++) held[i] |= self->path[k].held[i];
  for (size_t k = 0; k < count; k++) {
    self->path[k].held = held;
    for (size_t b = 0; b < self->path[k].branch_count; b++) self->path[k].branches[b].held = held;
  }
  return true;
}

/* Says why stages were left out. */
static void remark_rest(const stages *self, size_t count, const strut_error *why) {
  strut_path *path = &self->path[count - 1];
  size_t used = strlen(path->remark), all = self->experiment->stage_count;
  snprintf(path->remark + used, sizeof path->remark - used, "%sstage %zu of %zu is the last: %s",
           used ? "; " : "", count, all,
           why->status ? why->message : "the next would not begin where this was to end");
}

strut_status strut_path_follow_stages(const strut_model *model, const strut_experiment *experiment,
                                      const strut_path_options *usual, strut_path *path,
                                      strut_error *error) {
  stages s = {.model = model, .experiment = experiment, .usual = usual};
  strut_error why = {0};
  size_t count = 0, all = experiment->stage_count;
  bool on = true;
  *path = (strut_path){0};
  strut_status status = create_stages(&s) ? STRUT_OK : strut_no_memory(error, "");
  while (status == STRUT_OK && on && count < all) {
    strut_path_options o;
    const strut_path *now = &s.path[count];
    status = follow_stage(&s, count, &o, &why);
    if (status == STRUT_OK)
      count++;
    else
      strut_path_free(&s.path[count]);
    on = status == STRUT_OK && (now->end == STRUT_PATH_UNTIL || now->end == STRUT_PATH_STOP);
    strut_arena_free(&s.single);
  }
  bool kept = count > 0 && (status == STRUT_OK || status == STRUT_NOT_SETTLED);
  if (!kept && why.status) *error = why;
  if (kept && count < all) remark_rest(&s, count, &why);
  if (kept) status = join_held(&s, count) ? STRUT_OK : strut_no_memory(error, "");
  if (status == STRUT_OK) {
    *path = s.path[count - 1];
    path->stages = s.path;
    path->stage_count = count - 1;
  } else {
    for (size_t k = 0; k < all && s.path; k++) strut_path_free(&s.path[k]);
    strut_release(s.path);
  }
  strut_arena_free(&s.arena);
  return status;
}
