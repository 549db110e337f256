/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the tokens of a row to nodes of the tree: at once, or when they are needed. See rows.h. */
#include <assert.h>
#include <string.h>

#include "parser/yaml/rows.h"

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
