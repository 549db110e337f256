/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a sensitivity analysis has found: each effect, or the shares of samples at each point of the axes. */
#include "engine/study/report/study_report.h"

#include <math.h>
#include <string.h>

#include "engine/output/buffer.h"

enum { MOST_LINES = 60 };

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

/* Columns of the table before those of the analysis: of the other axes. */
static size_t other_columns(const strut_study *study) {
  size_t count = 0;
  for (size_t i = 0; i < study->sensitivity.axis; i++) count += study->axes[i].column_count;
  return count;
}

/* Room for a column of the table of shares. */
static int width_of(const char *name) {
  int length = (int)strlen(name);
  return length > 8 ? length : 8;
}

/* Headers of the table of shares: the axes, and the conditions. */
static void add_header(strut_buffer *b, const strut_sweep_plan *plan,
                       const strut_sensitivity_result *result) {
  for (size_t i = 0; i < other_columns(plan->study); i++) {
    const strut_slot_column *c = &plan->columns[i];
    bool plain = strcmp(c->unit, "1") == 0;
    strut_buffer_add(b, "  %12s%s%s", c->name, plain ? "" : ", ", plain ? "" : c->unit);
  }
  for (size_t i = 0; i < result->count && result->rows[i].point == result->rows[0].point; i++)
    if (result->rows[i].measure == STRUT_SENSITIVITY_SHARE)
      strut_buffer_add(b, "  %*s", width_of(result->rows[i].of), result->rows[i].of);
  strut_buffer_add(b, "  %8s\n", "used");
}

/* The values of the axes at a point, each as wide as its header. */
static void add_axes(strut_buffer *b, const strut_sweep_plan *plan, strut_slots *slots,
                     int64_t point) {
  strut_result_slot row;
  size_t numbers = 0, words = 0;
  if (!strut_slots_get(slots, point, &row)) return;
  for (size_t i = 0; i < other_columns(plan->study); i++) {
    const strut_slot_column *c = &plan->columns[i];
    int more = strcmp(c->unit, "1") == 0 ? 0 : (int)strlen(c->unit) + 2;
    int width = more + (strlen(c->name) > 12 ? (int)strlen(c->name) : 12);
    if (c->word)
      strut_buffer_add(b, "  %*s", width, row.words[words++]);
    else
      strut_buffer_add(b, "  %*.6g", width, row.numbers[numbers++]);
  }
}

/* A line for each point of the axes: the shares of the samples that meet each condition. */
static void add_shares(strut_buffer *b, const strut_sweep_plan *plan, strut_slots *slots,
                       const strut_sensitivity_result *result) {
  add_header(b, plan, result);
  size_t lines = 0;
  for (size_t i = 0, k = 0; i < result->count && lines < MOST_LINES; i = k, lines++) {
    size_t used = 0;
    add_axes(b, plan, slots, result->rows[i].point);
    for (k = i; k < result->count && result->rows[k].point == result->rows[i].point; k++) {
      const strut_sensitivity_row *r = &result->rows[k];
      if (r->measure != STRUT_SENSITIVITY_SHARE) continue;
      if (isfinite(r->estimate.value))
        strut_buffer_add(b, "  %*.3f", width_of(r->of), r->estimate.value);
      else
        strut_buffer_add(b, "  %*s", width_of(r->of), "-");
      if (r->used > used) used = r->used;
    }
    strut_buffer_add(b, "  %8zu\n", used);
  }
}

char *strut_sensitivity_report(const strut_sweep_plan *plan, strut_slots *slots,
                               const strut_sensitivity_result *result, const char *directory) {
  strut_buffer b = {0};
  size_t shown = 0;
  bool one = result->count && result->rows[0].point == result->rows[result->count - 1].point;
  for (size_t i = 0; i < result->count && one; i++) {
    if (!is_shown(&result->rows[i])) continue;
    if (shown++ < MOST_LINES) add_line(&b, &result->rows[i]);
  }
  if (!one && plan->study->sensitivity.samples > 0) add_shares(&b, plan, slots, result);
  if (shown > MOST_LINES)
    strut_buffer_add(&b, "  ... and %zu more in the file\n", shown - MOST_LINES);
  strut_buffer_add(&b, "%s/sensitivity.csv\n", directory);
  return strut_buffer_take(&b);
}
