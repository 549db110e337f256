/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One walk over the table of keys: a section becomes a definition, a key a property of it. Editors show
 * a property's own description only, never that of a definition behind it, and report alternatives
 * ("anyOf") vaguely; so every property has its description, and alternatives are "if type ... then".
 */
#include "parser/command/schema.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/json_value.h"
#include "parser/write/writer.h"

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

/* A quantity is a number or an expression in a text; the schema does not say which texts are expressions. */
#define NUMBER "[\"number\", \"string\"]"
/* YAML makes numbers and switches of names and texts such as 1 and true; strut takes them as written. */
#define SCALAR "[\"string\", \"number\", \"boolean\"]"

static void put_number(schema *s) { put_member(s, "type", NUMBER); }
static void put_scalar(schema *s) { put_member(s, "type", SCALAR); }

static void refer_to(schema *s, const char *definition) {
  char text[80] = "#/definitions/";
  strncat(text, definition, sizeof text - strlen(text) - 1);
  put_text_member(s, "$ref", text);
}

static void put_section(schema *s, strut_section section) {
  s->wanted[section] = true;
  refer_to(s, strut_section_name(section));
}

static void put_group(schema *s) { refer_to(s, "group"); }

typedef void fragment(schema *s);

/* A list of `least` to `most` items; most 0: any number. */
static void put_list(schema *s, int least, int most, fragment *item) {
  char digits[2] = {(char)('0' + least), '\0'};
  put_member(s, "type", "\"array\"");
  open_object(s, "items");
  item(s);
  close_object(s);
  if (least) put_member(s, "minItems", digits);
  digits[0] = (char)('0' + most);
  if (most) put_member(s, "maxItems", digits);
}

/* One form for values of a JSON type, another for all others. */
static void put_either(schema *s, const char *type, fragment *then, fragment *otherwise) {
  open_object(s, "if");
  put_text_member(s, "type", type);
  close_object(s);
  open_object(s, "then");
  then(s);
  close_object(s);
  open_object(s, "else");
  otherwise(s);
  close_object(s);
}

static void put_pair(schema *s) { put_list(s, 2, 2, put_number); }
static void put_names(schema *s) { put_list(s, 0, 0, put_scalar); }
static void put_names_of_things(schema *s) {
  put_member(s, "type", "\"object\"");
  open_object(s, "additionalProperties");
  put_scalar(s);
  close_object(s);
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

static void put_axes_of_support(schema *s) { put_member(s, "enum", "[\"x\", \"y\"]"); }
static void put_list_of_supports(schema *s) { put_list(s, 0, 2, put_axes_of_support); }
static void put_supports(schema *s) { put_member(s, "enum", "[\"none\", \"x\", \"y\", \"both\"]"); }

static void put_law(schema *s) { put_section(s, STRUT_SECTION_LAW); }
static void put_law_word(schema *s) {
  char word[40];
  const char *words = strut_key_at(STRUT_KEY_LAW_KIND)->words;
  open_list(s, "enum");
  for (int i = 0; strut_word_at(words, i, word, sizeof word); i++) put_text_member(s, NULL, word);
  put_text_member(s, NULL, "tension_only");
  put_text_member(s, NULL, "compression_only");
  close_object(s);
}

static void put_switch(schema *s) { put_member(s, "enum", "[true, false, \"yes\", \"no\"]"); }
static void put_settle(schema *s) { put_section(s, STRUT_SECTION_SETTLE); }
static void put_steady(schema *s) { put_section(s, STRUT_SECTION_STEADY); }
static void put_all(schema *s) { put_member(s, "enum", "[\"all\"]"); }
static void put_name_or_names(schema *s) { put_either(s, "array", put_names, put_scalar); }
static void put_signal_keys(schema *s) { put_section(s, STRUT_SECTION_SIGNAL); }
static void put_signal(schema *s) { put_either(s, "object", put_signal_keys, put_scalar); }
static void put_node_keys(schema *s) { put_section(s, STRUT_SECTION_NODE); }
static void put_node(schema *s) { put_either(s, "array", put_pair, put_node_keys); }
static void put_quantity_keys(schema *s) { put_section(s, STRUT_SECTION_QUANTITY); }
static void put_quantity(schema *s) { put_either(s, "object", put_quantity_keys, put_number); }
static void put_repeat(schema *s) { put_section(s, STRUT_SECTION_REPEAT); }
static void put_next(schema *s) { put_section(s, STRUT_SECTION_NEXT); }
static void put_stage(schema *s) { put_section(s, STRUT_SECTION_STAGE); }
static void put_two_next(schema *s) { put_list(s, 2, 2, put_next); }
static void put_two_texts(schema *s) { put_list(s, 2, 2, put_scalar); }
static void put_two_numbers(schema *s) { put_list(s, 2, 2, put_number); }
static void put_touching(schema *s) { put_member(s, "enum", "[\"touching\"]"); }
static void put_values(schema *s) { put_list(s, 0, 0, put_scalar); }
static void put_range(schema *s) { put_section(s, STRUT_SECTION_RANGE); }
static void put_variable(schema *s) { put_section(s, STRUT_SECTION_VARIABLE); }
static void put_points(schema *s) { put_section(s, STRUT_SECTION_POINTS); }
static void put_along(schema *s) { put_either(s, "array", put_values, put_range); }

/* `kind: relay` has keys of its own. */
static void put_controller(schema *s) {
  open_object(s, "if");
  put_member(s, "type", "\"object\"");
  put_member(s, "required", "[\"kind\"]");
  put_member(s, "properties", "{\"kind\": {\"const\": \"relay\"}}");
  close_object(s);
  open_object(s, "then");
  put_section(s, STRUT_SECTION_RELAY);
  close_object(s);
  open_object(s, "else");
  open_object(s, "if");
  put_member(s, "type", "\"object\"");
  put_member(s, "required", "[\"network\"]");
  close_object(s);
  open_object(s, "then");
  put_section(s, STRUT_SECTION_NETWORK);
  close_object(s);
  open_object(s, "else");
  put_section(s, STRUT_SECTION_CONTROLLER);
  close_object(s);
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
  put_along(s);
  close_object(s);
  close_object(s);
  open_object(s, "points");
  put_text_member(s, "description", "A CSV file with a row for each value, or the keys of points.");
  put_either(s, "object", put_points, put_name_or_names);
  close_object(s);
  open_object(s, "sample");
  put_text_member(s, "description", "Parameters from distributions.");
  put_section(s, STRUT_SECTION_SAMPLE);
  close_object(s);
  close_object(s);
  open_object(s, "additionalProperties");
  put_along(s);
  close_object(s);
}

/* Known columns are offered, others are quantities that the model measures. */
static void put_kept(schema *s) {
  const strut_key *key = strut_key_at(STRUT_KEY_STUDY_KEEP);
  open_list(s, "anyOf");
  open_object(s, NULL);
  put_words(s, key);
  close_object(s);
  open_object(s, NULL);
  put_scalar(s);
  close_object(s);
  close_object(s);
}

/* Keys of several forms. */
static void put_free(schema *s, const strut_key *key) {
  if (key->section == STRUT_SECTION_SEARCH)
    put_either(s, "array", put_two_texts, put_scalar);
  else if (strcmp(key->name, "mu") == 0)
    put_either(s, "object", put_signal_keys, put_scalar);
  else if (strcmp(key->name, "merge") == 0)
    put_either(s, "object", put_names_of_things, put_touching);
  else if (strcmp(key->name, "repeat") == 0)
    put_either(s, "object", put_repeat, put_number);
  else if (strcmp(key->name, "count") == 0)
    put_either(s, "array", put_two_numbers, put_number);
  else if (strcmp(key->name, "next") == 0)
    put_either(s, "array", put_two_next, put_next);
  else if (strcmp(key->name, "closed") == 0)
    put_either(s, "object", put_names_of_things, put_switch);
  else if (strcmp(key->name, "between") == 0)
    put_either(s, "array", put_two_texts, put_scalar);
  else if (strcmp(key->name, "load") == 0)
    put_name_or_names(s);
  else if (strcmp(key->name, "inputs") == 0)
    put_list(s, 1, 0, put_scalar);
  else if (strcmp(key->name, "path") == 0)
    put_section(s, STRUT_SECTION_SCENE_PATH);
  else if (strcmp(key->name, "stages") == 0)
    put_list(s, 1, 0, put_stage);
  else if (strcmp(key->name, "stop") == 0) {
    put_member(s, "type", "\"object\"");
    put_member(s, "maxProperties", "1");
  } else if (strcmp(key->name, "lattice") == 0) {
    put_member(s, "type", "\"array\"");
    open_object(s, "items");
    put_pair(s);
    close_object(s);
    put_member(s, "minItems", "1");
    put_member(s, "maxItems", "2");
  } else if (strcmp(key->name, "step") == 0) { /* a displacement or two of them */
    put_member(s, "type", "\"array\"");
    open_object(s, "items");
    put_either(s, "array", put_pair, put_number);
    close_object(s);
    put_member(s, "minItems", "2");
    put_member(s, "maxItems", "2");
  } else {
    put_number(s);
  }
}

/* ---- things ---- */

static void put_any_section(schema *s, strut_section section) {
  switch ((int)section) {
    case STRUT_SECTION_NODE: put_node(s); break;
    case STRUT_SECTION_SIGNAL: put_signal(s); break;
    case STRUT_SECTION_QUANTITY: put_quantity(s); break;
    case STRUT_SECTION_CONTROLLER: put_controller(s); break;
    default: put_section(s, section); break;
  }
}

/* What the things of a mapping are: its name decides, wherever it stands. */
static void put_thing(schema *s, const strut_key *key) {
  static const struct {
    const char *name;
    fragment *put;
  } plain[] = {{"groups", put_group},   {"parameters", put_scalar}, {"set", put_scalar},
               {"derive", put_scalar},  {"ports", put_scalar},      {"onto", put_scalar},
               {"merge", put_scalar},   {"coupling", put_number},   {"shape", put_pair},
               {"positions", put_pair}, {"velocities", put_pair}};
  for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++)
    if (strcmp(plain[i].name, key->name) == 0) {
      plain[i].put(s);
      return;
    }
  if (key == strut_key_at(STRUT_KEY_SEARCH_OVER)) {
    put_either(s, "array", put_values, put_variable);
    return;
  }
  if (key == strut_key_at(STRUT_KEY_SEARCH_WORST_OVER)) {
    put_along(s);
    return;
  }
  strut_section section = strut_section_below(key);
  if (section != STRUT_SECTION_COUNT) put_any_section(s, section);
}

/* With a base `remove` takes away a thing, or a whole mapping. */
static void open_unless_removed(schema *s) {
  put_member(s, "if", "{\"const\": \"remove\"}");
  open_object(s, "else");
}

static void put_things(schema *s, const strut_key *key) {
  if (!s->study) open_unless_removed(s);
  put_member(s, "type", "\"object\"");
  put_member(s, "propertyNames", "{\"pattern\": \"^[-A-Za-z0-9_.*\\\\u0080-\\\\uffff]{1,255}$\"}");
  open_object(s, "additionalProperties");
  put_thing(s, key);
  close_object(s);
  if (!s->study) close_object(s);
}

/* ---- keys ---- */

static void put_collisions(schema *s) { put_things(s, strut_key_at(STRUT_KEY_SCENE_COLLISIONS)); }
static void put_shape(schema *s) { put_things(s, strut_key_at(STRUT_KEY_CONFIGURATION_SHAPE)); }

static void put_value(schema *s, const strut_key *key) {
  if (key == strut_key_at(STRUT_KEY_SCENE_COLLISIONS)) {
    put_either(s, "object", put_collisions, put_all);
    return;
  }
  if (key == strut_key_at(STRUT_KEY_CONFIGURATION_SHAPE)) { /* it may be a node of that name */
    put_either(s, "array", put_pair, put_shape);
    return;
  }
  switch (key->type) {
    case STRUT_TYPE_VERSION: put_member(s, "enum", "[1]"); break;
    case STRUT_TYPE_TEXT:
    case STRUT_TYPE_NAME: put_scalar(s); break;
    case STRUT_TYPE_NUMBER:
    case STRUT_TYPE_EXPRESSION: put_number(s); break;
    case STRUT_TYPE_PAIR: put_pair(s); break;
    case STRUT_TYPE_WORD: put_words(s, key); break;
    case STRUT_TYPE_WORDS:
      put_member(s, "type", "\"array\"");
      put_member(s, "uniqueItems", "true");
      open_object(s, "items");
      put_words(s, key);
      close_object(s);
      break;
    case STRUT_TYPE_FIXED: put_either(s, "array", put_list_of_supports, put_supports); break;
    case STRUT_TYPE_NODE_PATH: put_list(s, 2, 0, put_scalar); break;
    case STRUT_TYPE_NODE_TRIPLE: put_list(s, 3, 3, put_scalar); break;
    case STRUT_TYPE_NODE_RING: put_list(s, 3, 0, put_scalar); break;
    case STRUT_TYPE_NAME_PAIR: put_list(s, 2, 2, put_scalar); break;
    case STRUT_TYPE_NUMBERS:
    case STRUT_TYPE_TIMES: put_list(s, 0, 0, put_number); break;
    case STRUT_TYPE_NAMES: put_names(s); break;
    case STRUT_TYPE_POINTS:
    case STRUT_TYPE_PROFILE:
    case STRUT_TYPE_TABLE: put_list(s, 0, 0, put_pair); break;
    case STRUT_TYPE_LAW: put_either(s, "object", put_law, put_law_word); break;
    case STRUT_TYPE_CONTACT_NODES: put_either(s, "array", put_names, put_all); break;
    case STRUT_TYPE_NODE_SETS: put_list(s, 0, 0, put_name_or_names); break;
    case STRUT_TYPE_GROUPS: put_name_or_names(s); break;
    case STRUT_TYPE_SIGNAL: put_signal(s); break;
    case STRUT_TYPE_SIGNALS: put_list(s, 0, 0, put_signal); break;
    case STRUT_TYPE_SETTLE: put_either(s, "object", put_settle, put_switch); break;
    case STRUT_TYPE_STEADY: put_either(s, "object", put_steady, put_switch); break;
    case STRUT_TYPE_KEEP: put_list(s, 0, 0, put_kept); break;
    case STRUT_TYPE_AXES: put_list(s, 0, 0, put_axis); break;
    case STRUT_TYPE_MAP: put_section(s, strut_section_below(key)); break;
    case STRUT_TYPE_THINGS: put_things(s, key); break;
    case STRUT_TYPE_FREE: put_free(s, key); break;
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
    put_pair(s);
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
