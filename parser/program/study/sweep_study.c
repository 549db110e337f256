/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/checksum.h"
#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/study/fit/fit.h"
#include "engine/study/results/study_table.h"
#include "engine/study/search/search.h"
#include "engine/study/sweep/sweep.h"
#include "parser/language/study/read_study.h"
#include "parser/language/write/write_scene.h"
#include "parser/language/yaml/document.h"
#include "parser/program/command/scene_options.h"
#include "parser/program/study/sweep.h"

enum { MOST_MESSAGES = 50 };

strut_status strut_sweep_study_report(const strut_listener *listener, strut_sweep_study *study,
                                      strut_status status, const strut_error *error) {
  if (status != STRUT_BAD_SCENE || error->message[0])
    return strut_tell_failure(listener, status, error);
  const char *messages = strut_study_messages(&study->file, MOST_MESSAGES);
  return strut_tell_lines(listener, messages) ? STRUT_NO_MEMORY : status;
}

/* Tries a point; of motions that are followed, at both ends of the parameter. */
static strut_status try_point(strut_study_file *file, const strut_study_value *values) {
  const strut_study_follow *follow = file->study.follow;
  strut_status status = strut_study_try(file, values, follow ? &follow->from : NULL);
  return status || !follow ? status : strut_study_try(file, values, &follow->to);
}

/* Tries each of the texts that a search chooses among, and what matches set, other values being the first ones. */
static strut_status try_choices(strut_study_file *file, strut_study_value *values) {
  const strut_study_search *search = file->study.search;
  const strut_study_fit *fit = file->study.fit;
  strut_status status = STRUT_OK;
  for (size_t i = 0; search && i < search->variable_count; i++) {
    const strut_search_variable *variable = &search->variables[i];
    strut_study_value *value = &values[search->column + i], first = *value;
    for (size_t k = 0; variable->word && k < variable->choice_count && !status; k++) {
      value->word = variable->words[k];
      status = try_point(file, values);
    }
    *value = first;
  }
  for (size_t m = 1; fit && fit->set_count && m < fit->match_count && !status; m++) {
    strut_study_value *set = &values[fit->column + fit->variable_count];
    memcpy(set, fit->matches[m].values, fit->set_count * sizeof *set);
    status = try_point(file, values);
  }
  strut_grid_values(&file->study, 0, values);
  return status;
}

/* Tries the first point, each choice, then both ends of each axis, with the others at their first values. */
static strut_status try_ends(strut_study_file *file) {
  const strut_study *study = &file->study;
  strut_study_value *values = strut_allocate(file->column_count + 1, sizeof *values);
  if (!values) return STRUT_NO_MEMORY;
  strut_grid_values(study, 0, values);
  strut_status status = try_point(file, values);
  if (!status) status = try_choices(file, values);
  int64_t stride = 1;
  for (size_t a = study->axis_count; a-- > 0 && !status;) {
    bool evaluations = study->search && a == study->search->axis; /* no parameters */
    if (study->axes[a].count > 1 && !evaluations) {
      strut_grid_values(study, stride * (study->axes[a].count - 1), values);
      status = try_point(file, values);
    }
    stride *= study->axes[a].count;
  }
  strut_release(values);
  return status;
}

static strut_status apply_options(const void *context, strut_setup *setup) {
  return strut_run_options_apply(context, setup);
}

/* Makes the scenes of the open study those that options such as --accuracy ask for; STRUT_USAGE. */
static strut_status adjust_scenes(const strut_arguments *arguments, strut_study_file *file) {
  const strut_option *first = strut_run_option_given(arguments, 0);
  if (!first) return STRUT_OK;
  if (file->study.compute != STRUT_COMPUTE_RUN || file->study.follow)
    return strut_usage_error(arguments, "--%s is for studies of runs", first->name);
  file->adjustment =
      (strut_study_adjustment){apply_options, arguments, strut_run_options_purpose(arguments)};
  return STRUT_OK;
}

const char *const *strut_sweep_words(const strut_arguments *arguments, strut_arena *arena,
                                     size_t *count) {
  size_t options = 0, n = 0;
  while (strut_run_option_given(arguments, options)) options++;
  const char **words =
      strut_arena_allocate(arena, 2 * (arguments->override_count + options) + 1, sizeof *words);
  for (size_t i = 0; words && i < arguments->override_count; i++) {
    const strut_setting *override = &arguments->overrides[i];
    words[n++] = "--set";
    words[n++] = strut_arena_format(arena, "%s=%s", override->name, override->text);
    if (!words[n - 1]) return NULL;
  }
  for (size_t i = 0; words && i < options; i++) {
    const strut_option *option = strut_run_option_given(arguments, i);
    words[n++] = strut_arena_format(arena, "--%s", option->name);
    words[n++] = strut_given_text(option, arguments);
    if (!words[n - 2]) return NULL;
  }
  *count = n;
  return words;
}

/* Hashes everything that decides the results: the study, its model, the options and the version. */
static bool identify(const strut_arguments *arguments, const strut_study_file *file,
                     uint8_t hash[STRUT_STUDY_HASH]) {
  char *text = strut_study_identity(file);
  if (!text) return false;
  size_t length = strlen(text);
  for (uint64_t i = 0; i < 2; i++) {
    uint64_t seed = strut_checksum(STRUT_VERSION, strlen(STRUT_VERSION), i);
    uint64_t sum = strut_checksum(text, length, seed);
    for (size_t k = 0; strut_run_option_given(arguments, k); k++) {
      const strut_option *option = strut_run_option_given(arguments, k);
      const char *value = strut_given_text(option, arguments);
      sum = strut_checksum(option->name, strlen(option->name), sum);
      sum = strut_checksum(value, strlen(value), sum);
    }
    for (size_t k = 0; k < 8; k++) hash[8 * i + k] = (uint8_t)(sum >> 8 * k);
  }
  strut_release(text);
  return true;
}

/* The expressions of a search are those of the table's columns. */
static strut_status bind_search(strut_sweep_study *study, strut_error *error) {
  strut_sweep_plan *plan = &study->plan;
  strut_table_name *names = strut_arena_allocate(&plan->arena, plan->column_count, sizeof *names);
  if (!names) return strut_no_memory(error, "");
  for (size_t i = 0; i < plan->column_count; i++)
    names[i] =
        (strut_table_name){plan->columns[i].name, plan->columns[i].unit, plan->columns[i].word};
  strut_status status = strut_study_search_bind(&study->file, names, plan->column_count);
  return status ? status : strut_search_add_columns(plan, error);
}

strut_status strut_sweep_refuse_series(strut_sweep_study *study, const strut_fit_series *at,
                                       const char *why, const char *hint) {
  strut_diagnose(&study->file.diagnostics,
                 strut_place_at(at->place.line, at->place.column, (uint32_t)strlen(at->of)), "%s%s",
                 why, hint);
  return STRUT_BAD_SCENE;
}

/* Column i of a table behind those of its axes, for suggestions. */
static const char *kept_name(const void *table, size_t i) {
  const strut_sweep_plan *plan = table;
  return plan->axis_columns + i < plan->column_count ? plan->columns[plan->axis_columns + i].name
                                                     : NULL;
}

/* Columns of a fit; what does not fit the model is reported where the study says it. */
static strut_status bind_fit(strut_sweep_study *study, strut_error *error) {
  strut_fit_refusal refusal;
  strut_status status = strut_fit_add_columns(&study->plan, &refusal, error);
  if (refusal.series) {
    strut_near near = strut_near_to(refusal.series->of, kept_name, &refusal.table);
    strut_sweep_refuse_series(study, refusal.series, error->message, near.text);
    *error = (strut_error){0};
  }
  strut_sweep_plan_free(&refusal.table);
  return status;
}

/* Points to the name that the model does not have. */
static strut_status place_fault(strut_sweep_study *study, strut_error *error) {
  const strut_study_fault *fault = &study->plan.fault;
  const strut_tree *key = strut_tree_find(study->file.document.root, fault->key, NULL), *at = key;
  if (!key) return STRUT_BAD_SCENE;
  for (const strut_tree *part = key->first; part; part = part->next)
    if (part->kind == STRUT_TREE_SCALAR && strcmp(part->text, fault->name) == 0) at = part;
  strut_diagnose(&study->file.diagnostics, at->place, "%s", error->message);
  *error = (strut_error){0};
  return STRUT_BAD_SCENE;
}

/* What a sensitivity analysis analyses are columns. */
static strut_status check_sensitivity(strut_sweep_study *study) {
  const strut_sweep_plan *plan = &study->plan;
  strut_study_file *file = &study->file;
  if (!plan->study->sensitivity.wanted) return STRUT_OK;
  const strut_tree *analysis = strut_tree_find(file->document.root, "sensitivity", NULL);
  const strut_tree *of = strut_tree_find(analysis, "of", NULL);
  for (const strut_tree *name = of->first; name; name = name->next) {
    const strut_near near =
        strut_near_to(name->text, strut_row_name, STRUT_NAMED(plan->columns, plan->column_count));
    if (strut_slot_named(plan->columns, plan->column_count, name->text) < plan->column_count)
      continue;
    strut_diagnose(&file->diagnostics, name->place,
                   "the sensitivity analysis: the table has no column '%.60s'%s", name->text,
                   *near.text ? near.text : "; 'keep' lists what it has");
  }
  return file->diagnostics.count ? STRUT_BAD_SCENE : STRUT_OK;
}

strut_status strut_sweep_study_try(const strut_arguments *arguments, strut_sweep_study *study,
                                   strut_error *error) {
  strut_study_file *file = &study->file;
  const strut_sweep_scenes scenes = {strut_study_setup, strut_setup_write, file, strut_study_vary};
  strut_status status = strut_study_open(arguments->model, arguments->overrides,
                                         arguments->override_count, file, error);
  if (!status) status = adjust_scenes(arguments, file);
  if (!status) status = try_ends(file);
  if (!status) {
    status = strut_sweep_plan_make(&file->study, &scenes, &study->plan, error);
    if (status && study->plan.fault.key) status = place_fault(study, error);
    study->plan.texts = arguments->svg_text;
  }
  if (!status && file->study.search) status = bind_search(study, error);
  if (!status && file->study.follow) status = strut_sweep_follow_check(study, error);
  if (!status && file->study.fit) status = bind_fit(study, error);
  if (!status) status = strut_sweep_figures_check(study);
  if (!status) status = check_sensitivity(study);
  if (status) return status;
  if (!identify(arguments, file, study->slots.hash)) return strut_no_memory(error, "");
  study->slots.version = STRUT_VERSION;
  study->slots.name = file->study.name;
  study->slots.points = study->slots.count = study->plan.points;
  study->slots.columns = study->plan.columns;
  study->slots.column_count = study->plan.column_count;
  return STRUT_OK;
}

strut_status strut_sweep_study_open(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_error error = {0};
  strut_status status = strut_sweep_study_try(arguments, study, &error);
  return status ? strut_sweep_study_report(arguments->listener, study, status, &error)
                : strut_tell_lines(arguments->listener, strut_study_notes(&study->file));
}

void strut_sweep_study_close(strut_sweep_study *study) {
  strut_sweep_plan_free(&study->plan);
  strut_study_close(&study->file);
}

/* ---- copies of the texts beside the results ---- */

/* A copy and its source. */
typedef struct copy {
  const char *name, *source, *text;
  const char *study, *model; /* paths of both sources */
} copy;

enum { COPIES = 2 };
static const char model_name[] = "model.yaml";

static bool same_file(const char *a, const char *b) {
  struct stat first, second;
  return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
         first.st_ino == second.st_ino;
}

/* Does the file have these bytes? */
static bool holds_text(const char *path, const char *text) {
  char *there = NULL;
  size_t length;
  bool same = strut_file_read(path, &there, &length, NULL) == STRUT_OK && length == strlen(text) &&
              memcmp(there, text, length) == 0;
  strut_release(there);
  return same;
}

/* Is the file in the directory? */
static bool lies_in(const char *directory, const char *path, strut_arena *arena) {
  const char *slash = strrchr(path, '/');
  size_t length = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
  const char *folder = slash ? strut_arena_text(arena, path, length) : ".";
  return folder && same_file(directory, folder);
}

/* Fails where a copy would overwrite a file that strut did not write. */
static strut_status check_copy(const char *directory, const copy *self, strut_arena *arena,
                               strut_error *error) {
  struct stat found;
  char *path = strut_arena_format(arena, "%s/%s", directory, self->name);
  if (!path) return strut_no_memory(error, "");
  if (stat(path, &found) != 0 || same_file(path, self->source) || holds_text(path, self->text))
    return STRUT_OK;
  if (!lies_in(directory, self->study, arena) && !lies_in(directory, self->model, arena))
    return strut_ownership_check(directory, (const char *const[]){self->name, NULL}, error);
  return strut_fail(
      error, STRUT_USAGE,
      "'%s' is the folder of the study or its model, and the copy of '%s' that is kept "
      "with the results would overwrite '%s': give another directory",
      directory, self->source, path);
}

static strut_status write_copy(const char *directory, const copy *self, strut_arena *arena,
                               strut_error *error) {
  char *path = strut_arena_format(arena, "%s/%s", directory, self->name);
  if (!path) return strut_no_memory(error, "");
  if (same_file(path, self->source) || holds_text(path, self->text))
    return STRUT_OK; /* already there */
  return strut_file_write_text(directory, self->name, self->text, error);
}

static strut_status for_each(const strut_arguments *arguments, const strut_sweep_study *study,
                             strut_status (*what)(const char *, const copy *, strut_arena *,
                                                  strut_error *),
                             strut_error *error) {
  strut_arena arena = {0};
  const strut_study_file *file = &study->file;
  size_t word_count = 0;
  const char *const *words = strut_sweep_words(arguments, &arena, &word_count);
  char *text = words ? strut_study_copy(file, model_name, words, word_count) : NULL;
  const char *study_path = file->path, *model_path = file->model_path;
  const char *model = file->model_copy ? file->model_copy : file->model_text;
  const copy copies[COPIES] = {{"study.yaml", study_path, text, study_path, model_path},
                               {model_name, model_path, model, study_path, model_path}};
  strut_status status = text ? STRUT_OK : strut_no_memory(error, "");
  for (int i = 0; i < COPIES && status == STRUT_OK; i++)
    status = what(arguments->output, &copies[i], &arena, error);
  for (size_t i = 0; i < file->table_count && status == STRUT_OK; i++) {
    const strut_study_points *points = &file->tables[i];
    const copy table = {points->copy, points->file.path, points->file.text, study_path, model_path};
    status = what(arguments->output, &table, &arena, error);
  }
  strut_release(text);
  strut_arena_free(&arena);
  return status;
}

/*
 * STRUT_USAGE where the copies would take the place of other files of the user's: results go into
 * the study's own folder, and one of the names is taken there.
 */
static strut_status check_texts(const strut_arguments *arguments, const strut_sweep_study *study,
                                strut_error *error) {
  return for_each(arguments, study, check_copy, error);
}

/* Writes study.yaml and model.yaml into the directory of the results, which exists. */
static strut_status write_texts(const strut_arguments *arguments, const strut_sweep_study *study,
                                strut_error *error) {
  const strut_study_file *file = &study->file;
  strut_status status = for_each(arguments, study, write_copy, error);
  if (!status)
    status = strut_data_copy(file->study.tables, file->study.table_count, arguments->output, error);
  for (size_t i = 0; i < file->source_count && !status; i++)
    status = strut_data_copy(file->sources[i]->tables, file->sources[i]->table_count,
                             arguments->output, error);
  return status;
}

/* The partial table is written anew after these times, ever less often [s]. */
static const double FIRST_PARTIAL = 2.0, RAREST_PARTIAL = 60.0;

/* When a running study's table of the rows that there are is written next. */
typedef struct partial {
  const strut_study_job *job;
  double next, interval; /* [s] since it began */
} partial;

static void show(void *context, const strut_sweep_state *state) {
  partial *self = context;
  const strut_study_job *job = self->job;
  job->progress(job, state);
  if (job->shard.count || state->seconds < self->next) return;
  const strut_slot_rows rows = {.sources = &job->slots, .count = 1, .partial = true};
  strut_study_table_write(job->arguments->output, STRUT_PARTIAL_TABLE, &rows, NULL, NULL);
  if (self->interval < RAREST_PARTIAL) self->interval *= 2.0;
  self->next = state->seconds + self->interval;
}

/* Writes and reports the rows of a study that has ended before its last point. */
static void write_partial(const strut_study_job *job) {
  int64_t count = 0;
  strut_error error = {0};
  const char *directory = job->arguments->output;
  const strut_slot_rows rows = {.sources = &job->slots, .count = 1, .partial = true};
  strut_status status =
      strut_study_table_write(directory, STRUT_PARTIAL_TABLE, &rows, &count, &error);
  if (!strut_tell_failure(job->arguments->listener, status, &error))
    strut_tell(job->arguments->listener, STRUT_MESSAGE_REMARK, NULL,
               "%s/%s has the %lld rows that are done", directory, STRUT_PARTIAL_TABLE,
               (long long)count);
}

strut_status strut_study_job_open(strut_study_job *job, const char *path, strut_error *error) {
  const strut_arguments *arguments = job->arguments;
  const bool search = strut_study_has_stages(job->study->plan.study);
  const strut_shard part = search ? (strut_shard){0} : job->shard;
  strut_status status = check_texts(arguments, job->study, error);
  if (!status && !part.count)
    status = strut_sweep_figures_check_files(&job->study->plan, arguments->output, error);
  if (!status) status = strut_directory_create(arguments->output, error);
  if (!status) status = strut_shard_begin(arguments->output, part, error);
  if (!status)
    status = (search && job->shard.count ? strut_slots_open_shared : strut_slots_open)(
        path, &job->study->slots, &job->slots, error);
  if (!status && arguments->retry) status = strut_slots_retry(job->slots, error);
  if (status || part.count) return status;
  int64_t missing = strut_slots_missing(job->slots);
  if (search ? missing == strut_slots_description_of(job->slots)->count : missing > 0)
    strut_file_remove(arguments->output, "table.csv"); /* outdated, or of another search */
  return STRUT_OK;
}

strut_status strut_study_job_run(strut_study_job *job, strut_study_compute *compute, void *context,
                                 strut_error *error) {
  const strut_sweep_state *state = &job->state;
  partial table = {.job = job, .next = FIRST_PARTIAL, .interval = FIRST_PARTIAL};
  const strut_sweep_options options = {.threads = (int)job->arguments->threads.value,
                                       .interrupt = job->interrupt,
                                       .directory = job->arguments->output,
                                       .progress = show,
                                       .progress_context = &table};
  strut_status status = write_texts(job->arguments, job->study, error);
  if (!status) status = compute(job, &options, context, error);
  job->progress(job, NULL);
  strut_error late = {0};
  strut_status synced = strut_slots_sync(job->slots, &late);
  if (!status && synced) status = strut_fail(error, synced, "%s", late.message);
  if (status && !job->shard.count && state->done > 0) write_partial(job);
  if (status == STRUT_INTERRUPTED && strut_study_has_stages(job->study->plan.study))
    strut_fail(error, status, "interrupted after %lld points; the same command resumes",
               (long long)state->done);
  else if (status == STRUT_INTERRUPTED)
    strut_fail(error, status, "interrupted after %lld of %lld points; the same command resumes",
               (long long)state->done, (long long)state->points);
  return status;
}

void strut_sweep_tell_warnings(const strut_study_job *job) {
  const strut_sweep_state *state = &job->state;
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *warning = &state->warnings[i];
    strut_tell(job->arguments->listener, STRUT_MESSAGE_WARNING, NULL,
               "%lld of %lld runs, first point %lld: %s", (long long)warning->runs,
               (long long)state->computed, (long long)warning->point, warning->text);
  }
}

strut_status strut_sweep_judge(const strut_listener *listener, int64_t points, int64_t failed,
                               int64_t inaccurate) {
  if (failed)
    strut_tell(listener, STRUT_MESSAGE_REMARK, NULL,
               "%lld of %lld points failed: see the table's columns status and message",
               (long long)failed, (long long)points);
  if (inaccurate)
    strut_tell(listener, STRUT_MESSAGE_REMARK, NULL,
               "%lld of %lld points are less accurate than requested: see the table's "
               "column " STRUT_KEPT_COLUMN,
               (long long)inaccurate, (long long)points);
  return failed ? STRUT_DIVERGED : inaccurate ? STRUT_INACCURATE : STRUT_OK;
}
