/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/sweep.h"

#include <stdio.h>
#include <string.h>

#include "engine/output/results.h"
#include "engine/study/report/study_report.h"
#include "engine/study/sweep/study_runs.h"
#include "parser/program/streams.h"
#include "parser/program/table_file.h"
#include "parser/yaml/diagnostics.h"

static bool of_runs(const strut_study_figure *f) {
  return f->kind >= STRUT_FIGURE_MOTION && f->kind <= STRUT_FIGURE_SNAPSHOTS;
}

static bool of_search(const strut_study_figure *f) { return f->kind >= STRUT_FIGURE_BEST; }

/* The source of a figure: the table, or the recorded runs. */
typedef struct source {
  const strut_sweep_plan *plan;
  bool runs;
} source;

static const char *column_name(const void *context, size_t i) {
  const source *s = context;
  size_t count = s->runs ? s->plan->axis_columns : s->plan->column_count;
  if (i < count) return s->plan->columns[i].name;
  return s->runs ? strut_study_motion_column(i - count) : NULL;
}

static bool holds_texts(const source *s, size_t i) {
  size_t axes = s->plan->axis_columns;
  return s->runs && i >= axes ? i == axes : s->plan->columns[i].word;
}

/* Columns that may split rows into series; recorded numbers may not. */
static bool tells_apart(const source *s, size_t i) {
  return !s->runs || i <= s->plan->axis_columns;
}

/* Checks that the figure may use this column; NULL: not given. */
static strut_status check_column(const source *s, const strut_study_figure *figure,
                                 const char *name, bool number, strut_error *error) {
  const char *other = NULL;
  for (size_t i = 0; name && (other = column_name(s, i)); i++) {
    if (strcmp(other, name) != 0) continue;
    if (number ? !holds_texts(s, i) : tells_apart(s, i)) return STRUT_OK;
    return strut_fail(error, STRUT_BAD_SCENE,
                      number
                          ? "figure '%.60s' of the study: column '%.60s' holds texts, not numbers"
                          : "figure '%.60s' of the study: '%.60s' is recorded; expected an axis, "
                            "or 'node'",
                      figure->name, name);
  }
  if (!name) return STRUT_OK;
  const char *near = strut_did_you_mean(name, column_name, s);
  return strut_fail(error, STRUT_BAD_SCENE,
                    "figure '%.60s' of the study: %s no column '%.60s'%s%s%s", figure->name,
                    s->runs ? "the motion has" : "the table has", name,
                    near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* COLUMN=TEXT, where the column has to be there. */
static strut_status check_match(const source *s, const strut_study_figure *figure, const char *text,
                                const char *key, strut_error *error) {
  char name[60];
  if (!text) return STRUT_OK;
  if (!strchr(text, '='))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study: '%s' expects COLUMN=TEXT, not '%.60s'",
                      figure->name, key, text);
  snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
  return check_column(s, figure, name, false, error);
}

static strut_status check_figure(const source *s, const strut_study_figure *f, strut_error *error) {
  if (s->runs && !s->plan->study->trajectories)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study needs recorded runs: add "
                      "'trajectories: yes' to the study",
                      f->name);
  if (of_search(f) && !s->plan->study->search)
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study is of a search, which the study has not",
                      f->name);
  if (of_search(f) && (f->difference || f->band))
    return strut_fail(
        error, STRUT_BAD_SCENE,
        "figure '%.60s' of the study is of a search: it has no 'difference' and no 'band'",
        f->name);
  strut_status status = check_column(s, f, f->x, true, error);
  if (!status) status = check_column(s, f, f->y, true, error);
  if (!status) status = check_column(s, f, f->series, false, error);
  if (!status) status = check_column(s, f, f->color, false, error);
  if (!status) status = check_column(s, f, f->panels, false, error);
  if (!status) status = check_column(s, f, f->difference, false, error);
  if (!status) status = check_match(s, f, f->band, "band", error);
  return status ? status : check_match(s, f, f->only, "only", error);
}

strut_status strut_sweep_figures_check(const strut_sweep_plan *plan, strut_error *error) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < plan->study->figure_count && !status; i++) {
    const source s = {.plan = plan, .runs = of_runs(&plan->study->figures[i])};
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

/* A figure of a winner is not of the table: sweep_search.c draws it. */
static strut_status draw_figure(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *f, const strut_table *table,
                                const strut_refinement *refinement) {
  strut_error error = {0};
  if (f->kind == STRUT_FIGURE_WINNER) return STRUT_OK;
  strut_status status = strut_sweep_figure(plan, directory, f, table, refinement, &error);
  if (error.message[0]) strut_print_error(&error);
  return status;
}

strut_status strut_sweep_figures_draw(const strut_sweep_plan *plan, const char *directory,
                                      const char *path, const strut_refinement *refinement) {
  const strut_study *study = plan->study;
  strut_table table = {0};
  if (study->figure_count == 0) return STRUT_OK;
  strut_status status = strut_table_read(path, &table);
  for (size_t i = 0; i < study->figure_count && !status; i++)
    status = draw_figure(plan, directory, &study->figures[i], &table, refinement);
  strut_arena_free(&table.arena);
  return status;
}
