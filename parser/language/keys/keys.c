/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of the language and the look-ups in it. See keys.h. */
#include "parser/language/keys/keys.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/sample.h"
#include "engine/scene/study.h"
#include "parser/language/yaml/document.h"

/* clang-format off */
#define STRUT_BELOW(SECTION) STRUT_SECTION_##SECTION
#define STRUT_KEY_ROW(section, id, name, type, measure, range, fallback, need, set, words, field, \
                      description) \
  {STRUT_SECTION_##section, name, STRUT_TYPE_##type, STRUT_MEASURE_##measure, \
   STRUT_LIMITS_##range, fallback, STRUT_##need, set, words, {STRUT_FIELD_OF_##field}, description},
#define STRUT_ROWS_OF(NAME, name, rows, ...) rows(STRUT_KEY_ROW)
static const strut_key table[] = {STRUT_SECTIONS(STRUT_ROWS_OF)};
/* clang-format on */

/* One more ends the last. */
static const struct {
  int first; /* key */
  const char *name, *introduction;
} sections[] = {
#define STRUT_SECTION_ROW(NAME, name, rows, introduction)                                          \
  {STRUT_FIRST_OF_##NAME, name, introduction},
    STRUT_SECTIONS(STRUT_SECTION_ROW)
#undef STRUT_SECTION_ROW
        {STRUT_KEY_COUNT, NULL, NULL}};

const strut_section strut_group_sections[STRUT_GROUP_SECTIONS] = {
    STRUT_SECTION_MEMBER, STRUT_SECTION_NODE, STRUT_SECTION_CONTACT, STRUT_SECTION_HINGE};

const strut_key *strut_key_at(int key) {
  assert(key >= 0 && key < STRUT_KEY_COUNT);
  return &table[key];
}

int strut_section_first(strut_section section) {
  assert((unsigned)section < STRUT_SECTION_COUNT);
  return sections[section].first;
}
int strut_section_size(strut_section section) {
  return sections[section + 1].first - sections[section].first;
}
const char *strut_section_name(strut_section section) { return sections[section].name; }
const char *strut_section_introduction(strut_section section) {
  return sections[section].introduction;
}

int strut_key_find(strut_section section, const char *name) {
  for (int key = sections[section].first; key < sections[section + 1].first; key++)
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
    {STRUT_SECTION_NODE, "fixed", "true", "both", STRUT_SPELLING_SYNONYM},
    {STRUT_SECTION_NODE, "fixed", "xy", "both", STRUT_SPELLING_SYNONYM},
    {STRUT_SECTION_NODE, "fixed", "false", "none", STRUT_SPELLING_SYNONYM}};

/* Likely first guesses of keys, and the key that is meant; a dotted one is of another mapping. */
static const struct {
  strut_section section;
  const char *guesses, *meant;
} first_guesses[] = {
    {STRUT_SECTION_SCENE, "title|label", "name"},
    {STRUT_SECTION_SCENE, "params|variables|constants", "parameters"},
    {STRUT_SECTION_SCENE, "points|vertices|joints|masses", "nodes"},
    {STRUT_SECTION_SCENE, "elements|edges|links|cables|strings|springs|rods|struts", "members"},
    {STRUT_SECTION_SCENE, "material|materials|properties", "groups"},
    {STRUT_SECTION_SCENE, "fixed|supports|anchors|constraints|boundary", "nodes.NAME.fixed"},
    {STRUT_SECTION_SCENE, "g|gravitational_acceleration", "gravity"},
    {STRUT_SECTION_SCENE, "floor|surface|terrain|contact|contacts", "ground"},
    {STRUT_SECTION_SCENE, "friction|mu|friction_coefficient", "ground.friction"},
    {STRUT_SECTION_SCENE, "drive|drives|motor|motors|muscles|actuation", "actuators"},
    {STRUT_SECTION_SCENE, "force|forces", "loads"},
    {STRUT_SECTION_SCENE, "time|end_time|t_end|tspan", "run.duration"},
    {STRUT_SECTION_SCENE, "dt|timestep|time_step", "solver.step"},
    {STRUT_SECTION_NODE, "coordinates|coords|location|pos|at|x|y|xy", "position"},
    {STRUT_SECTION_NODE, "support|constraint|pinned|pin|anchor|anchored|fix|locked", "fixed"},
    {STRUT_SECTION_NODE, "m|weight", "mass"},
    {STRUT_SECTION_MEMBER, "type", "kind"},
    {STRUT_SECTION_MEMBER, "material", "group"},
    {STRUT_SECTION_MEMBER, "from|to|between|ends|connects|connect|points|start|end|i|j", "nodes"},
    {STRUT_SECTION_MEMBER, "k|spring_constant", "stiffness"},
    {STRUT_SECTION_MEMBER, "EA|E|A|area|modulus|youngs_modulus|cross_section", "axial_stiffness"},
    {STRUT_SECTION_MEMBER, "c|d|b|damper|viscosity", "damping"},
    {STRUT_SECTION_MEMBER, "m|weight|density|rho", "mass"},
    {STRUT_SECTION_MEMBER, "l0|L0|length|natural_length|unstretched_length", "rest_length"},
    {STRUT_SECTION_MEMBER, "preload|prestress|tension|force", "pretension"},
    {STRUT_SECTION_GROUND, "k", "stiffness"},
    {STRUT_SECTION_GROUND, "c|d|restitution", "damping"},
    {STRUT_SECTION_GROUND, "angle|incline|inclination", "slope"},
    {STRUT_SECTION_GROUND, "mu|mu_s|mu_k|friction_coefficient|coefficient_of_friction", "friction"},
    {STRUT_SECTION_FRICTION, "coefficient|friction_coefficient|value", "mu"},
    {STRUT_SECTION_SOLVER, "dt|timestep|time_step|step_size|stepsize|max_step|h", "step"},
    {STRUT_SECTION_SOLVER, "method|type|scheme|algorithm", "integrator"},
    {STRUT_SECTION_RUN, "time|length|end|until|end_time|total_time|t_end|tspan", "duration"},
    {STRUT_SECTION_STUDY, "title|name", "study"},
    {STRUT_SECTION_STUDY, "over|vary|sweep", "axes"},
    {STRUT_SECTION_FIGURE, "by", "series"}};

const char *strut_key_meant(strut_section section, const char *guess) {
  for (size_t i = 0; i < sizeof first_guesses / sizeof first_guesses[0]; i++)
    if (first_guesses[i].section == section &&
        strut_word_find(first_guesses[i].guesses, guess) >= 0)
      return first_guesses[i].meant;
  return NULL;
}

const strut_spelling *strut_spelling_find(strut_section section, const char *key,
                                          const char *text) {
  const strut_spelling *spelling;
  for (size_t i = 0; (spelling = strut_spelling_at(i)); i++)
    if (spelling->section == section && strcmp(spelling->other, text) == 0 &&
        (key && spelling->key ? strcmp(spelling->key, key) == 0 : key == spelling->key))
      return spelling;
  return NULL;
}

const strut_spelling *strut_spelling_at(size_t i) {
  return i < sizeof spellings / sizeof spellings[0] ? &spellings[i] : NULL;
}

int strut_spelling_index(const strut_spelling *spelling) { return (int)(spelling - spellings); }

const char *strut_key_current(strut_section section, const char *name) {
  const strut_spelling *spelling = strut_spelling_find(section, NULL, name);
  return spelling ? spelling->current : name;
}

strut_section strut_section_find(const char *name) {
  int section = 0;
  while (section < STRUT_SECTION_COUNT && strcmp(sections[section].name, name) != 0) section++;
  return (strut_section)section;
}

strut_dimension strut_measure_dimension(strut_measure measure) {
  switch (measure) {
#define MEASURE_ROW(MEASURE, dimension)                                                            \
  case STRUT_MEASURE_##MEASURE: return STRUT_DIM_##dimension;
    STRUT_MEASURES(MEASURE_ROW)
  }
  return STRUT_DIM_NONE;
}

/* ---- types ---- */

enum {
  STRUT_SHAPE_ANY = 0,
  STRUT_SHAPE_SCALAR = 1,
  STRUT_SHAPE_ALL = 2,
  STRUT_SHAPE_LIST = 4,
  STRUT_SHAPE_MAP = 8
};

static const struct type_row {
  unsigned shapes;
  uint32_t least, most;
  const char *schema, *expected, *reference;
} types[] = {
#define TYPE_ROW(TYPE, shapes, least, most, schema, expected, reference)                           \
  {STRUT_SHAPE_##shapes, least, most, schema, expected, reference},
    STRUT_KEY_TYPES(TYPE_ROW)};

const char *strut_type_shape(strut_key_type type) { return types[type].schema; }
const char *strut_type_reference(strut_key_type type) { return types[type].reference; }

bool strut_shape_fits(strut_key_type type, const strut_tree *value) {
  const struct type_row *row = &types[type];
  if (row->shapes == STRUT_SHAPE_ANY) return true;
  if (value->kind == STRUT_TREE_MAP) return row->shapes & STRUT_SHAPE_MAP;
  if (value->kind == STRUT_TREE_LIST)
    return row->shapes & STRUT_SHAPE_LIST && value->count >= row->least &&
           value->count <= row->most;
  return row->shapes & STRUT_SHAPE_ALL ? strcmp(value->text, "all") == 0
                                       : row->shapes & STRUT_SHAPE_SCALAR && !strut_is_null(value);
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
  size_t length = strcspn(words, "|");
  if (!*words) return NULL;
  if (length >= size) length = size - 1;
  memcpy(buffer, words, length);
  buffer[length] = '\0';
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
  const strut_dimension dimension = strut_measure_dimension(k->measure);
  const char *expected = types[k->type].expected, *example = strut_dimension_example(dimension);
  bool context = k->measure == STRUT_MEASURE_CONTEXT;
  char words[400];
  if (k->type == STRUT_TYPE_EXPRESSION && context)
    return "an expression of t and sensors such as '2 mm * sin(2*pi*10 Hz*t)'";
  if (expected) return expected;
  if (k->type == STRUT_TYPE_FREE) return k->words;
  if (k->type == STRUT_TYPE_NUMBER)
    return context ? "a number" : strut_expected_quantity(k->name, dimension, buffer, size);
  strut_words_text(k->words, words, sizeof words);
  if (k->type == STRUT_TYPE_PAIR)
    snprintf(buffer, size, "two numbers such as [%s, 0]", example ? example : "1");
  else if (k->type == STRUT_TYPE_WORDS)
    snprintf(buffer, size, "a list of %s", words);
  else if (k->type == STRUT_TYPE_KEEP)
    snprintf(buffer, size, "a list of %s, and of measured quantities", words);
  else if (k->type == STRUT_TYPE_FIXED)
    snprintf(buffer, size, "%s, or a list of x and y", words);
  else
    snprintf(buffer, size, "%s", words);
  return buffer;
}
