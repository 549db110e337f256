/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/settle.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/elements.h"
#include "engine/forces/energy.h"
#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "engine/model/pose.h"
#include "engine/scene/things.h"

/* Force evaluations after which accelerations explained by rounding count as rest. */
static const int64_t ROUNDING_EVALUATIONS = 1000000;

/*
 * Copies the scene without drives, driven loads, feedback, belt and, unless kept, friction. Shares texts and
 * arrays.
 */
static strut_status copy_passive_scene(const strut_scene *scene, bool friction,
                                       strut_scene *passive, strut_arena *arena) {
  *passive = *scene;
  passive->actuator_count = 0;
  passive->nodes = strut_arena_allocate(arena, scene->node_count, sizeof *passive->nodes);
  if (!passive->nodes) return STRUT_NO_MEMORY;
  memcpy(passive->nodes, scene->nodes, scene->node_count * sizeof *passive->nodes);
  if (!strut_scene_hold_sliding_masses(passive, arena)) return STRUT_NO_MEMORY;
  strut_scene_hold_supports(passive, false);
  strut_scene_stop_unbalances(passive);
  passive->ground.belt_speed = 0.0;
  passive->bar_model = STRUT_BARS_ELASTIC; /* they become rigid in the settled, loaded shape */
  passive->loads = strut_arena_allocate(arena, scene->load_count, sizeof *passive->loads);
  passive->contacts = strut_arena_allocate(arena, scene->contact_count, sizeof *passive->contacts);
  if (!passive->loads || !passive->contacts || !strut_scene_stop_grounds(passive, arena))
    return STRUT_NO_MEMORY;
  passive->load_count = 0;
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal < 0) passive->loads[passive->load_count++] = scene->loads[i];
  for (size_t i = 0; i < scene->contact_count; i++) {
    passive->contacts[i] = scene->contacts[i];
    if (!friction) passive->contacts[i].friction.law = STRUT_FRICTION_NONE;
  }
  if (!strut_scene_remove_feedback(passive, arena)) return STRUT_NO_MEMORY;
  return STRUT_OK;
}

/* The largest absolute entry of x and its node; infinite where x has a NaN. */
static double find_largest(const double *x, int32_t n, int32_t *node) {
  double most = 0.0;
  *node = 0;
  for (int32_t i = 0; i < n; i++) {
    if (!(fabs(x[i]) <= most)) most = fabs(x[i]), *node = i / 2;
    if (isnan(x[i])) return HUGE_VAL;
  }
  return most;
}

/* The last bits of strains and positions, through slope and gradient, as forces on the nodes. */
static void add_element_rounding(const strut_relaxation *r, double *force) {
  const strut_element_table *t = &r->model->elements;
  const double *q = r->state->q;
  strut_element_pose pose;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *e = &t->element[i];
    const uint32_t *at = t->at + e->first;
    strut_element_evaluate(r->model, i, r->state->rest, q, r->state->element_turn[i], &pose);
    double bits = fabs(pose.strain) * DBL_EPSILON;
    for (int32_t k = 0; k < e->nodes; k++)
      bits +=
          hypot(pose.b[2 * k], pose.b[2 * k + 1]) * strut_coordinate_rounding(q + at[k], q + at[k]);
    for (int32_t k = 0; k < e->nodes; k++)
      force[at[k]] += fabs(pose.slope) * bits * hypot(pose.b[2 * k], pose.b[2 * k + 1]);
  }
}

/* The acceleration that rounding of the positions may cause at a node of stiff members. */
static double rounding_acceleration(const strut_relaxation *r) {
  const strut_model *model = r->model;
  const strut_member_table *t = &model->members;
  double worst = 0.0, *force = r->acceleration;
  memset(force, 0, (size_t)model->length * sizeof *force);
  for (int32_t j = 0; j < t->count; j++) {
    const double *a = r->state->q + t->from[j], *b = r->state->q + t->to[j];
    double far = strut_coordinate_rounding(a, b);
    force[t->from[j]] += t->stiffness[j] * far;
    force[t->to[j]] += t->stiffness[j] * far;
  }
  add_element_rounding(r, force);
  for (int32_t i = 0; i < model->node_count; i++)
    if (model->weight[i] > 0.0) worst = fmax(worst, force[2 * i] / model->weight[i]);
  return 4.0 * worst;
}

static strut_status fail_not_settled(const strut_relaxation *r, strut_error *error) {
  const strut_settle *wanted = &r->experiment->settle;
  int32_t fastest, pushed, length = r->model->length;
  double speed = find_largest(r->state->v, length, &fastest);
  strut_forces_acceleration(r->model, r->state, 0.0, r->state->q, r->state->v, r->acceleration);
  double push = find_largest(r->acceleration, length, &pushed);
  bool late = r->time >= wanted->limit, moves = !(speed < wanted->speed);
  bool slides = r->scene.contact_count && !wanted->friction;
  char within[60];
  snprintf(within, sizeof within, late ? "%g s" : "%g evaluations of the forces",
           late ? wanted->limit : (double)r->evaluations);
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the structure did not come to rest within %s: largest speed %.3g m/s, "
                    "largest acceleration %.3g m/s^2, node '%.60s' %s most; give a larger "
                    "initial.settle.%s or looser speed and acceleration%s",
                    within, speed, push, r->scene.nodes[moves ? fastest : pushed].name,
                    moves ? "moving" : "accelerating", late ? "limit" : "evaluations",
                    slides ? ", or let it hold by initial.settle.friction: kept" : "");
}

static strut_status fail_diverged(const strut_relaxation *r, double time, strut_error *error) {
  if (r->state->trouble)
    return strut_fail(error, STRUT_DIVERGED,
                      "%s failed while settling, after %g s; look for a member of zero length",
                      r->method->name, time);
  return strut_fail(error, STRUT_DIVERGED,
                    "settling before the run diverged after %g s with a step of %g s; use a "
                    "smaller initial.settle.step",
                    time, r->step);
}

/* Sets all velocities to zero: at the start and whenever the kinetic energy has passed a peak. */
static void stop_motion(strut_relaxation *r) {
  memset(r->state->v, 0, (size_t)r->model->length * sizeof(double));
  if (r->method->restart) r->method->restart(r->model, r->state, r->workspace, r->step);
}

/* Steps until at rest; adds to r->time and r->evaluations. */
static strut_status relax_until_rest(strut_relaxation *r, strut_error *error) {
  const strut_settle *wanted = &r->experiment->settle;
  strut_state *state = r->state;
  double dt = r->step, previous = 0.0, before = r->time, enough = wanted->acceleration;
  double most = wanted->evaluations > 0.0 ? wanted->evaluations : STRUT_SETTLE_EVALUATIONS;
  int64_t spent = r->evaluations;
  int32_t length = r->model->length, node;
  bool strict = true;
  stop_motion(r);
  while (r->time < wanted->limit && (double)r->evaluations < most) {
    if (r->interrupt && *r->interrupt)
      return strut_fail(error, STRUT_INTERRUPTED, "interrupted while coming to rest");
    r->method->advance(r->model, state, r->workspace, dt, 1);
    r->time = before + (double)state->step * dt;
    r->evaluations = spent + state->evaluations;
    if (state->trouble == STRUT_FAILURE_INTERRUPT) continue;
    double kinetic = strut_energy_kinetic(r->model, state->v);
    if (state->trouble || !isfinite(kinetic)) return fail_diverged(r, r->time - before, error);
    if (kinetic < previous) {
      stop_motion(r);
      kinetic = 0.0;
    }
    previous = kinetic;
    if (strict && r->evaluations > ROUNDING_EVALUATIONS) {
      strict = false;
      enough = fmax(enough, rounding_acceleration(r));
    }
    if (!(find_largest(state->v, length, &node) < wanted->speed)) continue;
    strut_forces_acceleration(r->model, state, 0.0, state->q, state->v, r->acceleration);
    if (find_largest(r->acceleration, length, &node) < enough) return STRUT_OK;
  }
  return fail_not_settled(r, error);
}

strut_status strut_relaxation_run(strut_relaxation *r, strut_error *error) {
  r->state->interrupt = r->interrupt;
  return relax_until_rest(r, error);
}

strut_status strut_relaxation_create(const strut_model *model, const strut_experiment *experiment,
                                     strut_relaxation *r, strut_error *error) {
  const strut_settle *settle = &experiment->settle;
  *r = (strut_relaxation){.experiment = experiment};
  strut_status status = copy_passive_scene(model->scene, settle->friction, &r->scene, &r->arena);
  r->step = settle->step > 0.0 ? settle->step : experiment->step;
  r->acceleration = strut_arena_allocate(&r->arena, (size_t)model->length, sizeof(double));
  if (!r->acceleration) status = STRUT_NO_MEMORY;
  if (status) return strut_fail(error, status, "out of memory");
  status = strut_model_compile(&r->scene, &r->model, error);
  if (!status) status = strut_state_create(r->model, &r->state, error);
  if (status) return status;
  r->state->forgetful = true;
  r->method = strut_integrator_for_settling(r->model);
  const strut_integrator_settings settings = strut_integrator_settings_of(experiment);
  r->workspace = r->method->create(r->model, r->state, &settings);
  return r->workspace ? STRUT_OK : strut_no_memory(error, "");
}

void strut_relaxation_free(strut_relaxation *r) {
  strut_state_free(r->state);
  strut_model_free(r->model);
  strut_arena_free(&r->arena);
  *r = (strut_relaxation){.model = NULL};
}

strut_status strut_settle_state(const strut_model *model, const strut_experiment *experiment,
                                strut_state *state, const volatile sig_atomic_t *interrupt,
                                double *time, strut_error *error) {
  strut_relaxation r;
  size_t bytes = (size_t)model->length * sizeof(double);
  strut_status status = strut_relaxation_create(model, experiment, &r, error);
  r.interrupt = interrupt;
  if (!status) status = strut_relaxation_run(&r, error);
  if (!status) {
    *time = r.time;
    memcpy(state->q, r.state->q, bytes);
    memset(state->v, 0, bytes);
  }
  strut_relaxation_free(&r);
  return status;
}
