/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libFuzzer: any bytes as a YAML text; every scalar as an expression. Aborts on a broken promise. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "parser/language/expression/expression.h"
#include "parser/language/yaml/document.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool promise) {
  if (!promise) abort();
}

static void visit_scalar(const strut_tree *node, bool evaluate) {
  strut_quantity quantity;
  strut_expression_error error;
  require(node->text && !node->first && node->count == 0);
  if (!evaluate) return;
  if (strut_expression_evaluate(node->text, NULL, &quantity, &error)) {
    require(isfinite(quantity.value) && !error.message[0]);
  } else {
    require(error.message[0] && strlen(error.message) < sizeof error.message);
    require(error.offset + error.length <= strlen(node->text));
  }
}

/* Aliases are visited each time; the reader's limit on them is what bounds this walk. */
static void visit(const strut_tree *node, int depth, size_t *visits) {
  require(depth <= 64 && ++*visits <= 4000000);
  require(node->place.line > 0 && node->place.column > 0);
  if (node->kind == STRUT_TREE_SCALAR) {
    visit_scalar(node, *visits < 2000);
    return;
  }
  uint32_t children = 0;
  for (const strut_tree *child = node->first; child; child = child->next, children++) {
    bool key = node->kind == STRUT_TREE_MAP && children % 2 == 0;
    require(!key || child->kind == STRUT_TREE_SCALAR);
    /* Of two equal keys the first would be found. */
    if (key && children < 64) require(strut_tree_find(node, child->text, NULL) == child->next);
    visit(child, depth + 1, visits);
  }
  require(children == (node->kind == STRUT_TREE_MAP ? 2 * node->count : node->count));
}

static void read_and_visit(const char *text, size_t size) {
  strut_document document = {0};
  strut_diagnostics diagnostics = {0};
  strut_diagnostics_source(&diagnostics, "fuzz", text, size);
  strut_status status = strut_document_read(&document, &diagnostics);
  require(status == STRUT_OK || status == STRUT_BAD_SCENE);
  require((status == STRUT_OK) == (diagnostics.count == 0));
  require(status != STRUT_OK || document.root);
  require(strut_diagnostics_render(&diagnostics, 50) != NULL);
  size_t visits = 0;
  if (document.root) visit(document.root, 0, &visits);
  strut_document_free(&document);
  strut_diagnostics_free(&diagnostics);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char *text = malloc(size + 1);
  if (!text) return 0;
  if (size) memcpy(text, data, size);
  text[size] = '\0';
  read_and_visit(text, size);
  free(text);
  return 0;
}
