/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/figures/run_figure.h"
#include "engine/output/figures/table_figure.h"
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
  const strut_study_figure *figure;
  bool runs, lines;   /* lines may be bars over texts */
  const char **units; /* of x, and of the y before; NULL: none */
} source;

static const char *column_name(const void *context, size_t i) {
  const source *self = context;
  const char *unit;
  size_t count = self->runs ? self->plan->axis_columns : self->plan->column_count;
  if (i < count) return self->plan->columns[i].name;
  return self->runs ? strut_study_motion_column(i - count, &unit) : i == count ? "status" : NULL;
}

/* The unit of a column of numbers, "" for none. */
static const char *unit_of(const source *self, size_t i) {
  const char *unit = "";
  if (self->runs && i >= self->plan->axis_columns)
    strut_study_motion_column(i - self->plan->axis_columns, &unit);
  else if (i < self->plan->column_count && strcmp(self->plan->columns[i].unit, "1") != 0)
    unit = self->plan->columns[i].unit;
  return unit;
}

/* The axis of column i; NULL where its values are chosen while the study runs. */
static const strut_study_axis *known_axis(const source *self, size_t i) {
  const strut_study *study = self->plan->study;
  size_t a = 0;
  if (i >= self->plan->axis_columns || study->fit) return NULL;
  strut_grid_column(study, i, &a);
  bool chosen = (study->search && a >= study->search->axis) ||
                (study->sensitivity.wanted && a >= study->sensitivity.axis);
  return chosen ? NULL : &study->axes[a];
}

/* Has an axis this text? Numbers are written as in the table. */
static bool has_text(const source *self, size_t i, const char *text) {
  enum { MOST = 100000 };
  size_t a;
  const strut_study_axis *axis = known_axis(self, i);
  char number[STRUT_NUMBER_TEXT];
  if (!axis || axis->count > MOST) return true;
  const strut_study_column *column = strut_grid_column(self->plan->study, i, &a);
  for (int64_t k = 0; k < axis->count; k++) {
    if (!column->word) strut_number_text(strut_grid_value(column, k, axis->count), number);
    if (strcmp(column->word ? column->words[k] : number, text) == 0) return true;
  }
  return false;
}

/* What was recorded is numbers behind the names of nodes; it does not split rows into series. */
static void judge_column(const void *context, size_t i, const strut_figure_key *key,
                         const char *text, char fault[STRUT_MESSAGE_MOST]) {
  const source *self = context;
  const strut_sweep_plan *plan = self->plan;
  const size_t node = plan->axis_columns;
  const char *name = column_name(self, i), *unit = unit_of(self, i);
  bool motion = self->figure->kind == STRUT_FIGURE_MOTION;
  bool words =
      self->runs && i >= node ? i == node : i == plan->column_count || plan->columns[i].word;
  bool x = strcmp(key->key, "x") == 0, y = strcmp(key->key, "y") == 0, bars = self->lines && x;
  const char **before = &self->units[y];
  if (key->number ? words && !bars : self->runs && i >= node + motion)
    snprintf(fault, STRUT_MESSAGE_MOST,
             !key->number ? motion ? "'%.60s' is recorded; expected an axis, or 'node'"
                                   : "'%.60s' is recorded; expected an axis"
             : self->lines
                 ? "column '%.60s' holds texts, not numbers; 'series' and 'panels' take texts"
                 : "column '%.60s' holds texts, not numbers",
             name);
  else if (*key->ends == '=' && !has_text(self, i, text))
    snprintf(fault, STRUT_MESSAGE_MOST, "'%.60s' is no value of '%.60s'%s%s%s", text, name,
             words ? "" : "; expected a number as in the table", !words && *unit ? ", in " : "",
             words ? "" : unit);
  else if (y && *before && strcmp(*before, unit) != 0)
    snprintf(fault, STRUT_MESSAGE_MOST,
             "'%.60s' has another unit (%s) than the columns before it (%s)", name,
             *unit ? unit : "none", **before ? *before : "none");
  else if (x || y)
    *before = unit;
}

/* Says what is wrong with the key, which it returns. */
__attribute__((format(printf, 3, 4))) static const char *wrong(char fault[STRUT_MESSAGE_MOST],
                                                               const char *key, const char *format,
                                                               ...) {
  va_list rest;
  va_start(rest, format);
  vsnprintf(fault, STRUT_MESSAGE_MOST, format, rest);
  va_end(rest);
  return key;
}

/* How many texts the figure's rows have in a column, of which `nodes` are those of "node"; 0: not known. */
static size_t count_texts(const source *self, const char *name, size_t nodes) {
  const char *only = self->figure->only ? self->figure->only : "=";
  size_t length = strcspn(only, "=");
  bool one = name && strlen(name) == length && memcmp(name, only, length) == 0;
  if (name && self->runs && strcmp(name, "node") == 0) return one ? 1 : nodes;
  for (size_t i = 0; name && i < self->plan->axis_columns; i++) {
    const strut_study_axis *axis = known_axis(self, i);
    if (strcmp(self->plan->columns[i].name, name) == 0 && axis && axis->column_count == 1)
      return one ? 1 : (size_t)axis->count;
  }
  return 0;
}

/* The key whose texts are too many or too few; of tables, the texts of axes are known. */
static const char *judge_counts(const source *self, size_t nodes, char fault[STRUT_MESSAGE_MOST]) {
  const strut_study_figure *figure = self->figure;
  size_t sides = count_texts(self, figure->difference, nodes), ys = 1;
  size_t curves = figure->series ? count_texts(self, figure->series, nodes) : 1;
  for (const char *y = figure->y; y && (y = strchr(y, ',')); y++) ys++;
  if (figure->difference && curves && figure->series &&
      strcmp(figure->series, figure->difference) == 0)
    curves = 1;
  if (sides && sides != 2)
    return wrong(fault, "difference", "it needs two values to compare; '%.60s' has %zu",
                 figure->difference, sides);
  if (!figure->label_count || !curves || figure->label_count == curves * ys) return NULL;
  if (figure->series && ys == 1)
    return wrong(fault, "labels", "%zu labels for the %zu values of '%.60s'", figure->label_count,
                 curves, figure->series);
  return wrong(fault, "labels", "%zu labels for %zu curve%s", figure->label_count, curves * ys,
               curves * ys == 1 ? "" : "s");
}

/* The key of a figure of runs that has a fault in a run of this scene. */
static const char *judge_run(const source *self, const strut_setup *setup,
                             char fault[STRUT_MESSAGE_MOST]) {
  const strut_study_figure *figure = self->figure;
  const strut_scene *scene = &setup->scene;
  const strut_span span = strut_experiment_span(&setup->experiment, scene);
  const strut_run_figure picture = {
      .experiment = &setup->experiment,
      .view = figure->kind == STRUT_FIGURE_PERIOD ? STRUT_RUN_PERIOD : STRUT_RUN_SNAPSHOTS,
      .time_count = figure->time_count,
      .times = figure->times};
  const char *node =
      figure->only && strncmp(figure->only, "node=", 5) == 0 ? figure->only + 5 : NULL;
  bool late = figure->from > span.duration;
  strut_error error = {0};
  if (!(setup->experiment.channels & STRUT_CHANNEL_POSITION))
    return wrong(
        fault, "kind",
        "the runs record no positions: expected 'position' in 'output: {channels: [...]}'");
  if (node && strut_thing_find(scene, STRUT_THING_NODE, node) < 0)
    return wrong(
        fault, "only", "the model has no node '%.60s'%s", node,
        strut_near_to(node, strut_row_name, STRUT_NAMED(scene->nodes, scene->node_count)).text);
  if (late || figure->to < span.record_start)
    return wrong(fault, late ? "from" : "to",
                 "nothing is recorded there: the record goes from %s to %s",
                 strut_quantity_of(span.record_start, 6, "s").text,
                 strut_quantity_of(span.duration, 6, "s").text);
  if (figure->kind != STRUT_FIGURE_MOTION && strut_run_figure_check(&picture, scene, &error))
    return wrong(fault, figure->time_count ? "times" : "kind", "%s", error.message);
  return judge_counts(self, scene->node_count, fault);
}

/* The same in the first and the last run of each variant: some run must be without a fault. */
static const char *judge_runs(const source *self, bool variants, char fault[STRUT_MESSAGE_MOST]) {
  const strut_sweep_plan *plan = self->plan;
  int64_t count = variants ? plan->study->axes[0].count : 1, each = plan->points / count;
  const char *key = NULL;
  strut_study_value *values = strut_allocate(plan->axis_columns + 1, sizeof *values);
  for (int64_t i = 0; i < 2 * count && values; i++) {
    strut_setup setup;
    strut_grid_values(plan->study, i / 2 * each + i % 2 * (each - 1), values);
    if (plan->scenes.setup(plan->scenes.context, values, &setup, NULL)) continue;
    key = judge_run(self, &setup, fault);
    strut_setup_free(&setup);
    if (!key) break;
  }
  strut_release(values);
  return key;
}

/* The key of limits in another unit than the column has. */
static const char *judge_limits(const source *self, char fault[STRUT_MESSAGE_MOST]) {
  for (int d = 0; d < 2; d++) {
    const char *given = self->figure->limit_units[d], *unit = self->units[d] ? self->units[d] : "";
    if (given && strcmp(given, unit) != 0)
      return wrong(fault, d ? "y_limits" : "x_limits", "expected numbers%s%s%s, found ones in %s",
                   *unit ? " in " : "", unit, *unit ? ", or without unit" : " without unit", given);
  }
  return NULL;
}

/* The key that has a fault, which it says; NULL: none. */
static const char *check_figure(const strut_sweep_study *study, const strut_study_figure *figure,
                                char fault[STRUT_MESSAGE_MOST]) {
  const strut_sweep_plan *plan = &study->plan;
  const char *units[2] = {NULL};
  const source s = {plan, figure, strut_figure_of_runs(figure), figure->kind == STRUT_FIGURE_LINES,
                    units};
  const strut_figure_columns columns = {s.runs ? "the motion" : "the table", column_name,
                                        judge_column, &s};
  if (strut_figure_of_search(figure) && !plan->study->search)
    return wrong(fault, "kind", "it is of a search, which the study has not");
  if (s.runs && !plan->study->trajectories)
    return wrong(fault, "kind", "it needs recorded runs: add 'trajectories: yes' to the study");
  const strut_figure_key *key = strut_figure_fault(figure, &columns, fault);
  if (key) return key->key;
  const char *limits = judge_limits(&s, fault);
  if (limits) return limits;
  return s.runs                           ? judge_runs(&s, study->file.variants, fault)
         : strut_figure_of_search(figure) ? NULL
                                          : judge_counts(&s, 0, fault);
}

/* Adds a message at the key of a figure, or at its name. */
static void report_fault(strut_sweep_study *study, const strut_study_figure *figure,
                         const char *key, const char *fault) {
  strut_study_file *file = &study->file;
  const strut_tree *own =
      strut_tree_find(strut_tree_find(file->document.root, "figures", NULL), figure->name, NULL);
  const strut_tree *at = key ? strut_tree_find(own, key, NULL) : NULL;
  strut_diagnose(&file->diagnostics, (at ? at : own)->place, "%s%s%sfigure '%.60s': %s",
                 key ? "'" : "", key ? key : "", key ? "' of " : "", figure->name, fault);
}

strut_status strut_sweep_figures_check(strut_sweep_study *study) {
  char fault[STRUT_MESSAGE_MOST];
  for (size_t i = 0; i < study->file.study.figure_count; i++) {
    const strut_study_figure *figure = &study->file.study.figures[i];
    const char *key = check_figure(study, figure, fault);
    if (key) report_fault(study, figure, key, fault);
  }
  return study->file.diagnostics.count ? STRUT_BAD_SCENE : STRUT_OK;
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
  strut_status first = strut_table_read(job->arguments->listener, path, &table);
  if (first) return first;
  strut_sweep_show_units(&job->study->plan, &table);
  for (size_t i = 0; i < study->figure_count; i++) {
    strut_error error = {0};
    if (study->figures[i].kind == STRUT_FIGURE_WINNER) continue; /* sweep_compute.c draws it */
    strut_status status = strut_sweep_figure(&job->study->plan, job->arguments->output,
                                             &study->figures[i], &table, job->searched, &error);
    if (status == STRUT_USAGE)
      report_fault(job->study, &study->figures[i], NULL, error.message);
    else
      strut_tell_failure(job->arguments->listener, status, &error);
    if (!first) first = status;
  }
  strut_arena_free(&table.arena);
  if (!job->study->file.diagnostics.count) return first;
  strut_sweep_study_report(job->arguments->listener, job->study, STRUT_BAD_SCENE,
                           &(strut_error){0});
  return first == STRUT_USAGE ? STRUT_BAD_SCENE : first;
}

/* `strut sweep` of a study that follows motions. */

static const char branches_name[] = "branches.csv";
static const char partial_branches_name[] = "branches-partial.csv";

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
                           .texts = plan->texts};
  if (!from || !plot.path) return strut_no_memory(error, "");
  strut_status status = strut_table_read(job->arguments->listener, from, &table);
  if (!status) {
    strut_sweep_show_units(plan, &table);
    strut_table_show_unit(&table, plan->study->follow->over, plan->study->follow->shown);
    status = strut_follow_figure(&plot, plan->study->name, plan->axis_columns, &table, error);
  }
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
