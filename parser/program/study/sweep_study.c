/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/checksum.h"
#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/study/cluster/cluster_script.h"
#include "engine/study/fit/fit.h"
#include "engine/study/results/study_table.h"
#include "engine/study/search/search.h"
#include "engine/study/sweep/grid.h"
#include "parser/language/study/read_study.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/run_settings.h"
#include "parser/program/commands.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/program/study/sweep.h"

enum { MOST_MESSAGES = 50 };

strut_status strut_sweep_study_report(strut_sweep_study *study, strut_status status,
                                      strut_error *error) {
  strut_study_file *file = &study->file;
  if (status == STRUT_BAD_SCENE && !error->message[0]) {
    const char *messages = strut_study_messages(file, MOST_MESSAGES);
    if (!messages) return strut_print_out_of_memory();
    fputs(messages, stderr);
  } else if (status != STRUT_OK) {
    if (!error->message[0]) strut_fail(error, status, "%s", strut_status_text(status));
    strut_print_error(error);
  }
  return status;
}

/* Tries a point; of motions that are followed, at both ends of the parameter. */
static strut_status try_point(strut_study_file *file, const strut_study_value *values) {
  const strut_study_follow *follow = file->study.follow;
  if (!follow) return strut_study_try(file, values);
  strut_status status = strut_study_try_at(file, values, follow->from);
  return status ? status : strut_study_try_at(file, values, follow->to);
}

/* Tries the first point, then both ends of each axis with the others at their first values. */
static strut_status try_ends(strut_study_file *file) {
  const strut_study *study = &file->study;
  strut_study_value *values = strut_allocate(file->column_count + 1, sizeof *values);
  if (!values) return STRUT_NO_MEMORY;
  strut_grid_values(study, 0, values);
  strut_status status = try_point(file, values);
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

static strut_status setup_of(void *context, const strut_study_value *values, strut_setup *setup,
                             strut_error *error) {
  return strut_study_setup(context, values, setup, error);
}

static strut_status vary(void *context, const strut_study_value *values, const strut_derived_by *by,
                         size_t count, const double *numbers, strut_setup *setup,
                         strut_error *error) {
  return strut_study_vary(context, values, by, count, numbers, setup, error);
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

/* The settings and options of the command line, each before its value. */
static const char *const *list_words(const strut_arguments *arguments, strut_arena *arena,
                                     size_t *count) {
  size_t options = 0, n = 0;
  while (strut_run_option_given(arguments, options)) options++;
  const char **words =
      strut_arena_allocate(arena, 2 * (arguments->override_count + options) + 1, sizeof *words);
  for (size_t i = 0; words && i < arguments->override_count; i++) {
    const strut_override *override = &arguments->overrides[i];
    words[n++] = "--set";
    words[n++] = strut_arena_format(arena, "%s=%s", override->name, override->value);
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

strut_status strut_sweep_study_try(const strut_arguments *arguments, strut_sweep_study *study,
                                   strut_error *error) {
  strut_study_file *file = &study->file;
  const strut_sweep_scenes scenes = {setup_of, strut_setup_write, file, vary};
  strut_status status = strut_study_open(arguments->model, arguments->overrides,
                                         arguments->override_count, file, error);
  if (!status) status = adjust_scenes(arguments, file);
  if (!status) status = try_ends(file);
  if (!status) status = strut_sweep_plan_make(&file->study, &scenes, &study->plan, error);
  if (!status && file->study.search) status = bind_search(study, error);
  if (!status && file->study.follow) status = strut_sweep_follow_check(study, error);
  if (!status && file->study.fit) status = strut_fit_add_columns(&study->plan, error);
  if (!status) status = strut_sweep_figures_check(&study->plan, error);
  if (!status) status = strut_sweep_sensitivity_check(&study->plan, error);
  return status;
}

strut_status strut_sweep_study_open(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_error error = {0};
  strut_study_file *file = &study->file;
  strut_status status = strut_sweep_study_try(arguments, study, &error);
  if (!status && !identify(arguments, file, study->slots.hash)) status = STRUT_NO_MEMORY;
  if (status) return strut_sweep_study_report(study, status, &error);
  const char *notes = strut_study_notes(file);
  if (!notes) return strut_print_out_of_memory();
  fputs(notes, stderr);
  study->slots.version = STRUT_VERSION;
  study->slots.name = file->study.name;
  study->slots.points = study->slots.count = study->plan.points;
  study->slots.columns = study->plan.columns;
  study->slots.column_count = study->plan.column_count;
  return STRUT_OK;
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
    return strut_ownership_check_path(path, error);
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
  const char *const *words = list_words(arguments, &arena, &word_count);
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

strut_status strut_sweep_texts_check(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error) {
  return for_each(arguments, study, check_copy, error);
}

strut_status strut_sweep_texts_write(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error) {
  const strut_study_file *file = &study->file;
  strut_status status = for_each(arguments, study, write_copy, error);
  if (!status)
    status = strut_data_copy(file->study.tables, file->study.table_count, arguments->output, error);
  for (size_t i = 0; i < file->source_count && !status; i++) {
    size_t count;
    const strut_data_table *tables = strut_scene_source_tables(file->sources[i], &count);
    status = strut_data_copy(tables, count, arguments->output, error);
  }
  return status;
}

/* The paths of this program and of the current directory. */
static strut_status find_places(char program[PATH_MAX], char folder[PATH_MAX]) {
  ssize_t length = readlink("/proc/self/exe", program, PATH_MAX - 1);
  if (length > 0)
    program[length] = '\0';
  else
    strcpy(program, "strut");
  if (getcwd(folder, PATH_MAX)) return STRUT_OK;
  strut_error error = {0};
  strut_fail(&error, STRUT_FILE_TROUBLE, "the current directory has no name: %s", strerror(errno));
  strut_print_error(&error);
  return STRUT_FILE_TROUBLE;
}

static strut_status print_script(const strut_arguments *arguments, strut_cluster_script *script,
                                 strut_arena *arena) {
  strut_error error = {0};
  char program[PATH_MAX], folder[PATH_MAX], *text = NULL;
  strut_status status = find_places(program, folder);
  if (status != STRUT_OK) return status;
  script->program = program;
  script->folder = folder;
  script->words = list_words(arguments, arena, &script->word_count);
  if (!script->words) return strut_print_out_of_memory();
  status = strut_cluster_script_write(script, &text, &error);
  if (status == STRUT_USAGE) fprintf(stderr, "strut sweep: --emit: %s\n", error.message);
  if (status == STRUT_NO_MEMORY) strut_print_error(&error);
  if (status == STRUT_OK) status = strut_print(text);
  strut_release(text);
  return status;
}

strut_status strut_sweep_emit(const strut_arguments *arguments, const char *name) {
  strut_cluster_script script = {.name = name,
                                 .study = arguments->model,
                                 .output = arguments->output,
                                 .time = arguments->time,
                                 .memory = arguments->memory,
                                 .shards = arguments->shards.value,
                                 .cpus = arguments->cpus.text ? arguments->cpus.value : 1};
  if (strcmp(arguments->model, "-") == 0)
    return strut_usage_error(arguments,
                             "--emit needs a file that the tasks can read, not standard input");
  if (!arguments->shards.text)
    return strut_usage_error(arguments, "--emit needs --shards N, the number of tasks");
  strut_arena arena = {0};
  strut_status status = print_script(arguments, &script, &arena);
  strut_arena_free(&arena);
  return status;
}

enum { WIDTH = 20, BAR_ROOM = 3 * WIDTH + 1, TEXT = 300 };

/* Between two lines without a terminal, and before the first bar [s]. */
static const double REPORT_INTERVAL = 30.0, PATIENCE = 0.5;

/* What a running sweep or search shows: progress, and now and then the table of the rows that there are. */
typedef struct display {
  const strut_study_job *job;
  strut_progress bar;
  double reported;       /* time of the latest line [s] */
  double next, interval; /* of partial tables [s] since it began */
} display;

/* "frequency 3.2 Hz, velocity 0.0098 m/s": the first few cells of a row. */
static void format_row(const strut_sweep_plan *plan, const strut_result_slot *row, char *text,
                       size_t size) {
  size_t used = 0, number = 0, word = 0, most = plan->axis_columns + 1;
  *text = '\0';
  for (size_t i = 0; i < plan->column_count && i < most && used < size; i++) {
    const strut_slot_column *column = &plan->columns[i];
    const char *unit = strcmp(column->unit, "1") == 0 ? "" : column->unit;
    int n = column->word ? snprintf(text + used, size - used, "%s%s %s", i ? ", " : "",
                                    column->name, row->words[word++])
                         : snprintf(text + used, size - used, "%s%s %.4g%s%s", i ? ", " : "",
                                    column->name, row->numbers[number++], *unit ? " " : "", unit);
    used += n > 0 ? (size_t)n : 0;
  }
  if (row->status != STRUT_OK && used < size)
    snprintf(text + used, size - used, ": %s", strut_status_text(row->status));
}

/* "123 of 1146 points (2 failed), 45 a second, 2 min 03 s left" */
static void format_state(const strut_sweep_state *state, char *text, size_t size) {
  char left[STRUT_DURATION_TEXT], failed[40] = "";
  double rate = state->seconds > 0.0 ? (double)state->computed / state->seconds : 0.0;
  strut_duration_text(rate > 0.0 ? (double)(state->points - state->done) / rate : HUGE_VAL, left);
  if (state->failed) snprintf(failed, sizeof failed, " (%lld failed)", (long long)state->failed);
  snprintf(text, size, "%lld of %lld points%s, %.3g a second, %s left", (long long)state->done,
           (long long)state->points, failed, rate, left);
}

static void show_state(display *shown, const strut_sweep_state *state) {
  strut_progress *bar = &shown->bar;
  char text[TEXT], row[TEXT], all[2 * TEXT + 40], blocks[BAR_ROOM];
  if (shown->job->arguments->quiet || state->seconds < PATIENCE) return;
  if (!bar->wanted && state->seconds - shown->reported < REPORT_INTERVAL) return;
  shown->reported = state->seconds;
  format_state(state, text, sizeof text);
  format_row(&shown->job->study->plan, state->row, row, sizeof row);
  if (state->has_best)
    snprintf(all, sizeof all, "%s; best %.5g; %s", text, state->best, row);
  else
    snprintf(all, sizeof all, "%s; %s", text, row);
  if (!bar->wanted) {
    fprintf(stderr, "strut: %s\n", all);
    return;
  }
  int size = bar->columns - 1, width = size > 3 * WIDTH ? WIDTH : 0;
  strut_progress_bar(blocks, width, (double)state->done / (double)state->points);
  const char *on = bar->colour ? "\033[36m" : "", *off = bar->colour ? "\033[0m" : "";
  fprintf(stderr, "\r%s%s%s %-*.*s", on, blocks, off, size - width - 1, size - width - 1, all);
  fflush(stderr);
  bar->shown = true;
}

/* The partial table is written anew after these times, ever less often [s]. */
static const double FIRST_PARTIAL = 2.0, RAREST_PARTIAL = 60.0;

static void show(void *context, const strut_sweep_state *state) {
  display *shown = context;
  show_state(shown, state);
  if (shown->job->shard.count || state->seconds < shown->next) return;
  strut_slots *const sources[] = {shown->job->slots};
  strut_study_table_write_partial(shown->job->arguments->output, STRUT_PARTIAL_TABLE, sources, 1,
                                  NULL, NULL);
  if (shown->interval < RAREST_PARTIAL) shown->interval *= 2.0;
  shown->next = state->seconds + shown->interval;
}

/* Writes and reports the rows of a study that has ended before its last point. */
static void write_partial(const char *directory, strut_slots *slots) {
  int64_t rows = 0;
  strut_error error = {0};
  strut_slots *const sources[] = {slots};
  if (strut_study_table_write_partial(directory, STRUT_PARTIAL_TABLE, sources, 1, &rows, &error))
    strut_print_error(&error);
  else
    fprintf(stderr, "strut: %s/%s has the %lld rows that are done\n", directory,
            STRUT_PARTIAL_TABLE, (long long)rows);
}

strut_status strut_study_job_open(strut_study_job *job, const char *path, strut_error *error) {
  const strut_arguments *arguments = job->arguments;
  const bool search = strut_study_has_stages(job->study->plan.study);
  const strut_shard part = search ? (strut_shard){0} : job->shard;
  strut_status status = strut_sweep_texts_check(arguments, job->study, error);
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
  const char *directory = job->arguments->output;
  const strut_sweep_state *state = &job->state;
  display shown = {.job = job,
                   .bar = strut_progress_begin(job->arguments->quiet),
                   .next = FIRST_PARTIAL,
                   .interval = FIRST_PARTIAL};
  const strut_sweep_options options = {.interrupt = strut_interrupt_watch(),
                                       .directory = directory,
                                       .progress = show,
                                       .progress_context = &shown};
  strut_status status = strut_sweep_texts_write(job->arguments, job->study, error);
  if (!status) status = compute(job, &options, context, error);
  strut_progress_end(&shown.bar);
  strut_error late = {0};
  strut_status synced = strut_slots_sync(job->slots, &late);
  if (!status && synced) status = strut_fail(error, synced, "%s", late.message);
  if (status && !job->shard.count && state->done > 0) write_partial(directory, job->slots);
  if (status == STRUT_INTERRUPTED && strut_study_has_stages(job->study->plan.study))
    strut_fail(error, status, "interrupted after %lld points; the same command resumes",
               (long long)state->done);
  else if (status == STRUT_INTERRUPTED)
    strut_fail(error, status, "interrupted after %lld of %lld points; the same command resumes",
               (long long)state->done, (long long)state->points);
  return status;
}

void strut_sweep_print_warnings(const strut_sweep_state *state) {
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *warning = &state->warnings[i];
    fprintf(stderr, "strut: warning: %lld of %lld runs, first point %lld: %s\n",
            (long long)warning->runs, (long long)state->computed, (long long)warning->point,
            warning->text);
  }
}

strut_status strut_sweep_judge(int64_t points, int64_t failed, int64_t inaccurate) {
  if (failed)
    fprintf(stderr,
            "strut: %lld of %lld points failed: see the table's columns status and message\n",
            (long long)failed, (long long)points);
  if (inaccurate)
    fprintf(stderr,
            "strut: %lld of %lld points are less accurate than requested: see the table's "
            "column " STRUT_KEPT_COLUMN "\n",
            (long long)inaccurate, (long long)points);
  return failed ? STRUT_DIVERGED : inaccurate ? STRUT_INACCURATE : STRUT_OK;
}
