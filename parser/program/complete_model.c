/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Names in the model that a command line mentions. Messages would disturb the line that is being typed:
 * what cannot be read offers nothing. See complete.h.
 */
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/program/complete.h"
#include "parser/read/read_scene.h"
#include "parser/read/reader.h"
#include "parser/read/used_files.h"

enum { LARGEST = 4 << 20, PATH = 4096 };

/* The model as a tree, with what its base gives; and as a scene if it is valid. Zero-initialise. */
typedef struct opened {
  char path[PATH];
  char *text;
  size_t length;
  strut_diagnostics diagnostics;
  strut_scene_source *source;
  strut_document alone; /* the tree of a text that is no valid source */
  const strut_tree *root;
  strut_setup setup;
  bool valid;
} opened;

static void close_model(opened *o) {
  strut_scene_source_free(o->source);
  strut_document_free(&o->alone);
  strut_diagnostics_free(&o->diagnostics);
  if (o->valid) strut_setup_free(&o->setup);
  strut_release(o->text);
  *o = (opened){.text = NULL};
}

static bool read_text(opened *o) {
  struct stat found;
  strut_error error = {0};
  bool small = stat(o->path, &found) == 0 && S_ISREG(found.st_mode) && found.st_size <= LARGEST;
  return small && strut_file_read(o->path, &o->text, &o->length, &error) == STRUT_OK;
}

/* The path of the model of a study, which is o->path, where a study may name it. */
static bool follow_study(opened *o, const strut_tree *root) {
  const strut_tree *model = strut_tree_find(root, "model", NULL);
  strut_arena arena = {0};
  strut_safe_text text = {0};
  strut_error error = {0};
  if (!model || model->kind != STRUT_TREE_SCALAR) return false;
  const char *folder = strut_folder_of(o->path, &arena);
  bool found = folder &&
               strut_safe_read(folder, o->path, model->text, LARGEST, &text, &error) == STRUT_OK &&
               strlen(text.path) < sizeof o->path;
  if (found) strcpy(o->path, text.path);
  strut_safe_text_free(&text);
  strut_arena_free(&arena);
  return found;
}

/* The tree of o->path; false where there is none. */
static bool read_tree(opened *o) {
  if (!read_text(o)) return false;
  if (strut_scene_source_open(o->path, o->text, o->length, &o->diagnostics, &o->source) ==
      STRUT_OK) {
    o->root = strut_scene_source_document(o->source)->root;
  } else {
    strut_diagnostics_free(&o->diagnostics);
    o->diagnostics = (strut_diagnostics){0};
    strut_diagnostics_source(&o->diagnostics, o->path, o->text, o->length);
    strut_document_read(&o->alone, &o->diagnostics);
    o->root = o->alone.root;
  }
  return o->root && o->root->kind == STRUT_TREE_MAP;
}

static bool open_model(const strut_completion *c, opened *o) {
  struct stat found;
  if (!c->model) return false;
  bool run = stat(c->model, &found) == 0 && S_ISDIR(found.st_mode);
  int length = snprintf(o->path, sizeof o->path, "%s%s", c->model, run ? "/scene.yaml" : "");
  if (length < 0 || (size_t)length >= sizeof o->path || !read_tree(o)) return false;
  if (!strut_tree_is_study(o->root)) return true;
  opened model = {.text = NULL};
  memcpy(model.path, o->path, sizeof model.path);
  bool followed = follow_study(&model, o->root);
  close_model(o);
  *o = model;
  return followed && read_tree(o) && !strut_tree_is_study(o->root);
}

/* Things of copies are known once the scene was read. */
static bool read_scene(opened *o) {
  strut_diagnostics unused = {0};
  o->valid = strut_setup_read(&o->setup, o->path, o->text, o->length, NULL, 0, STRUT_FOR_ANY,
                              &unused) == STRUT_OK;
  strut_diagnostics_free(&unused);
  return o->valid;
}

/* The names in a mapping of the tree. */
static void offer_keys(const strut_completion *c, const opened *o, const char *map,
                       const char *end) {
  const strut_tree *things = strut_tree_find(o->root, map, NULL);
  if (!things || things->kind != STRUT_TREE_MAP) return;
  for (const strut_tree *key = things->first; key; key = key->next->next) {
    bool shown = key->next->kind == STRUT_TREE_SCALAR;
    strut_offer(c, key->text, end, shown ? key->next->text : NULL);
  }
}

void strut_offer_parameters(const strut_completion *c) {
  opened o = {.text = NULL};
  if (open_model(c, &o)) offer_keys(c, &o, "parameters", "=");
  close_model(&o);
}

void strut_offer_values(const strut_completion *c) {
  opened o = {.text = NULL};
  size_t length = strcspn(c->word, "=");
  const strut_tree *map = open_model(c, &o) ? strut_tree_find(o.root, "parameters", NULL) : NULL;
  for (const strut_tree *key = map && map->kind == STRUT_TREE_MAP ? map->first : NULL; key;
       key = key->next->next) {
    if (strlen(key->text) != length || strncmp(key->text, c->word, length) != 0 ||
        key->next->kind != STRUT_TREE_SCALAR)
      continue;
    strut_completion value = *c;
    value.word = c->word + length + 1;
    value.kept = c->kept + (int)length + 1;
    strut_offer(&value, key->next->text, "", "as in the model");
  }
  close_model(&o);
}

void strut_offer_shapes(const strut_completion *c) {
  opened o = {.text = NULL};
  strut_offer(c, "drawn", "", "the drawn shape");
  strut_offer(c, "start", "", "where a run starts");
  if (open_model(c, &o)) {
    if (read_scene(&o))
      for (size_t i = 0; i < o.setup.scene.configuration_count; i++)
        strut_offer(c, o.setup.scene.configurations[i].name, "", "configuration");
    else
      offer_keys(c, &o, "configurations", "");
  }
  close_model(&o);
}

/* `ends` (NULL after the last) are put behind each. */
static void offer_all_nodes(const strut_completion *c, opened *o, const char *const *ends) {
  if (!o->valid && !read_scene(o)) {
    for (; *ends; ends++) offer_keys(c, o, "nodes", *ends);
    return;
  }
  for (size_t i = 0; i < o->setup.scene.node_count; i++)
    for (const char *const *end = ends; *end; end++)
      strut_offer(c, o->setup.scene.nodes[i].name, *end, "node");
}

void strut_offer_nodes(const strut_completion *c) {
  static const char *const ends[] = {"", NULL};
  opened o = {.text = NULL};
  if (open_model(c, &o)) offer_all_nodes(c, &o, ends);
  close_model(&o);
}

void strut_offer_loads(const strut_completion *c) {
  opened o = {.text = NULL};
  if (open_model(c, &o)) {
    if (read_scene(&o))
      for (size_t i = 0; i < o.setup.scene.load_count; i++)
        strut_offer(c, o.setup.scene.loads[i].name, "", "load");
    else
      offer_keys(c, &o, "loads", "");
  }
  close_model(&o);
}

void strut_offer_path_parameters(const strut_completion *c) {
  static const char *const ends[] = {".x", ".y", NULL};
  opened o = {.text = NULL};
  if (open_model(c, &o)) {
    offer_keys(c, &o, "parameters", "");
    offer_keys(c, &o, "actuators", "");
    /* names and displacements of a large structure would fill the screen */
    const char *dot = strrchr(c->word, '.');
    if (*c->word || dot) offer_all_nodes(c, &o, ends);
  }
  close_model(&o);
}

void strut_offer_columns(const strut_completion *c, const char *end) {
  char line[8192];
  FILE *file = c->model ? fopen(c->model, "r") : NULL;
  if (!file) return;
  bool read = fgets(line, sizeof line, file) != NULL;
  fclose(file);
  if (!read) return;
  line[strcspn(line, "\r\n")] = '\0';
  for (char *at = line, *next; at; at = next) {
    next = strchr(at, ',');
    if (next) *next++ = '\0';
    char *unit = strstr(at, " [");
    if (unit) *unit = '\0';
    if (!strchr(at, '"')) strut_offer(c, at, end, unit ? unit + 1 : NULL);
  }
}
