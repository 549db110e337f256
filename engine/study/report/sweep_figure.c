/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a study's table or of its recorded runs. */
#include "engine/study/report/study_report.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/sweep/grid.h"
#include "engine/study/sweep/study_runs.h"

static const double PAGE = 510.24; /* 180 mm [pt] */

static bool of_runs(const strut_study_figure *f) {
  return f->kind >= STRUT_FIGURE_MOTION && f->kind <= STRUT_FIGURE_SNAPSHOTS;
}

static bool of_search(const strut_study_figure *f) { return f->kind >= STRUT_FIGURE_BEST; }

/* ---- maps of the finest grid ---- */

/* Is it a column of this axis? */
static bool is_of_axis(const strut_study *study, size_t axis, const char *name) {
  for (size_t i = 0; name && i < study->axes[axis].column_count; i++)
    if (strcmp(study->axes[axis].columns[i].name, name) == 0) return true;
  return false;
}

/* Does the figure show the two axes that are refined? */
static bool shows_refined_axes(const strut_sweep_plan *plan, const strut_study_figure *f) {
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

/*
 * The table of all points of the finest grid, in an arena of its own: points that were not computed have
 * the row of the known one nearest to them, `from` being the table of these.
 */
static strut_status expand_refined(const strut_sweep_plan *plan, const strut_refinement *refinement,
                                   const strut_table *from, strut_table *to, strut_error *error) {
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

/* ---- figures ---- */

static int column_of(const strut_table *table, const char *name) {
  for (size_t i = 0; name && i < table->column_count; i++)
    if (strcmp(table->columns[i].name, name) == 0) return (int)i;
  return STRUT_NO_COLUMN;
}

/* COLUMN=TEXT. */
static int column_of_match(const strut_table *table, const char *match, const char **text) {
  size_t length = match ? strcspn(match, "=") : 0;
  for (size_t i = 0; match && i < table->column_count; i++) {
    const char *name = table->columns[i].name;
    if (strlen(name) != length || memcmp(name, match, length) != 0) continue;
    *text = match + length + 1;
    return (int)i;
  }
  return STRUT_NO_COLUMN;
}

static strut_axis_choice axis_of(const char *label, const double limits[2]) {
  return (strut_axis_choice){label, limits[0] < limits[1], limits[0], limits[1]};
}

static strut_status draw_table(const strut_study_figure *f, const char *path,
                               const strut_table *table, strut_error *error) {
  strut_table_choice choice = {.difference = column_of(table, f->difference)};
  choice.only = column_of_match(table, f->only, &choice.only_value);
  if (f->kind == STRUT_FIGURE_MAP) {
    const strut_table_map_figure map = {.title = f->title,
                                        .width = PAGE,
                                        .x = column_of(table, f->x),
                                        .y = column_of(table, f->y),
                                        .value = column_of(table, f->color),
                                        .x_axis = axis_of(f->x_label, f->x_limits),
                                        .y_axis = axis_of(f->y_label, f->y_limits),
                                        .colours = (strut_colours)f->colours,
                                        .panels = column_of(table, f->panels),
                                        .doubt = column_of(table, "flips"),
                                        .choice = choice};
    return strut_table_map(path, &map, table, error);
  }
  strut_table_figure lines = {.title = f->title,
                              .width = PAGE,
                              .x = column_of(table, f->x),
                              .y = {column_of(table, f->y)},
                              .y_count = 1,
                              .x_axis = axis_of(f->x_label, f->x_limits),
                              .y_axis = axis_of(f->y_label, f->y_limits),
                              .by = column_of(table, f->series),
                              .panels = column_of(table, f->panels),
                              .choice = choice,
                              .between = f->kind == STRUT_FIGURE_MOTION};
  lines.band = column_of_match(table, f->band, &lines.band_value);
  return strut_table_curves(path, &lines, table, error);
}

static strut_status draw_motion(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *f, const char *path, strut_error *error) {
  strut_table motion = {0};
  strut_status status = strut_study_motion(plan, directory, f, &motion, error);
  if (!status) status = draw_table(f, path, &motion, error);
  strut_arena_free(&motion.arena);
  return status;
}

/* A map of the finest grid. */
static strut_status draw_refined(const strut_sweep_plan *plan, const strut_study_figure *f,
                                 const char *path, const strut_table *table,
                                 const strut_refinement *refinement, strut_error *error) {
  strut_table fine = {0};
  strut_status status = expand_refined(plan, refinement, table, &fine, error);
  if (!status) status = draw_table(f, path, &fine, error);
  strut_arena_free(&fine.arena);
  return status;
}

strut_status strut_sweep_figure(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *f, const strut_table *table,
                                const strut_refinement *refinement, strut_error *error) {
  strut_arena arena = {0};
  const char *file = strut_arena_format(&arena, "%s/%s.svg", directory, f->name);
  strut_status status = STRUT_OK;
  if (!file)
    status = strut_no_memory(error, "");
  else if (f->kind == STRUT_FIGURE_MOTION)
    status = draw_motion(plan, directory, f, file, error);
  else if (of_search(f))
    status = strut_search_figure(plan, f, file, table, PAGE, error);
  else if (of_runs(f))
    status = strut_study_pictures(plan, directory, f, PAGE, error);
  else if (refinement && f->kind == STRUT_FIGURE_MAP && shows_refined_axes(plan, f))
    status = draw_refined(plan, f, file, table, refinement, error);
  else
    status = draw_table(f, file, table, error);
  strut_arena_free(&arena);
  return status;
}
