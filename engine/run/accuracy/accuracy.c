/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/accuracy.h"

#include <math.h>
#include <string.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/run/settle.h"

/* Least steps per period. */
static const double LEAST_STEPS = 100.0;
/* Velocities below this part of size over time are not measured relative to themselves. */
static const double STANDSTILL = 1e-3;

/*
 * A fine run with fixed steps has four steps for each step of the coarse method, of four
 * evaluations each. The budget counts in such runs.
 */
static const double FINE_STEPS = 4.0, FINE_EVALUATIONS = 4.0;
/* Work that is always allowed, in evaluations times nodes and members [1]. */
static const double LEAST_WORK = 4e7;

void strut_accuracy_begin_phase(const strut_accuracy *a, const char *name) {
  if (a->options->phase) a->options->phase(a->options->progress_context, name);
}

int64_t strut_accuracy_evaluations_left(const strut_accuracy *a) {
  return a->allowed > a->used ? a->allowed - a->used : 1;
}

strut_status strut_accuracy_run(strut_accuracy *a, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary) {
  strut_experiment plain = *experiment;
  strut_run_options bounded = *options;
  plain.accuracy = 0.0;
  bounded.chosen = true;
  bounded.most_evaluations = strut_accuracy_evaluations_left(a);
  strut_status status = strut_simulate(a->model, &plain, &bounded, summary, a->error);
  a->used += summary->force_evaluations;
  return status;
}

/* No method supports both rigid bars and exact friction. */
static strut_status refuse_exact_friction(const strut_accuracy *a) {
  const strut_model *model = a->model;
  int32_t exact = strut_first_exact_contact(model);
  if (exact >= 0)
    return strut_fail(a->error, STRUT_USAGE,
                      "no method supports both rigid bars and the friction law %s of node '%s'; "
                      "use bars: elastic, or the law karnopp",
                      strut_friction_law_at(model->contacts.entry[exact].friction.law)->word,
                      a->scene->nodes[model->contacts.entry[exact].node].name);
  return STRUT_OK;
}

/* Chooses verlet-events, or the method for rigid bars, with nearly its largest stable step. */
static strut_status choose_coarse_method(strut_accuracy *a) {
  const strut_model *model = a->model;
  double limit = 0.0;
  strut_span span = strut_experiment_span(&a->experiment, a->scene);
  double unit = span.period > 0.0 ? span.period : span.duration;
  strut_status status = STRUT_OK;
  if (!model->mass) return strut_fail(a->error, STRUT_SINGULAR, "a free node has no mass");
  a->single_method = model->plan & STRUT_TERM_RIGID; /* supported by one method only */
  if (a->single_method) status = refuse_exact_friction(a);
  if (status) return status;
  strut_experiment *e = &a->coarse;
  *e = a->experiment;
  e->accuracy = 0.0;
  e->integrator =
      strut_integrator_for(a->single_method ? STRUT_ROLE_PLAIN : STRUT_ROLE_COARSE)->name;
  status =
      strut_step_limit_for_method(model, strut_integrator_find(e->integrator), &limit, a->error);
  e->step = fmin(STRUT_COARSE_STEP * limit, unit / LEAST_STEPS);
  a->stiff = e->step < unit / LEAST_STEPS;
  e->refine = e->refine_time = 0.0;
  double fine = FINE_EVALUATIONS * FINE_STEPS * span.duration / e->step;
  double least = e->budget / STRUT_USUAL_BUDGET * LEAST_WORK;
  least /= (double)(a->scene->node_count + a->scene->member_count);
  a->budget = (int64_t)fmin(fmax(e->budget * fine, least), 1e18);
  if (a->options->most_evaluations > 0 && a->options->most_evaluations < a->budget)
    a->budget = a->options->most_evaluations;
  a->allowed = a->budget;
  a->scale = STANDSTILL * model->size / unit;
  return status;
}

double strut_accuracy_transient_periods(const strut_accuracy *a) {
  const strut_experiment *e = &a->experiment;
  strut_span span = strut_experiment_span(e, a->scene);
  return e->steady.wanted ? e->periods : 0.5 * span.window_start / span.period;
}

bool strut_accuracy_orbit_covers_window(const strut_accuracy *a,
                                        const strut_steady_summary *steady) {
  const strut_experiment *e = &a->experiment;
  if (e->steady.wanted) return true;
  double repetitions = e->measure_last / steady->repeats;
  return (double)steady->periods <= strut_accuracy_transient_periods(a) &&
         fabs(repetitions - round(repetitions)) < 1e-9;
}

strut_status strut_simulate_accurately(const strut_model *model, const strut_experiment *experiment,
                                       const strut_run_options *options, strut_summary *summary,
                                       strut_error *error) {
  strut_error own = {0};
  strut_settled_start start; /* settled once, so that all runs start from the same bits */
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  strut_accuracy a = {.experiment = *experiment,
                      .options = options,
                      .target = experiment->accuracy,
                      .summary = summary,
                      .error = error ? error : &own};
  bool done = false;
  double begin = strut_run_clock();
  strut_status status = strut_settle_model(model, experiment, options->interrupt, &start, a.error);
  a.model = start.model;
  a.scene = model->scene;
  a.experiment.settle.wanted = false;
  if (!status) status = choose_coarse_method(&a);
  bool velocity =
      experiment->quantity_count == 0; /* the only quantity that these two strategies check */
  /* states that they know nothing of */
  if (model->plan & STRUT_TERM_MEMORY) velocity = false;
  if (strut_feedback_remembers(&model->feedback)) velocity = false;
  if (!status && velocity) status = strut_accuracy_try_midpoint(&a, &done);
  if (!status && !done && velocity && experiment->periods > 0.0 && !a.single_method)
    status = strut_accuracy_try_orbit(&a, &done);
  if (!status && !done) status = strut_accuracy_climb_ladder(&a);
  summary->wall_time = strut_run_clock() - begin;
  summary->status = status;
  summary->settle_time = start.time, summary->settle = start.how;
  strut_summary_warn_of_start(summary);
  strut_summary_warn_of_accuracy(summary);
  strut_settled_start_free(&start);
  return status;
}
