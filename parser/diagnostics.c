/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/diagnostics.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/source_line.h"
#include "parser/text.h"

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

static bool make_room(strut_diagnostics *diagnostics) {
  if (diagnostics->count < diagnostics->capacity) return true;
  size_t capacity = diagnostics->capacity ? 2 * diagnostics->capacity : 16;
  void *items = strut_reallocate(diagnostics->items, capacity, sizeof *diagnostics->items);
  if (!items) return false;
  diagnostics->items = items;
  diagnostics->capacity = capacity;
  return true;
}

void strut_diagnose(strut_diagnostics *diagnostics, strut_place place, const char *format, ...) {
  if (diagnostics->count >= STRUT_DIAGNOSTICS_MOST) {
    diagnostics->unstored++;
    return;
  }
  char message[MESSAGE_MOST] = "";
  va_list arguments;
  va_start(arguments, format);
  strut_c_locale locale = strut_c_locale_enter();
  int written = vsnprintf(message, sizeof message, format, arguments);
  strut_c_locale_leave(locale);
  va_end(arguments);
  tidy(message, written);
  char *copy = strut_arena_text(&diagnostics->arena, message, strlen(message));
  if (!copy || !make_room(diagnostics)) {
    diagnostics->unstored++;
    diagnostics->out_of_memory = true;
    return;
  }
  uint32_t order = (uint32_t)diagnostics->count;
  diagnostics->items[diagnostics->count++] =
      (strut_diagnostic){.place = place, .order = order, .message = copy};
}

static int compare(const void *a, const void *b) {
  const strut_diagnostic *x = a, *y = b;
  if (x->place.line != y->place.line) return x->place.line < y->place.line ? -1 : 1;
  if (x->place.column != y->place.column) return x->place.column < y->place.column ? -1 : 1;
  return x->order < y->order ? -1 : x->order > y->order;
}

static void render_one(strut_text_builder *out, const strut_diagnostics *diagnostics,
                       const strut_diagnostic *item, strut_cursor *cursor) {
  const char *file = diagnostics->file ? diagnostics->file : "<text>";
  if (item->place.line == 0) {
    strut_text_append(out, "%s: error: %s\n", file, item->message);
    return;
  }
  strut_text_append(out, "%s:%u:%u: error: %s\n", file, item->place.line, item->place.column,
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
  for (size_t i = 0; i < shown; i++) render_one(&out, diagnostics, &diagnostics->items[i], &cursor);
  size_t left = diagnostics->count - shown + diagnostics->unstored;
  if (left) strut_text_append(&out, "... and %zu more\n", left);
  const char *text =
      out.failed ? NULL
                 : strut_arena_text(&diagnostics->arena, out.text ? out.text : "", out.length);
  strut_release(out.text);
  return text;
}

void strut_diagnostics_free(strut_diagnostics *diagnostics) {
  strut_release(diagnostics->items);
  strut_arena_free(&diagnostics->arena);
  *diagnostics = (strut_diagnostics){0};
}
