/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The state of layout.c.
 */
#ifndef STRUT_PARSER_YAML_LAYOUT_PARTS_H
#define STRUT_PARSER_YAML_LAYOUT_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <yaml.h>

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
