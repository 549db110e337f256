/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is told of a sweep: its points and columns, how far it is, its end. */
#include <stdio.h>

#include "engine/base/text.h"
#include "engine/output/result_values.h"
#include "engine/study/report/study_report.h"
#include "engine/study/sweep/sweep_parts.h"

static strut_value column_of(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(((const strut_sweep_plan *)of->at)->columns[i].name);
}

#define COUNTED(X)                                                                                 \
  X("points", "", IF(!open, COUNT(refined ? strut_refinement_coarse(plan) : plan->points)),        \
    "of a map before it is refined", .label = {""})                                                \
  X("points", "", IF(open, COUNT(plan->points)), "at most, of a search or a fit",                  \
    .label = {"points at most"})                                                                   \
  X("most_points", "", IF(refined, COUNT(plan->points)), "of the finest grid", .label = {""})      \
  X("columns", "", ARRAY(plan->column_count, column_of), "of the table", .label = {""})
STRUT_VALUES(strut_sweep_count_values, COUNTED, const strut_sweep_plan *plan = of->at;
             bool refined = plan->study->refine.depth > 0;
             bool open = plan->study->search || plan->study->fit)

/* ---- how far it is ---- */

/* Ranges of missing points, and the failed ones, the first few of both. */
void strut_slots_progress_find(strut_slots *slots, strut_slots_progress *p) {
  const int64_t count = strut_slots_description_of(slots)->count;
  *p = (strut_slots_progress){.points = count,
                              .missing = strut_slots_missing(slots),
                              .failed = strut_slots_failed(slots),
                              .started = true};
  p->done = count - p->missing;
  for (int64_t i = 0; i < count && p->gap_count < STRUT_STATUS_GAPS; i++) {
    int64_t first = i;
    while (i < count && !strut_slots_done(slots, strut_slots_point(slots, i))) i++;
    if (i == first) continue;
    p->gaps[p->gap_count][0] = (double)strut_slots_point(slots, first);
    p->gaps[p->gap_count++][1] = (double)strut_slots_point(slots, i - 1);
  }
  for (int64_t i = 0; i < count && p->failed && p->failure_count < STRUT_STATUS_FAILURES; i++) {
    strut_result_slot row;
    const int64_t point = strut_slots_point(slots, i);
    if (!strut_slots_get(slots, point, &row) || row.status == STRUT_OK) continue;
    struct strut_failed_point *failure = &p->failures[p->failure_count++];
    failure->point = point, failure->status = row.status;
    snprintf(failure->message, sizeof failure->message, "%s", row.message ? row.message : "");
  }
}

#define FAILURE(X)                                                                                 \
  X("point", "", COUNT(f->point), "of the study", .label = {""})                                   \
  X("status", "", TEXT(strut_status_text(f->status)), "why", .label = {""})                        \
  X("message", "", TEXT(f->message), "a sentence", .label = {""})
STRUT_VALUES_HERE(failure_values, FAILURE, const struct strut_failed_point *f = of->at)

#define PROGRESS(X)                                                                                \
  X("done", "", COUNT(p->done), "of them, failed ones too", .label = {""})                         \
  X("missing", "", IF(p->started && !open, COUNT(p->missing)), "of them", .label = {""})           \
  X("failed", "", IF(p->started, COUNT(p->failed)), "of the done", .label = {""})
STRUT_VALUES_HERE(counted_values, PROGRESS, const strut_slots_progress *p = of->at;
                  bool open = p->searches || p->most_points)

/* "3, 7 to 9": the first ranges of missing points. */
static void write_gaps(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_slots_progress *progress = of->at;
  for (size_t i = 0, used = 0; i < progress->gap_count && used < STRUT_VALUE_ROOM; i++)
    used +=
        (size_t)snprintf(text + used, STRUT_VALUE_ROOM - used,
                         progress->gaps[i][0] < progress->gaps[i][1] ? "%s%.0f to %.0f" : "%s%.0f",
                         i ? ", " : "", progress->gaps[i][0], progress->gaps[i][1]);
}

#define STATUS(X)                                                                                  \
  X("points", "", COUNT(p->points), "of the file", .label = {""})                                  \
  X(NULL, "", SAME, "", .rows = &counted_values)                                                   \
  X("finished", "", IF(p->searches, FLAG(p->finished)), "whether the searches are", .label = {""}) \
  X("most_points", "", IF(p->most_points, COUNT(p->most_points)), "of the finest grid",            \
    .label = {""})                                                                                 \
  X("gaps", "", IF(!open, TABLE(p->gaps, p->gap_count, 2)), "first and last of missing points")    \
  X(NULL, "", IF(!open, WORDS(write_gaps)), "", .label = {"gaps"})                                 \
  X("failures", "", IF(!open, LIST(p->failures, p->failure_count)), "the first",                   \
    .rows = &failure_values, .label = {""})
STRUT_VALUES(strut_slots_progress_values, STATUS, const strut_slots_progress *p = of->at;
             bool open = p->searches || p->most_points)

/* ---- shards ---- */

strut_status strut_shards_progress_find(const char *directory, const strut_shards_found *found,
                                        strut_arena *arena, strut_shards_progress *progress,
                                        strut_error *error) {
  size_t count = (size_t)found->count;
  *progress =
      (strut_shards_progress){count, strut_arena_allocate(arena, count, sizeof *progress->shards)};
  if (!progress->shards) return strut_no_memory(error, "");
  for (size_t i = 0; i < count; i++) {
    strut_slots *slots = NULL;
    strut_slots_description plan;
    if (found->there[i]) {
      const char *path =
          strut_shard_path(directory, (strut_shard){(int64_t)i, found->count}, arena);
      strut_status status =
          path ? strut_slots_read(path, &slots, &plan, error) : strut_no_memory(error, "");
      if (status) return status;
      strut_slots_progress_find(slots, &progress->shards[i]);
      strut_slots_close(slots);
    }
    progress->shards[i].shard = (int64_t)i;
  }
  return STRUT_OK;
}

#define SHARD(X)                                                                                   \
  X("shard", "", COUNT(p->shard), "its number, from 0", .label = {""})                             \
  X("points", "", IF(p->started, COUNT(p->points)), "of it", .label = {""})                        \
  X(NULL, "", SAME, "", .rows = &counted_values)
STRUT_VALUES_HERE(shard_values, SHARD, const strut_slots_progress *p = of->at)

#define SHARDS(X)                                                                                  \
  X("shard_count", "", COUNT(s->count), "of the study")                                            \
  X("shards", "", LIST(s->shards, s->count), "one by one", .rows = &shard_values, .label = {""})
STRUT_VALUES(strut_shards_progress_values, SHARDS, const strut_shards_progress *s = of->at)

/* ---- the end ---- */

#define WARNING(X)                                                                                 \
  X("code", "", TEXT(warning->code), "for programs")                                               \
  X("runs", "", COUNT(warning->runs), "that it is about")                                          \
  X("point", "", COUNT(warning->point), "the first of them")                                       \
  X("text", "", TEXT(warning->text), "finding, likely cause and remedy")
STRUT_VALUES_HERE(warning_values, WARNING, const strut_sweep_warning *warning = of->at)

static void write_seconds(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  strut_duration_text(((const strut_sweep_end *)of->at)->state->seconds, text);
}

#define END(X)                                                                                     \
  X("points", "", COUNT(state->points), "of the table", .label = {""})                             \
  X("failed", "", COUNT(state->failed), "of them", .label = {""})                                  \
  X("computed", "", COUNT(state->computed), "of them, by this call", .label = {""})                \
  X(NULL, "", WORDS(write_seconds), "", .label = {"in"})                                           \
  X("table", "", TEXT(((const strut_sweep_end *)of->at)->table), "its path", .label = {""})        \
  X("warnings", "", LIST(state->warnings, state->warning_count), "of runs", .rows = &warning_values)
STRUT_VALUES(strut_sweep_end_values, END,
             const strut_sweep_state *state = ((const strut_sweep_end *)of->at)->state)
