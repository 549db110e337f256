/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Results as data: for each value of a struct one row, beside the struct. JSON, CSV, tables, the trees of the
 * library and the page of results are made from the rows; nobody writes them by hand.
 *
 *     #define MODE(X) \
 *       X("frequency", "Hz", NUMBER(m->angular_frequency / STRUT_TAU), "undamped") \
 *       X("shape", "1", OF(NODE, m->shape), "the largest entry is 1")
 *     STRUT_VALUES(mode_values, MODE, const strut_mode *m = of->at)
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/channels.h"

typedef enum strut_value_kind {
  STRUT_VALUE_ABSENT,  /* not there: files have no such key */
  STRUT_VALUE_NUMBER,  /* null in files where it is not finite */
  STRUT_VALUE_COUNT,   /* a whole number */
  STRUT_VALUE_FLAG,    /* yes or no */
  STRUT_VALUE_TEXT,    /* NULL: null */
  STRUT_VALUE_WORDS,   /* a text that is written when it is asked for; empty: null */
  STRUT_VALUE_NUMBERS, /* an array of numbers, or of arrays of `columns` of them; NULL: null */
  STRUT_VALUE_INDICES, /* an array of int32_t, those below 0 left out */
  STRUT_VALUE_NAMES,   /* of things */
  STRUT_VALUE_THINGS,  /* a number for each of an owner's things, of nodes two */
  STRUT_VALUE_MAP,     /* a value of any kind under each name; an array of them without names */
  STRUT_VALUE_PART, /* a struct with rows of its own; without a key they stand among the others */
  STRUT_VALUE_LIST  /* structs with rows of their own; under names where it has some; NULL: null */
} strut_value_kind;

/** A struct, and the one that it is part of. */
typedef struct strut_result_object {
  const void *at;
  const struct strut_result_object *outer; /* NULL: it is the whole result */
  const struct strut_scene *scene;
  size_t index; /* of a struct of a list */
} strut_result_object;

/** Name of thing i of a value of that struct; NULL: it is left out; STRUT_NAME_NULL: null. */
typedef const char *strut_value_name(const strut_result_object *of, size_t i);
typedef struct strut_value strut_value;
/** Name and value of the scene's parameter i: a number, or a text. */
STRUT_API strut_value_name strut_name_of_parameter;
STRUT_API strut_value strut_value_of_parameter(const strut_result_object *of, size_t i);

#define STRUT_NAME_NULL ""

/** Room for words. */
enum { STRUT_VALUE_ROOM = 320 };

struct strut_value {
  strut_value_kind kind;
  int digits;    /* that numbers are rounded to; 0: all */
  double number; /* also of a count and a flag */
  int64_t integer;
  const char *text, *own_unit; /* also the name of a number's column, which the row leaves empty */
  const void *items;           /* numbers, structs of a list, or a part */
  size_t count, size, columns; /* of items; bytes from one to the next; numbers of a thing */
  strut_value_name *name;
  double (*each)(const strut_result_object *of, size_t k); /* of things: instead of items */
  bool (*has)(const strut_result_object *of,
              size_t k);     /* likewise, whether it is there; NULL: yes */
  strut_channel_owner owner; /* of things */
  void (*write)(const strut_result_object *of, char text[STRUT_VALUE_ROOM]); /* of words */
  strut_value (*value)(const strut_result_object *of, size_t i); /* of a map; absent: left out */
  /* Of a list whose structs belong to scenes of their own. */
  const struct strut_scene *(*scene)(const strut_result_object *of, size_t i);
};

typedef struct strut_value_rows strut_value_rows;

typedef struct strut_value_row {
  /* In files, NULL: only in a CSV or a printed table, or a map or part without one; SI, "" for none; a phrase for readers. */
  const char *key, *unit, *what;
  const strut_value_rows *rows; /* of a part, of a list */
  /* Of a CSV, and of a printed table, of nodes along x and y; NULL: not in it. Things: behind the name; before
     the columns of a part. */
  const char *column[2], *label[2];
} strut_value_row;

/** The value at a path of keys through parts, "steady.kind", and its row, NULL where the rows have no such. */
STRUT_API const strut_value_row *strut_value_at(const strut_value_rows *rows, const char *path,
                                                const strut_result_object *of, strut_value *value);

struct strut_value_rows {
  const strut_value_row *row;
  size_t count;
  void (*fill)(const strut_result_object *of, strut_value *value); /* (count) */
};

/* ---- making rows ---- */

enum { STRUT_MOST_VALUES = 64 };

static inline const void *strut_result_whole(const strut_result_object *of) {
  while (of->outer) of = of->outer;
  return of->at;
}

static inline strut_value strut_value_rounded(strut_value value, int digits) {
  value.digits = digits;
  return value;
}

/** Defines the rows NAME of a table of X(key, unit, value, what, ...); the rest declares what values refer to. */
#define STRUT_VALUES(NAME, TABLE, ...) STRUT_VALUES_OF(const, NAME, TABLE, __VA_ARGS__)
/** The same for one file. */
#define STRUT_VALUES_HERE(NAME, TABLE, ...) STRUT_VALUES_OF(static const, NAME, TABLE, __VA_ARGS__)
#define STRUT_VALUES_OF(LINKAGE, NAME, TABLE, ...)                                                 \
  static const strut_value_row NAME##_row[] = {TABLE(STRUT_VALUE_ROW)};                            \
  static void NAME##_fill(const strut_result_object *of, strut_value *value) {                     \
    __VA_ARGS__;                                                                                   \
    TABLE(STRUT_VALUE_FILL)                                                                        \
  }                                                                                                \
  LINKAGE strut_value_rows NAME = {NAME##_row, sizeof NAME##_row / sizeof *NAME##_row, NAME##_fill};
#define STRUT_VALUE_ROW(KEY, UNIT, VALUE, ...) {.key = KEY, .unit = UNIT, .what = __VA_ARGS__},
#define STRUT_VALUE_FILL(KEY, UNIT, VALUE, ...) *value++ = STRUT_VALUE_AS_##VALUE;

#define STRUT_VALUE_AS_NUMBER(NUMBER)                                                              \
  (strut_value) { .kind = STRUT_VALUE_NUMBER, .number = (NUMBER) }
/** In a column of its own name, where the row's is "". */
#define STRUT_VALUE_AS_CALLED(NAME, UNIT, NUMBER)                                                  \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_NUMBER, .number = (NUMBER), .text = (NAME), .own_unit = (UNIT)             \
  }
#define STRUT_VALUE_AS_COUNT(NUMBER)                                                               \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_COUNT, .integer = (int64_t)(NUMBER), .number = (double)(NUMBER)            \
  }
#define STRUT_VALUE_AS_FLAG(FLAG)                                                                  \
  (strut_value) { .kind = STRUT_VALUE_FLAG, .integer = (FLAG), .number = (FLAG) ? 1.0 : 0.0 }
#define STRUT_VALUE_AS_TEXT(TEXT)                                                                  \
  (strut_value) { .kind = STRUT_VALUE_TEXT, .text = (TEXT) }
#define STRUT_VALUE_AS_NUMBERS(ITEMS, COUNT) STRUT_VALUE_AS_OF_STRUCTS(ITEMS, COUNT, sizeof(double))
/** A number of each of several structs in a row, from that of the first on. */
#define STRUT_VALUE_AS_OF_STRUCTS(FIRST, COUNT, SIZE)                                              \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_NUMBERS, .items = (FIRST), .count = (size_t)(COUNT), .size = (SIZE)        \
  }
/** Arrays in an array: the first COLUMNS of each ITEMS[i]. */
#define STRUT_VALUE_AS_TABLE(ITEMS, COUNT, COLUMNS)                                                \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_NUMBERS, .items = (ITEMS), .count = (size_t)(COUNT),                       \
    .columns = (size_t)(COLUMNS), .size = sizeof *(ITEMS)                                          \
  }
#define STRUT_VALUE_AS_INDICES(ITEMS, COUNT)                                                       \
  (strut_value) { .kind = STRUT_VALUE_INDICES, .items = (ITEMS), .count = (size_t)(COUNT) }
#define STRUT_VALUE_AS_NAMES(NAME, COUNT)                                                          \
  (strut_value) { .kind = STRUT_VALUE_NAMES, .name = (NAME), .count = (size_t)(COUNT) }
#define STRUT_VALUE_AS_THINGS(OWNER, COLUMNS, ITEMS, EACH, HAS)                                    \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_THINGS, .items = (ITEMS), .each = (EACH), .has = (HAS),                    \
    .columns = (COLUMNS), .owner = STRUT_OWNER_##OWNER,                                            \
    .count = strut_owner_count(STRUT_OWNER_##OWNER, of->scene)                                     \
  }
/** A number for each thing, two for a node; from an array or by a function; only where HAS says so. */
#define STRUT_VALUE_AS_OF(OWNER, ITEMS)                                                            \
  STRUT_VALUE_AS_THINGS(OWNER, STRUT_OWNER_##OWNER == STRUT_OWNER_NODE ? 2 : 1, ITEMS, NULL, NULL)
#define STRUT_VALUE_AS_OF_WHERE(OWNER, ITEMS, HAS)                                                 \
  STRUT_VALUE_AS_THINGS(OWNER, STRUT_OWNER_##OWNER == STRUT_OWNER_NODE ? 2 : 1, ITEMS, NULL, HAS)
#define STRUT_VALUE_AS_OF_EACH(OWNER, EACH)                                                        \
  STRUT_VALUE_AS_THINGS(OWNER, STRUT_OWNER_##OWNER == STRUT_OWNER_NODE ? 2 : 1, NULL, EACH, NULL)
#define STRUT_VALUE_AS_PART(ITEM)                                                                  \
  (strut_value) { .kind = STRUT_VALUE_PART, .items = (ITEM) }
#define STRUT_VALUE_AS_SAME STRUT_VALUE_AS_PART(of->at)
#define STRUT_VALUE_AS_LIST(ITEMS, COUNT) STRUT_VALUE_AS_NAMED(ITEMS, COUNT, NULL)
#define STRUT_VALUE_AS_NAMED(ITEMS, COUNT, NAME)                                                   \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_LIST, .items = (ITEMS), .count = (size_t)(COUNT), .size = sizeof *(ITEMS), \
    .name = (NAME)                                                                                 \
  }
/** Only those that HAS says are there. */
#define STRUT_VALUE_AS_LIST_WHERE(ITEMS, COUNT, HAS)                                               \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_LIST, .items = (ITEMS), .count = (size_t)(COUNT), .size = sizeof *(ITEMS), \
    .has = (HAS)                                                                                   \
  }
/** The same struct with each index. */
#define STRUT_VALUE_AS_TIMES(COUNT)                                                                \
  (strut_value) { .kind = STRUT_VALUE_LIST, .items = of->at, .count = (size_t)(COUNT) }
#define STRUT_VALUE_AS_ARRAY(COUNT, VALUE) STRUT_VALUE_AS_MAP(COUNT, NULL, VALUE)
#define STRUT_VALUE_AS_MAP(COUNT, NAME, VALUE)                                                     \
  (strut_value) {                                                                                  \
    .kind = STRUT_VALUE_MAP, .count = (size_t)(COUNT), .name = (NAME), .value = (VALUE)            \
  }
#define STRUT_VALUE_AS_PARAMETERS                                                                  \
  STRUT_VALUE_AS_MAP(of->scene ? of->scene->parameter_count : 0, strut_name_of_parameter,          \
                     strut_value_of_parameter)
#define STRUT_VALUE_AS_WORDS(WRITE)                                                                \
  (strut_value) { .kind = STRUT_VALUE_WORDS, .write = (WRITE) }
#define STRUT_VALUE_AS_ROUNDED(DIGITS, VALUE) strut_value_rounded(STRUT_VALUE_AS_##VALUE, DIGITS)
/** Of a function that returns the value. */
#define STRUT_VALUE_AS_BY(CALL) (CALL)
#define STRUT_VALUE_AS_IF(THERE, VALUE)                                                            \
  (THERE) ? STRUT_VALUE_AS_##VALUE : (strut_value) { 0 }
/** A number, where it is above 0. */
#define STRUT_VALUE_AS_POSITIVE(VALUE) STRUT_VALUE_AS_IF((VALUE) > 0.0, NUMBER(VALUE))
/** null where it is below 0. */
#define STRUT_VALUE_AS_INDEX(INDEX) STRUT_VALUE_AS_KNOWN((INDEX) >= 0, COUNT(INDEX))
/** null where it is not known. */
#define STRUT_VALUE_AS_KNOWN(KNOWN, VALUE)                                                         \
  (KNOWN) ? STRUT_VALUE_AS_##VALUE : (strut_value) { .kind = STRUT_VALUE_TEXT }
