/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/cluster/script_page.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"

static void put(strut_page *p, const char *bytes, size_t length) {
  if (p->room - p->length <= length) {
    size_t room = 2 * p->room + length + 1024;
    char *more = p->failed ? NULL : strut_reallocate(p->text, room, 1);
    p->failed = !more;
    if (!more) return;
    p->text = more;
    p->room = room;
  }
  memcpy(p->text + p->length, bytes, length);
  p->length += length;
  p->text[p->length] = '\0';
}

void strut_page_say(strut_page *p, const char *text) { put(p, text, strlen(text)); }

void strut_page_format(strut_page *p, const char *format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  strut_page_say(p, line);
}

void strut_page_word(strut_page *p, const char *word) {
  strut_page_say(p, "'");
  while (*word) {
    size_t length = strcspn(word, "'");
    put(p, word, length);
    word += length;
    if (!*word) break;
    strut_page_say(p, "'\\''");
    word++;
  }
  strut_page_say(p, "'");
}

void strut_page_assignment(strut_page *p, const char *name, const char *value) {
  strut_page_format(p, "%s=", name);
  strut_page_word(p, value);
  strut_page_say(p, "\n");
}
