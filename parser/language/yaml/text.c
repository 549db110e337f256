/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/yaml/text.h"

#include <stdint.h>
#include <string.h>

static bool continues(unsigned char byte) { return (byte & 0xC0) == 0x80; }

size_t strut_text_decode(const char *text, size_t left, uint32_t *code) {
  const unsigned char *b = (const unsigned char *)text;
  if (b[0] < 0x80) {
    *code = b[0];
    return 1;
  }
  size_t size = b[0] >= 0xF0 ? 4 : b[0] >= 0xE0 ? 3 : 2;
  static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
  *code = STRUT_BAD_CODE;
  if (b[0] < 0xC2 || b[0] > 0xF4 || left < size) return 1;
  uint32_t value = b[0] & (0x7Fu >> size);
  for (size_t i = 1; i < size; i++) {
    if (!continues(b[i])) return 1;
    value = value << 6 | (b[i] & 0x3Fu);
  }
  if (value < least[size] || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) return 1;
  *code = value;
  return size;
}

size_t strut_text_break(const char *text, size_t left) {
  const unsigned char *b = (const unsigned char *)text;
  if (!left) return 0;
  if (b[0] == '\n') return 1;
  if (b[0] == '\r') return left > 1 && b[1] == '\n' ? 2 : 1;
  if (b[0] == 0xC2) return left > 1 && b[1] == 0x85 ? 2 : 0;
  if (b[0] == 0xE2) return left > 2 && b[1] == 0x80 && (b[2] == 0xA8 || b[2] == 0xA9) ? 3 : 0;
  return 0;
}

size_t strut_text_points(const char *text, size_t length) {
  size_t points = 0;
  uint32_t code;
  for (size_t at = 0; at < length; points++) at += strut_text_decode(text + at, length - at, &code);
  return points;
}

int strut_text_cut(const char *text, int most) {
  int length = (int)strnlen(text, (size_t)most + 1);
  if (length <= most) return length;
  for (length = most; length && continues((unsigned char)text[length]); length--) continue;
  return length;
}

size_t strut_text_mark(const char *text, size_t length) {
  return length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
}

bool strut_text_forbidden(uint32_t code) {
  if (code < 0x20) return code != '\t' && code != '\n' && code != '\r';
  if (code < 0x7F) return false;
  return (code < 0xA0 && code != 0x85) || code == 0xFEFF || code == 0xFFFE || code == 0xFFFF ||
         code > 0x10FFFF;
}

bool strut_text_hidden(uint32_t code) {
  return (code >= 0x80 && code < 0xA0) || code == 0x61C || code == 0x180E || code == 0x200B ||
         code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF ||
         (code >= 0xFFF9 && code <= 0xFFFB) || (code >= 0xE0000 && code <= 0xE0FFF);
}

strut_cursor strut_cursor_begin(const char *text, size_t length) {
  return (strut_cursor){.text = text,
                        .length = length,
                        .offset = strut_text_mark(text, length),
                        .line = 1,
                        .column = 1};
}

bool strut_cursor_step(strut_cursor *cursor) {
  if (cursor->offset >= cursor->length) return false;
  const char *here = cursor->text + cursor->offset;
  size_t left = cursor->length - cursor->offset, size = strut_text_break(here, left);
  if (size) {
    cursor->index += *here == '\r' ? size : 1; /* CR LF is two code points, the others are one */
    cursor->line++;
    cursor->column = 1;
  } else {
    uint32_t code;
    size = strut_text_decode(here, left, &code);
    cursor->index++;
    cursor->column++;
  }
  cursor->offset += size;
  return true;
}

void strut_cursor_to_offset(strut_cursor *cursor, size_t offset) {
  while (cursor->offset < offset && strut_cursor_step(cursor)) continue;
}

/* Steps over printable ASCII up to an index, as most of a text is. */
static void step_over_ascii(strut_cursor *cursor, size_t index) {
  size_t most = index - cursor->index, left = cursor->length - cursor->offset, steps = 0;
  const char *here = cursor->text + cursor->offset;
  if (most > left) most = left;
  while (steps < most && here[steps] >= ' ' && here[steps] < 0x7F) steps++;
  cursor->offset += steps;
  cursor->index += steps;
  cursor->column += (uint32_t)steps;
}

void strut_cursor_to_index(strut_cursor *cursor, size_t index) {
  do
    if (cursor->index < index) step_over_ascii(cursor, index);
  while (cursor->index < index && strut_cursor_step(cursor));
}

void strut_cursor_to_line(strut_cursor *cursor, uint32_t line) {
  while (cursor->line < line && strut_cursor_step(cursor)) continue;
}
