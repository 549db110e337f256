/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Branches: the paths that leave others at bifurcations, each along the null vector found there. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/statics/path/path_parts.h"

enum { SHORTER = 6, PLACES = 64 };

static const double LEAVING = 2e-3; /* first step off a bifurcation [units of y], and usual ones */
static const double USUAL = 0.01;
static const double SAME_FORK = 1e-4; /* two bifurcations so near are one [units of y] */
static const double PASSING = 0.02;   /* of a step: a branch so near a bifurcation passes it */
static const double ALIKE = 1e-6;     /* of the range: values of the parameter on twins */

void strut_path_keep_fork(strut_path_walk *w, const double *y, const gsl_vector *null) {
  strut_path_system *s = &w->system;
  double along = 0, square = 0;
  if (!w->forks.fork || w->forks.depth >= s->parameter.options->branches) return;
  for (size_t k = 0; k < w->forks.count; k++)
    if (w->forks.fork[k].path != w->forks.path &&
        strut_path_distance(w, w->forks.fork[k].y, y) < SAME_FORK)
      return;
  if (w->forks.count == STRUT_PATH_BRANCHES / 2) {
    w->forks.left++;
    return;
  }
  strut_path_fork *f = &w->forks.fork[w->forks.count];
  *f = (strut_path_fork){
      .y = strut_arena_copy(&s->arena, y, 1, strut_path_bytes(w)),
      .direction = strut_arena_allocate(&s->arena, (size_t)s->n + 1, sizeof(double)),
      .pulling = strut_arena_copy(&s->arena, s->latest.pulling, (size_t)s->model->members.count, 1),
      .contact = strut_arena_copy(&s->arena, s->contacts.contact, (size_t)s->model->contacts.count,
                                  sizeof *s->contacts.contact),
      .element = strut_arena_copy(&s->arena, s->elements.element, (size_t)s->model->elements.count,
                                  sizeof *s->elements.element),
      .factor = strut_path_value(s, y),
      .arc = w->arc + strut_path_distance(w, w->y, y),
      .path = w->forks.path,
      .depth = w->forks.depth};
  w->failed = w->failed || !f->y || !f->direction || !f->pulling || !f->contact || !f->element;
  if (w->failed) return;
  /* normal to the path: what is left of the null vector leads off it */
  for (int32_t i = 0; i < s->n; i++) f->direction[i] = gsl_vector_get(null, (size_t)i);
  f->direction[s->n] = 0.0;
  along = strut_path_dot(w, f->direction, w->tangent);
  for (int32_t i = 0; i <= s->n; i++) {
    f->direction[i] -= along * w->tangent[i];
    square += f->direction[i] * f->direction[i];
  }
  for (int32_t i = 0; i <= s->n; i++) f->direction[i] /= sqrt(square);
  w->forks.count++;
}

/* Has an element, a cable or a contact to change before the point? */
static bool is_switched(strut_path_walk *w, const double *y) {
  strut_path_system *s = &w->system;
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    double value = strut_path_switch_value(s, k, y);
    if (!isfinite(value) || fabs(value) <= STRUT_PATH_EVEN * s->size) continue;
    if ((value > 0) != strut_path_switch_is_on(s, k)) return true;
  }
  return false;
}

/* The first two points of a branch, the bifurcation and one off it; false: none is found. */
static bool leave_fork(strut_path_walk *w, const strut_path_fork *f, double side) {
  strut_path_system *s = &w->system;
  double step = LEAVING;
  bool found = false;
  memcpy(s->latest.pulling, f->pulling, (size_t)s->model->members.count);
  size_t contacts = (size_t)s->model->contacts.count, elements = (size_t)s->model->elements.count;
  if (contacts) memcpy(s->contacts.contact, f->contact, contacts * sizeof *f->contact);
  if (elements) memcpy(s->elements.element, f->element, elements * sizeof *f->element);
  memcpy(w->y, f->y, strut_path_bytes(w));
  for (int32_t i = 0; i <= s->n; i++) w->tangent[i] = side * f->direction[i];
  for (int k = 0; k < SHORTER && !found; k++, step *= 0.25) {
    memcpy(w->next, w->y, strut_path_bytes(w));
    for (int32_t i = 0; i <= s->n; i++) w->next[i] += step * w->tangent[i];
    double value = strut_path_dot(w, w->tangent, w->y) + step;
    found = strut_path_correct(s, w->tangent, value, w->next) >= 0 &&
            strut_path_distance(w, w->next, w->y) < 2 * step &&
            strut_path_tangent(s, w->next, w->tangent, w->next_tangent) &&
            !is_switched(w, w->next) && strut_path_spectrum(s, w->next, STRUT_PATH_SIGNS);
  }
  if (!found) return false;
  w->negative = s->spectrum.negative;
  w->arc = 0.0;
  w->step = USUAL;
  strut_path_add_point(w, w->negative);
  w->arc = strut_path_distance(w, w->next, w->y);
  memcpy(w->y, w->next, strut_path_bytes(w));
  memcpy(w->tangent, w->next_tangent, ((size_t)s->n + 1) * sizeof *w->tangent);
  strut_path_add_point(w, w->negative);
  return !w->failed;
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

/* Ends the branch at a bifurcation that its last step passed; there it has been walked, too. */
static bool join_fork(strut_path_walk *w, const strut_path_fork *origin, const double *from,
                      const double *tangent) {
  strut_path *p = w->path;
  for (size_t k = 0; k < w->forks.count; k++) {
    strut_path_fork *f = &w->forks.fork[k];
    if (f == origin && p->point_count < 5) continue; /* it begins there */
    if (f->path == w->forks.path) continue;          /* a bifurcation of its own */
    if (passing_distance(w, from, tangent, f->y) > PASSING + 1.0 / PLACES) continue;
    double side = 0;
    for (int32_t i = 0; i <= w->system.n; i++) side += f->direction[i] * (from[i] - f->y[i]);
    f->done[side > 0] = true;
    w->arc = p->points[p->point_count - 2].arc + strut_path_distance(w, from, f->y);
    p->point_count--;
    while (p->event_count > 0 && p->events[p->event_count - 1].arc > w->arc) p->event_count--;
    memcpy(w->y, f->y, strut_path_bytes(w));
    strut_path_add_point(w, p->points[p->point_count - 1].negative);
    p->end = STRUT_PATH_JOINED;
    char joined[40] = "the path";
    if (f->path) snprintf(joined, sizeof joined, "branch %d", (int)f->path);
    snprintf(p->remark, sizeof p->remark, "joins %s at the bifurcation at %s %.6g%s%s", joined,
             strut_path_subject(w), f->factor, *p->unit ? " " : "", p->unit);
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
    bool on = strut_path_walk_step(w);
    if (w->failed || join_fork(w, origin, from, tangent) || !on) break;
  }
  strut_path_remark_steps(w, steps);
  strut_release(from);
  strut_release(tangent);
}

/* Does the parameter do the same on both? */
static bool are_twins(const strut_path *a, const strut_path *b, double range) {
  if (a->point_count != b->point_count || a->event_count != b->event_count || a->end != b->end)
    return false;
  for (size_t k = 0; k < a->point_count; k++)
    if (fabs(a->points[k].factor - b->points[k].factor) > ALIKE * fabs(range) ||
        a->points[k].negative != b->points[k].negative)
      return false;
  return true;
}

static void add_remark(strut_path *path, const char *what) {
  size_t used = strlen(path->remark);
  snprintf(path->remark + used, sizeof path->remark - used, "%s%s", used ? "; " : "", what);
}

/* The branch of fork k to one side. */
static void walk_side(strut_path_walk *w, size_t k, int side, strut_path *path,
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
  f->done[side] = true;
  if (leave_fork(w, f, side ? 1.0 : -1.0)) {
    path->branch_count++;
    walk_branch(w, f, experiment);
    return;
  }
  char what[200];
  snprintf(what, sizeof what, "no path was found on one side of the bifurcation at %s %.6g%s%s",
           strut_path_subject(w), f->factor, *path->unit ? " " : "", path->unit);
  strut_path_free(branch);
  add_remark(path, what);
}

void strut_path_walk_branches(strut_path_walk *w, strut_path *path,
                              const strut_experiment *experiment) {
  double range = w->system.parameter.range;
  for (size_t k = 0; k < w->forks.count && !w->failed; k++) { /* walks add more */
    size_t first = path->branch_count;
    for (int side = 1; side >= 0 && !w->failed; side--)
      if (!w->forks.fork[k].done[side] && !strut_experiment_interrupted(experiment))
        walk_side(w, k, side, path, experiment);
    strut_path *a = &path->branches[first], *b = a + 1;
    if (path->branch_count == first + 2 && are_twins(a, b, range))
      a->from.twin = (int32_t)first + 2, b->from.twin = (int32_t)first + 1;
  }
  w->path = path;
  if (w->forks.left) add_remark(path, "there are more bifurcations than are left for branches");
}
