/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The points of a study that follows motions, side by side. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/follow/follow_parts.h"

#include "engine/output/file.h"
#include "engine/run/simulate.h"
#include "engine/study/results/slots_parts.h"
#include "engine/study/sweep/sweep_parts.h"

/* Columns of a row: X(name, unit, value); unit "over": that of the followed parameter. */
#define ROW_TABLE(X)                                                                               \
  X("branches", "1", (double)c->branches)                                                          \
  X("branch_points", "1", (double)c->points)                                                       \
  X("folds", "1", (double)c->kinds[STRUT_FOLLOW_FOLD])                                             \
  X("period_doublings", "1", (double)c->kinds[STRUT_FOLLOW_DOUBLING])                              \
  X("tori", "1", (double)c->kinds[STRUT_FOLLOW_TORUS])                                             \
  X("branchings", "1", (double)c->kinds[STRUT_FOLLOW_BRANCHING])                                   \
  X("events", "1", (double)c->events)                                                              \
  X("velocity_max", "m/s", c->high.velocity)                                                       \
  X("velocity_max_at", "over", c->high.at)                                                         \
  X("velocity_min", "m/s", c->low.velocity)                                                        \
  X("velocity_min_at", "over", c->low.at)                                                          \
  X("amplitude_max", "m", c->wide.velocity)                                                        \
  X("amplitude_max_at", "over", c->wide.at)

static const struct {
  const char *name, *unit;
} row_columns[] = {
#define ROW_COLUMN(name, unit, value) {name, unit},
    ROW_TABLE(ROW_COLUMN)};
enum { ROW_COLUMNS = sizeof row_columns / sizeof row_columns[0] };

/* An extreme value of the stable motions, and where; NAN: none. */
typedef struct extreme {
  double velocity, at;
} extreme;

/* What a point's branches come to. */
typedef struct counts {
  size_t branches, points, events, kinds[STRUT_FOLLOW_KINDS];
  extreme high, low, wide;
} counts;

/* A point of the study, and what is made of it. */
typedef struct point_work {
  const strut_sweep_plan *plan;
  const strut_follow_points *points;
  const strut_sweep_options *options;
  int64_t point;
  strut_study_value *values;
  strut_follow_result *result;
  strut_arena *arena;
  strut_error error;
} point_work;

strut_status strut_follow_points_columns(strut_sweep_plan *plan, strut_error *error) {
  const strut_study_follow *follow = plan->study->follow;
  for (size_t i = 0; i < ROW_COLUMNS; i++) {
    const char *unit = row_columns[i].unit;
    if (strcmp(unit, "over") == 0) unit = *follow->unit ? follow->unit : "1";
    if (!strut_sweep_add_column(plan, "", row_columns[i].name, unit, false))
      return strut_no_memory(error, "");
  }
  return STRUT_OK;
}

/* ---- what is followed at a point ---- */

static strut_status setup_at(void *context, const double value[2], strut_setup *setup,
                             strut_error *error) {
  const point_work *self = context;
  return self->points->setup(self->points->context, self->values, value[0], setup, error);
}

static double own_value(const strut_study_follow *follow, const strut_scene *scene) {
  const strut_parameter *own = strut_parameter_named(scene, follow->over);
  bool within = own && own->value >= follow->from && own->value <= follow->to;
  return within ? own->value : 0.5 * (follow->from + follow->to);
}

/* Every value of `at` from every configuration. */
static strut_status make_starts(point_work *self, strut_follow_options *options) {
  const strut_study_follow *follow = self->plan->study->follow;
  size_t values = follow->at_count ? follow->at_count : 1,
         names = follow->start_count ? follow->start_count : 1;
  double own = (double)NAN;
  strut_setup setup;
  strut_follow_start *starts = strut_arena_allocate(self->arena, values * names, sizeof *starts);
  if (!starts) return strut_no_memory(&self->error, "");
  if (!follow->at_count) {
    strut_status status =
        self->plan->scenes.setup(self->plan->scenes.context, self->values, &setup, &self->error);
    if (status) return status;
    own = own_value(follow, &setup.scene);
    strut_setup_free(&setup);
  }
  for (size_t v = 0; v < values; v++)
    for (size_t k = 0; k < names; k++)
      starts[options->start_count++] =
          (strut_follow_start){follow->at_count ? follow->at[v] : own,
                               follow->start_count ? follow->start_from[k] : NULL};
  options->starts = starts;
  return STRUT_OK;
}

static strut_status follow_point(point_work *self, int threads) {
  const strut_study_follow *follow = self->plan->study->follow;
  strut_follow_options o = {.name = follow->over,
                            .unit = follow->unit,
                            .low = follow->from,
                            .high = follow->to,
                            .scenes = {setup_at, self},
                            .method = follow->integrator,
                            .accuracy = follow->accuracy,
                            .steps = follow->steps,
                            .basins = follow->basins,
                            .threads = threads,
                            .interrupt = self->options->interrupt};
  strut_status status = make_starts(self, &o);
  return status ? status : strut_follow_make(&o, self->result, &self->error);
}

strut_status strut_follow_points_check(const strut_sweep_plan *plan,
                                       const strut_follow_points *points, strut_error *error) {
  const strut_study_follow *follow = plan->study->follow;
  strut_study_value *values = strut_allocate(plan->axis_columns + 1, sizeof *values);
  point_work w = {.plan = plan, .points = points, .values = values};
  const strut_follow_options o = {.scenes = {setup_at, &w},
                                  .low = follow->from,
                                  .high = follow->to,
                                  .method = follow->integrator,
                                  .accuracy = follow->accuracy};
  if (!values) return strut_no_memory(error, "");
  strut_grid_values(plan->study, 0, values);
  strut_status status = strut_follow_possible(&o, error);
  if (status == STRUT_USAGE) status = STRUT_BAD_SCENE;
  strut_release(values);
  return status;
}

/* ---- the row and the files of a point ---- */

static void take_extreme(extreme *self, double value, double at, bool larger) {
  if (!isnan(self->velocity) && !(larger ? value > self->velocity : value < self->velocity)) return;
  *self = (extreme){value, at};
}

static counts count_branches(const strut_follow_result *result) {
  const extreme none = {(double)NAN, (double)NAN};
  counts c = {.branches = result->count, .high = none, .low = none, .wide = none};
  for (size_t i = 0; i < result->count; i++) {
    const strut_follow_branch *branch = &result->branches[i].branch;
    for (size_t k = 0; k < branch->count; k++) {
      const strut_follow_point *point = &branch->points[k];
      c.points++;
      c.kinds[point->kind]++;
      c.events += point->kind > STRUT_FOLLOW_TORUS;
      if (point->stable && branch->travels)
        take_extreme(&c.high, point->velocity, point->at.value[0], true);
      if (point->stable && branch->travels)
        take_extreme(&c.low, point->velocity, point->at.value[0], false);
      if (point->stable && !branch->travels)
        take_extreme(&c.wide, point->amplitude, point->at.value[0], true);
    }
  }
  return c;
}

/* Headers and cells of the axes at their values as CSV, each with a comma behind it, in the arena. */
static bool list_axes(const strut_sweep_plan *plan, const strut_study_value *values,
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

static strut_status write_branches(point_work *self, bool partial) {
  const char *before[2]; /* headers and cells of the axes */
  char csv[64], json[64];
  const char *folder = strut_arena_format(self->arena, "%s/branches", self->options->directory);
  if (!folder || !list_axes(self->plan, self->values, self->arena, before))
    return strut_no_memory(&self->error, "");
  snprintf(csv, sizeof csv, "%09lld%s.csv", (long long)self->point, partial ? "-partial" : "");
  snprintf(json, sizeof json, "%09lld.json", (long long)self->point);
  strut_status status = strut_directory_create(folder, &self->error);
  if (!status)
    status = strut_file_write_block(
        folder, csv,
        strut_values_csv(&strut_follow_values, "branches.points", before, self->result, NULL),
        &self->error);
  if (status || partial) return status;
  status = strut_file_write_block(
      folder, json, strut_values_json(&strut_follow_values, self->result, NULL), &self->error);
  snprintf(csv, sizeof csv, "%09lld-partial.csv", (long long)self->point);
  if (!status) strut_file_remove(folder, csv);
  return status;
}

static void fill_row(const point_work *self, strut_status status, strut_row_buffer *cells) {
  strut_sweep_axes(self->plan, self->values, cells);
  const counts all = count_branches(self->result), *c = &all;
  const double values[] = {
#define ROW_VALUE(name, unit, value) value,
      ROW_TABLE(ROW_VALUE)};
  for (size_t i = 0; i < ROW_COLUMNS; i++)
    strut_sweep_number(cells, status ? (double)NAN : values[i]);
  strut_sweep_end_row(cells, status, status ? &self->error : &(strut_error){0});
}

/* ---- all points ---- */

static strut_status follow_into(point_work *self, strut_row_buffer *cells, int threads) {
  strut_status status = follow_point(self, threads);
  bool partial = status == STRUT_INTERRUPTED && self->result->count > 0;
  if (!status || partial) {
    strut_status written;
#ifdef _OPENMP
#pragma omp critical(strut_follow_points_files) /* the folder keeps one list of its files */
#endif
    written = write_branches(self, partial);
    if (written) return written;
  }
  if (strut_sweep_stops(status)) return status;
  fill_row(self, status, cells);
  return STRUT_OK;
}

/* All points. */
typedef struct all_points {
  const strut_sweep_plan *plan;
  const strut_follow_points *points;
  const strut_sweep_options *options;
  int inner; /* threads of a point */
} all_points;

static void compute_point(void *context, strut_sweep_job *job, int64_t point) {
  const all_points *all = context;
  strut_arena arena = {0};
  point_work w = {.plan = all->plan,
                  .points = all->points,
                  .options = all->options,
                  .point = point,
                  .values = job->cells.values,
                  .result = strut_allocate(1, sizeof *w.result),
                  .arena = &arena};
  job->point = point;
  job->cells.number_count = job->cells.word_count = 0;
  job->status = w.result ? STRUT_OK : strut_no_memory(&w.error, "");
  if (!job->status) {
    strut_grid_values(all->plan->study, point, w.values);
    job->status = follow_into(&w, &job->cells, all->inner);
  }
  job->error = w.error;
  if (w.result) strut_follow_free(w.result);
  strut_release(w.result);
  strut_arena_free(&arena);
}

strut_status strut_follow_points_run(const strut_sweep_plan *plan, strut_slots *slots,
                                     const strut_follow_points *points,
                                     const strut_sweep_options *options, strut_sweep_state *state,
                                     strut_error *error) {
  int threads = options->threads > 0 ? options->threads : strut_sweep_threads();
  int64_t missing = strut_slots_missing(slots);
  bool side = threads > 1 && missing > 1; /* points go, else the columns of derivatives */
  all_points all = {plan, points, options, side ? 1 : threads};
  strut_sweep_options how = *options;
  how.threads = !side ? 1 : missing < threads ? (int)missing : threads;
  how.compute = compute_point, how.compute_context = &all;
  how.nested = !side;
  return strut_sweep_run(plan, slots, &how, state, error);
}

/* The branches of all points as one table, as one JSON text, and as people read them. */

enum { MOST_BLOCK = 1 << 28 };

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
  if (!none || !values || !list_axes(plan, values, arena, before))
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
