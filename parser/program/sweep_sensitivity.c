/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a sensitivity analysis adds to a sweep: its table, its figure and its report. */

#include "engine/study/report/study_report.h"
#include "engine/study/sensitivity/sensitivity.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"
#include "parser/yaml/diagnostics.h"

static const double PAGE = 510.24; /* 180 mm [pt] */
static const char *column_name(const void *context, size_t i) {
  const strut_sweep_plan *plan = context;
  return i < plan->column_count ? plan->columns[i].name : NULL;
}

strut_status strut_sweep_sensitivity_check(const strut_sweep_plan *plan, strut_error *error) {
  const char *missing;
  if (!plan->study->sensitivity.wanted ||
      strut_sensitivity_check(plan->study, plan->columns, plan->column_count, &missing))
    return STRUT_OK;
  const char *near = strut_did_you_mean(missing, column_name, plan);
  return strut_fail(error, STRUT_BAD_SCENE,
                    "the sensitivity analysis: the table has no column '%.60s'%s%s%s; 'keep' lists "
                    "what it has",
                    missing, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

strut_status strut_sweep_sensitivity_complete(const strut_sweep_plan *plan, strut_slots *slots,
                                              const char *directory, bool report) {
  strut_sensitivity_result result = {0};
  strut_arena arena = {0};
  strut_error error = {0};
  bool drawn;
  if (!plan->study->sensitivity.wanted) return STRUT_OK;
  const char *path = strut_arena_format(&arena, "%s/sensitivity.svg", directory);
  strut_status status = path ? STRUT_OK : strut_no_memory(&error, "");
  if (!status) status = strut_sensitivity_find(plan->study, slots, &result, &error);
  if (!status) status = strut_sensitivity_write(plan->study, slots, &result, directory, &error);
  if (!status)
    status = strut_sensitivity_figure(plan->study, slots, &result, path, PAGE, &drawn, &error);
  if (status) strut_print_failure(status, &error);
  if (!status && report)
    status = strut_print_block(strut_sensitivity_report(plan, slots, &result, directory));
  strut_arena_free(&result.arena);
  strut_arena_free(&arena);
  return status;
}
