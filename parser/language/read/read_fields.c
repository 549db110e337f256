/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mappings by the table of keys: unknown keys, missing keys, typed values. See reader.h. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/reader.h"

strut_slot *strut_slot_of(strut_fields *fields, int key) {
  assert(strut_key_at(key)->section == fields->section);
  return &fields->slot[key - strut_section_first(fields->section)];
}

const strut_tree *strut_given(strut_fields *fields, int key) {
  const strut_slot *slot = strut_slot_of(fields, key);
  return slot->state == STRUT_GIVEN ? slot->value : NULL;
}

void strut_suppress_missing(strut_fields *fields) {
  for (int i = 0; i < strut_section_size(fields->section); i++)
    if (fields->slot[i].state == STRUT_ABSENT) fields->slot[i].state = STRUT_BROKEN;
}

/* The keys of some sections, one after the other, for suggestions. */
typedef struct sections_context {
  const strut_section *sections;
  size_t count;
} sections_context;

static int key_of_sections(const sections_context *sections, size_t i) {
  for (size_t r = 0; r < sections->count; r++) {
    size_t size = (size_t)strut_section_size(sections->sections[r]);
    if (i < size) return strut_section_first(sections->sections[r]) + (int)i;
    i -= size;
  }
  return -1;
}

static const char *name_of_sections(const void *context, size_t i) {
  int key = key_of_sections(context, i);
  return key < 0 ? NULL : strut_key_at(key)->name;
}

/* Suggests a known key for an unknown one; NULL if none is near. */
static const char *nearest_key(strut_reader *reader, const char *text,
                               const sections_context *context) {
  for (size_t i = 0; i < context->count; i++) {
    const char *meant = strut_key_meant(context->sections[i], text);
    if (meant) return meant;
  }
  if (strlen(text) > 64 || !strut_hints_left(reader)) return NULL;
  return strut_did_you_mean(text, name_of_sections, context);
}

/* Advice for keys that YAML made of something else: `mass:1 kg`, and `1,5 kg` within braces. */
static const char *punctuation_advice(const strut_tree *key) {
  bool number = key->text[0] >= '0' && key->text[0] <= '9';
  if (key->quoted || !strut_is_null(key->next)) return NULL;
  if (strut_lacks_space(key)) return "; write a space after the colon";
  return number ? "; within {...} a comma separates keys, and the decimal mark is a point" : NULL;
}

/* "; the keys here are 'a', 'b'" where there are few; "" where there are many, or enough has been said. */
static const char *known_keys(strut_reader *reader, const sections_context *context, char *text,
                              size_t size) {
  enum { MOST = 14 };
  size_t used = 0;
  text[0] = '\0';
  if (key_of_sections(context, MOST) >= 0 || !strut_hints_left(reader)) return text;
  for (size_t i = 0; key_of_sections(context, i) >= 0 && used < size; i++)
    used += (size_t)snprintf(text + used, size - used, "%s'%s'", i ? ", " : "; the keys here are ",
                             name_of_sections(context, i));
  return text;
}

/* Where a key belongs that is of another mapping of the scene; "" if there is none. */
static const char *other_home(const char *text) {
  static const struct {
    strut_section section;
    const char *advice;
  } homes[] = {{STRUT_SECTION_SCENE, "; it belongs beside 'nodes', to the whole scene"},
               {STRUT_SECTION_SOLVER, "; it belongs under 'solver'"},
               {STRUT_SECTION_RUN, "; it belongs under 'run'"},
               {STRUT_SECTION_INITIAL, "; it belongs under 'initial'"},
               {STRUT_SECTION_OUTPUT, "; it belongs under 'output'"},
               {STRUT_SECTION_MEASURE, "; it belongs under 'measure' of 'run'"},
               {STRUT_SECTION_SIGNAL, "; it belongs under 'signal'"}};
  for (size_t i = 0; i < sizeof homes / sizeof homes[0]; i++)
    if (strut_key_find(homes[i].section, text) >= 0) return homes[i].advice;
  return "";
}

int strut_unknown_key(strut_reader *reader, const strut_tree *key, const strut_section *sections,
                      size_t count, strut_owner owner) {
  sections_context context = {sections, count};
  const char *advice = punctuation_advice(key);
  const char *near = advice ? NULL : nearest_key(reader, key->text, &context);
  char others[400];
  if (!advice) advice = near ? "" : other_home(key->text);
  if (!*advice && !near) advice = known_keys(reader, &context, others, sizeof others);
  strut_report_error(reader, key->place, "unknown key '%s' in %s%s%s%s%s",
                     strut_sanitised_text(reader, key->text), strut_owner_text(reader, owner),
                     advice, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
  for (int i = 0; key_of_sections(&context, (size_t)i) >= 0; i++) {
    int meant = key_of_sections(&context, (size_t)i);
    const char *name = strut_key_at(meant)->name;
    if (near ? strcmp(name, near) == 0 : strut_lacks_space_after(key, name)) return meant;
  }
  return -1;
}

/* A former name is noted where it is met first. */
static void note_spelling(strut_reader *reader, const strut_spelling *spelling, strut_place place) {
  if (spelling->kind != STRUT_SPELLING_FORMER) return;
  unsigned bit = 1u << strut_spelling_index(spelling);
  if (reader->spellings & bit) return;
  reader->spellings |= bit;
  strut_note(reader->diagnostics, place, "'%s' is now called '%s'", spelling->other,
             spelling->current);
}

int strut_key_named(strut_reader *reader, strut_section section, const strut_tree *key) {
  int found = strut_key_find(section, key->text);
  if (found >= 0) return found;
  const strut_spelling *spelling = strut_spelling_find(section, NULL, key->text);
  if (!spelling) return -1;
  note_spelling(reader, spelling, key->place);
  return strut_key_find(section, spelling->current);
}

/* The words of a key, for suggestions. */
typedef struct words_context {
  char word[64][24];
  int count;
} words_context;

static const char *name_of_words(const void *context, size_t i) {
  const words_context *words = context;
  return i < (size_t)words->count ? words->word[i] : NULL;
}

bool strut_read_word(strut_reader *reader, const strut_key *key, const strut_tree *value,
                     strut_owner owner, int *word) {
  char expected[400];
  if (value->kind == STRUT_TREE_SCALAR && (*word = strut_word_find(key->words, value->text)) >= 0)
    return true; /* scenes of a study are read by the million */
  const strut_spelling *other = value->kind == STRUT_TREE_SCALAR
                                    ? strut_spelling_find(key->section, key->name, value->text)
                                    : NULL;
  if (other) {
    note_spelling(reader, other, value->place);
    *word = strut_word_find(key->words, other->current);
    return true;
  }
  bool may_switch = value->kind == STRUT_TREE_SCALAR && !value->quoted;
  if (may_switch && strcmp(key->words, "no|yes") == 0 &&
      (*word = strut_switch_find(value->text)) >= 0)
    return true;
  strut_words_text(key->words, expected, sizeof expected);
  if (!strut_read_scalar(reader, value, key->name, owner, expected)) return false;
  words_context words = {.count = 0};
  while (words.count < 64 &&
         strut_word_at(key->words, words.count, words.word[words.count], sizeof words.word[0]))
    words.count++;
  return strut_report_error(reader, value->place, "expected %s for '%s' of %s, found '%s'%s",
                            expected, key->name, strut_owner_text(reader, owner),
                            strut_sanitised_text(reader, value->text),
                            strut_hint(reader, value->text, name_of_words, &words));
}

/* A list of words without repetition; bits gets one bit for each. */
static bool read_words(strut_reader *reader, const strut_key *key, const strut_tree *value,
                       strut_owner owner, uint64_t *bits) {
  bool fine = true;
  *bits = 0;
  for (const strut_tree *item = value->first; item; item = item->next) {
    int word;
    if (!strut_read_word(reader, key, item, owner, &word)) {
      fine = false;
    } else if (*bits >> word & 1u) {
      fine = strut_report_error(reader, item->place, "'%s' appears twice in '%s' of %s", item->text,
                                key->name, strut_owner_text(reader, owner));
    } else {
      *bits |= (uint64_t)1 << word;
    }
  }
  return fine;
}

/* Supports: none, x, y, both, or a list of x and y. Bit 1: x, bit 2: y. */
static bool read_fixed(strut_reader *reader, const strut_key *key, const strut_tree *value,
                       strut_owner owner, int *bits) {
  if (value->kind != STRUT_TREE_LIST) return strut_read_word(reader, key, value, owner, bits);
  strut_key in_list = *key;
  in_list.words = "x|y";
  uint64_t both;
  bool fine = read_words(reader, &in_list, value, owner, &both);
  *bits = (int)both;
  return fine;
}

bool strut_refuse_form(strut_reader *reader, int key, const strut_tree *value, strut_owner owner) {
  char expected[300], keys[400] = "";
  strut_section below = strut_section_below(strut_key_at(key));
  if (strut_key_at(key)->type == STRUT_TYPE_MAP && below != STRUT_SECTION_COUNT)
    known_keys(reader, &(sections_context){&below, 1}, keys, sizeof keys);
  return strut_report_error(reader, value->place, "expected %s for '%s' of %s, found %s%s",
                            strut_key_expected(key, expected, sizeof expected),
                            strut_key_at(key)->name, strut_owner_text(reader, owner),
                            strut_found(reader, value),
                            strut_lacks_space(value) ? "; write a space after the colon" : keys);
}

static bool read_version(strut_reader *reader, const strut_tree *value) {
  if (strcmp(value->text, "1") == 0) return true;
  return strut_report_error(reader, value->place,
                            "expected the language version 1 for 'strut', found '%s'; "
                            "this program knows version 1 only",
                            strut_sanitised_text(reader, value->text));
}

/* A plain number above a whole turn, or 45 deg of a slope, is in radians, and probably meant in degrees. */
static void note_radians(strut_reader *reader, const strut_key *key, const strut_tree *value,
                         double angle) {
  const char *text = value->text;
  double most = key == strut_key_at(STRUT_KEY_GROUND_SLOPE) ? STRUT_TAU / 8 : STRUT_TAU;
  if (fabs(angle) > most && strut_number_scan(text, strlen(text)) == strlen(text))
    strut_note(reader->diagnostics, value->place,
               "a %s of %s is in radians, %.6g deg; write '%s deg' if that is meant", key->name,
               text, angle * 360.0 / STRUT_TAU, text);
}

static bool read_number(strut_reader *reader, const strut_key *key, const strut_tree *value,
                        strut_owner owner, double *number) {
  if (key->measure == STRUT_MEASURE_CONTEXT) return true;
  bool fine = strut_read_number(reader, value, key->name, owner,
                                strut_measure_dimension(key->measure), key->limits, number);
  if (fine && key->measure == STRUT_MEASURE_ANGLE) note_radians(reader, key, value, *number);
  return fine;
}

/* Reads a value whose type needs no code of the section's own; false if it was reported. */
static bool read_typed(strut_reader *reader, const strut_key *key, const strut_tree *value,
                       strut_owner owner, strut_slot *slot) {
  strut_key_type type = key->type;
  if (key->limits.range == STRUT_RANGE_COUNT &&
      !strut_check_limits(reader, value, key->name, owner, key->limits, value->count))
    return false;
  if (type == STRUT_TYPE_VERSION) return read_version(reader, value);
  if (type == STRUT_TYPE_NUMBER && key->section == STRUT_SECTION_SCENE) return true; /* as pairs */
  if (type == STRUT_TYPE_NUMBER) return read_number(reader, key, value, owner, slot->number);
  if (type == STRUT_TYPE_WORD) return strut_read_word(reader, key, value, owner, &slot->word);
  if (type == STRUT_TYPE_WORDS) return read_words(reader, key, value, owner, &slot->words);
  if (type == STRUT_TYPE_FIXED) return read_fixed(reader, key, value, owner, &slot->word);
  if (type != STRUT_TYPE_PAIR || key->section == STRUT_SECTION_SCENE || /* no parameters yet */
      key->measure == STRUT_MEASURE_CONTEXT)
    return true;
  return strut_read_pair(reader, value, key->name, owner, strut_measure_dimension(key->measure),
                         slot->number);
}

void strut_read_slot(strut_reader *reader, int key, const strut_tree *key_tree,
                     const strut_tree *value, strut_owner owner, strut_slot *slot) {
  const strut_key *k = strut_key_at(key);
  *slot = (strut_slot){.key = key_tree, .value = value};
  bool bodies = key == STRUT_KEY_SCENE_COLLISIONS && value->kind == STRUT_TREE_SCALAR;
  if (bodies && strcmp(value->text, "all") == 0) return; /* strut_read_bodies takes it */
  bool fine = strut_shape_fits(k->type, value) ? read_typed(reader, k, value, owner, slot)
                                               : strut_refuse_form(reader, key, value, owner);
  slot->state = fine ? STRUT_GIVEN : STRUT_BROKEN;
}

/* Another key of the same set that the mapping itself gives, or NULL. */
static const strut_tree *rival(const strut_fields *fields, int key) {
  int set = strut_key_at(key)->set;
  if (!set) return NULL;
  int first = strut_section_first(fields->section), size = strut_section_size(fields->section);
  const strut_key *keys = strut_key_at(first);
  for (int i = 0; i < size; i++)
    if (first + i != key && keys[i].set == set && fields->slot[i].key) return fields->slot[i].key;
  return NULL;
}

static void read_pair_of_map(strut_reader *reader, strut_fields *fields,
                             const strut_tree *key_tree) {
  int key = strut_key_named(reader, fields->section, key_tree);
  if (key < 0) {
    int meant = strut_unknown_key(reader, key_tree, &fields->section, 1, fields->owner);
    fields->broken = fields->strange = true;
    if (meant >= 0 && strut_slot_of(fields, meant)->state == STRUT_ABSENT)
      strut_slot_of(fields, meant)->state = STRUT_BROKEN;
    return;
  }
  strut_slot *slot = strut_slot_of(fields, key);
  const strut_tree *other = slot->key ? slot->key : rival(fields, key); /* or by its former name */
  strut_read_slot(reader, key, key_tree, key_tree->next, fields->owner, slot);
  if (other) {
    strut_report_error(reader, key_tree->place, "%s gives both '%s' and '%s', expected one of them",
                       strut_owner_text(reader, fields->owner), other->text, key_tree->text);
    slot->state = STRUT_BROKEN;
  }
  if (slot->state == STRUT_BROKEN) fields->broken = true;
}

void strut_read_fields(strut_reader *reader, strut_section section, const strut_tree *map,
                       strut_owner owner, strut_fields *fields) {
  *fields = (strut_fields){.section = section, .owner = owner, .map = map};
  if (map->kind != STRUT_TREE_MAP) {
    const bool file = section == STRUT_SECTION_DATA && map->kind == STRUT_TREE_SCALAR;
    strut_report_error(reader, map->place,
                       "expected a mapping {key: value, ...} for %s, found %s%s",
                       strut_owner_text(reader, owner), strut_found(reader, map),
                       strut_lacks_space(map) ? "; write a space after the colon"
                       : file                 ? "; write {file: NAME.csv}"
                                              : "");
    fields->broken = true;
    strut_suppress_missing(fields);
    return;
  }
  for (const strut_tree *tree = map->first; tree; tree = tree->next->next)
    read_pair_of_map(reader, fields, tree);
}

void strut_read_fields_of(strut_reader *reader, strut_section section, const strut_tree *key,
                          strut_owner owner, strut_fields *fields) {
  strut_read_fields(reader, section, key->next, owner, fields);
  fields->key = key;
}

void strut_require(strut_reader *reader, strut_fields *fields, strut_place place) {
  int first = strut_section_first(fields->section), size = strut_section_size(fields->section);
  const strut_key *keys = strut_key_at(first);
  for (int i = 0; i < size; i++) {
    char expected[300];
    strut_slot *slot = &fields->slot[i];
    if (slot->state != STRUT_ABSENT || keys[i].need != STRUT_REQUIRED) continue;
    if (!reader->holes)
      strut_report_error(reader, place, "%s lacks '%s', expected %s",
                         strut_owner_text(reader, fields->owner), strut_key_at(first + i)->name,
                         strut_key_expected(first + i, expected, sizeof expected));
    slot->state = STRUT_BROKEN;
    fields->broken = true;
  }
}

bool strut_read_section(strut_reader *reader, int key, strut_section section, const char *owner,
                        strut_fields *fields) {
  const strut_slot *slot = strut_slot_of(&reader->top, key);
  *fields = (strut_fields){.section = section, .broken = slot->state == STRUT_BROKEN};
  if (fields->broken) strut_suppress_missing(fields);
  if (slot->state != STRUT_GIVEN) return false;
  strut_read_fields(reader, section, slot->value, (strut_owner){owner, NULL}, fields);
  fields->key = slot->key;
  return true;
}

const strut_tree *strut_entries(strut_reader *reader, int key) {
  return strut_given(&reader->top, key);
}

size_t strut_entry_count(strut_reader *reader, int key) {
  const strut_tree *map = strut_entries(reader, key);
  return map ? map->count : 0;
}

/* ---- keys that mean nothing without another one ---- */

/* `key` has a meaning beside one of `words`: of the key `other`, in the mapping or the one around it; -1: keys. */
typedef struct companion {
  int key, other;
  const char *words;
} companion;

#define WITH(section, key, around, other, words)                                                   \
  { STRUT_KEY_##section##_##key, STRUT_KEY_##around##_##other, words }
#define BESIDE(section, key, keys)                                                                 \
  { STRUT_KEY_##section##_##key, -1, keys }
#define OF_FIGURE(key, kinds) WITH(FIGURE, key, FIGURE, KIND, kinds)
#define OF_STUDY(section, key, computed) WITH(section, key, STUDY, COMPUTE, computed)

static const companion companions[] = {
    BESIDE(MEMBER, GUIDE_SIDE, "guide_radius"),
    WITH(GAS, EXPONENT, GAS, KIND, "isentropic"),
    BESIDE(CELL, REST_AREA, "stiffness|law"),
    BESIDE(DISTANCE, REST_DISTANCE, "stiffness|law"),
    WITH(LAW, SMOOTH, LAW, KIND, "table"),
    WITH(LAW, MIRRORED, LAW, KIND, "table|curve"),
    WITH(LAW, ROUNDING, LAW, KIND, "curve"),
    WITH(LAW, DATA, LAW, KIND, "table"),
    BESIDE(LAW, OVER, "data"),
    BESIDE(SIGNAL, OVER, "data"),
    BESIDE(SIGNAL, INTERPOLATION, "data"),
    BESIDE(SIGNAL, OUTSIDE, "data"),
    BESIDE(SENSOR, ALONG, "position|velocity"),
    BESIDE(OSCILLATOR, BIAS, "coupling"),
    BESIDE(REPEAT, ABOUT, "turn|scale"),
    BESIDE(RUN, OF, "periods"),
    BESIDE(RUBBING, MU_STATIC, "decay_velocity"),
    BESIDE(RUBBING, DECAY_VELOCITY, "mu_static"),
    WITH(QUANTITY, TARGET, QUANTITY, TAKE, "arrival"),
    OF_STUDY(STUDY, LOWEST, "equilibria|modes"),
    OF_STUDY(STUDY, AT, "modes|rigidity|path"),
    OF_STUDY(STUDY, PATH, "path"),
    OF_STUDY(STUDY, FORM, "form"),
    OF_STUDY(STUDY, CHECK, "run"),
    OF_STUDY(STUDY, TRAJECTORIES, "run"),
    OF_STUDY(STUDY, STIFFNESS_AT, "modes"),
    OF_STUDY(STUDY, SHAPE, "run|equilibria|modes"),
    OF_STUDY(STUDY, LIKE, "run|equilibria|modes"),
    OF_STUDY(STUDY, CURVE, "path"),
    OF_STUDY(LIMIT, EVALUATIONS, "run"),
    OF_STUDY(LIMIT, TIME, "run|equilibria"),
    OF_FIGURE(AT_X, "lines|map|motion|points"),
    OF_FIGURE(AT_Y, "lines|map|motion|points"),
    OF_FIGURE(SERIES, "lines|motion|best"),
    OF_FIGURE(COLOR, "map|points"),
    OF_FIGURE(PANELS, "lines|map|motion|best"),
    OF_FIGURE(BAND, "lines|motion"),
    OF_FIGURE(DIFFERENCE, "lines|map|motion|period|snapshots"),
    OF_FIGURE(FROM, "motion"),
    OF_FIGURE(TO, "motion"),
    OF_FIGURE(SCALE, "period"),
    OF_FIGURE(TIMES, "snapshots"),
    OF_FIGURE(LABELS, "lines|motion|best"),
    OF_FIGURE(X_LABEL, "lines|map|motion|best|points"),
    OF_FIGURE(Y_LABEL, "lines|map|motion|best|points"),
    OF_FIGURE(X_LIMITS, "lines|map|motion|best|points"),
    OF_FIGURE(Y_LIMITS, "lines|map|motion|best|points"),
    OF_FIGURE(COLORS, "map|points"),
    WITH(SEARCH, SEED, SEARCH, METHOD,
         "multistart|crs2|isres|cobyla|bobyqa|sbplx|neldermead|cma|nsga2")};

enum { COMPANIONS = sizeof companions / sizeof companions[0] };

/* Is the key beside, or the other's word one of the words? What could not be read is. */
static bool is_met(strut_fields *fields, const companion *self, const strut_slot **other) {
  char word[40];
  bool beside = false;
  for (int i = 0; self->other < 0 && strut_word_at(self->words, i, word, sizeof word); i++)
    beside = beside || strut_slot_of(fields, strut_key_find(fields->section, word))->state;
  if (self->other < 0) return beside;
  const strut_key *key = strut_key_at(self->other);
  while (fields && fields->section != key->section) fields = fields->outer;
  if (!fields) return true;
  if (self->other == STRUT_KEY_STUDY_COMPUTE &&
      strut_slot_of(fields, STRUT_KEY_STUDY_FIT)->state != STRUT_ABSENT)
    return true; /* its matches compute several things: study_fit.c */
  *other = strut_slot_of(fields, self->other);
  if ((*other)->state == STRUT_BROKEN) return true;
  if ((*other)->state == STRUT_ABSENT) return strut_word_find(self->words, key->fallback) >= 0;
  return strut_word_at(key->words, (*other)->word, word, sizeof word) &&
         strut_word_find(self->words, word) >= 0;
}

static bool check_companions(strut_reader *reader, strut_fields *fields) {
  bool fine = true;
  for (const companion *c = companions; c < companions + COMPANIONS; c++) {
    const strut_slot *other = NULL;
    char words[200];
    if (strut_key_at(c->key)->section != fields->section) continue;
    strut_slot *slot = strut_slot_of(fields, c->key);
    if (slot->state != STRUT_GIVEN || is_met(fields, c, &other)) continue;
    if (slot->from || (other && other->key && slot->key->place.file != other->key->place.file)) {
      slot->state = STRUT_ABSENT; /* a group's is for others, a base's for its own kind */
      continue;
    }
    strut_report_error(reader, slot->key->place, "'%s' of %s has no meaning without %s%s%s",
                       slot->key->text, strut_owner_text(reader, fields->owner),
                       c->other < 0 ? "" : strut_key_at(c->other)->name, c->other < 0 ? "" : ": ",
                       strut_words_text(c->words, words, sizeof words));
    slot->state = STRUT_BROKEN;
    fields->broken = true;
    fine = false;
  }
  return fine;
}

const char *strut_study_key_computes(int key) {
  for (const companion *c = companions; c < companions + COMPANIONS; c++)
    if (c->key == key && c->other == STRUT_KEY_STUDY_COMPUTE) return c->words;
  return NULL;
}

/* ---- keys that go together ---- */

typedef struct rule {
  strut_section section;
  const char *given;
  enum { NEEDS, ONLY, WANTS, FORBIDS } kind;
  const char *keys, *message;
} rule;

static const rule rules[] = {
#define RULE_ROW(section, given, kind, keys, message)                                              \
  {STRUT_SECTION_##section, given, kind, keys, message},
    STRUT_KEY_RULES(RULE_ROW)};

/* The slot of the i-th of "a|b" where the mapping has that key, or else NULL. */
static strut_slot *mentioned(strut_fields *fields, const char *keys, int i) {
  char name[40];
  if (!strut_word_at(keys, i, name, sizeof name)) return NULL;
  strut_slot *slot = strut_slot_of(fields, strut_key_find(fields->section, name));
  return slot->state != STRUT_ABSENT ? slot : NULL;
}

static int count_words(const char *keys) {
  int count = *keys != '\0';
  for (; *keys; keys++) count += *keys == '|';
  return count;
}

static int count_mentioned(strut_fields *fields, const char *keys) {
  int count = 0;
  for (int i = count_words(keys); i-- > 0;) count += mentioned(fields, keys, i) != NULL;
  return count;
}

/* Has the mapping one of the alternatives, and where that is so wanted none of the other keys? */
static bool has_alternative(strut_fields *fields, const rule *self) {
  char all[240], one[240];
  snprintf(all, sizeof all, "%s", self->keys);
  for (char *c = all; *c; c++) *c = *c == '+' ? '|' : *c;
  const int mentions = count_mentioned(fields, all);
  for (int i = 0; strut_word_at(self->keys, i, one, sizeof one); i++) {
    for (char *c = one; *c; c++) *c = *c == '+' ? '|' : *c;
    const int count = count_words(one);
    if (count_mentioned(fields, one) == count && (self->kind != ONLY || mentions == count))
      return true;
  }
  return false;
}

static void report_rule(strut_reader *reader, const strut_fields *fields, const rule *self,
                        strut_place place, const strut_slot *given, const strut_slot *key) {
  char text[600];
  size_t used = 0;
  for (const char *c = self->message; *c && used < sizeof text; c++) {
    const bool insert = *c == '%';
    if (insert) c++;
    const char *part = !insert     ? (const char[]){*c, '\0'}
                       : *c == 'o' ? strut_owner_text(reader, fields->owner)
                       : *c == 'k' ? key->key->text
                       : *c == 'g' ? given->key->text
                                   : strut_sanitised_text(reader, given->value->text);
    used += (size_t)snprintf(text + used, sizeof text - used, "%s", part);
  }
  strut_report_text(reader, place, self->message, text);
}

static bool check_rule(strut_reader *reader, strut_fields *fields, const rule *self) {
  const int keys = count_words(self->given);
  const strut_slot *given = NULL;
  bool fine = true;
  for (int i = 0; i < keys && !(given && given->state == STRUT_GIVEN); i++)
    given = mentioned(fields, self->given, i);
  if (keys && !(given && given->state == STRUT_GIVEN)) return true;
  for (int i = 0; self->kind == FORBIDS && i < count_words(self->keys); i++) {
    const strut_slot *key = mentioned(fields, self->keys, i);
    if (!key || !key->key) continue;
    report_rule(reader, fields, self, key->key->place, given, key);
    fine = false;
  }
  if (self->kind == FORBIDS || fields->strange || reader->holes || has_alternative(fields, self))
    return fine;
  const strut_tree *whole = fields->key && !fields->outer ? fields->key : fields->map;
  const strut_tree *at = self->kind == WANTS ? given->key : whole;
  report_rule(reader, fields, self, at->place, given, NULL);
  return false;
}

bool strut_check_rules(strut_reader *reader, strut_fields *fields) {
  bool fine = check_companions(reader, fields);
  for (const rule *r = rules; r < rules + sizeof rules / sizeof rules[0]; r++)
    if (r->section == fields->section) fine = check_rule(reader, fields, r) && fine;
  if (!fine) fields->broken = true;
  return fine;
}
