/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Branches: the paths that leave others at bifurcations, each along the null vector found there. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/things.h"
#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

enum { PLACES = 64 };

static const double USUAL = 0.01;     /* longest first step of a branch [units of y] */
static const double SAME_FORK = 1e-5; /* two bifurcations so near are one [units of y] */
static const double PASSING = 0.02;   /* of a step: a branch so near a bifurcation passes it */
static const double ALIKE = 1e-6;     /* of the range: values of the parameter on twins */
static const double NEARLY = 0.02;    /* of their lengths, likewise, as chords have them */
static const double ARRIVING = 0.5;   /* cosine to the path by which a walk came to a bifurcation */

bool strut_path_wants_fork(strut_path_walk *walk, const double *unknowns) {
  if (!walk->forks.fork || walk->forks.depth >= walk->system.parameter.options->branches)
    return false;
  for (size_t k = 0; k < walk->forks.count; k++) /* its sphere has all that leaves this one, too */
    if (strut_path_distance(walk, walk->forks.fork[k].y, unknowns) <
        fmax(walk->forks.fork[k].rays.radius, SAME_FORK))
      return false;
  if (walk->forks.count < STRUT_PATH_FORKS) return true;
  walk->forks.left++;
  return false;
}

bool strut_path_freeze(const strut_path_walk *walk, strut_arena *arena, strut_path_frozen *frozen) {
  const strut_path_system *system = &walk->system;
  const strut_model *model = system->model;
  size_t numbers = 2 * ((size_t)system->n + 1);
  *frozen = (strut_path_frozen){system->lends,
                                system->latest.pulling,
                                system->contacts.contact,
                                system->elements.element,
                                walk->y,
                                walk->next,
                                walk->tangent};
  return STRUT_DUPLICATE(arena, STRUT_NEW(frozen->pulling, model->members.count),
                         STRUT_NEW(frozen->contact, model->contacts.count),
                         STRUT_NEW(frozen->element, model->elements.count),
                         STRUT_NEW(frozen->y, numbers), STRUT_NEW(frozen->next, numbers),
                         STRUT_NEW(frozen->tangent, numbers));
}

void strut_path_thaw(strut_path_walk *walk, const strut_path_frozen *frozen) {
  strut_path_system *system = &walk->system;
  size_t contacts = (size_t)system->model->contacts.count, bytes = strut_path_bytes(walk),
         elements = (size_t)system->model->elements.count;
  system->lends = frozen->lends;
  memcpy(system->latest.pulling, frozen->pulling, (size_t)system->model->members.count);
  if (contacts)
    memcpy(system->contacts.contact, frozen->contact, contacts * sizeof *frozen->contact);
  if (elements)
    memcpy(system->elements.element, frozen->element, elements * sizeof *frozen->element);
  memcpy(walk->y, frozen->y, bytes);
  memcpy(walk->next, frozen->next, bytes);
  memcpy(walk->tangent, frozen->tangent, bytes);
}

void strut_path_keep_fork(strut_path_walk *walk, const double *unknowns,
                          const strut_path_rays *rays, const strut_path_ray *way) {
  strut_path_system *system = &walk->system;
  if (!strut_path_wants_fork(walk, unknowns)) return;
  strut_path_fork *fork = &walk->forks.fork[walk->forks.count];
  *fork =
      (strut_path_fork){.y = strut_arena_copy(&system->arena, unknowns, 1, strut_path_bytes(walk)),
                        .rays = *rays,
                        .factor = strut_path_value(system, unknowns),
                        .arc = walk->arc + strut_path_distance(walk, walk->y, unknowns),
                        .path = walk->forks.path,
                        .depth = walk->forks.depth};
  walk->failed =
      walk->failed || !fork->y || !strut_path_freeze(walk, &system->arena, &fork->frozen);
  for (int32_t k = 0; k < rays->count; k++)
    fork->rays.ray[k].done =
        fork->rays.ray[k].own < 0 || &rays->ray[k] == way || (!way && fork->rays.ray[k].own > 0);
  walk->forks.count += !walk->failed;
}

/* Directions of members at the latest place count as theirs from now on, or what is found next. */
static void forget_directions(strut_path_system *system) {
  memset(system->latest.ahead, 0,
         2 * (size_t)system->model->members.count * sizeof *system->latest.ahead);
}

/* The first two points of a branch, the bifurcation and one off it; false: none is found. */
static bool leave_fork(strut_path_walk *walk, const strut_path_fork *fork,
                       const strut_path_ray *ray) {
  strut_path_system *system = &walk->system;
  strut_path_thaw(walk, &fork->frozen);
  memcpy(walk->y, fork->y, strut_path_bytes(walk));
  forget_directions(system);
  if (!strut_path_tangent(system, ray->y, ray->direction, walk->tangent)) return false;
  walk->negative = ray->negative;
  walk->arc = 0.0;
  strut_path_add_point(walk, walk->negative);
  walk->arc = strut_path_distance(walk, ray->y, walk->y);
  walk->step = fmin(USUAL, 2.0 * walk->arc);
  memcpy(walk->y, ray->y, strut_path_bytes(walk));
  strut_path_count_negative(walk);
  strut_path_add_point(walk, walk->negative);
  return !walk->failed;
}

/* The way by which the latest step has come to a bifurcation need not be walked again. */
static void mark_arrival(const strut_path_walk *walk, strut_path_fork *fork) {
  double distance = strut_path_distance(walk, walk->last, fork->y), most = ARRIVING;
  strut_path_ray *own = NULL;
  for (int32_t k = 0; k < fork->rays.count && distance > 0; k++) {
    const double *way = fork->rays.ray[k].direction;
    double along = strut_path_dot(walk, way, walk->last) - strut_path_dot(walk, way, fork->y);
    if (along / distance > most) most = along / distance, own = &fork->rays.ray[k];
  }
  if (own) own->done = true;
}

/* Distance of a bifurcation to the latest step of the walk, a cubic. */
static double passing_distance(const strut_path_walk *walk, const double *unknowns) {
  const double *from = walk->last, *tangent = walk->last_tangent;
  double length = strut_path_distance(walk, walk->y, from), least = HUGE_VAL;
  for (int k = 0; k <= PLACES; k++) {
    double t = (double)k / PLACES, r = 1 - t, square = 0;
    for (int32_t i = 0; i <= walk->system.n; i++) {
      double at = r * r * (1 + 2 * t) * from[i] + t * t * (1 + 2 * r) * walk->y[i] +
                  length * t * r * (r * tangent[i] - t * walk->tangent[i]);
      square += (at - unknowns[i]) * (at - unknowns[i]);
    }
    least = fmin(least, sqrt(square));
  }
  return least / length;
}

/* Ends the branch, which begins at `origin`, at a known bifurcation that its last step has passed. */
static bool join_fork(strut_path_walk *walk, const strut_path_fork *origin) {
  for (size_t k = 0; k < walk->forks.count; k++) {
    strut_path_fork *fork = &walk->forks.fork[k];
    if (fork->path == walk->forks.path || (fork == origin && walk->path->point_count < 5) ||
        passing_distance(walk, fork->y) > PASSING + 1.0 / PLACES)
      continue;
    mark_arrival(walk, fork);
    strut_path_end_within(walk, fork->y, STRUT_PATH_JOINED);
    char joined[40] = "the path", at[STRUT_PATH_TEXT];
    if (fork->path) snprintf(joined, sizeof joined, "branch %d", (int)fork->path);
    snprintf(walk->path->remark, sizeof walk->path->remark, "joins %s at the bifurcation at %s",
             joined, strut_path_at(walk, fork->factor, at));
    return true;
  }
  return false;
}

/* Steps along a branch from its second point. */
static void walk_branch(strut_path_walk *walk, const strut_path_fork *origin,
                        const strut_experiment *experiment) {
  const strut_path_options *options = walk->system.parameter.options;
  int32_t steps = options->steps > 0 ? options->steps : STRUT_PATH_USUAL_STEPS;
  walk->path->end = STRUT_PATH_STEPS;
  for (int32_t i = 0; i < steps && !walk->failed && !strut_experiment_interrupted(experiment);
       i++) {
    bool on = strut_path_walk_step(walk);
    if (walk->failed || join_fork(walk, origin) || !on) break;
  }
  strut_path_remark_steps(walk, steps);
}

/* Square of what the coordinates change by along a path [m^2]. */
static double change_along(const strut_path *path, int32_t length) {
  double sum = 0;
  for (int32_t i = 0; i < length; i++) {
    double change = path->points[path->point_count - 1].at.q[i] - path->points[0].at.q[i];
    sum += change * change;
  }
  return sum;
}

/* Does the parameter do the same on both? Their steps may differ. */
static bool are_twins(const strut_path_walk *walk, const strut_path *first,
                      const strut_path *second) {
  const strut_path_point *point = &first->points[first->point_count - 1],
                         *t = &second->points[second->point_count - 1];
  int32_t length = walk->system.model->length;
  double least = ALIKE * fabs(walk->system.parameter.range), moved = change_along(first, length);
  bool alike = first->event_count == second->event_count && first->end == second->end &&
               point->negative == t->negative && fabs(point->at.factor - t->at.factor) <= least &&
               fabs(point->at.arc - t->at.arc) <= NEARLY * point->at.arc &&
               fabs(moved - change_along(second, length)) <= ALIKE * moved;
  for (size_t k = 0; k < first->event_count && alike; k++) {
    const strut_path_event *one = &first->events[k], *other = &second->events[k];
    alike = fabs(one->at.factor - other->at.factor) <= least && one->kind == other->kind &&
            one->after == other->after;
  }
  return alike;
}

static void add_remark(strut_path *path, const char *what) {
  size_t used = strlen(path->remark);
  snprintf(path->remark + used, sizeof path->remark - used, "%s%s", used ? "; " : "", what);
}

/* The branch of fork k along a ray. */
static void walk_ray(strut_path_walk *walk, size_t k, strut_path_ray *ray, strut_path *path,
                     const strut_experiment *experiment) {
  strut_path_fork *fork = &walk->forks.fork[k];
  strut_path *branch = &path->branches[path->branch_count];
  *branch = (strut_path){.over = path->over,
                         .load = path->load,
                         .name = path->name,
                         .unit = path->unit,
                         .reference = path->reference,
                         .several = path->several,
                         .coordinate = path->coordinate,
                         .friction = path->friction,
                         .grips = path->grips,
                         .held = path->held,
                         .from = {.path = fork->path, .factor = fork->factor, .arc = fork->arc}};
  walk->path = branch;
  walk->point_room = walk->event_room = 0;
  walk->forks.path = (int32_t)path->branch_count + 1;
  walk->forks.depth = fork->depth + 1;
  ray->done = true;
  if (leave_fork(walk, fork, ray)) {
    path->branch_count++;
    walk_branch(walk, fork, experiment);
    return;
  }
  strut_path_free(branch);
  walk->forks.lost++;
}

/* Of the branches of one fork, from `first` on: two each that resemble one another. */
static void pair_twins(const strut_path_walk *walk, strut_path *path, size_t first) {
  for (size_t i = first; i < path->branch_count; i++)
    for (size_t k = i + 1; k < path->branch_count && !path->branches[i].from.twin; k++) {
      strut_path *a = &path->branches[i], *b = &path->branches[k];
      if (b->from.twin || !are_twins(walk, a, b)) continue;
      a->from.twin = (int32_t)k + 1, b->from.twin = (int32_t)i + 1;
    }
}

void strut_path_walk_branches(strut_path_walk *walk, strut_path *path,
                              const strut_experiment *experiment) {
  for (size_t k = 0; k < walk->forks.count && !walk->failed; k++) { /* walks add more */
    size_t first = path->branch_count;
    for (int32_t i = 0; i < walk->forks.fork[k].rays.count && !walk->failed; i++) {
      strut_path_ray *ray = &walk->forks.fork[k].rays.ray[i];
      if (ray->done || strut_experiment_interrupted(experiment)) continue;
      if (path->branch_count == STRUT_PATH_BRANCHES)
        walk->forks.left++;
      else
        walk_ray(walk, k, ray, path, experiment);
    }
    pair_twins(walk, path, first);
  }
  walk->path = path;
  if (walk->forks.lost) add_remark(path, "some branches were lost where they begin");
  if (walk->forks.left) add_remark(path, "there are more branches than are followed");
}

/* A path in stages: each is a path of its own, of a scene that keeps what those before it left. */

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
      !STRUT_NUMBERS(arena, length, &self->q, &self->moved) ||
      !STRUT_NUMBERS(arena, scene->load_count, &self->factor) ||
      !STRUT_NUMBERS(arena, scene->actuator_count, &self->drive))
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
