/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A path in stages: each is a path of its own, of a scene that keeps what those before it left. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/things.h"
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

static bool create_stages(stages *s) {
  const strut_scene *scene = s->model->scene;
  const strut_experiment *e = s->experiment;
  size_t length = (size_t)s->model->length;
  s->q = strut_arena_allocate(&s->arena, length, sizeof *s->q);
  s->factor = strut_arena_allocate(&s->arena, scene->load_count, sizeof *s->factor);
  s->staged = strut_arena_allocate(&s->arena, scene->load_count, sizeof *s->staged);
  s->drive = strut_arena_allocate(&s->arena, scene->actuator_count, sizeof *s->drive);
  s->moved = strut_arena_allocate(&s->arena, length, sizeof *s->moved);
  s->held = strut_arena_allocate(&s->arena, length, sizeof *s->held);
  s->path = strut_allocate(e->stage_count, sizeof *s->path);
  if (!s->q || !s->factor || !s->staged || !s->drive || !s->moved || !s->held || !s->path)
    return false;
  memcpy(s->held, s->model->fixed, length);
  for (size_t i = 0; i < scene->load_count; i++) {
    s->factor[i] = 1.0;
    for (size_t k = 0; k < e->stage_count; k++)
      if (e->stages[k].load && strut_path_names_load(e->stages[k].load, scene->loads[i].name))
        s->factor[i] = 0.0, s->staged[i] = 1;
  }
  return true;
}

/* Options of stage k from where its parameter is. */
static strut_path_options options_of(stages *s, size_t k) {
  const strut_path_stage *stage = &s->experiment->stages[k];
  const strut_scene *scene = s->model->scene;
  bool last = k + 1 == s->experiment->stage_count;
  strut_path_options o = {.over = STRUT_PATH_OVER_LOAD,
                          .until = stage->until,
                          .start = k ? s->q : NULL,
                          .after = k ? &s->path[k - 1] : NULL,
                          .at = k ? NULL : s->usual->at,
                          .branches = last ? s->usual->branches : 0,
                          .friction = s->usual->friction,
                          .steps = stage->steps ? stage->steps : s->usual->steps};
  if (stage->load) {
    o.load = stage->load;
    for (size_t i = 0; i < scene->load_count; i++)
      if (strut_path_names_load(stage->load, scene->loads[i].name)) o.from = s->factor[i];
  } else if (stage->release) {
    o.load = strut_arena_format(&s->single, "reaction of %s", stage->release);
    o.from = 1.0;
  } else {
    o.over = STRUT_PATH_OVER_ACTUATOR;
    o.index = strut_thing_find(scene, STRUT_THING_ACTUATOR, stage->over);
    if (o.index >= 0) {
      o.from = s->drive[o.index];
    } else {
      o.over = STRUT_PATH_OVER_COORDINATE;
      o.index = strut_coordinate_find(scene, stage->over);
      o.from = s->moved[o.index];
    }
  }
  if (stage->stop >= 0) o.stop = (strut_path_stop){true, stage->stop, stage->stop_distance};
  return o;
}

/* Loads at their factors, but the one that is followed; of a release, the reaction as one more. */
static bool set_loads(stages *s, const strut_path_stage *stage, const strut_path_options *o,
                      strut_scene *scene) {
  strut_load *loads = strut_arena_allocate(&s->single, scene->load_count + 1, sizeof *loads);
  if (!loads) return false;
  for (size_t i = 0; i < scene->load_count; i++) {
    loads[i] = scene->loads[i];
    if (stage->load && strut_path_names_load(stage->load, loads[i].name)) continue;
    if (s->staged[i]) loads[i].signal = -1;
    strut_load_scale(&loads[i], s->factor[i]);
  }
  scene->loads = loads;
  if (!stage->release) return true;
  int32_t at = strut_coordinate_find(scene, stage->release);
  strut_load *reaction = &loads[scene->load_count++];
  *reaction = (strut_load){.name = o->load, .node = at / 2, .signal = -1};
  reaction->force[at % 2] = s->reaction[at];
  return o->load != NULL;
}

/* Coordinates that are held where they are. */
static bool set_supports(stages *s, strut_scene *scene) {
  strut_node *nodes = strut_arena_copy(&s->single, scene->nodes, scene->node_count, sizeof *nodes);
  if (!nodes) return false;
  for (size_t i = 0; i < 2 * scene->node_count; i++) {
    nodes[i / 2].fixed[i % 2] = s->held[i];
    if (s->held[i]) nodes[i / 2].start[i % 2] = s->q[i];
  }
  scene->nodes = nodes;
  return true;
}

/* What a stage holds and lets go. A coordinate that is followed is held by the path itself. */
static void change_supports(stages *s, const strut_path_stage *stage, const strut_path_options *o) {
  for (size_t i = 0; i < stage->hold_count; i++)
    if (!(o->over == STRUT_PATH_OVER_COORDINATE && o->index == stage->hold[i]))
      s->held[stage->hold[i]] = 1;
  if (stage->release) {
    int32_t at = strut_coordinate_find(s->model->scene, stage->release);
    s->held[at] = 0;
    s->moved[at] = 0.0;
  }
}

/* Keeps where the stage ended for the next. */
static void keep_end(stages *s, const strut_path_stage *stage, const strut_path_options *o,
                     const strut_path *path) {
  const strut_path_point *end = &path->points[path->point_count - 1];
  memcpy(s->q, end->at.q, (size_t)s->model->length * sizeof *s->q);
  s->reaction = end->at.reaction;
  for (size_t i = 0; i < s->model->scene->load_count && stage->load; i++)
    if (strut_path_names_load(stage->load, s->model->scene->loads[i].name))
      s->factor[i] = end->at.factor;
  if (o->over == STRUT_PATH_OVER_ACTUATOR) s->drive[o->index] = end->at.factor;
  if (o->over == STRUT_PATH_OVER_COORDINATE)
    s->held[o->index] = 1, s->moved[o->index] = end->at.factor;
}

/* Follows stage k into s->path[k]. */
static strut_status follow_stage(stages *s, size_t k, strut_path_options *o, strut_error *error) {
  const strut_path_stage *stage = &s->experiment->stages[k];
  strut_scene scene = *s->model->scene;
  strut_model *model = NULL;
  *o = options_of(s, k);
  if (!k) memcpy(s->q, s->model->start, (size_t)s->model->length * sizeof *s->q);
  change_supports(s, stage, o);
  bool made = set_loads(s, stage, o, &scene) && set_supports(s, &scene);
  strut_status status = made ? STRUT_OK : strut_no_memory(error, "");
  for (size_t i = 0; i < scene.actuator_count && status == STRUT_OK; i++)
    if (s->drive[i] != 0 && !(o->over == STRUT_PATH_OVER_ACTUATOR && o->index == (int32_t)i))
      status =
          strut_path_set_actuator(s->model, (int32_t)i, s->drive[i], &s->single, &scene, error);
  if (status == STRUT_OK) status = strut_model_compile(&scene, &model, error);
  if (status == STRUT_OK) status = strut_path_follow(model, s->experiment, o, &s->path[k], error);
  if (status == STRUT_OK) keep_end(s, stage, o, &s->path[k]);
  strut_model_free(model);
  return status;
}

/* All stages show the same coordinates as held. */
static bool join_held(stages *s, size_t count) {
  size_t length = (size_t)s->model->length;
  uint8_t *held = strut_arena_allocate(&s->path[count - 1].arena, length, sizeof *held);
  if (!held) return false;
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < length; i++) held[i] |= s->path[k].held[i];
  for (size_t k = 0; k < count; k++) {
    s->path[k].held = held;
    for (size_t b = 0; b < s->path[k].branch_count; b++) s->path[k].branches[b].held = held;
  }
  return true;
}

/* Says why stages were left out. */
static void remark_rest(const stages *s, size_t count, const strut_error *why) {
  strut_path *path = &s->path[count - 1];
  size_t used = strlen(path->remark), all = s->experiment->stage_count;
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
