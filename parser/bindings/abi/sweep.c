/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * strutlib_sweep: the points of `strut sweep`, given as numbers, with the table as arrays; strutlib_study: `strut
 * sweep` of a file.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/output/file.h"
#include "engine/output/result_values.h"
#include "engine/study/results/study_table.h"
#include "engine/study/sweep/sweep.h"
#include "parser/bindings/abi/handles.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/scene_options.h"
#include "parser/program/study/sweep.h"

static const char slots_name[] = "points.slots", table_name[] = "table.csv";
static const char *const files[] = {slots_name, table_name, NULL};

/* What strutlib_sweep was given. */
typedef struct given_points {
  size_t axis_count, point_count, keep_count;
  const char *const *axes;
  const double *points;     /* (point_count, axis_count) */
  const char *const *words; /* likewise, or NULL */
  const char *const *keep;
} given_points;

/* A sweep under way. Stays where it is. */
typedef struct sweep {
  abi_call call; /* first: the call is the sweep's */
  given_points given;
  strut_arguments options; /* of method and model, for each point; without messages */
  strut_varied_scenes scenes;
  strut_study study;
  strut_study_axis axis;
  const char **names; /* (axis.column_count) of the parameters, as declared */
  strut_sweep_plan plan;
  strut_slots *slots;
  strutlib_control own; /* where the caller has none */
  strutlib_row row;
  void *context;
  uint8_t *reported; /* (points) 1 where `row` was called */
  strut_arena arena;
} sweep;

/* What a result keeps. */
typedef struct sweep_detail {
  size_t points, column_count;
  const strut_slot_column *columns; /* (column_count) in the result's arena, as all below */
  const char ***words;              /* (column_count) (points) of columns of words; or NULL */
  const char **messages;            /* (points) */
} sweep_detail;

/* ---- the study ---- */

static const strut_declared *find_parameter(const sweep *self, const char *name,
                                            strut_error *what) {
  const strut_scene_source *source = self->call.scene->source->tree;
  const strut_declared *declared = strut_scene_source_parameter(source, name);
  const strut_named_rows *names = STRUT_NAMED(source->parameters, source->parameter_count);
  if (!declared)
    strut_fail(what, STRUT_USAGE, "the scene has no parameter '%s'%s", name,
               strut_near_to(name, strut_row_name, names).text);
  return declared;
}

/* Column k of the points. */
static strut_status add_axis(sweep *self, size_t k, strut_error *what) {
  const given_points *given = &self->given;
  const strut_declared *declared = find_parameter(self, given->axes[k], what);
  double *numbers;
  const char **texts;
  if (!declared) return STRUT_USAGE;
  if (!STRUT_ALLOCATE(&self->arena, STRUT_NEW(numbers, given->point_count),
                      STRUT_NEW(texts, given->point_count)))
    return strut_no_memory(what, "");
  for (size_t i = 0, at = k; i < given->point_count; i++, at += given->axis_count) {
    texts[i] = given->words ? given->words[at] : NULL;
    if (declared->text && !texts[i])
      return strut_fail(what, STRUT_USAGE, "parameter '%s' is a text: point %zu gives none",
                        given->axes[k], i);
    if (!declared->text && !(given->points && isfinite(given->points[at])))
      return strut_fail(what, STRUT_USAGE, "parameter '%s' at point %zu must be a finite number",
                        given->axes[k], i);
    if (!declared->text) numbers[i] = given->points[at];
  }
  self->names[k] = declared->name;
  self->axis.columns[k] = (strut_study_column){
      .name = declared->name,
      .unit = declared->bare || declared->text ? "1" : strut_dimension_unit(declared->dimension),
      .word = declared->text,
      .kind = STRUT_RANGE_LIST,
      .words = declared->text ? texts : NULL,
      .number = declared->text ? NULL : numbers};
  return STRUT_OK;
}

static strut_status add_axes(sweep *self, strut_error *what) {
  size_t axes = self->given.axis_count, count = self->given.point_count;
  strut_status status = STRUT_OK;
  if (axes == 0) return STRUT_OK; /* one point */
  if (count == 0 || count > (size_t)STRUT_STUDY_MOST_POINTS)
    return strut_fail(what, STRUT_USAGE, "a sweep has from 1 to %lld points, not %zu",
                      (long long)STRUT_STUDY_MOST_POINTS, count);
  self->axis = (strut_study_axis){.count = (int64_t)count, .column_count = axes};
  if (!STRUT_ALLOCATE(&self->arena, STRUT_NEW(self->axis.columns, axes),
                      STRUT_NEW(self->names, axes)))
    return strut_no_memory(what, "");
  for (size_t k = 0; k < axes && status == STRUT_OK; k++) {
    const char *name = self->given.axes[k];
    for (size_t before = 0; before < k; before++)
      if (strcmp(self->given.axes[before], name) == 0)
        return strut_fail(what, STRUT_USAGE, "parameter '%s' is given twice", name);
    status = add_axis(self, k, what);
  }
  self->study.axes = &self->axis;
  self->study.axis_count = 1;
  return status;
}

static const char *kept_word_at(const void *context, size_t i) {
  (void)context;
  return i < STRUT_KEEP_COUNT ? strut_kept_word_at(i)->word : NULL;
}

static strut_status add_kept(sweep *self, const char *word, strut_error *what) {
  strut_study *study = &self->study;
  int found = strut_keep_find(word, study->compute);
  if (found >= 0) {
    strut_keep_add(&study->keep, (unsigned)found);
    return STRUT_OK;
  }
  if (study->compute == STRUT_COMPUTE_RUN &&
      strutlib_index(self->call.scene, "quantities", word) >= 0) {
    study->quantities[study->quantity_count++] = word;
    return STRUT_OK;
  }
  const char *near = strut_did_you_mean(word, kept_word_at, NULL);
  return strut_fail(what, STRUT_USAGE,
                    "a sweep cannot keep '%s'%s%s%s; see 'keep' of the section study in the "
                    "language's keys",
                    word, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* Applies the options of method and model to the scene itself, so that what is wrong with them is said once. */
static strut_status check_options(sweep *self) {
  const strut_arguments *arguments = &self->call.arguments;
  strut_setup setup;
  if (!strut_run_option_given(arguments, 0)) return STRUT_OK;
  strut_status status = abi_setup(self->call.scene, self->scenes.purpose, &setup, self->call.error);
  if (status != STRUT_OK) return status;
  status = strut_run_options_apply(arguments, &setup);
  strut_setup_free(&setup);
  return status;
}

static strut_status read_study(sweep *self, strut_error *what) {
  const strut_arguments *arguments = &self->call.arguments;
  const abi_source *source = self->call.scene->source;
  strut_study *study = &self->study;
  *study = (strut_study){.name = "sweep",
                         .compute = (uint32_t)arguments->compute.index,
                         .lowest = (int32_t)arguments->lowest.value,
                         .at = arguments->at,
                         .limit = {.evaluations = arguments->limit_evaluations.value,
                                   .time = arguments->limit_time.value},
                         .quantities = strut_arena_allocate(&self->arena, self->given.keep_count,
                                                            sizeof *study->quantities)};
  if (!study->quantities) return strut_no_memory(what, "");
  self->options = *arguments;
  self->options.listener = NULL;
  self->scenes = (strut_varied_scenes){.file = source->name,
                                       .source = source->tree,
                                       .purpose = study->compute == STRUT_COMPUTE_RUN
                                                      ? strut_run_options_purpose(arguments)
                                                      : STRUT_FOR_ANY_STATICS,
                                       .options = &self->options};
  strut_status status = check_options(self);
  if (status == STRUT_OK) status = add_axes(self, what);
  if (status == STRUT_OK)
    status = strut_varied_scenes_open(arguments, self->names, self->axis.column_count,
                                      &self->scenes, NULL);
  for (size_t i = 0; i < self->given.keep_count && status == STRUT_OK; i++)
    status = add_kept(self, self->given.keep[i], what);
  return status;
}

/* ---- rows ---- */

/* Reports all rows that are done and were not reported. */
static void report_rows(sweep *self) {
  for (int64_t i = 0; self->row && i < self->plan.points; i++) {
    strut_result_slot slot;
    if (self->reported[i] || !strut_slots_done(self->slots, i)) continue;
    if (!strut_slots_get(self->slots, i, &slot)) continue;
    self->reported[i] = 1;
    if (self->row(self->context, (size_t)i, (int)slot.status)) self->call.control->interrupt = 1;
  }
}

/* The part that is done. */
static void tell_state(strutlib_control *control, const strut_sweep_state *state) {
  if (state->points > 0) abi_progress(control, (double)state->done / (double)state->points);
}

static void show_progress(void *context, const strut_sweep_state *state) {
  sweep *self = context;
  report_rows(self);
  tell_state(self->call.control, state);
}

static strut_status run_points(sweep *self, const abi_scratch *scratch, strut_sweep_state *state,
                               strut_error *what) {
  const strut_slots_description plan = {.version = STRUT_VERSION,
                                        .name = "sweep",
                                        .points = self->plan.points,
                                        .count = self->plan.points,
                                        .columns = self->plan.columns,
                                        .column_count = self->plan.column_count};
  const strut_sweep_options how = {.threads = (int)self->call.arguments.threads.value,
                                   .interrupt = &self->call.control->interrupt,
                                   .progress = show_progress,
                                   .progress_context = self};
  self->reported = strut_arena_allocate(&self->arena, (size_t)self->plan.points, 1);
  if (!self->reported) return strut_no_memory(what, "");
  strut_status status = strut_slots_open(scratch->path, &plan, &self->slots, what);
  if (status == STRUT_OK) status = strut_sweep_run(&self->plan, self->slots, &how, state, what);
  if (status == STRUT_OK || status == STRUT_INTERRUPTED) report_rows(self);
  return status;
}

/* ---- the result ---- */

static bool add_columns(const strut_sweep_plan *plan, strutlib_result *result, sweep_detail *d,
                        double **data) {
  strut_arena *arena = &result->arrays.arena;
  size_t n = d->points, count = d->column_count = plan->column_count;
  strut_slot_column *columns = strut_arena_copy(arena, plan->columns, count, sizeof *columns);
  d->columns = columns;
  if (!columns || !STRUT_ALLOCATE(arena, STRUT_NEW(d->words, count), STRUT_NEW(d->messages, n)))
    return false;
  for (size_t c = 0; c < count; c++) {
    const char *name = columns[c].name;
    columns[c].name = strut_arena_text(arena, name, strlen(name));
    if (columns[c].word)
      d->words[c] = strut_arena_allocate(arena, n, sizeof **d->words);
    else
      data[c] = abi_new_array(&result->arrays, name, columns[c].unit, n, 1);
    if (!columns[c].name || !(columns[c].word ? (void *)d->words[c] : data[c])) return false;
    for (size_t i = 0; data[c] && i < n; i++) data[c][i] = (double)NAN;
  }
  return true;
}

static bool copy_row(strut_arena *arena, sweep_detail *self, const strut_result_slot *row,
                     size_t point, double *const *data) {
  size_t number = 0, word = 0;
  for (size_t c = 0; c < self->column_count; c++) {
    if (!self->columns[c].word) {
      data[c][point] = row->numbers[number++];
      continue;
    }
    const char *text = row->words[word++];
    self->words[c][point] = strut_arena_text(arena, text, strlen(text));
    if (!self->words[c][point]) return false;
  }
  if (!row->message || !row->message[0]) return true;
  self->messages[point] = strut_arena_text(arena, row->message, strlen(row->message));
  return self->messages[point] != NULL;
}

static bool fill_table(const strut_sweep_plan *plan, strut_slots *slots, const int64_t *points,
                       strutlib_result *result, sweep_detail *d) {
  size_t n = d->points;
  strut_arena *arena = &result->arrays.arena;
  double **data = strut_arena_allocate(arena, plan->column_count, sizeof *data);
  bool good = data && add_columns(plan, result, d, data);
  double *status = good ? abi_new_array(&result->arrays, "status", "1", n, 1) : NULL;
  good = status;
  for (size_t i = 0; good && i < n; i++) {
    strut_result_slot row;
    bool there = strut_slots_get(slots, points[i], &row);
    status[i] = there ? (double)row.status : (double)STRUT_INTERRUPTED;
    if (there) good = copy_row(arena, d, &row, i, data);
  }
  return good;
}

/* Adds the rows of all points, or of those that are done, and the program's table in the file. */
static strut_status add_table(const strut_sweep_plan *plan, strut_slots *slots, bool all,
                              const char *path, strutlib_result *result, strut_error *what) {
  size_t length;
  sweep_detail *d = strut_allocate(1, sizeof *d);
  int64_t *points = strut_allocate((size_t)plan->points, sizeof *points);
  result->release = strut_release;
  result->detail = d;
  for (int64_t i = 0; d && points && i < plan->points; i++)
    if (all || strut_slots_done(slots, i)) points[d->points++] = i;
  bool good = d && points && path && fill_table(plan, slots, points, result, d);
  strut_release(points);
  return good ? strut_file_read(path, &result->table, &length, what) : strut_no_memory(what, "");
}

static void add_warnings(abi_messages *messages, const strut_sweep_state *state) {
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *warning = &state->warnings[i];
    char text[sizeof warning->text + 80];
    snprintf(text, sizeof text, "%lld runs, the first at point %lld: %s", (long long)warning->runs,
             (long long)warning->point, warning->text);
    abi_add_warning(messages, text);
  }
}

static strut_status complete(sweep *self, strutlib_result *result, const abi_scratch *scratch,
                             const strut_sweep_state *state) {
  const strut_slot_rows rows = {.sources = &self->slots, .count = 1, .partial = true};
  strut_error *what = &self->call.what;
  add_warnings(&self->call.messages, state);
  strut_status status = strut_study_table_write(scratch->folder, table_name, &rows, NULL, what);
  const char *path = strut_arena_format(&self->arena, "%s/%s", scratch->folder, table_name);
  if (status == STRUT_OK) status = add_table(&self->plan, self->slots, true, path, result, what);
  self->call.complete = status == STRUT_OK;
  return status;
}

/* Computes what is read, and completes the result. */
static strut_status compute(sweep *self, strutlib_result *result) {
  const strut_sweep_scenes scenes = {strut_varied_scenes_read, strut_setup_write, &self->scenes,
                                     strut_varied_scenes_vary};
  strut_sweep_state state = {0};
  abi_scratch scratch;
  strut_error *what = &self->call.what;
  strut_status status = strut_sweep_plan_make(&self->study, &scenes, &self->plan, what);
  if (status == STRUT_OK) status = abi_scratch_begin(&scratch, slots_name, what);
  if (status != STRUT_OK) return status;
  status = run_points(self, &scratch, &state, what);
  if (status == STRUT_OK || status == STRUT_INTERRUPTED) {
    strut_status completed = complete(self, result, &scratch, &state);
    if (completed != STRUT_OK)
      status = completed;
    else if (status == STRUT_INTERRUPTED)
      strut_fail(what, status, "interrupted after %lld of %lld points", (long long)state.done,
                 (long long)state.points);
  }
  strut_slots_close(self->slots);
  abi_scratch_end(&scratch, files);
  return status;
}

static strut_status run_sweep(abi_call *call, strutlib_result *result) {
  sweep *self = (sweep *)call;
  if (abi_lacks_texts(call->error, self->given.axis_count, self->given.axes, "axes") ||
      abi_lacks_texts(call->error, self->given.keep_count, self->given.keep, "keep"))
    return STRUT_USAGE;
  strut_status status = read_study(self, &call->what);
  return status ? status : compute(self, result);
}

strutlib_result *strutlib_sweep(const strutlib_scene *scene, size_t axis_count,
                                const char *const *axes, size_t point_count, const double *points,
                                const char *const *words, size_t keep_count,
                                const char *const *keep, size_t count, const char *const *names,
                                const char *const *values, strutlib_row row, void *context,
                                strutlib_control *control, strutlib_error **error) {
  if (abi_lacks(error, scene, "scene")) return NULL;
  sweep s = {.given = {axis_count, point_count, keep_count, axes, points, words, keep},
             .row = row,
             .context = context};
  s.call = abi_call_of(scene, &abi_sweep_command, control ? control : &s.own, error);
  strutlib_result *result = abi_compute(&s.call, &(abi_pairs){count, names, values}, run_sweep);
  strut_sweep_plan_free(&s.plan);
  strut_varied_scenes_free(&s.scenes);
  strut_arena_free(&s.arena);
  return result;
}

/* ---- studies by file ---- */

/* A study under way. */
typedef struct study {
  abi_call call; /* first: the call is the study's */
  abi_pairs settings;
  strut_sweep_study open;
  strut_study_job job;
  strutlib_result *result;
  strutlib_control own; /* where the caller has none */
} study;

static void show_study(const strut_study_job *job, const strut_sweep_state *state) {
  if (state) tell_state(((const study *)job->context)->call.control, state);
}

static strut_status keep_report(const strut_study_job *job, const strut_value_rows *rows,
                                const void *of, const char *json) {
  strutlib_result *result = ((const study *)job->context)->result;
  char *copy = json ? strut_allocate(strlen(json) + 1, 1) : strut_values_json(rows, of, NULL);
  if (copy && json) strcpy(copy, json);
  result->json = copy;
  return strut_tell_failure(job->arguments->listener, copy ? STRUT_OK : STRUT_NO_MEMORY, NULL);
}

static strut_status open_study(study *self, strut_error *what) {
  abi_call *call = &self->call;
  strut_study_file *file = &self->open.file;
  strut_arena *arena = &self->result->arrays.arena;
  strut_setting *set = strut_arena_allocate(arena, self->settings.count, sizeof *set);
  if (!set) return strut_no_memory(what, "");
  for (size_t i = 0; i < self->settings.count; i++)
    set[i] = (strut_setting){.name = self->settings.names[i], .text = self->settings.values[i]};
  call->arguments.overrides = set;
  call->arguments.override_count = self->settings.count;
  strut_status status = strut_sweep_study_try(&call->arguments, &self->open, what);
  abi_add_notes(&call->messages, &file->diagnostics);
  abi_add_notes(&call->messages, &file->model_diagnostics);
  if (status != STRUT_BAD_SCENE || what->message[0]) return status;
  strut_diagnostics *found[] = {&file->diagnostics, &file->model_diagnostics};
  return (strut_status)abi_fail_located(call->error, status, found, 2);
}

/* Points that failed or are inaccurate are no error. */
static strut_status run_study(abi_call *call, strutlib_result *result) {
  study *self = (study *)call;
  self->result = result;
  strut_status status = open_study(self, &call->what), added;
  if (status) return status;
  self->job = (strut_study_job){.arguments = &call->arguments,
                                .study = &self->open,
                                .interrupt = &call->control->interrupt,
                                .context = self,
                                .progress = show_study,
                                .report = keep_report};
  status = strut_study_job_compute(&self->job);
  if (result->json &&
      (status == STRUT_OK || status == STRUT_DIVERGED || status == STRUT_INACCURATE)) {
    const char *path =
        strut_arena_format(&result->arrays.arena, "%s/%s", call->arguments.output, table_name);
    added = add_table(&self->open.plan, self->job.slots, false, path, result, &call->what);
    call->complete = !added;
    result->status = (int)status;
    status = added;
  }
  strut_slots_close(self->job.slots);
  return status;
}

strutlib_result *strutlib_study(const char *path, const char *directory, size_t setting_count,
                                const char *const *settings, const char *const *set, size_t count,
                                const char *const *names, const char *const *values,
                                strutlib_control *control, strutlib_error **error) {
  if (abi_lacks(error, path, "path") || abi_lacks(error, directory, "directory") ||
      abi_lacks_pairs(error, setting_count, settings, set))
    return NULL;
  study s = {.settings = {setting_count, settings, set}};
  s.call = (abi_call){.arguments = {.command = &abi_study_command,
                                    .model = path,
                                    .output = directory,
                                    .json = true},
                      .control = control ? control : &s.own,
                      .error = error};
  strutlib_result *result = abi_compute(&s.call, &(abi_pairs){count, names, values}, run_study);
  strut_sweep_study_close(&s.open);
  return result;
}

/* ---- columns of words ---- */

/* What has a table, or NULL. */
static const sweep_detail *table_of(const strutlib_result *result) {
  bool has =
      result && (result->command == &abi_sweep_command || result->command == &abi_study_command);
  return has ? result->detail : NULL;
}

const char *strutlib_result_column(const strutlib_result *result, size_t i) {
  const sweep_detail *self = table_of(result);
  return self && i < self->column_count ? self->columns[i].name : NULL;
}

const char *strutlib_result_cell(const strutlib_result *result, const char *column, size_t point) {
  const sweep_detail *self = table_of(result);
  if (!self || !column || point >= self->points) return NULL;
  if (strcmp(column, "message") == 0) return self->messages[point];
  for (size_t c = 0; c < self->column_count; c++)
    if (self->words[c] && strcmp(self->columns[c].name, column) == 0) return self->words[c][point];
  return NULL;
}
