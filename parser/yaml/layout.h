/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A YAML text in a canonical layout: indentation, blanks and blank lines change, nothing else.
 *
 * Block collections are indented by two, flow collections have one blank behind a comma and a colon and
 * none within their brackets; lines break where they did. Comments, quotes, the order of keys and the
 * characters of every value stay.
 */
#ifndef STRUT_PARSER_YAML_LAYOUT_H
#define STRUT_PARSER_YAML_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <yaml.h>

#include "engine/base/status.h"

/**
 * The text in its layout, a block of strut_allocate. It has been read again: its values and comments are
 * those of `text`, and its own layout is itself. STRUT_BAD_SCENE with the reason in `error` where that
 * cannot be rewritten safely, as with tags, explicit keys ("? key") or text that is not YAML; or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_layout_text(const char *text, size_t length, char **result,
                                         strut_error *error);

/* The state of layout.c. */

enum { STRUT_LAYOUT_DEPTH = 128 };

typedef enum strut_level_kind {
  STRUT_LEVEL_MAP,
  STRUT_LEVEL_LIST,
  STRUT_LEVEL_BARE_LIST /* below its key, in the same column */
} strut_level_kind;

/** A block collection that is open: its columns in the text, and in the layout. */
typedef struct strut_level {
  strut_level_kind kind;
  int column, indent;
} strut_level;

/** A token of libyaml in the text: bytes [begin, end). */
typedef struct strut_token {
  yaml_token_type_t type;
  yaml_scalar_style_t style;
  size_t begin, end;
  bool opens, closes; /* a bracket of a flow collection */
  bool in_key;
} strut_token;

typedef struct strut_layout {
  const char *text;
  size_t size, done; /* bytes of the text, and those behind the last token that was put */
  char *out;
  size_t length, capacity;
  int column; /* of the line that is open, in characters */
  strut_level level[STRUT_LAYOUT_DEPTH];
  size_t depth, peak;              /* open levels; and how many were open at the last token */
  int flow;                        /* brackets that are open */
  int content[STRUT_LAYOUT_DEPTH]; /* (flow) columns of lines within them */
  bool key;                        /* a key comes next */
  bool after_open, comment, failed;
} strut_layout;

#endif
