/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One walk over the table of keys: a section becomes a definition, a key a property of it. Editors show
 * a property's own description only, never that of a definition behind it, and report alternatives
 * ("anyOf") vaguely; so every property has its description, and alternatives are "if type ... then".
 */
#include "parser/program/command/schema.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/json_value.h"
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

static void put_member(schema *s, const char *key, const char *raw) {
  strut_json_raw(&s->json, s->open[s->depth], key, raw);
}

static void put_text_member(schema *s, const char *key, const char *text) {
  strut_json_text(&s->json, s->open[s->depth], key, text);
}

/* Without a key in a list. */
static void open_object(schema *s, const char *key) {
  assert(s->depth + 1 < DEEPEST);
  s->open[s->depth + 1] = strut_json_object(&s->json, s->open[s->depth], key);
  s->depth++;
}

static void open_list(schema *s, const char *key) {
  assert(s->depth + 1 < DEEPEST);
  s->open[s->depth + 1] = strut_json_array(&s->json, s->open[s->depth], key);
  s->depth++;
}

/* Object or list. */
static void close_object(schema *s) { s->depth--; }

static void refer_to(schema *s, const char *definition) {
  char text[80] = "#/definitions/";
  strncat(text, definition, sizeof text - strlen(text) - 1);
  put_text_member(s, "$ref", text);
}

/* The words of a key with its synonyms and former words. */
static void put_words(schema *s, const strut_key *key) {
  char word[40];
  const strut_spelling *spelling;
  open_list(s, "enum");
  for (int i = 0; strut_word_at(key->words, i, word, sizeof word); i++)
    put_text_member(s, NULL, word);
  for (size_t i = 0; (spelling = strut_spelling_at(i)); i++)
    if (spelling->section == key->section && spelling->key &&
        strcmp(spelling->key, key->name) == 0 && spelling->kind != STRUT_SPELLING_MISTAKE)
      put_text_member(s, NULL, spelling->other);
  if (strcmp(key->words, "no|yes") == 0) {
    put_member(s, NULL, "false");
    put_member(s, NULL, "true");
  }
  close_object(s);
}

/* With a base `remove` takes away a thing, or a whole mapping. */
static void open_unless_removed(schema *s) {
  put_member(s, "if", "{\"const\": \"remove\"}");
  open_object(s, "else");
}

/* ---- what a value may be, as a text ---- */

/*
 *   n  a number, or an expression in a text; the schema does not say which texts are expressions
 *   s  a scalar: YAML makes numbers and switches of names and texts such as 1 and true, strut takes them as written
 *   w  a word of the key
 *   k  a word of the key, or another text
 *   l  a word of a law;  x  an axis of a study;  t  a thing of the key
 *   =[...]=     one of these values
 *   <section>   an object with the keys of a section, or of a group
 *   [LMx]       a list of L to M items x; M 0: any number
 *   {x}         an object whose members are x
 *   {!x}        likewise named things, which a scene with a base may remove
 *   {1}         an object of one member
 *   A(x|y)      x for a list, y for all others;  O(x|y): x for an object;  K(x|y): for one with the key `network`;
 *   R(x|y)      for one of the kind `relay`
 */
#define SIGNAL "O(<signal>|s)"
#define ALONG "A([00s]|<range>)"

static const char *put_shape(schema *s, const strut_key *key, const char *shape);
static void put_thing(schema *s, const strut_key *key);

static void put_law_word(schema *s) {
  char word[40];
  const char *words = strut_key_at(STRUT_KEY_LAW_KIND)->words;
  open_list(s, "enum");
  for (int i = 0; strut_word_at(words, i, word, sizeof word); i++) put_text_member(s, NULL, word);
  put_text_member(s, NULL, "tension_only");
  put_text_member(s, NULL, "compression_only");
  close_object(s);
}

/* An axis of a study: one parameter, or one of the forms for several. */
static void put_axis(schema *s) {
  put_member(s, "type", "\"object\"");
  put_member(s, "minProperties", "1");
  open_object(s, "properties");
  open_object(s, "zip");
  put_text_member(s, "description", "Parameters that vary together.");
  put_member(s, "type", "[\"object\", \"array\"]");
  open_object(s, "additionalProperties");
  put_shape(s, NULL, ALONG);
  close_object(s);
  close_object(s);
  open_object(s, "points");
  put_text_member(s, "description", "A CSV file with a row for each value, or the keys of points.");
  put_shape(s, NULL, "O(<points>|A([00s]|s))");
  close_object(s);
  open_object(s, "sample");
  put_text_member(s, "description", "Parameters from distributions.");
  put_shape(s, NULL, "<sample>");
  close_object(s);
  close_object(s);
  open_object(s, "additionalProperties");
  put_shape(s, NULL, ALONG);
  close_object(s);
}

/* [LMx] */
static const char *put_list(schema *s, const strut_key *key, const char *shape) {
  const char least[] = {shape[0], '\0'}, most[] = {shape[1], '\0'};
  put_member(s, "type", "\"array\"");
  open_object(s, "items");
  shape = put_shape(s, key, shape + 2);
  close_object(s);
  if (*least > '0') put_member(s, "minItems", least);
  if (*most > '0') put_member(s, "maxItems", most);
  return shape + 1;
}

/* {x}, {!x} or {1} */
static const char *put_members(schema *s, const strut_key *key, const char *shape) {
  bool one = *shape == '1', things = *shape == '!', removable = things && !s->study;
  if (removable) open_unless_removed(s);
  put_member(s, "type", "\"object\"");
  if (one) put_member(s, "maxProperties", "1");
  if (things)
    put_member(s, "propertyNames",
               "{\"pattern\": \"^[-A-Za-z0-9_.*\\\\u0080-\\\\uffff]{1,255}$\"}");
  if (!one) {
    open_object(s, "additionalProperties");
    shape = put_shape(s, key, shape + things) - 1;
    close_object(s);
  }
  if (removable) close_object(s);
  return shape + 2;
}

/* One form for values of one kind, another for all others: A(x|y) and its like. */
static const char *put_either(schema *s, const strut_key *key, char kind, const char *shape) {
  open_object(s, "if");
  put_member(s, "type", kind == 'A' ? "\"array\"" : "\"object\"");
  if (kind == 'K') put_member(s, "required", "[\"network\"]");
  if (kind == 'R') put_member(s, "required", "[\"kind\"]");
  if (kind == 'R') put_member(s, "properties", "{\"kind\": {\"const\": \"relay\"}}");
  close_object(s);
  open_object(s, "then");
  shape = put_shape(s, key, shape + 1);
  close_object(s);
  open_object(s, "else");
  shape = put_shape(s, key, shape + 1);
  close_object(s);
  return shape + 1;
}

static const char *put_section(schema *s, const char *shape) {
  char name[40];
  size_t length = strcspn(shape, ">");
  snprintf(name, sizeof name, "%.*s", (int)length, shape);
  for (int i = 0; i < STRUT_SECTION_COUNT; i++)
    if (strcmp(strut_section_name((strut_section)i), name) == 0) s->wanted[i] = true;
  refer_to(s, name);
  return shape + length + 1;
}

/* Adds what the text says to the open object; returns what follows. */
static const char *put_shape(schema *s, const strut_key *key, const char *shape) {
  char values[120];
  size_t length = strcspn(shape + 1, "=");
  switch (*shape++) {
    case 'n': put_member(s, "type", "[\"number\", \"string\"]"); return shape;
    case 's': put_member(s, "type", "[\"string\", \"number\", \"boolean\"]"); return shape;
    case 'w': put_words(s, key); return shape;
    case 'l': put_law_word(s); return shape;
    case 'x': put_axis(s); return shape;
    case 't': put_thing(s, key); return shape;
    case 'k':
      open_list(s, "anyOf");
      open_object(s, NULL);
      put_words(s, key);
      close_object(s);
      open_object(s, NULL);
      put_shape(s, key, "s");
      close_object(s);
      close_object(s);
      return shape;
    case '=':
      snprintf(values, sizeof values, "%.*s", (int)length, shape);
      put_member(s, "enum", values);
      return shape + length + 1;
    case '<': return put_section(s, shape);
    case '[': return put_list(s, key, shape);
    case '{': return put_members(s, key, shape);
    default: return put_either(s, key, shape[-1], shape);
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
static const named_shape free_shapes[] = {{"mu", SIGNAL},
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
                                          {NULL, "n"}};

/* The things of a mapping: its name decides, wherever it stands. */
static const named_shape thing_shapes[] = {
    {"groups", "<group>"},  {"parameters", "s"},     {"set", "s"},
    {"derive", "s"},        {"ports", "s"},          {"onto", "s"},
    {"merge", "s"},         {"coupling", "n"},       {"shape", "[22n]"},
    {"positions", "[22n]"}, {"velocities", "[22n]"}, {NULL, NULL}};

static const named_shape section_shapes[] = {{"node", "A([22n]|<node>)"},
                                             {"signal", SIGNAL},
                                             {"quantity", "O(<quantity>|n)"},
                                             {"controller", "R(<relay>|K(<network>|<controller>))"},
                                             {NULL, NULL}};

#define SWITCH "=[true, false, \"yes\", \"no\"]="
#define AXES "=[\"x\", \"y\"]="
static const char *const type_shapes[] = {
    [STRUT_TYPE_VERSION] = "=[1]=",
    [STRUT_TYPE_TEXT] = "s",
    [STRUT_TYPE_NAME] = "s",
    [STRUT_TYPE_NUMBER] = "n",
    [STRUT_TYPE_EXPRESSION] = "n",
    [STRUT_TYPE_PAIR] = "[22n]",
    [STRUT_TYPE_WORD] = "w",
    [STRUT_TYPE_FIXED] = "A([02" AXES "]|=[\"none\", \"x\", \"y\", \"both\"]=)",
    [STRUT_TYPE_NODE_PATH] = "[20s]",
    [STRUT_TYPE_NODE_TRIPLE] = "[33s]",
    [STRUT_TYPE_NODE_RING] = "[30s]",
    [STRUT_TYPE_NAME_PAIR] = "[22s]",
    [STRUT_TYPE_NUMBERS] = "[00n]",
    [STRUT_TYPE_TIMES] = "[00n]",
    [STRUT_TYPE_NAMES] = "[00s]",
    [STRUT_TYPE_POINTS] = "[00[22n]]",
    [STRUT_TYPE_PROFILE] = "[00[22n]]",
    [STRUT_TYPE_TABLE] = "[00[22n]]",
    [STRUT_TYPE_CONTACT_NODES] = "A([00s]|=[\"all\"]=)",
    [STRUT_TYPE_NODE_SETS] = "[00A([00s]|s)]",
    [STRUT_TYPE_GROUPS] = "A([00s]|s)",
    [STRUT_TYPE_SIGNAL] = SIGNAL,
    [STRUT_TYPE_SIGNALS] = "[00" SIGNAL "]",
    [STRUT_TYPE_SETTLE] = "O(<settle>|" SWITCH ")",
    [STRUT_TYPE_STEADY] = "O(<steady>|" SWITCH ")",
    [STRUT_TYPE_KEEP] = "[00k]",
    [STRUT_TYPE_LAW] = "O(<law>|l)",
    [STRUT_TYPE_AXES] = "[00x]",
    [STRUT_TYPE_THINGS] = "{!t}",
};

/* ---- keys ---- */

/* Things of any section but these are objects with its keys. */
static void put_thing(schema *s, const strut_key *key) {
  const char *shape = find_shape(thing_shapes, key->name);
  if (!shape && key == strut_key_at(STRUT_KEY_SEARCH_OVER)) shape = "A([00s]|<variable>)";
  if (!shape && key == strut_key_at(STRUT_KEY_SEARCH_WORST_OVER)) shape = ALONG;
  strut_section section = shape ? STRUT_SECTION_COUNT : strut_section_below(key);
  if (section != STRUT_SECTION_COUNT)
    shape = find_shape(section_shapes, strut_section_name(section));
  if (shape)
    put_shape(s, key, shape);
  else if (section != STRUT_SECTION_COUNT)
    put_section(s, strut_section_name(section));
}

static void put_value(schema *s, const strut_key *key) {
  if (key->type == STRUT_TYPE_MAP) {
    put_section(s, strut_section_name(strut_section_below(key)));
  } else if (key->type == STRUT_TYPE_WORDS) {
    put_member(s, "type", "\"array\"");
    put_member(s, "uniqueItems", "true");
    open_object(s, "items");
    put_words(s, key);
    close_object(s);
  } else if (key == strut_key_at(STRUT_KEY_SCENE_COLLISIONS)) {
    put_shape(s, key, "O({!t}|=[\"all\"]=)");
  } else if (key ==
             strut_key_at(STRUT_KEY_CONFIGURATION_SHAPE)) { /* it may be a node of that name */
    put_shape(s, key, "A([22n]|{!t})");
  } else if (key->type != STRUT_TYPE_FREE) {
    put_shape(s, key, type_shapes[key->type]);
  } else {
    bool search = key->section == STRUT_SECTION_SEARCH;
    put_shape(s, key, search ? "A([22s]|s)" : find_shape(free_shapes, key->name));
  }
}

/* The range of numbers; that of expressions is not known here. */
static void put_limits(schema *s, const strut_key *key) {
  if (key->type != STRUT_TYPE_NUMBER) return;
  switch (key->limits.range) {
    case STRUT_RANGE_ANY: break;
    case STRUT_RANGE_NOT_NEGATIVE: put_member(s, "minimum", "0"); break;
    case STRUT_RANGE_ABOVE_ZERO: put_member(s, "exclusiveMinimum", "0"); break;
    case STRUT_RANGE_WHOLE:
      strut_json_number(&s->json, s->open[s->depth], "minimum", key->limits.least);
      strut_json_number(&s->json, s->open[s->depth], "maximum", key->limits.most);
      break;
  }
}

/* A default that is a value; the others are in the description. */
static void put_default(schema *s, const strut_key *key) {
  char *end = NULL;
  const char *value = key->fallback;
  bool number = *value && (strtod(value, &end), *end == '\0');
  bool word = key->type == STRUT_TYPE_WORD && strut_word_find(key->words, value) >= 0;
  bool raw = (number && key->type == STRUT_TYPE_NUMBER) ||
             (*value == '[' && key->type == STRUT_TYPE_PAIR) || key->type == STRUT_TYPE_SETTLE ||
             key->type == STRUT_TYPE_STEADY;
  if (word || (key->type == STRUT_TYPE_FIXED && *value))
    put_text_member(s, "default", value);
  else if (raw && *value)
    put_member(s, "default", value);
}

/* What it means, what it is, and its default. */
static void put_description(schema *s, const strut_key *key, bool ticks) {
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
    s->json.failed = true;
  else if (!ticks || strchr(all.out.text, '`'))
    put_text_member(s, ticks ? "markdownDescription" : "description", all.out.text);
  strut_release(text.out.text);
  strut_release(all.out.text);
}

static void put_property(schema *s, const strut_key *key) {
  open_object(s, key->name);
  put_description(s, key, false);
  put_description(s, key, true);
  put_default(s, key);
  put_value(s, key);
  put_limits(s, key);
  close_object(s);
}

/* Former names of keys are accepted, and not offered. */
static void put_former_names(schema *s, strut_section section) {
  const strut_spelling *spelling;
  for (size_t i = 0; (spelling = strut_spelling_at(i)); i++) {
    if (spelling->section != section || spelling->key || spelling->kind == STRUT_SPELLING_MISTAKE)
      continue;
    open_object(s, spelling->other);
    put_text_member(s, "deprecationMessage", "former name");
    put_value(s, strut_key_at(strut_key_find(section, spelling->current)));
    close_object(s);
  }
}

/* ---- sections ---- */

static void put_keys(schema *s, strut_section section) {
  put_text_member(s, "title", strut_section_name(section)); /* messages and hovers show it */
  put_member(s, "type", "\"object\"");
  open_object(s, "properties");
  for (int i = 0; i < strut_section_size(section); i++)
    put_property(s, strut_key_at(strut_section_first(section) + i));
  put_former_names(s, section);
  close_object(s);
  if (section == STRUT_SECTION_CONFIGURATION) { /* else a node and its position */
    open_object(s, "additionalProperties");
    open_unless_removed(s);
    put_shape(s, NULL, "[22n]");
    close_object(s);
    close_object(s);
  } else {
    put_member(s, "additionalProperties", "false");
  }
}

static void put_definition(schema *s, strut_section section) {
  open_object(s, strut_section_name(section));
  open_unless_removed(s);
  put_keys(s, section);
  close_object(s);
  close_object(s);
}

/* A group may have the keys of all things that may name one. */
static void put_group_definition(schema *s) {
  const strut_section *sections = strut_group_sections;
  open_object(s, "group");
  open_unless_removed(s);
  put_text_member(s, "title", "group");
  put_member(s, "type", "\"object\"");
  open_object(s, "properties");
  for (size_t a = 0; a < STRUT_GROUP_SECTIONS; a++)
    for (int i = 0; i < strut_section_size(sections[a]); i++) {
      const strut_key *key = strut_key_at(strut_section_first(sections[a]) + i);
      bool before = strcmp(key->name, "group") == 0;
      for (size_t b = 0; b < a; b++) before = before || strut_key_find(sections[b], key->name) >= 0;
      if (!before) put_property(s, key);
    }
  close_object(s);
  put_member(s, "additionalProperties", "false");
  close_object(s);
  close_object(s);
}

/* Those that something refers to; a definition may refer to further ones. */
static void put_definitions(schema *s) {
  bool done[STRUT_SECTION_COUNT] = {false}, more = true;
  open_object(s, "definitions");
  if (!s->study) put_group_definition(s);
  while (more) {
    more = false;
    for (int i = 0; i < STRUT_SECTION_COUNT; i++) {
      if (!s->wanted[i] || done[i]) continue;
      done[i] = more = true;
      put_definition(s, (strut_section)i);
    }
  }
  close_object(s);
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
               "{\"required\": [\"sensitivity\"]}, {\"required\": [\"follow\"]}]");
  put_definitions(&s);
  return strut_json_end(&s.json);
}
