/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which load, from which equilibrium, and the walk from there. See path.h. */
#include "engine/statics/path/path.h"

#include <stdio.h>
#include <string.h>

#include "engine/statics/minimise.h"
#include "engine/statics/path/walk.h"

enum { DEFAULT_STEPS = 400, NAMES = 400 };

/* Of the rounding in forces: what a descent may leave, as the path is corrected further anyway. */
static const double NEARLY = 1e6;

const char *strut_path_event_name(strut_path_event_kind kind) {
  static const char *const names[] = {"limit point", "bifurcation", "slack",
                                      "taut",        "touchdown",   "lift-off"};
  return names[kind];
}

static strut_status no_such_load(const strut_scene *scene, const char *name, strut_error *error) {
  char list[NAMES] = "";
  size_t used = 0;
  for (size_t i = 0; i < scene->load_count; i++) {
    size_t length = strlen(scene->loads[i].name);
    if (used + length + 3 > sizeof list) break;
    if (used) memcpy(list + used, ", ", 2), used += 2;
    memcpy(list + used, scene->loads[i].name, length);
    used += length;
    list[used] = '\0';
  }
  return strut_fail(error, STRUT_USAGE, "there is no load '%s'; the scene's loads are: %s", name,
                    list);
}

/* Adds the loads that the factor multiplies to `load` and takes them, where constant, off `base`. */
static strut_status choose_loads(const strut_scene *scene, const char *name, double *base,
                                 double *load, strut_error *error) {
  bool found = false, acts = false;
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *l = &scene->loads[i];
    if (name ? strcmp(l->name, name) != 0 : l->signal >= 0) continue;
    found = true;
    for (int c = 0; c < 2; c++) {
      int32_t at = 2 * l->node + c;
      load[at] += l->force[c];
      if (l->signal < 0) base[at] -= l->force[c];
      acts = acts || (load[at] != 0 && !scene->nodes[l->node].fixed[c]);
    }
  }
  if (found && acts) return STRUT_OK;
  if (name && scene->load_count && !found) return no_such_load(scene, name, error);
  if (!found)
    return strut_fail(error, STRUT_USAGE,
                      "the scene has no constant load to follow; give it one under 'loads'");
  return strut_fail(error, STRUT_USAGE,
                    "the load%s%s acts on nothing that can move; there is no path to follow",
                    name ? " " : "", name ? name : "");
}

/* The equilibrium without the load that the start comes to rest in: q. */
static strut_status begin_at(const strut_model *model, const double *base, double *q,
                             strut_error *error) {
  strut_potential *potential = NULL;
  strut_minimiser *minimiser = NULL;
  strut_status status = strut_potential_create(model, NULL, true, &potential, error);
  if (status == STRUT_OK) {
    memcpy(potential->force, base, (size_t)model->length * sizeof *base);
    status = strut_minimiser_create(potential, &minimiser, error);
  }
  if (status == STRUT_OK) {
    strut_descent descent = strut_minimise(minimiser, q, 0.0);
    if (descent.end == STRUT_DESCENT_RUNAWAY)
      status = strut_fail(error, STRUT_NOT_SETTLED,
                          "without the load there is no equilibrium to begin at: nothing holds the "
                          "structure; support it or give it a ground");
    else if (descent.end == STRUT_DESCENT_EXHAUSTED && descent.residual > NEARLY * descent.rounding)
      status = strut_fail(error, STRUT_NOT_SETTLED,
                          "without the load no equilibrium was found to begin at: %.3g N are left",
                          descent.residual);
  }
  strut_minimiser_free(minimiser);
  strut_potential_free(potential);
  return status;
}

static bool make_walk(strut_path_walk *w) {
  size_t count = (size_t)w->system.n + 1;
  double **arrays[] = {&w->y,     &w->tangent, &w->next,  &w->next_tangent,
                       &w->trial, &w->spare,   &w->upward};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
    *arrays[i] = strut_arena_allocate(&w->system.arena, count, sizeof(double));
    if (!*arrays[i]) return false;
  }
  w->upward[w->system.n] = 1.0;
  w->step = 0.01;
  return true;
}

static strut_status walk_from(const strut_model *model, const double *base, const double *load,
                              const double *q, double until, int32_t steps, strut_path *path,
                              strut_error *error) {
  strut_path_walk w = {.path = path};
  strut_status status = strut_path_system_create(model, base, load, until, &w.system, error);
  if (status == STRUT_OK && w.system.n > STRUT_PATH_COORDINATES)
    status = strut_fail(error, STRUT_USAGE,
                        "the structure has %d free coordinates; paths are followed with up to %d",
                        (int)w.system.n, STRUT_PATH_COORDINATES);
  if (status == STRUT_OK && !make_walk(&w))
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (status == STRUT_OK) {
    strut_path_unplace(&w.system, q, w.y);
    path->end = STRUT_PATH_STEPS;
    bool on = strut_path_walk_begin(&w);
    for (int32_t i = 0; i < steps && on; i++) on = strut_path_walk_step(&w);
    if (w.system.drifts && path->point_count == 0)
      status = strut_fail(error, STRUT_NOT_SETTLED,
                          "nothing holds the structure against the load: it moves as a whole");
    if (w.failed) status = strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  }
  if (status == STRUT_OK && path->point_count == 0)
    status = strut_fail(error, STRUT_NOT_SETTLED,
                        "the structure has no stiffness against the load at the start, so that no "
                        "path begins there");
  strut_path_system_free(&w.system);
  return status;
}

strut_status strut_path_follow(const strut_model *model, const strut_path_options *options,
                               strut_path *path, strut_error *error) {
  size_t length = (size_t)model->length;
  double until = options->until != 0 ? options->until : 1.0;
  int32_t steps = options->steps > 0 ? options->steps : DEFAULT_STEPS;
  *path = (strut_path){.load = options->load};
  strut_arena scratch = {0};
  double *base = strut_arena_allocate(&scratch, length, sizeof *base);
  double *load = strut_arena_allocate(&scratch, length, sizeof *load);
  double *q = strut_arena_allocate(&scratch, length, sizeof *q);
  strut_status status = base && load && q ? STRUT_OK : STRUT_NO_MEMORY;
  if (status) strut_fail(error, status, "out of memory");
  if (status == STRUT_OK) {
    if (model->constant_force) memcpy(base, model->constant_force, length * sizeof *base);
    memcpy(q, model->start, length * sizeof *q);
    status = choose_loads(model->scene, options->load, base, load, error);
  }
  if (status == STRUT_OK) status = begin_at(model, base, q, error);
  if (status == STRUT_OK) status = walk_from(model, base, load, q, until, steps, path, error);
  if (status == STRUT_OK && path->end == STRUT_PATH_STEPS)
    snprintf(path->remark, sizeof path->remark,
             "%d steps led to the factor %.6g; --steps allows more", (int)steps,
             path->points[path->point_count - 1].factor);
  strut_arena_free(&scratch);
  return status;
}

void strut_path_free(strut_path *path) {
  strut_release(path->points);
  strut_release(path->events);
  strut_arena_free(&path->arena);
  *path = (strut_path){0};
}
