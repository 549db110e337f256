/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of a point's numbers by parameters of its scene: its columns again at 2k + 2 points beside it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/things.h"
#include "engine/study/sweep/sweep_parts.h"

/* Of the runs whose results are differentiated, at most; of their orbits, where they stop once they are steady. */
static const double TIGHT = 1e-9, ORBIT = 1e-6;
/* Relative noise of what is solved: at rest, orbits. */
static const double REST_NOISE = 1e-12, ORBIT_NOISE = 1e-10;

/* A point under way. */
typedef struct derivation {
  const strut_sweep_worker *worker;
  const strut_sweep_job *job;
  double noise; /* relative; NAN: not known */
} derivation;

/* "m/s" by "N/m": "m/s/(N/m)" */
static const char *unit_of(strut_arena *arena, const char *of, const char *by) {
  if (strcmp(by, "1") == 0) return of;
  bool simple = !strpbrk(by, " /");
  return strut_arena_format(arena, "%s/%s%s%s", of, simple ? "" : "(", by, simple ? "" : ")");
}

/* The derived numbers of a row. */
static void take_numbers(const derivation *self, const strut_sweep_job *job, double *outputs,
                         double *errors) {
  const strut_sweep_plan *plan = self->worker->plan;
  for (size_t j = 0, c = 0, at = 0; j < plan->derived_count; j++) {
    for (; c < plan->derived[j]; c++) at += !plan->columns[c].word;
    outputs[j] = job->cells.numbers[at];
    errors[j] = self->noise * fabs(outputs[j]);
  }
}

static bool add_columns(strut_sweep_plan *plan, const strut_slot_column *of) {
  bool fine = true;
  for (size_t i = 0; i < plan->by_count && fine; i++) {
    const char *name = strut_arena_format(&plan->arena, "%s.d.%s", of->name, plan->by[i].name);
    const char *error = strut_arena_format(&plan->arena, "%s.error", name ? name : "");
    const char *unit = unit_of(&plan->arena, of->unit, plan->by[i].unit);
    fine = name && error && unit && strut_sweep_add_column(plan, "", name, unit, false) &&
           strut_sweep_add_column(plan, "", error, unit, false);
  }
  return fine;
}

strut_status strut_sweep_derivative_columns(strut_sweep_plan *plan, const strut_setup *setup,
                                            strut_error *error) {
  const strut_study *study = plan->study;
  const strut_experiment *experiment = &setup->experiment;
  bool own = study->derivative_count > 0;
  const strut_derived_by *from = own ? study->derivatives : experiment->derivatives;
  plan->by_count = own ? study->derivative_count : experiment->derivative_count;
  if (!plan->scenes.vary || study->follow) plan->by_count = 0;
  if (!plan->by_count) return STRUT_OK;
  plan->by = strut_arena_allocate(&plan->arena, plan->by_count, sizeof *plan->by);
  bool fine = plan->by != NULL;
  plan->first_derivative = plan->column_count;
  for (size_t i = 0; i < plan->by_count && fine; i++) {
    if (!strut_parameter_named(&setup->scene, from[i].name))
      return strut_fail(error, STRUT_USAGE, "derivatives: the model has no parameter '%.60s'",
                        from[i].name);
    plan->by[i].name = strut_arena_text(&plan->arena, from[i].name, strlen(from[i].name));
    plan->by[i].unit = strut_arena_text(&plan->arena, from[i].unit, strlen(from[i].unit));
    fine = plan->by[i].name && plan->by[i].unit;
  }
  for (size_t j = 0; j < plan->derived_count && fine; j++)
    fine = add_columns(plan, &plan->columns[plan->derived[j]]);
  return fine ? STRUT_OK : strut_no_memory(error, "");
}

/*
 * Makes a run as exact as its derivatives need: with error control and without a search for the method, or on the orbit
 * that it is to find. True where it was.
 */
static bool make_exact(strut_experiment *experiment, const strut_scene *scene) {
  bool adaptive = strut_experiment_is_adaptive(experiment->integrator);
  bool steady = experiment->steady.wanted, asked = experiment->accuracy > 0.0;
  bool exact = steady ? asked && experiment->accuracy <= ORBIT
                      : adaptive && experiment->tolerance <= TIGHT && !asked;
  if (!exact) experiment->accuracy = steady ? ORBIT : 0.0;
  if (steady) return exact;
  if (!adaptive) {
    experiment->integrator = "adaptive";
    experiment->step = 0.0;
    strut_experiment_choose_step(experiment, scene);
  }
  experiment->tolerance = adaptive ? fmin(experiment->tolerance, TIGHT) : TIGHT;
  return exact;
}

/* Fills the kept cells of a job whose scene is there. */
static strut_status fill_kept(const strut_sweep_worker *worker, strut_sweep_job *job) {
  const strut_sweep_plan *plan = worker->plan;
  strut_summary summary = {0};
  job->cells.number_count = 0;
  for (size_t i = 0; i < plan->axis_columns; i++)
    if (!plan->columns[i].word) strut_sweep_number(&job->cells, (double)NAN);
  if (plan->study->compute != STRUT_COMPUTE_RUN) return strut_statics_point(worker, job);
  make_exact(&job->setup.experiment, &job->setup.scene);
  strut_status status = strut_equilibrium_cache_resolve(worker->standing, &job->setup, &job->error);
  if (!status) status = strut_sweep_run_scene(worker, job, true, &summary);
  if (!status) strut_sweep_fill(plan, &job->setup, &summary, "", &job->cells);
  strut_summary_free(&summary);
  return status;
}

static strut_status evaluate(void *context, const double *parameters, double *outputs,
                             double *errors, strut_error *error) {
  const derivation *self = context;
  const strut_sweep_plan *plan = self->worker->plan;
  const strut_flag *interrupt = strut_sweep_interrupt_of(self->worker, self->job);
  strut_sweep_worker worker = *self->worker;
  strut_arena arena = {0};
  strut_sweep_job *job = strut_sweep_make_jobs(plan, &arena, 1);
  strut_status status = job ? STRUT_OK : strut_no_memory(error, "");
  worker.watch = NULL;
  if (!status)
    status = plan->scenes.vary(plan->scenes.context, self->job->cells.values, plan->by,
                               plan->by_count, parameters, &job->setup, error);
  if (!status) {
    job->options = (strut_run_options){.interrupt = interrupt,
                                       .most_evaluations = plan->study->limit.evaluations};
    status = fill_kept(&worker, job);
    if (error) *error = job->error;
    if (!status) take_numbers(self, job, outputs, errors);
    strut_setup_free(&job->setup);
  }
  strut_arena_free(&arena);
  return status;
}

/* A parameter of the job's scene; where a scene cannot have a little less or more of it, that is its range. */
static strut_derivatives_parameter parameter_of(const derivation *self, size_t i,
                                                strut_error *error) {
  const strut_sweep_plan *plan = self->worker->plan;
  const strut_parameter *parameter =
      strut_parameter_named(&self->job->setup.scene, plan->by[i].name);
  const double value = parameter ? parameter->value : (double)NAN;
  double limit[2] = {-INFINITY, INFINITY};
  for (int side = 0; side < 2; side++) {
    const double away = (side ? 1e-4 : -1e-4) * (value != 0.0 ? fabs(value) : 1.0);
    const double beside = value + away;
    strut_setup setup;
    strut_error why = {0};
    strut_status status = plan->scenes.vary(plan->scenes.context, self->job->cells.values,
                                            &plan->by[i], 1, &beside, &setup, &why);
    if (status) limit[side] = value;
    if (limit[0] == limit[1]) *error = why; /* neither */
    if (!status) strut_setup_free(&setup);
  }
  return (strut_derivatives_parameter){.value = value, .low = limit[0], .high = limit[1]};
}

strut_status strut_sweep_derive(const strut_sweep_worker *worker, strut_sweep_job *job) {
  const strut_sweep_plan *plan = worker->plan;
  strut_arena arena = {0};
  if (!plan->by_count) return STRUT_OK;
  strut_experiment experiment = job->setup.experiment;
  bool rest = plan->study->compute != STRUT_COMPUTE_RUN, steady = experiment.steady.wanted;
  bool known = make_exact(&experiment, &job->setup.scene) || rest;
  derivation self = {worker, job, rest ? REST_NOISE : steady ? ORBIT_NOISE : (double)NAN};
  strut_derivatives_parameter *by = strut_arena_allocate(&arena, plan->by_count, sizeof *by);
  double *outputs = strut_arena_allocate(&arena, plan->derived_count, sizeof *outputs);
  double *errors = strut_arena_allocate(&arena, plan->derived_count, sizeof *errors);
  strut_status status = by && outputs && errors ? STRUT_OK : strut_no_memory(&job->error, "");
  for (size_t i = 0; i < plan->by_count && !status; i++)
    by[i] = parameter_of(&self, i, &job->error);
  if (!status) take_numbers(&self, job, outputs, errors);
  const strut_derivatives_task task = {
      .parameter_count = plan->by_count,
      .output_count = plan->derived_count,
      .parameters = by,
      .evaluate = evaluate,
      .context = &self,
      .outputs = known ? outputs : NULL,
      .errors = errors,
      .threads = worker->options->threads > 0 ? worker->options->threads : strut_sweep_threads()};
  if (!status) status = strut_derivatives_find(&task, job->derivatives, &job->error);
  for (size_t k = 0; k < plan->derived_count * plan->by_count && !status; k++) {
    strut_sweep_number(&job->cells, job->derivatives[k].value);
    strut_sweep_number(&job->cells, job->derivatives[k].error);
  }
  strut_arena_free(&arena);
  return status;
}

/* What a run measures, in the order of the columns: the velocity and the quantities. */
static strut_status store(const strut_sweep_plan *plan, const strut_setup *setup,
                          const strut_sweep_job *job, strut_summary *summary, strut_error *error) {
  size_t count = plan->derived_count * plan->by_count;
  summary->derivatives = strut_allocate(count, sizeof *summary->derivatives);
  if (!summary->derivatives) return strut_no_memory(error, "");
  for (size_t k = 0; k < count; k++) {
    size_t j = k / plan->by_count;
    strut_summary_derivative *to = &summary->derivatives[summary->derivative_count++];
    *to =
        (strut_summary_derivative){.of = j ? setup->experiment.quantities[j - 1].name : "velocity",
                                   .by = setup->experiment.derivatives[k % plan->by_count].name,
                                   .is = job->derivatives[k]};
    snprintf(to->unit, sizeof to->unit, "%s", plan->columns[plan->first_derivative + 2 * k].unit);
    bool zero = j ? summary->measured[j - 1].zero : summary->velocity_zero;
    if (zero && to->is.verdict == STRUT_DERIVATIVE_NONE) to->is.verdict = STRUT_DERIVATIVE_UNKNOWN;
  }
  if (job->error.message[0])
    strut_summary_warn(summary, "derivatives", "there are no derivatives: %.500s",
                       job->error.message);
  return STRUT_OK;
}

strut_status strut_sweep_derive_run(const strut_sweep_scenes *scenes, const strut_setup *setup,
                                    const strut_sweep_options *options, strut_summary *summary,
                                    strut_error *error) {
  strut_study study = {.compute = STRUT_COMPUTE_RUN};
  strut_sweep_plan plan;
  strut_arena arena = {0};
  if (!setup->experiment.derivative_count) return STRUT_OK;
  strut_keep_add(&study.keep, STRUT_KEEP_VELOCITY);
  strut_keep_add(&study.keep, STRUT_KEEP_QUANTITIES);
  strut_status status = strut_sweep_plan_make(&study, scenes, &plan, error);
  strut_sweep_worker worker = {&plan, options, strut_equilibrium_cache_create(), NULL};
  strut_sweep_job *job = status ? NULL : strut_sweep_make_jobs(&plan, &arena, 1);
  if (!status && (!job || !worker.standing)) status = strut_no_memory(error, "");
  if (!status) status = scenes->setup(scenes->context, NULL, &job->setup, error);
  if (!status) {
    strut_sweep_fill(&plan, &job->setup, summary, "", &job->cells);
    status = strut_sweep_derive(&worker, job);
    if (status && error) *error = job->error;
    if (!status) status = store(&plan, setup, job, summary, error);
    strut_setup_free(&job->setup);
  }
  strut_equilibrium_cache_free(worker.standing);
  strut_sweep_plan_free(&plan);
  strut_arena_free(&arena);
  return status;
}
