/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The branches of all points as one table, as one JSON text, and as people read them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/buffer.h"
#include "engine/output/file.h"
#include "engine/output/json_value.h"
#include "engine/output/result_values.h"
#include "engine/study/follow/follow_parts.h"
#include "engine/study/results/slots_parts.h"

enum { MOST_BLOCK = 1 << 28 };

bool strut_follow_axes(const strut_sweep_plan *plan, const strut_study_value *values,
                       strut_arena *arena, const char *before[2]) {
  strut_buffer names = {0}, cells = {0};
  for (size_t i = 0; i < plan->axis_columns; i++) {
    strut_study_table_add_name(&names, &plan->columns[i]);
    if (values[i].word)
      strut_csv_add_text(&cells, "%s", values[i].word);
    else
      strut_csv_add_number(&cells, isfinite(values[i].number) ? values[i].number : (double)NAN);
    strut_buffer_add(&cells, ",");
  }
  bool fine = !names.failed && !cells.failed;
  before[0] = fine ? strut_arena_format(arena, "%s", names.text ? names.text : "") : NULL;
  before[1] = fine ? strut_arena_format(arena, "%s", cells.text ? cells.text : "") : NULL;
  strut_release(names.text);
  strut_release(cells.text);
  return before[0] && before[1];
}

/* The text of a point's file, in the arena; NULL where there is none, or no memory. */
static char *read_branches(const char *directory, int64_t point, const char *ending,
                           strut_arena *arena) {
  const char *path =
      strut_arena_format(arena, "%s/branches/%09lld%s", directory, (long long)point, ending);
  FILE *file = path ? fopen(path, "rb") : NULL;
  char *text = NULL;
  if (file && fseek(file, 0, SEEK_END) == 0) {
    long size = ftell(file);
    rewind(file);
    if (size >= 0 && size < MOST_BLOCK) text = strut_arena_allocate(arena, (size_t)size + 1, 1);
    if (text && fread(text, 1, (size_t)size, file) != (size_t)size) text = NULL;
  }
  if (file) fclose(file);
  return text;
}

static strut_status report_missing(int64_t point, strut_error *error) {
  return strut_fail(error, STRUT_FILE_TROUBLE,
                    "the branches of point %lld are missing below 'branches': remove points.slots "
                    "to compute all points again",
                    (long long)point);
}

/* ---- branches.csv ---- */

/* Headers of the table: those of the axes and of the branches. */
static strut_status write_header(FILE *to, const strut_sweep_plan *plan, bool partial,
                                 strut_arena *arena, strut_error *error) {
  const strut_study_follow *follow = plan->study->follow;
  strut_follow_result *none = strut_arena_allocate(arena, 1, sizeof *none);
  const strut_study_value *values =
      strut_arena_allocate(arena, plan->axis_columns + 1, sizeof *values);
  const char *before[2];
  if (!none || !values || !strut_follow_axes(plan, values, arena, before))
    return strut_no_memory(error, "");
  before[1] = "";
  none->name = strut_arena_format(arena, "%s", follow->over);
  none->unit = strut_arena_format(arena, "%s", follow->unit);
  char *header = none->name && none->unit
                     ? strut_values_csv(&strut_follow_values, "branches.points", before, none, NULL)
                     : NULL;
  if (!header) return strut_no_memory(error, "");
  fprintf(to, "%.*s%s\n", (int)strcspn(header, "\n"), header, partial ? ",finished" : "");
  strut_release(header);
  return STRUT_OK;
}

/* Copies the rows of a point's file; returns how many. */
static int64_t copy_rows(FILE *to, const char *text, const char *finished) {
  int64_t rows = 0;
  const char *line = strchr(text, '\n');
  for (line = line ? line + 1 : ""; *line; rows++) {
    size_t length = strcspn(line, "\n");
    fwrite(line, 1, length, to);
    fprintf(to, "%s\n", finished);
    line += length + (line[length] == '\n');
  }
  return rows;
}

strut_status strut_follow_points_combine(const strut_sweep_plan *plan, strut_slots *slots,
                                         const char *directory, const char *name, bool partial,
                                         int64_t *rows, strut_error *error) {
  strut_file file = {0};
  strut_arena arena = {0};
  int64_t count = 0;
  strut_status status = strut_file_open(&file, directory, name, error);
  if (!status) status = write_header(file.stream, plan, partial, &arena, error);
  for (int64_t point = 0; point < plan->points && !status; point++) {
    strut_result_slot row;
    strut_arena_free(&arena);
    bool done = strut_slots_get(slots, point, &row);
    if (done && row.status) continue;
    char *text = read_branches(directory, point, done ? ".csv" : "-partial.csv", &arena);
    if (text)
      count += copy_rows(file.stream, text, partial ? done ? ",yes" : ",no" : "");
    else if (done)
      status = report_missing(point, error);
  }
  if (!status)
    status = strut_file_commit(&file, error);
  else
    strut_file_abandon(&file);
  strut_arena_free(&arena);
  if (rows) *rows = count;
  return status;
}

/* ---- report.json ---- */

typedef strut_follow_points_rows point_rows;

static const char *cell_name(const strut_result_object *of, size_t i) {
  return ((const point_rows *)of->outer->at)->plan->columns[i].name;
}

/* A cell of the point's row. */
static strut_value cell_value(const strut_result_object *of, size_t i) {
  const point_rows *rows = of->outer->at;
  strut_result_slot row;
  return strut_slots_get(rows->slots, (int64_t)of->index, &row)
             ? strut_slot_value(rows->plan->columns, &row, i)
             : STRUT_VALUE_AS_TEXT(NULL);
}

static const char *result_name(const strut_result_object *of, size_t i) {
  return cell_name(of, i + ((const point_rows *)of->outer->at)->plan->axis_columns);
}

static strut_value result_value(const strut_result_object *of, size_t i) {
  return cell_value(of, i + ((const point_rows *)of->outer->at)->plan->axis_columns);
}

#define ROW(X)                                                                                     \
  X("point", "", COUNT(of->index), "its number", .label = {""})                                    \
  X("status", "", TEXT(strut_status_text(row.status)), "completed, or why it failed")              \
  X("message", "", TEXT(row.message &&*row.message ? row.message : NULL), "of a failed point")     \
  X("axes", "", MAP(axes, cell_name, cell_value), "their values", .label = {""})                   \
  X(NULL, "", MAP(rows->plan->column_count - axes, result_name, result_value), "", .label = {""})  \
  X(NULL, "", TEXT(row.status ? row.message : NULL), "", .label = {"message"})
STRUT_VALUES_HERE(row_values, ROW, const point_rows *rows = of->outer->at;
                  size_t axes = rows->plan->axis_columns; strut_result_slot row = {.status = 0};
                  strut_slots_get(rows->slots, (int64_t)of->index, &row))

static bool has_row(const strut_result_object *of, size_t i) {
  return strut_slots_done(((const point_rows *)of->at)->slots, (int64_t)i);
}

static strut_value rows_of(const point_rows *rows) {
  strut_value list = STRUT_VALUE_AS_LIST_WHERE((const char *)rows, rows->plan->points, has_row);
  list.size = 0;
  return list;
}

#define POINTS(X) X(NULL, "", BY(rows_of(of->at)), "", .rows = &row_values, .label = {"points"})
STRUT_VALUES(strut_follow_points_values, POINTS, )

strut_status strut_follow_points_json(const strut_sweep_plan *plan, strut_slots *slots,
                                      const char *directory, char **text, strut_error *error) {
  const strut_study_follow *follow = plan->study->follow;
  strut_arena arena = {0};
  strut_json json = strut_json_begin();
  strut_status status = STRUT_OK;
  const point_rows rows = {plan, slots};
  const strut_result_object whole = {&rows, NULL, NULL, 0};
  strut_json_text(&json, json.root, "study", plan->study->name);
  strut_json_text(&json, json.root, "over", follow->over);
  strut_json_number(&json, json.root, "from", follow->from);
  strut_json_number(&json, json.root, "to", follow->to);
  struct cJSON *points = strut_json_array(&json, json.root, "points");
  for (int64_t point = 0; point < plan->points && !status; point++) {
    strut_result_slot row;
    if (!strut_slots_get(slots, point, &row)) continue;
    struct cJSON *item = strut_json_object(&json, points, NULL);
    strut_json_values(&json, item, &row_values,
                      &(strut_result_object){&rows, &whole, NULL, (size_t)point});
    if (row.status) continue;
    strut_arena_free(&arena);
    char *own = read_branches(directory, point, ".json", &arena);
    if (!own)
      status = report_missing(point, error);
    else
      strut_json_raw(&json, item, "result", own);
  }
  strut_arena_free(&arena);
  *text = strut_json_end(&json);
  if (!status && !*text) status = strut_no_memory(error, "");
  if (status) {
    strut_release(*text);
    *text = NULL;
  }
  return status;
}
