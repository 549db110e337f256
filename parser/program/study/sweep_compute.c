/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes a study that is open, and writes its results: all but those that follow motions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/study/fit/fit.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "engine/study/sensitivity/sensitivity.h"
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

/* Takes note of what all files of a directory hold: `own`, and those of other shards. */
static void learn(strut_refinement *refinement, const char *directory, strut_shard shard,
                  strut_slots *own) {
  strut_shards_found found = {0};
  strut_arena arena = {0};
  strut_refinement_learn(refinement, own);
  if (shard.count && strut_shards_find(directory, &found, &arena, NULL) == STRUT_OK)
    for (int64_t k = 0; k < found.count; k++) {
      strut_slots *slots = NULL;
      strut_slots_description there;
      if (k == shard.index || found.count != shard.count || !found.there[k]) continue;
      const char *path = strut_shard_path(directory, (strut_shard){k, found.count}, &arena);
      if (!path || strut_slots_read(path, &slots, &there, NULL) != STRUT_OK) continue;
      const strut_slots_description *mine = strut_slots_description_of(own);
      if (there.points == mine->points && there.column_count == mine->column_count &&
          memcmp(there.hash, mine->hash, sizeof there.hash) == 0) /* of the same study */
        strut_refinement_learn(refinement, slots);
      strut_slots_close(slots);
    }
  strut_arena_free(&arena);
}

strut_status strut_sweep_refine_status(const strut_sweep_plan *plan, const char *directory,
                                       strut_slots *slots, strut_slots_progress *progress,
                                       strut_error *error) {
  strut_refinement *refinement = NULL;
  strut_status status = strut_refinement_create(plan, &refinement, error);
  if (status) return status;
  learn(refinement, directory, (strut_shard){0}, slots);
  strut_refinement_choose(refinement);
  strut_refinement_count(refinement, slots, &progress->points, &progress->done);
  progress->most_points = plan->points;
  strut_refinement_free(refinement);
  return STRUT_OK;
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
    learn(job->refinement, job->arguments->output, job->shard, job->slots);
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

/* Writes sensitivity.csv and sensitivity.svg, and reports what is in the former. */
static strut_status complete_sensitivity(const strut_study_job *job) {
  const strut_arguments *arguments = job->arguments;
  const strut_sweep_plan *plan = &job->study->plan;
  strut_slots *slots = job->slots;
  const char *directory = arguments->output;
  strut_sensitivity_result result = {0};
  strut_table table = {0};
  strut_arena arena = {0};
  strut_error error = {0};
  bool drawn;
  if (!plan->study->sensitivity.wanted) return STRUT_OK;
  const strut_plot plot = {.path = strut_arena_format(&arena, "%s/sensitivity.svg", directory),
                           .texts = plan->texts};
  const char *from = strut_arena_format(&arena, "%s/sensitivity.csv", directory);
  strut_status status = plot.path && from ? STRUT_OK : strut_no_memory(&error, "");
  if (!status) status = strut_sensitivity_find(plan->study, slots, &result, &error);
  if (!status) status = strut_sensitivity_write(&result, directory, &error);
  if (!status) status = strut_table_read(arguments->listener, from, &table);
  if (!status) {
    strut_sweep_show_units(plan, &table);
    status = strut_sensitivity_figure(&plot, plan->study, &table, &drawn, &error);
  }
  strut_tell_failure(arguments->listener, status, &error);
  if (!status && !arguments->json)
    status = job->report(job, &strut_sensitivity_values, &result, NULL);
  strut_arena_free(&table.arena);
  strut_arena_free(&result.arena);
  strut_arena_free(&arena);
  return status;
}

/* Failed points do not stop a sweep, but change the exit code. */
static strut_status report_points(const strut_study_job *job, const void *result,
                                  const char *table) {
  const strut_sweep_end end = {&job->state, table};
  (void)result;
  strut_status status = job->report(job, &strut_sweep_end_values, &end, NULL);
  if (!status && !job->shard.count) status = complete_sensitivity(job);
  return status ? status
                : strut_sweep_judge(job->arguments->listener, job->state.points, job->state.failed,
                                    strut_slots_inaccurate(job->slots));
}

static const strut_study_form points_form = {
    .size = 1, .compute = run_points, .report = report_points};

/* ---- searches ---- */

/* What was found, and its best point of all; NULL: none. */
typedef struct searched {
  strut_search_result found;
  const strut_search_point *best;
} searched;

static strut_status run_search(strut_study_job *job, const strut_sweep_options *options,
                               void *context, strut_error *error) {
  strut_sweep_options how = *options;
  how.directory = NULL;
  how.worker = job->shard.index;
  how.workers = job->shard.count;
  job->searched = &((searched *)context)->found;
  return strut_search_run(&job->study->plan, job->slots, &how, &job->state,
                          &((searched *)context)->found, error);
}

/* A row for each search that has found something, of the worst scenario; of two goals, for each point of the front. */
static strut_status write_best_rows(const strut_arguments *arguments, strut_slots *slots,
                                    const strut_search_result *result, strut_error *error) {
  size_t count = 0, room = result->outcome_count;
  for (size_t i = 0; i < result->front_count; i++) room += result->fronts[i].count;
  int64_t *points = strut_allocate(room, sizeof *points);
  if (!points) return strut_no_memory(error, "");
  for (size_t i = 0; i < result->front_count; i++)
    for (size_t k = 0; k < result->fronts[i].count; k++)
      points[count++] = result->fronts[i].points[k].worst;
  for (size_t i = 0; i < result->outcome_count && !result->front_count; i++)
    if (result->outcomes[i].best.evaluation >= 0) points[count++] = result->outcomes[i].best.worst;
  const strut_slot_rows rows = {&slots, 1, points, (int64_t)count, true};
  strut_status status = strut_study_table_write(arguments->output, "best.csv", &rows, NULL, error);
  strut_release(points);
  return status;
}

/* The scene of a best point as a file that runs. */
static strut_status write_scene(const strut_arguments *arguments, const strut_sweep_plan *plan,
                                const strut_search_point *best, const char *name,
                                strut_error *error) {
  strut_setup setup;
  strut_study_value *values = strut_allocate(plan->axis_columns + 1, sizeof *values);
  if (!values) return strut_no_memory(error, "");
  strut_search_values(plan, best->worst, best->values, values);
  strut_status status = plan->scenes.setup(plan->scenes.context, values, &setup, error);
  strut_release(values);
  if (status) return status;
  char *text = plan->scenes.text(&setup);
  status = text ? strut_file_write_text(arguments->output, name, text, error)
                : strut_no_memory(error, "");
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

/* Of a front, which is in order of the first goal: the point nearest to the best of both, in ranges. */
static const strut_search_point *compromise_of(const strut_search_front *front, bool maximise) {
  const strut_search_point *first = front->points, *last = front->points + front->count - 1;
  const strut_search_point *best = maximise ? last : first, *other = maximise ? first : last;
  const strut_search_point *found = NULL;
  double x = last->objective - first->objective, y = fabs(last->second - first->second);
  double least = 0.0;
  for (const strut_search_point *point = first; point <= last; point++) {
    double a = x > 0.0 ? (point->objective - best->objective) / x : 0.0;
    double b = y > 0.0 ? (point->second - other->second) / y : 0.0;
    if (found && a * a + b * b >= least) continue;
    least = a * a + b * b;
    found = point;
  }
  return found;
}

/* What is written of each point of the axes: its best, or the compromise of its front; NULL: nothing. */
static const strut_search_point *pick(const strut_search_result *result, bool maximise, size_t i,
                                      int64_t *outer) {
  if (result->front_count) {
    *outer = (int64_t)i;
    return result->fronts[i].count ? compromise_of(&result->fronts[i], maximise) : NULL;
  }
  const strut_search_outcome *outcome = &result->outcomes[result->worths[i].best];
  *outer = outcome->outer;
  return &outcome->best;
}

/* best.yaml of all, and best-N.yaml of each point of the axes where there are several. */
static strut_status write_best_scenes(const strut_arguments *arguments,
                                      const strut_sweep_plan *plan, searched *self,
                                      strut_error *error) {
  const strut_study_search *search = plan->study->search;
  const strut_search_result *result = &self->found;
  const strut_search_point *best = NULL;
  strut_status status = STRUT_OK;
  bool several = result->outcome_count > (size_t)search->starts;
  size_t count = result->front_count ? result->front_count : result->worth_count;
  for (size_t i = 0; i < count && !status; i++) {
    int64_t outer;
    const strut_search_point *found = pick(result, search->maximise, i, &outer);
    char name[40];
    if (!found) continue;
    snprintf(name, sizeof name, "best-%lld.yaml", (long long)outer + 1);
    if (several) status = write_scene(arguments, plan, found, name, error);
    if (!best || strut_search_better(search, found, best)) best = found;
  }
  if (!status && best) status = write_scene(arguments, plan, best, "best.yaml", error);
  self->best = best;
  return status;
}

static strut_status write_best(const strut_study_job *job, void *result, strut_error *error) {
  searched *self = result;
  strut_status status = write_best_rows(job->arguments, job->slots, &self->found, error);
  return status ? status : write_best_scenes(job->arguments, &job->study->plan, self, error);
}

/* The figures of the best of all. A search that found none has none. */
static strut_status draw_winner(const strut_study_job *job, const strut_search_point *best) {
  strut_sweep_plan *plan = &job->study->plan;
  strut_error error = {0};
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < plan->study->figure_count && best && !status; i++) {
    const strut_study_figure *figure = &plan->study->figures[i];
    if (figure->kind != STRUT_FIGURE_WINNER) continue;
    const char *path =
        strut_arena_format(&plan->arena, "%s/%s.svg", job->arguments->output, figure->name);
    status = path ? strut_search_winner_figure(plan, figure, path, best, job->interrupt, &error)
                  : STRUT_NO_MEMORY;
  }
  return strut_tell_failure(job->arguments->listener, status, &error);
}

static strut_status report_search(const strut_study_job *job, const void *of, const char *table) {
  const searched *self = of;
  const strut_search_result *result = &self->found;
  const strut_sweep_plan *plan = &job->study->plan;
  const strut_search_report report = {plan, plan->study->search, result, {&job->state, table}};
  strut_status status = draw_winner(job, self->best);
  if (!status) status = job->report(job, &strut_search_report_values, &report, NULL);
  if (status) return status;
  bool found = false;
  for (size_t i = 0; i < result->worth_count; i++)
    found = found || result->outcomes[result->worths[i].best].best.violation <= 0.0;
  for (size_t i = 0; i < result->front_count; i++) found = found || result->fronts[i].count > 0;
  if (!found) {
    strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
               "no point was found that is computed and meets all conditions");
    return STRUT_DIVERGED;
  }
  if (!self->best || !strut_slots_is_inaccurate(job->slots, self->best->worst)) return STRUT_OK;
  strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
             "the best point is less accurate than requested");
  return STRUT_INACCURATE;
}

static void free_searched(void *result) { strut_search_result_free(&((searched *)result)->found); }

static const strut_study_form search_form = {sizeof(searched), run_search, write_best,
                                             report_search, free_searched};

/* The table is written at the end. */
bool strut_sweep_search_is_finished(const char *directory) {
  strut_arena arena = {0};
  const char *table = strut_arena_format(&arena, "%s/%s", directory, table_name);
  bool finished = table && access(table, F_OK) == 0;
  strut_arena_free(&arena);
  return finished;
}

strut_status strut_sweep_search_check_workers(const strut_arguments *arguments,
                                              strut_sweep_study *study) {
  static const char *const words[] = {
#define STRUT_SEARCH_METHOD_WORD(name, word) word,
      STRUT_SEARCH_METHOD_TABLE(STRUT_SEARCH_METHOD_WORD)};
  strut_study_file *file = &study->file;
  if (strut_search_is_parallel(&study->plan)) return STRUT_OK;
  const strut_tree *search = strut_tree_find(file->document.root, "search", NULL);
  const strut_tree *method = strut_tree_find(search, "method", NULL);
  strut_diagnose(&file->diagnostics, (method ? method : search)->place,
                 "workers cannot share a search by '%s', which computes one point after another: "
                 "give 'starts' for several searches side by side, or the method 'cma'",
                 words[file->study.search->method]);
  return strut_sweep_study_report(arguments->listener, study, STRUT_BAD_SCENE, &(strut_error){0});
}

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
  if (result->missing)
    return strut_sweep_study_report(
        job->arguments->listener, job->study,
        strut_sweep_refuse_series(job->study, result->missing, result->reason, ""),
        &(strut_error){0});
  strut_status status = job->report(job, &strut_fit_values, result, NULL);
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

static void free_fit(void *result) { strut_arena_free(&((strut_fit_result *)result)->arena); }

static const strut_study_form fit_form = {sizeof(strut_fit_result), run_fit, write_fit, report_fit,
                                          free_fit};

/* ---- any study ---- */

/* Writes the files, the table last as a sign that they are there, draws and reports. */
static strut_status complete(const strut_study_job *job, const strut_study_form *form,
                             void *result) {
  const strut_arguments *arguments = job->arguments;
  const strut_study *study = job->study->plan.study;
  const bool stages = strut_study_has_stages(study), whole = stages || !job->shard.count;
  const strut_slot_rows rows = {
      .sources = &job->slots, .count = 1, .partial = stages || job->refinement};
  strut_error error = {0};
  const char *table =
      whole ? strut_arena_format(&job->study->plan.arena, "%s/%s", arguments->output, table_name)
            : "one shard: 'strut sweep --merge' writes the table of all";
  strut_status status = table ? STRUT_OK : STRUT_NO_MEMORY;
  if (!status && form->write) status = form->write(job, result, &error);
  if (!status && whole)
    status = strut_study_table_write(arguments->output, table_name, &rows, NULL, &error);
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
  return compute(job, study->search   ? &search_form
                      : study->follow ? &strut_follow_form
                      : study->fit    ? &fit_form
                                      : &points_form);
}
