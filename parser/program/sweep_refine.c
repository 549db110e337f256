/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Refined studies: what the files of all shards hold, their table, and maps of the finest grid. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/number_text.h"
#include "engine/study/results/study_table.h"
#include "engine/study/sweep/grid.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"

/* Are the files of the same study? */
static bool alike(const strut_slots_plan *a, const strut_slots_plan *b) {
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
      strut_slots_plan there;
      if (k == shard.index || found.count != shard.count || !found.there[k]) continue;
      const char *path = strut_shard_path(directory, (strut_shard){k, found.count}, &arena);
      if (!path || strut_slots_read(path, &slots, &there, NULL) != STRUT_OK) continue;
      if (alike(&there, strut_slots_plan_of(own))) strut_refinement_learn(refinement, slots);
      strut_slots_close(slots);
    }
  strut_arena_free(&arena);
}

/* Is it a column of this axis? */
static bool is_of_axis(const strut_study *study, size_t axis, const char *name) {
  for (size_t i = 0; name && i < study->axes[axis].column_count; i++)
    if (strcmp(study->axes[axis].columns[i].name, name) == 0) return true;
  return false;
}

bool strut_sweep_refine_shows(const strut_sweep_plan *plan, const strut_study_figure *f) {
  const strut_study *study = plan->study;
  const size_t *axes = study->refine_axes;
  return (is_of_axis(study, axes[0], f->x) && is_of_axis(study, axes[1], f->y)) ||
         (is_of_axis(study, axes[1], f->x) && is_of_axis(study, axes[0], f->y));
}

/* The row of each known point, + 1; 0: none. */
static uint32_t *find_rows(const strut_sweep_plan *plan, const strut_table *from,
                           strut_arena *arena) {
  uint32_t *row = strut_arena_allocate(arena, (size_t)plan->points, sizeof *row);
  for (size_t i = 0; row && i < from->row_count; i++) {
    double point = from->columns[0].value ? from->columns[0].value[i] : -1.0;
    if (point >= 0.0 && point < (double)plan->points) row[(size_t)point] = (uint32_t)i + 1;
  }
  return row;
}

/* Which value of a point is the column's; axis_columns: none of a refined axis. */
static size_t refined_value(const strut_sweep_plan *plan, const char *name) {
  const strut_study *study = plan->study;
  for (size_t i = 0; i < plan->axis_columns; i++) {
    size_t axis;
    const strut_study_column *c = strut_grid_column(study, i, &axis);
    bool refined = axis == study->refine_axes[0] || axis == study->refine_axes[1];
    if (refined && strcmp(c->name, name) == 0) return i;
  }
  return plan->axis_columns;
}

static bool make_column(strut_table *to, const strut_table_column *from, size_t rows, size_t i) {
  strut_table_column *c = &to->columns[i];
  c->name = from->name;
  c->unit = from->unit;
  c->text = strut_arena_allocate(&to->arena, rows, sizeof *c->text);
  if (from->value) c->value = strut_arena_allocate(&to->arena, rows, sizeof *c->value);
  return c->text && (!from->value || c->value);
}

/* Fills a row for `point` from the row `source` of `from`. */
static bool fill_row(const strut_sweep_plan *plan, const strut_table *from, size_t source,
                     const strut_study_value *values, strut_table *to) {
  size_t row = to->row_count++;
  for (size_t i = 0; i < from->column_count; i++) {
    const strut_table_column *c = &from->columns[i];
    const char **text = (const char **)to->columns[i].text;
    double *value = (double *)to->columns[i].value;
    size_t k = refined_value(plan, c->name);
    text[row] = c->text[source];
    if (value) value[row] = c->value[source];
    if (k == plan->axis_columns || !value) continue;
    char number[STRUT_NUMBER_TEXT];
    size_t length = strut_number_text(values[k].number, number);
    value[row] = values[k].number;
    text[row] = strut_arena_text(&to->arena, number, length);
    if (!text[row]) return false;
  }
  return true;
}

strut_status strut_sweep_refine_expand(const strut_sweep_plan *plan,
                                       const strut_refinement *refinement, const strut_table *from,
                                       strut_table *to, strut_error *error) {
  strut_arena arena = {0};
  size_t points = (size_t)plan->points;
  *to = (strut_table){0};
  uint32_t *row = find_rows(plan, from, &arena);
  strut_study_value *values = strut_arena_allocate(&arena, plan->axis_columns + 1, sizeof *values);
  to->columns = strut_arena_allocate(&to->arena, from->column_count, sizeof *to->columns);
  to->column_count = from->column_count;
  bool fine = row && values && to->columns;
  for (size_t i = 0; i < from->column_count && fine; i++)
    fine = make_column(to, &from->columns[i], points, i);
  for (int64_t point = 0; point < plan->points && fine; point++) {
    int64_t source = strut_refinement_stand_in(refinement, point);
    if (source < 0 || !row[source]) continue;
    strut_grid_values(plan->study, point, values);
    fine = fill_row(plan, from, row[source] - 1, values, to);
  }
  strut_arena_free(&arena);
  return fine ? STRUT_OK : strut_no_memory(error, "while drawing");
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
    strut_slots_plan there;
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
    else if (strut_slots_plan_of(slots[k])->points != study->plan.points ||
             memcmp(strut_slots_plan_of(slots[k])->hash, strut_slots_plan_of(slots[0])->hash,
                    STRUT_STUDY_HASH) != 0)
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
