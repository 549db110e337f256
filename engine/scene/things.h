/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What follows from the tables of things (things_table.h): arrays and names of a scene by kind, the fields
 * of an object, the ranges of its numbers, and the numbers on which what is at rest depends.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/things_table.h"

typedef enum strut_thing {
#define STRUT_THING_ROW(KIND, ...) STRUT_THING_##KIND,
  STRUT_THINGS(STRUT_THING_ROW) STRUT_THING_COUNT
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
/** The parameter of that name, or NULL. */
STRUT_API const strut_parameter *strut_parameter_named(const strut_scene *scene, const char *name);

/** The kind of things whose observables an owner has; STRUT_THING_COUNT: they are of no kind of thing. */
STRUT_API strut_thing strut_thing_of_owner(strut_channel_owner owner);

/** The object of the section `ground`: its line, and the contact that every node starts from. */
typedef struct strut_ground_section {
  strut_ground ground;
  strut_contact contact;
  double normal[2]; /* as the file gives it; the ground keeps the slope */
} strut_ground_section;

/* ---- fields ---- */

enum { STRUT_MOST_THINGS = 10000000 }; /* entries of all copies of parts */

/** Which numbers are allowed. */
typedef enum strut_key_range {
  STRUT_RANGE_ANY,
  STRUT_RANGE_NOT_NEGATIVE,
  STRUT_RANGE_ABOVE_ZERO,
  STRUT_RANGE_WHOLE, /* a whole number from least to most */
  STRUT_RANGE_COUNT, /* of a list or a mapping: so many entries */
  STRUT_RANGE_SHARE  /* above zero, up to most; messages give both in percent */
} strut_key_range;

typedef struct strut_key_limits {
  strut_key_range range;
  double least, most; /* of WHOLE, COUNT and SHARE */
} strut_key_limits;

#define STRUT_LIMITS_ANY                                                                           \
  { STRUT_RANGE_ANY, 0.0, 0.0 }
#define STRUT_LIMITS_NOT_NEGATIVE                                                                  \
  { STRUT_RANGE_NOT_NEGATIVE, 0.0, 0.0 }
#define STRUT_LIMITS_ABOVE_ZERO                                                                    \
  { STRUT_RANGE_ABOVE_ZERO, 0.0, 0.0 }
#define STRUT_LIMITS_WHOLE(least, most)                                                            \
  { STRUT_RANGE_WHOLE, least, most }
#define STRUT_LIMITS_COUNT(least, most)                                                            \
  { STRUT_RANGE_COUNT, least, most }
#define STRUT_LIMITS_SHARE(most)                                                                   \
  { STRUT_RANGE_SHARE, 0.0, most }
/** The same as values: STRUT_WITHIN(ANY), STRUT_WITHIN(WHOLE(1, 9)). */
#define STRUT_WITHIN(range) ((strut_key_limits)STRUT_LIMITS_##range)

/** What is wrong with a number, "must not be negative, found -1", in `text`; NULL: it is within the limits. */
enum { STRUT_LIMITS_TEXT = 160 };
STRUT_API const char *strut_limits_fault(strut_key_limits limits, double number,
                                         char text[STRUT_LIMITS_TEXT]);

typedef enum strut_key_need {
  STRUT_OPTIONAL, /* written only where it differs from the default */
  STRUT_WRITTEN,  /* may be left out, but is always written */
  STRUT_REQUIRED
} strut_key_need;

struct strut_tree;

/** How a value is kept, see things_table.h. */
typedef enum strut_field_role {
  STRUT_FIELD_BY_HAND,
  STRUT_FIELD_NONE,
  STRUT_FIELD_VALUE,
  STRUT_FIELD_REFERENCE,
  STRUT_FIELD_LIST,
  STRUT_FIELD_PLACES,
  STRUT_FIELD_PATH,
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
  STRUT_FIELD_TEXT,        /* const char *; of a WORD, the word itself */
  STRUT_FIELD_INSTRUCTION, /* of a LIST that is a program */
  STRUT_FIELD_NODE_SET,    /* of a LIST */
  STRUT_FIELD_TREE         /* const strut_tree *: the value as the file has it */
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
  bool later;       /* the section's reader reads it, when it knows what it needs */
  bool turns;       /* an angle that is kept in turns */
  bool direction;   /* an angle, also x or y, that turns with a copy of a part */
  uint32_t first;   /* of a WORD: the value of the first one */
  size_t
      beside; /* where a LIST has its second coordinates, a PATH its guides, or a number the text of its unit; 0: nowhere */
  bool
      chosen; /* one of several keys: that where the tag, of so many bytes, is from value to last */
  size_t tag, tag_size;
  uint32_t tag_value, tag_last;
} strut_field;

/* A field of a type that is not listed does not compile. */
#define STRUT_TYPE_OF(lvalue)                                                                      \
  _Generic((lvalue), double: STRUT_FIELD_DOUBLE, int32_t: STRUT_FIELD_INT32, \
           uint32_t: STRUT_FIELD_UINT32, int64_t: STRUT_FIELD_INT64, \
           uint64_t: STRUT_FIELD_UINT64, bool: STRUT_FIELD_BOOL, \
           double *: STRUT_FIELD_DOUBLE_PAIR, bool *: STRUT_FIELD_BOOL_PAIR, \
           const char *: STRUT_FIELD_TEXT, const struct strut_tree *: STRUT_FIELD_TREE)
#define STRUT_ELEMENT_OF(lvalue)                                                                   \
  _Generic((lvalue), double *: STRUT_FIELD_DOUBLE, const double *: STRUT_FIELD_DOUBLE, \
           int32_t *: STRUT_FIELD_INT32, const int32_t *: STRUT_FIELD_INT32, \
           strut_instruction *: STRUT_FIELD_INSTRUCTION, \
           const strut_instruction *: STRUT_FIELD_INSTRUCTION, \
           double(*)[2]: STRUT_FIELD_DOUBLE_PAIR, const char **: STRUT_FIELD_TEXT, \
           strut_node_set *: STRUT_FIELD_NODE_SET)
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
#define STRUT_FIELD_OF_UNIT(object, member, unit)                                                  \
  .beside = offsetof(object, unit), STRUT_FIELD_OF_FIELD(object, member)
#define STRUT_FIELD_OF_REFERENCE(object, member, KIND)                                             \
  .role = STRUT_FIELD_REFERENCE, .type = STRUT_FIELD_INT32, .kind = STRUT_THING_##KIND,            \
  STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_LIST(object, member, count)                                                 \
  .role = STRUT_FIELD_LIST, .type = STRUT_ELEMENT_OF(STRUT_MEMBER(object, member)),                \
  .number = offsetof(object, count), .kind = STRUT_THING_COUNT, STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_CURVE(object, x, y, count)                                                  \
  .beside = offsetof(object, y), STRUT_FIELD_OF_LIST(object, x, count)
#define STRUT_FIELD_OF_PLACES(object, member)                                                      \
  .role = STRUT_FIELD_PLACES, .type = STRUT_FIELD_DOUBLE_PAIR, STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_PATH(object, ends, guides, count)                                           \
  .role = STRUT_FIELD_PATH, .kind = STRUT_THING_NODE, .beside = offsetof(object, guides),          \
  .number = offsetof(object, count), STRUT_PLACE_OF(object, ends)
#define STRUT_FIELD_OF_REFERENCES(object, member, count, KIND)                                     \
  .role = STRUT_FIELD_LIST, .type = STRUT_ELEMENT_OF(STRUT_MEMBER(object, member)),                \
  .number = offsetof(object, count), .kind = STRUT_THING_##KIND, STRUT_PLACE_OF(object, member)
#define STRUT_FIELD_OF_NESTED(object, member, SECTION)                                             \
  .role = STRUT_FIELD_NESTED, STRUT_PLACE_OF(object, member), .below = STRUT_BELOW(SECTION)
#define STRUT_FIELD_OF_SELF(object, SECTION)                                                       \
  .role = STRUT_FIELD_NESTED, .size = sizeof(object), .object_size = sizeof(object),               \
  .below = STRUT_BELOW(SECTION)
#define STRUT_FIELD_OF_SECTION(SECTION) .role = STRUT_FIELD_SECTION, .below = STRUT_BELOW(SECTION)
#define STRUT_FIELD_OF_THINGS(SECTION) .role = STRUT_FIELD_THINGS, .below = STRUT_BELOW(SECTION)
#define STRUT_FIELD_OF_OF_RUNS(field) .of_runs = true, STRUT_FIELD_OF_##field
#define STRUT_FIELD_OF_LATER(field) .later = true, STRUT_FIELD_OF_##field
#define STRUT_FIELD_OF_TURNS(field) .turns = true, STRUT_FIELD_OF_##field
#define STRUT_FIELD_OF_DIRECTION(object, member)                                                   \
  .direction = true, STRUT_FIELD_OF_FIELD(object, member)
#define STRUT_FIELD_OF_FROM(value, field) .first = value, STRUT_FIELD_OF_##field
#define STRUT_FIELD_OF_CHOICE(object, member, value, field)                                        \
  STRUT_FIELD_OF_AMONG(object, member, value, value, field)
#define STRUT_FIELD_OF_AMONG(object, member, value, last, field)                                   \
  .chosen = true, .tag = offsetof(object, member),                                                 \
  .tag_size = sizeof STRUT_MEMBER(object, member), .tag_value = value, .tag_last = last,           \
  STRUT_FIELD_OF_##field

/** Does an object have the key: is it the chosen one of several? */
static inline bool strut_field_is_chosen(const strut_field *field, const void *object) {
  const void *at = (const char *)object + field->tag;
  uint32_t tag = field->tag_size == sizeof(bool) ? *(const bool *)at : *(const uint32_t *)at;
  return !field->chosen || (tag >= field->tag_value && tag <= field->tag_last);
}

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
