/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a study's table, of its recorded runs, and of branches of motions. */
#include <gsl/gsl_interp.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/compare/compare.h"
#include "engine/study/follow/follow_study.h"
#include "engine/study/report/study_report.h"
#include "engine/study/sweep/sweep.h"

void strut_sweep_show_units(const strut_sweep_plan *plan, strut_table *table) {
  for (size_t k = 0; k < strut_grid_columns(plan->study); k++) {
    const strut_study_column *of = strut_grid_column(plan->study, k, NULL);
    strut_table_show_unit(table, of->name, of->shown);
  }
}

static strut_axis_choice axis_of(const char *label, const double limits[2]) {
  return (strut_axis_choice){label, limits[0] < limits[1], limits[0], limits[1], false};
}

static strut_plot plot_of(const strut_sweep_plan *plan, const strut_study_figure *figure,
                          const char *path) {
  return (strut_plot){.path = path,
                      .title = figure->title,
                      .texts = plan->texts,
                      .x = axis_of(figure->x_label, figure->x_limits),
                      .y = axis_of(figure->y_label, figure->y_limits)};
}

static strut_status draw_motion(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, const char *path,
                                strut_error *error) {
  strut_table motion = {0};
  strut_status status = strut_study_motion(plan, directory, figure, &motion, error);
  strut_sweep_show_units(plan, &motion);
  const strut_plot plot = plot_of(plan, figure, path);
  if (!status) status = strut_table_draw(&plot, figure, &motion, false, error);
  strut_arena_free(&motion.arena);
  return status;
}

/* ---- branches: stable motions solid, unstable ones dashed, special points marked ---- */

static int column_of(const strut_table *table, const char *name) {
  return strut_table_column_of(table, name, strlen(name));
}

/* Events that change nothing, and starts, are in the table alone. */
static bool is_marked(const char *point, const char *changes) {
  bool marked = *point && strcmp(changes, "yes") == 0;
  for (int kind = STRUT_FOLLOW_CUSP; kind <= STRUT_FOLLOW_TORUS; kind++)
    marked = marked || strcmp(point, strut_follow_kind_word((strut_follow_kind)kind)) == 0;
  return marked;
}

strut_status strut_follow_figure(const strut_plot *plot, const char *title, size_t axes,
                                 strut_table *table, strut_error *error) {
  const bool curves = column_of(table, "curve") >= 0;
  const int over = column_of(table, "arclength") + 1, point = column_of(table, "point");
  const int changes = column_of(table, "changes_stability"), wide = column_of(table, "amplitude");
  const char **mark = strut_arena_allocate(&table->arena, table->row_count + 1, sizeof *mark);
  if (over == 0 || point < 0 || wide < 0)
    return strut_fail(error, STRUT_FILE_TROUBLE, "the table of branches lacks a column");
  if (!mark) return strut_no_memory(error, "while drawing");
  const strut_table_column *columns = table->columns;
  const char *const *text = columns[point].text;
  for (size_t i = 0; i < table->row_count; i++)
    mark[i] = is_marked(text[i], changes < 0 ? "" : columns[changes].text[i]) ? text[i] : "";
  table->columns[point].text = mark;
  const char *groups[] = {curves ? "kind" : columns[axes ? axes - 1 : 0].name,
                          axes > 1 ? columns[axes - 2].name : NULL};
  strut_table_groups found;
  for (int k = 0; k < 2; k++) /* too many have neither colours nor panels */
    if (groups[k] && strut_table_groups_find(table, column_of(table, groups[k]),
                                             STRUT_MOST_TABLE_GROUPS, "", &found, NULL))
      groups[k] = NULL;
  strut_plot titled = *plot;
  if (!plot->title) titled.title = title;
  const strut_study_figure figure = {
      .x = columns[over].name,
      .y = columns[curves                ? over + 1
                   : columns[wide].value ? wide
                                         : column_of(table, "velocity")]
               .name,
      .series = groups[0],
      .panels = groups[1],
      .line = curves ? "curve" : "branch",
      .stable = "stable",
      .mark = "point",
      .thing = curves ? NULL : "node"};
  return strut_table_draw(&titled, &figure, table, false, error);
}

/* ---- a search: its best objective over evaluations, its points over two variables ---- */

static const char BEST[] = "best so far", RINGED[] = "ringed"; /* columns */

/* Rows of a search's table, by number of the point. */
typedef struct searched_rows {
  const strut_table *table;
  double *best; /* (rows) the best objective so far */
  bool *shown;
  const char **ringed; /* "" but of marked ones */
} searched_rows;

static size_t row_of(const searched_rows *rows, int64_t point) {
  return gsl_interp_bsearch(rows->table->columns[0].value, (double)point, 0,
                            rows->table->row_count - 1);
}

/* Shows the worst scenario of each evaluation; marks the best of each search, or the front of two goals. */
static void find_rows(searched_rows *rows, const strut_search_result *result) {
  for (size_t i = 0; i < rows->table->row_count; i++)
    rows->best[i] = (double)NAN, rows->ringed[i] = "";
  for (size_t i = 0; i < result->outcome_count; i++) {
    const strut_search_outcome *outcome = &result->outcomes[i];
    for (int64_t k = 0; k < outcome->evaluations; k++) {
      size_t row = row_of(rows, outcome->steps[k].worst);
      rows->best[row] = outcome->steps[k].best;
      rows->shown[row] = true;
    }
    if (outcome->best.evaluation >= 0 && outcome->best.violation <= 0.0 && !result->front_count)
      rows->ringed[row_of(rows, outcome->best.worst)] = "yes";
  }
  for (size_t i = 0; i < result->front_count; i++)
    for (size_t k = 0; k < result->fronts[i].count; k++)
      rows->ringed[row_of(rows, result->fronts[i].points[k].worst)] = "yes";
}

/* Draws those rows of a table, which is freed. */
static strut_status draw_shown(const strut_plot *plot, const strut_study_figure *figure,
                               strut_table *table, const bool *shown, strut_error *error) {
  strut_table chosen = {0};
  strut_status status = strut_table_choose(table, STRUT_NO_COLUMN, NULL, shown, &chosen, error);
  if (!status) status = strut_table_draw(plot, figure, &chosen, false, error);
  strut_arena_free(&chosen.arena);
  strut_arena_free(&table->arena);
  return status;
}

static strut_status draw_search(const strut_sweep_plan *plan, const strut_study_figure *f,
                                const char *path, const strut_table *table,
                                const strut_search_result *result, strut_error *error) {
  const strut_study_search *search = plan->study->search;
  strut_table own = {0};
  strut_plot plot = plot_of(plan, f, path);
  strut_study_figure figure = *f; /* points over two variables, the best ringed; else: */
  size_t count = table->row_count + 1;
  searched_rows rows = {.table = table};
  const char *unit = search->goal.program.unit;
  strut_status status = STRUT_ALLOCATE(&own.arena, STRUT_NEW(rows.best, count),
                                       STRUT_NEW(rows.shown, count), STRUT_NEW(rows.ringed, count))
                            ? strut_table_choose(table, STRUT_NO_COLUMN, NULL, NULL, &own, error)
                            : strut_no_memory(error, "while drawing");
  if (status) return strut_arena_free(&own.arena), status;
  own.columns[own.column_count++] = (strut_table_column){
      .name = BEST, .unit = strcmp(unit, "1") == 0 ? "" : unit, .value = rows.best};
  own.columns[own.column_count++] =
      (strut_table_column){.name = RINGED, .unit = "", .text = rows.ringed};
  find_rows(&rows, result);
  if (!figure.color) figure.color = "objective";
  if (f->kind == STRUT_FIGURE_POINTS) figure.mark = RINGED;
  if (f->kind == STRUT_FIGURE_BEST) {
    figure.x = "evaluation", figure.y = BEST;
    if (!figure.series && search->starts > 1) figure.series = "search";
    if (!plot.y.label) plot.y.label = search->goal.text;
  }
  return draw_shown(&plot, &figure, &own, rows.shown, error);
}

strut_status strut_sweep_figure(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, const strut_table *table,
                                const strut_search_result *searched, strut_error *error) {
  strut_arena arena = {0};
  const char *file = strut_arena_format(&arena, "%s/%s.svg", directory, figure->name);
  const strut_plot plot = plot_of(plan, figure, file);
  strut_status status = STRUT_OK;
  if (!file)
    status = strut_no_memory(error, "");
  else if (figure->kind == STRUT_FIGURE_MOTION)
    status = draw_motion(plan, directory, figure, file, error);
  else if (strut_figure_of_search(figure))
    status = draw_search(plan, figure, file, table, searched, error);
  else if (strut_figure_of_runs(figure))
    status = strut_study_pictures(plan, directory, figure, error);
  else
    status = strut_table_draw(&plot, figure, table, plan->study->refine.depth > 0, error);
  strut_arena_free(&arena);
  return status;
}

/* ---- indices of sensitivity ---- */

/* Rows of indices that have a value, as far as there are panels; who: the parameter, or the measure. */
static bool choose_indices(const strut_table *table, size_t of, bool one, bool *shown,
                           const char **who) {
  const char *const *measure = table->columns[of + 1].text, *const *name = table->columns[of].text;
  const char *const *parameter = table->columns[of + 2].text;
  const double *value = table->columns[of + 3].value;
  size_t panel = 0; /* of the results of a point */
  bool some = false;
  for (size_t i = 0; i < table->row_count && value; i++) {
    panel = strcmp(name[i], name[0]) == 0 ? 0 : panel + (strcmp(name[i], name[i - 1]) != 0);
    who[i] = *parameter[i] ? parameter[i] : measure[i];
    shown[i] = isfinite(value[i]) && panel < STRUT_MOST_TABLE_GROUPS &&
               (strcmp(measure[i], "total") == 0 ||
                strcmp(measure[i], one ? "first_order" : "share") == 0);
    some = some || shown[i];
  }
  return some;
}

strut_status strut_sensitivity_figure(const strut_plot *plot, const strut_study *study,
                                      const strut_table *table, bool *drawn, strut_error *error) {
  static const char *labels[] = {"first order", "total; whiskers: 95 %"};
  const strut_study_axis *axes = study->axes;
  size_t of = 0, points = 1, last = study->sensitivity.axis, over = 0;
  strut_table own = {0};
  for (size_t i = 0; i < last; i++)
    over = of, of += axes[i].column_count, points *= (size_t)axes[i].count;
  bool one = points == 1, numbers = one || !axes[last - 1].columns[0].word;
  bool *shown;
  const char **who;
  strut_status status = STRUT_ALLOCATE(&own.arena, STRUT_NEW(shown, table->row_count + 1),
                                       STRUT_NEW(who, table->row_count + 1))
                            ? strut_table_choose(table, STRUT_NO_COLUMN, NULL, NULL, &own, error)
                            : strut_no_memory(error, "while drawing");
  *drawn = !status && numbers && choose_indices(table, of, one, shown, who);
  if (*drawn) {
    strut_plot limited = *plot;
    own.columns[own.column_count++] = (strut_table_column){.name = "", .unit = "", .text = who};
    const strut_study_figure figure = {.x = one ? "parameter" : own.columns[over].name,
                                       .y = "value",
                                       .series = one ? "measure" : "",
                                       .panels = "result",
                                       .low = one ? "low" : NULL,
                                       .high = one ? "high" : NULL,
                                       .label_count = one ? 2 : 0,
                                       .labels = labels};
    own.columns[of].name = figure.panels;
    limited.y = (strut_axis_choice){one ? "part of the variance" : "index", one, -0.1, 1.2, false};
    return draw_shown(&limited, &figure, &own, shown, error);
  }
  strut_arena_free(&own.arena);
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
                                        const strut_search_point *best, const strut_flag *interrupt,
                                        strut_error *error) {
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
    const strut_plot plot = {.path = path,
                             .texts = plan->texts,
                             .title = figure->title ? figure->title : plan->study->name};
    status = strut_compare_make(inputs, 2, &options, &result, error);
    if (!status) status = strut_compare_figure(&plot, &result, 0, result.count, error);
    strut_compare_free(&result);
    strut_setup_free(&setups[1]);
  }
  strut_setup_free(&setups[0]);
  return status;
}
