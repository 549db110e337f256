/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of a point's numbers by parameters of its scene: its columns again at 2k + 2 points beside it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/things.h"
#include "engine/study/sweep/sweep_parts.h"

/* Of the runs whose results are differentiated, at most; of their orbits, where they stop once they are steady. */
static const double TIGHT = 1e-11, ORBIT = 1e-6;
/* Relative noise of what is solved: at rest, orbits. */
static const double REST_NOISE = 1e-12, ORBIT_NOISE = 1e-10;

/* A point under way. */
typedef struct derivation {
  const strut_sweep_worker *worker;
  const strut_sweep_job *job;
  double noise;         /* relative; NAN: not known */
  strut_derived_by *by; /* what its scene uses */
  size_t by_count;
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
  for (size_t j = 0; j < plan->derived_count; j++) {
    const strut_derived_column *of = &plan->derived[j];
    outputs[j] = job->cells.numbers[strut_slot_place(plan->columns, of->column)];
    errors[j] = of->stepped ? 0.0 : self->noise * fabs(outputs[j]);
  }
}

/* Does a sensitivity analysis want derivatives, at the medians? */
static bool analyses_derivatives(const strut_study *study) {
  return study->sensitivity.wanted && study->sensitivity.derivatives;
}

bool strut_sweep_is_analysed(const strut_study *study, const char *name) {
  bool found = false;
  for (size_t i = 0; i < study->sensitivity.of_count && analyses_derivatives(study); i++)
    found = found || strcmp(study->sensitivity.of[i], name) == 0;
  return found;
}

static bool add_columns(strut_sweep_plan *plan, const strut_slot_column *of) {
  bool fine = true;
  for (size_t i = 0; i < plan->by_count && fine; i++) {
    const char *name = strut_arena_format(&plan->arena, "%s.d.%s", of->name, plan->by[i].name);
    const char *error = strut_arena_format(&plan->arena, "%s.error", name ? name : "");
    const char *unit = unit_of(&plan->arena, of->unit, plan->by[i].unit);
    fine = name && error && unit && strut_sweep_add_column(plan, "", name, unit, false) &&
           strut_sweep_add_column(plan, "", error, unit, false);
    if (!fine || !analyses_derivatives(plan->study)) continue;
    const char *verdict = strut_arena_format(&plan->arena, "%s.verdict", name);
    fine = verdict && strut_sweep_add_column(plan, "", verdict, "1", true);
  }
  return fine;
}

/* Adds a parameter to those that numbers are differentiated by, unless it is there. */
static bool add_parameter(strut_sweep_plan *plan, const char *name, const char *unit) {
  for (size_t i = 0; i < plan->by_count; i++)
    if (strcmp(plan->by[i].name, name) == 0) return true;
  strut_derived_by *by = &plan->by[plan->by_count++];
  by->name = strut_arena_text(&plan->arena, name, strlen(name));
  by->unit = strut_arena_text(&plan->arena, unit, strlen(unit));
  return by->name && by->unit;
}

/* Can the scene at these values have this number of a parameter? If nothing uses it, it cannot. */
static strut_status try_number(const strut_sweep_plan *plan, const strut_study_value *values,
                               const strut_derived_by *by, double number, strut_error *why) {
  strut_setup setup;
  strut_status status =
      plan->scenes.vary(plan->scenes.context, values, by, 1, &number, &setup, why);
  if (!status) strut_setup_free(&setup);
  return status;
}

/* Fails unless the scene of the first point has the parameter and uses it. */
static strut_status check_parameter(const strut_sweep_plan *plan, const strut_setup *setup,
                                    const strut_study_value *values, const strut_derived_by *by,
                                    strut_error *error) {
  const strut_parameter *parameter = strut_parameter_named(&setup->scene, by->name);
  strut_error why = {0};
  if (!parameter)
    return strut_fail(error, STRUT_USAGE, "derivatives: the model has no parameter '%.60s'",
                      by->name);
  strut_status status = try_number(plan, values, by, parameter->value, &why);
  return status ? strut_fail(error, status == STRUT_NO_MEMORY ? status : STRUT_USAGE,
                             "derivatives by '%.60s': %s", by->name, why.message)
                : STRUT_OK;
}

strut_status strut_sweep_derivative_columns(strut_sweep_plan *plan, const strut_setup *setup,
                                            const strut_study_value *values, strut_error *error) {
  const strut_study *study = plan->study;
  const strut_experiment *experiment = &setup->experiment;
  bool own = study->derivative_count > 0, fine = true;
  const strut_derived_by *from = own ? study->derivatives : experiment->derivatives;
  size_t count = own ? study->derivative_count : experiment->derivative_count;
  const strut_study_axis *analysed =
      analyses_derivatives(study) ? &study->axes[study->sensitivity.axis] : NULL;
  size_t more = analysed ? analysed->column_count : 0;
  if (!plan->scenes.vary || study->follow || count + more == 0) return STRUT_OK;
  plan->by = strut_arena_allocate(&plan->arena, count + more, sizeof *plan->by);
  if (!plan->by) return strut_no_memory(error, "");
  for (size_t i = 0; i < count && fine; i++) {
    strut_status status = check_parameter(plan, setup, values, &from[i], error);
    if (status) return status;
    fine = add_parameter(plan, from[i].name, from[i].unit);
  }
  plan->own_by_count = plan->by_count;
  for (size_t i = 0; i < more && fine; i++)
    fine = add_parameter(plan, analysed->columns[i].name, analysed->columns[i].unit);
  plan->first_derivative = plan->column_count;
  size_t smooth = plan->derived_count;
  for (size_t j = plan->derived_count = 0; j < smooth; j++)
    if (count || strut_sweep_is_analysed(study, plan->columns[plan->derived[j].column].name))
      plan->derived[plan->derived_count++] = plan->derived[j];
  for (size_t j = 0; j < plan->derived_count && fine; j++)
    fine = add_columns(plan, &plan->columns[plan->derived[j].column]);
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
  for (size_t i = 0; i < experiment->quantity_count; i++)
    exact = exact && !strut_takes_sum(&experiment->quantities[i]);
  experiment->exact_sums = true;
  if (steady) return exact;
  if (!adaptive) {
    experiment->integrator = "adaptive";
    experiment->step = 0.0;
    strut_experiment_choose_method(experiment, scene);
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
    status = plan->scenes.vary(plan->scenes.context, self->job->cells.values, self->by,
                               self->by_count, parameters, &job->setup, error);
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

/* A change of a parameter that matters; 0: not known. */
static double scale_of(const strut_sweep_plan *plan, const char *name) {
  const strut_study_sensitivity *analysis = &plan->study->sensitivity;
  for (size_t i = 0; analysis->wanted && i < plan->study->axes[analysis->axis].column_count; i++)
    if (strcmp(plan->study->axes[analysis->axis].columns[i].name, name) == 0)
      return analysis->scales[i];
  return 0.0;
}

/*
 * Lists the parameters of the job's scene that can be a little less or more, which bounds their range; of others
 * derivatives are not known, or 0 where nothing in this scene uses them.
 */
static void choose_parameters(derivation *self, strut_sweep_job *job, size_t count,
                              strut_derivatives_parameter *parameters, size_t *place) {
  const strut_sweep_plan *plan = self->worker->plan;
  const strut_study_value *values = job->cells.values;
  for (size_t i = 0; i < count; i++) {
    const strut_derived_by *by = &plan->by[i];
    const strut_parameter *parameter = strut_parameter_named(&job->setup.scene, by->name);
    const double value = parameter ? parameter->value : (double)NAN,
                 scale = scale_of(plan, by->name);
    const double away = 1e-4 * (value != 0.0 ? fabs(value) : 1.0);
    strut_error why = {0}, unused;
    bool below = !try_number(plan, values, by, value - away, &why);
    bool above = !try_number(plan, values, by, value + away, &why);
    if (below || above) {
      parameters[self->by_count] =
          (strut_derivatives_parameter){value, below ? -HUGE_VAL : value, above ? HUGE_VAL : value,
                                        scale > 0.0 ? fmax(fabs(value), scale) : 0.0};
      place[self->by_count] = i;
      self->by[self->by_count++] = *by;
    } else if (!try_number(plan, values, by, value, &unused)) {
      strut_sweep_warn(job, "derivatives", "there are no derivatives by '%.60s': %.400s", by->name,
                       why.message);
    } else {
      for (size_t j = 0; j < plan->derived_count; j++)
        job->derivatives[j * plan->by_count + i] =
            (strut_derivative){0.0, 0.0, STRUT_DERIVATIVE_THERE};
    }
  }
}

/* The derivatives by the first `count` parameters of the plan into those of the job. */
static strut_status find_derivatives(const strut_sweep_worker *worker, strut_sweep_job *job,
                                     size_t count, strut_arena *arena) {
  const strut_sweep_plan *plan = worker->plan;
  strut_experiment experiment = job->setup.experiment;
  bool rest = plan->study->compute != STRUT_COMPUTE_RUN, steady = experiment.steady.wanted;
  bool known = make_exact(&experiment, &job->setup.scene) || rest;
  derivation self = {worker, job, rest ? REST_NOISE : steady ? ORBIT_NOISE : (double)NAN, NULL, 0};
  strut_derivatives_parameter *parameters;
  double *outputs, *errors;
  size_t *place;
  strut_derivative *found;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(parameters, count), STRUT_NEW(outputs, plan->derived_count),
                      STRUT_NEW(errors, plan->derived_count), STRUT_NEW(place, count),
                      STRUT_NEW(found, count * plan->derived_count + 1), STRUT_NEW(self.by, count)))
    return strut_no_memory(&job->error, "");
  choose_parameters(&self, job, count, parameters, place);
  if (!self.by_count) return STRUT_OK;
  take_numbers(&self, job, outputs, errors);
  const strut_derivatives_task task = {
      .parameter_count = self.by_count,
      .output_count = plan->derived_count,
      .parameters = parameters,
      .evaluate = evaluate,
      .context = &self,
      .outputs = known ? outputs : NULL,
      .errors = errors,
      .threads = worker->options->threads > 0 ? worker->options->threads : strut_sweep_threads()};
  strut_status status = strut_derivatives_find(&task, found, &job->error);
  if (!status && *job->error.message)
    strut_sweep_warn(job, "derivatives",
                     "there are no derivatives that need a point beside this one: %.400s",
                     job->error.message);
  for (size_t k = 0; k < plan->derived_count * self.by_count && !status; k++)
    job->derivatives[k / self.by_count * plan->by_count + place[k % self.by_count]] = found[k];
  return status;
}

strut_status strut_sweep_derive(const strut_sweep_worker *worker, strut_sweep_job *job) {
  const strut_sweep_plan *plan = worker->plan;
  const strut_study *study = plan->study;
  bool analysed = analyses_derivatives(study);
  bool medians = analysed && job->point % study->axes[study->sensitivity.axis].count == 0;
  size_t count = medians ? plan->by_count : plan->own_by_count;
  strut_arena arena = {0};
  for (size_t k = 0; k < plan->derived_count * plan->by_count; k++)
    job->derivatives[k] = (strut_derivative){(double)NAN, (double)NAN, STRUT_DERIVATIVE_UNKNOWN};
  strut_status status = count ? find_derivatives(worker, job, count, &arena) : STRUT_OK;
  for (size_t k = 0; k < plan->derived_count * plan->by_count && !status; k++) {
    const strut_derivative *derivative = &job->derivatives[k];
    bool asked = k % plan->by_count < count;
    strut_sweep_number(&job->cells, derivative->value);
    strut_sweep_number(&job->cells, derivative->error);
    if (analysed)
      strut_sweep_word(&job->cells, asked ? strut_derivative_words(derivative->verdict) : "");
  }
  strut_arena_free(&arena);
  return status;
}

/* What a run measures, in the order of the columns: the velocity and the quantities. */
static strut_status store(const strut_sweep_plan *plan, const strut_setup *setup,
                          const strut_sweep_job *job, strut_summary *summary, strut_error *error) {
  size_t count = plan->derived_count * plan->by_count;
  summary->derivatives = strut_arena_allocate(&summary->arena, count, sizeof *summary->derivatives);
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
  for (size_t i = 0; i < job->warning_count; i++)
    strut_summary_warn(summary, job->warnings[i].code, "%s", job->warnings[i].text);
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
