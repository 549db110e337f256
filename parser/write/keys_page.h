/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the table of keys says, for readers and for editors.
 */
#ifndef STRUT_PARSER_WRITE_KEYS_PAGE_H
#define STRUT_PARSER_WRITE_KEYS_PAGE_H

#include <stdbool.h>

#include "engine/base/export.h"
#include "parser/language/keys.h"
#include "parser/write/writer.h"

/** The page as Markdown in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_keys_page(void);

/** A section in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_keys_text(strut_section section);

/* ---- parts of both, and of the schema ---- */

/** The text above the table of a section's keys, as Markdown. */
const char *strut_section_introduction(strut_section section);
/** Appends what a key's value is, as Markdown: "number [N/m], not negative". */
void strut_put_key_type(strut_writer *writer, const strut_key *key);
/** Is a default a sentence about a value, rather than a value? */
bool strut_default_is_described(const strut_key *key);
/**
 * Appends Markdown as plain text: `[text](link)` becomes its text; backticks are kept where `ticks`.
 */
void strut_put_without_links(strut_writer *writer, const char *markdown, bool ticks);

/* ---- the schema for editors ---- */

/** The schema of a scene, or of a study, in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_schema_write(bool study);

/* ---- JSON that grows ---- */

typedef struct strut_json_writer {
  strut_writer text;
  int depth;
  bool inside; /* the object or list that is open has something in it */
  bool keyed;  /* a key waits for its value */
} strut_json_writer;

/** Opens an object '{' or a list '['; closes it. */
void strut_json_open(strut_json_writer *json, char bracket);
void strut_json_close(strut_json_writer *json, char bracket);
/** The key of the value that follows, within an object. */
void strut_json_key(strut_json_writer *json, const char *key);
/** A value: a text, or what is JSON already (a number, true, false, null). */
void strut_json_put_text(strut_json_writer *json, const char *text);
void strut_json_put_raw(strut_json_writer *json, const char *raw);
/** The text with a line break at its end, a block of strut_allocate; NULL: memory was out. */
char *strut_json_finish(strut_json_writer *json);

#endif
