/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/buffer.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"

/* ---- CSV ---- */

static bool needs_quotes(const char *text, size_t length) {
  bool needed = false;
  for (size_t i = 0; i < length; i++)
    needed = needed || text[i] == ',' || text[i] == '"' || text[i] == '\r' || text[i] == '\n';
  return needed;
}

/* Would a spreadsheet compute the text? A sign before a number makes a number. */
static bool is_formula(const char *text, size_t length) {
  if (length < 2 || !strchr("=@+-", text[0])) return false;
  return text[0] == '=' || text[0] == '@' || !strchr("0123456789.i", text[1]);
}

size_t strut_csv_quote(const char *text, size_t length, char *cell) {
  size_t written = 0;
  length = strnlen(text, length);
  bool quoted = needs_quotes(text, length);
  if (quoted) cell[written++] = '"';
  if (is_formula(text, length)) cell[written++] = '\'';
  for (size_t i = 0; i < length; i++) {
    if (text[i] == '"') cell[written++] = '"';
    cell[written++] = text[i];
  }
  if (quoted) cell[written++] = '"';
  return written;
}

void strut_csv_add_text(strut_buffer *csv, const char *format, ...) {
  strut_buffer text = {0};
  va_list arguments;
  va_start(arguments, format);
  strut_buffer_add_list(&text, format, arguments);
  va_end(arguments);
  if (text.failed || !strut_buffer_reserve(csv, 2 * text.length + 2)) {
    csv->failed = true;
  } else {
    csv->length += strut_csv_quote(text.text, text.length, csv->text + csv->length);
    csv->text[csv->length] = '\0';
  }
  strut_release(text.text);
}

void strut_csv_add_number(strut_buffer *csv, double value) {
  char text[STRUT_NUMBER_TEXT] = "";
  if (!isnan(value)) strut_number_text(value, text);
  strut_buffer_add(csv, "%s", text);
}

/* ---- base 64 ---- */

enum { AT_ONCE = 3072 };

static size_t encode(const unsigned char *bytes, size_t count, char *text) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char *at = text;
  for (size_t i = 0; i < count; i += 3) {
    size_t left = count - i;
    uint32_t group = (uint32_t)bytes[i] << 16;
    if (left > 1) group |= (uint32_t)bytes[i + 1] << 8;
    if (left > 2) group |= bytes[i + 2];
    *at++ = letters[group >> 18];
    *at++ = letters[group >> 12 & 63];
    *at++ = left > 1 ? letters[group >> 6 & 63] : '=';
    *at++ = left > 2 ? letters[group & 63] : '=';
  }
  return (size_t)(at - text);
}

void strut_base64_add(strut_buffer *buffer, const void *bytes, size_t count) {
  char text[AT_ONCE / 3 * 4];
  const unsigned char *from = bytes;
  for (size_t done = 0; done < count; done += AT_ONCE) {
    size_t part = count - done < AT_ONCE ? count - done : AT_ONCE;
    int length = (int)encode(from + done, part, text);
    strut_buffer_add(buffer, "%.*s", length, text);
  }
}
