/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/yaml/source_line.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"

/* Code points of a long line that are shown, and how many of them stand before the place. */
enum { SHOWN_MOST = 100, SHOWN_BEFORE = 40 };

static bool make_room(strut_text_builder *out, size_t more) {
  if (out->failed) return false;
  if (out->length + more < out->capacity) return true;
  size_t capacity = 2 * (out->length + more) + 256;
  char *text = strut_reallocate(out->text, capacity, 1);
  if (!text) {
    out->failed = true;
    return false;
  }
  out->text = text;
  out->capacity = capacity;
  return true;
}

void strut_text_append(strut_text_builder *out, const char *format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, arguments);
  va_end(arguments);
  if (length < 0) out->failed = true;
  if (make_room(out, (size_t)length + 1)) {
    vsnprintf(out->text + out->length, (size_t)length + 1, format, again);
    out->length += (size_t)length;
  }
  va_end(again);
}

static void append_bytes(strut_text_builder *out, const char *bytes, size_t size) {
  if (!make_room(out, size + 1)) return;
  memcpy(out->text + out->length, bytes, size);
  out->length += size;
  out->text[out->length] = '\0';
}

/* Cells of a terminal that a character takes. */
static int cells(uint32_t code) {
  static const struct range {
    uint32_t first, last;
    int cells;
  } ranges[] = {{0x300, 0x36F, 0},    {0x200B, 0x200F, 0},   {0x20D0, 0x20FF, 0},
                {0xFE00, 0xFE0F, 0},  {0x1100, 0x115F, 2},   {0x2E80, 0xA4CF, 2},
                {0xAC00, 0xD7A3, 2},  {0xF900, 0xFAFF, 2},   {0xFE30, 0xFE6F, 2},
                {0xFF00, 0xFF60, 2},  {0x1F300, 0x1F64F, 2}, {0x1F900, 0x1F9FF, 2},
                {0x20000, 0x3FFFD, 2}};
  for (size_t i = 0; code >= 0x300 && i < sizeof ranges / sizeof ranges[0]; i++)
    if (code >= ranges[i].first && code <= ranges[i].last) return ranges[i].cells;
  return 1;
}

/* The stretch of a line that is shown: code points [first, end) of `points`. */
typedef struct window {
  uint32_t points, first, end;
} window;

static bool at_line_end(const strut_cursor *cursor) {
  return cursor->offset >= cursor->length ||
         strut_text_break(cursor->text + cursor->offset, cursor->length - cursor->offset) > 0;
}

static window choose(strut_cursor *line, strut_place place) {
  while (place.column > SHOWN_MOST && line->column <= place.column - SHOWN_BEFORE &&
         !at_line_end(line))
    strut_cursor_step(line);
  strut_cursor cursor = *line;
  window shown = {.points = line->column - 1, .first = line->column - 1};
  while (!at_line_end(&cursor) && shown.points <= place.column + SHOWN_MOST) {
    strut_cursor_step(&cursor);
    shown.points++;
  }
  shown.end = shown.points;
  if (!shown.first && shown.points > SHOWN_MOST && place.column > SHOWN_BEFORE)
    shown.first = place.column - SHOWN_BEFORE;
  if (shown.end - shown.first > SHOWN_MOST) shown.end = shown.first + SHOWN_MOST;
  return shown;
}

/* Calls for each shown character: the source itself, or what stands below it up to the place. */
static void append_source(strut_text_builder *out, strut_cursor cursor, window shown) {
  for (uint32_t i = cursor.column - 1; i < shown.end; i++) {
    uint32_t code;
    const char *here = cursor.text + cursor.offset;
    size_t size = strut_text_decode(here, cursor.length - cursor.offset, &code);
    strut_cursor_step(&cursor);
    if (i < shown.first) continue;
    if (code == STRUT_BAD_CODE || strut_text_forbidden(code))
      append_bytes(out, "\xEF\xBF\xBD", 3);
    else
      append_bytes(out, here, size);
  }
}

static void append_caret(strut_text_builder *out, strut_cursor cursor, window shown,
                         strut_place place) {
  uint32_t from = place.column ? place.column - 1 : 0, length = place.length ? place.length : 1;
  uint32_t to = length > shown.end || from > shown.end - length ? shown.end : from + length;
  for (uint32_t i = cursor.column - 1; i < shown.end && i < to; i++) {
    uint32_t code;
    strut_text_decode(cursor.text + cursor.offset, cursor.length - cursor.offset, &code);
    strut_cursor_step(&cursor);
    if (i < shown.first) continue;
    const char *mark = i > from ? "~" : i == from ? "^" : code == '\t' ? "\t" : " ";
    if (i == from) append_bytes(out, "^", 1);
    for (int cell = i == from ? 1 : 0; cell < cells(code); cell++)
      append_bytes(out, i == from ? "~" : mark, 1);
  }
  if (from >= shown.end) append_bytes(out, "^", 1); /* behind the line's last character */
}

void strut_source_line_show(strut_text_builder *out, strut_cursor *cursor, strut_place place) {
  window shown = choose(cursor, place);
  if (!shown.points) return;
  const char *before = shown.first ? "..." : "", *after = shown.end < shown.points ? "..." : "";
  strut_text_append(out, "%5u | %s", place.line, before);
  append_source(out, *cursor, shown);
  strut_text_append(out, "%s\n      | %s", after, shown.first ? "   " : "");
  append_caret(out, *cursor, shown, place);
  strut_text_append(out, "\n");
}
