/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * libFuzzer: any bytes as what other programs send: a request in JSON, DAKOTA's parameters, a file to import.
 * The first byte chooses. Aborts on a broken promise.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "parser/import/import.h"
#include "parser/study/study_request.h"
#include "parser/yaml/text.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool promise) {
  if (!promise) abort();
}

static void visit(const strut_tree *node, int depth) {
  require(depth <= STRUT_JSON_DEEPEST && node->place.column > 0 && node->text);
  uint32_t children = 0;
  for (const strut_tree *child = node->first; child; child = child->next, children++)
    visit(child, depth + 1);
  require(children == (node->kind == STRUT_TREE_MAP ? 2 * node->count : node->count));
}

static void read_json(const char *text, size_t length) {
  strut_arena arena = {0};
  strut_tree *root;
  strut_json_error error;
  strut_status status = strut_json_text_read(text, length, 1, &arena, &root, &error);
  require(status == STRUT_OK || status == STRUT_BAD_SCENE);
  require((status == STRUT_OK) == (root != NULL));
  if (root)
    visit(root, 1);
  else
    require(error.message[0] && error.column > 0);
  strut_arena_free(&arena);
}

static void read_dakota(const char *text, size_t length) {
  strut_diagnostics diagnostics = {0};
  strut_dakota_file file;
  strut_diagnostics_source(&diagnostics, "fuzz", text, length);
  strut_status status = strut_dakota_read(text, length, &diagnostics, &file);
  require((status == STRUT_OK) == (diagnostics.count == 0));
  if (diagnostics.count) require(strut_diagnostics_render(&diagnostics, 5) != NULL);
  strut_dakota_free(&file);
  strut_diagnostics_free(&diagnostics);
}

/* A zero byte divides the text into two files. */
static void read_foreign(strut_import_format format, const char *text, size_t length) {
  strut_import_file files[2] = {{.name = "fuzz"}, {.name = "other"}};
  strut_diagnostics result = {0};
  strut_error error = {0};
  char *scene = NULL;
  size_t first = format == STRUT_IMPORT_TABLES ? strlen(text) : length;
  size_t count = format == STRUT_IMPORT_TABLES ? 2 : 1;
  for (size_t i = 0; i < count; i++) {
    files[i].length = i ? length - first - (first < length) : first;
    files[i].text = strut_allocate(files[i].length + 1, 1);
    if (files[i].text && files[i].length)
      memcpy(files[i].text, i ? text + first + 1 : text, files[i].length);
  }
  strut_status status = strut_import(format, files, count, 0.0, &scene, &result, &error);
  size_t said = files[0].diagnostics.count + files[1].diagnostics.count + result.count;
  require(status == STRUT_OK || said > 0 || error.message[0]);
  require(status != STRUT_OK || (scene && !said));
  strut_release(scene);
  strut_diagnostics_free(&result);
  strut_import_files_free(files, 2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size == 0) return 0;
  char *text = malloc(size);
  if (!text) return 0;
  memcpy(text, data + 1, size - 1);
  text[size - 1] = '\0';
  switch (data[0] % 6) {
    case 0: read_json(text, size - 1); break;
    case 1: read_dakota(text, size - 1); break;
    case 2: read_foreign(STRUT_IMPORT_NTRT, text, size - 1); break;
    case 3: read_foreign(STRUT_IMPORT_TENSEGRITYSIM, text, size - 1); break;
    case 4: read_foreign(STRUT_IMPORT_SPRINGABLE, text, size - 1); break;
    default: read_foreign(STRUT_IMPORT_TABLES, text, size - 1); break;
  }
  strut_import_guess(text, size - 1);
  free(text);
  return 0;
}
