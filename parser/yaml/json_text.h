/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A JSON text as the tree of a YAML text, by RFC 8259 and nothing more: every value knows its place.
 *
 * Numbers stay text. Whether a scalar was a string says `quoted`; the others are numbers, true, false
 * and null. Refused are keys that appear twice, bytes that are not UTF-8, the character U+0000 and more
 * than STRUT_JSON_DEEPEST values within each other.
 */
#ifndef STRUT_PARSER_YAML_JSON_TEXT_H
#define STRUT_PARSER_YAML_JSON_TEXT_H

#include "parser/yaml/document.h"

enum { STRUT_JSON_DEEPEST = 32 };

/** Why a text is no JSON. */
typedef struct strut_json_error {
  uint32_t column; /* from 1, in code points */
  char message[200];
} strut_json_error;

/**
 * Reads text[0..length), which is on line `line` of something, into the arena. STRUT_BAD_SCENE with the
 * reason in `error`, STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_json_text_read(const char *text, size_t length, uint32_t line,
                                            strut_arena *arena, strut_tree **root,
                                            strut_json_error *error);

#endif
