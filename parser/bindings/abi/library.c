/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The library as a whole: versions, codes, errors, controls, and what holds while a call computes. */
#include <gsl/gsl_errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/output/hdf5_library.h"
#include "engine/output/result_values.h"
#include "engine/output/results.h"
#include "engine/scene/study.h"
#include "parser/bindings/abi/handles.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/yaml/text.h"
#include "parser/program/command/analyses.h"
#include "parser/program/command/scene_options.h"

/* No call of the library reads or writes trajectory.h5. With this definition neither HDF5 nor the libraries for
   network files that it needs are linked. */
strut_status strut_hdf5_load(const strut_hdf5_library **library, strut_error *error) {
  *library = NULL;
  return strut_fail(error, STRUT_FILE_TROUBLE, "this library has no HDF5; use the program strut");
}

enum { MOST_MESSAGES = 50 }; /* that a report shows */

typedef struct located {
  const char *text, *file, *source, *hint, *key;
  size_t line, column, length;
} located;

struct strutlib_error {
  int status;
  const char *message, *report;
  size_t count;
  located *items; /* (count) */
  strut_arena arena;
};

/* What is left to say where there is no memory for more. */
static const struct strutlib_error out_of_memory = {
    .status = STRUTLIB_NO_MEMORY, .message = "out of memory", .report = "error: out of memory\n"};

int abi_no_memory(strutlib_error **error) {
  /* It is never changed: all functions take it as constant, and strutlib_error_free knows it. */
  if (error) *error = (strutlib_error *)(uintptr_t)&out_of_memory;
  return STRUTLIB_NO_MEMORY;
}

void strutlib_error_free(strutlib_error *error) {
  if (!error || error == &out_of_memory) return;
  strut_arena arena = error->arena; /* which owns the error, too */
  strut_arena_free(&arena);
}

static strutlib_error *create(int status) {
  strut_arena arena = {0};
  strutlib_error *self = strut_arena_allocate(&arena, 1, sizeof *self);
  if (!self) strut_arena_free(&arena);
  if (!self) return NULL;
  self->arena = arena;
  self->status = status;
  return self;
}

static int finish(strutlib_error **error, strutlib_error *self) {
  if (self->message && self->report) {
    *error = self;
    return self->status;
  }
  int status = self->status;
  strutlib_error_free(self);
  abi_no_memory(error);
  return status;
}

static int fail_with_text(strutlib_error **error, int status, const char *text) {
  if (!error) return status;
  if (status == STRUTLIB_NO_MEMORY && strcmp(text, "out of memory") == 0)
    return abi_no_memory(error);
  strutlib_error *self = create(status);
  if (!self) return abi_no_memory(error), status;
  self->message = strut_arena_text(&self->arena, text, strlen(text));
  self->report = strut_arena_format(&self->arena, "error: %s\n", text);
  return finish(error, self);
}

int abi_fail(strutlib_error **error, int status, const char *format, ...) {
  char text[STRUT_MESSAGE_MOST];
  va_list values;
  va_start(values, format);
  vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return fail_with_text(error, status, text);
}

int abi_fail_with(strutlib_error **error, strut_status status, const strut_error *what) {
  return fail_with_text(error, (int)status,
                        what && what->message[0] ? what->message : strut_status_text(status));
}

bool abi_lacks(strutlib_error **error, const void *argument, const char *name) {
  if (!argument) abi_fail(error, STRUTLIB_USAGE, "argument '%s' is NULL", name);
  return !argument;
}

bool abi_lacks_texts(strutlib_error **error, size_t count, const char *const *texts,
                     const char *name) {
  bool lacks = count && abi_lacks(error, texts, name);
  for (size_t i = 0; i < count && !lacks; i++) lacks = abi_lacks(error, texts[i], name);
  return lacks;
}

/* ---- located ones ---- */

/* The line of a place, without its end, in the arena. */
static const char *line_of(const strut_used_file *in, uint32_t line, strut_arena *arena) {
  strut_cursor at = strut_cursor_begin(in->text ? in->text : "", in->text ? in->length : 0);
  strut_cursor_to_line(&at, line);
  size_t end = at.offset;
  while (at.line == line && end < at.length && !strut_text_break(at.text + end, at.length - end))
    end++;
  return strut_arena_text(arena, at.text + at.offset, end - at.offset);
}

/* The word of "... did you mean 'WORD'?", in the arena, or NULL. */
static const char *hint_of(const char *message, strut_arena *arena) {
  static const char before[] = "did you mean '";
  const char *at = strstr(message, before);
  if (!at) return NULL;
  at += sizeof before - 1;
  const char *end = strchr(at, '\'');
  return end ? strut_arena_text(arena, at, (size_t)(end - at)) : NULL;
}

static bool is_behind(const strut_tree *node, strut_place place) {
  return node->place.line > place.line ||
         (node->place.line == place.line && node->place.column > place.column);
}

/* The path of keys to the last value that begins at or before the place; NULL: memory is out. */
static const char *key_of(const strut_document *document, strut_place place, strut_arena *arena) {
  const strut_tree *node = place.file == 0 && place.line > 0 ? document->root : NULL;
  const char *path = "";
  while (node && node->kind != STRUT_TREE_SCALAR && path) {
    const strut_tree *last = NULL, *child = node->first;
    bool map = node->kind == STRUT_TREE_MAP;
    uint32_t i = 0;
    for (; i < node->count && child && !is_behind(child, place); i++) {
      last = child;
      child = map ? child->next->next : child->next;
    }
    if (!last) break;
    const char *dot = *path ? "." : "";
    path = map ? strut_arena_format(arena, "%s%s%s", path, dot, last->text)
               : strut_arena_format(arena, "%s%s%u", path, dot, (unsigned)i - 1);
    node = map ? last->next : last;
  }
  return path;
}

static bool fill_item(const strut_diagnostics *found, const strut_document *document,
                      const strut_diagnostic *from, strut_arena *arena, located *to) {
  const strut_used_file in = strut_diagnostics_text(found, from->place);
  to->text = strut_arena_text(arena, from->message, strlen(from->message));
  to->file = strut_arena_text(arena, in.file, strlen(in.file));
  to->source = line_of(&in, from->place.line, arena);
  to->hint = hint_of(from->message, arena);
  to->key = key_of(document, from->place, arena);
  to->line = from->place.line;
  to->column = from->place.column;
  to->length = from->place.length;
  return to->text && to->file && to->source && to->key;
}

static strut_document reread(const strut_diagnostics *found) {
  strut_document document = {.root = NULL};
  strut_diagnostics unused = {0};
  if (!found->text) return document;
  strut_diagnostics_source(&unused, found->file, found->text, found->length);
  strut_document_read(&document, &unused);
  strut_diagnostics_free(&unused);
  return document;
}

/* Adds the report and the items of a text. */
static bool add_located(strutlib_error *self, strut_diagnostics *found) {
  const char *report = strut_diagnostics_render(found, MOST_MESSAGES); /* sorts them */
  bool good = report;
  if (good) self->report = strut_arena_format(&self->arena, "%s%s", self->report, report);
  strut_document document = reread(found);
  for (size_t i = 0; good && i < found->count; i++)
    good = fill_item(found, &document, &found->items[i], &self->arena, &self->items[self->count++]);
  strut_document_free(&document);
  return good && self->report;
}

strut_status abi_settle(strutlib_error **error, strut_status status, strut_diagnostics *found) {
  if (status == STRUT_NO_MEMORY)
    abi_no_memory(error);
  else if (status != STRUT_OK)
    abi_fail_located(error, status, &found, 1);
  strut_diagnostics_free(found);
  return status;
}

int abi_fail_located(strutlib_error **error, strut_status status, strut_diagnostics *const *found,
                     size_t count) {
  if (!error) return (int)status;
  size_t most = 0;
  strutlib_error *self = create((int)status);
  if (!self) return abi_no_memory(error), (int)status;
  for (size_t i = 0; i < count; i++) most += found[i]->count;
  self->report = "";
  self->items = strut_arena_allocate(&self->arena, most, sizeof *self->items);
  bool good = self->items;
  for (size_t i = 0; good && i < count; i++)
    if (found[i]->count) good = add_located(self, found[i]);
  if (good && self->count > 0 && self->items[0].line > 0)
    self->message =
        strut_arena_format(&self->arena, "%s:%zu:%zu: %s", self->items[0].file, self->items[0].line,
                           self->items[0].column, self->items[0].text);
  else if (good && self->count > 0)
    self->message = self->items[0].text;
  else if (good)
    self->message = strut_status_text(status);
  return finish(error, self);
}

/* ---- what the header shows ---- */

#define OF_ERROR(TYPE, PART, NONE)                                                                 \
  TYPE strutlib_error_##PART(const strutlib_error *error) { return error ? error->PART : NONE; }
OF_ERROR(int, status, STRUTLIB_OK)
OF_ERROR(const char *, message, NULL)
OF_ERROR(const char *, report, NULL)
OF_ERROR(size_t, count, 0)

/* What a located message has; `none` beyond the last. */
#define LOCATED(TYPE, PART, NONE)                                                                  \
  TYPE strutlib_error_##PART(const strutlib_error *error, size_t i) {                              \
    return i < strutlib_error_count(error) ? error->items[i].PART : NONE;                          \
  }
LOCATED(const char *, text, NULL)
LOCATED(const char *, file, NULL)
LOCATED(const char *, source, NULL)
LOCATED(const char *, hint, NULL)
LOCATED(const char *, key, NULL)
LOCATED(size_t, line, 0)
LOCATED(size_t, column, 0)
LOCATED(size_t, length, 0)

/* ---- messages ---- */

void abi_add_warning(abi_messages *m, const char *text) {
  const char *kept = strut_arena_text(&m->arena, text, strlen(text));
  if (!kept || !strut_grow(&m->warnings, &m->capacity, m->count, sizeof *m->warnings))
    m->out_of_memory = true;
  else
    m->warnings[m->count++] = kept;
}

void abi_add_notes(abi_messages *m, const strut_diagnostics *found) {
  for (size_t i = 0; i < found->note_count; i++) abi_add_warning(m, found->notes[i].message);
}

static void hear(void *context, strut_message_kind kind, const char *command, const char *text) {
  abi_messages *self = context;
  (void)command;
  switch (kind) {
    case STRUT_MESSAGE_LINES: break; /* abi_fail_located has them */
    case STRUT_MESSAGE_USAGE:
    case STRUT_MESSAGE_ERROR: strut_fail(&self->error, STRUT_USAGE, "%s", text); break;
    case STRUT_MESSAGE_WARNING:
    case STRUT_MESSAGE_NOTE:
    case STRUT_MESSAGE_REMARK: abi_add_warning(self, text); break;
  }
}

strut_listener abi_listen(abi_messages *messages) {
  return (strut_listener){.context = messages, .hear = hear};
}

void abi_messages_free(abi_messages *messages) {
  strut_arena_free(&messages->arena);
  strut_release((void *)messages->warnings);
  *messages = (abi_messages){0};
}

int strutlib_abi_version(void) { return STRUTLIB_ABI_VERSION; }
const char *strutlib_version(void) { return STRUT_VERSION; }
void strutlib_release(char *text) { strut_release(text); }

char *strutlib_schema(int study, strutlib_error **error) {
  abi_enter(error);
  return abi_leave_text(error, strut_schema_write(study != 0), NULL);
}

static struct cJSON *put_places(strut_json *json, struct cJSON *to, const strut_tree *node) {
  struct cJSON *place = strut_json_array(json, to, to == json->root ? "places" : NULL);
  strut_json_integer(json, place, NULL, node->place.line);
  strut_json_integer(json, place, NULL, node->place.column);
  if (node->kind == STRUT_TREE_SCALAR) {
    strut_json_text(json, place, NULL, node->text);
  } else {
    struct cJSON *list = strut_json_array(json, place, NULL);
    for (const strut_tree *child = node->first; child; child = child->next)
      put_places(json, list, child);
  }
  if (node->kind == STRUT_TREE_MAP) strut_json_bool(json, place, NULL, true);
  return place;
}

char *strutlib_yaml_places(const char *name, const char *text, strutlib_error **error) {
  if (abi_lacks(error, name, "name") || abi_lacks(error, text, "text")) return NULL;
  strut_document document = {0};
  strut_diagnostics found = {0};
  strut_json json = strut_json_begin();
  struct cJSON *places = NULL;
  char *answer = NULL;
  abi_enter(error);
  strut_diagnostics_source(&found, name, text, strlen(text));
  strut_status status = strut_document_read(&document, &found);
  if (!status) places = put_places(&json, json.root, document.root);
  if (!status && !json.failed) answer = strut_json_print(places);
  strut_release(strut_json_end(&json));
  strut_document_free(&document);
  abi_settle(error, status, &found);
  return abi_leave_text(error, answer, NULL);
}

/* ---- codes ---- */

#define STATUSES(X)                                                                                \
  X(OK, "ok")                                                                                      \
  X(USAGE, "usage")                                                                                \
  X(BAD_SCENE, "bad_scene")                                                                        \
  X(DIVERGED, "diverged")                                                                          \
  X(STEP_TOO_LARGE, "step_too_large")                                                              \
  X(NOT_SETTLED, "not_settled")                                                                    \
  X(SINGULAR, "singular")                                                                          \
  X(WORK_LIMIT, "work_limit")                                                                      \
  X(FILE_TROUBLE, "file_trouble")                                                                  \
  X(NO_MEMORY, "no_memory")                                                                        \
  X(INTERRUPTED, "interrupted")                                                                    \
  X(INACCURATE, "inaccurate")
#define NAME(CODE, WORD) [STRUTLIB_##CODE] = WORD,
#define SAME(CODE, WORD) _Static_assert(STRUTLIB_##CODE == (int)STRUT_##CODE, WORD);
STATUSES(SAME)
_Static_assert(STRUTLIB_INACCURATE + 1 == (int)STRUT_STATUS_COUNT, "all have a word");
static const char *const status_names[STRUT_STATUS_COUNT] = {STATUSES(NAME)};

static bool is_status(int status) { return status >= 0 && status < (int)STRUT_STATUS_COUNT; }

const char *strutlib_status_name(int status) {
  return is_status(status) ? status_names[status] : "unknown";
}

const char *strutlib_status_text(int status) {
  return is_status(status) ? strut_status_text((strut_status)status) : "unknown status";
}

int strutlib_exit_code(int status) {
  return is_status(status) ? strut_status_exit_code((strut_status)status) : 1;
}

/* ---- controls ---- */

strutlib_control *strutlib_control_create(void) {
  return strut_allocate(1, sizeof(strutlib_control));
}

void strutlib_control_free(strutlib_control *control) { strut_release(control); }
void strutlib_interrupt(strutlib_control *control) {
  if (control) control->interrupt = 1;
}

void strutlib_control_reset(strutlib_control *control) {
  if (control) control->interrupt = 0;
}

int strutlib_control_interrupted(const strutlib_control *control) {
  return control && control->interrupt != 0;
}

void strutlib_control_on_progress(strutlib_control *control, strutlib_progress progress,
                                  void *context) {
  if (!control) return;
  control->context = context;
  control->progress = progress;
}

/* ---- GSL's error handler ---- */

/*
 * GSL has one handler for the whole process, which by default aborts. It is off while any call computes;
 * the last one that leaves puts back what the host had, unless the host has set another meanwhile.
 */
static pthread_mutex_t handler_lock = PTHREAD_MUTEX_INITIALIZER;
static int computing;
static gsl_error_handler_t *of_host;

void abi_enter(strutlib_error **error) {
  if (error) *error = NULL;
  pthread_mutex_lock(&handler_lock);
  if (computing++ == 0) of_host = gsl_set_error_handler_off();
  pthread_mutex_unlock(&handler_lock);
}

void abi_leave(strutlib_error **error, strut_status status, const strut_error *what) {
  if (status && error && !*error) abi_fail_with(error, status, what);
  pthread_mutex_lock(&handler_lock);
  if (--computing == 0) {
    gsl_error_handler_t *now = gsl_set_error_handler_off();
    gsl_error_handler_t *off = gsl_set_error_handler(of_host);
    if (now != off) gsl_set_error_handler(now);
  }
  pthread_mutex_unlock(&handler_lock);
}

char *abi_leave_text(strutlib_error **error, char *text, const strut_error *what) {
  strut_status failure = what && what->status ? what->status : STRUT_NO_MEMORY;
  abi_leave(error, text ? STRUT_OK : failure, what);
  return text;
}

/* ---- calls ---- */

abi_call abi_call_of(const strutlib_scene *scene, const strut_command *command,
                     strutlib_control *control, strutlib_error **error) {
  return (abi_call){.scene = scene,
                    .arguments = {.command = command,
                                  .model = scene->source->name,
                                  .overrides = scene->settings,
                                  .override_count = scene->setting_count},
                    .control = control,
                    .error = error};
}

strut_status abi_call_begin(abi_call *call, const abi_pairs *options) {
  if (abi_lacks_pairs(call->error, options->count, options->names, options->values))
    return STRUT_USAGE;
  call->listener = abi_listen(&call->messages);
  call->arguments.listener = &call->listener;
  for (size_t i = 0; i < options->count; i++) {
    strut_status status =
        strut_argument_set(options->names[i], options->values[i], &call->arguments);
    if (status) return status;
  }
  if (!call->control || !call->control->interrupt) return STRUT_OK;
  return strut_fail(&call->what, STRUT_INTERRUPTED, "interrupted before anything was computed");
}

void abi_call_leave(const abi_call *call, strut_status status) {
  const strut_error *heard = &call->messages.error;
  abi_leave(call->error, status, !call->what.message[0] && heard->message[0] ? heard : &call->what);
}

strutlib_result *abi_compute(abi_call *call, const abi_pairs *options, abi_work *work) {
  abi_enter(call->error);
  strutlib_result *result = abi_result_create(call->arguments.command);
  strut_status status = result ? abi_call_begin(call, options) : STRUT_NO_MEMORY;
  if (!status) status = work(call, result);
  abi_call_leave(call, status);
  if (!result) return NULL;
  if (status) result->status = (int)status;
  result->messages = call->messages;
  if (call->complete) return result;
  strutlib_result_free(result);
  return NULL;
}

/* ---- options ---- */

/* The library's commands: of each the options that the program's command of that name has, files apart. */

static const strut_option run_options[] = {
    STRUT_FORCE_OPTION,
    {.table = strut_experiment_options},
    {STRUT_FILLS(channels), "channels", "NAME,...", "channels to record, instead of the scene's",
     .words = STRUT_CHANNEL_WORDS},
    {STRUT_FILLS(record), "record", "YES|NO", "record channels (default yes)", .words = "yes|no"},
    {.name = NULL}};
static const strut_option simulation_options[] = {
    STRUT_FORCE_OPTION,
    {.table = strut_method_options},
    {.table = strut_fidelity_options},
    {STRUT_FILLS(channels), "channels", "NAME,...", "channels to record; sets record",
     .words = STRUT_CHANNEL_WORDS},
    {STRUT_FILLS(record), "record", "YES|NO", "record the run, up to its end (default no)",
     .words = "yes|no"},
    {.name = NULL}};
static const strut_option sweep_options[] = {
    {STRUT_FILLS(compute), "compute", "WHAT",
     "run (default), equilibria, modes, rigidity, path or form", .key = STRUT_KEY_STUDY_COMPUTE},
    {STRUT_FILLS(at), "at", "NAME", "equilibrium of modes, rigidity and path"},
    {STRUT_FILLS(lowest), "lowest", "N", "number of energies, barriers and frequencies in a row",
     .least = 1, .most = STRUT_STUDY_MOST_LOWEST},
    {STRUT_FILLS(limit_evaluations), "limit_evaluations", "N",
     "force evaluations after which a point fails", .least = 1, .most = INT64_MAX / 16},
    {STRUT_FILLS(limit_time), "limit_time", "TIME", "time after which a point fails",
     .measure = STRUT_MEASURE_TIME, .limits = STRUT_LIMITS_NOT_NEGATIVE},
    {STRUT_FILLS(threads), "threads", "N", "number of threads (default automatic)", .least = 1,
     .most = 4096},
    {.table = strut_experiment_options},
    {.name = NULL}};

static const strut_option study_options[] = {
    {STRUT_FILLS(threads), "threads", "N", "number of threads (default automatic)", .least = 1,
     .most = 4096},
    {STRUT_FILLS(retry), "retry", NULL, "recompute points that failed"},
    {.table = strut_run_setting_options},
    {.name = NULL}};

const strut_command abi_run_command = {.name = "run", .options = run_options},
                    abi_matrices_command = {.name = "matrices",
                                            .options = strut_rigidity_analysis_options},
                    abi_sweep_command = {.name = "sweep", .options = sweep_options},
                    abi_study_command = {.name = "study", .options = study_options},
                    abi_simulation_command = {.name = "simulation_open",
                                              .options = simulation_options};

#define ANALYSIS(NAME)                                                                             \
  const strut_command abi_##NAME##_command = {.name = #NAME,                                       \
                                              .options = strut_##NAME##_analysis_options,          \
                                              .analysis = &strut_##NAME##_analysis};
STRUT_ANALYSES(ANALYSIS)

/* NULL after the last. */
static const strut_command *command_at(size_t i) {
#define COMMAND(NAME) &abi_##NAME##_command,
  static const strut_command *const all[] = {
      &abi_run_command,        &abi_matrices_command, &abi_sweep_command,     &abi_study_command,
      &abi_simulation_command, &abi_svg_command,      STRUT_ANALYSES(COMMAND)};
  return i < sizeof all / sizeof all[0] ? all[i] : NULL;
}

static const strut_option *option_of(const char *name, size_t i) {
  const strut_command *command;
  for (size_t k = 0; name && (command = command_at(k)); k++)
    if (strcmp(command->name, name) == 0) return strut_option_row(command->options, i);
  return NULL;
}

static const char *kind_of(const strut_option *option) {
  static const char *const names[] = {"selector", "flag", "setting", "text", "number",
                                      "whole",    "word", "words",   "range"};
  return names[option->kind];
}

#define OPTION(PART, VALUE)                                                                        \
  const char *strutlib_option_##PART(const char *command, size_t i) {                              \
    const strut_option *option = option_of(command, i);                                            \
    return option ? VALUE : NULL;                                                                  \
  }
OPTION(name, option->name)
OPTION(help, option->help)
OPTION(kind, kind_of(option))
OPTION(words, strut_option_words(option))

/* ---- a temporary folder ---- */

strut_status abi_scratch_begin(abi_scratch *self, const char *name, strut_error *error) {
  const char *temporary = getenv("TMPDIR");
  bool usable = temporary && *temporary && strlen(temporary) < sizeof self->folder - 40;
  snprintf(self->folder, sizeof self->folder, "%s/" STRUT_STAGE_PREFIX "XXXXXX",
           usable ? temporary : "/tmp");
  if (!mkdtemp(self->folder))
    return strut_fail(error, STRUT_FILE_TROUBLE, "cannot create a temporary folder in '%s'",
                      usable ? temporary : "/tmp");
  snprintf(self->path, sizeof self->path, "%s/%s", self->folder, name);
  return STRUT_OK;
}

char *abi_scratch_read(const abi_scratch *self, const char *name, strut_error *error) {
  char path[sizeof self->path], *text = NULL;
  size_t length;
  snprintf(path, sizeof path, "%s/%s", self->folder, name);
  strut_file_read(path, &text, &length, error);
  return text;
}

static void remove_file(const abi_scratch *self, const char *name) {
  char path[sizeof self->path];
  snprintf(path, sizeof path, "%s/%s", self->folder, name);
  unlink(path);
}

void abi_scratch_end(const abi_scratch *self, const char *const *names) {
  for (size_t i = 0; names[i]; i++) remove_file(self, names[i]);
  rmdir(self->folder);
}
