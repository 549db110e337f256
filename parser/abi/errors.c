/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors: what a call says of its failure, and messages that it tells meanwhile. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "parser/abi/handles.h"

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
  strutlib_error *e = strut_arena_allocate(&arena, 1, sizeof *e);
  if (!e) strut_arena_free(&arena);
  if (!e) return NULL;
  e->arena = arena;
  e->status = status;
  return e;
}

static int finish(strutlib_error **error, strutlib_error *e) {
  if (e->message && e->report) {
    *error = e;
    return e->status;
  }
  int status = e->status;
  strutlib_error_free(e);
  abi_no_memory(error);
  return status;
}

static int fail_with_text(strutlib_error **error, int status, const char *text) {
  if (!error) return status;
  if (status == STRUTLIB_NO_MEMORY && strcmp(text, "out of memory") == 0)
    return abi_no_memory(error);
  strutlib_error *e = create(status);
  if (!e) return abi_no_memory(error), status;
  e->message = strut_arena_text(&e->arena, text, strlen(text));
  e->report = strut_arena_format(&e->arena, "error: %s\n", text);
  return finish(error, e);
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

bool abi_lacks_pairs(strutlib_error **error, size_t count, const char *const *names,
                     const char *const *values) {
  if (count && (abi_lacks(error, names, "names") || abi_lacks(error, values, "values")))
    return true;
  for (size_t i = 0; i < count; i++)
    if (abi_lacks(error, names[i], "names[]") || abi_lacks(error, values[i], "values[]"))
      return true;
  return false;
}

/* ---- located ones ---- */

/* The line of a place, without its end, in the arena. */
static const char *line_of(const char *text, size_t length, size_t line, strut_arena *arena) {
  const char *at = text, *end = text + length;
  if (!text || line == 0) return "";
  for (; line > 1; line--) {
    const char *next = memchr(at, '\n', (size_t)(end - at));
    if (!next) return "";
    at = next + 1;
  }
  const char *stop = memchr(at, '\n', (size_t)(end - at));
  if (!stop) stop = end;
  if (stop > at && stop[-1] == '\r') stop--;
  return strut_arena_text(arena, at, (size_t)(stop - at));
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

typedef struct key_search {
  uint32_t line, column;
  char path[512];
  char best[512];
} key_search;

static bool is_behind(strut_place place, const key_search *s) {
  return place.line > s->line || (place.line == s->line && place.column > s->column);
}

/* Walks in the text's order, and keeps the path of the last value that begins at or before the place. */
static void walk(const strut_tree *node, size_t used, key_search *s, int depth) {
  const strut_tree *child = node->first;
  bool map = node->kind == STRUT_TREE_MAP;
  if (node->kind == STRUT_TREE_SCALAR || depth > 64) return;
  for (uint32_t i = 0; i < node->count && child; i++) {
    const strut_tree *key = map ? child : NULL, *value = map ? child->next : child;
    if (!value || is_behind(key ? key->place : value->place, s)) return;
    int more =
        key ? snprintf(s->path + used, sizeof s->path - used, "%s%s", used ? "." : "", key->text)
            : snprintf(s->path + used, sizeof s->path - used, "%s%u", used ? "." : "", (unsigned)i);
    if (more < 0 || used + (size_t)more >= sizeof s->path) return;
    memcpy(s->best, s->path, used + (size_t)more + 1);
    walk(value, used + (size_t)more, s, depth + 1);
    s->path[used] = '\0';
    child = value->next;
  }
}

static const char *key_of(const strut_document *document, strut_place place, strut_arena *arena) {
  key_search s = {.line = place.line, .column = place.column};
  if (!document->root || place.file != 0 || place.line == 0) return "";
  walk(document->root, 0, &s, 0);
  return strut_arena_text(arena, s.best, strlen(s.best));
}

static bool fill_item(const strut_diagnostics *found, const strut_document *document,
                      const strut_diagnostic *from, strut_arena *arena, located *to) {
  const strut_used_file *used = from->place.file > 0 ? &found->used[from->place.file - 1] : NULL;
  const char *file = used ? used->file : found->file ? found->file : "";
  to->text = strut_arena_text(arena, from->message, strlen(from->message));
  to->file = strut_arena_text(arena, file, strlen(file));
  to->source = line_of(used ? used->text : found->text, used ? used->length : found->length,
                       from->place.line, arena);
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

int abi_fail_located(strutlib_error **error, strut_status status, strut_diagnostics *found) {
  if (!error) return (int)status;
  const char *report = strut_diagnostics_render(found, MOST_MESSAGES); /* sorts them */
  strutlib_error *e = report ? create((int)status) : NULL;
  if (!e) return abi_no_memory(error), (int)status;
  e->report = strut_arena_text(&e->arena, report, strlen(report));
  e->items = strut_arena_allocate(&e->arena, found->count, sizeof *e->items);
  strut_document document = reread(found);
  bool good = e->items && e->report;
  for (; good && e->count < found->count; e->count++)
    good = fill_item(found, &document, &found->items[e->count], &e->arena, &e->items[e->count]);
  strut_document_free(&document);
  if (good && e->count > 0 && e->items[0].line > 0)
    e->message = strut_arena_format(&e->arena, "%s:%zu:%zu: %s", e->items[0].file, e->items[0].line,
                                    e->items[0].column, e->items[0].text);
  else if (good && e->count > 0)
    e->message = e->items[0].text;
  else if (good)
    e->message = strut_status_text(status);
  return finish(error, e);
}

/* ---- what the header shows ---- */

int strutlib_error_status(const strutlib_error *error) {
  return error ? error->status : STRUTLIB_OK;
}

const char *strutlib_error_message(const strutlib_error *error) {
  return error ? error->message : NULL;
}

const char *strutlib_error_report(const strutlib_error *error) {
  return error ? error->report : NULL;
}

size_t strutlib_error_count(const strutlib_error *error) { return error ? error->count : 0; }

static const located *item_of(const strutlib_error *error, size_t i) {
  return i < strutlib_error_count(error) ? &error->items[i] : NULL;
}

const char *strutlib_error_text(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->text : NULL;
}

const char *strutlib_error_file(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->file : NULL;
}

size_t strutlib_error_line(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->line : 0;
}

size_t strutlib_error_column(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->column : 0;
}

size_t strutlib_error_length(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->length : 0;
}

const char *strutlib_error_source(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->source : NULL;
}

const char *strutlib_error_hint(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->hint : NULL;
}

const char *strutlib_error_key(const strutlib_error *error, size_t i) {
  const located *item = item_of(error, i);
  return item ? item->key : NULL;
}

/* ---- messages ---- */

void abi_add_warning(abi_messages *m, const char *text) {
  if (m->count == m->capacity) {
    size_t wider = m->capacity ? 2 * m->capacity : 8;
    const char **list = strut_reallocate((void *)m->warnings, wider, sizeof *list);
    if (!list) m->out_of_memory = true;
    if (!list) return;
    m->warnings = list;
    m->capacity = wider;
  }
  const char *kept = strut_arena_text(&m->arena, text, strlen(text));
  if (!kept) m->out_of_memory = true;
  if (kept) m->warnings[m->count++] = kept;
}

static void hear(void *context, strut_message_kind kind, const char *command, const char *text) {
  abi_messages *m = context;
  (void)command;
  switch (kind) {
    case STRUT_MESSAGE_USAGE: strut_fail(&m->error, STRUT_USAGE, "%s", text); break;
    case STRUT_MESSAGE_ERROR: strut_fail(&m->error, STRUT_USAGE, "%s", text); break;
    case STRUT_MESSAGE_WARNING:
    case STRUT_MESSAGE_NOTE:
    case STRUT_MESSAGE_REMARK: abi_add_warning(m, text); break;
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
