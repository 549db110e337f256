/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * libyaml's tokens one after the other, each as written; what is between two of them is
 * blanks and comments, and is set anew. See layout.h.
 */
#include "parser/yaml/layout.h"

#include <string.h>
#include <yaml.h>

#include "engine/base/memory.h"
#include "parser/yaml/document.h"
#include "parser/yaml/text.h"

/* ---- text that grows ---- */

static void put_bytes(strut_layout *l, const char *bytes, size_t count) {
  if (l->failed || l->length + count + 1 > l->capacity) {
    size_t capacity = 2 * (l->length + count) + 256;
    char *bigger = l->failed ? NULL : strut_reallocate(l->out, capacity, 1);
    if (!bigger) {
      l->failed = true;
      return;
    }
    l->out = bigger;
    l->capacity = capacity;
  }
  memcpy(l->out + l->length, bytes, count);
  l->length += count;
  l->out[l->length] = '\0';
  for (size_t i = 0; i < count; i++)
    l->column = bytes[i] == '\n' ? 0 : l->column + (((unsigned char)bytes[i] & 0xC0) != 0x80);
}

static void put_blanks(strut_layout *l, int count) {
  for (int i = 0; i < count; i++) put_bytes(l, " ", 1);
}

/* Ends the line that is open, if one is; an empty one too where `blank`. */
static void end_line(strut_layout *l, bool blank) {
  if (l->length && l->out[l->length - 1] != '\n') put_bytes(l, "\n", 1);
  bool empty = l->length < 2 || l->out[l->length - 2] == '\n';
  if (blank && !empty) put_bytes(l, "\n", 1);
}

/* ---- indentation ---- */

enum { STEP = 2 };

static strut_level *top_of(strut_layout *l) { return l->depth ? &l->level[l->depth - 1] : NULL; }

static bool push(strut_layout *l, strut_level_kind kind, int column, int indent) {
  if (l->depth == STRUT_LAYOUT_DEPTH) return false;
  l->level[l->depth++] = (strut_level){kind, column, indent};
  return true;
}

/* Of a block collection within the one that is open. */
static int inner_indent(strut_layout *l) {
  const strut_level *top = top_of(l);
  return top ? top->indent + STEP : 0;
}

/* The column around the bracket that was opened last. */
static int outer_column(strut_layout *l) {
  const strut_level *top = top_of(l);
  return l->flow > 1 ? l->content[l->flow - 2] : top ? top->indent : 0;
}

/* Lines within brackets begin below what follows the bracket, or further in where nothing does. */
static void follow_bracket(strut_layout *l, bool breaks) {
  if (!l->after_open) return;
  l->content[l->flow - 1] = breaks ? outer_column(l) + STEP : l->column;
}

/* Of a line that begins with this token. */
static int line_indent(strut_layout *l, const strut_token *t) {
  const strut_level *top = top_of(l);
  /* a bracket of the outermost collection must stand further in than the key before it */
  if (l->flow) return t->closes && l->flow > 1 ? outer_column(l) : l->content[l->flow - 1];
  if (!top) return 0;
  return t->in_key || t->type == YAML_BLOCK_ENTRY_TOKEN ? top->indent : top->indent + STEP;
}

static bool is_blank(char c) { return c == ' ' || c == '\t'; }
static bool is_break(char c) { return c == '\n' || c == '\r'; }

static int column_of(const strut_layout *l, size_t at) {
  int column = 0;
  while (at > 0 && !is_break(l->text[at - 1])) at--, column++;
  return column;
}

/* Of a comment on a line of its own: that of the token behind it, or of what has just ended. */
static int comment_indent(const strut_layout *l, size_t at, const strut_token *next,
                          int next_indent) {
  int indent = next_indent, column = column_of(l, at);
  int next_column = next->type == YAML_STREAM_END_TOKEN ? 0 : column_of(l, next->begin);
  if (l->flow || column <= next_column) return indent;
  for (size_t i = 0; i < l->peak; i++)
    if (l->level[i].column <= column && l->level[i].indent > indent) indent = l->level[i].indent;
  return indent;
}

/* ---- between tokens ---- */

/*
 * Comments and line breaks of the text before the token; *lines gets the breaks since the last of them.
 * False: something else stands there.
 */
static bool set_gap(strut_layout *l, const strut_token *t, int indent, int *lines) {
  *lines = 0;
  for (size_t at = l->done; at < t->begin;) {
    if (is_break(l->text[at])) {
      if (l->text[at] == '\r' && at + 1 < t->begin && l->text[at + 1] == '\n') at++;
      ++*lines;
      at++;
    } else if (is_blank(l->text[at])) {
      at++;
    } else if (l->text[at] == '#') {
      size_t end = at;
      while (end < l->size && !is_break(l->text[end])) end++;
      size_t last = end;
      while (last > at && is_blank(l->text[last - 1])) last--;
      if (*lines || !l->length) {
        end_line(l, *lines > 1);
        put_blanks(l, comment_indent(l, at, t, indent));
      } else {
        size_t before = at;
        while (before > l->done && l->text[before - 1] == ' ') before--;
        put_blanks(l, at - before > 1 ? (int)(at - before) : 1);
      }
      put_bytes(l, l->text + at, last - at);
      at = end;
      l->comment = true;
      *lines = 0;
    } else {
      return false;
    }
  }
  return true;
}

static bool needs_blank(const strut_layout *l, const strut_token *t) {
  if (t->type == YAML_FLOW_ENTRY_TOKEN || t->type == YAML_VALUE_TOKEN || t->closes) return false;
  return l->length && !l->after_open && l->out[l->length - 1] != '\n';
}

/* Sets what stands before the token. False: see set_gap. */
static bool set_before(strut_layout *l, const strut_token *t) {
  bool breaks = false;
  for (size_t at = l->done; at < t->begin; at++) breaks = breaks || is_break(l->text[at]);
  follow_bracket(l, breaks);
  int indent = line_indent(l, t), lines;
  l->comment = false;
  if (!set_gap(l, t, indent, &lines)) return false;
  if (lines || l->comment) {
    end_line(l, lines > 1);
    put_blanks(l, indent);
  } else if (needs_blank(l, t)) {
    put_bytes(l, " ", 1);
  }
  return true;
}

/* ---- values of several lines ---- */

/* Lines of a quoted or plain scalar behind the first: their blanks at the beginning mean nothing. */
static void put_folded(strut_layout *l, const strut_token *t, int indent) {
  for (size_t at = t->begin; at < t->end;) {
    size_t end = at;
    while (end < t->end && !is_break(l->text[end])) end++;
    if (at > t->begin) {
      while (at < end && is_blank(l->text[at])) at++;
      put_bytes(l, "\n", 1);
      if (at < end) put_blanks(l, indent);
    }
    put_bytes(l, l->text + at, end - at);
    if (end < t->end && l->text[end] == '\r' && l->text[end + 1] == '\n') end++;
    at = end + 1;
  }
}

/* Lines of a block scalar, all moved by as much. False: they cannot be. */
static bool put_block(strut_layout *l, const strut_token *t, int indent) {
  size_t at = t->begin;
  int own = -1;
  while (at < t->end && !is_break(l->text[at])) {
    char c = l->text[at];
    if (c == '+' || (c >= '0' && c <= '9') || c == '#') return false;
    at++;
  }
  size_t head = at;
  while (head > t->begin && is_blank(l->text[head - 1])) head--;
  put_bytes(l, l->text + t->begin, head - t->begin);
  while (at < t->end) {
    if (l->text[at] == '\r' && at + 1 < t->end && l->text[at + 1] == '\n') at++;
    at++;
    size_t end = at, first = at;
    while (end < t->end && !is_break(l->text[end])) end++;
    while (first < end && l->text[first] == ' ') first++;
    put_bytes(l, "\n", 1);
    if (first < end && own < 0) own = (int)(first - at);
    if (own >= 0 && (int)(end - at) > own) {
      put_blanks(l, indent);
      put_bytes(l, l->text + at + own, end - at - (size_t)own);
    }
    at = end;
  }
  return true;
}

/* The end of a block scalar's last line that is not blank. */
static size_t end_of_block(const strut_layout *l, const strut_token *t) {
  size_t end = t->end;
  for (size_t at = end; at > t->begin && (is_break(l->text[at - 1]) || l->text[at - 1] == ' ');) {
    at--;
    if (is_break(l->text[at])) end = at;
  }
  return end;
}

/* ---- tokens ---- */

static bool put_scalar(strut_layout *l, strut_token *t) {
  const strut_level *top = top_of(l);
  int indent = l->flow ? line_indent(l, t) : top ? top->indent + STEP : 0;
  if (t->style == YAML_LITERAL_SCALAR_STYLE || t->style == YAML_FOLDED_SCALAR_STYLE) {
    t->end = end_of_block(l, t);
    return put_block(l, t, indent ? indent : STEP);
  }
  put_folded(l, t, indent ? indent : STEP);
  return true;
}

/* What has no characters of its own: the structure. False: too deep, or not to be kept. */
static bool take_structure(strut_layout *l, const strut_token *t) {
  if (t->type == YAML_BLOCK_MAPPING_START_TOKEN)
    return push(l, STRUT_LEVEL_MAP, column_of(l, t->begin), inner_indent(l));
  if (t->type == YAML_BLOCK_SEQUENCE_START_TOKEN)
    return push(l, STRUT_LEVEL_LIST, column_of(l, t->begin), inner_indent(l));
  if (t->type != YAML_BLOCK_END_TOKEN) return true;
  if (l->depth && top_of(l)->kind == STRUT_LEVEL_BARE_LIST) l->depth--;
  if (l->depth) l->depth--;
  return true;
}

/* A list may stand below its key without being further in; it has no token of its own. */
static bool follow_bare_list(strut_layout *l, const strut_token *t) {
  if (l->flow || !l->depth) return true;
  bool bare = top_of(l)->kind == STRUT_LEVEL_BARE_LIST;
  if (t->type == YAML_KEY_TOKEN && bare) l->depth--;
  if (t->type == YAML_BLOCK_ENTRY_TOKEN && top_of(l)->kind == STRUT_LEVEL_MAP)
    return push(l, STRUT_LEVEL_BARE_LIST, column_of(l, t->begin), inner_indent(l));
  return true;
}

static bool has_text(const strut_token *t) {
  return t->type == YAML_SCALAR_TOKEN || t->type == YAML_BLOCK_ENTRY_TOKEN ||
         t->type == YAML_FLOW_ENTRY_TOKEN || t->type == YAML_VALUE_TOKEN ||
         t->type == YAML_ANCHOR_TOKEN || t->type == YAML_ALIAS_TOKEN || t->opens || t->closes;
}

/* Appends one token. False: it cannot be kept. */
static bool put_token(strut_layout *l, strut_token *t) {
  bool key = t->type == YAML_KEY_TOKEN;
  bool refused = t->type == YAML_TAG_TOKEN || t->type == YAML_DOCUMENT_START_TOKEN ||
                 t->type == YAML_DOCUMENT_END_TOKEN || t->type == YAML_VERSION_DIRECTIVE_TOKEN ||
                 t->type == YAML_TAG_DIRECTIVE_TOKEN || (key && t->end > t->begin);
  if (t->closes && !l->flow) return false; /* tokens of a text that is no YAML */
  if (refused || !follow_bare_list(l, t)) return false;
  if (key) l->key = true;
  if (!has_text(t)) return take_structure(l, t);
  t->in_key = l->key;
  if (!set_before(l, t)) return false;
  if (t->closes) l->flow--;
  if (t->type == YAML_SCALAR_TOKEN) {
    if (!put_scalar(l, t)) return false;
  } else {
    put_bytes(l, l->text + t->begin, t->end - t->begin);
  }
  if (t->opens && ++l->flow > STRUT_LAYOUT_DEPTH) return false;
  l->after_open = t->opens;
  l->key = false;
  l->done = t->end;
  l->peak = l->depth;
  return true;
}

/* ---- the whole text ---- */

static strut_token token_of(const yaml_token_t *token, strut_cursor *begin, strut_cursor *end) {
  strut_token t = {.type = token->type};
  strut_cursor_to_index(begin, token->start_mark.index);
  strut_cursor_to_index(end, token->end_mark.index);
  t.begin = begin->offset;
  t.end = end->offset;
  if (t.type == YAML_SCALAR_TOKEN) t.style = token->data.scalar.style;
  t.opens = t.type == YAML_FLOW_SEQUENCE_START_TOKEN || t.type == YAML_FLOW_MAPPING_START_TOKEN;
  t.closes = t.type == YAML_FLOW_SEQUENCE_END_TOKEN || t.type == YAML_FLOW_MAPPING_END_TOKEN;
  return t;
}

/* Where in the text the layout stopped. */
static strut_status refuse(const strut_layout *l, size_t at, strut_error *error) {
  int line = 1;
  for (size_t i = 0; i < at && i < l->size; i++) line += l->text[i] == '\n';
  return strut_fail(error, STRUT_BAD_SCENE,
                    "the layout of line %d cannot be changed without changing what it says", line);
}

static strut_status lay_out(strut_layout *l, yaml_parser_t *parser, strut_error *error) {
  strut_cursor begin = strut_cursor_begin(l->text, l->size), end = begin;
  bool more = true;
  while (more) {
    yaml_token_t token;
    if (!yaml_parser_scan(parser, &token))
      return strut_fail(error, STRUT_BAD_SCENE, "the text is not YAML");
    strut_token t = token_of(&token, &begin, &end);
    yaml_token_delete(&token);
    if (t.begin < l->done && has_text(&t)) return refuse(l, t.begin, error);
    if (!put_token(l, &t)) return refuse(l, t.begin, error);
    more = t.type != YAML_STREAM_END_TOKEN;
  }
  strut_token last = {.type = YAML_STREAM_END_TOKEN, .begin = l->size, .end = l->size};
  int lines;
  l->depth = 0;
  if (!set_gap(l, &last, 0, &lines)) return refuse(l, l->done, error);
  end_line(l, false);
  return l->failed ? strut_no_memory(error, "") : STRUT_OK;
}

/* One pass; *result is a block of strut_allocate. */
static strut_status lay_out_once(const char *text, size_t length, char **result, size_t *size,
                                 strut_error *error) {
  strut_layout *l = strut_allocate(1, sizeof *l);
  yaml_parser_t parser;
  if (!l || !yaml_parser_initialize(&parser)) {
    strut_release(l);
    return strut_no_memory(error, "");
  }
  yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
  l->text = text;
  l->size = length;
  strut_status status = lay_out(l, &parser, error);
  if (status == STRUT_OK && !l->out) put_bytes(l, "", 0);
  if (l->failed) status = strut_no_memory(error, "");
  *result = l->out;
  *size = l->length;
  if (status != STRUT_OK) {
    strut_release(l->out);
    *result = NULL;
  }
  yaml_parser_delete(&parser);
  strut_release(l);
  return status;
}

/* ---- is it the same? ---- */

static bool same_tree(const strut_tree *a, const strut_tree *b) {
  if (a->kind != b->kind || a->count != b->count || a->quoted != b->quoted) return false;
  if (a->kind == STRUT_TREE_SCALAR) return strcmp(a->text, b->text) == 0;
  const strut_tree *x = a->first, *y = b->first;
  for (; x && y; x = x->next, y = y->next)
    if (!same_tree(x, y)) return false;
  return !x && !y;
}

static strut_status compare_values(const char *text, size_t length, const char *other, size_t size,
                                   bool *same) {
  strut_document a = {.root = NULL}, b = {.root = NULL};
  strut_diagnostics of_a = {0}, of_b = {0};
  strut_diagnostics_source(&of_a, "", text, length);
  strut_diagnostics_source(&of_b, "", other, size);
  strut_status status = strut_document_read(&a, &of_a);
  strut_status again = strut_document_read(&b, &of_b);
  *same = status == again && !a.root == !b.root && (!a.root || same_tree(a.root, b.root));
  strut_document_free(&a);
  strut_document_free(&b);
  strut_diagnostics_free(&of_a);
  strut_diagnostics_free(&of_b);
  return status == STRUT_NO_MEMORY || again == STRUT_NO_MEMORY ? STRUT_NO_MEMORY : STRUT_OK;
}

/* All characters but blanks and breaks, in order: those of comments and of values alike. */
static bool same_characters(const char *a, const char *b) {
  for (;; a++, b++) {
    while (is_blank(*a) || is_break(*a)) a++;
    while (is_blank(*b) || is_break(*b)) b++;
    if (*a != *b) return false;
    if (!*a) return true;
  }
}

strut_status strut_layout_text(const char *text, size_t length, char **result, strut_error *error) {
  char *again = NULL;
  size_t size = 0, size_again = 0;
  bool same = true;
  *result = NULL;
  if (strut_text_mark(text, length))
    return strut_fail(error, STRUT_BAD_SCENE, "the text begins with a byte order mark");
  strut_status status = lay_out_once(text, length, result, &size, error);
  if (status != STRUT_OK) return status;
  status = compare_values(text, length, *result, size, &same);
  if (status != STRUT_OK) status = strut_no_memory(error, "");
  if (status == STRUT_OK) status = lay_out_once(*result, size, &again, &size_again, error);
  if (status == STRUT_OK &&
      (!same || !same_characters(text, *result) || strcmp(again, *result) != 0))
    status = strut_fail(error, STRUT_BAD_SCENE,
                        "the layout cannot be changed without changing what the text says");
  strut_release(again);
  if (status == STRUT_OK) return STRUT_OK;
  strut_release(*result);
  *result = NULL;
  return status;
}
