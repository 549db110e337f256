/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/read/difference.h"

#include <stdbool.h>
#include <string.h>

#include "parser/read/difference_copies.h"
#include "parser/yaml/document.h"

/* The two scenes under comparison. */
typedef struct comparison {
  strut_arena *arena; /* of the results */
  strut_difference *list;
  size_t count, room;
  bool failed; /* memory was out */
} comparison;

/* Joins three texts in the arena; values are short. */
static const char *join(comparison *c, const char *a, const char *b, const char *d) {
  const char *text = a && b && d ? strut_arena_format(c->arena, "%s%s%s", a, b, d) : NULL;
  if (!text) c->failed = true;
  return text;
}

/* A value as it would stand on one line. */
static const char *flat(comparison *c, const strut_tree *tree) {
  if (tree->kind == STRUT_TREE_SCALAR) return join(c, tree->text, "", "");
  bool map = tree->kind == STRUT_TREE_MAP;
  const char *text = map ? "{" : "[";
  for (const strut_tree *t = tree->first; t && !c->failed; t = t->next) {
    if (t != tree->first) text = join(c, text, ", ", "");
    if (map) {
      text = join(c, text, t->text, ": ");
      t = t->next;
    }
    text = join(c, text, flat(c, t), "");
  }
  return join(c, text, map ? "}" : "]", "");
}

static bool equal(const strut_tree *a, const strut_tree *b) {
  if (a->kind != b->kind) return false;
  if (a->kind == STRUT_TREE_SCALAR) return strcmp(a->text, b->text) == 0;
  const strut_tree *x = a->first, *y = b->first;
  for (; x && y; x = x->next, y = y->next)
    if (!equal(x, y)) return false;
  return !x && !y;
}

static void add(comparison *c, const char *where, const strut_tree *was, const strut_tree *is) {
  if (c->count == c->room) {
    size_t room = 2 * c->room + 64;
    strut_difference *list = strut_arena_allocate(c->arena, room, sizeof *list);
    if (!list) {
      c->failed = true;
      return;
    }
    for (size_t i = 0; i < c->count; i++) list[i] = c->list[i];
    c->list = list;
    c->room = room;
  }
  c->list[c->count++] = (strut_difference){
      .where = where, .was = was ? flat(c, was) : NULL, .is = is ? flat(c, is) : NULL};
}

/* Names and descriptions do not count as differences. */
static bool is_label(const char *where) {
  return strcmp(where, "name") == 0 || strcmp(where, "description") == 0 ||
         strcmp(where, "source") == 0;
}

static void compare(comparison *c, const char *where, const strut_tree *a, const strut_tree *b);

static void compare_maps(comparison *c, const char *where, const strut_tree *a,
                         const strut_tree *b) {
  const char *dot = *where ? "." : "";
  for (const strut_tree *key = a->first; key && !c->failed; key = key->next->next) {
    const char *here = join(c, where, dot, key->text);
    const strut_tree *other = strut_tree_find(b, key->text, NULL);
    if (!here || is_label(here)) continue;
    if (other)
      compare(c, here, key->next, other);
    else
      add(c, here, key->next, NULL);
  }
  for (const strut_tree *key = b->first; key && !c->failed; key = key->next->next) {
    const char *here = join(c, where, dot, key->text);
    if (here && !is_label(here) && !strut_tree_find(a, key->text, NULL))
      add(c, here, NULL, key->next);
  }
}

static void compare(comparison *c, const char *where, const strut_tree *a, const strut_tree *b) {
  if (a->kind == STRUT_TREE_MAP && b->kind == STRUT_TREE_MAP)
    compare_maps(c, where, a, b);
  else if (!equal(a, b))
    add(c, where, a, b);
}

static strut_status read(const char *text, strut_document *document,
                         strut_diagnostics *diagnostics) {
  strut_diagnostics_source(diagnostics, "", text, strlen(text));
  strut_status status = strut_document_read(document, diagnostics);
  return status == STRUT_OK && !document->root ? STRUT_BAD_SCENE : status;
}

strut_status strut_text_differences(const char *first, const char *second, strut_arena *arena,
                                    strut_difference **list, size_t *count) {
  comparison c = {.arena = arena};
  strut_document a = {0}, b = {0};
  strut_diagnostics about_a = {0}, about_b = {0};
  *list = NULL;
  *count = 0;
  strut_status status = read(first, &a, &about_a);
  if (status == STRUT_OK) status = read(second, &b, &about_b);
  if (status == STRUT_OK) {
    compare(&c, "", a.root, b.root);
    if (c.failed) status = STRUT_NO_MEMORY;
    if (status == STRUT_OK && c.count)
      status = strut_differences_join_copies(a.root, b.root, arena, c.list, &c.count);
  }
  if (status == STRUT_OK) {
    *list = c.list;
    *count = c.count;
  }
  strut_document_free(&a);
  strut_document_free(&b);
  strut_diagnostics_free(&about_a);
  strut_diagnostics_free(&about_b);
  return status;
}
