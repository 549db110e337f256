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

static bool is_known_fork(const strut_path_walk *w, const double *y) {
  for (size_t k = 0; k < w->forks.count; k++)
    if (w->forks.fork[k].path != w->forks.path &&
        strut_path_distance(w, w->forks.fork[k].y, y) < SAME_FORK)
      return true;
  return false;
}

bool strut_path_wants_fork(strut_path_walk *w, const double *y) {
  if (!w->forks.fork || w->forks.depth >= w->system.parameter.options->branches ||
      is_known_fork(w, y))
    return false;
  for (size_t k = 0; k < w->forks.count; k++) /* its sphere has all that leaves this one, too */
    if (strut_path_distance(w, w->forks.fork[k].y, y) < w->forks.fork[k].rays.radius) return false;
  if (w->forks.count < STRUT_PATH_FORKS) return true;
  w->forks.left++;
  return false;
}

void strut_path_keep_fork(strut_path_walk *w, const double *y, const strut_path_rays *rays,
                          const strut_path_ray *way) {
  strut_path_system *s = &w->system;
  if (!strut_path_wants_fork(w, y)) return;
  strut_path_fork *f = &w->forks.fork[w->forks.count];
  *f = (strut_path_fork){
      .y = strut_arena_copy(&s->arena, y, 1, strut_path_bytes(w)),
      .rays = *rays,
      .pulling = strut_arena_copy(&s->arena, s->latest.pulling, (size_t)s->model->members.count, 1),
      .contact = strut_arena_copy(&s->arena, s->contacts.contact, (size_t)s->model->contacts.count,
                                  sizeof *s->contacts.contact),
      .element = strut_arena_copy(&s->arena, s->elements.element, (size_t)s->model->elements.count,
                                  sizeof *s->elements.element),
      .factor = strut_path_value(s, y),
      .arc = w->arc + strut_path_distance(w, w->y, y),
      .path = w->forks.path,
      .depth = w->forks.depth};
  w->failed = w->failed || !f->y || !f->pulling || !f->contact || !f->element;
  for (int32_t k = 0; k < rays->count; k++)
    f->rays.ray[k].done =
        f->rays.ray[k].own < 0 || &rays->ray[k] == way || (!way && f->rays.ray[k].own > 0);
  w->forks.count += !w->failed;
}

bool strut_path_is_switched(strut_path_walk *w, const double *y) {
  strut_path_system *s = &w->system;
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    double value = strut_path_switch_value(s, k, y);
    if (!isfinite(value) || fabs(value) <= STRUT_PATH_EVEN * s->size) continue;
    if ((value > 0) != strut_path_switch_is_on(s, k)) return true;
  }
  return false;
}

/* The first two points of a branch, the bifurcation and one off it; false: none is found. */
static bool leave_fork(strut_path_walk *w, const strut_path_fork *f, const strut_path_ray *ray) {
  strut_path_system *s = &w->system;
  memcpy(s->latest.pulling, f->pulling, (size_t)s->model->members.count);
  size_t contacts = (size_t)s->model->contacts.count, elements = (size_t)s->model->elements.count;
  if (contacts) memcpy(s->contacts.contact, f->contact, contacts * sizeof *f->contact);
  if (elements) memcpy(s->elements.element, f->element, elements * sizeof *f->element);
  memcpy(w->y, f->y, strut_path_bytes(w));
  strut_path_forget_directions(s);
  if (!strut_path_tangent(s, ray->y, ray->direction, w->tangent)) return false;
  w->negative = ray->negative;
  w->arc = 0.0;
  strut_path_add_point(w, w->negative);
  w->arc = strut_path_distance(w, ray->y, w->y);
  w->step = fmin(USUAL, 2.0 * w->arc);
  memcpy(w->y, ray->y, strut_path_bytes(w));
  strut_path_count_negative(w);
  strut_path_add_point(w, w->negative);
  return !w->failed;
}

/* The way by which a walk has come to a bifurcation need not be walked again. False: there is none within `most`. */
static bool mark_arrival(const strut_path_walk *w, strut_path_fork *f, const double *from,
                         double most) {
  double distance = strut_path_distance(w, from, f->y);
  strut_path_ray *own = NULL;
  for (int32_t k = 0; k < f->rays.count && distance > 0; k++) {
    double along = 0;
    for (int32_t i = 0; i <= w->system.n; i++)
      along += f->rays.ray[k].direction[i] * (from[i] - f->y[i]) / distance;
    if (along > most) most = along, own = &f->rays.ray[k];
  }
  if (own) own->done = true;
  return own != NULL;
}

/* Distance of a bifurcation to a step of the walk, a cubic from `from` with its tangent to w->y. */
static double passing_distance(const strut_path_walk *w, const double *from, const double *tangent,
                               const double *y) {
  double length = strut_path_distance(w, w->y, from), least = HUGE_VAL;
  for (int k = 0; k <= PLACES; k++) {
    double t = (double)k / PLACES, r = 1 - t, square = 0;
    for (int32_t i = 0; i <= w->system.n; i++) {
      double at = r * r * (1 + 2 * t) * from[i] + t * t * (1 + 2 * r) * w->y[i] +
                  length * t * r * (r * tangent[i] - t * w->tangent[i]);
      square += (at - y[i]) * (at - y[i]);
    }
    least = fmin(least, sqrt(square));
  }
  return least / length;
}

static void remark_joined(strut_path_walk *w, const strut_path_fork *f) {
  strut_path *p = w->path;
  char joined[40] = "the path";
  memcpy(w->y, f->y, strut_path_bytes(w));
  strut_path_add_point(w, p->points[p->point_count - 1].negative);
  p->end = STRUT_PATH_JOINED;
  if (f->path) snprintf(joined, sizeof joined, "branch %d", (int)f->path);
  snprintf(p->remark, sizeof p->remark, "joins %s at the bifurcation at %s %.6g%s%s", joined,
           strut_path_subject(w), f->factor, *p->unit ? " " : "", p->unit);
}

/* Can the branch end at this bifurcation? It begins at `origin`. */
static bool may_join(const strut_path_walk *w, const strut_path_fork *f,
                     const strut_path_fork *origin) {
  return f->path != w->forks.path && (f != origin || w->path->point_count >= 5);
}

/* Ends the branch at a bifurcation that its next step would pass: there it has been walked, too. */
static bool reach_fork(strut_path_walk *w, const strut_path_fork *origin) {
  for (size_t k = 0; k < w->forks.count; k++) {
    strut_path_fork *f = &w->forks.fork[k];
    double distance = strut_path_distance(w, f->y, w->y), ahead = 0;
    if (!may_join(w, f, origin) || !(distance > 0) ||
        distance > fmax(1.2 * w->step, 2.0 * f->rays.radius))
      continue;
    for (int32_t i = 0; i <= w->system.n; i++)
      ahead += w->tangent[i] * (f->y[i] - w->y[i]) / distance;
    if (ahead < AHEAD || !mark_arrival(w, f, w->y, AHEAD)) continue;
    w->arc += distance;
    remark_joined(w, f);
    return true;
  }
  return false;
}

/* The same of one that its last step has passed. */
static bool join_fork(strut_path_walk *w, const strut_path_fork *origin, const double *from,
                      const double *tangent) {
  strut_path *p = w->path;
  for (size_t k = 0; k < w->forks.count; k++) {
    strut_path_fork *f = &w->forks.fork[k];
    if (!may_join(w, f, origin)) continue;
    if (passing_distance(w, from, tangent, f->y) > PASSING + 1.0 / PLACES) continue;
    mark_arrival(w, f, from, ARRIVING);
    w->arc = p->points[p->point_count - 2].at.arc + strut_path_distance(w, from, f->y);
    p->point_count--;
    while (p->event_count > 0 && p->events[p->event_count - 1].at.arc > w->arc) p->event_count--;
    remark_joined(w, f);
    return true;
  }
  return false;
}

/* Steps along a branch from its second point. */
static void walk_branch(strut_path_walk *w, const strut_path_fork *origin,
                        const strut_experiment *experiment) {
  const strut_path_options *o = w->system.parameter.options;
  int32_t steps = o->steps > 0 ? o->steps : STRUT_PATH_USUAL_STEPS;
  double *from = strut_allocate(1, strut_path_bytes(w)),
         *tangent = strut_allocate(1, strut_path_bytes(w));
  w->failed = w->failed || !from || !tangent;
  w->path->end = STRUT_PATH_STEPS;
  for (int32_t i = 0; i < steps && !w->failed && !strut_experiment_interrupted(experiment); i++) {
    memcpy(from, w->y, strut_path_bytes(w));
    memcpy(tangent, w->tangent, ((size_t)w->system.n + 1) * sizeof *tangent);
    if (reach_fork(w, origin)) break;
    bool on = strut_path_walk_step(w);
    if (w->failed || join_fork(w, origin, from, tangent) || !on) break;
  }
  strut_path_remark_steps(w, steps);
  strut_release(from);
  strut_release(tangent);
}

/* Square of what the coordinates change by along a path [m^2]. */
static double change_along(const strut_path *p, int32_t length) {
  double sum = 0;
  for (int32_t i = 0; i < length; i++) {
    double change = p->points[p->point_count - 1].at.q[i] - p->points[0].at.q[i];
    sum += change * change;
  }
  return sum;
}

/* Does the parameter do the same on both? Their steps may differ. */
static bool are_twins(const strut_path_walk *w, const strut_path *a, const strut_path *b) {
  const strut_path_point *s = &a->points[a->point_count - 1], *t = &b->points[b->point_count - 1];
  double range = fabs(w->system.parameter.range);
  double moved = change_along(a, w->system.model->length);
  if (a->event_count != b->event_count || a->end != b->end || s->negative != t->negative ||
      fabs(s->at.factor - t->at.factor) > ALIKE * range ||
      fabs(s->at.arc - t->at.arc) > NEARLY * s->at.arc ||
      fabs(moved - change_along(b, w->system.model->length)) > ALIKE * moved)
    return false;
  for (size_t k = 0; k < a->event_count; k++)
    if (fabs(a->events[k].at.factor - b->events[k].at.factor) > ALIKE * range ||
        a->events[k].kind != b->events[k].kind || a->events[k].after != b->events[k].after)
      return false;
  return true;
}

static void add_remark(strut_path *path, const char *what) {
  size_t used = strlen(path->remark);
  snprintf(path->remark + used, sizeof path->remark - used, "%s%s", used ? "; " : "", what);
}

/* The branch of fork k along a ray. */
static void walk_ray(strut_path_walk *w, size_t k, strut_path_ray *ray, strut_path *path,
                     const strut_experiment *experiment) {
  strut_path_fork *f = &w->forks.fork[k];
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
                         .from = {.path = f->path, .factor = f->factor, .arc = f->arc}};
  w->path = branch;
  w->point_room = w->event_room = 0;
  w->forks.path = (int32_t)path->branch_count + 1;
  w->forks.depth = f->depth + 1;
  ray->done = true;
  if (leave_fork(w, f, ray)) {
    path->branch_count++;
    walk_branch(w, f, experiment);
    return;
  }
  strut_path_free(branch);
  w->forks.lost++;
}

/* Of the branches of one fork, from `first` on: two each that resemble one another. */
static void pair_twins(const strut_path_walk *w, strut_path *path, size_t first) {
  for (size_t i = first; i < path->branch_count; i++)
    for (size_t k = i + 1; k < path->branch_count && !path->branches[i].from.twin; k++) {
      strut_path *a = &path->branches[i], *b = &path->branches[k];
      if (b->from.twin || !are_twins(w, a, b)) continue;
      a->from.twin = (int32_t)k + 1, b->from.twin = (int32_t)i + 1;
    }
}

void strut_path_walk_branches(strut_path_walk *w, strut_path *path,
                              const strut_experiment *experiment) {
  for (size_t k = 0; k < w->forks.count && !w->failed; k++) { /* walks add more */
    size_t first = path->branch_count;
    for (int32_t i = 0; i < w->forks.fork[k].rays.count && !w->failed; i++) {
      strut_path_ray *ray = &w->forks.fork[k].rays.ray[i];
      if (ray->done || strut_experiment_interrupted(experiment)) continue;
      if (path->branch_count == STRUT_PATH_BRANCHES)
        w->forks.left++;
      else
        walk_ray(w, k, ray, path, experiment);
    }
    pair_twins(w, path, first);
  }
  w->path = path;
  if (w->forks.lost) add_remark(path, "some branches were lost where they begin");
  if (w->forks.left) add_remark(path, "there are more branches than are followed");
}
