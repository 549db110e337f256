/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "parser/yaml/document_parts.h"
#include "parser/yaml/text.h"

/* Forbidden characters that are reported one by one. */
enum { REPORT_MOST = 10 };

static strut_place place_of(const strut_cursor *cursor) {
  return (strut_place){cursor->line, cursor->column, 1};
}

/* Byte offset of the first character at or after `at` that is not allowed, or the length. */
static size_t find_forbidden(const char *text, size_t length, size_t at, uint32_t *code) {
  while (at < length) {
    unsigned char byte = (unsigned char)text[at];
    if (byte >= 0x20 && byte < 0x7F) {
      at++;
      continue;
    }
    size_t size = strut_text_decode(text + at, length - at, code);
    if (*code == STRUT_BAD_CODE || strut_text_forbidden(*code)) return at;
    at += size;
  }
  return length;
}

/* Reports one character; false where looking further would only repeat it. */
static bool report(strut_diagnostics *diagnostics, const strut_cursor *cursor, uint32_t code) {
  unsigned byte = (unsigned char)cursor->text[cursor->offset];
  if (code == STRUT_BAD_CODE) {
    strut_diagnose(diagnostics, place_of(cursor),
                   "byte 0x%02X is not valid UTF-8; save the file as UTF-8", byte);
    return false;
  }
  if (code == 0)
    strut_diagnose(diagnostics, place_of(cursor), "a NUL byte is not allowed");
  else if (code == 0xFEFF)
    strut_diagnose(diagnostics, place_of(cursor),
                   "a byte order mark is allowed only at the beginning of the file");
  else
    strut_diagnose(diagnostics, place_of(cursor), "control character U+%04X is not allowed",
                   (unsigned)code);
  return true;
}

static bool scan_characters(strut_diagnostics *diagnostics) {
  const char *text = diagnostics->text;
  size_t length = diagnostics->length, at = strut_text_mark(text, length);
  strut_cursor cursor = strut_cursor_begin(text, length);
  uint32_t code = 0;
  int reported = 0;
  while ((at = find_forbidden(text, length, at, &code)) < length && reported < REPORT_MOST) {
    strut_cursor_to_offset(&cursor, at);
    reported++;
    if (!report(diagnostics, &cursor, code)) break;
    at += strut_text_decode(text + at, length - at, &code);
  }
  return reported == 0;
}

/*
 * Directives stand before the document: libyaml is quadratic in their number, and one %YAML is all
 * that anybody needs.
 */
static bool scan_directives(strut_diagnostics *diagnostics) {
  strut_cursor cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  bool seen = false;
  while (cursor.offset < cursor.length) {
    const char *line = cursor.text + cursor.offset;
    size_t left = cursor.length - cursor.offset;
    size_t blanks = 0;
    while (blanks < left && (line[blanks] == ' ' || line[blanks] == '\t')) blanks++;
    bool nothing =
        blanks == left || line[blanks] == '#' || strut_text_break(line + blanks, left - blanks);
    if (*line == '%') {
      bool version = left > 6 && memcmp(line, "%YAML ", 6) == 0;
      if (!version || seen) {
        strut_diagnose(
            diagnostics, place_of(&cursor),
            version ? "a second %%YAML line" : "directives such as %%TAG are not allowed");
        return false;
      }
      seen = true;
    } else if (!nothing) {
      return true;
    }
    strut_cursor_to_line(&cursor, cursor.line + 1);
  }
  return true;
}

bool strut_document_scan(strut_diagnostics *diagnostics) {
  const char *text = diagnostics->text;
  size_t length = diagnostics->length;
  if (length > STRUT_TEXT_MOST) {
    strut_diagnose(diagnostics, (strut_place){0, 0, 0},
                   "the text has %zu MiB, at most %zu are read", length >> 20,
                   STRUT_TEXT_MOST >> 20);
    return false;
  }
  if (length >= 2 && (memcmp(text, "\xFF\xFE", 2) == 0 || memcmp(text, "\xFE\xFF", 2) == 0)) {
    strut_diagnose(diagnostics, (strut_place){0, 0, 0}, "the file is UTF-16; save it as UTF-8");
    return false;
  }
  return scan_characters(diagnostics) && scan_directives(diagnostics);
}
