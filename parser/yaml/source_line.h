/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A line of the source with a caret below it, cut to fit where it is long.
 */
#ifndef STRUT_PARSER_YAML_SOURCE_LINE_H
#define STRUT_PARSER_YAML_SOURCE_LINE_H

#include <stdbool.h>
#include <stddef.h>

#include "parser/yaml/diagnostics.h"
#include "parser/yaml/text.h"

/** A text that grows. Zero-initialise; release `text` with strut_release. */
typedef struct strut_text_builder {
  char *text; /* NUL-terminated once anything was appended */
  size_t length, capacity;
  bool failed; /* memory was out: the text is not whole */
} strut_text_builder;

/** Appends at most some hundred bytes more than the arguments hold. */
void strut_text_append(strut_text_builder *out, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/**
 * Appends the line in which the cursor stands, at or before the place, and the caret line below it.
 * The cursor moves on to where the shown stretch begins: places in order cost one walk of a line.
 */
void strut_source_line_show(strut_text_builder *out, strut_cursor *cursor, strut_place place);

#endif
