/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Located messages about a text: collected, sorted, shown with the line and a caret.
 */
#ifndef STRUT_PARSER_YAML_DIAGNOSTICS_H
#define STRUT_PARSER_YAML_DIAGNOSTICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"

/** A stretch of one line: 1-based, columns count code points. line 0: the file as a whole. */
typedef struct strut_place {
  uint32_t line, column, length;
} strut_place;

typedef struct strut_diagnostic {
  strut_place place;
  uint32_t order;      /* of arrival */
  const char *message; /* one sentence without a full stop */
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
  strut_diagnostic *notes; /* what is no error; not among the items */
  size_t unstored;    /* messages beyond STRUT_DIAGNOSTICS_MOST, or lost because memory was out */
  bool out_of_memory; /* a message was lost */
  strut_arena arena;  /* owns the messages */
} strut_diagnostics;

/** True where a further message would only be counted: its text need not be made. */
static inline bool strut_diagnostics_full(const strut_diagnostics *diagnostics) {
  return diagnostics->count >= STRUT_DIAGNOSTICS_MOST;
}

/** Begins: remembers the file's name and its bytes (neither copied). */
STRUT_API void strut_diagnostics_source(strut_diagnostics *diagnostics, const char *file,
                                        const char *text, size_t length);
/**
 * Adds one message at a place. Control characters in it become spaces; beyond 900 bytes it is cut.
 */
STRUT_API void strut_diagnose(strut_diagnostics *diagnostics, strut_place place, const char *format,
                              ...) __attribute__((format(printf, 3, 4)));
/** Adds a note, which is no error, unless the place has it already. Lost if memory is out. */
STRUT_API void strut_note(strut_diagnostics *diagnostics, strut_place place, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));
/** All notes, in order, as strut_diagnostics_render shows messages. NULL: memory is out. */
STRUT_API const char *strut_diagnostics_render_notes(strut_diagnostics *diagnostics);
/**
 * All messages, sorted by place, as printed text (file:line:column: error: ..., the line, a caret);
 * the text belongs to the diagnostics' arena. At most `most` are shown, then "... and N more".
 * NULL: memory is out.
 */
STRUT_API const char *strut_diagnostics_render(strut_diagnostics *diagnostics, size_t most);
STRUT_API void strut_diagnostics_free(strut_diagnostics *diagnostics);

/**
 * The candidate nearest to `word` by Damerau-Levenshtein distance (at most max(1, length / 3), and
 * something must agree), or NULL. The first of equally near ones wins. Candidates come one by one:
 * next(context, i) returns the i-th or NULL after the last; only the first 10000 are looked at.
 */
STRUT_API const char *strut_did_you_mean(const char *word,
                                         const char *(*next)(const void *context, size_t i),
                                         const void *context);

#endif
