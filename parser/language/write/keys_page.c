/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reference of keys: docs/language-keys.md, and what `strut keys` prints. See writer.h. */
#include "parser/language/write/writer.h"

#include <string.h>

#include "parser/language/keys/keys.h"

/* "none, x, y or both", each in code style. */
static void put_words(strut_writer *writer, const char *words) {
  char word[40], next[40];
  for (int i = 0; strut_word_at(words, i, word, sizeof word); i++) {
    bool last = !strut_word_at(words, i + 1, next, sizeof next);
    strut_put(writer, i == 0 ? "`" : last ? " or `" : ", `");
    strut_put(writer, word);
    strut_put(writer, "`");
  }
}

static void put_unit(strut_writer *writer, const strut_key *key) {
  bool number = key->type == STRUT_TYPE_NUMBER || key->type == STRUT_TYPE_PAIR;
  if (!number || key->measure == STRUT_MEASURE_NONE) return;
  if (key->measure == STRUT_MEASURE_CONTEXT) {
    strut_put(writer, " in a unit that depends on its use");
    return;
  }
  strut_put(writer, " [");
  strut_put(writer, strut_dimension_unit(strut_measure_dimension(key->measure)));
  strut_put(writer, "]");
}

/* A link to the heading of a section. */
static void put_section_link(strut_writer *writer, const char *name) {
  char letter[2] = "";
  strut_put(writer, "[mapping](#");
  for (; *name; name++) {
    letter[0] = *name == ' ' ? '-' : *name;
    strut_put(writer, letter);
  }
  strut_put(writer, ")");
}

static void put_limits(strut_writer *writer, strut_key_limits limits) {
  switch (limits.range) {
    case STRUT_RANGE_NOT_NEGATIVE: strut_put(writer, ", not negative"); break;
    case STRUT_RANGE_ABOVE_ZERO: strut_put(writer, ", positive"); break;
    case STRUT_RANGE_WHOLE:
      strut_put(writer, " from ");
      strut_put_number(writer, limits.least);
      strut_put(writer, " to ");
      strut_put_number(writer, limits.most);
      break;
    case STRUT_RANGE_ANY: break;
  }
}

static void put_expression_type(strut_writer *writer, const strut_key *key) {
  bool signal = key->measure == STRUT_MEASURE_CONTEXT;
  strut_put(writer, signal ? "expression of `t` and sensors" : "expression of columns");
}

void strut_put_key_type(strut_writer *writer, const strut_key *key) {
  if (key->type == STRUT_TYPE_MAP) {
    put_section_link(writer, strut_section_name(strut_section_below(key)));
    return;
  }
  if (key->type == STRUT_TYPE_EXPRESSION) put_expression_type(writer, key);
  if (key->limits.range == STRUT_RANGE_WHOLE) strut_put(writer, "whole ");
  strut_put(writer, strut_type_reference(key->type));
  if (key->type == STRUT_TYPE_THINGS || key->type == STRUT_TYPE_FREE) {
    strut_put(writer, key->words);
  } else if (*key->words && key->type != STRUT_TYPE_NAMES) {
    put_words(writer, key->words);
  }
  put_unit(writer, key);
  put_limits(writer, key->limits);
}

bool strut_default_is_described(const strut_key *key) {
  return strchr(key->fallback, ' ') && !strchr(key->fallback, '[');
}

void strut_put_without_links(strut_writer *writer, const char *markdown, bool ticks) {
  for (const char *c = markdown; *c; c++) {
    const char *close = *c == '[' ? strchr(c, ']') : NULL;
    const char *end = close && close[1] == '(' ? strchr(close, ')') : NULL;
    if (end) {
      strut_put_part(writer, c + 1, (size_t)(close - c - 1));
      c = end;
    } else if (ticks || *c != '`') {
      strut_put_part(writer, c, 1);
    }
  }
}

/* Do the words of the key fill more than a cell of a table? They stand below it then. */
static bool has_many_words(const strut_key *key) {
  char word[40];
  enum { MOST_WORDS = 30 };
  return key->type == STRUT_TYPE_KEEP && strut_word_at(key->words, MOST_WORDS, word, sizeof word);
}

static void put_section(strut_writer *writer, strut_section section) {
  strut_put(writer, "\n## ");
  strut_put(writer, strut_section_name(section));
  strut_put(writer, "\n\n");
  strut_put(writer, strut_section_introduction(section));
  strut_put(writer, "\n\n| key | value | default | meaning |\n|---|---|---|---|\n");
  for (int i = 0; i < strut_section_size(section); i++) {
    const strut_key *key = strut_key_at(strut_section_first(section) + i);
    bool words = strut_default_is_described(key);
    strut_put(writer, "| `");
    strut_put(writer, key->name);
    strut_put(writer, "` | ");
    if (has_many_words(key))
      strut_put(writer, "list of quantities, or of the words below");
    else
      strut_put_key_type(writer, key);
    strut_put(writer, key->need == STRUT_REQUIRED ? " | required"
                      : *key->fallback            ? words ? " | " : " | `"
                                                  : " |");
    strut_put(writer, key->fallback);
    strut_put(writer, *key->fallback && !words ? "` | " : " | ");
    strut_put(writer, key->description);
    strut_put(writer, " |\n");
  }
  for (int i = 0; i < strut_section_size(section); i++) {
    const strut_key *key = strut_key_at(strut_section_first(section) + i);
    if (!has_many_words(key)) continue;
    strut_put(writer, "\nWords of `");
    strut_put(writer, key->name);
    strut_put(writer, "`: ");
    put_words(writer, key->words);
    strut_put(writer, ".\n");
  }
}

char *strut_keys_page(void) {
  strut_writer result = {.scene = NULL};
  strut_put(
      &result,
      "<!-- Generated by `strut keys` from parser/language/keys/keys_table.h; do not edit. -->\n"
      "# Keys of the language, version 1\n\n"
      "A number is an expression with units, such as `2*amplitude + 0.1 mm`; a number "
      "without a unit is "
      "in the SI unit in brackets.\nGroups may have the keys of a [member](#member), a "
      "[node](#node) or "
      "a [contact](#contact), except `group`.\n");
  for (int section = 0; section < STRUT_SECTION_COUNT; section++)
    put_section(&result, (strut_section)section);
  return strut_buffer_take(&result.out);
}

/* ---- for the terminal ---- */

enum { WIDTH = 79, INDENT = 4 };

/* Words of Markdown as lines of up to WIDTH columns (bytes), each begun by `indent` spaces. */
static void put_wrapped(strut_writer *writer, const char *markdown, int indent) {
  strut_writer plain = {.scene = NULL};
  strut_put_without_links(&plain, markdown, false);
  if (plain.out.failed) writer->out.failed = true;
  size_t column = 0;
  for (const char *word = plain.out.failed ? "" : plain.out.text; word && *word;) {
    size_t length = strcspn(word, " ");
    if (column && column + 1 + length > WIDTH) column = 0, strut_put(writer, "\n");
    for (; column < (size_t)indent; column++) strut_put(writer, " ");
    if (column > (size_t)indent) column++, strut_put(writer, " ");
    strut_put_part(writer, word, length);
    column += length;
    word += length + strspn(word + length, " ");
  }
  strut_put(writer, "\n");
  strut_release(plain.out.text);
}

static void put_key(strut_writer *writer, const strut_key *key) {
  strut_writer head = {.scene = NULL};
  strut_put(&head, key->name);
  strut_put(&head, ": ");
  strut_put_key_type(&head, key);
  if (key->need == STRUT_REQUIRED) strut_put(&head, "; required");
  if (*key->fallback) strut_put(&head, "; default ");
  strut_put(&head, key->fallback);
  if (head.out.failed) writer->out.failed = true;
  strut_put(writer, "\n");
  if (!head.out.failed) put_wrapped(writer, head.out.text, 0);
  put_wrapped(writer, key->description, INDENT);
  strut_release(head.out.text);
}

char *strut_keys_text(strut_section section) {
  strut_writer result = {.scene = NULL};
  put_wrapped(&result, strut_section_introduction(section), 0);
  for (int i = 0; i < strut_section_size(section); i++)
    put_key(&result, strut_key_at(strut_section_first(section) + i));
  return strut_buffer_take(&result.out);
}

char *strut_keys_named(const char *name) {
  strut_writer result = {.scene = NULL};
  for (int i = 0; i < STRUT_SECTION_COUNT; i++) {
    int key = strut_key_find((strut_section)i, name);
    if (key < 0) continue;
    strut_put(&result, result.out.length ? "\nin " : "in ");
    strut_put(&result, strut_section_name((strut_section)i));
    strut_put(&result, ":\n");
    put_key(&result, strut_key_at(key));
  }
  return strut_buffer_take(&result.out);
}
