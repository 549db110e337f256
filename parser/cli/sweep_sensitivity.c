/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a sensitivity analysis adds to a sweep: its table, its figure and its report. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/buffer.h"
#include "engine/output/quantity_text.h"
#include "engine/study/sensitivity/sensitivity.h"
#include "parser/cli/streams.h"
#include "parser/cli/sweep.h"
#include "parser/yaml/diagnostics.h"

static const double PAGE = 510.24; /* 180 mm [pt] */
enum { MOST_LINES = 60 };

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

/* What is missing, and that a number never changes its sign, is in the file only. */
static bool is_shown(const strut_sensitivity_row *r) {
  double value = r->estimate.value;
  bool sign = strstr(r->of, " > 0") != NULL;
  return isfinite(value) && !(sign && (value == 0.0 || value == 1.0));
}

static void add_line(strut_buffer *b, const strut_sensitivity_row *r) {
  const strut_estimate *e = &r->estimate;
  strut_buffer_add(b, "  %-24.40s %-12s %-16.30s", r->of, strut_sensitivity_word(r->measure),
                   r->parameter ? r->parameter : "");
  strut_buffer_add(b, " %12s", strut_quantity_of_any(e->value, 4, r->unit).text);
  if (isfinite(e->error))
    strut_buffer_add(b, "  +- %s", strut_quantity_of_any(e->error, 2, r->unit).text);
  if (r->measure >= STRUT_SENSITIVITY_FIRST_ORDER || r->measure == STRUT_SENSITIVITY_SHARE)
    strut_buffer_add(b, "  (%.2f to %.2f)", e->low, e->high);
  strut_buffer_add(b, "\n");
}

static strut_status print_report(const strut_sensitivity_result *result, const char *directory) {
  strut_buffer b = {0};
  size_t shown = 0;
  bool one = result->count && result->rows[0].point == result->rows[result->count - 1].point;
  for (size_t i = 0; i < result->count && one; i++) {
    if (!is_shown(&result->rows[i])) continue;
    if (shown++ < MOST_LINES) add_line(&b, &result->rows[i]);
  }
  if (shown > MOST_LINES)
    strut_buffer_add(&b, "  ... and %zu more in the file\n", shown - MOST_LINES);
  strut_buffer_add(&b, "%s/sensitivity.csv\n", directory);
  char *text = strut_buffer_take(&b);
  strut_status status = text ? strut_print(text) : strut_print_out_of_memory();
  strut_release(text);
  return status;
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
  if (!status && report) status = print_report(&result, directory);
  strut_arena_free(&result.arena);
  strut_arena_free(&arena);
  return status;
}
