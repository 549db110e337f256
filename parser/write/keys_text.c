/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/write/keys_text.h"

#include <string.h>

#include "parser/write/key_text.h"

enum { WIDTH = 79, INDENT = 4 };

/* Words of Markdown as lines of up to WIDTH columns (bytes), each begun by `indent` spaces. */
static void put_wrapped(strut_writer *writer, const char *markdown, int indent) {
  strut_writer plain = {.text = NULL};
  strut_put_without_links(&plain, markdown, false);
  if (plain.failed) writer->failed = true;
  size_t column = 0;
  for (const char *word = plain.failed ? "" : plain.text; word && *word;) {
    size_t length = strcspn(word, " ");
    if (column && column + 1 + length > WIDTH) column = 0, strut_put(writer, "\n");
    for (; column < (size_t)indent; column++) strut_put(writer, " ");
    if (column > (size_t)indent) column++, strut_put(writer, " ");
    strut_put_part(writer, word, length);
    column += length;
    word += length + strspn(word + length, " ");
  }
  strut_put(writer, "\n");
  strut_release(plain.text);
}

static void put_key(strut_writer *writer, const strut_key *key) {
  strut_writer head = {.text = NULL};
  strut_put(&head, key->name);
  strut_put(&head, ": ");
  strut_put_key_type(&head, key);
  if (key->need == STRUT_REQUIRED) strut_put(&head, "; required");
  if (*key->fallback) strut_put(&head, "; default ");
  strut_put(&head, key->fallback);
  if (head.failed) writer->failed = true;
  strut_put(writer, "\n");
  if (!head.failed) put_wrapped(writer, head.text, 0);
  put_wrapped(writer, key->description, INDENT);
  strut_release(head.text);
}

char *strut_keys_text(strut_section section) {
  strut_writer result = {.text = NULL};
  put_wrapped(&result, strut_section_introduction(section), 0);
  for (int i = 0; i < strut_section_size(section); i++)
    put_key(&result, strut_key_at(strut_section_first(section) + i));
  if (!result.failed) return result.text;
  strut_release(result.text);
  return NULL;
}
