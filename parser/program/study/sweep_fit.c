/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut sweep` of a study that fits. */
#include <stdio.h>

#include "engine/output/file.h"
#include "engine/study/fit/fit.h"
#include "engine/study/results/study_table.h"
#include "parser/program/commands.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/program/study/sweep.h"

/* `context`: the result. */
static strut_status run_fit(strut_study_job *job, const strut_sweep_options *options, void *context,
                            strut_error *error) {
  strut_sweep_options how = *options;
  how.directory = NULL;
  how.worker = job->shard.index, how.workers = job->shard.count;
  return strut_fit_run(&job->study->plan, job->slots, &how, &job->state, context, error);
}

/* Files, figures, the table last, and what is printed. */
static strut_status complete(const strut_study_job *job, const strut_fit_result *result) {
  const char *directory = job->arguments->output;
  strut_slots *const sources[] = {job->slots};
  strut_error error = {0};
  strut_status status = strut_fit_write(result, directory, "model.yaml", &error);
  if (!status) status = strut_fit_figures(result, directory, &error);
  if (!status)
    status = strut_study_table_write_partial(directory, "table.csv", sources, 1, NULL, &error);
  if (status) return strut_print_failure(status, &error);
  strut_file_remove(directory, STRUT_PARTIAL_TABLE);
  status = strut_print_values(job->arguments, &strut_fit_values, result, NULL);
  if (status) return status;
  if (!result->found) {
    fputs(
        "strut: the model cannot be computed at any start: see 'message' of the table, or 'strut "
        "run' with values of the ranges\n",
        stderr);
    return STRUT_DIVERGED;
  }
  if (strut_fit_is_identified(result)) return STRUT_OK;
  fprintf(stderr, "strut: not all parameters are identified%s%s\n", *result->reason ? ": " : "",
          result->reason);
  return STRUT_INACCURATE;
}

strut_status strut_sweep_fit_plan(const strut_arguments *arguments,
                                  const strut_sweep_study *study) {
  strut_fit_plan plan = {0};
  strut_error error = {0};
  if (!study->plan.study->fit)
    return strut_usage_error(arguments, "--plan is for studies with 'fit'");
  strut_status status = strut_fit_plan_find(&study->plan, strut_interrupt_watch(), &plan, &error);
  strut_print_failure(status, &error);
  if (!status) status = strut_print_values(arguments, &strut_fit_plan_values, &plan, NULL);
  strut_arena_free(&plan.arena);
  return status;
}

strut_status strut_sweep_fit(strut_study_job *job) {
  strut_fit_result result = {0};
  strut_error error = {0};
  strut_status status = strut_study_job_run(job, run_fit, &result, &error);
  strut_print_failure(status, &error);
  if (!status) status = complete(job, &result);
  strut_fit_result_free(&result);
  return status;
}
