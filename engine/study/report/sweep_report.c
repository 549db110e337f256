/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is printed of a sweep: how far it is; and of sensitivities. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/study/report/study_report.h"
#include "engine/study/sweep/sweep_parts.h"

enum { MOST_FAILURES = 20, MOST_GAPS = 20 };

/* A text as a JSON string. */
static void add_string(strut_buffer *b, const char *text) {
  strut_buffer_add(b, "\"");
  for (; *text; text++) {
    unsigned char c = (unsigned char)*text;
    if (c == '"' || c == '\\')
      strut_buffer_add(b, "\\%c", c);
    else if (c < 0x20)
      strut_buffer_add(b, "\\u%04x", c);
    else
      strut_buffer_add(b, "%c", c);
  }
  strut_buffer_add(b, "\"");
}

char *strut_sweep_count_report(const strut_sweep_plan *plan, bool json) {
  strut_buffer b = {0};
  bool refined = plan->study->refine.depth > 0;
  int64_t points = refined ? strut_refinement_coarse(plan) : plan->points;
  if (plan->study->search && !json) strut_buffer_add(&b, "at most ");
  strut_buffer_add(&b, json ? "{\"points\": %lld" : "%lld points", (long long)points);
  if (refined)
    strut_buffer_add(&b, json ? ", \"most_points\": %lld" : ", refined to at most %lld",
                     (long long)plan->points);
  strut_buffer_add(&b, json ? ", \"columns\": [" : "; the table has");
  for (size_t i = 0; i < plan->column_count; i++) {
    const strut_slot_column *c = &plan->columns[i];
    bool unit = strcmp(c->unit, "1") != 0;
    strut_buffer_add(&b, "%s", i == 0 ? json ? "" : " " : ", ");
    if (json)
      add_string(&b, c->name);
    else
      strut_buffer_add(&b, unit ? "%s [%s]" : "%s", c->name, c->unit);
  }
  strut_buffer_add(&b, json ? "]}\n" : "\n");
  return strut_buffer_take(&b);
}

/* Ranges of missing points, the first few. */
static void add_gaps(strut_buffer *b, strut_slots *slots, bool json) {
  int64_t count = strut_slots_description_of(slots)->count;
  int gaps = 0;
  for (int64_t i = 0; i < count && gaps < MOST_GAPS;) {
    int64_t first = i;
    while (i < count && !strut_slots_done(slots, strut_slots_point(slots, i))) i++;
    if (i > first) {
      long long from = strut_slots_point(slots, first), to = strut_slots_point(slots, i - 1);
      if (json)
        strut_buffer_add(b, "%s[%lld, %lld]", gaps ? ", " : "", from, to);
      else if (from == to)
        strut_buffer_add(b, "%s%lld", gaps ? ", " : "missing: ", from);
      else
        strut_buffer_add(b, "%s%lld to %lld", gaps ? ", " : "missing: ", from, to);
      gaps++;
    }
    i++;
  }
  if (!json && gaps) strut_buffer_add(b, gaps == MOST_GAPS ? ", ...\n" : "\n");
}

static void add_failures(strut_buffer *b, strut_slots *slots, bool json) {
  int64_t count = strut_slots_description_of(slots)->count;
  int reported = 0;
  for (int64_t i = 0; i < count && reported < MOST_FAILURES && strut_slots_failed(slots); i++) {
    strut_result_slot row;
    long long point = strut_slots_point(slots, i);
    if (!strut_slots_get(slots, point, &row) || row.status == STRUT_OK) continue;
    if (json) {
      strut_buffer_add(b, "%s{\"point\": %lld, \"status\": ", reported ? ", " : "", point);
      add_string(b, strut_status_text(row.status));
      strut_buffer_add(b, ", \"message\": ");
      add_string(b, row.message ? row.message : "");
      strut_buffer_add(b, "}");
    } else {
      strut_buffer_add(b, "failed: point %lld: %s: %s\n", point, strut_status_text(row.status),
                       row.message ? row.message : "");
    }
    reported++;
  }
  if (!json && reported == MOST_FAILURES && strut_slots_failed(slots) > reported)
    strut_buffer_add(b, "... and %lld more; the table has all\n",
                     (long long)strut_slots_failed(slots) - reported);
}

char *strut_sweep_status_report(strut_slots *slots, bool json) {
  strut_buffer b = {0};
  const strut_slots_description *plan = strut_slots_description_of(slots);
  long long missing = strut_slots_missing(slots), failed = strut_slots_failed(slots);
  strut_buffer_add(&b,
                   json ? "{\"points\": %lld, \"done\": %lld, \"missing\": %lld, \"failed\": %lld, "
                          "\"gaps\": ["
                        : "%lld points: %lld done, %lld missing, %lld of the done failed\n",
                   (long long)plan->count, (long long)plan->count - missing, missing, failed);
  add_gaps(&b, slots, json);
  if (json) strut_buffer_add(&b, "], \"failures\": [");
  add_failures(&b, slots, json);
  if (json) strut_buffer_add(&b, "]}\n");
  return strut_buffer_take(&b);
}

static void add_warnings(strut_buffer *b, const strut_sweep_state *state) {
  strut_buffer_add(b, ", \"warnings\": [");
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *w = &state->warnings[i];
    strut_buffer_add(b, "%s{\"code\": \"%s\", \"runs\": %lld, \"point\": %lld, \"text\": ",
                     i ? ", " : "", w->code, (long long)w->runs, (long long)w->point);
    add_string(b, w->text);
    strut_buffer_add(b, "}");
  }
  strut_buffer_add(b, "]");
}

char *strut_sweep_end_report(const strut_sweep_state *state, const char *table, bool json) {
  strut_buffer b = {0};
  char time[STRUT_DURATION_TEXT];
  strut_duration_text(state->seconds, time);
  if (json) {
    strut_buffer_add(&b, "{\"points\": %lld, \"failed\": %lld, \"computed\": %lld, \"table\": ",
                     (long long)state->points, (long long)state->failed,
                     (long long)state->computed);
    add_string(&b, table);
    add_warnings(&b, state);
    strut_buffer_add(&b, "}\n");
  } else {
    strut_buffer_add(&b, "%lld points, %lld failed; %lld computed in %s\n%s\n",
                     (long long)state->points, (long long)state->failed, (long long)state->computed,
                     time, table);
  }
  return strut_buffer_take(&b);
}

/* ---- shards ---- */

static strut_status add_shard(strut_buffer *b, const char *directory, strut_shard shard,
                              strut_arena *arena, bool json, strut_error *error) {
  strut_slots *slots = NULL;
  strut_slots_description plan;
  char *path = strut_shard_path(directory, shard, arena);
  if (!path) return strut_no_memory(error, "");
  strut_status status = strut_slots_read(path, &slots, &plan, error);
  if (status != STRUT_OK) return status;
  long long missing = strut_slots_missing(slots), failed = strut_slots_failed(slots);
  strut_buffer_add(b,
                   json ? "{\"shard\": %lld, \"points\": %lld, \"done\": %lld, \"missing\": %lld, "
                          "\"failed\": %lld}"
                        : "shard %lld: %lld points: %lld done, %lld missing, %lld of the done "
                          "failed\n",
                   (long long)shard.index, (long long)plan.count, (long long)plan.count - missing,
                   missing, failed);
  strut_slots_close(slots);
  return STRUT_OK;
}

strut_status strut_shards_report(const char *directory, const strut_shards_found *found,
                                 strut_arena *arena, bool json, char **text, strut_error *error) {
  strut_buffer b = {0};
  strut_status status = STRUT_OK;
  if (json) strut_buffer_add(&b, "{\"shard_count\": %lld, \"shards\": [", (long long)found->count);
  for (int64_t i = 0; i < found->count && status == STRUT_OK; i++) {
    if (json && i) strut_buffer_add(&b, ", ");
    if (found->there[i])
      status = add_shard(&b, directory, (strut_shard){i, found->count}, arena, json, error);
    else
      strut_buffer_add(&b, json ? "{\"shard\": %lld, \"done\": 0}" : "shard %lld: not started\n",
                       (long long)i);
  }
  if (json) strut_buffer_add(&b, "]}\n");
  *text = strut_buffer_take(&b);
  return status == STRUT_OK && !*text ? strut_no_memory(error, "") : status;
}

/* What a sensitivity analysis has found: each effect, or the shares of samples at each point of the axes. */

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
