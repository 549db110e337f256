/* SPDX-License-Identifier: GPL-3.0-or-later */
/* strutlib_sweep: the points of `strut sweep`, given as numbers, with the table as arrays. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "engine/study/results/study_table.h"
#include "engine/study/sweep/sweep.h"
#include "parser/bindings/abi/handles.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/arguments.h"
#include "parser/program/command/run_settings.h"
#include "parser/program/command/varied_scenes.h"

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
  abi_detail base;
  size_t points, column_count;
  const strut_slot_column *columns; /* (column_count) in the result's arena, as all below */
  const char ***words;              /* (column_count) (points) of columns of words; or NULL */
  const char **messages;            /* (points) */
} sweep_detail;

static void release(void *detail) { strut_release(detail); }

/* ---- the study ---- */

static strut_status refuse_parameter(const strut_scene_source *source, const char *name,
                                     strut_error *what) {
  const char *near = strut_did_you_mean(name, strut_scene_source_parameter_name, source);
  return strut_fail(what, STRUT_USAGE, "the scene has no parameter '%s'%s%s%s", name,
                    near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* Column k of the points, which are (count, axes). */
static strut_status add_axis(sweep *s, size_t k, const char *name, const double *points,
                             const char *const *words, strut_error *what) {
  size_t count = (size_t)s->axis.count, axes = s->axis.column_count;
  const strut_scene_source *source = s->scene->source->tree;
  const strut_declared *d = strut_scene_source_parameter(source, name);
  if (!d) return refuse_parameter(source, name, what);
  strut_study_column *c = &s->axis.columns[k];
  *c = (strut_study_column){.name = d->name,
                            .unit = d->bare || d->text ? "1" : strut_dimension_unit(d->dimension),
                            .word = d->text,
                            .kind = STRUT_RANGE_LIST};
  s->names[k] = d->name;
  double *numbers = strut_arena_allocate(&s->arena, count, sizeof *numbers);
  const char **texts = strut_arena_allocate(&s->arena, count, sizeof *texts);
  if (!numbers || !texts) return strut_no_memory(what, "");
  for (size_t i = 0; i < count; i++) {
    const char *word = words ? words[i * axes + k] : NULL;
    if (d->text && !word)
      return strut_fail(what, STRUT_USAGE, "parameter '%s' is a text: point %zu gives none", name,
                        i);
    if (!d->text && !(points && isfinite(points[i * axes + k])))
      return strut_fail(what, STRUT_USAGE, "parameter '%s' at point %zu must be a finite number",
                        name, i);
    numbers[i] = d->text ? 0.0 : points[i * axes + k];
    texts[i] = word;
  }
  if (d->text)
    c->words = texts;
  else
    c->number = numbers;
  return STRUT_OK;
}

static strut_status add_axes(sweep *s, size_t axes, const char *const *names, size_t count,
                             const double *points, const char *const *words, strut_error *what) {
  strut_status status = STRUT_OK;
  if (axes == 0) return STRUT_OK; /* one point */
  if (count == 0 || count > (size_t)STRUT_STUDY_MOST_POINTS)
    return strut_fail(what, STRUT_USAGE, "a sweep has from 1 to %lld points, not %zu",
                      (long long)STRUT_STUDY_MOST_POINTS, count);
  s->axis = (strut_study_axis){.count = (int64_t)count, .column_count = axes};
  s->axis.columns = strut_arena_allocate(&s->arena, axes, sizeof *s->axis.columns);
  s->names = strut_arena_allocate(&s->arena, axes, sizeof *s->names);
  if (!s->axis.columns || !s->names) return strut_no_memory(what, "");
  for (size_t k = 0; k < axes && status == STRUT_OK; k++) {
    for (size_t before = 0; before < k; before++)
      if (strcmp(names[before], names[k]) == 0)
        return strut_fail(what, STRUT_USAGE, "parameter '%s' is given twice", names[k]);
    status = add_axis(s, k, names[k], points, words, what);
  }
  s->study.axes = &s->axis;
  s->study.axis_count = 1;
  return status;
}

static const char *kept_word_at(const void *context, size_t i) {
  (void)context;
  return i < STRUT_KEEP_COUNT ? strut_kept_word_at(i)->word : NULL;
}

static strut_status add_kept(sweep *s, const char *word, strut_error *what) {
  int found = strut_keep_find(word, s->study.compute);
  if (found >= 0) {
    strut_keep_add(&s->study.keep, (unsigned)found);
    return STRUT_OK;
  }
  if (s->study.compute == STRUT_COMPUTE_RUN && strutlib_index(s->scene, "quantities", word) >= 0) {
    s->study.quantities[s->study.quantity_count++] =
        strut_arena_text(&s->arena, word, strlen(word));
    return s->study.quantities[s->study.quantity_count - 1] ? STRUT_OK : strut_no_memory(what, "");
  }
  const char *near = strut_did_you_mean(word, kept_word_at, NULL);
  return strut_fail(what, STRUT_USAGE,
                    "a sweep cannot keep '%s'%s%s%s; see 'keep' of the section study in the "
                    "language's keys",
                    word, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static strut_status read_options(const strut_arguments *a, sweep *s, strut_error *what) {
  s->threads = a->threads.value;
  s->study.limit.evaluations = a->limit_evaluations.value;
  s->study.limit.time = a->limit_time.value;
  s->study.compute = (uint32_t)a->compute.index;
  s->study.lowest = (int32_t)a->lowest.value;
  if (a->at && !(s->study.at = strut_arena_text(&s->arena, a->at, strlen(a->at))))
    return strut_no_memory(what, "");
  return STRUT_OK;
}

/* Applies the options of method and model to the scene itself, so that what is wrong with them is said once. */
static strut_status check_options(abi_call *call, sweep *s) {
  const strut_arguments *a = &call->arguments;
  bool run = s->study.compute == STRUT_COMPUTE_RUN;
  strut_setup setup;
  s->scenes =
      (strut_varied_scenes){.file = s->scene->source->name,
                            .source = s->scene->source->tree,
                            .purpose = run ? strut_run_options_purpose(a) : STRUT_FOR_ANY_STATICS};
  s->options = *a;
  s->options.listener = NULL;
  if (!strut_run_option_given(a, 0)) return STRUT_OK;
  strut_status status = abi_setup(s->scene, s->scenes.purpose, &setup, call->error);
  s->located = status != STRUT_OK;
  if (status != STRUT_OK) return status;
  status = strut_run_options_apply(a, &setup);
  strut_setup_free(&setup);
  return status;
}

/* ---- scenes of points; called from several threads ---- */

static strut_status setup_of(void *context, const strut_study_value *values, strut_setup *setup,
                             strut_error *error) {
  const sweep *s = context;
  strut_status status = strut_varied_scenes_read(&s->scenes, values, setup, error);
  if (status == STRUT_OK && (status = strut_run_options_apply(&s->options, setup)) != STRUT_OK) {
    strut_fail(error, status, "the options do not fit the scene of this point");
    strut_setup_free(setup);
  }
  return status;
}

/* ---- rows ---- */

/* Reports all rows that are done and were not reported. */
static void report_rows(sweep *s) {
  for (int64_t i = 0; s->row && i < s->plan.points; i++) {
    strut_result_slot slot;
    if (s->reported[i] || !strut_slots_done(s->slots, i)) continue;
    if (!strut_slots_get(s->slots, i, &slot)) continue;
    s->reported[i] = 1;
    if (s->row(s->context, (size_t)i, (int)slot.status)) s->control->interrupt = 1;
  }
}

static void show_progress(void *context, const strut_sweep_state *state) {
  sweep *s = context;
  double fraction = state->points > 0 ? (double)state->done / (double)state->points : 1.0;
  report_rows(s);
  if (s->control->progress && s->control->progress(s->control->context, fraction))
    s->control->interrupt = 1;
}

static strut_status run_points(sweep *s, const abi_scratch *scratch, strut_sweep_state *state,
                               strut_error *what) {
  const strut_slots_description plan = {.version = STRUT_VERSION,
                                        .name = "sweep",
                                        .points = s->plan.points,
                                        .count = s->plan.points,
                                        .columns = s->plan.columns,
                                        .column_count = s->plan.column_count};
  const strut_sweep_options how = {.threads = (int)s->threads,
                                   .interrupt = &s->control->interrupt,
                                   .progress = show_progress,
                                   .progress_context = s};
  s->reported = strut_arena_allocate(&s->arena, (size_t)s->plan.points, 1);
  if (!s->reported) return strut_no_memory(what, "");
  strut_status status = strut_slots_open(scratch->path, &plan, &s->slots, what);
  if (status == STRUT_OK) status = strut_sweep_run(&s->plan, s->slots, &how, state, what);
  if (status == STRUT_OK || status == STRUT_INTERRUPTED) report_rows(s);
  return status;
}

/* ---- the result ---- */

static bool add_columns(sweep *s, strutlib_result *result, sweep_detail *d, double **data) {
  size_t n = (size_t)s->plan.points;
  strut_slot_column *columns =
      strut_arena_allocate(&result->arena, s->plan.column_count, sizeof *columns);
  d->columns = columns;
  d->column_count = s->plan.column_count;
  d->points = n;
  d->words = strut_arena_allocate(&result->arena, d->column_count, sizeof *d->words);
  d->messages = strut_arena_allocate(&result->arena, n, sizeof *d->messages);
  if (!columns || !d->words || !d->messages) return false;
  for (size_t c = 0; c < d->column_count; c++) {
    columns[c] = s->plan.columns[c];
    columns[c].name = strut_arena_text(&result->arena, columns[c].name, strlen(columns[c].name));
    if (!columns[c].name) return false;
    if (columns[c].word) {
      d->words[c] = strut_arena_allocate(&result->arena, n, sizeof **d->words);
      if (!d->words[c]) return false;
      continue;
    }
    data[c] = strut_arena_allocate(&result->arena, n, sizeof **data);
    for (size_t i = 0; data[c] && i < n; i++) data[c][i] = (double)NAN;
    if (!data[c] || !abi_result_add_array(result, columns[c].name, columns[c].unit, data[c], 1, &n))
      return false;
  }
  return true;
}

static bool copy_row(strutlib_result *result, sweep_detail *d, const strut_result_slot *row,
                     size_t point, double *const *data) {
  size_t number = 0, word = 0;
  for (size_t c = 0; c < d->column_count; c++) {
    if (!d->columns[c].word) {
      data[c][point] = row->numbers[number++];
      continue;
    }
    const char *text = row->words[word++];
    d->words[c][point] = strut_arena_text(&result->arena, text, strlen(text));
    if (!d->words[c][point]) return false;
  }
  if (!row->message || !row->message[0]) return true;
  d->messages[point] = strut_arena_text(&result->arena, row->message, strlen(row->message));
  return d->messages[point] != NULL;
}

static bool fill_table(sweep *s, strutlib_result *result, sweep_detail *d) {
  size_t n = (size_t)s->plan.points;
  double **data = strut_arena_allocate(&s->arena, s->plan.column_count, sizeof *data);
  double *status = strut_arena_allocate(&result->arena, n, sizeof *status);
  bool good = data && status && add_columns(s, result, d, data);
  for (size_t i = 0; good && i < n; i++) {
    strut_result_slot row;
    bool there = strut_slots_get(s->slots, (int64_t)i, &row);
    status[i] = there ? (double)row.status : (double)STRUT_INTERRUPTED;
    if (there) good = copy_row(result, d, &row, i, data);
  }
  return good && abi_result_add_array(result, "status", "1", status, 1, &n);
}

static void add_warnings(strutlib_result *result, const strut_sweep_state *state) {
  for (size_t i = 0; i < state->warning_count; i++) {
    const strut_sweep_warning *w = &state->warnings[i];
    char text[sizeof w->text + 80];
    snprintf(text, sizeof text, "%lld runs, the first at point %lld: %s", (long long)w->runs,
             (long long)w->point, w->text);
    abi_add_warning(&result->messages, text);
  }
}

static strut_status complete(sweep *s, strutlib_result *result, const abi_scratch *scratch,
                             const strut_sweep_state *state, strut_error *what) {
  strut_slots *const sources[] = {s->slots};
  sweep_detail *d = strut_allocate(1, sizeof *d);
  if (!d) return strut_no_memory(what, "");
  d->base.release = release;
  result->detail = d;
  if (!fill_table(s, result, d)) return strut_no_memory(what, "");
  add_warnings(result, state);
  strut_status status =
      strut_study_table_write_partial(scratch->folder, table_name, sources, 1, NULL, what);
  if (status != STRUT_OK) return status;
  result->table = abi_scratch_read(scratch, table_name, what);
  return result->table ? STRUT_OK : what->status;
}

/* Runs a sweep that is read, and completes the result. */
static strut_status run_sweep(sweep *s, strutlib_result *result, strut_error *what) {
  const strut_sweep_scenes scenes = {setup_of, strut_setup_write, s};
  strut_sweep_state state = {0};
  abi_scratch scratch;
  strut_error late = {0};
  strut_status status = strut_sweep_plan_make(&s->study, &scenes, &s->plan, what);
  if (status != STRUT_OK) return status;
  if ((status = abi_scratch_begin(&scratch, slots_name, what)) != STRUT_OK) return status;
  status = run_points(s, &scratch, &state, what);
  if (status == STRUT_INTERRUPTED)
    strut_fail(what, status, "interrupted after %lld of %lld points", (long long)state.done,
               (long long)state.points);
  if (status == STRUT_OK || status == STRUT_INTERRUPTED) {
    strut_status completed = complete(s, result, &scratch, &state, &late);
    if (completed != STRUT_OK) *what = late;
    if (completed != STRUT_OK) status = completed;
  }
  strut_slots_close(s->slots);
  abi_scratch_end(&scratch, files);
  return status;
}

/* Is a list of texts, or one of them, NULL? */
static bool lacks_text(strutlib_error **error, size_t count, const char *const *texts,
                       const char *name) {
  bool lacks = count && abi_lacks(error, texts, name);
  for (size_t i = 0; i < count && !lacks; i++) lacks = abi_lacks(error, texts[i], name);
  return lacks;
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
  if (status == STRUT_OK &&
      (lacks_text(error, axis_count, axes, "axes") || lacks_text(error, keep_count, keep, "keep")))
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
  if (status != STRUT_OK && !(status == STRUT_INTERRUPTED && result->table)) {
    strutlib_result_free(result);
    result = NULL;
  }
  abi_leave();
  return result;
}

/* ---- columns of words ---- */

const char *strutlib_result_column(const strutlib_result *result, size_t i) {
  if (!result || result->command != &abi_sweep_command) return NULL;
  const sweep_detail *d = result->detail;
  return i < d->column_count ? d->columns[i].name : NULL;
}

const char *strutlib_result_cell(const strutlib_result *result, const char *column, size_t point) {
  if (!result || !column || result->command != &abi_sweep_command) return NULL;
  const sweep_detail *d = result->detail;
  if (point >= d->points) return NULL;
  if (strcmp(column, "message") == 0) return d->messages[point];
  for (size_t c = 0; c < d->column_count; c++)
    if (d->words[c] && strcmp(d->columns[c].name, column) == 0) return d->words[c][point];
  return NULL;
}
