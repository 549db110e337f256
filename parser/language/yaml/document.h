/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A YAML text as a tree in which every value knows its place, and located messages about it: collected, sorted, shown
 * with the line and a caret.
 *
 * libyaml's events become nodes in one arena. Nothing is interpreted here: scalars stay text. Limits (depth, bytes,
 * nodes, anchors, expansion of aliases) are enforced while reading, so that a hostile text is refused at once. An alias
 * is a copy of the anchored node that shares its children: branches may be shared but there is no cycle, and no way down
 * has more than 64 levels.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"

/* ---- messages ---- */

/**
 * A stretch of one line, counted from 1; columns are code points. Line 0: the file as a whole. `file`: 0
 * is the text under examination, others are those that it uses.
 */
typedef struct strut_place {
  uint32_t line, column, length : 24, file : 8;
} strut_place;

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
/** The text that a place is in; its file is "<text>" where it has no name. */
STRUT_API strut_used_file strut_diagnostics_text(const strut_diagnostics *diagnostics,
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
/** The first row of that name, or their number. */
STRUT_API size_t strut_row_find(const strut_named_rows *named, const char *name);

/* ---- trees ---- */

typedef enum strut_tree_kind { STRUT_TREE_SCALAR, STRUT_TREE_LIST, STRUT_TREE_MAP } strut_tree_kind;

/** Most bytes of a text. */
#define STRUT_TEXT_MOST ((size_t)256 << 20)

/** One value: 40 bytes. A map's children alternate key, value; keys are scalars. */
typedef struct strut_tree {
  strut_place place;   /* of its first character (an alias: of the alias), its length */
  uint32_t count : 27; /* list: items; map: pairs */
  uint32_t kind : 2;   /* a strut_tree_kind */
  bool quoted : 1;     /* scalar: written in quotes or as a block */
  bool placed : 1;     /* it belongs to a copy of a part, see parser/language/read/reuse/copies.h */
  const char *text;    /* scalar: NUL-terminated, no NUL inside, "" for nothing */
  struct strut_tree *first, *next; /* first child; next sibling */
} strut_tree;

/** Mask that fits a number into `count`, which the limits on values keep below it. */
#define STRUT_TREE_COUNT_MASK 0x7FFFFFFu

/** The tree and the arena that owns it. Zero-initialise; release with strut_document_free. */
typedef struct strut_document {
  strut_arena arena;
  strut_tree *root; /* NULL when the text could not be read to its end */
} strut_document;

/**
 * Reads the text that `diagnostics` holds (see strut_diagnostics_source). Problems are added to
 * diagnostics; returns STRUT_OK, STRUT_BAD_SCENE or STRUT_NO_MEMORY. With STRUT_BAD_SCENE there is a
 * root where the rest of the text still makes sense (a duplicate key or '<<' is left out, a tag is
 * ignored), so that a caller can go on to find all errors at once.
 */
STRUT_API strut_status strut_document_read(strut_document *document,
                                           strut_diagnostics *diagnostics);
STRUT_API void strut_document_free(strut_document *document);

/** Value of `key` in a map, or NULL; key_node (may be NULL) receives the key itself. */
STRUT_API strut_tree *strut_tree_find(const strut_tree *map, const char *key,
                                      strut_tree **key_node);

/** True for a plain empty scalar, ~ and null. */
STRUT_API bool strut_is_null(const strut_tree *value);

/* ---- trees made of others, in an arena; NULL or false: memory is out ---- */

/** An entry, or a value, that belongs to a copy of a part (parser/language/read/reuse/copies.h); NULL: to the scene. */
typedef struct strut_placed_tree {
  strut_tree tree; /* `placed` is set */
  struct strut_copy *scope;
} strut_placed_tree;

/** A copy of one node, by itself, that shares its children. */
STRUT_API strut_tree *strut_tree_copy(strut_arena *arena, const strut_tree *node);
/** A plain text that stands where `like` does; NULL where the text is NULL, too. */
STRUT_API strut_tree *strut_tree_scalar(strut_arena *arena, const strut_tree *like,
                                        const char *text);

/** A mapping that grows. */
typedef struct strut_tree_builder {
  strut_tree *map, **end;
} strut_tree_builder;

/** A mapping without entries, where `like` stands. Appending to one that could not be made fails. */
STRUT_API strut_tree_builder strut_tree_begin(strut_arena *arena, const strut_tree *like);
/** Appends an entry, whose nodes are not shared; fails where one of them is NULL. */
STRUT_API bool strut_tree_append(strut_tree_builder *builder, strut_tree *key, strut_tree *value);
/** Appends copies of a key and of a value. */
STRUT_API bool strut_tree_share(strut_tree_builder *builder, strut_arena *arena,
                                const strut_tree *key, const strut_tree *value);
/** Takes a key out of a mapping whose entries are not shared. */
STRUT_API void strut_tree_drop(strut_tree *map, const char *key);
/** Do two values say the same, wherever they stand? */
STRUT_API bool strut_tree_equal(const strut_tree *first, const strut_tree *second);
