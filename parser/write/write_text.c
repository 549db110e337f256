/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Growing YAML text: numbers, names, quoted texts, and the fields of a section. See writer.h. */
#include <assert.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "parser/write/writer.h"
#include "parser/yaml/text.h"

void strut_put_part(strut_writer *writer, const char *text, size_t length) {
  if (writer->failed) return;
  if (writer->length + length + 1 > writer->capacity) {
    size_t capacity = 2 * (writer->capacity + length + 1);
    char *bigger = strut_reallocate(writer->text, capacity, 1);
    if (!bigger) {
      writer->failed = true;
      return;
    }
    writer->text = bigger;
    writer->capacity = capacity;
  }
  memcpy(writer->text + writer->length, text, length);
  writer->length += length;
  writer->text[writer->length] = '\0';
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
  bool plain = *name && *name != '-' && *name != '.';
  for (const char *c = name; *c && plain; c++)
    plain = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9') ||
            *c == '_' || *c == '-' || *c == '.';
  if (plain)
    strut_put(writer, name);
  else
    strut_put_quoted(writer, name);
}

void strut_put_key(strut_writer *writer, strut_mapping *mapping, const char *key) {
  strut_put(writer, mapping->separator);
  mapping->separator = mapping->next;
  strut_put(writer, key);
  strut_put(writer, ": ");
}

void strut_put_key_name(strut_writer *writer, strut_mapping *mapping, int key) {
  strut_put_key(writer, mapping, strut_key_at(key)->name);
}

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

static void put_field(strut_writer *writer, const strut_key *key, const void *field) {
  switch (key->field.kind) {
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
    case STRUT_FIELD_BY_HAND: assert(false);
  }
}

/* By bits, so that 0 and -0 differ; texts by their characters. */
static bool fields_equal(const strut_key *key, const void *a, const void *b) {
  static const size_t sizes[] = {
      [STRUT_FIELD_DOUBLE] = sizeof(double),          [STRUT_FIELD_INT32] = sizeof(int32_t),
      [STRUT_FIELD_UINT32] = sizeof(uint32_t),        [STRUT_FIELD_INT64] = sizeof(int64_t),
      [STRUT_FIELD_UINT64] = sizeof(uint64_t),        [STRUT_FIELD_BOOL] = sizeof(bool),
      [STRUT_FIELD_DOUBLE_PAIR] = 2 * sizeof(double), [STRUT_FIELD_BOOL_PAIR] = 2 * sizeof(bool)};
  if (key->field.kind == STRUT_FIELD_TEXT)
    return strcmp(*(const char *const *)a, *(const char *const *)b) == 0;
  return memcmp(a, b, sizes[key->field.kind]) == 0;
}

static bool differs(const strut_key *key, const void *object, const void *usual) {
  const char *a = object, *b = usual;
  if (key->field.kind == STRUT_FIELD_BY_HAND) return false;
  return !fields_equal(key, a + key->field.offset, b + key->field.offset);
}

void strut_put_fields(strut_writer *writer, strut_mapping *mapping, strut_section section,
                      const void *object, const void *usual, strut_put_by_hand *by_hand) {
  for (int i = 0; i < strut_section_size(section); i++) {
    int index = strut_section_first(section) + i;
    const strut_key *key = strut_key_at(index);
    if (key->field.kind == STRUT_FIELD_BY_HAND) {
      if (by_hand) by_hand(writer, mapping, index, object);
    } else if (key->need != STRUT_OPTIONAL || differs(key, object, usual)) {
      strut_put_key(writer, mapping, key->name);
      put_field(writer, key, (const char *)object + key->field.offset);
    }
  }
}

bool strut_fields_differ(strut_section section, const void *object, const void *usual) {
  for (int i = 0; i < strut_section_size(section); i++)
    if (differs(strut_key_at(strut_section_first(section) + i), object, usual)) return true;
  return false;
}
