/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Branches: the paths that leave others at bifurcations, each along the null vector found there. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/statics/path/path_parts.h"

enum { PLACES = 64 };

static const double USUAL = 0.01;     /* longest first step of a branch [units of y] */
static const double SAME_FORK = 1e-5; /* two bifurcations so near are one [units of y] */
static const double PASSING = 0.02;   /* of a step: a branch so near a bifurcation passes it */
static const double ALIKE = 1e-6;     /* of the range: values of the parameter on twins */
static const double NEARLY = 0.02;    /* of their lengths, likewise, as chords have them */
static const double AHEAD = 0.95;     /* cosine to a bifurcation that lies on the way */
static const double ARRIVING = 0.5;   /* cosine to the path by which a walk came to a bifurcation */

static bool is_known_fork(const strut_path_walk *walk, const double *unknowns) {
  for (size_t k = 0; k < walk->forks.count; k++)
    if (walk->forks.fork[k].path != walk->forks.path &&
        strut_path_distance(walk, walk->forks.fork[k].y, unknowns) < SAME_FORK)
      return true;
  return false;
}

bool strut_path_wants_fork(strut_path_walk *walk, const double *unknowns) {
  if (!walk->forks.fork || walk->forks.depth >= walk->system.parameter.options->branches ||
      is_known_fork(walk, unknowns))
    return false;
  for (size_t k = 0; k < walk->forks.count; k++) /* its sphere has all that leaves this one, too */
    if (strut_path_distance(walk, walk->forks.fork[k].y, unknowns) <
        walk->forks.fork[k].rays.radius)
      return false;
  if (walk->forks.count < STRUT_PATH_FORKS) return true;
  walk->forks.left++;
  return false;
}

void strut_path_keep_fork(strut_path_walk *walk, const double *unknowns,
                          const strut_path_rays *rays, const strut_path_ray *way) {
  strut_path_system *system = &walk->system;
  if (!strut_path_wants_fork(walk, unknowns)) return;
  strut_path_fork *fork = &walk->forks.fork[walk->forks.count];
  *fork =
      (strut_path_fork){.y = strut_arena_copy(&system->arena, unknowns, 1, strut_path_bytes(walk)),
                        .rays = *rays,
                        .pulling = strut_arena_copy(&system->arena, system->latest.pulling,
                                                    (size_t)system->model->members.count, 1),
                        .contact = strut_arena_copy(&system->arena, system->contacts.contact,
                                                    (size_t)system->model->contacts.count,
                                                    sizeof *system->contacts.contact),
                        .element = strut_arena_copy(&system->arena, system->elements.element,
                                                    (size_t)system->model->elements.count,
                                                    sizeof *system->elements.element),
                        .factor = strut_path_value(system, unknowns),
                        .arc = walk->arc + strut_path_distance(walk, walk->y, unknowns),
                        .path = walk->forks.path,
                        .depth = walk->forks.depth};
  walk->failed = walk->failed || !fork->y || !fork->pulling || !fork->contact || !fork->element;
  for (int32_t k = 0; k < rays->count; k++)
    fork->rays.ray[k].done =
        fork->rays.ray[k].own < 0 || &rays->ray[k] == way || (!way && fork->rays.ray[k].own > 0);
  walk->forks.count += !walk->failed;
}

bool strut_path_is_switched(strut_path_walk *walk, const double *unknowns) {
  strut_path_system *system = &walk->system;
  for (int32_t k = 0; k < strut_path_switch_count(system); k++) {
    double value = strut_path_switch_value(system, k, unknowns);
    if (!isfinite(value) || fabs(value) <= STRUT_PATH_EVEN * system->size) continue;
    if ((value > 0) != strut_path_switch_is_on(system, k)) return true;
  }
  return false;
}

/* The first two points of a branch, the bifurcation and one off it; false: none is found. */
static bool leave_fork(strut_path_walk *walk, const strut_path_fork *fork,
                       const strut_path_ray *ray) {
  strut_path_system *system = &walk->system;
  memcpy(system->latest.pulling, fork->pulling, (size_t)system->model->members.count);
  size_t contacts = (size_t)system->model->contacts.count,
         elements = (size_t)system->model->elements.count;
  if (contacts) memcpy(system->contacts.contact, fork->contact, contacts * sizeof *fork->contact);
  if (elements) memcpy(system->elements.element, fork->element, elements * sizeof *fork->element);
  memcpy(walk->y, fork->y, strut_path_bytes(walk));
  strut_path_forget_directions(system);
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

/* The way by which a walk has come to a bifurcation need not be walked again. False: there is none within `most`. */
static bool mark_arrival(const strut_path_walk *walk, strut_path_fork *fork, const double *from,
                         double most) {
  double distance = strut_path_distance(walk, from, fork->y);
  strut_path_ray *own = NULL;
  for (int32_t k = 0; k < fork->rays.count && distance > 0; k++) {
    double along = 0;
    for (int32_t i = 0; i <= walk->system.n; i++)
      along += fork->rays.ray[k].direction[i] * (from[i] - fork->y[i]) / distance;
    if (along > most) most = along, own = &fork->rays.ray[k];
  }
  if (own) own->done = true;
  return own != NULL;
}

/* Distance of a bifurcation to a step of the walk, a cubic from `from` with its tangent to w->y. */
static double passing_distance(const strut_path_walk *walk, const double *from,
                               const double *tangent, const double *unknowns) {
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

static void remark_joined(strut_path_walk *walk, const strut_path_fork *fork) {
  strut_path *path = walk->path;
  char joined[40] = "the path", at[STRUT_PATH_TEXT];
  memcpy(walk->y, fork->y, strut_path_bytes(walk));
  strut_path_add_point(walk, path->points[path->point_count - 1].negative);
  path->end = STRUT_PATH_JOINED;
  if (fork->path) snprintf(joined, sizeof joined, "branch %d", (int)fork->path);
  snprintf(path->remark, sizeof path->remark, "joins %s at the bifurcation at %s", joined,
           strut_path_at(walk, fork->factor, at));
}

/* Can the branch end at this bifurcation? It begins at `origin`. */
static bool may_join(const strut_path_walk *walk, const strut_path_fork *fork,
                     const strut_path_fork *origin) {
  return fork->path != walk->forks.path && (fork != origin || walk->path->point_count >= 5);
}

/* Ends the branch at a bifurcation that its next step would pass: there it has been walked, too. */
static bool reach_fork(strut_path_walk *walk, const strut_path_fork *origin) {
  for (size_t k = 0; k < walk->forks.count; k++) {
    strut_path_fork *fork = &walk->forks.fork[k];
    double distance = strut_path_distance(walk, fork->y, walk->y), ahead = 0;
    if (!may_join(walk, fork, origin) || !(distance > 0) ||
        distance > fmax(1.2 * walk->step, 2.0 * fork->rays.radius))
      continue;
    for (int32_t i = 0; i <= walk->system.n; i++)
      ahead += walk->tangent[i] * (fork->y[i] - walk->y[i]) / distance;
    if (ahead < AHEAD || !mark_arrival(walk, fork, walk->y, AHEAD)) continue;
    walk->arc += distance;
    remark_joined(walk, fork);
    return true;
  }
  return false;
}

/* The same of one that its last step has passed. */
static bool join_fork(strut_path_walk *walk, const strut_path_fork *origin, const double *from,
                      const double *tangent) {
  strut_path *path = walk->path;
  for (size_t k = 0; k < walk->forks.count; k++) {
    strut_path_fork *fork = &walk->forks.fork[k];
    if (!may_join(walk, fork, origin)) continue;
    if (passing_distance(walk, from, tangent, fork->y) > PASSING + 1.0 / PLACES) continue;
    mark_arrival(walk, fork, from, ARRIVING);
    walk->arc =
        path->points[path->point_count - 2].at.arc + strut_path_distance(walk, from, fork->y);
    path->point_count--;
    while (path->event_count > 0 && path->events[path->event_count - 1].at.arc > walk->arc)
      path->event_count--;
    remark_joined(walk, fork);
    return true;
  }
  return false;
}

/* Steps along a branch from its second point. */
static void walk_branch(strut_path_walk *walk, const strut_path_fork *origin,
                        const strut_experiment *experiment) {
  const strut_path_options *options = walk->system.parameter.options;
  int32_t steps = options->steps > 0 ? options->steps : STRUT_PATH_USUAL_STEPS;
  double *from = strut_allocate(1, strut_path_bytes(walk)),
         *tangent = strut_allocate(1, strut_path_bytes(walk));
  walk->failed = walk->failed || !from || !tangent;
  walk->path->end = STRUT_PATH_STEPS;
  for (int32_t i = 0; i < steps && !walk->failed && !strut_experiment_interrupted(experiment);
       i++) {
    memcpy(from, walk->y, strut_path_bytes(walk));
    memcpy(tangent, walk->tangent, ((size_t)walk->system.n + 1) * sizeof *tangent);
    if (reach_fork(walk, origin)) break;
    bool on = strut_path_walk_step(walk);
    if (walk->failed || join_fork(walk, origin, from, tangent) || !on) break;
  }
  strut_path_remark_steps(walk, steps);
  strut_release(from);
  strut_release(tangent);
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
  double range = fabs(walk->system.parameter.range);
  double moved = change_along(first, walk->system.model->length);
  if (first->event_count != second->event_count || first->end != second->end ||
      point->negative != t->negative || fabs(point->at.factor - t->at.factor) > ALIKE * range ||
      fabs(point->at.arc - t->at.arc) > NEARLY * point->at.arc ||
      fabs(moved - change_along(second, walk->system.model->length)) > ALIKE * moved)
    return false;
  for (size_t k = 0; k < first->event_count; k++)
    if (fabs(first->events[k].at.factor - second->events[k].at.factor) > ALIKE * range ||
        first->events[k].kind != second->events[k].kind ||
        first->events[k].after != second->events[k].after)
      return false;
  return true;
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
