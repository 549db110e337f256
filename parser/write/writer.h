/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Growing YAML text: what the parts of the scene writer share. Internal to parser/.
 */
#ifndef STRUT_PARSER_WRITE_WRITER_H
#define STRUT_PARSER_WRITE_WRITER_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/scene/experiment.h"

typedef struct strut_writer {
  const strut_scene *scene;
  const strut_experiment *experiment;
  char *text; /* strut_allocate; NUL-terminated */
  size_t length, capacity;
  bool failed;           /* memory was out; all later writing is ignored */
  int32_t period_signal; /* a signal that has no name but needs one; else -1 */
} strut_writer;

/** Appends text as it is. */
void strut_put(strut_writer *writer, const char *text);
/** Appends some bytes of a text. */
void strut_put_part(strut_writer *writer, const char *text, size_t length);
/** Appends a number as the shortest text that reads back to the same bits. */
void strut_put_number(strut_writer *writer, double value);
/** Appends "[x, y]". */
void strut_put_pair(strut_writer *writer, const double pair[2]);
/** Appends text in double quotes, with escapes. */
void strut_put_quoted(strut_writer *writer, const char *text);
/** Appends a thing's name, in quotes where YAML would take it for something else. */
void strut_put_name(strut_writer *writer, const char *name);
/** Appends ", key: " or "key: " at the beginning of a mapping {...}. */
void strut_put_key(strut_writer *writer, bool *first, const char *key);
/** Appends ", key: value" unless value is 0 (bits included). */
void strut_put_value(strut_writer *writer, bool *first, const char *key, double value);

/** write_drives.c: signals, actuators, loads, run, solver, output. */
void strut_put_drives(strut_writer *writer);
void strut_put_experiment(strut_writer *writer);
/** write_quantities.c: `quantities` of the measurement, where there are any. */
void strut_put_quantities(strut_writer *writer, bool *first);
/** write_shapes.c: configurations, the search for equilibria, the initial state. */
void strut_put_shapes(strut_writer *writer);

#endif
