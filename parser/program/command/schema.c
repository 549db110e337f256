/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One walk over the table of keys: a section becomes a definition, a key a property of it. Editors show
 * a property's own description only, never that of a definition behind it, and report alternatives
 * ("anyOf") vaguely; so every property has its description, and alternatives are "if type ... then".
 */
#include "parser/program/command/arguments.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/result_values.h"
#include "parser/language/write/writer.h"

enum { DEEPEST = 64 };

typedef struct schema {
  strut_json json;
  struct cJSON *open[DEEPEST]; /* (depth + 1) objects and lists */
  int depth;
  bool wanted[STRUT_SECTION_COUNT]; /* something refers to it */
  bool study;
} schema;

/* ---- fragments: members of an object that is open ---- */

static void put_member(schema *self, const char *key, const char *raw) {
  strut_json_raw(&self->json, self->open[self->depth], key, raw);
}

static void put_text_member(schema *self, const char *key, const char *text) {
  strut_json_text(&self->json, self->open[self->depth], key, text);
}

/* Without a key in a list. */
static void open_object(schema *self, const char *key) {
  assert(self->depth + 1 < DEEPEST);
  self->open[self->depth + 1] = strut_json_object(&self->json, self->open[self->depth], key);
  self->depth++;
}

static void open_list(schema *self, const char *key) {
  assert(self->depth + 1 < DEEPEST);
  self->open[self->depth + 1] = strut_json_array(&self->json, self->open[self->depth], key);
  self->depth++;
}

/* Object or list. */
static void close_object(schema *self) { self->depth--; }

static void refer_to(schema *self, const char *definition) {
  char text[80] = "#/definitions/";
  strncat(text, definition, sizeof text - strlen(text) - 1);
  put_text_member(self, "$ref", text);
}

/* A list of words that is left open. */
static void open_words(schema *self, const char *words) {
  char word[40];
  open_list(self, "enum");
  for (int i = 0; strut_word_at(words, i, word, sizeof word); i++)
    put_text_member(self, NULL, word);
}

/* The words of a key with its synonyms and former words. */
static void put_words(schema *self, const strut_key *key) {
  const strut_spelling *spelling;
  open_words(self, key->words);
  for (size_t i = 0; (spelling = strut_spelling_at(i)); i++)
    if (spelling->section == key->section && spelling->key && strcmp(spelling->key, key->name) == 0)
      put_text_member(self, NULL, spelling->other);
  if (strcmp(key->words, "no|yes") == 0) {
    put_member(self, NULL, "false");
    put_member(self, NULL, "true");
  }
  close_object(self);
}

/* With a base `remove` takes away a thing, or a whole mapping. */
static void open_unless_removed(schema *self) {
  put_member(self, "if", "{\"const\": \"remove\"}");
  open_object(self, "else");
}

/* ---- what a value may be, as a text ---- */

/*
 * n a number, or an expression in a text; the schema does not say which texts are expressions s a scalar: YAML makes
 * numbers and switches of names and texts such as 1 and true, strut takes them as written w a word of the key k a word
 * of the key, or another text l a word of a law; x an axis of a study; t a thing of the key =[...]= one of these values
 * <section> an object with the keys of a section, or of a group [LMx] a list of L to M items x; M 0: any number {x} an
 * object whose members are x {!x} likewise named things, which a scene with a base may remove {1} an object of one
 * member A(x|y) x for a list, y for all others; O(x|y): x for an object; K(x|y): for one with the key `network`; R(x|y)
 * for one of the kind `relay`
 */
#define ALONG "A([00s]|<range>)"
#define PLACE "A([22n]|<row of data>)"

static const char *put_shape(schema *self, const strut_key *key, const char *shape);
static void put_thing(schema *self, const strut_key *key);

/* What the shape says in an object of its own; returns what follows the shape. */
static const char *put_within(schema *self, const char *name, const strut_key *key,
                              const char *shape) {
  open_object(self, name);
  shape = put_shape(self, key, shape);
  close_object(self);
  return shape;
}

static void put_law_word(schema *self) {
  open_words(self, strut_key_at(STRUT_KEY_LAW_KIND)->words);
  put_text_member(self, NULL, "tension_only");
  put_text_member(self, NULL, "compression_only");
  close_object(self);
}

/* An axis of a study: one parameter, or one of the forms for several. */
static void put_axis(schema *self) {
  put_member(self, "type", "\"object\"");
  put_member(self, "minProperties", "1");
  open_object(self, "properties");
  open_object(self, "zip");
  put_text_member(self, "description", "Parameters that vary together.");
  put_member(self, "type", "[\"object\", \"array\"]");
  put_within(self, "additionalProperties", NULL, ALONG);
  close_object(self);
  open_object(self, "points");
  put_text_member(self, "description",
                  "A CSV file with a row for each value, or the keys of points.");
  put_shape(self, NULL, "O(<points>|A([00s]|s))");
  close_object(self);
  open_object(self, "sample");
  put_text_member(self, "description", "Parameters from distributions.");
  put_shape(self, NULL, "<sample>");
  close_object(self);
  close_object(self);
  put_within(self, "additionalProperties", NULL, ALONG);
}

/* [LMx] */
static const char *put_list(schema *self, const strut_key *key, const char *shape) {
  const char least[] = {shape[0], '\0'}, most[] = {shape[1], '\0'};
  put_member(self, "type", "\"array\"");
  shape = put_within(self, "items", key, shape + 2);
  if (*least > '0') put_member(self, "minItems", least);
  if (*most > '0') put_member(self, "maxItems", most);
  return shape + 1;
}

/* {x}, {!x} or {1} */
static const char *put_members(schema *self, const strut_key *key, const char *shape) {
  bool one = *shape == '1', things = *shape == '!', removable = things && !self->study;
  if (removable) open_unless_removed(self);
  put_member(self, "type", "\"object\"");
  if (one) put_member(self, "maxProperties", "1");
  if (things)
    put_member(self, "propertyNames",
               "{\"pattern\": \"^[-A-Za-z0-9_.*\\\\u0080-\\\\uffff]{1,255}$\"}");
  if (!one) shape = put_within(self, "additionalProperties", key, shape + things) - 1;
  if (removable) close_object(self);
  return shape + 2;
}

/* One form for values of one kind, another for all others: A(x|y) and its like. */
static const char *put_either(schema *self, const strut_key *key, char kind, const char *shape) {
  open_object(self, "if");
  put_member(self, "type", kind == 'A' ? "\"array\"" : "\"object\"");
  if (kind == 'K') put_member(self, "required", "[\"network\"]");
  if (kind == 'R') put_member(self, "required", "[\"kind\"]");
  if (kind == 'R') put_member(self, "properties", "{\"kind\": {\"const\": \"relay\"}}");
  close_object(self);
  shape = put_within(self, "then", key, shape + 1);
  return put_within(self, "else", key, shape + 1) + 1;
}

static const char *put_section(schema *self, const char *shape) {
  char name[40];
  size_t length = strcspn(shape, ">");
  snprintf(name, sizeof name, "%.*s", (int)length, shape);
  for (int i = 0; i < STRUT_SECTION_COUNT; i++)
    if (strcmp(strut_section_name((strut_section)i), name) == 0) self->wanted[i] = true;
  refer_to(self, name);
  return shape + length + 1;
}

/* Adds what the text says to the open object; returns what follows. */
static const char *put_shape(schema *self, const strut_key *key, const char *shape) {
  char values[120];
  size_t length = strcspn(shape + 1, "=");
  switch (*shape++) {
    case 'n': put_member(self, "type", "[\"number\", \"string\"]"); return shape;
    case 's': put_member(self, "type", "[\"string\", \"number\", \"boolean\"]"); return shape;
    case 'w': put_words(self, key); return shape;
    case 'l': put_law_word(self); return shape;
    case 'x': put_axis(self); return shape;
    case 't': put_thing(self, key); return shape;
    case 'k':
      open_list(self, "anyOf");
      open_object(self, NULL);
      put_words(self, key);
      close_object(self);
      put_within(self, NULL, key, "s");
      close_object(self);
      return shape;
    case '=':
      snprintf(values, sizeof values, "%.*s", (int)length, shape);
      put_member(self, "enum", values);
      return shape + length + 1;
    case '<': return put_section(self, shape);
    case '[': return put_list(self, key, shape);
    case '{': return put_members(self, key, shape);
    default: return put_either(self, key, shape[-1], shape);
  }
}

/* ---- what the value of a key may be ---- */

typedef struct named_shape {
  const char *name, *shape;
} named_shape;

static const char *find_shape(const named_shape *shapes, const char *name) {
  while (shapes->name && strcmp(shapes->name, name) != 0) shapes++;
  return shapes->shape;
}

/* Keys of several forms, and of others numbers. */
static const named_shape free_shapes[] = {{"mu", "O(<signal>|s)"},
                                          {"merge", "O({s}|=[\"touching\"]=)"},
                                          {"repeat", "O(<repeat>|n)"},
                                          {"count", "A([22n]|n)"},
                                          {"next", "A([22<next>]|<next>)"},
                                          {"closed", "O({s}|=[true, false, \"yes\", \"no\"]=)"},
                                          {"between", "A([22s]|s)"},
                                          {"load", "A([00s]|s)"},
                                          {"inputs", "[10s]"},
                                          {"path", "<path in stages>"},
                                          {"stages", "[10<stage>]"},
                                          {"stop", "{1}"},
                                          {"lattice", "[12[22n]]"},
                                          {"step", "[22A([22n]|n)]"},
                                          {"correlation", "[10[10n]]"},
                                          {NULL, "n"}};

/* The things of a mapping: its name decides, wherever it stands. */
static const named_shape thing_shapes[] = {
    {"groups", "<group>"}, {"parameters", "s"},     {"set", "s"},
    {"derive", "s"},       {"ports", "s"},          {"onto", "s"},
    {"merge", "s"},        {"coupling", "n"},       {"shape", PLACE},
    {"positions", PLACE},  {"velocities", "[22n]"}, {"units", "s"},
    {NULL, NULL}};

static const named_shape section_shapes[] = {{"node", "A([22n]|<node>)"},
                                             {"signal", "O(<signal>|s)"},
                                             {"quantity", "O(<quantity>|n)"},
                                             {"controller", "R(<relay>|K(<network>|<controller>))"},
                                             {NULL, NULL}};

/* ---- keys ---- */

/* Things of any section but these are objects with its keys. */
static void put_thing(schema *self, const strut_key *key) {
  const char *shape = find_shape(thing_shapes, key->name);
  if (!shape && key == strut_key_at(STRUT_KEY_SEARCH_OVER)) shape = "A([00s]|<variable>)";
  if (!shape && key == strut_key_at(STRUT_KEY_SEARCH_WORST_OVER)) shape = ALONG;
  strut_section section = shape ? STRUT_SECTION_COUNT : strut_section_below(key);
  if (section != STRUT_SECTION_COUNT)
    shape = find_shape(section_shapes, strut_section_name(section));
  if (shape)
    put_shape(self, key, shape);
  else if (section != STRUT_SECTION_COUNT)
    put_section(self, strut_section_name(section));
}

static void put_value(schema *self, const strut_key *key) {
  if (key->type == STRUT_TYPE_MAP) {
    put_section(self, strut_section_name(strut_section_below(key)));
  } else if (key->type == STRUT_TYPE_WORDS) {
    put_member(self, "type", "\"array\"");
    put_member(self, "uniqueItems", "true");
    open_object(self, "items");
    put_words(self, key);
    close_object(self);
  } else if (key == strut_key_at(STRUT_KEY_SCENE_COLLISIONS)) {
    put_shape(self, key, "O({!t}|=[\"all\"]=)");
  } else if (key ==
             strut_key_at(STRUT_KEY_CONFIGURATION_SHAPE)) { /* it may be a node of that name */
    put_shape(self, key, "A([22n]|{!t})");
  } else if (key->type != STRUT_TYPE_FREE) {
    put_shape(self, key, strut_type_shape(key->type));
  } else {
    bool search = key->section == STRUT_SECTION_SEARCH;
    put_shape(self, key, search ? "A([22s]|s)" : find_shape(free_shapes, key->name));
  }
}

/* The range of numbers, that of expressions is not known here; or how many entries there may be. */
static void put_limits(schema *self, const strut_key *key) {
  bool count = key->limits.range == STRUT_RANGE_COUNT, list = *strut_type_shape(key->type) == '[';
  const char *least = !count ? "minimum" : list ? "minItems" : "minProperties";
  const char *most = !count ? "maximum" : list ? "maxItems" : "maxProperties";
  if (!count && key->type != STRUT_TYPE_NUMBER) return;
  switch (key->limits.range) {
    case STRUT_RANGE_ANY: break;
    case STRUT_RANGE_NOT_NEGATIVE: put_member(self, "minimum", "0"); break;
    case STRUT_RANGE_SHARE:
    case STRUT_RANGE_ABOVE_ZERO: put_member(self, "exclusiveMinimum", "0"); break;
    case STRUT_RANGE_COUNT:
    case STRUT_RANGE_WHOLE:
      strut_json_number(&self->json, self->open[self->depth], least, key->limits.least);
      break;
  }
  if (key->limits.most > 0.0)
    strut_json_number(&self->json, self->open[self->depth], most, key->limits.most);
}

/* A default that is a value; the others are in the description. */
static void put_default(schema *self, const strut_key *key) {
  char *end = NULL;
  const char *value = key->fallback;
  bool number = *value && (strtod(value, &end), *end == '\0');
  bool word = key->type == STRUT_TYPE_WORD && strut_word_find(key->words, value) >= 0;
  bool raw = (number && key->type == STRUT_TYPE_NUMBER) ||
             (*value == '[' && key->type == STRUT_TYPE_PAIR) || key->type == STRUT_TYPE_SETTLE ||
             key->type == STRUT_TYPE_STEADY;
  if (word || (key->type == STRUT_TYPE_FIXED && *value))
    put_text_member(self, "default", value);
  else if (raw && *value)
    put_member(self, "default", value);
}

/* What it means, what it is, and its default. */
static void put_description(schema *self, const strut_key *key, bool ticks) {
  strut_writer text = {.scene = NULL}, all = {.scene = NULL};
  strut_put(&text, key->description);
  strut_put(&text, "\n\n");
  strut_put_key_type(&text, key);
  if (key->need == STRUT_REQUIRED) strut_put(&text, ". Required.");
  if (*key->fallback) {
    bool described = strut_default_is_described(key) || strchr(key->fallback, '`');
    strut_put(&text, described ? ". Default: " : ". Default: `");
    strut_put(&text, key->fallback);
    strut_put(&text, described ? "." : "`.");
  }
  if (!text.out.failed) strut_put_without_links(&all, text.out.text, ticks);
  if (text.out.failed || all.out.failed)
    self->json.failed = true;
  else if (!ticks || strchr(all.out.text, '`'))
    put_text_member(self, ticks ? "markdownDescription" : "description", all.out.text);
  strut_release(text.out.text);
  strut_release(all.out.text);
}

static void put_property(schema *self, const strut_key *key) {
  open_object(self, key->name);
  put_description(self, key, false);
  put_description(self, key, true);
  put_default(self, key);
  put_value(self, key);
  put_limits(self, key);
  close_object(self);
}

/* Former names of keys are accepted, and not offered. */
static void put_former_names(schema *self, strut_section section) {
  const strut_spelling *spelling;
  for (size_t i = 0; (spelling = strut_spelling_at(i)); i++) {
    if (spelling->section != section || spelling->key) continue;
    open_object(self, spelling->other);
    put_text_member(self, "deprecationMessage", "former name");
    put_value(self, strut_key_at(strut_key_find(section, spelling->current)));
    close_object(self);
  }
}

/* ---- sections ---- */

static void put_keys(schema *self, strut_section section) {
  put_text_member(self, "title", strut_section_name(section)); /* messages and hovers show it */
  put_member(self, "type", "\"object\"");
  open_object(self, "properties");
  for (int i = 0; i < strut_section_size(section); i++)
    put_property(self, strut_key_at(strut_section_first(section) + i));
  put_former_names(self, section);
  close_object(self);
  if (section == STRUT_SECTION_CONFIGURATION) { /* else a node and its position */
    open_object(self, "additionalProperties");
    open_unless_removed(self);
    put_member(self, "minProperties", "2");
    put_shape(self, NULL, PLACE);
    close_object(self);
    close_object(self);
  } else if (section == STRUT_SECTION_MATCH) { /* else what is compared, and with what */
    put_within(self, "additionalProperties", NULL, "n");
  } else {
    put_member(self, "additionalProperties", "false");
  }
}

static void put_definition(schema *self, strut_section section) {
  open_object(self, strut_section_name(section));
  open_unless_removed(self);
  put_keys(self, section);
  close_object(self);
  close_object(self);
}

/* A group may have the keys of all things that may name one. */
static void put_group_definition(schema *self) {
  const strut_section *sections = strut_group_sections;
  open_object(self, "group");
  open_unless_removed(self);
  put_text_member(self, "title", "group");
  put_member(self, "type", "\"object\"");
  open_object(self, "properties");
  for (size_t a = 0; a < STRUT_GROUP_SECTIONS; a++)
    for (int i = 0; i < strut_section_size(sections[a]); i++) {
      const strut_key *key = strut_key_at(strut_section_first(sections[a]) + i);
      bool before = strcmp(key->name, "group") == 0;
      for (size_t b = 0; b < a; b++) before = before || strut_key_find(sections[b], key->name) >= 0;
      if (!before) put_property(self, key);
    }
  close_object(self);
  put_member(self, "additionalProperties", "false");
  close_object(self);
  close_object(self);
}

/* Those that something refers to; a definition may refer to further ones. */
static void put_definitions(schema *self) {
  bool done[STRUT_SECTION_COUNT] = {false}, more = true;
  open_object(self, "definitions");
  if (!self->study) put_group_definition(self);
  while (more) {
    more = false;
    for (int i = 0; i < STRUT_SECTION_COUNT; i++) {
      if (!self->wanted[i] || done[i]) continue;
      done[i] = more = true;
      put_definition(self, (strut_section)i);
    }
  }
  close_object(self);
}

char *strut_schema_write(bool study) {
  schema s = {.json = strut_json_begin(), .study = study};
  s.open[0] = s.json.root;
  put_text_member(&s, "$schema", "http://json-schema.org/draft-07/schema#");
  put_text_member(&s, "$comment", "generated by strut keys --schema; version 1 of the language");
  put_keys(&s, study ? STRUT_SECTION_STUDY : STRUT_SECTION_SCENE);
  put_member(&s, "required", study ? "[\"strut\", \"study\", \"model\"]" : "[\"strut\"]");
  if (study)
    put_member(&s, "anyOf",
               "[{\"required\": [\"axes\"]}, {\"required\": [\"search\"]}, "
               "{\"required\": [\"sensitivity\"]}, {\"required\": [\"follow\"]}, "
               "{\"required\": [\"fit\"]}]");
  put_definitions(&s);
  return strut_json_end(&s.json);
}
