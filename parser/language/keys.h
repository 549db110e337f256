/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The language as one table: which mapping (section) has which keys, of which type, dimension, range
 * and default, and in which field of which struct the value is kept. The reader, its messages, the
 * writer and the reference page all come from it.
 */
#ifndef STRUT_PARSER_LANGUAGE_KEYS_H
#define STRUT_PARSER_LANGUAGE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/status.h"
#include "engine/scene/things.h"
#include "parser/expression/units.h"
#include "parser/language/keys_table.h"

/** The mappings of the language. */
typedef enum strut_section {
#define STRUT_SECTION_ROW(NAME, ...) STRUT_SECTION_##NAME,
  STRUT_SECTIONS(STRUT_SECTION_ROW)
#undef STRUT_SECTION_ROW
      STRUT_SECTION_COUNT
} strut_section;

typedef enum strut_key_type {
  STRUT_TYPE_VERSION,       /* the integer 1 */
  STRUT_TYPE_TEXT,          /* any text */
  STRUT_TYPE_NUMBER,        /* an expression of the key's dimension */
  STRUT_TYPE_PAIR,          /* a list of two such numbers */
  STRUT_TYPE_WORD,          /* one of the key's words */
  STRUT_TYPE_WORDS,         /* a list of them */
  STRUT_TYPE_FIXED,         /* none, x, y, both, or a list of x and y */
  STRUT_TYPE_NAME,          /* the name of a thing */
  STRUT_TYPE_NODE_PATH,     /* the names of two nodes or more */
  STRUT_TYPE_NODE_TRIPLE,   /* the names of three nodes */
  STRUT_TYPE_NUMBERS,       /* a list of numbers */
  STRUT_TYPE_POINTS,        /* a list of [x, y] */
  STRUT_TYPE_PROFILE,       /* a list of [x, y], lengths */
  STRUT_TYPE_LAW,           /* the name of a law, or the keys of law */
  STRUT_TYPE_CONTACT_NODES, /* all, or a list of nodes */
  STRUT_TYPE_NODE_SETS,     /* a list of nodes, or a list of such lists */
  STRUT_TYPE_GROUPS,        /* the name of a group, or a list of them */
  STRUT_TYPE_SIGNAL,        /* a signal or its name */
  STRUT_TYPE_SIGNALS,       /* a list of signals */
  STRUT_TYPE_TABLE,         /* a list of [t, value] */
  STRUT_TYPE_SETTLE,        /* true, false or the keys of settle */
  STRUT_TYPE_STEADY,        /* true, false or the keys of steady */
  STRUT_TYPE_EXPRESSION,    /* an expression of columns of the motion; CONTEXT: of sensors */
  STRUT_TYPE_KEEP,          /* a list of the key's words and of quantities */
  STRUT_TYPE_AXES,          /* a list of axes of a study */
  STRUT_TYPE_TIMES,         /* a list of times */
  STRUT_TYPE_MAP,           /* the keys of the section that has the key's name */
  STRUT_TYPE_THINGS,        /* a mapping from names to things, described by `words` */
  STRUT_TYPE_NODE_RING,     /* the names of three nodes or more */
  STRUT_TYPE_NAME_PAIR,     /* the names of two things */
  STRUT_TYPE_FREE,          /* several forms, described by `words` */
  STRUT_TYPE_NAMES          /* a list of names */
} strut_key_type;

/** The dimension of a number; CONTEXT: it depends on the use of the mapping. */
typedef enum strut_measure {
  STRUT_MEASURE_NONE,
  STRUT_MEASURE_CONTEXT,
  STRUT_MEASURE_LENGTH,
  STRUT_MEASURE_MASS,
  STRUT_MEASURE_TIME,
  STRUT_MEASURE_FREQUENCY,
  STRUT_MEASURE_ANGLE,
  STRUT_MEASURE_VELOCITY,
  STRUT_MEASURE_ACCELERATION,
  STRUT_MEASURE_FORCE,
  STRUT_MEASURE_STIFFNESS,
  STRUT_MEASURE_DAMPING,
  STRUT_MEASURE_DISSIPATION,
  STRUT_MEASURE_ANGULAR_STIFFNESS,
  STRUT_MEASURE_ANGULAR_DAMPING,
  STRUT_MEASURE_MOMENT,
  STRUT_MEASURE_BENDING_STIFFNESS,
  STRUT_MEASURE_AREA,
  STRUT_MEASURE_PRESSURE, /* in the plane: force per length, which acts on an area */
  STRUT_MEASURE_CONDUCTANCE,
  STRUT_MEASURE_AREA_STIFFNESS,
  STRUT_MEASURE_AREA_DAMPING
} strut_measure;

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
  STRUT_KEY_TABLE(STRUT_KEY_ENUM)
#undef STRUT_KEY_ENUM
      STRUT_KEY_COUNT
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
  STRUT_SPELLING_FORMER,  /* a former name, accepted with a note */
  STRUT_SPELLING_MISTAKE  /* not accepted: what a message suggests for it */
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
/** The i-th spelling, or NULL after the last. */
STRUT_API const strut_spelling *strut_spelling_at(size_t i);
/** The number of a spelling; below 32 for former names. */
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

/** Size of the buffer of strut_dimension_suffix. */
enum { STRUT_SUFFIX_TEXT = 120 };

#endif
