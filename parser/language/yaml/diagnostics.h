/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Located messages about a text: collected, sorted, shown with the line and a caret. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"

/**
 * A stretch of one line, counted from 1; columns are code points. Line 0: the file as a whole. `file`: 0
 * is the text under examination, others are those that it uses.
 */
typedef struct strut_place {
  uint32_t line, column, length : 24, file : 8;
} strut_place;

/** The order of two places: below, at or above 0, as strcmp. */
STRUT_API int strut_place_compare(strut_place a, strut_place b);

/** Most files that a text may use. */
enum { STRUT_USED_FILES_MOST = 255, STRUT_PLACE_LENGTH_MOST = 0xFFFFFF };

/** A place in the text under examination. */
static inline strut_place strut_place_at(uint32_t line, uint32_t column, uint32_t length) {
  return (strut_place){
      .line = line,
      .column = column,
      .length = (length < STRUT_PLACE_LENGTH_MOST ? length : 0xFFFFFFu) & 0xFFFFFFu,
      .file = 0};
}

/** A file that the text under examination uses. */
typedef struct strut_used_file {
  const char *file, *text;
  size_t length;
  char *owned; /* NULL, or the block that holds the text */
} strut_used_file;

/** Most notes of one message. */
enum { STRUT_MESSAGE_NOTES = 2 };

typedef struct strut_diagnostic {
  strut_place place;
  uint32_t order;      /* of arrival */
  const char *message; /* one sentence without a full stop */
  strut_place note_place[STRUT_MESSAGE_NOTES];
  const char *note[STRUT_MESSAGE_NOTES]; /* what else there is to say, elsewhere; NULL: nothing */
} strut_diagnostic;

/** Most messages that are stored; later ones are only counted. */
enum { STRUT_DIAGNOSTICS_MOST = 1000 };

/** The text under examination and what was found in it. Zero-initialise. */
typedef struct strut_diagnostics {
  const char *file; /* name to show; not owned */
  const char *text; /* the bytes; not owned, must outlive this */
  size_t length;
  size_t count, capacity;
  strut_diagnostic *items;
  size_t note_count, note_capacity;
  strut_diagnostic *notes; /* notes, which are not errors; not among the items */
  size_t unstored;    /* messages beyond STRUT_DIAGNOSTICS_MOST, or lost because memory was out */
  bool out_of_memory; /* a message was lost */
  strut_arena arena;  /* owns the messages */
  size_t used_count;
  strut_used_file *used; /* (used_count) file i + 1 of places; their texts are not owned */
} strut_diagnostics;

/** True once further messages are only counted, so that their texts need not be formatted. */
static inline bool strut_diagnostics_full(const strut_diagnostics *diagnostics) {
  return diagnostics->count >= STRUT_DIAGNOSTICS_MOST;
}

/** Sets the file's name and its bytes; neither is copied. */
STRUT_API void strut_diagnostics_source(strut_diagnostics *diagnostics, const char *file,
                                        const char *text, size_t length);
/** Adds one message at a place. Control characters in it become spaces; beyond 900 bytes it is cut. */
STRUT_API void strut_diagnose(strut_diagnostics *diagnostics, strut_place place, const char *format,
                              ...) __attribute__((format(printf, 3, 4)));
/**
 * Adds a note to the message that was stored as number `item` (count - 1 is the latest), which shows it
 * with its line. More than STRUT_MESSAGE_NOTES are left out.
 */
STRUT_API void strut_diagnose_note(strut_diagnostics *diagnostics, size_t item, strut_place place,
                                   const char *format, ...) __attribute__((format(printf, 4, 5)));
/** Enters a used file, whose texts must outlive this; its number for places, or 0: there are too many. */
STRUT_API unsigned strut_diagnostics_use(strut_diagnostics *diagnostics, const char *file,
                                         const char *text, size_t length);
/** Lets the used file of that number own its text, a block of strut_allocate, and copies its name. */
STRUT_API void strut_diagnostics_own(strut_diagnostics *diagnostics, unsigned number, char *text);
/** Adds a note (not an error) unless the place already has it. Lost if memory is out. */
STRUT_API void strut_note(strut_diagnostics *diagnostics, strut_place place, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));
/** All notes, in order, as strut_diagnostics_render shows messages. NULL: memory is out. */
STRUT_API const char *strut_diagnostics_render_notes(strut_diagnostics *diagnostics);
/**
 * All messages, sorted by place, as printed text (file:line:column: error: ..., the line, a caret); the text belongs to
 * the diagnostics' arena. At most `most` are shown, then "... and N more". NULL: memory is out.
 */
STRUT_API const char *strut_diagnostics_render(strut_diagnostics *diagnostics, size_t most);
/** Sorts the messages by place. */
STRUT_API void strut_diagnostics_sort(strut_diagnostics *diagnostics);
/** The name of the file that a place is in. */
STRUT_API const char *strut_diagnostics_file(const strut_diagnostics *diagnostics,
                                             strut_place place);
STRUT_API void strut_diagnostics_free(strut_diagnostics *diagnostics);

/**
 * The candidate nearest to `word` by Damerau-Levenshtein distance (at most max(1, length / 3), and
 * something must agree), else one that continues it by a dot, or NULL. The first of several wins.
 * next(context, i) returns the i-th or NULL after the last; only the first 10000 are compared.
 */
STRUT_API const char *strut_did_you_mean(const char *word,
                                         const char *(*next)(const void *context, size_t i),
                                         const void *context);

/** "; did you mean 'x'?" of such a candidate, or "". */
typedef struct strut_near {
  char text[300];
} strut_near;
STRUT_API strut_near strut_near_to(const char *word,
                                   const char *(*next)(const void *context, size_t i),
                                   const void *context);
/** Rows of an array that begin with their names: candidates by strut_row_name. */
typedef struct strut_named_rows {
  const void *rows;
  size_t count, size;
} strut_named_rows;
#define STRUT_NAMED(rows, count) (&(const strut_named_rows){rows, count, sizeof *(rows)})
STRUT_API const char *strut_row_name(const void *named_rows, size_t i);
