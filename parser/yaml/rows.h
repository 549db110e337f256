/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Long runs of plain rows, which libyaml need not read.
 *
 * A *row* is one line that holds one entry of a block mapping in its plainest form, such as
 *
 *     m1: {group: along, nodes: [a0, a1]}
 *     a0: [10 mm, -2]
 *
 * A *run* is a number of rows with the same indentation, one directly after the other. libyaml reads the
 * first of them, and so tells whether the text is what it seems to be; the others are read here. What is
 * not known for certain at the first glance is no row: quotes, anchors, tags, empty values, a key twice,
 * characters beyond ASCII.
 */
#ifndef STRUT_PARSER_YAML_ROWS_H
#define STRUT_PARSER_YAML_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parser/yaml/document.h"

/** Most tokens of one row (its values, lists, mappings and their keys), levels of brackets, and bytes. */
enum { STRUT_ROW_TOKENS = 96, STRUT_ROW_LEVELS = 4, STRUT_ROW_BYTES = 4096 };

typedef struct strut_row_token {
  uint32_t at, length; /* bytes of the line; of a list or mapping with its brackets */
  uint16_t count;      /* list: items; map: pairs; they follow, each with all that is in it */
  uint8_t kind;        /* a strut_tree_kind */
} strut_row_token;

typedef struct strut_row {
  size_t length; /* bytes, with the end of the line */
  int count;     /* tokens: the key, its value, what is in it */
  int levels;    /* of brackets */
  int maps;      /* tokens that are mappings */
  strut_row_token token[STRUT_ROW_TOKENS];
} strut_row;

/** Reads the row that text[0..left) begins with. False: it is none. */
bool strut_row_read(const char *text, size_t left, strut_row *row);

/** Keeps a copy of a scalar's text; NULL: memory is out. */
typedef const char *strut_row_keep(void *context, const char *text, size_t length);

/**
 * Makes nodes[i] of each of the first `count` tokens, which are 1 (the key) or all. `text` begins with the
 * row, which is on that line of the file. False: memory is out.
 */
bool strut_row_build(const strut_row *row, int count, const char *text, uint32_t line,
                     strut_tree *nodes, strut_row_keep *keep, void *context);

/** Is a row so plain that its value may be deferred? Then no mapping is within its value. */
static inline bool strut_row_is_deferrable(const strut_row *row) {
  return row->maps == (row->token[1].kind == STRUT_TREE_MAP);
}

/** Defers the value of a row, which `text` begins with: `value` is its node, without children. */
void strut_row_defer(const strut_row *row, const char *text, strut_tree *value);

/** The nodes of one row and their texts. */
typedef struct strut_row_nodes {
  strut_tree node[STRUT_ROW_TOKENS];
  char text[STRUT_ROW_BYTES + STRUT_ROW_TOKENS];
  size_t used; /* bytes of `text` */
} strut_row_nodes;

/**
 * The value itself unless it is deferred; otherwise the same value with its children, in `nodes`: they are
 * good until `nodes` serves again.
 */
const strut_tree *strut_row_expand(const strut_tree *value, strut_row_nodes *nodes);

/** The rows of a run behind its first one. */
typedef struct strut_row_run {
  size_t begin, end;    /* bytes */
  uint32_t line, lines; /* number of the first line, counted from 0; how many */
  uint32_t indent;
} strut_row_run;

/** Zero-initialise; release with strut_row_runs_free. */
typedef struct strut_row_runs {
  size_t count, capacity;
  strut_row_run *run;
} strut_row_runs;

/** Finds runs of at least `least` rows (2 or more). False: memory is out. */
bool strut_row_runs_find(const char *text, size_t length, uint32_t least, strut_row_runs *runs);
void strut_row_runs_free(strut_row_runs *runs);

#endif
