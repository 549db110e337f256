/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The language as one table: which mapping (section) has which keys, of which type, dimension, range
 * and default, and in which field of which struct the value is kept. The reader, its messages, the
 * writer and the reference page all come from it.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/status.h"
#include "engine/scene/things.h"
#include "parser/language/expression/expression.h"
#include "parser/language/keys/keys_table.h"

/** The mappings of the language. */
typedef enum strut_section {
#define STRUT_SECTION_ROW(NAME, ...) STRUT_SECTION_##NAME,
  STRUT_SECTIONS(STRUT_SECTION_ROW)
#undef STRUT_SECTION_ROW
      STRUT_SECTION_COUNT
} strut_section;

/* clang-format off */
/**
 * The types of values, X(TYPE, shape, least, most, schema, what messages expect, what the reference says): whether
 * the value is a scalar or the name of one (SCALAR), a list with so many items (LIST), a mapping (MAP), or one of
 * several; ANY where its reader reports it. The schema says the same in the letters of parser/program/command/schema.c.
 * What messages expect is NULL where it depends on the key (keys.c).
 */
#define STRUT_KEY_TYPES(X) \
  X(VERSION, SCALAR, 0, 0, "=[1]=", "the language version 1", "") \
  X(TEXT, SCALAR, 0, 0, "s", "a text", "text") \
  X(NUMBER, ANY, 0, 0, "n", NULL, "number") /* an expression of the key's dimension */ \
  X(PAIR, ANY, 0, 0, "[22n]", NULL, "two numbers") /* a list of two such numbers */ \
  X(WORD, ANY, 0, 0, "w", NULL, "") /* one of the key's words */ \
  X(WORDS, LIST, 0, UINT32_MAX, "", NULL, "list of ") \
  X(FIXED, SCALAR | STRUT_SHAPE_LIST, 0, UINT32_MAX, "A([02=[\"x\", \"y\"]=]|=[\"none\", \"x\", \"y\", \"both\"]=)", NULL, "") /* one of the words, or a list of x and y */ \
  X(NAME, SCALAR, 0, 0, "s", "a name", "name") \
  X(NODE_PATH, LIST, 2, UINT32_MAX, "[20s]", "two nodes such as [n1, n2], or the nodes of a running cable", "names of two nodes or more") \
  X(NODE_TRIPLE, LIST, 3, 3, "[33s]", "three nodes such as [n1, n2, n3]", "names of three nodes") \
  X(NUMBERS, LIST, 0, UINT32_MAX, "[00n]", "a list of numbers", "list of numbers") \
  X(POINTS, LIST, 0, UINT32_MAX, "[00[22n]]", "a list of points such as [[0, 0], [2 mm, 3 N]]", "list of `[x, force]`") \
  X(PROFILE, LIST, 0, UINT32_MAX, "[00[22n]]", "a list of points such as [[0, 0], [10 mm, 0], [20 mm, 5 mm]]", "list of `[x, y]` [m]") \
  X(LAW, SCALAR | STRUT_SHAPE_MAP, 0, 0, "O(<law>|l)", "a law such as {kind: bilinear, knee: 2 mm, second_stiffness: 5 N/m}", "[law](#law), or the kind of one") \
  X(CONTACT_NODES, ALL | STRUT_SHAPE_LIST, 0, UINT32_MAX, "A([00s]|=[\"all\"]=)", "all, or a list of nodes such as [n1, n2]", "`all`, or list of nodes") \
  X(NODE_SETS, LIST, 0, UINT32_MAX, "[00A([00s]|s)]", "nodes such as [n1, n2], or a list of such lists", "list of nodes, or list of such lists") \
  X(GROUPS, SCALAR | STRUT_SHAPE_LIST, 0, UINT32_MAX, "A([00s]|s)", "a group, or a list of groups", "group, or list of groups") \
  X(SIGNAL, SCALAR | STRUT_SHAPE_MAP, 0, 0, "O(<signal>|s)", "a signal such as {sine: {amplitude: 1 mm, frequency: 10 Hz}}, or a signal's name", "[signal](#signal), or the name of one") \
  X(SIGNALS, LIST, 0, UINT32_MAX, "[00O(<signal>|s)]", "a list of signals", "list of signals") \
  X(TABLE, LIST, 0, UINT32_MAX, "[00[22n]]", "a list of points such as [[0 s, 0], [1 s, 2]]", "list of `[t, value]`") \
  X(SETTLE, SCALAR | STRUT_SHAPE_MAP, 0, 0, "O(<settle>|=[true, false, \"yes\", \"no\"]=)", "true, or a mapping such as {limit: 100 s}", "`true`, `false`, or [mapping](#settle)") \
  X(STEADY, SCALAR | STRUT_SHAPE_MAP, 0, 0, "O(<steady>|=[true, false, \"yes\", \"no\"]=)", "true, or a mapping such as {tolerance: 0.5 %}", "`true`, `false`, or [mapping](#steady)") \
  X(EXPRESSION, SCALAR, 0, 0, "n", "an expression such as com.vy, n1.y - n2.y or m1.force", "") /* CONTEXT: of sensors */ \
  X(KEEP, LIST, 0, UINT32_MAX, "[00k]", NULL, "list of quantities, or of ") /* the key's words and quantities */ \
  X(AXES, LIST, 0, UINT32_MAX, "[00x]", "a list of axes such as [{friction: [0.1, 0.2]}]", "list of axes") \
  X(TIMES, LIST, 1, UINT32_MAX, "[00n]", "a list of times such as [0 s, 20 ms]", "list of times [s]") \
  X(MAP, MAP, 0, 0, "", "a mapping {key: value, ...}", "") /* the keys of the section that has the key's name */ \
  X(THINGS, MAP, 0, 0, "{!t}", "a mapping {name: ..., ...}", "names, each with ") /* from names to things, described by `words` */ \
  X(NODE_RING, LIST, 3, UINT32_MAX, "[30s]", "three nodes or more such as [n1, n2, n3]", "names of three nodes or more") \
  X(NAME_PAIR, LIST, 2, 2, "[22s]", "two names such as [a, b]", "two names") \
  X(FREE, ANY, 0, 0, "", NULL, "") /* several forms, described by `words` */ \
  X(NAMES, LIST, 0, UINT32_MAX, "[00s]", "a list of names such as [a, b]", "list of names")

/** The dimensions of numbers, X(MEASURE, dimension); CONTEXT: it depends on the use of the mapping. */
#define STRUT_MEASURES(X) \
  X(NONE, NONE) X(CONTEXT, NONE) X(LENGTH, LENGTH) X(MASS, MASS) X(TIME, TIME) X(FREQUENCY, FREQUENCY) X(ANGLE, ANGLE) \
  X(VELOCITY, VELOCITY) X(ACCELERATION, ACCELERATION) X(FORCE, FORCE) X(STIFFNESS, STIFFNESS) X(DAMPING, DAMPING) \
  X(DISSIPATION, DISSIPATION) X(ANGULAR_STIFFNESS, ANGULAR_STIFFNESS) X(ANGULAR_DAMPING, ANGULAR_DAMPING) \
  X(MOMENT, MOMENT) X(BENDING_STIFFNESS, BENDING_STIFFNESS) X(AREA, AREA) \
  X(PRESSURE, STIFFNESS) /* in the plane: force per length, which acts on an area */ \
  X(CONDUCTANCE, CONDUCTANCE) X(AREA_STIFFNESS, AREA_STIFFNESS) X(AREA_DAMPING, AREA_DAMPING)

typedef enum strut_key_type {
#define STRUT_KEY_TYPE_ROW(TYPE, ...) STRUT_TYPE_##TYPE,
  STRUT_KEY_TYPES(STRUT_KEY_TYPE_ROW)
} strut_key_type;

typedef enum strut_measure {
#define STRUT_MEASURE_ROW(MEASURE, dimension) STRUT_MEASURE_##MEASURE,
  STRUT_MEASURES(STRUT_MEASURE_ROW)
} strut_measure;
/* clang-format on */

enum { STRUT_USUAL_PARTS = 10 };

/** The object of the section `beam`, which the reader turns into nodes, members and hinges. */
typedef struct strut_beam {
  const char *name;
  const struct strut_tree *key; /* its place */
  int32_t node[2];
  double bending_stiffness, axial_stiffness; /* EI [N m^2], EA [N] */
  double mass, damping;                      /* [kg] of the whole; over stiffness [s] */
  int32_t parts;
  uint32_t clamped;                  /* bits: at its first node, at its second */
  int32_t first_node, clamp_node[2]; /* of the nodes that it has added */
  bool broken;
  const struct strut_tree *clamped_to[2]; /* what its ends are clamped to, or NULL */
} strut_beam;

/** The objects of the sections `part`, `place` and `repeat`; values that are trees are read where they are used. */
typedef struct strut_part_keys {
  const struct strut_tree *use, *parameters, *merge, *ports;
  bool isolated;
} strut_part_keys;

typedef struct strut_place_keys {
  uint32_t flip;      /* bits: x, y */
  double turn, at[2]; /* [rad], [m] */
  const struct strut_tree *part, *scale, *onto, *set, *repeat;
} strut_place_keys;

typedef struct strut_repeat_keys {
  double turn, scale, about[2]; /* [rad], [1], [m] */
  const struct strut_tree *count, *step, *next, *closed;
} strut_repeat_keys;

/** The object of the section `next`; its things have none. */
typedef struct strut_next_keys {
  const struct strut_tree *merge;
} strut_next_keys;

/** The objects of the sections `range` and `points` of a study's axes. */
typedef struct strut_range_keys {
  double from, to, step, count;
  uint32_t scale; /* 1: logarithmic */
} strut_range_keys;

typedef struct strut_points_keys {
  const struct strut_tree *file, *columns;
} strut_points_keys;

/** The object of the section `moves`. */
typedef struct strut_moves {
  int32_t signal[2]; /* in x, in y [m]; -1: none */
} strut_moves;

/** The object of the section `controller`: a PID controller. */
typedef struct strut_controller {
  int32_t sensor;
  double target, gain, integral, derivative, every;
  double limit[2]; /* least, most */
  bool limited[2];
} strut_controller;

/** The object of the section `pipe`. */
typedef struct strut_pipe {
  int32_t cell[2];
  double conductance; /* [m^2/s] */
} strut_pipe;

/** The object of the section `network`. */
typedef struct strut_network {
  const char *file;
  int64_t output; /* from 1 */
  uint32_t last;  /* 0: tanh, 1: linear */
  double every;   /* [s] */
  const struct strut_tree *inputs, *scale;
} strut_network;

/** The object of the section `row of data`. */
typedef struct strut_row_keys {
  const char *column[2]; /* of x, of y */
  int32_t row;           /* from 1 */
  double time;           /* [s] */
} strut_row_keys;

/** The object of the section `oscillator`. */
typedef struct strut_oscillator {
  double frequency, phase, bias; /* [Hz], [rad] */
  const struct strut_tree *coupling, *feedback;
} strut_oscillator;

/** The object of the section `sample`. */
typedef struct strut_sample_keys {
  int64_t count;
  uint32_t scheme; /* strut_sample_scheme */
  int64_t seed;
} strut_sample_keys;

/** One row of the table. */
typedef struct strut_key {
  strut_section section;
  const char *name;
  strut_key_type type;
  strut_measure measure;
  strut_key_limits limits;
  const char *fallback; /* the default, as the reference page shows it */
  strut_key_need need;
  int set;           /* a mapping may give only one of the keys with the same set (not 0) */
  const char *words; /* of a nested mapping: what messages call it, "" if by its key */
  strut_field field;
  const char *description;
} strut_key;

/** STRUT_KEY_MEMBER_STIFFNESS, ...; the keys of one section follow each other. */
enum {
#define STRUT_KEY_ENUM(section, id, ...) STRUT_KEY_##section##_##id,
#define STRUT_KEYS_OF(NAME, name, rows, ...)                                                       \
  STRUT_FIRST_OF_##NAME, STRUT_BEFORE_##NAME = STRUT_FIRST_OF_##NAME - 1, rows(STRUT_KEY_ENUM)
  STRUT_SECTIONS(STRUT_KEYS_OF) STRUT_KEY_COUNT
};

enum { STRUT_MOST_KEYS = 48 }; /* of one section */

STRUT_API const strut_key *strut_key_at(int key);
/** First key and number of keys of a section. */
STRUT_API int strut_section_first(strut_section section);
STRUT_API int strut_section_size(strut_section section);
/** The key of that name in a section, or -1. */
STRUT_API int strut_key_find(strut_section section, const char *name);
typedef enum strut_spelling_kind {
  STRUT_SPELLING_SYNONYM, /* accepted */
  STRUT_SPELLING_FORMER   /* a former name, accepted with a note */
} strut_spelling_kind;

/** Another spelling of a key, or of a word of a key. */
typedef struct strut_spelling {
  strut_section section;
  const char *key; /* the key whose word it is; NULL: a key itself */
  const char *other, *current;
  strut_spelling_kind kind;
} strut_spelling;

/** The other spelling of a key (`key` NULL) or of a word, or NULL. */
STRUT_API const strut_spelling *strut_spelling_find(strut_section section, const char *key,
                                                    const char *text);
/** The key that a message suggests for a likely first guess, such as "k"; NULL for other words. */
STRUT_API const char *strut_key_meant(strut_section section, const char *guess);
/** The i-th spelling, or NULL after the last. */
STRUT_API const strut_spelling *strut_spelling_at(size_t i);
/** The number of a spelling, below 32. */
STRUT_API int strut_spelling_index(const strut_spelling *spelling);
/** The current name of a key: `name` itself, unless it is a former one. */
STRUT_API const char *strut_key_current(strut_section section, const char *name);
/** The section of that name, or STRUT_SECTION_COUNT. */
STRUT_API strut_section strut_section_find(const char *name);
/** "node", "half_sine", ... */
STRUT_API const char *strut_section_name(strut_section section);
/** What the reference says about the section. */
STRUT_API const char *strut_section_introduction(strut_section section);
/** The sections whose things may name groups; a group may have the keys of all. */
enum { STRUT_GROUP_SECTIONS = 4 };
STRUT_API extern const strut_section strut_group_sections[STRUT_GROUP_SECTIONS];

/** The section of a wave: sine, half_sine, square or ramp. */
STRUT_API strut_section strut_wave_section(strut_signal_kind kind);
/** The section of the keys below a mapping's key, or STRUT_SECTION_COUNT. */
STRUT_API strut_section strut_section_below(const strut_key *key);

STRUT_API strut_dimension strut_measure_dimension(strut_measure measure);
/** What the reference says of a type, before the key's words; "" where these are all. */
const char *strut_type_reference(strut_key_type type);
/** What the schema says of a type. */
const char *strut_type_shape(strut_key_type type);
/** Is the value a scalar, list or mapping, as its type requires? */
bool strut_shape_fits(strut_key_type type, const struct strut_tree *value);
/** "a length such as '10 mm'"; written into buffer. */
STRUT_API const char *strut_expected_number(strut_dimension dimension, char *buffer, size_t size);
/** The same of a key or a quantity whose dimension may be better known as another: moments are no energies. */
STRUT_API const char *strut_expected_quantity(const char *quantity, strut_dimension dimension,
                                              char *buffer, size_t size);
/** Describes the values of a key for messages, such as "bar, spring or cable", in buffer. */
STRUT_API const char *strut_key_expected(int key, char *buffer, size_t size);
/** "bar, spring or cable" from "bar|spring|cable". */
STRUT_API const char *strut_words_text(const char *words, char *buffer, size_t size);
/** Index of a word in "bar|spring|cable", or -1. */
STRUT_API int strut_word_find(const char *words, const char *word);
/** 1 for yes and true, 0 for no and false, -1 for other texts. */
int strut_switch_find(const char *text);
/** The i-th word, copied into buffer, or NULL after the last. */
STRUT_API const char *strut_word_at(const char *words, int i, char *buffer, size_t size);

/** What names in expressions are made of, a letter first. */
#define STRUT_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
#define STRUT_DIGITS "0123456789"

/** Size of the buffer of strut_dimension_suffix. */
enum { STRUT_SUFFIX_TEXT = 120 };
