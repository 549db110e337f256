/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/write/write_tree.h"

#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/write/writer.h"
#include "parser/yaml/text.h"

enum { WIDTH = 100, TOO_WIDE = WIDTH + 1 };

static bool is_plain(const strut_tree *scalar) {
  return !scalar->quoted && !strpbrk(scalar->text, "\n\r");
}

/* ---- on one line ---- */

/* Columns of the value within braces; TOO_WIDE: more than there are, or it cannot stand there. */
static size_t inline_width(const strut_tree *value) {
  size_t width = 2;
  if (value->kind == STRUT_TREE_SCALAR) {
    bool plain = is_plain(value);
    if (plain && (!*value->text || strpbrk(value->text, ",[]{}:?#"))) return TOO_WIDE;
    width = strnlen(value->text, WIDTH) + (plain ? 0 : 2);
    return width > WIDTH ? TOO_WIDE : width;
  }
  for (const strut_tree *child = value->first; child; child = child->next) {
    width += inline_width(child) + 2;
    if (width > WIDTH) return TOO_WIDE;
  }
  return width;
}

static void put_scalar(strut_writer *w, const strut_tree *value) {
  if (is_plain(value))
    strut_put(w, value->text);
  else
    strut_put_quoted(w, value->text);
}

static void put_inline(strut_writer *w, const strut_tree *value) {
  if (value->kind == STRUT_TREE_SCALAR) {
    put_scalar(w, value);
    return;
  }
  bool map = value->kind == STRUT_TREE_MAP;
  strut_put(w, map ? "{" : "[");
  for (const strut_tree *child = value->first; child; child = child->next) {
    if (child != value->first) strut_put(w, ", ");
    put_inline(w, child);
    if (!map) continue;
    strut_put(w, ": ");
    child = child->next;
    put_inline(w, child);
  }
  strut_put(w, map ? "}" : "]");
}

/* ---- on several lines ---- */

static void put_indent(strut_writer *w, size_t indent) {
  strut_put(w, "\n");
  for (size_t i = 0; i < indent; i++) strut_put(w, " ");
}

static bool holds_mappings(const strut_tree *map) {
  for (const strut_tree *k = map->first; k; k = k->next->next)
    if (k->next->kind == STRUT_TREE_MAP) return true;
  return false;
}

/* May the value stand behind its key? Of the scene's keys, things have a line each. */
static bool fits(const strut_tree *value, size_t column, bool top) {
  if (value->kind == STRUT_TREE_SCALAR || !value->first) return true;
  if (top && value->kind == STRUT_TREE_MAP && holds_mappings(value)) return false;
  return column + inline_width(value) <= WIDTH;
}

static void put_lines(strut_writer *w, const strut_tree *value, size_t indent, bool top);

/* What stands behind "key:" or "-". */
static void put_value(strut_writer *w, const strut_tree *value, size_t indent, size_t column,
                      bool top) {
  if (value->kind == STRUT_TREE_SCALAR && is_plain(value) && !*value->text) return;
  if (!fits(value, column + 1, top)) {
    put_lines(w, value, indent + 2, false);
    return;
  }
  strut_put(w, " ");
  put_inline(w, value);
}

static void put_lines(strut_writer *w, const strut_tree *value, size_t indent, bool top) {
  for (const strut_tree *child = value->first; child; child = child->next) {
    size_t column = indent + 2;
    put_indent(w, indent);
    if (value->kind == STRUT_TREE_LIST) {
      strut_put(w, "-");
    } else {
      put_scalar(w, child);
      strut_put(w, ":");
      column += strnlen(child->text, WIDTH);
      child = child->next;
    }
    put_value(w, child, indent, column, top);
  }
}

char *strut_tree_write(const strut_tree *root, const char *comment) {
  strut_writer w = {.text = NULL};
  strut_c_locale locale = strut_c_locale_enter();
  strut_put(&w, "# ");
  strut_put(&w, comment);
  put_lines(&w, root, 0, true);
  strut_put(&w, "\n");
  strut_c_locale_leave(locale);
  if (!w.failed) return w.text;
  strut_release(w.text);
  return NULL;
}
