/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut sweep` of a study that fits. */
#include "engine/output/file.h"
#include "engine/study/fit/fit.h"
#include "engine/study/results/study_table.h"
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
  const strut_listener *listener = job->arguments->listener;
  strut_slots *const sources[] = {job->slots};
  strut_error error = {0};
  strut_status status = strut_fit_write(result, directory, "model.yaml", &error);
  if (!status) status = strut_fit_figures(result, directory, &error);
  if (!status)
    status = strut_study_table_write_partial(directory, "table.csv", sources, 1, NULL, &error);
  if (status) return strut_tell_failure(listener, status, &error);
  strut_file_remove(directory, STRUT_PARTIAL_TABLE);
  status = job->report(job, &strut_fit_values, result, NULL);
  if (status) return status;
  if (!result->found) {
    strut_tell(listener, STRUT_MESSAGE_REMARK, NULL,
               "the model cannot be computed at any start: see 'message' of the table, or 'strut "
               "run' with values of the ranges");
    return STRUT_DIVERGED;
  }
  if (strut_fit_is_identified(result)) return STRUT_OK;
  strut_tell(listener, STRUT_MESSAGE_REMARK, NULL, "not all parameters are identified%s%s",
             *result->reason ? ": " : "", result->reason);
  return STRUT_INACCURATE;
}

strut_status strut_sweep_fit(strut_study_job *job) {
  strut_fit_result result = {0};
  strut_error error = {0};
  strut_status status = strut_study_job_run(job, run_fit, &result, &error);
  strut_tell_failure(job->arguments->listener, status, &error);
  if (!status) status = complete(job, &result);
  strut_fit_result_free(&result);
  return status;
}
