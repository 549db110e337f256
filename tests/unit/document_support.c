/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/document_support.h"

#include "tests/support/test.h"

char *shown_end(char *out) { return out + strlen(out); }

strut_status read_text(const char *text, strut_document *document, strut_diagnostics *diagnostics) {
  strut_diagnostics_source(diagnostics, "t", text, strlen(text));
  return strut_document_read(document, diagnostics);
}

/* {a: [1 'x']} with the places of scalars where asked: a@1:1+1. */
static void show(const strut_tree *node, bool places, char *out) {
  if (node->kind == STRUT_TREE_SCALAR) {
    sprintf(out, node->quoted ? "'%s'" : "%s", node->text);
  } else {
    uint32_t children = 0;
    strcat(out, node->kind == STRUT_TREE_LIST ? "[" : "{");
    for (const strut_tree *child = node->first; child; child = child->next, children++) {
      bool key = node->kind == STRUT_TREE_MAP && children % 2 == 0;
      show(child, places, shown_end(out));
      if (key)
        strcat(out, ": ");
      else if (child->next)
        strcat(out, ", ");
    }
    strcat(out, node->kind == STRUT_TREE_LIST ? "]" : "}");
    assert_int_equal(children, node->kind == STRUT_TREE_MAP ? 2 * node->count : node->count);
  }
  if (places)
    sprintf(shown_end(out), "@%u:%u+%u", node->place.line, node->place.column, node->place.length);
}

/* "line:column: message" for each, one per line. */
static void list_messages(strut_diagnostics *diagnostics, char *out, size_t size) {
  size_t used = 0;
  assert_non_null(strut_diagnostics_render(diagnostics, 50)); /* sorts */
  out[0] = '\0';
  for (size_t i = 0; i < diagnostics->count && used < size; i++) {
    const strut_diagnostic *item = &diagnostics->items[i];
    int added = snprintf(out + used, size - used, "%s%u:%u: %s", i ? "\n" : "", item->place.line,
                         item->place.column, item->message);
    used += (size_t)added;
  }
}

void expect_of(const char *text, size_t length, bool places, const char *tree,
               const char *messages) {
  char got[4000] = "", said[4000];
  OWN(strut_document) document = {0};
  OWN(strut_diagnostics) diagnostics = {0};
  strut_diagnostics_source(&diagnostics, "t", text, length);
  strut_status status = strut_document_read(&document, &diagnostics);
  if (document.root) show(document.root, places, got);
  list_messages(&diagnostics, said, sizeof said);
  if (strcmp(said, messages) != 0) fail_msg("'%s' says\n%s\nnot\n%s", text, said, messages);
  if (strcmp(got, tree) != 0) fail_msg("'%s' is\n%s\nnot\n%s", text, got, tree);
  assert_int_equal(status, messages[0] ? STRUT_BAD_SCENE : STRUT_OK);
}

void expect_tree(const char *text, const char *tree) {
  expect_of(text, strlen(text), false, tree, "");
}

void expect_places(const char *text, const char *tree) {
  expect_of(text, strlen(text), true, tree, "");
}

void expect_error(const char *text, const char *message) {
  expect_of(text, strlen(text), false, "", message);
}

char *repeat(const char *before, const char *part, size_t count, const char *after) {
  size_t size = strlen(part);
  char *text = malloc(strlen(before) + size * count + strlen(after) + 1), *end = text;
  end = strcpy(text, before) + strlen(before);
  for (size_t i = 0; i < count; i++, end += size) memcpy(end, part, size);
  strcpy(end, after);
  return text;
}
