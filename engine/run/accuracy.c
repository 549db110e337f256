/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy.h"

#include <math.h>
#include <string.h>

#include "engine/integrate/step_limit.h"

/* Part of the largest stable step that the cheapest method takes, and least steps in a period. */
static const double OF_LIMIT = 0.82, LEAST_STEPS = 100.0;
/* Velocities below this part of size over time are not measured relative to themselves. */
static const double STANDING = 1e-3;

strut_status strut_accuracy_run(const strut_accuracy *a, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary) {
  strut_scene scene = *a->scene;
  strut_model *model = NULL;
  scene.experiment = *experiment;
  scene.experiment.accuracy = 0.0;
  strut_status status = strut_model_compile(&scene, &model, a->error);
  if (!status) status = strut_simulate(model, options, summary, a->error);
  strut_model_free(model);
  return status;
}

/* Rigid bars and exact friction have no method in common. */
static strut_status refuse_exact_friction(const strut_accuracy *a, const strut_model *model) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (model->contacts.entry[i].law == STRUT_FRICTION_COULOMB)
      return strut_fail(a->error, STRUT_USAGE,
                        "no method keeps both rigid bars and the friction law coulomb, which node "
                        "'%s' has; use bars: elastic, or the law karnopp",
                        a->scene->nodes[model->contacts.entry[i].node].name);
  return STRUT_OK;
}

/* Verlet from event to event, or what takes rigid bars, with as large a step as it bears. */
static strut_status choose_cheap(strut_accuracy *a) {
  strut_model *model = NULL;
  double limit = 0.0;
  strut_span span = strut_scene_span(a->scene);
  strut_status status = strut_model_compile(a->scene, &model, a->error);
  if (!status && !model->mass)
    status = strut_fail(a->error, STRUT_SINGULAR, "some node that can move has no mass");
  if (!status && (model->plan & STRUT_TERM_RIGID)) status = refuse_exact_friction(a, model);
  if (!status) {
    strut_experiment *e = &a->cheap;
    double unit = span.period > 0.0 ? span.period : span.duration;
    *e = a->scene->experiment;
    e->accuracy = 0.0;
    a->halving = model->plan & STRUT_TERM_RIGID; /* which one method keeps */
    e->integrator = a->halving ? "rk4" : "verlet-events";
    status = strut_step_limit_for(model, strut_integrator_find(e->integrator), &limit, a->error);
    e->step = fmin(OF_LIMIT * limit, unit / LEAST_STEPS);
    e->refine = e->refine_time = 0.0;
    a->scale = STANDING * model->size / unit;
  }
  strut_model_free(model);
  return status;
}

double strut_accuracy_periods(const strut_accuracy *a) {
  const strut_experiment *e = &a->scene->experiment;
  strut_span span = strut_scene_span(a->scene);
  return e->steady.wanted ? e->periods : 0.5 * span.window_start / span.period;
}

bool strut_accuracy_orbit_answers(const strut_accuracy *a, const strut_steady_summary *steady) {
  const strut_experiment *e = &a->scene->experiment;
  if (e->steady.wanted) return true;
  double repetitions = e->measure_last / steady->repeats;
  return (double)steady->periods <= strut_accuracy_periods(a) &&
         fabs(repetitions - round(repetitions)) < 1e-9;
}

strut_status strut_simulate_accurately(const strut_scene *scene, const strut_run_options *options,
                                       strut_summary *summary, strut_error *error) {
  strut_error own = {0};
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  strut_accuracy a = {.scene = scene,
                      .options = options,
                      .wanted = scene->experiment.accuracy,
                      .summary = summary,
                      .error = error ? error : &own};
  bool done = false;
  double begin = strut_run_clock();
  strut_status status = choose_cheap(&a);
  if (!status) status = strut_accuracy_by_midpoint(&a, &done);
  if (!status && !done && scene->experiment.periods > 0.0 && !a.halving)
    status = strut_accuracy_by_orbit(&a, &done);
  if (!status && !done) status = strut_accuracy_by_repetition(&a);
  summary->wall_time = strut_run_clock() - begin;
  summary->status = status;
  return status;
}
