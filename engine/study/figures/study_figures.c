/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a study's table or of its recorded runs. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/compare/compare.h"
#include "engine/study/report/study_report.h"
#include "engine/study/sweep/sweep.h"

static const double PAGE = 510.24; /* 180 mm [pt] */

static int column_of(const strut_table *table, const char *name) {
  return strut_table_column_of(table, name, name ? strlen(name) : 0);
}

void strut_sweep_show_units(const strut_sweep_plan *plan, strut_table *table) {
  for (size_t k = 0; k < strut_grid_columns(plan->study); k++) {
    const strut_study_column *of = strut_grid_column(plan->study, k, NULL);
    int column = column_of(table, of->name);
    if (column >= 0) table->columns[column].shown = of->shown;
  }
}

static strut_axis_choice axis_of(const char *label, const double limits[2]) {
  return (strut_axis_choice){label, limits[0] < limits[1], limits[0], limits[1]};
}

static strut_plot plot_of(const strut_study_figure *figure, const char *path) {
  return (strut_plot){.path = path,
                      .title = figure->title,
                      .x = axis_of(figure->x_label, figure->x_limits),
                      .y = axis_of(figure->y_label, figure->y_limits)};
}

static strut_status draw_motion(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, const char *path,
                                strut_error *error) {
  strut_table motion = {0};
  strut_status status = strut_study_motion(plan, directory, figure, &motion, error);
  strut_sweep_show_units(plan, &motion);
  const strut_plot plot = plot_of(figure, path);
  if (!status) status = strut_table_draw(&plot, figure, &motion, (strut_table_marks){0}, error);
  strut_arena_free(&motion.arena);
  return status;
}

/* Figures of a search: its best objective over evaluations, and its points over two variables, its best point. */

static const char BEST[] = "best so far"; /* a column */

/* What a row of the table means to a search. */
typedef struct tracker {
  const strut_study_search *search;
  const strut_table *table;
  int number, evaluation, objective, second, violation; /* columns */
  size_t outer; /* columns of the axes before the searches */
} tracker;

static double value_at(const tracker *self, int column, size_t row) {
  const double *value = column >= 0 ? self->table->columns[column].value : NULL;
  return value ? value[row] : (double)NAN;
}

static bool same_text(const tracker *self, size_t column, size_t a, size_t b) {
  const char *const *text = self->table->columns[column].text;
  return text && text[a] && text[b]
             ? strcmp(text[a], text[b]) == 0
             : value_at(self, (int)column, a) == value_at(self, (int)column, b);
}

/* Are both rows of one search, or even of one evaluation? Column 0 is the point. */
static bool same_search(const tracker *self, size_t a, size_t b) {
  bool same = value_at(self, self->number, a) == value_at(self, self->number, b);
  for (size_t i = 1; i <= self->outer && same; i++) same = same_text(self, i, a, b);
  return same;
}

static bool same_evaluation(const tracker *self, size_t a, size_t b) {
  return same_search(self, a, b) &&
         value_at(self, self->evaluation, a) == value_at(self, self->evaluation, b);
}

/* The worst of the scenarios from `row` on, NAN where a condition is broken; *next: the row behind. */
static double judge(const tracker *self, int column, size_t row, size_t *next) {
  double worst = value_at(self, column, row);
  bool broken = false;
  size_t i = row;
  for (; i < self->table->row_count && same_evaluation(self, row, i); i++) {
    double value = value_at(self, column, i);
    bool worse = self->search->maximise ? value < worst : value > worst;
    if (worse || isnan(value)) worst = value;
    broken = broken || isnan(value) || value_at(self, self->violation, i) > 0.0;
  }
  *next = i;
  return broken ? (double)NAN : worst;
}

static tracker track(const strut_sweep_plan *plan, const strut_table *table) {
  tracker t = {.search = plan->study->search,
               .table = table,
               .number = column_of(table, "search"),
               .evaluation = column_of(table, "evaluation"),
               .objective = column_of(table, "objective"),
               .second = column_of(table, "objective_2"),
               .violation = column_of(table, "violation")};
  for (size_t i = 0; i < t.search->axis; i++) t.outer += plan->study->axes[i].column_count;
  return t;
}

/* Fills the best objective so far, in each row of a search, and marks the row of the best of each. */
static void follow(const tracker *self, double *best, bool *shown, bool *marked) {
  double so_far = (double)NAN;
  size_t at = 0, next = 0;
  bool any = false;
  for (size_t row = 0; row < self->table->row_count; row = next) {
    bool begins = row == 0 || !same_search(self, row - 1, row);
    if (begins && any) marked[at] = true;
    if (begins) so_far = (double)NAN, any = false;
    double value = judge(self, self->objective, row, &next);
    bool proper = value_at(self, self->number, row) > 0.0;
    if (proper && isfinite(value) &&
        (isnan(so_far) || (self->search->maximise ? value > so_far : value < so_far)))
      so_far = value, at = row, any = true;
    for (size_t i = row; i < next; i++) {
      best[i] = proper ? so_far : (double)NAN;
      shown[i] = proper && i == row;
    }
  }
  if (any) marked[at] = true;
}

/* Marks the points that no other of the same axes beats in both goals. */
static bool mark_front(const tracker *self, const bool *shown, bool *marked, strut_arena *arena) {
  size_t rows = self->table->row_count, next;
  double sign = self->search->maximise ? -1.0 : 1.0;
  double(*goal)[2] = strut_arena_allocate(arena, rows, sizeof *goal);
  for (size_t i = 0; goal && i < rows; i++) {
    marked[i] = false;
    if (!shown[i]) continue;
    goal[i][0] = sign * judge(self, self->objective, i, &next);
    goal[i][1] = sign * judge(self, self->second, i, &next);
    marked[i] = !isnan(goal[i][0]) && !isnan(goal[i][1]);
  }
  for (size_t i = 0; goal && i < rows; i++)
    for (size_t k = 0; k < rows && marked[i]; k++) {
      bool same = shown[k];
      for (size_t c = 1; c <= self->outer && same; c++) same = same_text(self, c, i, k);
      bool better = same && goal[k][0] <= goal[i][0] && goal[k][1] <= goal[i][1] &&
                    (goal[k][0] < goal[i][0] || goal[k][1] < goal[i][1]);
      if (better) marked[i] = false;
    }
  return goal != NULL;
}

/* The table with a further column. */
static strut_status extend(const strut_table *from, const double *best, const char *unit,
                           strut_table *to, strut_error *error) {
  to->row_count = from->row_count;
  to->column_count = from->column_count + 1;
  to->columns = strut_arena_allocate(&to->arena, to->column_count, sizeof *to->columns);
  if (!to->columns) return strut_no_memory(error, "while drawing");
  memcpy(to->columns, from->columns, from->column_count * sizeof *to->columns);
  to->columns[from->column_count] = (strut_table_column){.name = BEST, .unit = unit, .value = best};
  return STRUT_OK;
}

static strut_status draw_search(const strut_sweep_plan *plan, const strut_study_figure *f,
                                const char *path, const strut_table *table, strut_error *error) {
  const tracker t = track(plan, table);
  strut_table own = {0};
  strut_plot plot = plot_of(f, path);
  strut_study_figure figure = *f; /* points over two variables, the best ringed; else: */
  size_t rows = table->row_count;
  double *best = strut_arena_allocate(&own.arena, rows, sizeof *best);
  bool *shown = strut_arena_allocate(&own.arena, rows, sizeof *shown);
  bool *marked = strut_arena_allocate(&own.arena, rows, sizeof *marked);
  const char *unit = t.search->goal.program.unit;
  bool fine = best && shown && marked;
  if (fine) follow(&t, best, shown, marked);
  if (fine && t.second >= 0) fine = mark_front(&t, shown, marked, &own.arena);
  strut_status status = fine ? extend(table, best, strcmp(unit, "1") == 0 ? "" : unit, &own, error)
                             : strut_no_memory(error, "while drawing");
  if (!figure.color) figure.color = "objective";
  if (f->kind == STRUT_FIGURE_BEST) {
    figure.x = "evaluation", figure.y = BEST;
    if (!figure.series && t.search->starts > 1) figure.series = "search";
    if (!plot.y.label) plot.y.label = t.search->goal.text;
  }
  if (!status)
    status = strut_table_draw(&plot, &figure, &own,
                              (strut_table_marks){.shown = shown, .marked = marked}, error);
  strut_arena_free(&own.arena);
  return status;
}

strut_status strut_sweep_figure(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, const strut_table *table,
                                const strut_refinement *refinement, strut_error *error) {
  strut_arena arena = {0};
  const char *file = strut_arena_format(&arena, "%s/%s.svg", directory, figure->name);
  const strut_plot plot = plot_of(figure, file);
  strut_status status = STRUT_OK;
  if (!file)
    status = strut_no_memory(error, "");
  else if (figure->kind == STRUT_FIGURE_MOTION)
    status = draw_motion(plan, directory, figure, file, error);
  else if (strut_figure_of_search(figure))
    status = draw_search(plan, figure, file, table, error);
  else if (strut_figure_of_runs(figure))
    status = strut_study_pictures(plan, directory, figure, PAGE, error);
  else
    status = strut_table_draw(&plot, figure, table,
                              (strut_table_marks){.spread = refinement != NULL}, error);
  strut_arena_free(&arena);
  return status;
}

/* ---- the best point beside its start, with the numbers of `strut compare` ---- */

/* The scene of the best point, or of the start with the same axes and scenario. */
static strut_status set_up(const strut_sweep_plan *plan, const strut_search_point *best, bool start,
                           strut_setup *setup, strut_error *error) {
  strut_study_value *values = strut_allocate(plan->axis_columns + 1, sizeof *values);
  if (!values) return strut_no_memory(error, "");
  strut_grid_values(plan->study, best->worst, values); /* the variables' own axis holds the start */
  if (!start) strut_search_values(plan, best->worst, best->values, values);
  strut_status status = plan->scenes.setup(plan->scenes.context, values, setup, error);
  strut_release(values);
  return status;
}

strut_status strut_search_winner_figure(const strut_sweep_plan *plan,
                                        const strut_study_figure *figure, const char *path,
                                        const strut_search_point *best, double width,
                                        const strut_flag *interrupt, strut_error *error) {
  strut_setup setups[2];
  strut_compare result = {0};
  const strut_compare_input inputs[] = {{.label = "start", .setup = &setups[0]},
                                        {.label = "best", .setup = &setups[1]}};
  strut_status status = set_up(plan, best, true, &setups[0], error);
  if (status) return status;
  status = set_up(plan, best, false, &setups[1], error);
  if (!status) {
    const strut_compare_options options = {.accuracy = setups[1].experiment.accuracy,
                                           .no_motion = plan->study->compute != STRUT_COMPUTE_RUN,
                                           .no_states = true,
                                           .interrupt = interrupt};
    const strut_plot plot = {
        .path = path, .title = figure->title ? figure->title : plan->study->name, .width = width};
    status = strut_compare_make(inputs, 2, &options, &result, error);
    if (!status) status = strut_compare_figure(&plot, &result, 0, result.count, error);
    strut_compare_free(&result);
    strut_setup_free(&setups[1]);
  }
  strut_setup_free(&setups[0]);
  return status;
}
