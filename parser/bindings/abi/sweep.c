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

/* A sweep under way. Stays where it is. */
typedef struct sweep {
  const strutlib_scene *scene;
  strut_arguments options; /* of method and model, for each point; without messages */
  strut_varied_scenes scenes;
  bool located; /* the error is there, with its places */
  strut_study study;
  strut_study_axis axis;
  const char **names; /* (axis.column_count) of the parameters, as declared */
  strut_sweep_plan plan;
  strut_slots *slots;
  int64_t threads;
  strutlib_control *control, own;
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

/* Column k of the points, which are (count, axes). */
static strut_status add_axis(sweep *self, size_t k, const char *name, const double *points,
                             const char *const *words, strut_error *what) {
  size_t count = (size_t)self->axis.count, axes = self->axis.column_count;
  const strut_scene_source *source = self->scene->source->tree;
  const strut_declared *declared = strut_scene_source_parameter(source, name);
  if (!declared) {
    const strut_named_rows *names = STRUT_NAMED(source->parameters, source->parameter_count);
    return strut_fail(what, STRUT_USAGE, "the scene has no parameter '%s'%s", name,
                      strut_near_to(name, strut_row_name, names).text);
  }
  strut_study_column *column = &self->axis.columns[k];
  *column = (strut_study_column){
      .name = declared->name,
      .unit = declared->bare || declared->text ? "1" : strut_dimension_unit(declared->dimension),
      .word = declared->text,
      .kind = STRUT_RANGE_LIST};
  self->names[k] = declared->name;
  double *numbers = strut_arena_allocate(&self->arena, count, sizeof *numbers);
  const char **texts = strut_arena_allocate(&self->arena, count, sizeof *texts);
  if (!numbers || !texts) return strut_no_memory(what, "");
  for (size_t i = 0; i < count; i++) {
    const char *word = words ? words[i * axes + k] : NULL;
    if (declared->text && !word)
      return strut_fail(what, STRUT_USAGE, "parameter '%s' is a text: point %zu gives none", name,
                        i);
    if (!declared->text && !(points && isfinite(points[i * axes + k])))
      return strut_fail(what, STRUT_USAGE, "parameter '%s' at point %zu must be a finite number",
                        name, i);
    numbers[i] = declared->text ? 0.0 : points[i * axes + k];
    texts[i] = word;
  }
  if (declared->text)
    column->words = texts;
  else
    column->number = numbers;
  return STRUT_OK;
}

static strut_status add_axes(sweep *self, size_t axes, const char *const *names, size_t count,
                             const double *points, const char *const *words, strut_error *what) {
  strut_status status = STRUT_OK;
  if (axes == 0) return STRUT_OK; /* one point */
  if (count == 0 || count > (size_t)STRUT_STUDY_MOST_POINTS)
    return strut_fail(what, STRUT_USAGE, "a sweep has from 1 to %lld points, not %zu",
                      (long long)STRUT_STUDY_MOST_POINTS, count);
  self->axis = (strut_study_axis){.count = (int64_t)count, .column_count = axes};
  self->axis.columns = strut_arena_allocate(&self->arena, axes, sizeof *self->axis.columns);
  self->names = strut_arena_allocate(&self->arena, axes, sizeof *self->names);
  if (!self->axis.columns || !self->names) return strut_no_memory(what, "");
  for (size_t k = 0; k < axes && status == STRUT_OK; k++) {
    for (size_t before = 0; before < k; before++)
      if (strcmp(names[before], names[k]) == 0)
        return strut_fail(what, STRUT_USAGE, "parameter '%s' is given twice", names[k]);
    status = add_axis(self, k, names[k], points, words, what);
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
  int found = strut_keep_find(word, self->study.compute);
  if (found >= 0) {
    strut_keep_add(&self->study.keep, (unsigned)found);
    return STRUT_OK;
  }
  if (self->study.compute == STRUT_COMPUTE_RUN &&
      strutlib_index(self->scene, "quantities", word) >= 0) {
    self->study.quantities[self->study.quantity_count++] =
        strut_arena_text(&self->arena, word, strlen(word));
    return self->study.quantities[self->study.quantity_count - 1] ? STRUT_OK
                                                                  : strut_no_memory(what, "");
  }
  const char *near = strut_did_you_mean(word, kept_word_at, NULL);
  return strut_fail(what, STRUT_USAGE,
                    "a sweep cannot keep '%s'%s%s%s; see 'keep' of the section study in the "
                    "language's keys",
                    word, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static strut_status read_options(const strut_arguments *arguments, sweep *self, strut_error *what) {
  self->threads = arguments->threads.value;
  self->study.limit.evaluations = arguments->limit_evaluations.value;
  self->study.limit.time = arguments->limit_time.value;
  self->study.compute = (uint32_t)arguments->compute.index;
  self->study.lowest = (int32_t)arguments->lowest.value;
  if (arguments->at &&
      !(self->study.at = strut_arena_text(&self->arena, arguments->at, strlen(arguments->at))))
    return strut_no_memory(what, "");
  return STRUT_OK;
}

/* Applies the options of method and model to the scene itself, so that what is wrong with them is said once. */
static strut_status check_options(abi_call *call, sweep *self) {
  const strut_arguments *arguments = &call->arguments;
  bool run = self->study.compute == STRUT_COMPUTE_RUN;
  strut_setup setup;
  self->scenes = (strut_varied_scenes){
      .file = self->scene->source->name,
      .source = self->scene->source->tree,
      .purpose = run ? strut_run_options_purpose(arguments) : STRUT_FOR_ANY_STATICS,
      .options = &self->options};
  self->options = *arguments;
  self->options.listener = NULL;
  if (!strut_run_option_given(arguments, 0)) return STRUT_OK;
  strut_status status = abi_setup(self->scene, self->scenes.purpose, &setup, call->error);
  self->located = status != STRUT_OK;
  if (status != STRUT_OK) return status;
  status = strut_run_options_apply(arguments, &setup);
  strut_setup_free(&setup);
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
    if (self->row(self->context, (size_t)i, (int)slot.status)) self->control->interrupt = 1;
  }
}

static void show_progress(void *context, const strut_sweep_state *state) {
  sweep *self = context;
  double fraction = state->points > 0 ? (double)state->done / (double)state->points : 1.0;
  report_rows(self);
  abi_progress(self->control, fraction);
}

static strut_status run_points(sweep *self, const abi_scratch *scratch, strut_sweep_state *state,
                               strut_error *what) {
  const strut_slots_description plan = {.version = STRUT_VERSION,
                                        .name = "sweep",
                                        .points = self->plan.points,
                                        .count = self->plan.points,
                                        .columns = self->plan.columns,
                                        .column_count = self->plan.column_count};
  const strut_sweep_options how = {.threads = (int)self->threads,
                                   .interrupt = &self->control->interrupt,
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
  size_t n = d->points;
  strut_slot_column *columns =
      strut_arena_allocate(&result->arena, plan->column_count, sizeof *columns);
  d->columns = columns;
  d->column_count = plan->column_count;
  d->words = strut_arena_allocate(&result->arena, d->column_count, sizeof *d->words);
  d->messages = strut_arena_allocate(&result->arena, n, sizeof *d->messages);
  if (!columns || !d->words || !d->messages) return false;
  for (size_t c = 0; c < d->column_count; c++) {
    columns[c] = plan->columns[c];
    columns[c].name = strut_arena_text(&result->arena, columns[c].name, strlen(columns[c].name));
    if (!columns[c].name) return false;
    if (columns[c].word) {
      d->words[c] = strut_arena_allocate(&result->arena, n, sizeof **d->words);
      if (!d->words[c]) return false;
      continue;
    }
    data[c] = abi_result_new_array(result, columns[c].name, columns[c].unit, n, 1);
    for (size_t i = 0; data[c] && i < n; i++) data[c][i] = (double)NAN;
    if (!data[c]) return false;
  }
  return true;
}

static bool copy_row(strutlib_result *result, sweep_detail *self, const strut_result_slot *row,
                     size_t point, double *const *data) {
  size_t number = 0, word = 0;
  for (size_t c = 0; c < self->column_count; c++) {
    if (!self->columns[c].word) {
      data[c][point] = row->numbers[number++];
      continue;
    }
    const char *text = row->words[word++];
    self->words[c][point] = strut_arena_text(&result->arena, text, strlen(text));
    if (!self->words[c][point]) return false;
  }
  if (!row->message || !row->message[0]) return true;
  self->messages[point] = strut_arena_text(&result->arena, row->message, strlen(row->message));
  return self->messages[point] != NULL;
}

static bool fill_table(const strut_sweep_plan *plan, strut_slots *slots, const int64_t *points,
                       strutlib_result *result, sweep_detail *d) {
  size_t n = d->points;
  double **data = strut_arena_allocate(&result->arena, plan->column_count, sizeof *data);
  bool good = data && add_columns(plan, result, d, data);
  double *status = good ? abi_result_new_array(result, "status", "1", n, 1) : NULL;
  good = status;
  for (size_t i = 0; good && i < n; i++) {
    strut_result_slot row;
    bool there = strut_slots_get(slots, points[i], &row);
    status[i] = there ? (double)row.status : (double)STRUT_INTERRUPTED;
    if (there) good = copy_row(result, d, &row, i, data);
  }
  return good;
}

/* Adds the rows of all points, or of those that are done. */
static strut_status add_table(const strut_sweep_plan *plan, strut_slots *slots, bool all,
                              strutlib_result *result, strut_error *what) {
  sweep_detail *d = strut_allocate(1, sizeof *d);
  int64_t *points = strut_allocate((size_t)plan->points, sizeof *points);
  result->release = strut_release;
  result->detail = d;
  for (int64_t i = 0; d && points && i < plan->points; i++)
    if (all || strut_slots_done(slots, i)) points[d->points++] = i;
  bool good = d && points && fill_table(plan, slots, points, result, d);
  strut_release(points);
  return good ? STRUT_OK : strut_no_memory(what, "");
}

static void add_warnings(strutlib_result *result, const strut_sweep_state *state) {
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *warning = &state->warnings[i];
    char text[sizeof warning->text + 80];
    snprintf(text, sizeof text, "%lld runs, the first at point %lld: %s", (long long)warning->runs,
             (long long)warning->point, warning->text);
    abi_add_warning(&result->messages, text);
  }
}

static strut_status complete(sweep *self, strutlib_result *result, const abi_scratch *scratch,
                             const strut_sweep_state *state, strut_error *what) {
  const strut_slot_rows rows = {.sources = &self->slots, .count = 1, .partial = true};
  strut_status status = add_table(&self->plan, self->slots, true, result, what);
  if (status) return status;
  add_warnings(result, state);
  status = strut_study_table_write(scratch->folder, table_name, &rows, NULL, what);
  if (status != STRUT_OK) return status;
  result->table = abi_scratch_read(scratch, table_name, what);
  return result->table ? STRUT_OK : what->status;
}

/* Runs a sweep that is read, and completes the result. */
static strut_status run_sweep(sweep *self, strutlib_result *result, strut_error *what) {
  const strut_sweep_scenes scenes = {strut_varied_scenes_read, strut_setup_write, &self->scenes,
                                     strut_varied_scenes_vary};
  strut_sweep_state state = {0};
  abi_scratch scratch;
  strut_error late = {0};
  strut_status status = strut_sweep_plan_make(&self->study, &scenes, &self->plan, what);
  if (status != STRUT_OK) return status;
  if ((status = abi_scratch_begin(&scratch, slots_name, what)) != STRUT_OK) return status;
  status = run_points(self, &scratch, &state, what);
  if (status == STRUT_INTERRUPTED)
    strut_fail(what, status, "interrupted after %lld of %lld points", (long long)state.done,
               (long long)state.points);
  if (status == STRUT_OK || status == STRUT_INTERRUPTED) {
    strut_status completed = complete(self, result, &scratch, &state, &late);
    if (completed != STRUT_OK) *what = late;
    if (completed != STRUT_OK) status = completed;
  }
  strut_slots_close(self->slots);
  abi_scratch_end(&scratch, files);
  return status;
}

strutlib_result *strutlib_sweep(const strutlib_scene *scene, size_t axis_count,
                                const char *const *axes, size_t point_count, const double *points,
                                const char *const *words, size_t keep_count,
                                const char *const *keep, size_t count, const char *const *names,
                                const char *const *values, strutlib_row row, void *context,
                                strutlib_control *control, strutlib_error **error) {
  sweep s = {.scene = scene, .row = row, .context = context};
  abi_call call;
  strut_error what = {0};
  abi_enter(error);
  s.control = control ? control : &s.own;
  strutlib_result *result = abi_result_create(&abi_sweep_command, error);
  strut_status status = result ? STRUT_OK : STRUT_NO_MEMORY;
  if (result)
    status = abi_call_begin(&call, scene, &abi_sweep_command, &(abi_pairs){count, names, values},
                            control, error, &result->messages);
  if (status == STRUT_OK && (abi_lacks_texts(error, axis_count, axes, "axes") ||
                             abi_lacks_texts(error, keep_count, keep, "keep")))
    status = STRUT_USAGE;
  else if (status == STRUT_OK) {
    s.study.name = "sweep";
    s.study.quantities = strut_arena_allocate(&s.arena, keep_count, sizeof *s.study.quantities);
    if (!s.study.quantities) status = strut_no_memory(&what, "");
    if (status == STRUT_OK) status = read_options(&call.arguments, &s, &what);
    if (status == STRUT_OK) status = check_options(&call, &s);
    if (status == STRUT_OK)
      status = add_axes(&s, axis_count, axes, point_count, points, words, &what);
    if (status == STRUT_OK)
      status =
          strut_varied_scenes_open(&call.arguments, s.names, s.axis.column_count, &s.scenes, NULL);
    for (size_t i = 0; i < keep_count && status == STRUT_OK; i++)
      status = add_kept(&s, keep[i], &what);
    if (status == STRUT_OK) status = run_sweep(&s, result, &what);
    if (status != STRUT_OK && !s.located) abi_call_fail(&call, status, &what);
  }
  strut_sweep_plan_free(&s.plan);
  strut_varied_scenes_free(&s.scenes);
  strut_arena_free(&s.arena);
  if (result) result->status = (int)status;
  bool there = status == STRUT_INTERRUPTED && result->table;
  return abi_result_leave(result, status == STRUT_OK || there);
}

/* ---- studies by file ---- */

/* A study under way. */
typedef struct study {
  strut_sweep_study open;
  strut_study_job job;
  strutlib_result *result;
  strutlib_control *control, own;
  strut_setting *overrides; /* in the arena of the result */
} study;

static void show_study(const strut_study_job *job, const strut_sweep_state *state) {
  study *self = job->context;
  if (state && state->points > 0)
    abi_progress(self->control, (double)state->done / (double)state->points);
}

static strut_status keep_report(const strut_study_job *job, const strut_value_rows *rows,
                                const void *of, const char *json) {
  strutlib_result *result = ((const study *)job->context)->result;
  char *copy = json ? strut_allocate(strlen(json) + 1, 1) : strut_values_json(rows, of, NULL);
  if (copy && json) strcpy(copy, json);
  result->json = copy;
  return strut_tell_failure(job->arguments->listener, copy ? STRUT_OK : STRUT_NO_MEMORY, NULL);
}

/* Opens the study; sets the error. */
static strut_status open_study(abi_call *call, study *self) {
  strut_study_file *file = &self->open.file;
  strut_error what = {0};
  strut_status status = strut_sweep_study_try(&call->arguments, &self->open, &what);
  abi_add_notes(&self->result->messages, &file->diagnostics);
  abi_add_notes(&self->result->messages, &file->model_diagnostics);
  if (!status) return STRUT_OK;
  if (status != STRUT_BAD_SCENE || what.message[0])
    return abi_call_fail(call, status, &what), status;
  strut_diagnostics *found[] = {&file->diagnostics, &file->model_diagnostics};
  return (strut_status)abi_fail_located(call->error, status, found, 2);
}

/* Computes the study; sets the error where there is no result. */
static strut_status run_study(abi_call *call, study *self) {
  strutlib_result *result = self->result;
  const strut_sweep_plan *plan = &self->open.plan;
  strut_error what = {0};
  size_t length;
  self->job = (strut_study_job){.arguments = &call->arguments,
                                .study = &self->open,
                                .interrupt = &self->control->interrupt,
                                .context = self,
                                .progress = show_study,
                                .report = keep_report};
  strut_status status = strut_study_job_compute(&self->job), added = STRUT_OK;
  bool there = result->json &&
               (status == STRUT_OK || status == STRUT_DIVERGED || status == STRUT_INACCURATE);
  const char *path =
      strut_arena_format(&result->arena, "%s/%s", call->arguments.output, table_name);
  if (there) added = add_table(plan, self->job.slots, false, result, &what);
  if (there && !added)
    added = path ? strut_file_read(path, &result->table, &length, &what) : STRUT_NO_MEMORY;
  strut_slots_close(self->job.slots);
  if (!there || added) abi_call_fail(call, there ? added : status, &what);
  return added ? added : status;
}

strutlib_result *strutlib_study(const char *path, const char *directory, size_t setting_count,
                                const char *const *settings, const char *const *set, size_t count,
                                const char *const *names, const char *const *values,
                                strutlib_control *control, strutlib_error **error) {
  abi_call call;
  study s = {0};
  if (abi_lacks(error, path, "path") || abi_lacks(error, directory, "directory") ||
      abi_lacks_pairs(error, setting_count, settings, set))
    return NULL;
  abi_enter(error);
  s.control = control ? control : &s.own;
  s.result = abi_result_create(&abi_study_command, error);
  strut_status status = s.result ? STRUT_OK : STRUT_NO_MEMORY;
  if (!status) {
    s.overrides = strut_arena_allocate(&s.result->arena, setting_count, sizeof *s.overrides);
    if (!s.overrides) status = (strut_status)abi_no_memory(error);
  }
  for (size_t i = 0; !status && i < setting_count; i++)
    s.overrides[i] = (strut_setting){.name = settings[i], .text = set[i]};
  const strut_arguments begun = {.command = &abi_study_command,
                                 .model = path,
                                 .output = directory,
                                 .overrides = s.overrides,
                                 .override_count = setting_count,
                                 .json = true};
  if (!status)
    status = abi_call_begin_file(&call, &begun, &(abi_pairs){count, names, values}, control, error,
                                 &s.result->messages);
  if (!status) status = open_study(&call, &s);
  if (!status) status = run_study(&call, &s);
  strut_sweep_study_close(&s.open);
  if (s.result) s.result->status = (int)status;
  return abi_result_leave(s.result, s.result && s.result->table);
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
