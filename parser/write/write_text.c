/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Growing YAML text: numbers, names, quoted texts. See writer.h. */
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
