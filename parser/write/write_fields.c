/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Objects as mappings, by the rows of their sections, and all things of a kind. See writer.h. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "parser/write/writer.h"

/* ---- values ---- */

static void put_word(strut_writer *writer, const strut_key *key, int i) {
  char word[40];
  const char *found = strut_word_at(key->words, i, word, sizeof word);
  assert(found);
  if (found) strut_put(writer, found);
}

static void put_words(strut_writer *writer, const strut_key *key, uint32_t bits) {
  bool any = false;
  strut_put(writer, "[");
  for (int i = 0; i < 32; i++) {
    if (!(bits >> i & 1u)) continue;
    if (any) strut_put(writer, ", ");
    any = true;
    put_word(writer, key, i);
  }
  strut_put(writer, "]");
}

static void put_value(strut_writer *writer, const strut_key *key, const void *field) {
  switch (key->field.type) {
    case STRUT_FIELD_DOUBLE: strut_put_number(writer, *(const double *)field); break;
    case STRUT_FIELD_INT32: strut_put_number(writer, *(const int32_t *)field); break;
    case STRUT_FIELD_INT64: strut_put_number(writer, (double)*(const int64_t *)field); break;
    case STRUT_FIELD_UINT64: strut_put_number(writer, (double)*(const uint64_t *)field); break;
    case STRUT_FIELD_UINT32:
      if (key->type == STRUT_TYPE_WORDS)
        put_words(writer, key, *(const uint32_t *)field);
      else
        put_word(writer, key, (int)*(const uint32_t *)field);
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
    case STRUT_FIELD_OBJECT: assert(false);
  }
}

static void put_thing_name(strut_writer *writer, strut_thing kind, int32_t i) {
  strut_put_name(writer, strut_thing_name(writer->scene, kind, (size_t)i));
}

/* A name, or "[a, b]". */
static void put_references(strut_writer *writer, const strut_key *key, const int32_t *index,
                           size_t count) {
  bool list = count != 1 || key->field.role == STRUT_FIELD_LIST;
  for (size_t k = 0; k < count; k++) {
    if (list) strut_put(writer, k ? ", " : "[");
    put_thing_name(writer, key->field.kind, index[k]);
  }
  if (list) strut_put(writer, "]");
}

static void put_list(strut_writer *writer, const strut_key *key, const char *object) {
  size_t count = *(const size_t *)(const void *)(object + key->field.number);
  const double *number;
  memcpy(&number, object + key->field.offset, sizeof number);
  if (key->field.type == STRUT_FIELD_INT32) {
    put_references(writer, key, (const int32_t *)(const void *)number, count);
    return;
  }
  for (size_t k = 0; k < count; k++) {
    strut_put(writer, k ? ", " : "[");
    if (key->field.type == STRUT_FIELD_DOUBLE_PAIR)
      strut_put_pair(writer, number + 2 * k);
    else
      strut_put_number(writer, number[k]);
  }
  strut_put(writer, "]");
}

/* ---- does an object have a value for a key? ---- */

/* By bits, so that 0 and -0 differ; texts by their characters. */
static bool values_equal(const strut_key *key, const void *a, const void *b) {
  if (key->field.type == STRUT_FIELD_TEXT)
    return strcmp(*(const char *const *)a, *(const char *const *)b) == 0;
  return memcmp(a, b, key->field.size) == 0;
}

static bool is_chosen(const strut_field *field, const char *object) {
  if (field->tag_size == sizeof(bool))
    return *(const bool *)(object + field->tag) == (field->tag_value != 0);
  return *(const uint32_t *)(const void *)(object + field->tag) == field->tag_value;
}

static bool has_references(const strut_field *field, const char *object) {
  const int32_t *index = (const int32_t *)(const void *)(object + field->offset);
  for (size_t k = 0; k < field->size / sizeof *index; k++)
    if (index[k] < 0) return false;
  return true;
}

/* A law is written where it is not the linear one. */
static bool is_plain_law(const strut_law *law) {
  return law->kind == STRUT_LAW_LINEAR && law->carries == STRUT_CARRIES_BOTH;
}

static bool differs(const strut_key *key, const char *object, const char *usual) {
  const strut_field *field = &key->field;
  const char *value = object + field->offset;
  if (field->chosen && !is_chosen(field, object)) return false;
  switch (field->role) {
    case STRUT_FIELD_VALUE:
      if (key->type == STRUT_TYPE_SIGNAL) return *(const int32_t *)(const void *)value >= 0;
      return field->chosen || !values_equal(key, value, usual + field->offset);
    case STRUT_FIELD_REFERENCE: return has_references(field, object);
    case STRUT_FIELD_LIST: return *(const size_t *)(const void *)(object + field->number) > 0;
    case STRUT_FIELD_NESTED:
      if (key->type == STRUT_TYPE_LAW) return !is_plain_law((const void *)value);
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
  strut_mapping inner = STRUT_MAPPING_INLINE;
  if (key->type == STRUT_TYPE_LAW) {
    strut_put_law(writer, (const void *)(object + key->field.offset));
    return;
  }
  strut_put(writer, "{");
  strut_put_fields(writer, &inner, strut_section_below(key), object + key->field.offset,
                   usual + key->field.offset, NULL);
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
        put_value(writer, key, value);
      break;
    case STRUT_FIELD_REFERENCE:
      put_references(writer, key, value, key->field.size / sizeof(int32_t));
      break;
    case STRUT_FIELD_LIST: put_list(writer, key, object); break;
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
    bool kept = key->field.role == STRUT_FIELD_VALUE && !key->field.chosen;
    if (key->field.role == STRUT_FIELD_BY_HAND || key->field.role == STRUT_FIELD_SECTION ||
        key->field.role == STRUT_FIELD_THINGS || key->field.role == STRUT_FIELD_NONE) {
      if (by_hand) by_hand(writer, mapping, index, object);
    } else if ((kept && key->need != STRUT_OPTIONAL) || differs(key, object, usual)) {
      strut_put_key(writer, mapping, key->name);
      put_key(writer, key, object, usual);
    }
  }
}

void strut_put_things(strut_writer *writer, strut_thing kind, strut_section section,
                      const void *usual, strut_put_by_hand *by_hand) {
  const strut_thing_row *row = strut_thing_at(kind);
  size_t count = strut_thing_count(writer->scene, kind);
  if (count) strut_put(writer, row->things);
  if (count) strut_put(writer, ":\n");
  for (size_t i = 0; i < count; i++) {
    strut_mapping mapping = STRUT_MAPPING_INLINE;
    strut_put(writer, "  ");
    put_thing_name(writer, kind, (int32_t)i);
    strut_put(writer, ": {");
    strut_put_fields(writer, &mapping, section, strut_thing_object(writer->scene, kind, i),
                     usual ? usual : row->usual, by_hand);
    strut_put(writer, "}\n");
  }
}
