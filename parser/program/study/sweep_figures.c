/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/study/follow/follow_parts.h"
#include "engine/study/report/study_report.h"
#include "engine/study/sweep/sweep.h"
#include "parser/language/yaml/document.h"
#include "parser/program/command/scene_options.h"
#include "parser/program/study/sweep.h"

/* The source of a figure: the table, or the recorded runs. */
typedef struct source {
  const strut_sweep_plan *plan;
  bool runs, lines; /* lines may be bars over texts */
} source;

static const char *column_name(const void *context, size_t i) {
  const source *self = context;
  size_t count = self->runs ? self->plan->axis_columns : self->plan->column_count;
  if (i < count) return self->plan->columns[i].name;
  return self->runs ? strut_study_motion_column(i - count) : i == count ? "status" : NULL;
}

/* May a key have a text of this axis? */
static bool has_text(const source *self, size_t i, const char *text) {
  size_t a;
  const strut_study_column *column = strut_grid_column(self->plan->study, i, &a);
  for (int64_t k = 0; k < self->plan->study->axes[a].count && column->word; k++)
    if (strcmp(column->words[k], text) == 0) return true;
  return !column->word;
}

/* What was recorded is numbers behind the names of nodes; it does not split rows into series. */
static void judge_column(const void *context, size_t i, const strut_figure_key *key,
                         const char *text, char fault[STRUT_MESSAGE_MOST]) {
  const source *self = context;
  const strut_sweep_plan *plan = self->plan;
  const size_t node = plan->axis_columns;
  const char *name = column_name(self, i);
  bool words =
      self->runs && i >= node ? i == node : i == plan->column_count || plan->columns[i].word;
  bool bars = self->lines && strcmp(key->key, "x") == 0;
  if (key->number ? words && !bars : self->runs && i > node)
    snprintf(fault, STRUT_MESSAGE_MOST,
             !key->number ? "'%.60s' is recorded; expected an axis, or 'node'"
             : self->lines
                 ? "column '%.60s' holds texts, not numbers; 'series' and 'panels' take texts"
                 : "column '%.60s' holds texts, not numbers",
             name);
  else if (*key->ends == '=' && i < node && !has_text(self, i, text))
    snprintf(fault, STRUT_MESSAGE_MOST, "'%.60s' is no value of '%.60s'", text, name);
}

/* A label for each value of an axis by itself; of other columns the curves are counted when they are drawn. */
static bool has_labels(const strut_sweep_plan *plan, const strut_study_figure *figure,
                       char fault[STRUT_MESSAGE_MOST]) {
  for (size_t i = 0, a; i < plan->axis_columns && figure->series && figure->label_count; i++) {
    if (strcmp(plan->columns[i].name, figure->series) != 0) continue;
    strut_grid_column(plan->study, i, &a);
    const strut_study_axis *axis = &plan->study->axes[a];
    if (axis->column_count > 1 || axis->count == (int64_t)figure->label_count) continue;
    snprintf(fault, STRUT_MESSAGE_MOST, "%zu labels for the %lld values of '%.60s'",
             figure->label_count, (long long)axis->count, figure->series);
    return false;
  }
  return true;
}

/* The key that has a fault, which it says; NULL: none. */
static const char *check_figure(const strut_sweep_plan *plan, const strut_study_figure *figure,
                                char fault[STRUT_MESSAGE_MOST]) {
  const source s = {plan, strut_figure_of_runs(figure), figure->kind == STRUT_FIGURE_LINES};
  const strut_figure_columns columns = {s.runs ? "the motion" : "the table", column_name,
                                        judge_column, &s};
  const bool no_search = strut_figure_of_search(figure) && !plan->study->search;
  if (no_search || (s.runs && !plan->study->trajectories)) {
    snprintf(fault, STRUT_MESSAGE_MOST, "%s",
             no_search ? "it is of a search, which the study has not"
                       : "it needs recorded runs: add 'trajectories: yes' to the study");
    return "kind";
  }
  if (!has_labels(plan, figure, fault)) return "labels";
  const strut_figure_key *key = strut_figure_fault(figure, &columns, fault);
  return key ? key->key : NULL;
}

strut_status strut_sweep_figures_check(strut_sweep_study *study) {
  strut_study_file *file = &study->file;
  const strut_tree *figures = strut_tree_find(file->document.root, "figures", NULL);
  char fault[STRUT_MESSAGE_MOST];
  for (size_t i = 0; i < file->study.figure_count; i++) {
    const strut_study_figure *figure = &file->study.figures[i];
    const char *key = check_figure(&study->plan, figure, fault);
    const strut_tree *own = strut_tree_find(figures, figure->name, NULL);
    const strut_tree *at = key ? strut_tree_find(own, key, NULL) : NULL;
    if (key)
      strut_diagnose(&file->diagnostics, (at ? at : own)->place, "'%s' of figure '%.60s': %s", key,
                     figure->name, fault);
  }
  return file->diagnostics.count ? STRUT_BAD_SCENE : STRUT_OK;
}

strut_status strut_sweep_figures_check_files(const strut_sweep_plan *plan, const char *directory,
                                             strut_error *error) {
  const strut_study *study = plan->study;
  strut_arena arena = {0};
  const char **names = strut_arena_allocate(&arena, study->figure_count + 5, sizeof *names);
  if (names) names[0] = "table.csv";
  for (size_t i = 0; i < study->figure_count && names; i++) {
    names[i + 1] = strut_arena_format(&arena, "%s.svg", study->figures[i].name);
    if (!names[i + 1]) names = NULL;
  }
  if (names && study->sensitivity.wanted) {
    names[study->figure_count + 1] = "sensitivity.csv";
    names[study->figure_count + 2] = "sensitivity.svg";
  }
  if (names && study->search) {
    names[study->figure_count + 1] = "best.csv";
    names[study->figure_count + 2] = "best.yaml";
  }
  if (names && study->follow) {
    names[study->figure_count + 1] = "branches.csv";
    names[study->figure_count + 2] = "branches.svg";
    names[study->figure_count + 3] = "report.json";
  }
  strut_status status =
      names ? strut_ownership_check(directory, names, error) : strut_no_memory(error, "");
  strut_arena_free(&arena);
  return status;
}

strut_status strut_sweep_figures_draw(const strut_study_job *job, const char *path) {
  const strut_study *study = job->study->plan.study;
  strut_table table = {0};
  if (study->figure_count == 0) return STRUT_OK;
  strut_status status = strut_table_read(job->arguments->listener, path, &table);
  strut_sweep_show_units(&job->study->plan, &table);
  for (size_t i = 0; i < study->figure_count && !status; i++) {
    strut_error error = {0};
    if (study->figures[i].kind == STRUT_FIGURE_WINNER) continue; /* sweep_search.c draws it */
    status = strut_sweep_figure(&job->study->plan, job->arguments->output, &study->figures[i],
                                &table, job->searched, &error);
    strut_tell_failure(job->arguments->listener, status, &error);
  }
  strut_arena_free(&table.arena);
  return status;
}

/* `strut sweep` of a study that follows motions. */

static const char branches_name[] = "branches.csv";
static const char partial_branches_name[] = "branches-partial.csv";
static const double PAGE = 510.24; /* 180 mm [pt] */

strut_status strut_sweep_follow_check(strut_sweep_study *study, strut_error *error) {
  const strut_follow_points how = {strut_study_setup_at, &study->file};
  strut_status status = strut_follow_points_columns(&study->plan, error);
  return status ? status : strut_follow_points_check(&study->plan, &how, error);
}

/* What is there of an interrupted study. */
static void write_partial(const strut_study_job *job) {
  int64_t rows = 0;
  strut_error error = {0};
  const strut_arguments *arguments = job->arguments;
  strut_status status = strut_follow_points_combine(
      &job->study->plan, job->slots, arguments->output, partial_branches_name, true, &rows, &error);
  if (!strut_tell_failure(arguments->listener, status, &error))
    strut_tell(arguments->listener, STRUT_MESSAGE_REMARK, NULL,
               "%s/%s has what was followed so far, %lld points of branches", arguments->output,
               partial_branches_name, (long long)rows);
}

static strut_status run_points(strut_study_job *job, const strut_sweep_options *options,
                               void *context, strut_error *error) {
  const strut_follow_points how = {strut_study_setup_at, &job->study->file};
  (void)context;
  strut_status status =
      strut_follow_points_run(&job->study->plan, job->slots, &how, options, &job->state, error);
  if (status == STRUT_INTERRUPTED) write_partial(job);
  return status;
}

static strut_status draw_branches(const strut_study_job *job, strut_error *error) {
  strut_sweep_plan *plan = &job->study->plan;
  const char *directory = job->arguments->output;
  strut_table table = {0};
  const char *from = strut_arena_format(&plan->arena, "%s/%s", directory, branches_name);
  const strut_plot plot = {.path = strut_arena_format(&plan->arena, "%s/branches.svg", directory),
                           .width = PAGE};
  if (!from || !plot.path) return strut_no_memory(error, "");
  strut_status status = strut_table_read(job->arguments->listener, from, &table);
  strut_sweep_show_units(plan, &table);
  if (!status) status = strut_follow_points_figure(&plot, plan, &table, error);
  strut_arena_free(&table.arena);
  return status;
}

/* branches.csv, branches.svg and report.json, whose text becomes *result. */
static strut_status write_branches(const strut_study_job *job, void *result, strut_error *error) {
  strut_sweep_plan *plan = &job->study->plan;
  const char *directory = job->arguments->output;
  char **json = result;
  int64_t rows = 0;
  strut_status status =
      strut_follow_points_combine(plan, job->slots, directory, branches_name, false, &rows, error);
  if (!status && rows) status = draw_branches(job, error);
  if (!status) status = strut_follow_points_json(plan, job->slots, directory, json, error);
  if (!status) status = strut_file_write_text(directory, "report.json", *json, error);
  if (!status) strut_file_remove(directory, partial_branches_name);
  return status;
}

static strut_status report_branches(const strut_study_job *job, const void *result,
                                    const char *table) {
  const strut_follow_points_rows rows = {&job->study->plan, job->slots};
  (void)table;
  strut_status status =
      job->report(job, &strut_follow_points_values, &rows, *(char *const *)result);
  return status ? status
                : strut_sweep_judge(job->arguments->listener, job->study->plan.points,
                                    strut_slots_failed(job->slots),
                                    strut_slots_inaccurate(job->slots));
}

static void free_branches(void *result) { strut_release(*(char **)result); }

const strut_study_form strut_follow_form = {sizeof(char *), run_points, write_branches,
                                            report_branches, free_branches};
