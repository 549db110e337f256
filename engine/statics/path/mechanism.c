/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Motions without stiffness that the parameter works on: among slack cables, or a straight string that is pulled
 * aside. There the equilibria of one value of the parameter are a family, no tangent leads on, and eigenvalues have
 * no sign but that of rounding. A small change of the parameter decides where in the family the structure
 * comes to rest: a descent finds it, and the path continues there.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/path/path_parts.h"

static const double LEAPS[] = {1e-6, 1e-5, 1e-4, 1e-3}; /* of the range: such changes */
static const double STEADY = 1e-2;   /* of the largest force: what a leap may change */
static const double ROUNDED = 1e-12; /* of stiffness times size: a force of rounding */
static const double RATE = 1e-9;     /* of the parameter: none */
static const double NEARBY = 1e-3;  /* [units of y] between where a descent and the equations end */
static const double NOTABLE = 1e-2; /* of the range: a part of the path that is noted */
enum { MOST_LEAPS = 2 };            /* within such a part */

/* Do the forces at the latest place differ from those before by rounding and the small leap alone? */
static bool are_forces_steady(const strut_path_system *system, const double *before) {
  double most = ROUNDED * strut_stiffest(system->model) * system->size, change = 0.0;
  for (int32_t i = 0; i < system->n; i++) most = fmax(most, fabs(system->latest.slope[i]));
  for (int32_t i = 0; i < strut_force_count(system->model, true); i++) {
    double force = system->force[i].pose.acts ? system->force[i].pose.force : 0.0;
    most = fmax(most, fmax(fabs(force), fabs(before[i])));
    change = fmax(change, fabs(force - before[i]));
  }
  return change <= STEADY * most;
}

/* Puts walk->y to where the structure rests with the parameter by `leap` further; false: there is no such place. */
static bool leap_to(strut_path_walk *walk, const double *from, double leap, const double *before) {
  strut_path_system *system = &walk->system;
  double at = from[system->n], value = at + fmin(leap, 0.5 * fabs(1.0 - at));
  memcpy(walk->y, from, strut_path_bytes(walk));
  walk->y[system->n] = value, walk->y[2 * system->n + 1] = 0.0;
  if (!strut_path_evaluate(system, walk->y)) return false;
  memcpy(walk->settled, system->latest.q, (size_t)system->model->length * sizeof *walk->settled);
  double there = system->parameter.from + value * system->parameter.range;
  if (!walk->settle(walk->settler, there, walk->settled)) return false;
  strut_path_unplace(system, walk->settled, walk->y);
  walk->y[system->n] = value;
  if (!strut_path_set_out(walk, NEARBY) || !(walk->tangent[system->n] > RATE)) return false;
  for (int32_t i = 0; i <= system->n && leap < 0.0; i++) walk->tangent[i] *= -1.0;
  return strut_path_evaluate(system, walk->y) && are_forces_steady(system, before);
}

/* Continues the path where it has leapt to; it came from `here`. */
static void go_on_from_leap(strut_path_walk *walk, const double *here, const double *from,
                            int32_t node, int32_t count) {
  char detail[300], at[STRUT_PATH_TEXT];
  size_t bytes = strut_path_bytes(walk);
  strut_path_at(walk, strut_path_value(&walk->system, walk->y), at);
  memcpy(walk->next, walk->y, bytes);
  memcpy(walk->y, from, bytes);
  walk->arc += strut_path_distance(walk, here, from);
  if (!walk->path->point_count) strut_path_add_point(walk, 0);
  snprintf(detail, sizeof detail,
           "%d motion%s without stiffness here, %s moves most in one; the path goes on at %s",
           (int)count, count == 1 ? "" : "s", walk->system.model->scene->nodes[node].name, at);
  strut_path_add_event(walk, STRUT_PATH_MECHANISM, walk->y, node, 0, 0, detail);
  walk->arc += strut_path_distance(walk, walk->next, walk->y);
  memcpy(walk->y, walk->next, bytes);
  strut_path_count_negative(walk);
  walk->step = NEARBY;
  strut_path_add_point(walk, walk->negative);
}

/* Would a leap lead back to where the path comes from, or did several not lead on? */
static bool is_futile(const strut_path_walk *walk, const double *unknowns, double sense) {
  const strut_path_system *system = &walk->system;
  const strut_path *path = walk->path;
  double range = system->parameter.range, here = strut_path_value(system, unknowns), came = 0.0;
  int near = 0;
  for (size_t k = path->point_count; k-- > 0 && came == 0.0;)
    came = (here - path->points[k].at.factor) / range;
  for (size_t k = 0; k < path->event_count; k++)
    near += path->events[k].kind == STRUT_PATH_MECHANISM &&
            fabs(path->events[k].at.factor - here) < NOTABLE * fabs(range);
  return near >= MOST_LEAPS || sense * came < 0.0;
}

bool strut_path_leave_mechanism(strut_path_walk *walk, const double *unknowns, double sense) {
  strut_path_system *system = &walk->system;
  int32_t first = 0, count = 0, forces = strut_force_count(system->model, true);
  if (walk->settle && !system->parameter.options->friction && !is_futile(walk, unknowns, sense))
    count = strut_path_find_mechanisms(system, unknowns, &first);
  if (!count) return false;
  int32_t node = strut_path_most_moved(system, strut_path_mode(system, first));
  strut_arena arena = {0};
  strut_path_frozen here;
  double *from = strut_arena_copy(&arena, unknowns, 1, strut_path_bytes(walk)),
         *before = strut_arena_allocate(&arena, (size_t)forces + 1, sizeof *before);
  bool found = false;
  walk->failed = walk->failed || !from || !before || !strut_path_freeze(walk, &arena, &here);
  for (int32_t i = 0; i < forces && !walk->failed; i++)
    before[i] = system->force[i].pose.acts ? system->force[i].pose.force : 0.0;
  for (size_t k = 0; k < sizeof LEAPS / sizeof *LEAPS && !found && !walk->failed; k++) {
    found = leap_to(walk, from, sense < 0 ? -LEAPS[k] : LEAPS[k], before);
    if (!found) strut_path_thaw(walk, &here);
  }
  if (found) go_on_from_leap(walk, here.y, from, node, count);
  strut_arena_free(&arena);
  return found && !walk->failed;
}

/* Is no member tense beyond rounding at both points, or is nothing changed between them but the parameter? */
static bool is_idle(const strut_model *model, const strut_path_state *a, const strut_path_state *b,
                    bool slack, double rounding) {
  for (int32_t j = 0; j < model->members.count; j++)
    if (slack ? fabs(a->force[j]) + fabs(b->force[j]) > 0.0
              : fabs(a->force[j] - b->force[j]) > rounding * fabs(a->force[j]))
      return false;
  for (int32_t i = 0; i < model->length && !slack; i++)
    if (fabs(a->q[i] - b->q[i]) > rounding * model->size) return false;
  return a->factor != b->factor;
}

void strut_path_remark_idle(const strut_path_walk *walk) {
  strut_path *path = walk->path;
  const strut_model *model = walk->system.model;
  double range = fabs(walk->system.parameter.range);
  for (int slack = 1; slack >= 0; slack--)
    for (size_t k = 0, end; k + 1 < path->point_count; k = end + (end == k)) {
      char from[STRUT_PATH_TEXT], to[STRUT_PATH_TEXT];
      for (end = k; end + 1 < path->point_count; end++)
        if (!is_idle(model, &path->points[end].at, &path->points[end + 1].at, slack, 1e-12)) break;
      const strut_path_state *a = &path->points[k].at, *b = &path->points[end].at;
      if (!(fabs(a->factor - b->factor) > NOTABLE * range)) continue;
      size_t used = strlen(path->remark);
      snprintf(path->remark + used, sizeof path->remark - used, "%s%s from %s to %s",
               used ? "; " : "",
               slack ? "no member carries a force" : "the parameter changes nothing",
               strut_path_at(walk, a->factor, from), strut_path_at(walk, b->factor, to));
    }
}
