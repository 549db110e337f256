/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/yaml/memory_estimate.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "engine/base/memory_limit.h"
#include "parser/yaml/rows.h"

/* MOST_PER_BYTE: largest number of bytes of tree per byte of text, as in [1,2,3]. */
enum { DEPTH_MOST = 64, WORDS = 400, SHORT = 100000, MOST_PER_BYTE = 1 + sizeof(strut_tree) / 2 };

/* State of the scan: the open brackets and the previous character. */
typedef struct scan_state {
  uint64_t list; /* bit d: the bracket at depth d is a list's */
  int depth;
  double values;
  char before;
} scan_state;

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* The end of the comment or quoted text that begins at `at`; `at` if none begins there. */
static size_t skip_text(const scan_state *l, const char *text, size_t length, size_t at) {
  char c = text[at];
  bool begins = is_blank(l->before) || l->before == '[' || l->before == '{' || l->before == ',';
  if (!begins || (c != '#' && c != '"' && c != '\'')) return at;
  char end = c == '#' ? '\n' : c;
  size_t i = at + 1;
  while (i < length && text[i] != end) i += c == '"' && text[i] == '\\' ? 2 : 1;
  return i < length ? i : length;
}

/* Two values per colon, and one per comma of a bracketed list and for its first item. */
static void count_values(scan_state *l, char c, char next) {
  bool listed = l->depth > 0 && l->depth < DEPTH_MOST && (l->list >> l->depth & 1);
  if (c == ':' && is_blank(next)) l->values += 2.0;
  if (c == ',' && listed) l->values += 1.0;
  if (c == '[' || c == '{') {
    if (++l->depth < DEPTH_MOST) {
      l->list = (l->list & ~((uint64_t)1 << l->depth)) | (uint64_t)(c == '[') << l->depth;
    }
    if (c == '[' && next != ']') l->values += 1.0;
  }
  if ((c == ']' || c == '}') && l->depth > 0) l->depth--;
}

/* Bytes of the row at the beginning of a line whose value may be deferred, or 0. */
static size_t measure_deferrable(const scan_state *l, const char *text, size_t length) {
  strut_row row;
  bool begins = l->before == '\n' && l->depth == 0;
  return begins && strut_row_read(text, length, &row) && strut_row_is_deferrable(&row) ? row.length
                                                                                       : 0;
}

/* `deferred`: rows that may be are not read, so that they are two values each. */
static double estimate_needs(const char *text, size_t length, bool deferred) {
  scan_state l = {.before = '\n'};
  for (size_t at = 0; at < length; at++) {
    size_t row = deferred ? measure_deferrable(&l, text + at, length - at) : 0;
    if (row) {
      l.values += 2.0;
      at += row - 1;
      continue; /* a row ends in a line feed, as the character before it */
    }
    at = skip_text(&l, text, length, at);
    if (at >= length) break;
    count_values(&l, text[at], at + 1 < length ? text[at + 1] : '\n');
    l.before = text[at];
  }
  return l.values * (double)sizeof(strut_tree) + (double)length;
}

double strut_document_needs(const char *text, size_t length) {
  return estimate_needs(text, length, false);
}

static const char *name_text(const char *name, char words[WORDS]) {
  snprintf(words, WORDS, "reading '%.300s'", name);
  return words;
}

strut_status strut_memory_check_document(const char *name, const char *text, size_t length,
                                         strut_error *error) {
  char words[WORDS];
  const char *whose;
  if (length < SHORT || MOST_PER_BYTE * (double)length <= strut_memory_most(&whose))
    return STRUT_OK;
  return strut_memory_check(estimate_needs(text, length, true), name_text(name, words), error);
}

strut_status strut_memory_fail_document(const char *name, const char *text, size_t length,
                                        strut_error *error) {
  char words[WORDS];
  return strut_memory_fail(estimate_needs(text, length, true), name_text(name, words), error);
}
