/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut sweep` of a study that fits. */
#include "engine/study/fit/fit.h"
#include "parser/program/study/sweep.h"

/* `context`: the result. */
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
  strut_status status = job->report(job, &strut_fit_values, result, NULL);
  if (status) return status;
  if (!result->found) {
    strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
               "the model cannot be computed at any start: see 'message' of the table, or 'strut "
               "run' with values of the ranges");
    return STRUT_DIVERGED;
  }
  if (strut_fit_is_identified(result)) return STRUT_OK;
  strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
             "not all parameters are identified%s%s", *result->reason ? ": " : "", result->reason);
  return STRUT_INACCURATE;
}

static void free_fit(void *result) { strut_fit_result_free(result); }

const strut_study_form strut_fit_form = {sizeof(strut_fit_result), run_fit, write_fit, report_fit,
                                         free_fit};
