/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of the language and the look-ups in it. See keys.h. */
#include "parser/language/keys.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "engine/scene/sample.h"
#include "engine/scene/study.h"

/* clang-format off */
#define STRUT_BELOW(SECTION) STRUT_SECTION_##SECTION
#define STRUT_KEY_ROW(section, id, name, type, measure, range, fallback, need, set, words, field, \
                      description) \
  {STRUT_SECTION_##section, name, STRUT_TYPE_##type, STRUT_MEASURE_##measure, \
   STRUT_LIMITS_##range, fallback, STRUT_##need, set, words, {STRUT_FIELD_OF_##field}, description},
static const strut_key table[] = {STRUT_KEY_TABLE(STRUT_KEY_ROW)};
/* clang-format on */

/* First key of each section, and one more that ends the last; a test compares it with the table. */
static const int first[] = {
#define STRUT_SECTION_ROW(NAME, name, first, ...) STRUT_KEY_##first,
    STRUT_SECTIONS(STRUT_SECTION_ROW)
#undef STRUT_SECTION_ROW
        STRUT_KEY_COUNT};

static const char *const section_names[] = {
#define STRUT_SECTION_ROW(NAME, name, ...) name,
    STRUT_SECTIONS(STRUT_SECTION_ROW)
#undef STRUT_SECTION_ROW
};

static const char *const introductions[] = {
#define STRUT_SECTION_ROW(NAME, name, first, introduction) introduction,
    STRUT_SECTIONS(STRUT_SECTION_ROW)
#undef STRUT_SECTION_ROW
};

const strut_section strut_group_sections[STRUT_GROUP_SECTIONS] = {
    STRUT_SECTION_MEMBER, STRUT_SECTION_NODE, STRUT_SECTION_CONTACT, STRUT_SECTION_HINGE};

const strut_key *strut_key_at(int key) {
  assert(key >= 0 && key < STRUT_KEY_COUNT);
  return &table[key];
}

int strut_section_first(strut_section section) {
  assert((unsigned)section < STRUT_SECTION_COUNT);
  return first[section];
}
int strut_section_size(strut_section section) { return first[section + 1] - first[section]; }
const char *strut_section_name(strut_section section) { return section_names[section]; }
const char *strut_section_introduction(strut_section section) { return introductions[section]; }

int strut_key_find(strut_section section, const char *name) {
  for (int key = first[section]; key < first[section + 1]; key++)
    if (strcmp(table[key].name, name) == 0) return key;
  return -1;
}

strut_section strut_wave_section(strut_signal_kind kind) {
  assert(kind >= STRUT_SINE && kind <= STRUT_RAMP);
  return (strut_section)(STRUT_SECTION_SINE + (kind - STRUT_SINE));
}

strut_section strut_section_below(const strut_key *key) {
  bool mapping = key->field.role == STRUT_FIELD_NESTED || key->field.role == STRUT_FIELD_SECTION ||
                 key->field.role == STRUT_FIELD_THINGS;
  if (mapping) return (strut_section)key->field.below;
  if (key->type != STRUT_TYPE_THINGS) return strut_section_find(key->name);
  /* groups have keys of members, and of other things */
  return strcmp(key->name, "groups") == 0 ? STRUT_SECTION_MEMBER : STRUT_SECTION_COUNT;
}

/* Former names stay readable for one version of strut at least; docs and models use the current ones. */
static const strut_spelling spellings[] = {
    {STRUT_SECTION_GROUND, "damping_law", "printed", "approach_only", STRUT_SPELLING_FORMER},
    {STRUT_SECTION_STEADY, NULL, "floor", "absolute_tolerance", STRUT_SPELLING_FORMER},
    {STRUT_SECTION_STEADY, NULL, "successive", "repetitions", STRUT_SPELLING_FORMER},
    {STRUT_SECTION_MEMBER, "kind", "strut", "bar", STRUT_SPELLING_SYNONYM},
    {STRUT_SECTION_MEMBER, "kind", "string", "cable", STRUT_SPELLING_SYNONYM},
    {STRUT_SECTION_SCENE, NULL, "elements", "members", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_SCENE, NULL, "points", "nodes", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_SCENE, NULL, "forces", "loads", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_NODE, NULL, "coordinates", "position", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_NODE, NULL, "pos", "position", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_NODE, NULL, "support", "fixed", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_MEMBER, NULL, "type", "kind", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_MEMBER, NULL, "EA", "axial_stiffness", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_MEMBER, NULL, "prestress", "pretension", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_MEMBER, NULL, "length", "rest_length", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_GROUND, NULL, "angle", "slope", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_FRICTION, NULL, "coefficient", "mu", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_SOLVER, NULL, "timestep", "step", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_SOLVER, NULL, "time_step", "step", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_SOLVER, NULL, "dt", "step", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_SOLVER, NULL, "method", "integrator", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_RUN, NULL, "time", "duration", STRUT_SPELLING_MISTAKE},
    {STRUT_SECTION_RUN, NULL, "length", "duration", STRUT_SPELLING_MISTAKE}};

const strut_spelling *strut_spelling_find(strut_section section, const char *key,
                                          const char *text) {
  for (size_t i = 0; i < sizeof spellings / sizeof spellings[0]; i++) {
    const strut_spelling *s = &spellings[i];
    if (s->section != section || !s->key != !key || (key && strcmp(s->key, key) != 0)) continue;
    if (strcmp(s->other, text) == 0) return s;
  }
  return NULL;
}

const strut_spelling *strut_spelling_at(size_t i) {
  return i < sizeof spellings / sizeof spellings[0] ? &spellings[i] : NULL;
}

int strut_spelling_index(const strut_spelling *spelling) {
  int index = (int)(spelling - spellings);
  assert(index >= 0 && (index < 32 || spelling->kind != STRUT_SPELLING_FORMER));
  return index;
}

const char *strut_key_current(strut_section section, const char *name) {
  const strut_spelling *spelling = strut_spelling_find(section, NULL, name);
  return spelling && spelling->kind != STRUT_SPELLING_MISTAKE ? spelling->current : name;
}

strut_section strut_section_find(const char *name) {
  int section = 0;
  while (section < STRUT_SECTION_COUNT && strcmp(section_names[section], name) != 0) section++;
  return (strut_section)section;
}

strut_dimension strut_measure_dimension(strut_measure measure) {
  switch (measure) {
    case STRUT_MEASURE_LENGTH: return STRUT_DIM_LENGTH;
    case STRUT_MEASURE_MASS: return STRUT_DIM_MASS;
    case STRUT_MEASURE_TIME: return STRUT_DIM_TIME;
    case STRUT_MEASURE_FREQUENCY: return STRUT_DIM_FREQUENCY;
    case STRUT_MEASURE_ANGLE: return STRUT_DIM_ANGLE;
    case STRUT_MEASURE_VELOCITY: return STRUT_DIM_VELOCITY;
    case STRUT_MEASURE_ACCELERATION: return STRUT_DIM_ACCELERATION;
    case STRUT_MEASURE_FORCE: return STRUT_DIM_FORCE;
    case STRUT_MEASURE_STIFFNESS: return STRUT_DIM_STIFFNESS;
    case STRUT_MEASURE_DAMPING: return STRUT_DIM_DAMPING;
    case STRUT_MEASURE_DISSIPATION: return STRUT_DIM_DISSIPATION;
    case STRUT_MEASURE_ANGULAR_STIFFNESS: return STRUT_DIM_ANGULAR_STIFFNESS;
    case STRUT_MEASURE_BENDING_STIFFNESS: return STRUT_DIM_BENDING_STIFFNESS;
    case STRUT_MEASURE_ANGULAR_DAMPING: return STRUT_DIM_ANGULAR_DAMPING;
    case STRUT_MEASURE_MOMENT: return STRUT_DIM_MOMENT;
    case STRUT_MEASURE_AREA: return STRUT_DIM_AREA;
    case STRUT_MEASURE_PRESSURE: return STRUT_DIM_STIFFNESS;
    case STRUT_MEASURE_CONDUCTANCE: return STRUT_DIM_CONDUCTANCE;
    case STRUT_MEASURE_AREA_STIFFNESS: return STRUT_DIM_AREA_STIFFNESS;
    case STRUT_MEASURE_AREA_DAMPING: return STRUT_DIM_AREA_DAMPING;
    case STRUT_MEASURE_NONE:
    case STRUT_MEASURE_CONTEXT: break;
  }
  return STRUT_DIM_NONE;
}

/* Quantities that share their dimension with a better known one. */
static const struct quantity_words {
  const char *name;
  strut_measure measure;
  const char *expected;
} quantities[] = {
    {"breaks_at", STRUT_MEASURE_MOMENT, "a moment such as '2 N m'"},
    {"yield", STRUT_MEASURE_MOMENT, "a moment such as '2 N m'"},
    {"moment", STRUT_MEASURE_MOMENT, "a moment such as '2 N m'"},
    {"pressure", STRUT_MEASURE_STIFFNESS,
     "a pressure, in the plane a force per length, such as '500 N/m'"},
    {"outside", STRUT_MEASURE_STIFFNESS,
     "a pressure, in the plane a force per length, such as '500 N/m'"},
};

const char *strut_expected_quantity(const char *quantity, strut_dimension dimension, char *buffer,
                                    size_t size) {
  char name[80];
  const char *example = strut_dimension_example(dimension);
  for (size_t i = 0; quantity && i < sizeof quantities / sizeof quantities[0]; i++)
    if (strcmp(quantities[i].name, quantity) == 0 &&
        strut_dimension_equal(strut_measure_dimension(quantities[i].measure), dimension)) {
      snprintf(buffer, size, "%s", quantities[i].expected);
      return buffer;
    }
  strut_dimension_name(dimension, name, sizeof name);
  if (example)
    snprintf(buffer, size, "%s such as '%s'", name, example);
  else
    snprintf(buffer, size, "%s", name);
  return buffer;
}

const char *strut_expected_number(strut_dimension dimension, char *buffer, size_t size) {
  return strut_expected_quantity(NULL, dimension, buffer, size);
}

const char *strut_word_at(const char *words, int i, char *buffer, size_t size) {
  for (; i > 0 && *words; i--) {
    words += strcspn(words, "|");
    if (*words) words++;
  }
  if (!*words) return NULL;
  snprintf(buffer, size, "%.*s", (int)strcspn(words, "|"), words);
  return buffer;
}

int strut_word_find(const char *words, const char *word) {
  size_t wanted = strlen(word);
  for (int i = 0; *words; i++) {
    size_t length = strcspn(words, "|");
    if (length == wanted && memcmp(words, word, length) == 0) return i;
    words += length + (words[length] != '\0');
  }
  return -1;
}

int strut_switch_find(const char *text) {
  int found = strut_word_find("no|yes|false|true", text);
  return found < 0 ? -1 : found % 2;
}

const char *strut_words_text(const char *words, char *buffer, size_t size) {
  enum { MOST_LISTED = 20 };
  char word[40], following[40];
  size_t used = 0;
  buffer[0] = '\0';
  for (int i = 0; strut_word_at(words, i, word, sizeof word) && used < size; i++) {
    bool last = !strut_word_at(words, i + 1, following, sizeof following);
    const char *before = i == 0 ? "" : last ? " or " : ", ";
    if (i == MOST_LISTED) return strncat(buffer, ", ...", size - used - 1);
    used += (size_t)snprintf(buffer + used, size - used, "%s%s", before, word);
  }
  return buffer;
}

const char *strut_key_expected(int key, char *buffer, size_t size) {
  const strut_key *k = strut_key_at(key);
  char text[400];
  const char *example;
  switch (k->type) {
    case STRUT_TYPE_NUMBER:
      if (k->measure == STRUT_MEASURE_CONTEXT)
        snprintf(buffer, size, "a number");
      else
        strut_expected_quantity(k->name, strut_measure_dimension(k->measure), buffer, size);
      break;
    case STRUT_TYPE_PAIR:
      example = strut_dimension_example(strut_measure_dimension(k->measure));
      snprintf(buffer, size, "two numbers such as [%s, 0]", example ? example : "1");
      break;
    case STRUT_TYPE_WORD: strut_words_text(k->words, buffer, size); break;
    case STRUT_TYPE_WORDS:
      snprintf(buffer, size, "a list of %s", strut_words_text(k->words, text, sizeof text));
      break;
    case STRUT_TYPE_KEEP:
      snprintf(buffer, size, "a list of %s, and of measured quantities",
               strut_words_text(k->words, text, sizeof text));
      break;
    case STRUT_TYPE_FIXED:
      snprintf(buffer, size, "%s, or a list of x and y",
               strut_words_text(k->words, text, sizeof text));
      break;
    case STRUT_TYPE_VERSION: return "the language version 1";
    case STRUT_TYPE_TEXT: return "a text";
    case STRUT_TYPE_NAME: return "a name";
    case STRUT_TYPE_NODE_PATH: return "two nodes such as [n1, n2], or the nodes of a running cable";
    case STRUT_TYPE_NODE_RING: return "three nodes or more such as [n1, n2, n3]";
    case STRUT_TYPE_NAME_PAIR: return "two names such as [a, b]";
    case STRUT_TYPE_NAMES: return "a list of names such as [a, b]";
    case STRUT_TYPE_NODE_TRIPLE: return "three nodes such as [n1, n2, n3]";
    case STRUT_TYPE_NUMBERS: return "a list of numbers";
    case STRUT_TYPE_POINTS: return "a list of points such as [[0, 0], [2 mm, 3 N]]";
    case STRUT_TYPE_PROFILE: return "a list of points such as [[0, 0], [10 mm, 0], [20 mm, 5 mm]]";
    case STRUT_TYPE_LAW:
      return "a law such as {kind: bilinear, knee: 2 mm, second_stiffness: 5 N/m}";
    case STRUT_TYPE_CONTACT_NODES: return "all, or a list of nodes such as [n1, n2]";
    case STRUT_TYPE_NODE_SETS: return "nodes such as [n1, n2], or a list of such lists";
    case STRUT_TYPE_GROUPS: return "a group, or a list of groups";
    case STRUT_TYPE_SIGNAL:
      return "a signal such as {sine: {amplitude: 1 mm, frequency: 10 Hz}}, or a signal's name";
    case STRUT_TYPE_SIGNALS: return "a list of signals";
    case STRUT_TYPE_TABLE: return "a list of points such as [[0 s, 0], [1 s, 2]]";
    case STRUT_TYPE_SETTLE: return "true, or a mapping such as {limit: 100 s}";
    case STRUT_TYPE_STEADY: return "true, or a mapping such as {tolerance: 0.5 %}";
    case STRUT_TYPE_EXPRESSION:
      if (k->measure == STRUT_MEASURE_CONTEXT)
        return "an expression of t and sensors such as '2 mm * sin(2*pi*10 Hz*t)'";
      return "an expression such as com.vy, n1.y - n2.y or m1.force";
    case STRUT_TYPE_AXES: return "a list of axes such as [{friction: [0.1, 0.2]}]";
    case STRUT_TYPE_TIMES: return "a list of times such as [0 s, 20 ms]";
    case STRUT_TYPE_FREE: return k->words;
    case STRUT_TYPE_MAP: return "a mapping {key: value, ...}";
    case STRUT_TYPE_THINGS: return "a mapping {name: ..., ...}";
  }
  return buffer;
}
