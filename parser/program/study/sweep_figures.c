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
  bool runs;
} source;

static const char *column_name(const void *context, size_t i) {
  const source *self = context;
  size_t count = self->runs ? self->plan->axis_columns : self->plan->column_count;
  if (i < count) return self->plan->columns[i].name;
  return self->runs ? strut_study_motion_column(i - count) : NULL;
}

/* Checks that the figure may use this column; NULL: not given. */
static strut_status check_column(const source *self, const strut_study_figure *figure,
                                 const char *name, bool number, strut_error *error) {
  const char *other = NULL;
  for (size_t i = 0; name && (other = column_name(self, i)); i++) {
    if (strcmp(other, name) != 0) continue;
    /* What was recorded is numbers behind the names of nodes; it does not split rows into series. */
    const size_t node = self->plan->axis_columns;
    const bool texts = self->runs && i >= node ? i == node : self->plan->columns[i].word;
    if (number ? !texts : !self->runs || i <= node) return STRUT_OK;
    return strut_fail(error, STRUT_BAD_SCENE,
                      number
                          ? "figure '%.60s' of the study: column '%.60s' holds texts, not numbers"
                          : "figure '%.60s' of the study: '%.60s' is recorded; expected an axis, "
                            "or 'node'",
                      figure->name, name);
  }
  if (!name) return STRUT_OK;
  return strut_fail(error, STRUT_BAD_SCENE, "figure '%.60s' of the study: %s no column '%.60s'%s",
                    figure->name, self->runs ? "the motion has" : "the table has", name,
                    strut_near_to(name, column_name, self).text);
}

/* COLUMN=TEXT, where the column has to be there. */
static strut_status check_match(const source *self, const strut_study_figure *figure,
                                const char *text, const char *key, strut_error *error) {
  char name[60];
  if (!text) return STRUT_OK;
  if (!strchr(text, '='))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study: '%s' expects COLUMN=TEXT, not '%.60s'",
                      figure->name, key, text);
  snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
  if (!self->runs && strcmp(name, "status") == 0) return STRUT_OK; /* of every table */
  return check_column(self, figure, name, false, error);
}

/* A label for each value of an axis by itself; of other columns the curves are counted when they are drawn. */
static strut_status check_labels(const strut_sweep_plan *plan, const strut_study_figure *figure,
                                 strut_error *error) {
  for (size_t i = 0, a; i < plan->axis_columns && figure->series && figure->label_count; i++) {
    if (strcmp(plan->columns[i].name, figure->series) != 0) continue;
    strut_grid_column(plan->study, i, &a);
    const strut_study_axis *axis = &plan->study->axes[a];
    if (axis->column_count == 1 && axis->count != (int64_t)figure->label_count)
      return strut_fail(error, STRUT_BAD_SCENE,
                        "figure '%.60s' of the study: 'labels' has %zu labels for the %lld values "
                        "of '%.60s'",
                        figure->name, figure->label_count, (long long)axis->count, figure->series);
  }
  return STRUT_OK;
}

static strut_status check_figure(const source *self, const strut_study_figure *figure,
                                 strut_error *error) {
  if (self->runs && !self->plan->study->trajectories)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study needs recorded runs: add "
                      "'trajectories: yes' to the study",
                      figure->name);
  if (strut_figure_of_search(figure) && !self->plan->study->search)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study is of a search, which the study has not",
                      figure->name);
  strut_status status = check_column(self, figure, figure->x, true, error);
  if (!status) status = check_column(self, figure, figure->y, true, error);
  if (!status) status = check_column(self, figure, figure->series, false, error);
  if (!status) status = check_column(self, figure, figure->color, false, error);
  if (!status) status = check_column(self, figure, figure->panels, false, error);
  if (!status) status = check_column(self, figure, figure->difference, false, error);
  if (!status) status = check_labels(self->plan, figure, error);
  if (!status) status = check_match(self, figure, figure->band, "band", error);
  return status ? status : check_match(self, figure, figure->only, "only", error);
}

strut_status strut_sweep_figures_check(const strut_sweep_plan *plan, strut_error *error) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < plan->study->figure_count && !status; i++) {
    const source s = {.plan = plan, .runs = strut_figure_of_runs(&plan->study->figures[i])};
    status = check_figure(&s, &plan->study->figures[i], error);
  }
  return status;
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
                                &table, job->refinement, &error);
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
