/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/sweep.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "parser/program/streams.h"

enum { WIDTH = 20, BAR_ROOM = 3 * WIDTH + 1, TEXT = 300, MOST_FAILURES = 20, MOST_GAPS = 20 };

/* Between two lines without a terminal, and before the first bar [s]. */
static const double REPORT_INTERVAL = 30.0, PATIENCE = 0.5;

strut_sweep_progress strut_sweep_progress_begin(const strut_sweep_plan *plan, bool quiet) {
  return (strut_sweep_progress){.bar = strut_progress_begin(quiet), .plan = plan, .quiet = quiet};
}

/* "frequency 3.2 Hz, velocity 0.0098 m/s": the first few cells of a row. */
static void format_row(const strut_sweep_plan *plan, const strut_result_slot *row, char *text,
                       size_t size) {
  size_t used = 0, number = 0, word = 0, most = plan->axis_columns + 1;
  *text = '\0';
  for (size_t i = 0; i < plan->column_count && i < most && used < size; i++) {
    const strut_slot_column *c = &plan->columns[i];
    const char *unit = strcmp(c->unit, "1") == 0 ? "" : c->unit;
    int n = c->word ? snprintf(text + used, size - used, "%s%s %s", i ? ", " : "", c->name,
                               row->words[word++])
                    : snprintf(text + used, size - used, "%s%s %.4g%s%s", i ? ", " : "", c->name,
                               row->numbers[number++], *unit ? " " : "", unit);
    used += n > 0 ? (size_t)n : 0;
  }
  if (row->status != STRUT_OK && used < size)
    snprintf(text + used, size - used, ": %s", strut_status_text(row->status));
}

/* "123 of 1146 points (2 failed), 45 a second, 2 min 03 s left" */
static void format_state(const strut_sweep_state *state, char *text, size_t size) {
  char left[32], failed[40] = "";
  double rate = state->seconds > 0.0 ? (double)state->computed / state->seconds : 0.0;
  strut_progress_time(left, sizeof left,
                      rate > 0.0 ? (double)(state->points - state->done) / rate : HUGE_VAL);
  if (state->failed) snprintf(failed, sizeof failed, " (%lld failed)", (long long)state->failed);
  snprintf(text, size, "%lld of %lld points%s, %.3g a second, %s left", (long long)state->done,
           (long long)state->points, failed, rate, left);
}

void strut_sweep_progress_show(void *context, const strut_sweep_state *state) {
  strut_sweep_progress *progress = context;
  strut_progress *bar = &progress->bar;
  char text[TEXT], row[TEXT], all[2 * TEXT + 40], blocks[BAR_ROOM];
  if (progress->quiet || state->seconds < PATIENCE) return;
  if (!bar->wanted && state->seconds - progress->reported < REPORT_INTERVAL) return;
  progress->reported = state->seconds;
  format_state(state, text, sizeof text);
  format_row(progress->plan, state->row, row, sizeof row);
  if (state->has_best)
    snprintf(all, sizeof all, "%s; best %.5g; %s", text, state->best, row);
  else
    snprintf(all, sizeof all, "%s; %s", text, row);
  if (!bar->wanted) {
    fprintf(stderr, "strut: %s\n", all);
    return;
  }
  int size = bar->columns - 1, width = size > 3 * WIDTH ? WIDTH : 0;
  strut_progress_bar(blocks, width, (double)state->done / (double)state->points, bar->unicode);
  const char *on = bar->colour ? "\033[36m" : "", *off = bar->colour ? "\033[0m" : "";
  fprintf(stderr, "\r%s%s%s %-*.*s", on, blocks, off, size - width - 1, size - width - 1, all);
  fflush(stderr);
  bar->shown = true;
}

void strut_sweep_progress_end(strut_sweep_progress *progress) {
  strut_progress_end(&progress->bar);
}

static strut_status print_buffer(strut_buffer *b) {
  char *text = strut_buffer_take(b);
  if (!text) return strut_print_out_of_memory();
  strut_status status = strut_print(text);
  strut_release(text);
  return status;
}

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

strut_status strut_sweep_print_count(const strut_sweep_plan *plan, bool json) {
  strut_buffer b = {0};
  bool refined = plan->study->refine_depth > 0;
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
  return print_buffer(&b);
}

/* Ranges of missing points, the first few. */
static void add_gaps(strut_buffer *b, strut_slots *slots, bool json) {
  int64_t count = strut_slots_plan_of(slots)->count;
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
  int64_t count = strut_slots_plan_of(slots)->count;
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

strut_status strut_sweep_print_status(strut_slots *slots, bool json) {
  strut_buffer b = {0};
  const strut_slots_plan *plan = strut_slots_plan_of(slots);
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
  return print_buffer(&b);
}

void strut_sweep_print_warnings(const strut_sweep_state *state) {
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *w = &state->warnings[i];
    fprintf(stderr, "strut: warning: %lld of %lld runs, first point %lld: %s\n", (long long)w->runs,
            (long long)state->computed, (long long)w->point, w->text);
  }
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

strut_status strut_sweep_print_end(const strut_sweep_state *state, const char *table, bool json) {
  strut_buffer b = {0};
  char time[32];
  strut_progress_time(time, sizeof time, state->seconds);
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
  return print_buffer(&b);
}

strut_status strut_sweep_judge(int64_t points, int64_t failed, int64_t inaccurate) {
  if (failed)
    fprintf(stderr,
            "strut: %lld of %lld points failed: see the table's columns status and message\n",
            (long long)failed, (long long)points);
  if (inaccurate)
    fprintf(stderr,
            "strut: %lld of %lld points are less accurate than requested: see the table's "
            "column " STRUT_KEPT_COLUMN "\n",
            (long long)inaccurate, (long long)points);
  return failed ? STRUT_DIVERGED : inaccurate ? STRUT_INACCURATE : STRUT_OK;
}

/* ---- shards ---- */

static strut_status add_shard(strut_buffer *b, const char *directory, strut_shard shard,
                              strut_arena *arena, bool json) {
  strut_error error = {0};
  strut_slots *slots = NULL;
  strut_slots_plan plan;
  char *path = strut_shard_path(directory, shard, arena);
  if (!path) return strut_print_out_of_memory();
  strut_status status = strut_slots_read(path, &slots, &plan, &error);
  if (status != STRUT_OK) {
    strut_print_error(&error);
    return status;
  }
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

strut_status strut_sweep_print_shards(const char *directory, const strut_shards_found *found,
                                      strut_arena *arena, bool json) {
  strut_buffer b = {0};
  strut_status status = STRUT_OK;
  if (json) strut_buffer_add(&b, "{\"shard_count\": %lld, \"shards\": [", (long long)found->count);
  for (int64_t i = 0; i < found->count && status == STRUT_OK; i++) {
    if (json && i) strut_buffer_add(&b, ", ");
    if (found->there[i])
      status = add_shard(&b, directory, (strut_shard){i, found->count}, arena, json);
    else
      strut_buffer_add(&b, json ? "{\"shard\": %lld, \"done\": 0}" : "shard %lld: not started\n",
                       (long long)i);
  }
  if (json) strut_buffer_add(&b, "]}\n");
  char *text = strut_buffer_take(&b);
  if (status == STRUT_OK) status = text ? strut_print(text) : strut_print_out_of_memory();
  strut_release(text);
  return status;
}
