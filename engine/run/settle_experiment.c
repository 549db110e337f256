/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settled start of an experiment: its step, unstable equilibria, and who else wants it. */
#include <math.h>
#include <string.h>

#include "engine/integrate/integrator.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/run/settle.h"

/* Of the largest stable step, where the scene gives none. Halvings of one that diverges. */
static const double OF_LIMIT = 0.5;
enum { HALVINGS = 6, MOST_PERTURBATIONS = 8 };
/* How far the node that moves most is pushed, in model sizes. */
static const double PUSH = 1e-4;

static strut_status choose_step(strut_relaxation *r, strut_step_limits *limits,
                                strut_error *error) {
  const strut_settle *settle = &r->experiment->settle;
  double given = settle->step == 0.0 ? r->experiment->step : settle->step, limit = 0.0;
  if (!r->model->mass)
    return strut_fail(error, STRUT_SINGULAR, "some node that can move has no mass");
  strut_status status = limits ? strut_step_limit_cached(r->model, r->method, limits, &limit, error)
                               : strut_step_limit_for_method(r->model, r->method, &limit, error);
  if (status) return status;
  if (given > 0.0 && given <= limit)
    r->step = given;
  else
    r->step = isfinite(limit) ? OF_LIMIT * limit : 1e-4 * settle->limit;
  return STRUT_OK;
}

/* From `from` (length), with a smaller step where it diverges. */
static strut_status relax_from(strut_relaxation *r, const double *from, strut_error *error) {
  strut_status status = STRUT_DIVERGED;
  for (int i = 0; i <= HALVINGS && status == STRUT_DIVERGED; i++) {
    if (i > 0) r->step *= 0.5;
    strut_state_reset(r->model, r->state);
    memcpy(r->state->q, from, (size_t)r->model->length * sizeof *from);
    status = strut_relaxation_run(r, error);
  }
  return status;
}

static void push_off(const strut_relaxation *r, const strut_instability *unstable, double *q) {
  for (int32_t i = 0; i < 2 * r->model->node_count; i++)
    q[i] = r->state->q[i] + PUSH * r->model->size * unstable->direction[i];
}

/* Settles, and leaves unstable equilibria where that is wanted. q (length): from where, and to. */
static strut_status settle(strut_relaxation *r, double *q, strut_settle_summary *how,
                           strut_error *error) {
  strut_instability unstable;
  for (;;) {
    strut_status status = relax_from(r, q, error);
    if (!status)
      status = strut_find_instability(r->model, r->experiment->settle.acceleration, r->state->q,
                                      &r->arena, &unstable, error);
    if (status) return status;
    if (unstable.node < 0 || !r->experiment->settle.perturb ||
        how->perturbations == MOST_PERTURBATIONS)
      break;
    push_off(r, &unstable, q);
    how->perturbations++;
  }
  memcpy(q, r->state->q, (size_t)r->model->length * sizeof *q);
  how->step = r->step;
  how->evaluations = r->evaluations;
  how->unstable = unstable.node >= 0;
  if (!how->unstable) return STRUT_OK;
  how->stiffness = unstable.stiffness;
  how->growth_rate = unstable.growth_rate;
  how->node = r->scene.nodes[unstable.node].name;
  return STRUT_OK;
}

strut_status strut_settle_experiment(const strut_model *model, const strut_experiment *experiment,
                                     strut_step_limits *limits,
                                     const volatile sig_atomic_t *interrupt, double *q,
                                     double *time, strut_settle_summary *how, strut_error *error) {
  strut_relaxation r;
  strut_status status = strut_relaxation_create(model, experiment, &r, error);
  *how = (strut_settle_summary){0};
  r.interrupt = interrupt;
  memcpy(q, model->start, (size_t)model->length * sizeof *q);
  if (!status) status = choose_step(&r, limits, error);
  if (!status) status = settle(&r, q, how, error);
  *time = r.time;
  strut_relaxation_free(&r);
  return status;
}

/* The scene of the model, its nodes starting at rest in the positions q (length). */
static strut_status move_start(const strut_scene *scene, const double *q,
                               strut_settled_start *start) {
  strut_scene *settled = start->scene = strut_arena_allocate(&start->arena, 1, sizeof *settled);
  if (!settled) return STRUT_NO_MEMORY;
  *settled = *scene;
  settled->nodes = strut_arena_allocate(&start->arena, scene->node_count, sizeof *settled->nodes);
  if (!settled->nodes) return STRUT_NO_MEMORY;
  memcpy(settled->nodes, scene->nodes, scene->node_count * sizeof *settled->nodes);
  for (size_t i = 0; i < scene->node_count; i++)
    for (size_t c = 0; c < 2; c++) {
      settled->nodes[i].start[c] = q[2 * i + c];
      settled->nodes[i].velocity[c] = 0.0;
    }
  return STRUT_OK;
}

strut_status strut_settle_model(const strut_model *model, const strut_experiment *experiment,
                                const volatile sig_atomic_t *interrupt, strut_settled_start *start,
                                strut_error *error) {
  *start = (strut_settled_start){.model = model};
  if (!experiment->settle.wanted) return STRUT_OK;
  double *q = strut_arena_allocate(&start->arena, (size_t)model->length, sizeof *q);
  if (!q) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  strut_status status = strut_settle_experiment(model, experiment, NULL, interrupt, q, &start->time,
                                                &start->how, error);
  if (status) return status;
  if (move_start(model->scene, q, start))
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  status = strut_model_compile(start->scene, &start->own, error);
  start->model = start->own;
  return status;
}

void strut_settled_start_free(strut_settled_start *start) {
  strut_model_free(start->own);
  strut_arena_free(&start->arena);
  *start = (strut_settled_start){.model = NULL};
}
