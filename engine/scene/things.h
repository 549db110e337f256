/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What follows from the tables of things (things_table.h): arrays and names of a scene by kind, the fields
 * of an object, the ranges of its numbers, and the numbers on which what is at rest depends.
 */
#ifndef STRUT_ENGINE_SCENE_THINGS_H
#define STRUT_ENGINE_SCENE_THINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"
#include "engine/scene/things_table.h"

typedef enum strut_thing {
#define STRUT_THING_ROW(KIND, ...) STRUT_THING_##KIND,
  STRUT_THINGS(STRUT_THING_ROW)
#undef STRUT_THING_ROW
      STRUT_THING_COUNT
} strut_thing;

/** A kind of things. */
typedef struct strut_thing_row {
  const char *word, *things;       /* "node", "nodes" */
  size_t size, name, array, count; /* of an object; where its name is; where the scene has them */
  const void *usual;               /* an object with the defaults */
} strut_thing_row;

STRUT_API const strut_thing_row *strut_thing_at(strut_thing kind);
STRUT_API size_t strut_thing_count(const strut_scene *scene, strut_thing kind);
/** Thing i of its kind. */
STRUT_API const void *strut_thing_object(const strut_scene *scene, strut_thing kind, size_t i);
/** Its name, NULL behind the last one; "" or NULL where it has none. */
STRUT_API const char *strut_thing_name(const strut_scene *scene, strut_thing kind, size_t i);
/** Index of the thing of that name, -1: none. */
STRUT_API int32_t strut_thing_find(const strut_scene *scene, strut_thing kind, const char *name);
/** Index of a coordinate: "node.x" is 2 node, "node.y" 2 node + 1; -1: none. */
STRUT_API int32_t strut_coordinate_find(const strut_scene *scene, const char *name);
/** The configuration of that name, NULL: none. */
STRUT_API const strut_configuration *strut_configuration_named(const strut_scene *scene,
                                                               const char *name);

/** The kind of things that have columns of that owner; STRUT_THING_COUNT: they are of no kind of thing. */
STRUT_API strut_thing strut_thing_of_column(strut_column_owner owner);

/** The object of the section `ground`: its line, and the contact that every node starts from. */
typedef struct strut_ground_section {
  strut_ground ground;
  strut_contact contact;
} strut_ground_section;

/* ---- fields ---- */

enum { STRUT_MOST_THINGS = 10000000 }; /* entries of all copies of parts */

/** Which numbers are allowed. */
typedef enum strut_key_range {
  STRUT_RANGE_ANY,
  STRUT_RANGE_NOT_NEGATIVE,
  STRUT_RANGE_ABOVE_ZERO,
  STRUT_RANGE_WHOLE /* a whole number from least to most */
} strut_key_range;

typedef struct strut_key_limits {
  strut_key_range range;
  double least, most; /* of WHOLE */
} strut_key_limits;

#define STRUT_LIMITS_ANY                                                                           \
  { STRUT_RANGE_ANY, 0.0, 0.0 }
#define STRUT_LIMITS_NOT_NEGATIVE                                                                  \
  { STRUT_RANGE_NOT_NEGATIVE, 0.0, 0.0 }
#define STRUT_LIMITS_ABOVE_ZERO                                                                    \
  { STRUT_RANGE_ABOVE_ZERO, 0.0, 0.0 }
#define STRUT_LIMITS_WHOLE(least, most)                                                            \
  { STRUT_RANGE_WHOLE, least, most }

typedef enum strut_key_need {
  STRUT_OPTIONAL, /* written only where it differs from the default */
  STRUT_WRITTEN,  /* may be left out, but is always written */
  STRUT_REQUIRED
} strut_key_need;

/** How a value is kept, see things_table.h. */
typedef enum strut_field_role {
  STRUT_FIELD_BY_HAND,
  STRUT_FIELD_NONE,
  STRUT_FIELD_VALUE,
  STRUT_FIELD_REFERENCE,
  STRUT_FIELD_LIST,
  STRUT_FIELD_NESTED,
  STRUT_FIELD_SECTION,
  STRUT_FIELD_THINGS
} strut_field_role;

/** The C type of a value, or of the elements of a list. */
typedef enum strut_field_type {
  STRUT_FIELD_OBJECT, /* of NESTED */
  STRUT_FIELD_DOUBLE,
  STRUT_FIELD_INT32,
  STRUT_FIELD_UINT32, /* enumerations and bits too */
  STRUT_FIELD_INT64,
  STRUT_FIELD_UINT64,
  STRUT_FIELD_BOOL,
  STRUT_FIELD_DOUBLE_PAIR,
  STRUT_FIELD_BOOL_PAIR,
  STRUT_FIELD_TEXT /* const char *; of a WORD, the word itself */
} strut_field_type;

/** Where an object keeps a value. */
typedef struct strut_field {
  strut_field_role role;
  strut_field_type type;
  size_t offset, size, object_size;
  size_t number;    /* of a LIST: where the object keeps how many (size_t) */
  strut_thing kind; /* of references */
  int below;        /* of NESTED, SECTION and THINGS: the strut_section of the keys; else 0 */
  bool of_runs;     /* what is at rest does not depend on it */
  bool chosen;      /* one of several keys: it sets the tag, of so many bytes, to the value */
  size_t tag, tag_size;
  uint32_t tag_value;
} strut_field;

/* A field of a type that is not listed does not compile. */
#define STRUT_TYPE_OF(lvalue)                                                                      \
  _Generic((lvalue), double: STRUT_FIELD_DOUBLE, int32_t: STRUT_FIELD_INT32, \
           uint32_t: STRUT_FIELD_UINT32, int64_t: STRUT_FIELD_INT64, \
           uint64_t: STRUT_FIELD_UINT64, bool: STRUT_FIELD_BOOL, \
           double *: STRUT_FIELD_DOUBLE_PAIR, bool *: STRUT_FIELD_BOOL_PAIR, \
           const char *: STRUT_FIELD_TEXT)
#define STRUT_ELEMENT_OF(lvalue)                                                                   \
  _Generic((lvalue), double *: STRUT_FIELD_DOUBLE, const double *: STRUT_FIELD_DOUBLE, \
           int32_t *: STRUT_FIELD_INT32, double(*)[2]: STRUT_FIELD_DOUBLE_PAIR)
#define STRUT_MEMBER(object, member) (((object *)0)->member)
#define STRUT_PLACE_OF(object, member)                                                             \
  .offset = offsetof(object, member), .size = sizeof STRUT_MEMBER(object, member),                 \
  .object_size = sizeof(object)

/* Initialisers of a strut_field by the column `field`; STRUT_BELOW(SECTION) is defined where they are used. */
#define STRUT_FIELD_OF_BY_HAND .role = STRUT_FIELD_BY_HAND
#define STRUT_FIELD_OF_NONE .role = STRUT_FIELD_NONE
#define STRUT_FIELD_OF_FIELD(object, member)                                                       \
  .role = STRUT_FIELD_VALUE, .type = STRUT_TYPE_OF(STRUT_MEMBER(object, member)),                  \
  STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_NUMBERS(object, member) STRUT_FIELD_OF_FIELD(object, member)
#define STRUT_FIELD_OF_REFERENCE(object, member, KIND)                                             \
  .role = STRUT_FIELD_REFERENCE, .type = STRUT_FIELD_INT32, .kind = STRUT_THING_##KIND,            \
  STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_LIST(object, member, count)                                                 \
  .role = STRUT_FIELD_LIST, .type = STRUT_ELEMENT_OF(STRUT_MEMBER(object, member)),                \
  .number = offsetof(object, count), .kind = STRUT_THING_COUNT, STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_REFERENCES(object, member, count, KIND)                                     \
  .role = STRUT_FIELD_LIST, .type = STRUT_ELEMENT_OF(STRUT_MEMBER(object, member)),                \
  .number = offsetof(object, count), .kind = STRUT_THING_##KIND, STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_NESTED(object, member, SECTION)                                             \
  .role = STRUT_FIELD_NESTED, STRUT_PLACE_OF(object, member), .below = STRUT_BELOW(SECTION)
#define STRUT_FIELD_OF_SECTION(SECTION) .role = STRUT_FIELD_SECTION, .below = STRUT_BELOW(SECTION)
#define STRUT_FIELD_OF_THINGS(SECTION) .role = STRUT_FIELD_THINGS, .below = STRUT_BELOW(SECTION)
#define STRUT_FIELD_OF_OF_RUNS(field) .of_runs = true, STRUT_FIELD_OF_##field
#define STRUT_FIELD_OF_CHOICE(object, member, value, field)                                        \
  .chosen = true, .tag = offsetof(object, member),                                                 \
  .tag_size = sizeof STRUT_MEMBER(object, member), .tag_value = value, STRUT_FIELD_OF_##field

/** A row of the table, as far as the engine needs it. */
typedef struct strut_field_row {
  const char *name;
  strut_key_limits limits;
  strut_key_need need;
  strut_field field;
} strut_field_row;

/** Sections of objects other than those of the kinds, X(NAME, ). */
/* clang-format off */
#define STRUT_FURTHER_SECTIONS(X) \
  X(SCENE, ) X(GAS, ) X(LAW, ) X(RAYLEIGH, ) X(CIRCLE, ) X(FRICTION, ) X(SINE, ) X(HALF_SINE, ) X(SQUARE, ) X(RAMP, ) \
  X(MAXWELL, ) X(RUBBING, ) X(SETTLE, ) X(EQUILIBRIA, ) X(SOLVER, ) X(RUN, ) X(MEASURE, ) X(OUTPUT, )
/* clang-format on */

typedef enum strut_thing_section {
#define STRUT_SECTION_ROW(NAME, ...) STRUT_FIELDS_##NAME,
  STRUT_THINGS(STRUT_SECTION_ROW) STRUT_FURTHER_SECTIONS(STRUT_SECTION_ROW)
#undef STRUT_SECTION_ROW
      STRUT_THING_SECTION_COUNT
} strut_thing_section;

/** The rows of a section, *count of them. */
STRUT_API const strut_field_row *strut_fields_of(strut_thing_section section, size_t *count);

/**
 * Hands over, in a fixed order, all numbers of a scene and its experiment on which its equilibria depend:
 * two setups with the same numbers have the same equilibria, bit by bit.
 */
typedef void strut_number_sink(void *context, double number);
STRUT_API void strut_setup_at_rest(const strut_setup *setup, strut_number_sink *sink,
                                   void *context);

/* ---- scenes beside others ---- */

/** One difference between two scenes, as texts. */
typedef struct strut_difference {
  const char *where;    /* such as "members.m8.stiffness", values in SI units */
  const char *was, *is; /* in the first and the second scene; NULL: absent */
} strut_difference;

/**
 * Removes sensors, signals, internal states and Maxwell branches, which have relaxed at rest, from a copy of
 * a scene that has no driven loads any more. Members are copied into the arena where that changes them.
 * False: out of memory.
 */
STRUT_API bool strut_scene_remove_feedback(strut_scene *scene, strut_arena *arena);

#endif
