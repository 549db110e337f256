/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Results as data: for each value of a struct one row, beside the struct. JSON, CSV, tables, the trees of the
 * library and the page of results are made from the rows; nobody writes them by hand.
 */
#ifndef STRUT_ENGINE_SCENE_VALUE_ROWS_H
#define STRUT_ENGINE_SCENE_VALUE_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/channels.h"

typedef struct strut_value_rows strut_value_rows;

/** What a value is, and how a struct stores it where a row gives its place. */
typedef enum strut_value_kind {
  STRUT_VALUE_ABSENT,  /* not there: files have no such key */
  STRUT_VALUE_NUMBER,  /* double; null in files where it is not finite */
  STRUT_VALUE_INTEGER, /* int32_t */
  STRUT_VALUE_COUNT,   /* size_t or int64_t */
  STRUT_VALUE_FLAG,    /* bool */
  STRUT_VALUE_TEXT,    /* const char *; NULL is null */
  STRUT_VALUE_WORDS,   /* char[]; empty is null */
  STRUT_VALUE_NUMBERS, /* const double *, as many as `count` says */
  STRUT_VALUE_NAMES,   /* names of things */
  STRUT_VALUE_THINGS,  /* const double *, for each of an owner's things, of nodes two */
  STRUT_VALUE_PART,    /* a struct: rows of its own */
  STRUT_VALUE_LIST     /* const struct *, as many as `count` says, each with its rows */
} strut_value_kind;

/** A struct, and the one that it is part of. */
typedef struct strut_result_object {
  const void *at;
  const struct strut_result_object *outer; /* NULL: it is the whole result */
  const struct strut_scene *scene;
} strut_result_object;

/** A value that was asked for. */
typedef struct strut_value {
  strut_value_kind kind;
  double number;
  int64_t integer; /* also of a flag */
  const char *text;
  const void *items; /* numbers, structs of a list, or a part */
  size_t count;
  /** NAMES, and a LIST whose structs stand under names: of thing i, NULL: it is left out. */
  const char *(*name)(const strut_result_object *of, size_t i);
} strut_value;

typedef struct strut_value_row {
  const char *key, *unit, *what; /* in files; SI, "" for none; a sentence for readers */
  strut_value_kind kind;
  strut_channel_owner owner;  /* of things */
  size_t at, count_at, size;  /* offsets of the value, of its number; size of a struct of a list */
  strut_value_kind counts_as; /* how the number is stored */
  const strut_value_rows *rows;
  strut_value (*get)(const strut_result_object *of); /* instead of what the struct stores */
  bool (*there)(const strut_result_object *of);      /* else it is absent; NULL: it is there */
  bool (*has)(const strut_result_object *of, size_t component); /* of things; NULL: each has it */
  /* Of a CSV, and of a printed table, of nodes along x and y; NULL: not in it. Things: behind the name. */
  const char *column[2], *label[2];
} strut_value_row;

struct strut_value_rows {
  const strut_value_row *row;
  size_t count;
};

/* ---- rows ---- */

#define STRUT_VALUE_KIND(TYPE, MEMBER)                                                             \
  _Generic(((TYPE *)0)->MEMBER,                                                                    \
      double: STRUT_VALUE_NUMBER,                                                                  \
      int32_t: STRUT_VALUE_INTEGER,                                                                \
      size_t: STRUT_VALUE_COUNT,                                                                   \
      int64_t: STRUT_VALUE_COUNT,                                                                  \
      bool: STRUT_VALUE_FLAG,                                                                      \
      const char *: STRUT_VALUE_TEXT,                                                              \
      char *: STRUT_VALUE_WORDS)

/** A value that the struct stores. */
#define STRUT_VALUE(TYPE, MEMBER, KEY, UNIT, WHAT)                                                 \
  .key = KEY, .unit = UNIT, .what = WHAT, .kind = STRUT_VALUE_KIND(TYPE, MEMBER),                  \
  .at = offsetof(TYPE, MEMBER)
/** One that is computed from it. */
#define STRUT_VALUE_GET(GET, KEY, UNIT, WHAT) .key = KEY, .unit = UNIT, .what = WHAT, .get = GET
/** An array: a value for each thing of an owner. */
#define STRUT_VALUE_OF(TYPE, MEMBER, OWNER, KEY, UNIT, WHAT)                                       \
  .key = KEY, .unit = UNIT, .what = WHAT, .kind = STRUT_VALUE_THINGS, .owner = OWNER,              \
  .at = offsetof(TYPE, MEMBER)
/** Rows of a struct that stands at the beginning of this one, or is it: they are as rows of its own. */
#define STRUT_VALUE_SAME(ROWS)                                                                     \
  .kind = STRUT_VALUE_PART, .rows = &(const strut_value_rows)STRUT_VALUE_ROWS(ROWS)
/** A list of structs. */
#define STRUT_VALUE_STRUCTS(TYPE, MEMBER, COUNT, ROWS, KEY, WHAT)                                  \
  .key = KEY, .unit = "", .what = WHAT, .kind = STRUT_VALUE_LIST, .at = offsetof(TYPE, MEMBER),    \
  .count_at = offsetof(TYPE, COUNT), .counts_as = STRUT_VALUE_KIND(TYPE, COUNT),                   \
  .size = sizeof *((TYPE *)0)->MEMBER, .rows = ROWS
/** The rows of a table. */
#define STRUT_VALUE_ROWS(ROWS)                                                                     \
  { ROWS, sizeof(ROWS) / sizeof *(ROWS) }

static inline strut_value strut_value_number(double number) {
  return (strut_value){.kind = STRUT_VALUE_NUMBER, .number = number};
}
static inline strut_value strut_value_flag(bool flag) {
  return (strut_value){.kind = STRUT_VALUE_FLAG, .integer = flag};
}
static inline strut_value strut_value_text(const char *text) {
  return (strut_value){.kind = STRUT_VALUE_TEXT, .text = text};
}

#endif
