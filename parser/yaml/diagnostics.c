/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/yaml/diagnostics.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/yaml/source_line.h"
#include "parser/yaml/text.h"

enum { MESSAGE_MOST = 900 };

void strut_diagnostics_source(strut_diagnostics *diagnostics, const char *file, const char *text,
                              size_t length) {
  diagnostics->file = file;
  diagnostics->text = text;
  diagnostics->length = length;
}

/* Cuts where a character begins and makes controls harmless: a message is one line. */
static void tidy(char *message, int written) {
  if (written >= MESSAGE_MOST) {
    size_t end = MESSAGE_MOST - 4;
    while (end && ((unsigned char)message[end] & 0xC0) == 0x80) end--;
    memcpy(message + end, "...", 4);
  }
  for (char *c = message; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7F) *c = ' ';
}

static bool make_room(strut_diagnostic **list, size_t count, size_t *room) {
  if (count < *room) return true;
  size_t capacity = *room ? 2 * *room : 16;
  void *items = strut_reallocate(*list, capacity, sizeof **list);
  if (!items) return false;
  *list = items;
  *room = capacity;
  return true;
}

/* The message in the arena, or NULL. */
static const char *compose(strut_diagnostics *diagnostics, const char *format, va_list arguments) {
  char message[MESSAGE_MOST] = "";
  strut_c_locale locale = strut_c_locale_enter();
  int written = vsnprintf(message, sizeof message, format, arguments);
  strut_c_locale_leave(locale);
  tidy(message, written);
  return strut_arena_text(&diagnostics->arena, message, strlen(message));
}

void strut_diagnose(strut_diagnostics *diagnostics, strut_place place, const char *format, ...) {
  if (strut_diagnostics_full(diagnostics)) {
    diagnostics->unstored++;
    return;
  }
  va_list arguments;
  va_start(arguments, format);
  const char *copy = compose(diagnostics, format, arguments);
  va_end(arguments);
  if (!copy || !make_room(&diagnostics->items, diagnostics->count, &diagnostics->capacity)) {
    diagnostics->unstored++;
    diagnostics->out_of_memory = true;
    return;
  }
  uint32_t order = (uint32_t)diagnostics->count;
  diagnostics->items[diagnostics->count++] =
      (strut_diagnostic){.place = place, .order = order, .message = copy};
}

static bool has_note(const strut_diagnostics *diagnostics, strut_place place, const char *message) {
  for (size_t i = 0; i < diagnostics->note_count; i++) {
    const strut_diagnostic *note = &diagnostics->notes[i];
    if (note->place.line == place.line && note->place.column == place.column &&
        strcmp(note->message, message) == 0)
      return true;
  }
  return false;
}

void strut_note(strut_diagnostics *diagnostics, strut_place place, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const char *copy = compose(diagnostics, format, arguments);
  va_end(arguments);
  if (!copy || has_note(diagnostics, place, copy) ||
      !make_room(&diagnostics->notes, diagnostics->note_count, &diagnostics->note_capacity))
    return;
  diagnostics->notes[diagnostics->note_count++] =
      (strut_diagnostic){.place = place, .message = copy};
}

static int compare(const void *a, const void *b) {
  const strut_diagnostic *x = a, *y = b;
  if (x->place.line != y->place.line) return x->place.line < y->place.line ? -1 : 1;
  if (x->place.column != y->place.column) return x->place.column < y->place.column ? -1 : 1;
  return x->order < y->order ? -1 : x->order > y->order;
}

static void render_one(strut_text_builder *out, const strut_diagnostics *diagnostics,
                       const char *kind, const strut_diagnostic *item, strut_cursor *cursor) {
  const char *file = diagnostics->file ? diagnostics->file : "<text>";
  if (item->place.line == 0) {
    strut_text_append(out, "%s: %s: %s\n", file, kind, item->message);
    return;
  }
  strut_text_append(out, "%s:%u:%u: %s: %s\n", file, item->place.line, item->place.column, kind,
                    item->message);
  strut_cursor_to_line(cursor, item->place.line);
  if (cursor->line == item->place.line) strut_source_line_show(out, cursor, item->place);
}

const char *strut_diagnostics_render(strut_diagnostics *diagnostics, size_t most) {
  strut_text_builder out = {0};
  strut_cursor cursor = {.text = "", .line = 1, .column = 1};
  if (diagnostics->text) cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  if (diagnostics->count)
    qsort(diagnostics->items, diagnostics->count, sizeof *diagnostics->items, compare);
  size_t shown = diagnostics->count < most ? diagnostics->count : most;
  for (size_t i = 0; i < shown; i++)
    render_one(&out, diagnostics, "error", &diagnostics->items[i], &cursor);
  size_t left = diagnostics->count - shown + diagnostics->unstored;
  if (left) strut_text_append(&out, "... and %zu more\n", left);
  const char *text =
      out.failed ? NULL
                 : strut_arena_text(&diagnostics->arena, out.text ? out.text : "", out.length);
  strut_release(out.text);
  return text;
}

const char *strut_diagnostics_render_notes(strut_diagnostics *diagnostics) {
  strut_text_builder out = {0};
  for (size_t i = 0; i < diagnostics->note_count; i++) {
    strut_cursor cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
    render_one(&out, diagnostics, "note", &diagnostics->notes[i], &cursor);
  }
  const char *text =
      out.failed ? NULL
                 : strut_arena_text(&diagnostics->arena, out.text ? out.text : "", out.length);
  strut_release(out.text);
  return text;
}

void strut_diagnostics_free(strut_diagnostics *diagnostics) {
  strut_release(diagnostics->items);
  strut_release(diagnostics->notes);
  strut_arena_free(&diagnostics->arena);
  *diagnostics = (strut_diagnostics){0};
}
