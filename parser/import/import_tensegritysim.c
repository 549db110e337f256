/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TensegritySim: nodes, connections by builder, pins. Without units: metres and newtons. */
#include <string.h>

#include "parser/import/import_parts.h"

typedef struct tensegritysim {
  strut_import_scene *scene;
  strut_diagnostics *said;
  const strut_tree *nodes, *builders;
  size_t unnamed; /* members that the file gives no name */
} tensegritysim;

/* The mapping of a key; NULL where that was reported, or it is not required and not there. */
static const strut_tree *find_map(tensegritysim *t, const strut_tree *root, const char *key,
                                  bool required) {
  strut_tree *name = NULL;
  const strut_tree *value = strut_tree_find(root, key, &name);
  if (!value && required)
    strut_diagnose(t->said, root->place, "expected the key '%s' with a mapping", key);
  if (value && value->kind != STRUT_TREE_MAP) {
    strut_diagnose(t->said, value->place, "expected a mapping for '%s'", key);
    return NULL;
  }
  return value;
}

static bool is_true(const strut_tree *value) {
  return value->kind == STRUT_TREE_SCALAR &&
         (strcmp(value->text, "True") == 0 || strcmp(value->text, "true") == 0 ||
          strcmp(value->text, "yes") == 0 || strcmp(value->text, "1") == 0);
}

/* "", "x", "y" or "both". */
static const char *read_pin(tensegritysim *t, const strut_tree *pin, const char *node) {
  static const char *const words[] = {"", "x", "y", "both"};
  const strut_tree *value = pin ? strut_tree_find(pin, node, NULL) : NULL;
  if (!value) return "";
  if (value->kind != STRUT_TREE_LIST || value->count < 2) {
    strut_diagnose(t->said, value->place, "expected a list such as [True, True, False] for '%.60s'",
                   node);
    return "";
  }
  return words[is_true(value->first) + 2 * is_true(value->first->next)];
}

static void read_nodes(tensegritysim *t, const strut_tree *pin) {
  strut_import_scene *s = t->scene;
  for (const strut_tree *key = t->nodes->first; key; key = key->next->next) {
    const strut_tree *value = key->next;
    double p[3] = {0.0, 0.0, 0.0};
    if (value->kind != STRUT_TREE_LIST || value->count < 2 || value->count > 3) {
      strut_diagnose(t->said, value->place, "expected two or three coordinates for node '%.60s'",
                     key->text);
      continue;
    }
    const strut_tree *item = value->first;
    for (uint32_t i = 0; i < value->count; i++, item = item->next)
      strut_import_read_number(t->said, item, "a coordinate", &p[i]);
    if (p[2] != 0.0)
      strut_diagnose(t->said, value->place, "node '%.60s' is not in the plane z = 0", key->text);
    const char *fixed = read_pin(t, pin, key->text);
    strut_import_node_add(
        s, t->said, key->place, key->text,
        strut_import_text(s, "{position: [%s, %s]%s%s}", strut_import_length(s, p[0]),
                          strut_import_length(s, p[1]), *fixed ? ", fixed: " : "", fixed));
  }
  for (const strut_tree *key = pin ? pin->first : NULL; key; key = key->next->next)
    if (!strut_tree_find(t->nodes, key->text, NULL))
      strut_diagnose(t->said, key->place, "there is no node '%.60s' to pin", key->text);
}

/* "bar" or "cable", or NULL where that was reported. */
static const char *read_builder(tensegritysim *t, const strut_tree *key) {
  strut_import_scene *s = t->scene;
  const strut_tree *builder = strut_tree_find(t->builders, key->text, NULL);
  double stiffness = 0.0, ratio = 1.0;
  if (!builder || builder->kind != STRUT_TREE_MAP) {
    strut_diagnose(t->said, key->place, "'%.60s' has no builder", key->text);
    return NULL;
  }
  const strut_tree *type = strut_tree_find(builder, "type", NULL);
  const strut_tree *given = strut_tree_find(builder, "stiffness", NULL);
  const strut_tree *length = strut_tree_find(builder, "initial_length_ratio", NULL);
  bool bar = type && type->kind == STRUT_TREE_SCALAR && strcmp(type->text, "bar") == 0;
  bool string = type && type->kind == STRUT_TREE_SCALAR && strcmp(type->text, "string") == 0;
  if (!bar && !string)
    strut_diagnose(t->said, type ? type->place : builder->place,
                   "expected 'type: bar' or 'type: string' of builder '%.60s'", key->text);
  if (!given)
    strut_diagnose(t->said, builder->place, "builder '%.60s' lacks 'stiffness'", key->text);
  if (given) strut_import_read_number(t->said, given, "the stiffness", &stiffness);
  if (length) strut_import_read_number(t->said, length, "the ratio", &ratio);
  for (const strut_tree *k = builder->first; k; k = k->next->next)
    if (k->next != type && k->next != given && k->next != length)
      strut_note(t->said, k->place, "not imported: '%.60s' of a builder", k->text);
  strut_import_line(s, &s->section[STRUT_IMPORT_GROUPS],
                    "  %s: {kind: %s, stiffness: %s N/m, rest_length_ratio: %s}",
                    strut_import_name(s, key->text), bar ? "bar" : "cable",
                    strut_import_number(s, stiffness), strut_import_number(s, ratio));
  return bar ? "bar" : "cable";
}

static void read_connection(tensegritysim *t, const strut_tree *group, const char *kind,
                            const strut_tree *name, const strut_tree *list) {
  strut_import_scene *s = t->scene;
  const char *nodes = "";
  if (list->kind != STRUT_TREE_LIST || list->count < 2 || list->count > 32) {
    strut_diagnose(t->said, list->place, "expected a list of two or more nodes");
    return;
  }
  if (list->count > 2 && strcmp(kind, "bar") == 0)
    strut_diagnose(t->said, list->place, "a bar has two nodes, found %u", (unsigned)list->count);
  for (const strut_tree *item = list->first; item; item = item->next) {
    bool known = item->kind == STRUT_TREE_SCALAR && strut_tree_find(t->nodes, item->text, NULL);
    if (!known)
      strut_diagnose(t->said, item->place, "there is no node '%.60s'",
                     item->kind == STRUT_TREE_SCALAR ? item->text : "");
    else
      nodes = strut_import_text(s, "%s%s%s", nodes, *nodes ? ", " : "",
                                strut_import_node_use(s, item->text));
  }
  const char *own =
      name ? strut_import_name(s, name->text)
           : strut_import_text(s, "%s-%zu", strut_import_name(s, group->text), ++t->unnamed);
  strut_import_line(s, &s->section[STRUT_IMPORT_MEMBERS], "  %s: {group: %s, nodes: [%s]}", own,
                    strut_import_name(s, group->text), nodes);
}

static void read_connections(tensegritysim *t, const strut_tree *connections) {
  for (const strut_tree *key = connections->first; key; key = key->next->next) {
    const char *kind = read_builder(t, key);
    const strut_tree *list = key->next;
    t->unnamed = 0;
    if (list->kind != STRUT_TREE_LIST) {
      strut_diagnose(t->said, list->place, "expected a list of connections for '%.60s'", key->text);
      continue;
    }
    for (const strut_tree *item = list->first; item && kind; item = item->next) {
      if (item->kind != STRUT_TREE_MAP) {
        read_connection(t, key, kind, NULL, item);
        continue;
      }
      for (const strut_tree *name = item->first; name; name = name->next->next)
        read_connection(t, key, kind, name, name->next);
    }
  }
}

static void read_root(tensegritysim *t, const strut_tree *root) {
  t->nodes = find_map(t, root, "nodes", true);
  t->builders = find_map(t, root, "builders", true);
  const strut_tree *connections = find_map(t, root, "connections", true);
  const strut_tree *pin = find_map(t, root, "pin", false);
  for (const strut_tree *key = root->first; key; key = key->next->next) {
    if (strcmp(key->text, "surface") == 0)
      strut_diagnose(t->said, key->place, "a structure on a cylinder is not planar");
    else if (strcmp(key->text, "control") == 0)
      strut_note(t->said, key->place,
                 "not imported: which strings are controlled; 'actuators' drive rest lengths");
    else if (key->next != t->nodes && key->next != t->builders && key->next != connections &&
             key->next != pin)
      strut_diagnose(
          t->said, key->place,
          "expected nodes, connections, builders, pin, control or surface, found '%.60s'",
          key->text);
  }
  if (t->nodes) read_nodes(t, pin);
  if (t->nodes && t->builders && connections) read_connections(t, connections);
}

strut_status strut_import_tensegritysim(strut_import_scene *s) {
  strut_document document = {0};
  tensegritysim t = {.scene = s, .said = &s->files[0].diagnostics};
  strut_status status = strut_document_read(&document, t.said);
  if (!status && document.root->kind != STRUT_TREE_MAP)
    strut_diagnose(t.said, document.root->place, "expected a mapping with nodes and connections");
  else if (!status)
    read_root(&t, document.root);
  strut_document_free(&document);
  return status;
}
