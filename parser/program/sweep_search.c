/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut sweep` of a study that searches. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/study/report/study_report.h"
#include "engine/study/results/study_table.h"
#include "engine/study/sensitivity/sensitivity.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"
#include "parser/yaml/diagnostics.h"

static const char table_name[] = "table.csv";
static const double PAGE = 510.24; /* 180 mm [pt] */

static strut_status run_search(const strut_arguments *arguments, strut_sweep_study *study,
                               strut_sweep_options *how, strut_slots *slots,
                               strut_sweep_state *state, strut_search_result *result,
                               strut_error *error) {
  strut_sweep_display shown = strut_sweep_display_begin(&study->plan, arguments->quiet, slots,
                                                        how->workers ? NULL : arguments->output);
  how->interrupt = strut_interrupt_watch();
  how->progress = strut_sweep_display_show;
  how->progress_context = &shown;
  strut_status status = strut_sweep_texts_write(arguments, study, error);
  if (!status) status = strut_search_run(&study->plan, slots, how, state, result, error);
  strut_sweep_progress_end(&shown.progress);
  strut_error late = {0};
  strut_status synced = strut_slots_sync(slots, &late);
  if (!status && synced) status = strut_fail(error, synced, "%s", late.message);
  if (status && shown.directory && state->done > 0)
    strut_sweep_write_partial(arguments->output, slots);
  if (status == STRUT_INTERRUPTED)
    strut_fail(error, status, "interrupted after %lld points; the same command resumes",
               (long long)state->done);
  return status;
}

/*
 * A row for each search that has found something, of the worst scenario; of two goals, for each point of the
 * front.
 */
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
  strut_status status =
      strut_study_table_write_points(arguments->output, "best.csv", slots, points, count, error);
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
  for (const strut_search_point *p = first; p <= last; p++) {
    double a = x > 0.0 ? (p->objective - best->objective) / x : 0.0;
    double b = y > 0.0 ? (p->second - other->second) / y : 0.0;
    if (found && a * a + b * b >= least) continue;
    least = a * a + b * b;
    found = p;
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
  const strut_search_outcome *o = &result->outcomes[result->worths[i].best];
  *outer = o->outer;
  return &o->best;
}

/*
 * best.yaml of all, whose point is *of_all, and best-N.yaml of each point of the axes where there are
 * several.
 */
static strut_status write_best_scenes(const strut_arguments *arguments,
                                      const strut_sweep_plan *plan,
                                      const strut_search_result *result,
                                      const strut_search_point **of_all, strut_error *error) {
  const strut_study_search *search = plan->study->search;
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
  *of_all = best;
  return status;
}

/* The figures of the best of all. A search that found none has none. */
static strut_status draw_winner(const strut_arguments *arguments, strut_sweep_plan *plan,
                                const strut_search_point *best) {
  strut_error error = {0};
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < plan->study->figure_count && best && !status; i++) {
    const strut_study_figure *f = &plan->study->figures[i];
    if (f->kind != STRUT_FIGURE_WINNER) continue;
    const char *path = strut_arena_format(&plan->arena, "%s/%s.svg", arguments->output, f->name);
    if (!path) return strut_print_out_of_memory();
    status = strut_search_winner_figure(plan, f, path, best, PAGE, strut_interrupt_watch(), &error);
    if (status) strut_print_failure(status, &error);
  }
  return status;
}

static strut_status complete(const strut_arguments *arguments, strut_sweep_study *study,
                             strut_slots *slots, const strut_sweep_state *state,
                             const strut_search_result *result) {
  strut_error error = {0};
  const strut_search_point *best = NULL;
  strut_slots *const sources[] = {slots};
  const char *table =
      strut_arena_format(&study->plan.arena, "%s/%s", arguments->output, table_name);
  if (!table) return strut_print_out_of_memory();
  strut_status status = write_best_rows(arguments, slots, result, &error);
  if (!status) status = write_best_scenes(arguments, &study->plan, result, &best, &error);
  if (!status) /* last, as a sign that the searches are finished */
    status =
        strut_study_table_write_partial(arguments->output, table_name, sources, 1, NULL, &error);
  if (status) return strut_print_failure(status, &error);
  strut_file_remove(arguments->output, STRUT_PARTIAL_TABLE);
  status = strut_sweep_figures_draw(&study->plan, arguments->output, table, NULL);
  if (!status) status = draw_winner(arguments, &study->plan, best);
  if (!status && (!arguments->quiet || arguments->json))
    status =
        strut_print_block(strut_search_report(&study->plan, result, state, table, arguments->json));
  if (status) return status;
  bool found = false;
  for (size_t i = 0; i < result->worth_count; i++)
    found = found || result->outcomes[result->worths[i].best].best.violation <= 0.0;
  for (size_t i = 0; i < result->front_count; i++) found = found || result->fronts[i].count > 0;
  if (!found) {
    fputs("strut: no point was found that is computed and meets all conditions\n", stderr);
    return STRUT_DIVERGED;
  }
  if (!best || !strut_slots_is_inaccurate(slots, best->worst)) return STRUT_OK;
  fputs("strut: the best point is less accurate than requested\n", stderr);
  return STRUT_INACCURATE;
}

/* The table is written at the end. */
static bool is_finished(const char *directory) {
  strut_arena arena = {0};
  const char *table = strut_arena_format(&arena, "%s/%s", directory, table_name);
  bool finished = table && access(table, F_OK) == 0;
  strut_arena_free(&arena);
  return finished;
}

strut_status strut_sweep_search_status(strut_slots *slots, const char *directory, bool json) {
  char text[300];
  const strut_slots_description *plan = strut_slots_description_of(slots);
  bool over = is_finished(directory);
  long long failed = (long long)strut_slots_failed(slots);
  long long done = (long long)(plan->count - strut_slots_missing(slots));
  snprintf(text, sizeof text,
           json ? "{\"points\": %lld, \"done\": %lld, \"failed\": %lld, \"finished\": %s}\n"
                : "at most %lld points, %lld done, %lld of the done failed: %s\n",
           (long long)plan->count, done, failed,
           json   ? over ? "true" : "false"
           : over ? "the searches are finished"
                  : "the searches are not finished");
  return strut_print(text);
}

strut_status strut_sweep_search_check_workers(strut_sweep_study *study) {
  static const char *const words[] = {
#define STRUT_SEARCH_METHOD_WORD(name, word) word,
      STRUT_SEARCH_METHOD_TABLE(STRUT_SEARCH_METHOD_WORD)
#undef STRUT_SEARCH_METHOD_WORD
  };
  strut_study_file *file = &study->file;
  if (strut_search_is_parallel(&study->plan)) return STRUT_OK;
  const strut_tree *search = strut_tree_find(file->document.root, "search", NULL);
  const strut_tree *method = strut_tree_find(search, "method", NULL);
  strut_diagnose(&file->diagnostics, (method ? method : search)->place,
                 "workers cannot share a search by '%s', which computes one point after another: "
                 "give 'starts' for several searches side by side, or the method 'cma'",
                 words[file->study.search->method]);
  return strut_sweep_study_report(study, STRUT_BAD_SCENE, &(strut_error){0});
}

strut_status strut_sweep_search(const strut_arguments *arguments, strut_sweep_study *study,
                                strut_shard worker) {
  strut_slots *slots = NULL;
  strut_sweep_state state = {0};
  strut_search_result result = {0};
  strut_error error = {0};
  const char *path = strut_shard_path(arguments->output, (strut_shard){0}, &study->plan.arena);
  if (!path) return strut_print_out_of_memory();
  strut_sweep_options how = {.worker = worker.index, .workers = worker.count};
  strut_status status = strut_sweep_texts_check(arguments, study, &error);
  if (!status) status = strut_sweep_figures_check_files(&study->plan, arguments->output, &error);
  if (!status) status = strut_directory_create(arguments->output, &error);
  if (!status) status = strut_shard_begin(arguments->output, (strut_shard){0}, &error);
  if (!status)
    status = (worker.count ? strut_slots_open_shared : strut_slots_open)(path, &study->slots,
                                                                         &slots, &error);
  if (!status && strut_slots_missing(slots) == strut_slots_description_of(slots)->count)
    strut_file_remove(arguments->output, table_name); /* of another search */
  if (!status) status = run_search(arguments, study, &how, slots, &state, &result, &error);
  strut_sweep_print_warnings(&state);
  strut_print_failure(status, &error);
  if (!status) status = complete(arguments, study, slots, &state, &result);
  strut_search_result_free(&result);
  strut_slots_close(slots);
  return status;
}

/* Refined studies: what the files of all shards hold, and their table. */

/* Are the files of the same study? */
static bool alike(const strut_slots_description *a, const strut_slots_description *b) {
  return a->points == b->points && a->column_count == b->column_count &&
         memcmp(a->hash, b->hash, sizeof a->hash) == 0;
}

void strut_sweep_refine_learn(strut_refinement *refinement, const char *directory,
                              strut_shard shard, strut_slots *own) {
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
      if (alike(&there, strut_slots_description_of(own))) strut_refinement_learn(refinement, slots);
      strut_slots_close(slots);
    }
  strut_arena_free(&arena);
}

strut_status strut_sweep_refine_status(const strut_sweep_plan *plan, const char *directory,
                                       strut_slots *slots, bool json) {
  strut_refinement *r = NULL;
  strut_error error = {0};
  int64_t wanted, done;
  char text[300];
  strut_status status = strut_refinement_create(plan, &r, &error);
  if (status) return strut_print_failure(status, &error);
  strut_sweep_refine_learn(r, directory, (strut_shard){0}, slots);
  strut_refinement_choose(r);
  strut_refinement_count(r, slots, &wanted, &done);
  long long failed = (long long)strut_slots_failed(slots);
  snprintf(text, sizeof text,
           json ? "{\"points\": %lld, \"done\": %lld, \"failed\": %lld, \"most_points\": %lld}\n"
                : "%lld points wanted so far, %lld done, %lld failed; the finest grid has %lld\n",
           (long long)wanted, (long long)done, failed, (long long)plan->points);
  strut_refinement_free(r);
  return strut_print(text);
}

/* ---- shards ---- */

/* Opens the files of all shards; those that are missing stay NULL. */
static strut_slots **open_shards(const char *directory, const strut_shards_found *found,
                                 strut_arena *arena) {
  size_t count = found->count ? (size_t)found->count : 1;
  strut_slots **slots = strut_arena_allocate(arena, count, sizeof *slots);
  for (size_t k = 0; slots && k < count; k++) {
    strut_slots_description there;
    const char *path = strut_shard_path(directory, (strut_shard){(int64_t)k, found->count}, arena);
    if (path && (!found->count || found->there[k])) strut_slots_read(path, &slots[k], &there, NULL);
  }
  return slots;
}

/* bad: failed and inaccurate points. */
static strut_status merge_shards(const strut_sweep_study *study, const char *directory,
                                 strut_arena *arena, int64_t *rows, int64_t bad[2],
                                 strut_error *error) {
  strut_shards_found found = {0};
  strut_refinement *r = NULL;
  strut_status status = strut_shards_find(directory, &found, arena, error);
  strut_slots **slots = status ? NULL : open_shards(directory, &found, arena);
  size_t count = found.count ? (size_t)found.count : 1;
  if (!status && !slots) status = strut_no_memory(error, "");
  if (!status) status = strut_refinement_create(&study->plan, &r, error);
  for (size_t k = 0; k < count && !status; k++) {
    if (!slots[k])
      status = strut_fail(error, STRUT_FILE_TROUBLE, "shard %zu of %zu is missing", k, count);
    else if (strut_slots_description_of(slots[k])->points != study->plan.points ||
             memcmp(strut_slots_description_of(slots[k])->hash,
                    strut_slots_description_of(slots[0])->hash, STRUT_STUDY_HASH) != 0)
      status = strut_fail(error, STRUT_USAGE, "shard %zu of %zu is of another study", k, count);
    if (!status) strut_refinement_learn(r, slots[k]);
    if (!status) bad[0] += strut_slots_failed(slots[k]);
    if (!status) bad[1] += strut_slots_inaccurate(slots[k]);
  }
  int64_t unknown = status ? 0 : strut_refinement_choose(r);
  if (unknown)
    status = strut_fail(error, STRUT_FILE_TROUBLE,
                        "%lld points of the refinement are missing: run all shards again",
                        (long long)unknown);
  if (!status)
    status = strut_study_table_write_partial(directory, "table.csv", slots, count, rows, error);
  for (size_t k = 0; slots && k < count; k++) strut_slots_close(slots[k]);
  strut_refinement_free(r);
  return status;
}

/* Each worker of a search writes all files itself. Has one? */
static strut_status check_searches(const char *directory, bool quiet) {
  strut_error error = {0};
  if (!is_finished(directory))
    return strut_print_failure(
        strut_fail(&error, STRUT_FILE_TROUBLE,
                   "'%s': the searches are not finished: run the study again to resume them",
                   directory),
        &error);
  if (!quiet) printf("%s/%s: the searches are finished\n", directory, table_name);
  return STRUT_OK;
}

strut_status strut_sweep_refine_merge(const strut_arguments *arguments, bool *merged) {
  strut_sweep_study study = {0};
  strut_arena arena = {0};
  strut_error error = {0};
  strut_arguments inner = *arguments;
  int64_t rows = 0, bad[2] = {0};
  const char *directory = arguments->model;
  inner.model = strut_arena_format(&arena, "%s/study.yaml", directory);
  *merged = false;
  if (!inner.model || access(inner.model, R_OK) != 0) {
    strut_arena_free(&arena);
    return STRUT_OK;
  }
  strut_status status = strut_study_open(inner.model, NULL, 0, &study.file, &error);
  *merged = !status && study.file.study.refine.depth > 0;
  if (!status && study.file.study.search) {
    *merged = true;
    status = check_searches(directory, arguments->quiet);
    strut_study_close(&study.file);
    strut_arena_free(&arena);
    return status;
  }
  strut_study_close(&study.file);
  error = (strut_error){0};
  if (*merged) status = strut_sweep_study_open(&inner, &study);
  if (*merged && !status)
    status =
        strut_print_failure(merge_shards(&study, directory, &arena, &rows, bad, &error), &error);
  if (*merged && !status && !arguments->quiet)
    printf("%s/table.csv: %lld points\n", directory, (long long)rows);
  if (*merged && !status) status = strut_sweep_judge(rows, bad[0], bad[1]);
  if (*merged) strut_sweep_study_close(&study);
  strut_arena_free(&arena);
  return status;
}

/* What a sensitivity analysis adds to a sweep: its table, its figure and its report. */

static const char *column_name(const void *context, size_t i) {
  const strut_sweep_plan *plan = context;
  return i < plan->column_count ? plan->columns[i].name : NULL;
}

strut_status strut_sweep_sensitivity_check(const strut_sweep_plan *plan, strut_error *error) {
  const char *missing;
  if (!plan->study->sensitivity.wanted ||
      strut_sensitivity_check(plan->study, plan->columns, plan->column_count, &missing))
    return STRUT_OK;
  const char *near = strut_did_you_mean(missing, column_name, plan);
  return strut_fail(error, STRUT_BAD_SCENE,
                    "the sensitivity analysis: the table has no column '%.60s'%s%s%s; 'keep' lists "
                    "what it has",
                    missing, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

strut_status strut_sweep_sensitivity_complete(const strut_sweep_plan *plan, strut_slots *slots,
                                              const char *directory, bool report) {
  strut_sensitivity_result result = {0};
  strut_arena arena = {0};
  strut_error error = {0};
  bool drawn;
  if (!plan->study->sensitivity.wanted) return STRUT_OK;
  const char *path = strut_arena_format(&arena, "%s/sensitivity.svg", directory);
  strut_status status = path ? STRUT_OK : strut_no_memory(&error, "");
  if (!status) status = strut_sensitivity_find(plan->study, slots, &result, &error);
  if (!status) status = strut_sensitivity_write(plan->study, slots, &result, directory, &error);
  if (!status)
    status = strut_sensitivity_figure(&(strut_plot){.path = path}, plan->study, slots, &result,
                                      &drawn, &error);
  if (status) strut_print_failure(status, &error);
  if (!status && report)
    status = strut_print_block(strut_sensitivity_report(plan, slots, &result, directory));
  strut_arena_free(&result.arena);
  strut_arena_free(&arena);
  return status;
}
