/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a sweep is: its size, its files of points, its shards, its end. */
#include "engine/study/report/study_report.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/study/sweep/refine.h"

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
