/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Templates to text; templates.h says how they are written. */
#include <assert.h>
#include <stdbool.h>
#include <string.h>

#include "engine/output/code/writer.h"

enum { MOST_NESTED = 8 };

/* Which of the nested conditions hold. */
typedef struct conditions {
  bool holds[MOST_NESTED];
  int depth;
} conditions;

static size_t word_length(const char *text) {
  return strspn(text, "abcdefghijklmnopqrstuvwxyz_0123456789");
}

static bool all_hold(const strut_code_writer *w, const char *line, const char *end) {
  bool all = true;
  while (line < end) {
    line += strspn(line, " ");
    bool not = *line == '!';
    if (not ) line++;
    size_t length = word_length(line);
    if (!length) break;
    all = all && strut_code_has(w, line, length) != not ;
    line += length;
  }
  return all;
}

static bool is_shown(const conditions *c) {
  bool shown = true;
  for (int i = 0; i < c->depth; i++) shown = shown && c->holds[i];
  return shown;
}

static void add_line(strut_code_writer *w, const char *line, const char *end) {
  while (line < end) {
    size_t plain = strcspn(line, "$@");
    if (plain > (size_t)(end - line)) plain = (size_t)(end - line);
    if (plain) strut_buffer_add(&w->text, "%.*s", (int)plain, line);
    line += plain;
    if (line >= end) break;
    if (*line++ == '$') {
      strut_buffer_add(&w->text, "%s", w->options->prefix);
    } else if (*line == '_') {
      strut_buffer_add(&w->text, "%s", w->upper);
    } else {
      size_t length = word_length(line);
      strut_code_add_part(w, line, length);
      line += length;
    }
  }
}

static bool starts(const char *line, const char *word) {
  return !strncmp(line, word, strlen(word));
}

void strut_code_expand(strut_code_writer *w, const char *template) {
  conditions c = {.depth = 0};
  for (const char *line = template, *end; *line; line = end) {
    end = line + strcspn(line, "\n");
    end += *end == '\n';
    if (starts(line, "@if ")) {
      assert(c.depth < MOST_NESTED);
      c.holds[c.depth++] = all_hold(w, line + 4, end - 1);
    } else if (starts(line, "@else")) {
      c.holds[c.depth - 1] = !c.holds[c.depth - 1];
    } else if (starts(line, "@end")) {
      c.depth--;
    } else if (!is_shown(&c)) {
      continue;
    } else if (starts(line, "@table ")) {
      strut_code_add_part(w, line + 7, word_length(line + 7));
    } else {
      add_line(w, line, end);
    }
  }
  assert(c.depth == 0);
}
