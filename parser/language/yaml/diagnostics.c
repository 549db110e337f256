/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages: collected, sorted, rendered with their line and a caret; and suggestions. */
#include "parser/language/yaml/document.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "parser/language/yaml/text.h"

enum { MESSAGE_MOST = 900 };

void strut_diagnostics_source(strut_diagnostics *diagnostics, const char *file, const char *text,
                              size_t length) {
  diagnostics->file = file;
  diagnostics->text = text;
  diagnostics->length = length;
}

/* Cuts an overlong message between two characters, and replaces control characters by blanks. */
static void tidy(char *message, int written) {
  if (written >= MESSAGE_MOST) {
    size_t end = MESSAGE_MOST - 4;
    while (end && ((unsigned char)message[end] & 0xC0) == 0x80) end--;
    memcpy(message + end, "...", 4);
  }
  for (char *c = message; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7F) *c = ' ';
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
  if (!copy || !strut_grow(&diagnostics->items, &diagnostics->capacity, diagnostics->count,
                           sizeof *diagnostics->items)) {
    diagnostics->unstored++;
    diagnostics->out_of_memory = true;
    return;
  }
  uint32_t order = (uint32_t)diagnostics->count;
  diagnostics->items[diagnostics->count++] =
      (strut_diagnostic){.place = place, .order = order, .message = copy};
}

void strut_diagnose_note(strut_diagnostics *diagnostics, size_t item, strut_place place,
                         const char *format, ...) {
  size_t k = 0;
  if (item >= diagnostics->count) return;
  strut_diagnostic *of = &diagnostics->items[item];
  while (k < STRUT_MESSAGE_NOTES && of->note[k]) k++;
  if (k == STRUT_MESSAGE_NOTES) return;
  va_list arguments;
  va_start(arguments, format);
  of->note[k] = compose(diagnostics, format, arguments);
  of->note_place[k] = place;
  va_end(arguments);
}

unsigned strut_diagnostics_use(strut_diagnostics *diagnostics, const char *file, const char *text,
                               size_t length) {
  if (!diagnostics->used)
    diagnostics->used =
        strut_arena_allocate(&diagnostics->arena, STRUT_USED_FILES_MOST, sizeof *diagnostics->used);
  if (!diagnostics->used || diagnostics->used_count == STRUT_USED_FILES_MOST) return 0;
  diagnostics->used[diagnostics->used_count] = (strut_used_file){file, text, length, NULL};
  return (unsigned)++diagnostics->used_count;
}

void strut_diagnostics_own(strut_diagnostics *diagnostics, unsigned number, char *text) {
  strut_used_file *used = &diagnostics->used[number - 1];
  const char *name = strut_arena_text(&diagnostics->arena, used->file, strlen(used->file));
  used->owned = text;
  used->file = name ? name : "<file>";
}

/* The order of two places: below, at or above 0, as strcmp. */
static int compare_places(strut_place a, strut_place b) {
  if (a.file != b.file) return a.file < b.file ? -1 : 1;
  if (a.line != b.line) return a.line < b.line ? -1 : 1;
  return a.column < b.column ? -1 : a.column > b.column;
}

static bool has_note(const strut_diagnostics *diagnostics, strut_place place, const char *message) {
  for (size_t i = 0; i < diagnostics->note_count; i++) {
    const strut_diagnostic *note = &diagnostics->notes[i];
    if (compare_places(note->place, place) == 0 && strcmp(note->message, message) == 0) return true;
  }
  return false;
}

void strut_note(strut_diagnostics *diagnostics, strut_place place, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const char *copy = compose(diagnostics, format, arguments);
  va_end(arguments);
  if (!copy || has_note(diagnostics, place, copy) ||
      !strut_grow(&diagnostics->notes, &diagnostics->note_capacity, diagnostics->note_count,
                  sizeof *diagnostics->notes))
    return;
  diagnostics->notes[diagnostics->note_count++] =
      (strut_diagnostic){.place = place, .message = copy};
}

/* Code points shown of a long line, and how many of them precede the place. */
enum { SHOWN_MOST = 100, SHOWN_BEFORE = 40 };

/* Width of a character in terminal cells. */
static int cells(uint32_t code) {
  static const struct range {
    uint32_t first, last;
    int cells;
  } ranges[] = {{0x300, 0x36F, 0},    {0x200B, 0x200F, 0},   {0x20D0, 0x20FF, 0},
                {0xFE00, 0xFE0F, 0},  {0x1100, 0x115F, 2},   {0x2E80, 0xA4CF, 2},
                {0xAC00, 0xD7A3, 2},  {0xF900, 0xFAFF, 2},   {0xFE30, 0xFE6F, 2},
                {0xFF00, 0xFF60, 2},  {0x1F300, 0x1F64F, 2}, {0x1F900, 0x1F9FF, 2},
                {0x20000, 0x3FFFD, 2}};
  if (strut_text_hidden(code)) return 1; /* shown as U+FFFD */
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

static window choose_window(strut_cursor *line, strut_place place) {
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

/* Appends the mark below character i of a line: the caret at `from`, tildes up to `to`, blanks before. */
static void append_mark(strut_buffer *out, uint32_t i, uint32_t from, uint32_t to, uint32_t code) {
  const char *mark = i >= from ? "~" : code == '\t' ? "\t" : " ";
  if (i >= to) return;
  if (i == from) strut_buffer_put(out, "^", 1);
  for (int cell = i == from ? 1 : 0; cell < cells(code); cell++) strut_buffer_put(out, mark, 1);
}

/* Appends the line in which the cursor stands and a caret line; the cursor moves to where the shown
   stretch begins, so that places in order cost one walk of a line. */
static void append_source_line(strut_buffer *out, strut_cursor *line, strut_place place) {
  window shown = choose_window(line, place);
  strut_buffer marks = {0};
  strut_cursor cursor = *line;
  uint32_t from = place.column ? place.column - 1 : 0, length = place.length ? place.length : 1;
  uint32_t to = length > shown.end || from > shown.end - length ? shown.end : from + length;
  if (!shown.points) return;
  strut_buffer_add(out, "%5u | %s", place.line, shown.first ? "..." : "");
  strut_buffer_add(&marks, "      | %s", shown.first ? "   " : "");
  for (uint32_t i = cursor.column - 1; i < shown.end; i++) {
    uint32_t code;
    const char *here = cursor.text + cursor.offset;
    size_t size = strut_text_decode(here, cursor.length - cursor.offset, &code);
    strut_cursor_step(&cursor);
    if (i < shown.first) continue;
    bool hidden = code == STRUT_BAD_CODE || strut_text_forbidden(code) || strut_text_hidden(code);
    strut_buffer_put(out, hidden ? "\xEF\xBF\xBD" : here, hidden ? 3 : size);
    append_mark(&marks, i, from, to, code);
  }
  if (from >= shown.end)
    strut_buffer_put(&marks, "^", 1); /* after the last character of the line */
  strut_buffer_add(out, "%s\n%s\n", shown.end < shown.points ? "..." : "",
                   marks.text ? marks.text : "");
  out->failed = out->failed || marks.failed;
  strut_release(marks.text);
}

static int compare(const void *first, const void *second) {
  const strut_diagnostic *a = first, *b = second;
  int order = compare_places(a->place, b->place);
  return order ? order : a->order < b->order ? -1 : a->order > b->order;
}

strut_used_file strut_diagnostics_text(const strut_diagnostics *diagnostics, strut_place place) {
  if (place.file && place.file <= diagnostics->used_count) return diagnostics->used[place.file - 1];
  return (strut_used_file){diagnostics->file ? diagnostics->file : "<text>", diagnostics->text,
                           diagnostics->length, NULL};
}

static strut_cursor cursor_in(strut_used_file in) {
  const strut_cursor nothing = {.text = "", .line = 1, .column = 1};
  return in.text ? strut_cursor_begin(in.text, in.length) : nothing;
}

/* `cursor` is in the text of the place, and not behind its line. */
static void render_line(strut_buffer *out, const char *file, const char *kind, strut_place place,
                        const char *message, strut_cursor *cursor) {
  if (place.line == 0) {
    strut_buffer_add(out, "%s: %s: %s\n", file, kind, message);
    return;
  }
  strut_buffer_add(out, "%s:%u:%u: %s: %s\n", file, place.line, place.column, kind, message);
  strut_cursor_to_line(cursor, place.line);
  if (cursor->line == place.line) append_source_line(out, cursor, place);
}

static void render_one(strut_buffer *out, const strut_diagnostics *diagnostics, const char *kind,
                       const strut_diagnostic *item, strut_cursor *cursor) {
  render_line(out, strut_diagnostics_text(diagnostics, item->place).file, kind, item->place,
              item->message, cursor);
  for (size_t k = 0; k < STRUT_MESSAGE_NOTES && item->note[k]; k++) {
    strut_used_file in = strut_diagnostics_text(diagnostics, item->note_place[k]);
    strut_cursor own = cursor_in(in);
    render_line(out, in.file, "note", item->note_place[k], item->note[k], &own);
  }
}

void strut_diagnostics_sort(strut_diagnostics *diagnostics) {
  if (diagnostics->count)
    qsort(diagnostics->items, diagnostics->count, sizeof *diagnostics->items, compare);
}

/* What was written, in the arena; NULL: memory is out. */
static const char *keep_text(strut_diagnostics *diagnostics, strut_buffer *out) {
  const char *text = out->text ? out->text : "";
  text = out->failed ? NULL : strut_arena_text(&diagnostics->arena, text, out->length);
  strut_release(out->text);
  return text;
}

const char *strut_diagnostics_render(strut_diagnostics *diagnostics, size_t most) {
  strut_buffer out = {0};
  strut_cursor cursor = {0};
  strut_diagnostics_sort(diagnostics);
  size_t shown = diagnostics->count < most ? diagnostics->count : most;
  for (size_t i = 0; i < shown; i++) {
    const strut_diagnostic *item = &diagnostics->items[i];
    if (!i || item->place.file != item[-1].place.file)
      cursor = cursor_in(strut_diagnostics_text(diagnostics, item->place));
    render_one(&out, diagnostics, "error", item, &cursor);
  }
  size_t left = diagnostics->count - shown + diagnostics->unstored;
  if (left) strut_buffer_add(&out, "... and %zu more\n", left);
  return keep_text(diagnostics, &out);
}

const char *strut_diagnostics_render_notes(strut_diagnostics *diagnostics) {
  strut_buffer out = {0};
  for (size_t i = 0; i < diagnostics->note_count; i++) {
    strut_cursor cursor =
        cursor_in(strut_diagnostics_text(diagnostics, diagnostics->notes[i].place));
    render_one(&out, diagnostics, "note", &diagnostics->notes[i], &cursor);
  }
  return keep_text(diagnostics, &out);
}

void strut_diagnostics_free(strut_diagnostics *diagnostics) {
  strut_release(diagnostics->items);
  strut_release(diagnostics->notes);
  for (size_t i = 0; i < diagnostics->used_count; i++) strut_release(diagnostics->used[i].owned);
  strut_arena_free(&diagnostics->arena);
  *diagnostics = (strut_diagnostics){0};
}

/* Limits of the search for suggestions: code points of a word, number of candidates. */
enum { WORD_MOST = 64, CANDIDATE_MOST = 10000 };

typedef struct word {
  uint32_t code[WORD_MOST];
  size_t length;
} word;

static bool decode(const char *text, word *result) {
  size_t left = strnlen(text, 4 * WORD_MOST + 1);
  result->length = 0;
  while (left) {
    if (result->length == WORD_MOST) return false;
    size_t size = strut_text_decode(text, left, &result->code[result->length++]);
    text += size;
    left -= size;
  }
  return result->length > 0;
}

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

/*
 * Insertions, deletions, substitutions and swaps of neighbours from a to b; most + 1 where there are
 * more than `most`. Only the band of the table that so few steps can reach is computed.
 */
static size_t distance(const word *self, const word *second, size_t most) {
  size_t rows[3][WORD_MOST + 2];
  size_t *before = rows[0], *above = rows[1], *row = rows[2], beyond = most + 1, last_nearest = 0;
  for (size_t j = 0; j <= second->length; j++) above[j] = least(j, beyond);
  for (size_t i = 1; i <= self->length; i++) {
    size_t first = i > most ? i - most : 1, last = least(second->length, i + most),
           nearest = beyond;
    row[first - 1] = first == 1 ? least(i, beyond) : beyond;
    for (size_t j = first; j <= last; j++) {
      size_t inserted = j < i + most ? above[j] + 1 : beyond;
      size_t substituted = above[j - 1] + (self->code[i - 1] != second->code[j - 1]);
      row[j] = least(least(inserted, row[j - 1] + 1), least(substituted, beyond));
      if (i > 1 && j > 1 && self->code[i - 1] == second->code[j - 2] &&
          self->code[i - 2] == second->code[j - 1])
        row[j] = least(row[j], before[j - 2] + 1);
      nearest = least(nearest, row[j]);
    }
    nearest = least(nearest, row[first - 1]);
    if (nearest > most && last_nearest > most) return beyond; /* a swap looks two rows back */
    last_nearest = nearest;
    size_t *oldest = before;
    before = above;
    above = row;
    row = oldest;
  }
  return above[second->length];
}

const char *strut_did_you_mean(const char *text, const char *(*next)(const void *context, size_t i),
                               const void *context) {
  word wanted, candidate;
  if (!decode(text, &wanted)) return NULL;
  size_t allowed = wanted.length / 3 > 1 ? wanted.length / 3 : 1;
  const char *best = NULL, *within = NULL, *name;
  size_t bytes = strlen(text);
  for (size_t i = 0; i < CANDIDATE_MOST && (name = next(context, i)) != NULL; i++) {
    if (!within && strncmp(name, text, bytes) == 0 && name[bytes] == '.') within = name;
    if (!decode(name, &candidate)) continue;
    size_t longer = wanted.length > candidate.length ? wanted.length : candidate.length;
    if (longer - least(wanted.length, candidate.length) > allowed) continue;
    size_t steps = distance(&wanted, &candidate, allowed);
    if (steps > allowed || steps >= longer) continue; /* nothing in common is no suggestion */
    best = name;
    if (steps == 0) return best;
    allowed = steps - 1; /* only a nearer one replaces it */
  }
  return best ? best : within;
}

strut_near strut_near_to(const char *text, const char *(*next)(const void *context, size_t i),
                         const void *context) {
  strut_near near = {""};
  const char *name = strut_did_you_mean(text, next, context);
  if (name) snprintf(near.text, sizeof near.text, "; did you mean '%.260s'?", name);
  return near;
}

const char *strut_row_name(const void *named_rows, size_t i) {
  const strut_named_rows *named = named_rows;
  return i < named->count ? *(const char *const *)((const char *)named->rows + i * named->size)
                          : NULL;
}

size_t strut_row_find(const strut_named_rows *named, const char *name) {
  size_t i = 0;
  while (i < named->count && strcmp(strut_row_name(named, i), name) != 0) i++;
  return i;
}
