/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/yaml/rows.h"

#include <assert.h>
#include <string.h>

#include "parser/yaml/text.h"

enum {
  NAME_MOST = 128, /* libyaml wants the colon within 1024 characters */
  PAIRS_MOST = 16, /* of a mapping, whose keys are compared one by one */
};

/* ---- one row ---- */

typedef struct scanner {
  const char *text;
  uint32_t at, end; /* end: where the line feed stands */
  int levels;
  strut_row *row;
} scanner;

/* Is the character among those of a set of ASCII? One bit each. */
static bool is_in(const uint64_t set[2], char c) {
  unsigned char byte = (unsigned char)c;
  return byte < 128 && (set[byte >> 6] >> (byte & 63) & 1);
}

/* Letters, digits, '_'; for names also '.' and '-'; for values also these and + * / ^ ( ). */
static const uint64_t word_set[2] = {0x03FF000000000000, 0x07FFFFFE87FFFFFE};
static const uint64_t name_set[2] = {0x03FF600000000000, 0x07FFFFFE87FFFFFE};
static const uint64_t value_set[2] = {0x03FFEF0000000000, 0x07FFFFFEC7FFFFFE};

static char here(const scanner *s) { return s->text[s->at]; }

static void skip_spaces(scanner *s) {
  while (here(s) == ' ') s->at++;
}

static strut_row_token *add_token(scanner *s, strut_tree_kind kind) {
  if (s->row->count == STRUT_ROW_TOKENS) return NULL;
  strut_row_token *token = &s->row->token[s->row->count++];
  *token = (strut_row_token){.at = s->at, .kind = (uint8_t)kind};
  return token;
}

/* A name, its colon, and at least one space behind it. */
static strut_row_token *read_key(scanner *s) {
  strut_row_token *token = is_in(word_set, here(s)) ? add_token(s, STRUT_TREE_SCALAR) : NULL;
  if (!token) return NULL;
  while (is_in(name_set, here(s))) s->at++;
  token->length = s->at - token->at;
  if (token->length > NAME_MOST || here(s) != ':' || s->text[s->at + 1] != ' ') return NULL;
  s->at++;
  skip_spaces(s);
  return token;
}

/* A plain scalar within brackets; it ends before the comma or bracket. */
static bool read_plain(scanner *s) {
  char c = here(s);
  bool sign = c == '-' || c == '+';
  char first = sign ? s->text[s->at + 1] : c;
  if (!is_in(word_set, first) && first != '.') return false;
  strut_row_token *token = add_token(s, STRUT_TREE_SCALAR);
  if (!token) return false;
  uint32_t end = s->at;
  s->at += sign;
  for (;;) {
    while (is_in(value_set, here(s))) s->at++;
    end = s->at;
    skip_spaces(s);
    if (!is_in(value_set, here(s))) break;
  }
  token->length = end - token->at;
  return true;
}

static bool is_new_key(const scanner *s, const strut_row_token *map, const strut_row_token *key) {
  const strut_row_token *other = map + 1;
  while (other != key) {
    if (other->length == key->length &&
        memcmp(s->text + other->at, s->text + key->at, key->length) == 0)
      return false;
    other++;
    int inside = 1; /* tokens of the key's value that are still to be passed */
    for (; inside > 0; other++)
      inside += (other->kind == STRUT_TREE_MAP ? 2 : 1) * other->count - 1;
  }
  return true;
}

static bool read_brackets(scanner *s);

static bool read_value(scanner *s) {
  char c = here(s);
  return c == '{' || c == '[' ? read_brackets(s) : read_plain(s);
}

/* A list or a mapping, from its bracket to the one that closes it. */
static bool read_brackets(scanner *s) {
  bool map = here(s) == '{';
  strut_row_token *token = add_token(s, map ? STRUT_TREE_MAP : STRUT_TREE_LIST);
  if (!token || ++s->levels > STRUT_ROW_LEVELS) return false;
  if (s->row->levels < s->levels) s->row->levels = s->levels;
  s->row->maps += map;
  char close = map ? '}' : ']';
  do {
    s->at++; /* the bracket or comma */
    skip_spaces(s);
    strut_row_token *key = map ? read_key(s) : NULL;
    if (map && (!key || token->count == PAIRS_MOST || !is_new_key(s, token, key))) return false;
    if (!read_value(s)) return false;
    skip_spaces(s);
    token->count++;
  } while (here(s) == ',');
  if (here(s) != close) return false;
  s->at++;
  s->levels--;
  token->length = s->at - token->at;
  return true;
}

/* Nothing, or a comment in ASCII, up to the end of the line. */
static bool read_rest(scanner *s) {
  uint32_t before = s->at;
  skip_spaces(s);
  if (s->at == s->end) return true;
  if (here(s) != '#' || s->at == before) return false;
  while (here(s) >= ' ' && here(s) < 0x7F) s->at++;
  return s->at == s->end;
}

bool strut_row_read(const char *text, size_t left, strut_row *row) {
  size_t most = left < STRUT_ROW_BYTES ? left : STRUT_ROW_BYTES;
  const char *end = memchr(text, '\n', most);
  row->count = row->levels = row->maps = 0;
  if (!end) return false;
  scanner s = {.text = text, .end = (uint32_t)(end - text), .row = row};
  row->length = s.end + 1;
  skip_spaces(&s);
  if (!read_key(&s) || (here(&s) != '{' && here(&s) != '[')) return false;
  return read_brackets(&s) && read_rest(&s);
}

/* ---- runs ---- */

/* Lines end at line feeds only, so that they can be counted by these. */
static bool has_other_breaks(const char *text, size_t length) {
  static const char leads[] = {'\r', '\xC2', '\xE2'};
  for (size_t i = 0; i < sizeof leads; i++) {
    const char *at = text, *end = text + length;
    while (at < end && (at = memchr(at, leads[i], (size_t)(end - at)))) {
      if (strut_text_break(at, (size_t)(end - at))) return true;
      at++;
    }
  }
  return false;
}

static bool add_run(strut_row_runs *runs, const strut_row_run *run) {
  if (runs->count == runs->capacity) {
    size_t wider = runs->capacity ? 2 * runs->capacity : 8;
    strut_row_run *block = strut_reallocate(runs->run, wider, sizeof *block);
    if (!block) return false;
    runs->run = block;
    runs->capacity = wider;
  }
  runs->run[runs->count++] = *run;
  return true;
}

/* Bytes of the rows with this indentation that begin at `at`; *lines: how many. */
static size_t measure_run(const char *text, size_t at, size_t length, uint32_t indent,
                          uint32_t *lines) {
  size_t begin = at;
  strut_row row;
  while (at < length && strut_row_read(text + at, length - at, &row) && row.token[0].at == indent) {
    at += row.length;
    ++*lines;
  }
  return at - begin;
}

bool strut_row_runs_find(const char *text, size_t length, uint32_t least, strut_row_runs *runs) {
  size_t at = strut_text_mark(text, length);
  if (has_other_breaks(text, length)) return true;
  for (uint32_t line = 0; at < length; line++) {
    strut_row row;
    if (!strut_row_read(text + at, length - at, &row)) {
      const char *end = memchr(text + at, '\n', length - at);
      at = end ? (size_t)(end - text) + 1 : length;
      continue;
    }
    at += row.length;
    strut_row_run run = {.begin = at, .line = line + 1, .indent = row.token[0].at};
    run.end = at + measure_run(text, at, length, run.indent, &run.lines);
    at = run.end;
    line += run.lines;
    if (run.lines && run.lines + 1 >= least && !add_run(runs, &run)) return false;
  }
  return true;
}

void strut_row_runs_free(strut_row_runs *runs) {
  strut_release(runs->run);
  *runs = (strut_row_runs){0};
}

/* From the tokens of a row to nodes of the tree: at once, or when they are needed. See rows.h. */

typedef struct row_builder {
  const strut_row *row;
  const char *text; /* begins with the row */
  uint32_t line;
  strut_tree *nodes;
  strut_row_keep *keep;
  void *context;
} row_builder;

/* Makes the node of token i and all in it. Returns the number of the token behind these; 0: memory is out. */
static int build_node(const row_builder *b, int i) {
  const strut_row_token *token = &b->row->token[i];
  strut_tree *node = &b->nodes[i];
  *node = (strut_tree){.kind = token->kind & 3u,
                       .place = strut_place_at(b->line, token->at + 1, token->length),
                       .text = ""};
  if (token->kind == STRUT_TREE_SCALAR) {
    node->text = b->keep(b->context, b->text + token->at, token->length);
    return node->text ? i + 1 : 0;
  }
  node->count = token->count;
  strut_tree **link = &node->first;
  int next = i + 1;
  for (int left = (token->kind == STRUT_TREE_MAP ? 2 : 1) * token->count; left > 0; left--) {
    strut_tree *child = &b->nodes[next];
    next = build_node(b, next);
    if (!next) return 0;
    *link = child;
    link = &child->next;
  }
  return next;
}

bool strut_row_build(const strut_row *row, int count, const char *text, uint32_t line,
                     strut_tree *nodes, strut_row_keep *keep, void *context) {
  const row_builder b = {row, text, line, nodes, keep, context};
  return build_node(&b, 0) && (count == 1 || build_node(&b, 1));
}

/* ---- deferred values ---- */

void strut_row_defer(const strut_row *row, const char *text, strut_tree *value) {
  value->count = row->token[1].count;
  value->deferred = true;
  value->text = text;
}

/* Reads the row of a deferred value again. */
static void read_again(const strut_tree *value, strut_row *row) {
  bool read = strut_row_read(value->text, STRUT_ROW_BYTES, row);
  assert(read && "it has been a row before");
  (void)read;
}

static const char *keep_in_nodes(void *context, const char *text, size_t length) {
  strut_row_nodes *nodes = context;
  char *copy = nodes->text + nodes->used;
  memcpy(copy, text, length);
  copy[length] = '\0';
  nodes->used += length + 1;
  return copy;
}

/* Gives a value the children of its expanded copy. */
static void adopt(strut_tree *value, const strut_tree *expanded) {
  value->first = expanded->first;
  value->text = expanded->text;
  value->deferred = false;
}

const strut_tree *strut_row_expand(const strut_tree *value, strut_row_nodes *nodes) {
  strut_row row;
  if (!value->deferred) return value;
  read_again(value, &row);
  nodes->used = 0;
  strut_row_build(&row, row.count, value->text, value->place.line, nodes->node, keep_in_nodes,
                  nodes);
  strut_tree whole = *value;
  adopt(&whole, &nodes->node[1]);
  nodes->node[1] = whole;
  return &nodes->node[1];
}

static const char *keep_in_arena(void *arena, const char *text, size_t length) {
  return strut_arena_text(arena, text, length);
}

static bool expand_for_good(strut_tree *value, strut_arena *arena) {
  strut_row row;
  read_again(value, &row);
  strut_tree *nodes = strut_arena_allocate(arena, (size_t)row.count, sizeof *nodes);
  if (!nodes || !strut_row_build(&row, row.count, value->text, value->place.line, nodes,
                                 keep_in_arena, arena))
    return false;
  adopt(value, &nodes[1]);
  return true;
}

bool strut_document_expand(strut_document *document) {
  strut_tree *root = document->deferred ? document->root : NULL;
  for (strut_tree *key = root ? root->first : NULL; key; key = key->next->next) {
    strut_tree *map = key->next;
    for (strut_tree *entry = map->kind == STRUT_TREE_MAP ? map->first : NULL; entry;
         entry = entry->next->next)
      if (entry->next->deferred && !expand_for_good(entry->next, &document->arena)) return false;
  }
  document->deferred = false;
  return true;
}
