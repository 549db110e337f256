/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Growing YAML text, and objects as mappings by the rows of their keys. See writer.h. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/base/vec.h"
#include "parser/language/write/writer.h"
#include "parser/language/yaml/text.h"

/* ---- growing text ---- */

void strut_put_part(strut_writer *writer, const char *text, size_t length) {
  strut_buffer_put(&writer->out, text, length);
}

void strut_put(strut_writer *writer, const char *text) {
  strut_put_part(writer, text, strlen(text));
}

void strut_put_number(strut_writer *writer, double value) {
  char text[STRUT_NUMBER_TEXT];
  strut_put_part(writer, text, strut_number_text(value, text));
}

void strut_put_pair(strut_writer *writer, const double pair[2]) {
  strut_put(writer, "[");
  strut_put_number(writer, pair[0]);
  strut_put(writer, ", ");
  strut_put_number(writer, pair[1]);
  strut_put(writer, "]");
}

/* One code point within double quotes. */
static void put_escaped(strut_writer *writer, const char *text, size_t bytes, uint32_t code) {
  char escape[16];
  if (code == STRUT_BAD_CODE || strut_text_forbidden(code)) { /* no text may hold it */
    strut_put(writer, "\\uFFFD");
  } else if (code == '"' || code == '\\') {
    snprintf(escape, sizeof escape, "\\%c", (char)code);
    strut_put(writer, escape);
  } else if (code < 0x20 || strut_text_break(text, bytes)) {
    snprintf(escape, sizeof escape, code > 0xffff ? "\\U%08X" : "\\u%04X", (unsigned)code);
    strut_put(writer, escape);
  } else {
    strut_put_part(writer, text, bytes);
  }
}

void strut_put_quoted(strut_writer *writer, const char *text) {
  size_t left = strlen(text);
  strut_put(writer, "\"");
  while (left > 0) {
    uint32_t code;
    size_t bytes = strut_text_decode(text, left, &code);
    put_escaped(writer, text, bytes, code);
    text += bytes;
    left -= bytes;
  }
  strut_put(writer, "\"");
}

void strut_put_name(strut_writer *writer, const char *name) {
  if (!strchr("-.", *name) && !name[strspn(name, STRUT_LETTERS STRUT_DIGITS "-.")])
    strut_put(writer, name);
  else
    strut_put_quoted(writer, name);
}

static void put_key_text(strut_writer *writer, strut_mapping *mapping, const char *key) {
  strut_put(writer, mapping->separator);
  mapping->separator = mapping->next;
  strut_put(writer, key);
  strut_put(writer, ": ");
}

void strut_put_key_name(strut_writer *writer, strut_mapping *mapping, int key) {
  put_key_text(writer, mapping, strut_key_at(key)->name);
}

/* ---- values ---- */

static void put_word(strut_writer *writer, const strut_key *key, int i) {
  char word[40];
  const char *found = strut_word_at(key->words, i, word, sizeof word);
  assert(found);
  if (found) strut_put(writer, found);
}

static void put_words(strut_writer *writer, const strut_key *key, uint64_t bits) {
  bool any = false;
  strut_put(writer, "[");
  for (int i = 0; i < 64; i++) {
    if (!(bits >> i & 1u)) continue;
    if (any) strut_put(writer, ", ");
    any = true;
    put_word(writer, key, i);
  }
  strut_put(writer, "]");
}

/* The angle in radians that reads back as exactly this number of turns, if there is one. */
static double radians(double turns) {
  double angle = turns * STRUT_TAU, up = angle, down = angle;
  for (int i = 0; i < 4; i++) {
    if (up / STRUT_TAU == turns) return up;
    if (down / STRUT_TAU == turns) return down;
    up = nextafter(up, (double)INFINITY);
    down = nextafter(down, -(double)INFINITY);
  }
  return angle;
}

/* A number, and the unit beside it in the object. */
static void put_number(strut_writer *writer, const strut_field *field, const char *object) {
  double number = *(const double *)(const void *)(object + field->offset);
  const char *unit = NULL;
  if (field->direction && (number == 0.0 || number == 0.25 * STRUT_TAU)) {
    strut_put(writer, number == 0.0 ? "x" : "y");
    return;
  }
  if (field->beside) memcpy(&unit, object + field->beside, sizeof unit);
  if (unit && strcmp(unit, "1") == 0) unit = NULL;
  strut_put(writer, unit ? "\"" : "");
  strut_put_number(writer, field->turns ? radians(number) : number);
  if (unit) strut_buffer_add(&writer->out, " %s\"", unit);
}

static void put_value(strut_writer *writer, const strut_key *key, const char *object) {
  const void *field = object + key->field.offset;
  switch (key->field.type) {
    case STRUT_FIELD_DOUBLE: put_number(writer, &key->field, object); break;
    case STRUT_FIELD_INT32: strut_put_number(writer, *(const int32_t *)field); break;
    case STRUT_FIELD_INT64: strut_put_number(writer, (double)*(const int64_t *)field); break;
    case STRUT_FIELD_UINT64:
      if (key->type == STRUT_TYPE_WORDS)
        put_words(writer, key, *(const uint64_t *)field);
      else
        strut_put_number(writer, (double)*(const uint64_t *)field);
      break;
    case STRUT_FIELD_UINT32:
      put_word(writer, key, (int)(*(const uint32_t *)field - key->field.first));
      break;
    case STRUT_FIELD_BOOL: put_word(writer, key, *(const bool *)field); break;
    case STRUT_FIELD_DOUBLE_PAIR: strut_put_pair(writer, field); break;
    case STRUT_FIELD_BOOL_PAIR:
      put_word(writer, key, ((const bool *)field)[0] + 2 * ((const bool *)field)[1]);
      break;
    case STRUT_FIELD_TEXT:
      if (key->type == STRUT_TYPE_TEXT)
        strut_put_quoted(writer, *(const char *const *)field);
      else
        strut_put_name(writer, *(const char *const *)field);
      break;
    case STRUT_FIELD_INSTRUCTION:
    case STRUT_FIELD_NODE_SET:
    case STRUT_FIELD_TREE:
    case STRUT_FIELD_OBJECT: assert(false);
  }
}

static void put_thing_name(strut_writer *writer, strut_thing kind, int32_t i) {
  strut_put_name(writer, strut_thing_name(writer->scene, kind, (size_t)i));
}

void strut_put_coordinate(strut_writer *writer, int32_t at) {
  strut_arena arena = {0};
  const char *node = writer->scene->nodes[at / 2].name;
  const char *name = strut_arena_format(&arena, "%s.%c", node, at % 2 ? 'y' : 'x');
  strut_put_name(writer, name ? name : node);
  strut_arena_free(&arena);
}

/* A name, or "[a, b]". */
static void put_references(strut_writer *writer, const strut_key *key, const int32_t *index,
                           size_t count) {
  bool list = count != 1 || key->field.role == STRUT_FIELD_LIST;
  for (size_t k = 0; k < count; k++) {
    if (list) strut_put(writer, k ? ", " : "[");
    if (key->field.kind == STRUT_THING_SIGNAL)
      strut_put_signal_reference(writer, index[k]);
    else if (key->field.kind == STRUT_THING_COUNT)
      strut_put_coordinate(writer, index[k]);
    else
      put_thing_name(writer, key->field.kind, index[k]);
  }
  if (list) strut_put(writer, "]");
}

/* "[a, p, q, b]" */
static void put_path(strut_writer *writer, const strut_field *field, const char *object) {
  const int32_t *ends = (const int32_t *)(const void *)(object + field->offset), *guides;
  size_t count = *(const size_t *)(const void *)(object + field->number);
  memcpy(&guides, object + field->beside, sizeof guides);
  strut_put(writer, "[");
  for (size_t k = 0; k < count + 2; k++) {
    if (k) strut_put(writer, ", ");
    put_thing_name(writer, field->kind, k == 0 ? ends[0] : k > count ? ends[1] : guides[k - 1]);
  }
  strut_put(writer, "]");
}

/* "[[n1, n4], [n2]]": always a list of lists, which cannot be mistaken for a position. */
static void put_node_sets(strut_writer *writer, const strut_node_set *sets, size_t count) {
  strut_put(writer, "[");
  for (size_t i = 0; i < count; i++) {
    strut_put(writer, i ? ", [" : "[");
    for (size_t n = 0; n < sets[i].count; n++) {
      if (n) strut_put(writer, ", ");
      put_thing_name(writer, STRUT_THING_NODE, sets[i].node[n]);
    }
    strut_put(writer, "]");
  }
  strut_put(writer, "]");
}

static void put_numbers(strut_writer *writer, const strut_field *field, const double *number,
                        const double *second, size_t count) {
  for (size_t k = 0; k < count; k++) {
    strut_put(writer, k ? ", " : "[");
    if (field->type == STRUT_FIELD_DOUBLE_PAIR)
      strut_put_pair(writer, number + 2 * k);
    else if (field->beside)
      strut_put_pair(writer, (const double[2]){number[k], second[k]});
    else
      strut_put_number(writer, number[k]);
  }
  strut_put(writer, "]");
}

static void put_list(strut_writer *writer, const strut_key *key, const char *object) {
  const strut_field *field = &key->field;
  size_t count = *(const size_t *)(const void *)(object + field->number);
  const void *array, *second;
  memcpy(&array, object + field->offset, sizeof array);
  memcpy(&second, object + field->beside, sizeof second);
  if (field->type == STRUT_FIELD_INT32)
    put_references(writer, key, array, count);
  else if (field->type == STRUT_FIELD_INSTRUCTION)
    strut_put_program(writer, array, count);
  else if (field->type == STRUT_FIELD_NODE_SET)
    put_node_sets(writer, array, count);
  else
    put_numbers(writer, field, array, second, count);
}

/* ---- does an object have a value for a key? ---- */

/* By bits, so that 0 and -0 differ; texts by their characters. */
static bool values_equal(const strut_key *key, const void *first, const void *second) {
  if (key->field.type == STRUT_FIELD_TEXT)
    return strcmp(*(const char *const *)first, *(const char *const *)second) == 0;
  return memcmp(first, second, key->field.size) == 0;
}

static bool has_items(const strut_field *field, const char *object) {
  const void *array;
  memcpy(&array, object + field->offset, sizeof array);
  return array && *(const size_t *)(const void *)(object + field->number) > 0;
}

static bool has_references(const strut_field *field, const char *object) {
  const int32_t *index = (const int32_t *)(const void *)(object + field->offset);
  for (size_t k = 0; k < field->size / sizeof *index; k++)
    if (index[k] < 0) return false;
  return true;
}

static bool differs(const strut_key *key, const char *object, const char *usual) {
  const strut_field *field = &key->field;
  const char *value = object + field->offset;
  if (!strut_field_is_chosen(field, object)) return false;
  switch (field->role) {
    case STRUT_FIELD_VALUE:
      if (key->type == STRUT_TYPE_SIGNAL) return *(const int32_t *)(const void *)value >= 0;
      return field->chosen || !values_equal(key, value, usual + field->offset);
    case STRUT_FIELD_REFERENCE:
      return has_references(field, object) && (!strut_field_is_chosen(field, usual) ||
                                               !values_equal(key, value, usual + field->offset));
    case STRUT_FIELD_LIST: return has_items(field, object);
    case STRUT_FIELD_PATH:
    case STRUT_FIELD_PLACES: return true;
    case STRUT_FIELD_NESTED:
      if (key->type == STRUT_TYPE_LAW) {
        const strut_law *law = (const void *)value;
        return law->kind != STRUT_LAW_LINEAR || law->carries != STRUT_CARRIES_BOTH;
      }
      return field->chosen ||
             strut_fields_differ(strut_section_below(key), value, usual + field->offset);
    case STRUT_FIELD_BY_HAND:
    case STRUT_FIELD_NONE:
    case STRUT_FIELD_SECTION:
    case STRUT_FIELD_THINGS: break;
  }
  return false;
}

bool strut_fields_differ(strut_section section, const void *object, const void *usual) {
  for (int i = 0; i < strut_section_size(section); i++)
    if (differs(strut_key_at(strut_section_first(section) + i), object, usual)) return true;
  return false;
}

/* ---- mappings ---- */

static void put_nested(strut_writer *writer, const strut_key *key, const char *object,
                       const char *usual) {
  object += key->field.offset;
  if (key->type == STRUT_TYPE_LAW)
    strut_put_law(writer, (const void *)object);
  else
    strut_put_mapping(writer, strut_section_below(key), object, usual + key->field.offset, NULL);
}

/* The positions that are not as drawn. */
static void put_places(strut_writer *writer, const double (*position)[2]) {
  bool first = true;
  strut_put(writer, "{");
  for (size_t i = 0; i < writer->scene->node_count; i++) {
    const strut_node *node = &writer->scene->nodes[i];
    if (memcmp(position[i], node->position, sizeof node->position) == 0) continue;
    if (!first) strut_put(writer, ", ");
    first = false;
    strut_put_name(writer, node->name);
    strut_put(writer, ": ");
    strut_put_pair(writer, position[i]);
  }
  strut_put(writer, "}");
}

static void put_key(strut_writer *writer, const strut_key *key, const char *object,
                    const char *usual) {
  const void *value = object + key->field.offset;
  switch (key->field.role) {
    case STRUT_FIELD_VALUE:
      if (key->type == STRUT_TYPE_SIGNAL)
        strut_put_signal_reference(writer, *(const int32_t *)value);
      else
        put_value(writer, key, object);
      break;
    case STRUT_FIELD_REFERENCE:
      put_references(writer, key, value, key->field.size / sizeof(int32_t));
      break;
    case STRUT_FIELD_LIST: put_list(writer, key, object); break;
    case STRUT_FIELD_PATH: put_path(writer, &key->field, object); break;
    case STRUT_FIELD_PLACES: put_places(writer, *(const double(*const *)[2])value); break;
    case STRUT_FIELD_NESTED: put_nested(writer, key, object, usual); break;
    case STRUT_FIELD_BY_HAND:
    case STRUT_FIELD_NONE:
    case STRUT_FIELD_SECTION:
    case STRUT_FIELD_THINGS: assert(false);
  }
}

void strut_put_fields(strut_writer *writer, strut_mapping *mapping, strut_section section,
                      const void *object, const void *usual, strut_put_by_hand *by_hand) {
  for (int i = 0; i < strut_section_size(section); i++) {
    int index = strut_section_first(section) + i;
    const strut_key *key = strut_key_at(index);
    bool word = key->field.role == STRUT_FIELD_NONE && key->need == STRUT_REQUIRED;
    bool kept = key->field.role == STRUT_FIELD_VALUE && !key->field.chosen;
    if (word) { /* the only one that there is */
      put_key_text(writer, mapping, key->name);
      strut_put(writer, key->words);
    } else if (key->field.role == STRUT_FIELD_BY_HAND || key->field.role == STRUT_FIELD_SECTION ||
               key->field.role == STRUT_FIELD_THINGS || key->field.role == STRUT_FIELD_NONE) {
      if (by_hand) by_hand(writer, mapping, index, object);
    } else if ((kept && key->need != STRUT_OPTIONAL) || differs(key, object, usual)) {
      put_key_text(writer, mapping, key->name);
      put_key(writer, key, object, usual);
    }
  }
}

void strut_put_mapping(strut_writer *writer, strut_section section, const void *object,
                       const void *usual, strut_put_by_hand *by_hand) {
  strut_mapping mapping = STRUT_MAPPING_INLINE;
  strut_put(writer, "{");
  strut_put_fields(writer, &mapping, section, object, usual, by_hand);
  strut_put(writer, "}");
}

void strut_put_line(strut_writer *writer, const char *name, strut_section section,
                    const void *object, const void *usual, strut_put_by_hand *by_hand) {
  strut_put_name(writer, name);
  strut_put(writer, ": ");
  strut_put_mapping(writer, section, object, usual, by_hand);
  strut_put(writer, "\n");
}

void strut_put_things(strut_writer *writer, strut_thing kind, strut_section section,
                      const void *usual) {
  const strut_thing_row *row = strut_thing_at(kind);
  for (size_t i = 0; i < strut_thing_count(writer->scene, kind); i++) {
    strut_buffer_add(&writer->out, i ? "  " : "%s:\n  ", row->things);
    strut_put_line(writer, strut_thing_name(writer->scene, kind, i), section,
                   strut_thing_object(writer->scene, kind, i), usual ? usual : row->usual, NULL);
  }
}
