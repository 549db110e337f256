/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Refined studies: what the files of all shards hold, and their table. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/study/results/study_table.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"

/* Are the files of the same study? */
static bool alike(const strut_slots_description *a, const strut_slots_description *b) {
  return a->points == b->points && a->column_count == b->column_count &&
         memcmp(a->hash, b->hash, sizeof a->hash) == 0;
}

void strut_sweep_refine_learn(strut_refinement *refinement, const char *directory,
                              strut_shard shard, strut_slots *own) {
  strut_shards_found found = {0};
  strut_arena arena = {0};
  strut_refinement_learn(refinement, own);
  if (shard.count && strut_shards_find(directory, &found, &arena, NULL) == STRUT_OK)
    for (int64_t k = 0; k < found.count; k++) {
      strut_slots *slots = NULL;
      strut_slots_description there;
      if (k == shard.index || found.count != shard.count || !found.there[k]) continue;
      const char *path = strut_shard_path(directory, (strut_shard){k, found.count}, &arena);
      if (!path || strut_slots_read(path, &slots, &there, NULL) != STRUT_OK) continue;
      if (alike(&there, strut_slots_description_of(own))) strut_refinement_learn(refinement, slots);
      strut_slots_close(slots);
    }
  strut_arena_free(&arena);
}

strut_status strut_sweep_refine_status(const strut_sweep_plan *plan, const char *directory,
                                       strut_slots *slots, bool json) {
  strut_refinement *r = NULL;
  strut_error error = {0};
  int64_t wanted, done;
  char text[300];
  strut_status status = strut_refinement_create(plan, &r, &error);
  if (status) return strut_print_failure(status, &error);
  strut_sweep_refine_learn(r, directory, (strut_shard){0}, slots);
  strut_refinement_choose(r);
  strut_refinement_count(r, slots, &wanted, &done);
  long long failed = (long long)strut_slots_failed(slots);
  snprintf(text, sizeof text,
           json ? "{\"points\": %lld, \"done\": %lld, \"failed\": %lld, \"most_points\": %lld}\n"
                : "%lld points wanted so far, %lld done, %lld failed; the finest grid has %lld\n",
           (long long)wanted, (long long)done, failed, (long long)plan->points);
  strut_refinement_free(r);
  return strut_print(text);
}

/* ---- shards ---- */

/* Opens the files of all shards; those that are missing stay NULL. */
static strut_slots **open_shards(const char *directory, const strut_shards_found *found,
                                 strut_arena *arena) {
  size_t count = found->count ? (size_t)found->count : 1;
  strut_slots **slots = strut_arena_allocate(arena, count, sizeof *slots);
  for (size_t k = 0; slots && k < count; k++) {
    strut_slots_description there;
    const char *path = strut_shard_path(directory, (strut_shard){(int64_t)k, found->count}, arena);
    if (path && (!found->count || found->there[k])) strut_slots_read(path, &slots[k], &there, NULL);
  }
  return slots;
}

/* bad: failed and inaccurate points. */
static strut_status merge_shards(const strut_sweep_study *study, const char *directory,
                                 strut_arena *arena, int64_t *rows, int64_t bad[2],
                                 strut_error *error) {
  strut_shards_found found = {0};
  strut_refinement *r = NULL;
  strut_status status = strut_shards_find(directory, &found, arena, error);
  strut_slots **slots = status ? NULL : open_shards(directory, &found, arena);
  size_t count = found.count ? (size_t)found.count : 1;
  if (!status && !slots) status = strut_no_memory(error, "");
  if (!status) status = strut_refinement_create(&study->plan, &r, error);
  for (size_t k = 0; k < count && !status; k++) {
    if (!slots[k])
      status = strut_fail(error, STRUT_FILE_TROUBLE, "shard %zu of %zu is missing", k, count);
    else if (strut_slots_description_of(slots[k])->points != study->plan.points ||
             memcmp(strut_slots_description_of(slots[k])->hash,
                    strut_slots_description_of(slots[0])->hash, STRUT_STUDY_HASH) != 0)
      status = strut_fail(error, STRUT_USAGE, "shard %zu of %zu is of another study", k, count);
    if (!status) strut_refinement_learn(r, slots[k]);
    if (!status) bad[0] += strut_slots_failed(slots[k]);
    if (!status) bad[1] += strut_slots_inaccurate(slots[k]);
  }
  int64_t unknown = status ? 0 : strut_refinement_choose(r);
  if (unknown)
    status = strut_fail(error, STRUT_FILE_TROUBLE,
                        "%lld points of the refinement are missing: run all shards again",
                        (long long)unknown);
  if (!status)
    status = strut_study_table_write_partial(directory, "table.csv", slots, count, rows, error);
  for (size_t k = 0; slots && k < count; k++) strut_slots_close(slots[k]);
  strut_refinement_free(r);
  return status;
}

strut_status strut_sweep_refine_merge(const strut_arguments *arguments, bool *merged) {
  strut_sweep_study study = {0};
  strut_arena arena = {0};
  strut_error error = {0};
  strut_arguments inner = *arguments;
  int64_t rows = 0, bad[2] = {0};
  const char *directory = arguments->model;
  inner.model = strut_arena_format(&arena, "%s/study.yaml", directory);
  *merged = false;
  if (!inner.model || access(inner.model, R_OK) != 0) {
    strut_arena_free(&arena);
    return STRUT_OK;
  }
  strut_status status = strut_study_open(inner.model, NULL, 0, &study.file, &error);
  *merged = !status && study.file.study.refine_depth > 0;
  if (!status && study.file.study.search) {
    *merged = true;
    strut_fail(&error, STRUT_USAGE,
               "'%s' has the results of a search, which are never in shards: 'strut sweep' writes "
               "their table",
               directory);
    status = strut_print_failure(STRUT_USAGE, &error);
    strut_study_close(&study.file);
    strut_arena_free(&arena);
    return status;
  }
  strut_study_close(&study.file);
  error = (strut_error){0};
  if (*merged) status = strut_sweep_study_open(&inner, &study);
  if (*merged && !status)
    status =
        strut_print_failure(merge_shards(&study, directory, &arena, &rows, bad, &error), &error);
  if (*merged && !status && !arguments->quiet)
    printf("%s/table.csv: %lld points\n", directory, (long long)rows);
  if (*merged && !status) status = strut_sweep_judge(rows, bad[0], bad[1]);
  if (*merged) strut_sweep_study_close(&study);
  strut_arena_free(&arena);
  return status;
}
