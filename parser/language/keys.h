/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The language as one table: which mapping (room) has which keys, of which type, dimension, range
 * and default. The reader, its messages and the reference page all come from it.
 */
#ifndef STRUT_PARSER_LANGUAGE_KEYS_H
#define STRUT_PARSER_LANGUAGE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/export.h"
#include "engine/scene/scene.h"
#include "parser/expression/units.h"
#include "parser/language/keys_table.h"

/** The mappings of the language. */
typedef enum strut_section {
  STRUT_ROOM_SCENE,
  STRUT_ROOM_NODE,
  STRUT_ROOM_MEMBER,
  STRUT_ROOM_GROUND,
  STRUT_ROOM_FRICTION,
  STRUT_ROOM_CONTACT,
  STRUT_ROOM_ACTUATOR,
  STRUT_ROOM_LOAD,
  STRUT_ROOM_SIGNAL,
  STRUT_ROOM_SINE,
  STRUT_ROOM_HALF_SINE,
  STRUT_ROOM_SQUARE,
  STRUT_ROOM_RAMP,
  STRUT_ROOM_CONFIGURATION,
  STRUT_ROOM_INITIAL,
  STRUT_ROOM_SETTLE,
  STRUT_ROOM_EQUILIBRIA,
  STRUT_ROOM_SOLVER,
  STRUT_ROOM_RUN,
  STRUT_ROOM_MEASURE,
  STRUT_ROOM_QUANTITY,
  STRUT_ROOM_STEADY,
  STRUT_ROOM_OUTPUT,
  STRUT_ROOM_STUDY,
  STRUT_ROOM_RANGE,
  STRUT_ROOM_VARIANT,
  STRUT_ROOM_CHECK,
  STRUT_ROOM_FIGURE,
  STRUT_ROOM_COUNT
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
  STRUT_TYPE_NODE_PAIR,     /* the names of two nodes */
  STRUT_TYPE_CONTACT_NODES, /* all, or a list of nodes */
  STRUT_TYPE_NODE_SETS,     /* a list of nodes, or a list of such lists */
  STRUT_TYPE_GROUPS,        /* the name of a group, or a list of them */
  STRUT_TYPE_SIGNAL,        /* a signal or its name */
  STRUT_TYPE_SIGNALS,       /* a list of signals */
  STRUT_TYPE_TABLE,         /* a list of [t, value] */
  STRUT_TYPE_SETTLE,        /* true, false or the keys of settle */
  STRUT_TYPE_STEADY,        /* true, false or the keys of steady */
  STRUT_TYPE_EXPRESSION,    /* an expression of columns of the motion */
  STRUT_TYPE_KEEP,          /* a list of the key's words and of quantities */
  STRUT_TYPE_AXES,          /* a list of axes of a study */
  STRUT_TYPE_TIMES,         /* a list of times */
  STRUT_TYPE_MAP,           /* the keys of the room that has the key's name */
  STRUT_TYPE_THINGS         /* a mapping from names to what `words` says */
} strut_key_type;

/** What a number measures; CONTEXT: it depends on where the mapping stands. */
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
  STRUT_MEASURE_DISSIPATION
} strut_measure;

typedef enum strut_key_range {
  STRUT_RANGE_ANY,
  STRUT_RANGE_NOT_NEGATIVE,
  STRUT_RANGE_ABOVE_ZERO
} strut_key_range;

/** One line of the table. */
typedef struct strut_key {
  strut_section room;
  const char *name;
  strut_key_type type;
  strut_measure measure;
  strut_key_range range;
  bool required;
  int set; /* of the keys with the same set (not 0) a mapping has one */
  const char *fallback, *words, *description;
} strut_key;

/** STRUT_KEY_MEMBER_STIFFNESS and so on: the keys of one room follow each other. */
enum {
#define STRUT_KEY_ENUM(room, id, ...) STRUT_KEY_##room##_##id,
  STRUT_KEY_TABLE(STRUT_KEY_ENUM)
#undef STRUT_KEY_ENUM
      STRUT_KEY_COUNT
};

enum { STRUT_MOST_KEYS = 24 }; /* of one room */

STRUT_API const strut_key *strut_key_at(int key);
/** First key and number of keys of a room. */
STRUT_API int strut_section_first(strut_section room);
STRUT_API int strut_section_size(strut_section room);
/** The key of that name in a room, or -1. */
STRUT_API int strut_key_find(strut_section room, const char *name);
/** "node", "half_sine", ... */
STRUT_API const char *strut_section_name(strut_section room);

STRUT_API strut_dimension strut_measure_dimension(strut_measure measure);
/** "a length such as '10 mm'"; written into buffer. */
STRUT_API const char *strut_expected_number(strut_dimension dimension, char *buffer, size_t size);
/** What a key's value should be, for messages: "bar, spring or cable"; written into buffer. */
STRUT_API const char *strut_key_expected(int key, char *buffer, size_t size);
/** "bar, spring or cable" from "bar|spring|cable". */
STRUT_API const char *strut_words_text(const char *words, char *buffer, size_t size);
/** Index of a word in "bar|spring|cable", or -1. */
STRUT_API int strut_word_find(const char *words, const char *word);
/** 1 for yes and true, 0 for no and false, -1 for other texts. */
int strut_switch_find(const char *text);
/** The i-th word, copied into buffer, or NULL after the last. */
STRUT_API const char *strut_word_at(const char *words, int i, char *buffer, size_t size);

#endif
