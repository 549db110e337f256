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
    strut_buffer_add(&writer->out, "%s`%s`", i == 0 ? "" : last ? " or " : ", ", word);
  }
}

static void put_unit(strut_writer *writer, const strut_key *key) {
  bool number = key->type == STRUT_TYPE_NUMBER || key->type == STRUT_TYPE_PAIR;
  if (!number || key->measure == STRUT_MEASURE_NONE) return;
  if (key->measure == STRUT_MEASURE_CONTEXT)
    strut_put(writer, " in a unit that depends on its use");
  else
    strut_buffer_add(&writer->out, " [%s]",
                     strut_dimension_unit(strut_measure_dimension(key->measure)));
}

static void put_section_link(strut_writer *writer, const char *name) {
  char letter[2] = "";
  strut_put(writer, "[mapping](#");
  for (; *name; name++) {
    letter[0] = *name == ' ' ? '-' : *name;
    strut_put(writer, letter);
  }
  strut_put(writer, ")");
}

static void put_limits(strut_writer *writer, const strut_key *key) {
  const strut_key_limits limits = key->limits;
  bool context = key->measure == STRUT_MEASURE_CONTEXT;
  if (limits.range == STRUT_RANGE_NOT_NEGATIVE) strut_put(writer, ", not negative");
  if (limits.range == STRUT_RANGE_ABOVE_ZERO) strut_put(writer, ", positive");
  if (limits.range == STRUT_RANGE_SHARE)
    strut_buffer_add(&writer->out, ", positive, %sat most %g %%", context ? "without a unit " : "",
                     100.0 * limits.most);
  if (limits.range == STRUT_RANGE_WHOLE)
    strut_buffer_add(&writer->out, " from %.0f to %.0f", limits.least, limits.most);
  if (limits.range == STRUT_RANGE_COUNT)
    strut_buffer_add(&writer->out, "; %.0f to %.0f of them", limits.least, limits.most);
}

void strut_put_key_type(strut_writer *writer, const strut_key *key) {
  if (key->type == STRUT_TYPE_MAP) {
    put_section_link(writer, strut_section_name(strut_section_below(key)));
    return;
  }
  bool signal = key->measure == STRUT_MEASURE_CONTEXT;
  if (key->type == STRUT_TYPE_EXPRESSION)
    strut_put(writer, signal ? "expression of `t` and sensors" : "expression of columns");
  if (key->limits.range == STRUT_RANGE_WHOLE) strut_put(writer, "whole ");
  strut_put(writer, strut_type_reference(key->type));
  if (key->type == STRUT_TYPE_THINGS || key->type == STRUT_TYPE_FREE) {
    strut_put(writer, key->words);
  } else if (*key->words && key->type != STRUT_TYPE_NAMES) {
    put_words(writer, key->words);
  }
  put_unit(writer, key);
  put_limits(writer, key);
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
  const strut_key *keys = strut_key_at(strut_section_first(section));
  const strut_key *end = keys + strut_section_size(section);
  strut_buffer_add(&writer->out, "\n## %s\n\n%s\n\n", strut_section_name(section),
                   strut_section_introduction(section));
  strut_put(writer, "| key | value | default | meaning |\n|---|---|---|---|\n");
  for (const strut_key *key = keys; key < end; key++) {
    const char *tick = !*key->fallback || strut_default_is_described(key) ? "" : "`";
    strut_buffer_add(&writer->out, "| `%s` | ", key->name);
    if (has_many_words(key))
      strut_put(writer, "list of quantities, or of the words below");
    else
      strut_put_key_type(writer, key);
    strut_put(writer, key->need == STRUT_REQUIRED ? " | required" : *key->fallback ? " | " : " |");
    strut_buffer_add(&writer->out, "%s%s%s | %s |\n", tick, key->fallback, tick, key->description);
  }
  for (const strut_key *key = keys; key < end; key++) {
    if (!has_many_words(key)) continue;
    strut_buffer_add(&writer->out, "\nWords of `%s`: ", key->name);
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
  strut_buffer_add(&head.out, "%s: ", key->name);
  strut_put_key_type(&head, key);
  strut_buffer_add(&head.out, "%s%s%s", key->need == STRUT_REQUIRED ? "; required" : "",
                   *key->fallback ? "; default " : "", key->fallback);
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
    strut_buffer_add(&result.out, "%sin %s:\n", result.out.length ? "\n" : "",
                     strut_section_name((strut_section)i));
    put_key(&result, strut_key_at(key));
  }
  return strut_buffer_take(&result.out);
}
