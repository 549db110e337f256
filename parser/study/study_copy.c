/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a study for another folder. See read_study.h. */
#include <string.h>

#include "parser/study/read_study.h"
#include "parser/write/writer.h"
#include "parser/yaml/text.h"

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/* Where the text of a node begins and ends. */
static void find_span(const strut_study_file *file, strut_place place, size_t *from, size_t *to) {
  strut_cursor at = strut_cursor_begin(file->text, file->length);
  strut_cursor_to_line(&at, place.line);
  while (at.column < place.column && strut_cursor_step(&at)) continue;
  *from = at.offset;
  strut_cursor_to_index(&at, at.index + place.length);
  *to = at.offset;
  while (*to > *from && is_blank(file->text[*to - 1])) --*to; /* of a block */
}

/* One line of comment; what would end it becomes a blank. */
static void put_note(strut_writer *w, const char *what, const char *text, const char *value) {
  const char *const parts[] = {text, value ? "=" : "", value ? value : ""};
  strut_put(w, "# ");
  strut_put(w, what);
  for (int i = 0; i < 3; i++)
    for (const char *at = parts[i]; *at;) {
      size_t length = 0, left = strlen(at), end = 0;
      while (at[length] && !end)
        if ((end = strut_text_break(at + length, left - length)) == 0) length++;
      strut_put_part(w, at, length);
      if (end) strut_put(w, " ");
      at += length + end;
    }
  strut_put(w, "\n");
}

char *strut_study_copy(const strut_study_file *file, const char *model,
                       const strut_override *overrides, size_t override_count) {
  strut_writer w = {.text = NULL};
  const strut_tree *node = strut_tree_find(file->document.root, "model", NULL);
  bool elsewhere = node && strcmp(node->text, model) != 0;
  size_t from = 0, to = 0;
  if (elsewhere) find_span(file, node->place, &from, &to);
  strut_put_part(&w, file->text, from);
  if (elsewhere) strut_put(&w, model);
  strut_put_part(&w, file->text + to, file->length - to);
  if (elsewhere || override_count) strut_put(&w, "\n");
  if (elsewhere) put_note(&w, "A copy; its model was ", node->text, NULL);
  for (size_t i = 0; i < override_count; i++)
    put_note(&w, "It was run with --set ", overrides[i].name, overrides[i].value);
  if (!w.failed) return w.text;
  strut_release(w.text);
  return NULL;
}
