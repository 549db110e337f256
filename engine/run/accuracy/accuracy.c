/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/accuracy.h"

#include <math.h>
#include <string.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/run/settle.h"

/* Part of the largest stable step that the cheapest method takes, and least steps in a period. */
static const double OF_LIMIT = 0.82, LEAST_STEPS = 100.0;
/* Velocities below this part of size over time are not measured relative to themselves. */
static const double STANDING = 1e-3;

/*
 * A fine plain run has four steps where the cheapest method has one, of a method that evaluates the forces four
 * times a step. So many of them, and so many evaluations at least, may be used up.
 */
static const double FINE_STEPS = 4.0, FINE_EVALUATIONS = 4.0;
/* Evaluations times nodes and members, less than which is no matter [1]. */
static const double LITTLE_WORK = 4e7;

void strut_accuracy_begin_phase(const strut_accuracy *a, const char *name) {
  if (a->options->phase) a->options->phase(a->options->progress_context, name);
}

int64_t strut_accuracy_left(const strut_accuracy *a) {
  return a->allowed > a->used ? a->allowed - a->used : 1;
}

strut_status strut_accuracy_run(strut_accuracy *a, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary) {
  strut_scene scene = *a->scene;
  strut_model *model = NULL;
  scene.experiment = *experiment;
  scene.experiment.accuracy = 0.0;
  strut_status status = strut_model_compile(&scene, &model, a->error);
  strut_run_options bounded = *options;
  bounded.chosen = true;
  bounded.most_evaluations = strut_accuracy_left(a);
  if (!status) status = strut_simulate(model, &bounded, summary, a->error);
  a->used += summary->force_evaluations;
  strut_model_free(model);
  return status;
}

/* Rigid bars and exact friction have no method in common. */
static strut_status refuse_exact_friction(const strut_accuracy *a, const strut_model *model) {
  int32_t exact = strut_first_exact_contact(model);
  if (exact >= 0)
    return strut_fail(a->error, STRUT_USAGE,
                      "no method keeps both rigid bars and the friction law %s, which node "
                      "'%s' has; use bars: elastic, or the law karnopp",
                      strut_friction_law_at(model->contacts.entry[exact].friction.law)->word,
                      a->scene->nodes[model->contacts.entry[exact].node].name);
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
    e->integrator = strut_integrator_for(a->halving ? STRUT_ROLE_PLAIN : STRUT_ROLE_COARSE)->name;
    status =
        strut_step_limit_for_method(model, strut_integrator_find(e->integrator), &limit, a->error);
    e->step = fmin(OF_LIMIT * limit, unit / LEAST_STEPS);
    e->refine = e->refine_time = 0.0;
    double fine = FINE_EVALUATIONS * FINE_STEPS * span.duration / e->step;
    double little = e->budget / STRUT_USUAL_BUDGET * LITTLE_WORK;
    little /= (double)(a->scene->node_count + a->scene->member_count);
    a->budget = (int64_t)fmin(fmax(e->budget * fine, little), 1e18);
    a->allowed = a->budget;
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
  strut_scene settled; /* once for all runs: they start from the same bits */
  strut_settle_summary how;
  strut_arena arena = {0};
  double settle_time;
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  strut_accuracy a = {.scene = &settled,
                      .options = options,
                      .wanted = scene->experiment.accuracy,
                      .summary = summary,
                      .error = error ? error : &own};
  bool done = false;
  double begin = strut_run_clock();
  strut_status status =
      strut_settle_scene(scene, options->interrupt, &arena, &settled, &settle_time, &how, a.error);
  if (!status) status = choose_cheap(&a);
  bool velocity = scene->experiment.quantity_count == 0; /* which alone these two watch */
  if (!status && velocity) status = strut_accuracy_by_midpoint(&a, &done);
  if (!status && !done && velocity && scene->experiment.periods > 0.0 && !a.halving)
    status = strut_accuracy_by_orbit(&a, &done);
  if (!status && !done) status = strut_accuracy_by_repetition(&a);
  summary->wall_time = strut_run_clock() - begin;
  summary->status = status;
  summary->settle_time = settle_time, summary->settle = how;
  strut_summary_warn_of_start(summary);
  strut_arena_free(&arena);
  return status;
}
