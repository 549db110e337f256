/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Growing YAML text: what the parts of the scene writer share. Internal to parser/. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/text.h"
#include "engine/scene/experiment.h"
#include "parser/language/keys/keys.h"

typedef struct strut_writer {
  const strut_scene *scene;
  const strut_experiment *experiment;
  strut_buffer out;
  int32_t period_signal; /* a signal that has no name but needs one; else -1 */
  strut_setup usual;     /* the defaults */
  int32_t ground;        /* the one that is being written */
} strut_writer;

void strut_put(strut_writer *writer, const char *text);
/** Appends some bytes of a text. */
void strut_put_part(strut_writer *writer, const char *text, size_t length);
/** Appends a number as the shortest text that reads back to the same bits. */
void strut_put_number(strut_writer *writer, double value);
/** Appends "n1.x". */
void strut_put_coordinate(strut_writer *writer, int32_t at);
/** Appends "[x, y]". */
void strut_put_pair(strut_writer *writer, const double pair[2]);
/** Appends text in double quotes, with escapes. */
void strut_put_quoted(strut_writer *writer, const char *text);
/** Appends a name, in quotes if YAML would misread it. */
void strut_put_name(strut_writer *writer, const char *name);
/** A mapping under construction: the separators before the next key and before the following ones. */
typedef struct strut_mapping {
  const char *separator, *next;
} strut_mapping;

/** Within braces: `{key: value, key: value}`. */
#define STRUT_MAPPING_INLINE ((strut_mapping){"", ", "})
/** One line per key, each begun by a line break. */
#define STRUT_MAPPING_LINES(indent) ((strut_mapping){"\n" indent, "\n" indent})

/** Appends the separator and "key: ", with the key's name in the language. */
void strut_put_key_name(strut_writer *writer, strut_mapping *mapping, int key);

/** Writes a key that rows do not write, if the object has a value for it. */
typedef void strut_put_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                               const void *object);
/**
 * Writes the keys of a section in the order of the table: values of `object` that are always written or
 * differ from those of `usual`, things and lists that there are, of several keys the chosen one, and the
 * keys that rows do not write by `by_hand` (NULL: they are left out).
 */
void strut_put_fields(strut_writer *writer, strut_mapping *mapping, strut_section section,
                      const void *object, const void *usual, strut_put_by_hand *by_hand);
/** The same within braces. */
void strut_put_mapping(strut_writer *writer, strut_section section, const void *object,
                       const void *usual, strut_put_by_hand *by_hand);
/** True where some field of the section differs between two objects. */
bool strut_fields_differ(strut_section section, const void *object, const void *usual);

/**
 * Writes all things of a kind, a line each, with strut_put_fields. usual: what they are compared with, NULL:
 * the defaults of the kind.
 */
void strut_put_things(strut_writer *writer, strut_thing kind, strut_section section,
                      const void *usual);
/** "NAME: {...}" and a line break. */
void strut_put_line(strut_writer *writer, const char *name, strut_section section,
                    const void *object, const void *usual, strut_put_by_hand *by_hand);
/** write_scene.c: a law as a mapping. */
void strut_put_law(strut_writer *writer, const strut_law *law);

/** The name of a signal in the file; NULL if it is written where it is used. */
const char *strut_signal_name(const strut_writer *writer, int32_t index);
/** A signal's name, or the signal itself where it has none. */
void strut_put_signal_reference(strut_writer *writer, int32_t index);
/** signals, actuators, loads, run, solver, output. */
void strut_put_experiment(strut_writer *writer);
/** a program as an expression in quotes. */
void strut_put_program(strut_writer *writer, const strut_instruction *program, size_t length);
/** `quantities` of the measurement, if there are any. */
void strut_put_quantities(strut_writer *writer, strut_mapping *mapping);
/** configurations, the search for equilibria, the initial state. */
void strut_put_shapes(strut_writer *writer);

/* What the table of keys says, for readers and for editors. */

/** The page as Markdown in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_keys_page(void);

/** A section in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_keys_text(strut_section section);
/** The same for every key of that name, each below the name of its section. */
STRUT_API char *strut_keys_named(const char *name);

/* ---- parts of both, and of the schema ---- */

/** The text above the table of a section's keys, as Markdown. */
const char *strut_section_introduction(strut_section section);
/** Appends what a key's value is, as Markdown: "number [N/m], not negative". */
void strut_put_key_type(strut_writer *writer, const strut_key *key);
/** Is a default a sentence about a value, rather than a value? */
bool strut_default_is_described(const strut_key *key);
/** Appends Markdown as plain text: `[text](link)` becomes its text; backticks are kept where `ticks`. */
void strut_put_without_links(strut_writer *writer, const char *markdown, bool ticks);
