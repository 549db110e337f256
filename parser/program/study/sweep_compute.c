/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes a study that is open, and writes its results; those of single points, of refinements, of fits and of branches are here. Figures. */
#include <stdlib.h>
#include <string.h>

#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/study/fit/fit.h"
#include "engine/study/follow/follow_parts.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "engine/study/sweep/sweep.h"
#include "parser/language/yaml/document.h"
#include "parser/program/command/scene_options.h"
#include "parser/program/study/sweep.h"

static const char table_name[] = "table.csv";

strut_status strut_sweep_find_shard(const strut_arguments *arguments, strut_sweep_study *study,
                                    strut_shard *shard, const char **path) {
  const strut_array_task task = {
      .id = getenv("SLURM_ARRAY_TASK_ID"),
      .min = getenv("SLURM_ARRAY_TASK_MIN"),
      .max = getenv("SLURM_ARRAY_TASK_MAX"),
      .step = getenv("SLURM_ARRAY_TASK_STEP"),
      .count = getenv("SLURM_ARRAY_TASK_COUNT"),
      .variable = getenv,
  };
  const char *text = arguments->shard;
  strut_error error = {0};
  *shard = (strut_shard){0};
  strut_status status = text ? strut_shard_read(text, &task, shard, &error) : STRUT_OK;
  if (status) return strut_tell_failure(arguments->listener, status, &error);
  const strut_shard part = strut_study_has_stages(study->plan.study) ? (strut_shard){0} : *shard;
  if (part.count) strut_shard_points(part, &study->slots);
  *path = strut_shard_path(arguments->output, part, &study->plan.arena);
  return strut_tell_failure(arguments->listener, *path ? STRUT_OK : STRUT_NO_MEMORY, NULL);
}

/* ---- single points, and refined maps of them ---- */

static strut_status run_points(strut_study_job *job, const strut_sweep_options *given,
                               void *context, strut_error *error) {
  strut_sweep_options how = *given;
  (void)context;
  if (job->refinement) {
    how.wants = strut_refinement_wants;
    how.wants_context = job->refinement;
    strut_refinement_count(job->refinement, job->slots, &how.wanted, &how.wanted_done);
  }
  return strut_sweep_run(&job->study->plan, job->slots, &how, &job->state, error);
}

/* Adds the warnings of a round to those before. */
static void add_warnings(strut_sweep_state *all, const strut_sweep_state *round) {
  for (size_t i = 0; i < round->warning_count; i++) {
    const strut_sweep_warning *warning = &round->warnings[i];
    size_t at = 0;
    while (at < all->warning_count && strcmp(all->warnings[at].code, warning->code) != 0) at++;
    if (at == STRUT_SWEEP_MOST_WARNINGS) continue;
    int64_t runs = at < all->warning_count ? all->warnings[at].runs : 0;
    bool first = at == all->warning_count || warning->point < all->warnings[at].point;
    if (at == all->warning_count) all->warning_count++;
    if (first) all->warnings[at] = *warning;
    all->warnings[at].runs = runs + warning->runs;
  }
}

/* Computes what is wanted until that wants nothing further. */
static strut_status run_refined(strut_study_job *job, strut_error *error) {
  int64_t wanted, done;
  strut_sweep_state all = {0}, *state = &job->state;
  strut_status status = STRUT_OK;
  for (bool first = true; !status; first = false) {
    strut_sweep_refine_learn(job->refinement, job->arguments->output, job->shard, job->slots);
    job->others = strut_refinement_choose(job->refinement);
    strut_refinement_count(job->refinement, job->slots, &wanted, &done);
    if (wanted == done && !first) break;
    status = strut_study_job_run(job, run_points, NULL, error);
    all.computed += state->computed;
    all.seconds += state->seconds;
    add_warnings(&all, state);
  }
  state->computed = all.computed;
  state->seconds = all.seconds;
  state->warning_count = all.warning_count;
  memcpy(state->warnings, all.warnings, sizeof all.warnings);
  return status;
}

/* Failed points do not stop a sweep, but change the exit code. */
static strut_status report_points(const strut_study_job *job, const void *result,
                                  const char *table) {
  const strut_sweep_end end = {&job->state, table};
  (void)result;
  strut_status status = job->report(job, &strut_sweep_end_values, &end, NULL);
  if (!status && !job->shard.count) status = strut_sweep_sensitivity_complete(job);
  return status ? status
                : strut_sweep_judge(job->arguments->listener, job->state.points, job->state.failed,
                                    strut_slots_inaccurate(job->slots));
}

static const strut_study_form points_form = {
    .size = 1, .compute = run_points, .report = report_points};

/* ---- fits ---- */

static strut_status run_fit(strut_study_job *job, const strut_sweep_options *options, void *context,
                            strut_error *error) {
  strut_sweep_options how = *options;
  how.directory = NULL;
  how.worker = job->shard.index, how.workers = job->shard.count;
  return strut_fit_run(&job->study->plan, job->slots, &how, &job->state, context, error);
}

static strut_status write_fit(const strut_study_job *job, void *result, strut_error *error) {
  strut_status status = strut_fit_write(result, job->arguments->output, "model.yaml", error);
  return status ? status : strut_fit_figures(result, job->arguments->output, error);
}

static strut_status report_fit(const strut_study_job *job, const void *of, const char *table) {
  const strut_fit_result *result = of;
  (void)table;
  strut_status status = result->missing
                            ? strut_sweep_refuse_series(job->study, result->missing, result->reason)
                            : STRUT_OK;
  if (status)
    return strut_sweep_study_report(job->arguments->listener, job->study, status,
                                    &(strut_error){0});
  status = job->report(job, &strut_fit_values, result, NULL);
  if (status) return status;
  if (!result->found) {
    strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
               "the model cannot be computed at any start: %s; see 'message' of the table",
               result->reason);
    return STRUT_DIVERGED;
  }
  if (strut_fit_is_identified(result)) return STRUT_OK;
  strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
             "not all parameters are identified%s%s", *result->reason ? ": " : "", result->reason);
  return STRUT_INACCURATE;
}

static void free_fit(void *result) { strut_fit_result_free(result); }

static const strut_study_form fit_form = {sizeof(strut_fit_result), run_fit, write_fit, report_fit,
                                          free_fit};

/* ---- any study ---- */

/* Writes the files, the table last as a sign that they are there, draws and reports. */
static strut_status complete(const strut_study_job *job, const strut_study_form *form,
                             void *result) {
  const strut_arguments *arguments = job->arguments;
  const strut_study *study = job->study->plan.study;
  const bool stages = strut_study_has_stages(study), whole = stages || !job->shard.count;
  strut_slots *const sources[] = {job->slots};
  strut_error error = {0};
  const char *table =
      whole ? strut_arena_format(&job->study->plan.arena, "%s/%s", arguments->output, table_name)
            : "one shard: 'strut sweep --merge' writes the table of all";
  strut_status status = table ? STRUT_OK : STRUT_NO_MEMORY;
  if (!status && form->write) status = form->write(job, result, &error);
  if (!status && whole && (stages || job->refinement))
    status =
        strut_study_table_write_partial(arguments->output, table_name, sources, 1, NULL, &error);
  else if (!status && whole)
    status = strut_study_table_write(arguments->output, table_name, sources, 1, &error);
  if (status) return strut_tell_failure(arguments->listener, status, &error);
  if (whole) strut_file_remove(arguments->output, STRUT_PARTIAL_TABLE);
  if (whole) status = strut_sweep_figures_draw(job, table);
  return status ? status : form->report(job, result, table);
}

static strut_status compute(strut_study_job *job, const strut_study_form *form) {
  strut_error error = {0};
  const strut_listener *listener = job->arguments->listener;
  void *result = strut_allocate(1, form->size);
  strut_status status = result ? STRUT_OK : strut_no_memory(&error, "");
  if (!status && job->study->plan.study->refine.depth)
    status = strut_refinement_create(&job->study->plan, &job->refinement, &error);
  if (!status)
    status = job->refinement ? run_refined(job, &error)
                             : strut_study_job_run(job, form->compute, result, &error);
  strut_sweep_tell_warnings(job);
  strut_tell_failure(listener, status, &error);
  if (!status) status = complete(job, form, result);
  if (job->others && (!status || status == STRUT_DIVERGED || status == STRUT_INACCURATE))
    strut_tell(listener, STRUT_MESSAGE_REMARK, NULL,
               "%lld points of other shards decide what is refined next: run this shard again when "
               "they are done",
               (long long)job->others);
  if (result && form->release) form->release(result);
  strut_refinement_free(job->refinement);
  strut_release(result);
  return status;
}

strut_status strut_study_job_compute(strut_study_job *job) {
  const strut_study *study = job->study->plan.study;
  strut_error error = {0};
  const char *path;
  if (job->arguments->retry && strut_study_has_stages(study))
    return strut_usage_error(job->arguments,
                             "--retry cannot be used with a study that searches or fits: each of "
                             "its points depends on those before it");
  strut_status status = strut_sweep_find_shard(job->arguments, job->study, &job->shard, &path);
  if (status) return status;
  status = strut_study_job_open(job, path, &error);
  if (status) return strut_tell_failure(job->arguments->listener, status, &error);
  return compute(job, study->search   ? &strut_search_form
                      : study->follow ? &strut_follow_form
                      : study->fit    ? &fit_form
                                      : &points_form);
}

/* ---- figures ---- */

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
static void write_partial_branches(const strut_study_job *job) {
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

static strut_status run_branches(strut_study_job *job, const strut_sweep_options *options,
                                 void *context, strut_error *error) {
  const strut_follow_points how = {strut_study_setup_at, &job->study->file};
  (void)context;
  strut_status status =
      strut_follow_points_run(&job->study->plan, job->slots, &how, options, &job->state, error);
  if (status == STRUT_INTERRUPTED) write_partial_branches(job);
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

const strut_study_form strut_follow_form = {sizeof(char *), run_branches, write_branches,
                                            report_branches, free_branches};
