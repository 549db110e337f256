/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes a study that is open, and writes its results; those of single points, of refinements and of fits are here. */
#include <stdlib.h>
#include <string.h>

#include "engine/output/file.h"
#include "engine/study/fit/fit.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "parser/program/study/sweep.h"

static const char table_name[] = "table.csv";

strut_status strut_sweep_find_shard(const strut_arguments *arguments, strut_sweep_study *study,
                                    strut_shard *shard, const char **path) {
  const strut_array_task task = {
      .id = getenv("SLURM_ARRAY_TASK_ID"),
      .min = getenv("SLURM_ARRAY_TASK_MIN"),
      .max = getenv("SLURM_ARRAY_TASK_MAX"),
      .step = getenv("SLURM_ARRAY_TASK_STEP"),
      .count = getenv("SLURM_ARRAY_TASK_COUNT"),
      .variable = getenv,
  };
  const char *text = arguments->shard;
  strut_error error = {0};
  *shard = (strut_shard){0};
  strut_status status = text ? strut_shard_read(text, &task, shard, &error) : STRUT_OK;
  if (status) return strut_tell_failure(arguments->listener, status, &error);
  const strut_shard part = strut_study_has_stages(study->plan.study) ? (strut_shard){0} : *shard;
  if (part.count) strut_shard_points(part, &study->slots);
  *path = strut_shard_path(arguments->output, part, &study->plan.arena);
  return strut_tell_failure(arguments->listener, *path ? STRUT_OK : STRUT_NO_MEMORY, NULL);
}

/* ---- single points, and refined maps of them ---- */

static strut_status run_points(strut_study_job *job, const strut_sweep_options *given,
                               void *context, strut_error *error) {
  strut_sweep_options how = *given;
  (void)context;
  if (job->refinement) {
    how.wants = strut_refinement_wants;
    how.wants_context = job->refinement;
    strut_refinement_count(job->refinement, job->slots, &how.wanted, &how.wanted_done);
  }
  return strut_sweep_run(&job->study->plan, job->slots, &how, &job->state, error);
}

/* Adds the warnings of a round to those before. */
static void add_warnings(strut_sweep_state *all, const strut_sweep_state *round) {
  for (size_t i = 0; i < round->warning_count; i++) {
    const strut_sweep_warning *warning = &round->warnings[i];
    size_t at = 0;
    while (at < all->warning_count && strcmp(all->warnings[at].code, warning->code) != 0) at++;
    if (at == STRUT_SWEEP_MOST_WARNINGS) continue;
    int64_t runs = at < all->warning_count ? all->warnings[at].runs : 0;
    bool first = at == all->warning_count || warning->point < all->warnings[at].point;
    if (at == all->warning_count) all->warning_count++;
    if (first) all->warnings[at] = *warning;
    all->warnings[at].runs = runs + warning->runs;
  }
}

/* Computes what is wanted until that wants nothing further. */
static strut_status run_refined(strut_study_job *job, strut_error *error) {
  int64_t wanted, done;
  strut_sweep_state all = {0}, *state = &job->state;
  strut_status status = STRUT_OK;
  for (bool first = true; !status; first = false) {
    strut_sweep_refine_learn(job->refinement, job->arguments->output, job->shard, job->slots);
    job->others = strut_refinement_choose(job->refinement);
    strut_refinement_count(job->refinement, job->slots, &wanted, &done);
    if (wanted == done && !first) break;
    status = strut_study_job_run(job, run_points, NULL, error);
    all.computed += state->computed;
    all.seconds += state->seconds;
    add_warnings(&all, state);
  }
  state->computed = all.computed;
  state->seconds = all.seconds;
  state->warning_count = all.warning_count;
  memcpy(state->warnings, all.warnings, sizeof all.warnings);
  return status;
}

/* Failed points do not stop a sweep, but change the exit code. */
static strut_status report_points(const strut_study_job *job, const void *result,
                                  const char *table) {
  const strut_sweep_end end = {&job->state, table};
  (void)result;
  strut_status status = job->report(job, &strut_sweep_end_values, &end, NULL);
  if (!status && !job->shard.count) status = strut_sweep_sensitivity_complete(job);
  return status ? status
                : strut_sweep_judge(job->arguments->listener, job->state.points, job->state.failed,
                                    strut_slots_inaccurate(job->slots));
}

static const strut_study_form points_form = {
    .size = 1, .compute = run_points, .report = report_points};

/* ---- fits ---- */

static strut_status run_fit(strut_study_job *job, const strut_sweep_options *options, void *context,
                            strut_error *error) {
  strut_sweep_options how = *options;
  how.directory = NULL;
  how.worker = job->shard.index, how.workers = job->shard.count;
  return strut_fit_run(&job->study->plan, job->slots, &how, &job->state, context, error);
}

static strut_status write_fit(const strut_study_job *job, void *result, strut_error *error) {
  strut_status status = strut_fit_write(result, job->arguments->output, "model.yaml", error);
  return status ? status : strut_fit_figures(result, job->arguments->output, error);
}

static strut_status report_fit(const strut_study_job *job, const void *of, const char *table) {
  const strut_fit_result *result = of;
  (void)table;
  if (result->missing)
    return strut_sweep_study_report(
        job->arguments->listener, job->study,
        strut_sweep_refuse_series(job->study, result->missing, result->reason, ""),
        &(strut_error){0});
  strut_status status = job->report(job, &strut_fit_values, result, NULL);
  if (status) return status;
  if (!result->found) {
    strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
               "the model cannot be computed at any start: %s; see 'message' of the table",
               result->reason);
    return STRUT_DIVERGED;
  }
  if (strut_fit_is_identified(result)) return STRUT_OK;
  strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
             "not all parameters are identified%s%s", *result->reason ? ": " : "", result->reason);
  return STRUT_INACCURATE;
}

static void free_fit(void *result) { strut_arena_free(&((strut_fit_result *)result)->arena); }

static const strut_study_form fit_form = {sizeof(strut_fit_result), run_fit, write_fit, report_fit,
                                          free_fit};

/* ---- any study ---- */

/* Writes the files, the table last as a sign that they are there, draws and reports. */
static strut_status complete(const strut_study_job *job, const strut_study_form *form,
                             void *result) {
  const strut_arguments *arguments = job->arguments;
  const strut_study *study = job->study->plan.study;
  const bool stages = strut_study_has_stages(study), whole = stages || !job->shard.count;
  const strut_slot_rows rows = {
      .sources = &job->slots, .count = 1, .partial = stages || job->refinement};
  strut_error error = {0};
  const char *table =
      whole ? strut_arena_format(&job->study->plan.arena, "%s/%s", arguments->output, table_name)
            : "one shard: 'strut sweep --merge' writes the table of all";
  strut_status status = table ? STRUT_OK : STRUT_NO_MEMORY;
  if (!status && form->write) status = form->write(job, result, &error);
  if (!status && whole)
    status = strut_study_table_write(arguments->output, table_name, &rows, NULL, &error);
  if (status) return strut_tell_failure(arguments->listener, status, &error);
  if (whole) strut_file_remove(arguments->output, STRUT_PARTIAL_TABLE);
  if (whole) status = strut_sweep_figures_draw(job, table);
  return status ? status : form->report(job, result, table);
}

static strut_status compute(strut_study_job *job, const strut_study_form *form) {
  strut_error error = {0};
  const strut_listener *listener = job->arguments->listener;
  void *result = strut_allocate(1, form->size);
  strut_status status = result ? STRUT_OK : strut_no_memory(&error, "");
  if (!status && job->study->plan.study->refine.depth)
    status = strut_refinement_create(&job->study->plan, &job->refinement, &error);
  if (!status)
    status = job->refinement ? run_refined(job, &error)
                             : strut_study_job_run(job, form->compute, result, &error);
  strut_sweep_tell_warnings(job);
  strut_tell_failure(listener, status, &error);
  if (!status) status = complete(job, form, result);
  if (job->others && (!status || status == STRUT_DIVERGED || status == STRUT_INACCURATE))
    strut_tell(listener, STRUT_MESSAGE_REMARK, NULL,
               "%lld points of other shards decide what is refined next: run this shard again when "
               "they are done",
               (long long)job->others);
  if (result && form->release) form->release(result);
  strut_refinement_free(job->refinement);
  strut_release(result);
  return status;
}

strut_status strut_study_job_compute(strut_study_job *job) {
  const strut_study *study = job->study->plan.study;
  strut_error error = {0};
  const char *path;
  if (job->arguments->retry && strut_study_has_stages(study))
    return strut_usage_error(job->arguments,
                             "--retry cannot be used with a study that searches or fits: each of "
                             "its points depends on those before it");
  strut_status status = strut_sweep_find_shard(job->arguments, job->study, &job->shard, &path);
  if (status) return status;
  status = strut_study_job_open(job, path, &error);
  if (status) return strut_tell_failure(job->arguments->listener, status, &error);
  return compute(job, study->search   ? &strut_search_form
                      : study->follow ? &strut_follow_form
                      : study->fit    ? &fit_form
                                      : &points_form);
}
