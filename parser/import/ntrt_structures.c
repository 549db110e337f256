/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/import/ntrt.h"

#include <math.h>
#include <string.h>

enum { MOST_DEPTH = 16, MOST_STRUCTURES = 10000, MOST_NODES = 20000, LONGEST_NAME = 500 };

/* A structure: the nodes first .. end - 1, and what their names begin with. */
typedef struct structure {
  size_t file, first, end;
  const char *prefix;
  int depth;
} structure;

/* Room for one more in an array of the arena; NULL: out of memory. */
static void *reserve(strut_ntrt *n, void *items, size_t count, size_t *room, size_t size) {
  if (count < *room) return items;
  *room = 2 * *room + 64;
  void *more = strut_arena_allocate(&n->scene->arena, *room, size);
  if (!more) n->scene->out_of_memory = true;
  if (more && count) memcpy(more, items, count * size);
  return more;
}

static strut_diagnostics *said_of(const strut_ntrt *n, const structure *s) {
  return &n->scene->files[s->file].diagnostics;
}

/* Three numbers; false where that was reported. */
static bool read_point(strut_diagnostics *said, const strut_tree *value, double p[3]) {
  if (value->kind != STRUT_TREE_LIST || value->count != 3) {
    strut_diagnose(said, value->place, "expected three coordinates [x, y, z]");
    return false;
  }
  const strut_tree *item = value->first;
  bool fine = true;
  for (int i = 0; i < 3; i++, item = item->next)
    fine = strut_import_read_number(said, item, "a coordinate", &p[i]) && fine;
  return fine;
}

/* False: there are too many. */
static bool read_nodes(strut_ntrt *n, const structure *s, const strut_tree *map) {
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    strut_ntrt_node node = {.place = key->place, .said = said_of(n, s)};
    if (!read_point(node.said, key->next, node.p)) continue;
    if (n->node_count == MOST_NODES) {
      strut_diagnose(node.said, key->place, "these are more than %d nodes", MOST_NODES);
      return false;
    }
    node.name = strut_import_text(n->scene, "%s%.*s", s->prefix, LONGEST_NAME, key->text);
    strut_ntrt_node *room = reserve(n, n->nodes, n->node_count, &n->node_room, sizeof *room);
    if (!room) return false;
    n->nodes = room;
    n->nodes[n->node_count++] = node;
  }
  return true;
}

/* The node that a structure calls so: its own, or the only one of structures in it. -1: it was reported. */
static int32_t find_node(const strut_ntrt *n, const structure *s, strut_diagnostics *said,
                         const strut_tree *item) {
  const char *name = item->kind == STRUT_TREE_SCALAR ? item->text : "";
  size_t length = strlen(name), shared = strlen(s->prefix);
  int32_t found = -1, count = 0;
  for (size_t i = s->first; i < s->end && length; i++) {
    const char *own = n->nodes[i].name + shared;
    size_t more = strlen(own);
    if (strcmp(own, name) == 0) return (int32_t)i;
    if (more < length + 2 || own[more - length - 1] != '.' ||
        strcmp(own + more - length, name) != 0)
      continue;
    found = (int32_t)i, count++;
  }
  if (count == 1) return found;
  if (count)
    strut_diagnose(said, item->place,
                   "%d nodes are called '%.60s': write of which structure it is, "
                   "STRUCTURE.%.60s",
                   count, name, name);
  else
    strut_diagnose(said, item->place, "there is no node '%.60s'", name);
  return -1;
}

/* Pairs of nodes of two structures, or twice the same one. */
static void read_pairs(strut_ntrt *n, const structure *from, const structure *to,
                       strut_diagnostics *said, const strut_tree *list,
                       const strut_ntrt_pair *like) {
  if (list->kind != STRUT_TREE_LIST) {
    strut_diagnose(said, list->place, "expected a list of pairs for '%.60s'", like->tags);
    return;
  }
  for (const strut_tree *item = list->first; item; item = item->next) {
    strut_ntrt_pair pair = *like;
    if (item->kind != STRUT_TREE_LIST || item->count != 2) {
      strut_diagnose(said, item->place, "expected a pair of nodes [a, b]");
      continue;
    }
    pair.end[0] = find_node(n, from, said, item->first);
    pair.end[1] = find_node(n, to, said, item->first->next);
    if (pair.end[0] < 0 || pair.end[1] < 0) continue;
    strut_ntrt_pair *room = reserve(n, n->pairs, n->pair_count, &n->pair_room, sizeof *room);
    if (!room) return;
    n->pairs = room;
    n->pairs[n->pair_count++] = pair;
  }
}

static void read_builders(strut_ntrt *n, const structure *s, const strut_tree *map) {
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    size_t i = 0;
    while (i < n->builder_count && strcmp(n->builders[i].key->text, key->text) != 0) i++;
    strut_ntrt_builder *room =
        reserve(n, n->builders, n->builder_count, &n->builder_room, sizeof *room);
    if (!room) return;
    n->builders = room;
    n->builders[i] = (strut_ntrt_builder){key, said_of(n, s)};
    if (i == n->builder_count) n->builder_count++;
  }
}

/* ---- structures in others ---- */

/* The middle of its nodes. */
static void find_centre(const strut_ntrt *n, const structure *s, double centre[3]) {
  for (int c = 0; c < 3; c++) {
    centre[c] = 0.0;
    for (size_t i = s->first; i < s->end; i++) centre[c] += n->nodes[i].p[c];
    centre[c] /= s->end > s->first ? (double)(s->end - s->first) : 1.0;
  }
}

static void rotate(strut_ntrt *n, const structure *s, const double axis[3], double angle,
                   const double centre[3]) {
  double cosine = cos(angle), sine = sin(angle);
  for (size_t i = s->first; i < s->end; i++) {
    double *p = n->nodes[i].p, v[3], along = 0.0;
    for (int c = 0; c < 3; c++) v[c] = p[c] - centre[c], along += axis[c] * v[c];
    for (int c = 0; c < 3; c++) {
      int d = (c + 1) % 3, e = (c + 2) % 3;
      double across = axis[d] * v[e] - axis[e] * v[d];
      p[c] = centre[c] + v[c] * cosine + across * sine + axis[c] * along * (1.0 - cosine);
    }
  }
}

/* `rotation: {axis, angle, reference}`, about the middle without a reference. */
static void read_rotation(strut_ntrt *n, const structure *s, strut_diagnostics *said,
                          const strut_tree *map) {
  static const double degree = 0.017453292519943295;
  double axis[3] = {0.0}, angle = 0.0, centre[3];
  const strut_tree *given[3] = {NULL, NULL, NULL};
  static const char *const keys[] = {"axis", "angle", "reference"};
  for (int k = 0; k < 3 && map->kind == STRUT_TREE_MAP; k++)
    given[k] = strut_tree_find(map, keys[k], NULL);
  if (!given[0] || !given[1]) {
    strut_diagnose(said, map->place, "expected a rotation with 'axis' and 'angle'");
    return;
  }
  find_centre(n, s, centre);
  if (!read_point(said, given[0], axis) ||
      !strut_import_read_number(said, given[1], "an angle", &angle) ||
      (given[2] && !read_point(said, given[2], centre)))
    return;
  double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  if (!(length > 0.0)) {
    strut_diagnose(said, given[0]->place, "the axis of a rotation has no direction");
    return;
  }
  for (int c = 0; c < 3; c++) axis[c] /= length;
  rotate(n, s, axis, angle * degree, centre);
}

static void move(strut_ntrt *n, const structure *s, const double way[3], double times) {
  for (size_t i = s->first; i < s->end; i++)
    for (int c = 0; c < 3; c++) n->nodes[i].p[c] += times * way[c];
}

static void scale(strut_ntrt *n, const structure *s, double factor) {
  double centre[3];
  find_centre(n, s, centre);
  for (size_t i = s->first; i < s->end; i++)
    for (int c = 0; c < 3; c++)
      n->nodes[i].p[c] = centre[c] + factor * (n->nodes[i].p[c] - centre[c]);
}

/* Places the index-th structure of a key: rotated, scaled, moved on by the offset, moved. */
static void place(strut_ntrt *n, const structure *s, strut_diagnostics *said,
                  const strut_tree *attributes, int index) {
  const strut_tree *rotation = strut_tree_find(attributes, "rotation", NULL);
  const strut_tree *scaling = strut_tree_find(attributes, "scale", NULL);
  const strut_tree *offset = strut_tree_find(attributes, "offset", NULL);
  const strut_tree *translation = strut_tree_find(attributes, "translation", NULL);
  double factor = 1.0, way[3] = {0.0};
  if (rotation) read_rotation(n, s, said, rotation);
  if (scaling && strut_import_read_number(said, scaling, "a scale", &factor)) scale(n, s, factor);
  if (offset && read_point(said, offset, way)) move(n, s, way, (double)index);
  if (translation && read_point(said, translation, way)) move(n, s, way, 1.0);
}

/* Does a file's name end with this path? */
static bool ends_with(const char *name, const char *path) {
  size_t length = strlen(name), tail = strlen(path);
  if (length < tail || strcmp(name + length - tail, path) != 0) return false;
  return length == tail || name[length - tail - 1] == '/';
}

/* The file that a path means, among those that were given; -1: it was reported. */
static int find_file(const strut_ntrt *n, strut_diagnostics *said, const strut_tree *path) {
  const char *tail = path && path->kind == STRUT_TREE_SCALAR ? path->text : "";
  int found = -1, count = 0;
  while (strncmp(tail, "./", 2) == 0 || strncmp(tail, "../", 3) == 0) tail = strchr(tail, '/') + 1;
  for (size_t i = 0; i < n->scene->file_count && *tail; i++)
    if (ends_with(n->scene->files[i].name, tail)) found = (int)i, count++;
  if (count == 1) return found;
  if (count)
    strut_diagnose(said, path->place, "%d of the files are called '%.200s'", count, tail);
  else if (*tail)
    strut_diagnose(said, path->place,
                   "the file '%.200s' was not given: name it behind the first one", tail);
  else if (path)
    strut_diagnose(said, path->place, "expected the path of a file");
  return -1;
}

static bool read_structure(strut_ntrt *n, structure *s);

static bool knows_attributes(strut_diagnostics *said, const strut_tree *key) {
  static const char *const known[] = {"path", "rotation", "translation", "scale", "offset"};
  bool fine = key->next->kind == STRUT_TREE_MAP;
  if (!fine)
    strut_diagnose(said, key->next->place, "expected a mapping with the path of '%.60s'",
                   key->text);
  for (const strut_tree *a = fine ? key->next->first : NULL; a; a = a->next->next) {
    size_t i = 0;
    while (i < 5 && strcmp(known[i], a->text) != 0) i++;
    if (i < 5) continue;
    strut_diagnose(said, a->place,
                   "expected path, rotation, translation, scale or offset, found '%.60s'", a->text);
    fine = false;
  }
  return fine;
}

/* The next of names with slashes between, of at most LONGEST_NAME; NULL: there is none. */
static const char *next_name(strut_ntrt *n, const char **at) {
  size_t length = strcspn(*at, "/");
  if (!length) return NULL;
  const char *name = strut_import_text(n->scene, "%.*s",
                                       (int)(length < LONGEST_NAME ? length : LONGEST_NAME), *at);
  *at += length + ((*at)[length] == '/');
  return name;
}

static bool read_substructures(strut_ntrt *n, const structure *s, const strut_tree *map) {
  strut_diagnostics *said = said_of(n, s);
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    const char *at = key->text, *name;
    if (!knows_attributes(said, key)) continue;
    const strut_tree *path = strut_tree_find(key->next, "path", NULL);
    int file = find_file(n, said, path);
    if (!path) strut_diagnose(said, key->place, "'%.60s' has no path", key->text);
    if (file < 0) continue;
    for (int index = 0; (name = next_name(n, &at)) != NULL; index++) {
      structure child = {.file = (size_t)file, .depth = s->depth + 1};
      child.prefix = strut_import_text(n->scene, "%s%s.", s->prefix, name);
      if (++n->structures > MOST_STRUCTURES) {
        strut_diagnose(said, key->place, "these are more than %d structures", MOST_STRUCTURES);
        return false;
      }
      if (child.depth > MOST_DEPTH) {
        strut_diagnose(said, key->place, "structures are more than %d deep in each other",
                       MOST_DEPTH);
        return false;
      }
      if (!read_structure(n, &child)) return false;
      place(n, &child, said, key->next, index);
    }
  }
  return true;
}

/* The structure of that name in another, by its nodes; false: it has none, or there is no such one. */
static bool find_structure(strut_ntrt *n, const structure *s, const char *name, structure *child) {
  *child = *s;
  child->prefix = strut_import_text(n->scene, "%s%s.", s->prefix, name);
  size_t length = strlen(child->prefix);
  while (child->first < s->end && strncmp(n->nodes[child->first].name, child->prefix, length) != 0)
    child->first++;
  child->end = child->first;
  while (child->end < s->end && strncmp(n->nodes[child->end].name, child->prefix, length) == 0)
    child->end++;
  return child->end > child->first;
}

/* "a/b/c/node_node": pairs between neighbours. */
static void read_bonds(strut_ntrt *n, const structure *s, const strut_tree *bond, const char *tags,
                       const strut_tree *list) {
  strut_diagnostics *said = said_of(n, s);
  const char *at = bond->text, *type = strrchr(bond->text, '/') + 1;
  if (strcmp(type, "node_node") != 0) {
    strut_diagnose(
        said, bond->place,
        strcmp(type, "node_edge") == 0
            ? "'node_edge' is not read: it places structures in space by itself; use node_node"
            : "expected node_node behind the structures");
    return;
  }
  const char *name, *before = NULL;
  structure child, last = {0};
  int count = 0;
  while (at < type && (name = next_name(n, &at)) != NULL) {
    if (!find_structure(n, s, name, &child)) {
      strut_diagnose(said, bond->place, "there is no structure '%.60s' with nodes", name);
      return;
    }
    if (before)
      read_pairs(
          n, &last, &child, said, list,
          &(strut_ntrt_pair){
              .base = strut_import_text(n->scene, "%s%s_%s_%.100s", s->prefix, before, name, tags),
              .tags = strut_import_text(n->scene, "%.200s %s %s", tags, before, name),
              .place = bond->place,
              .said = said});
    before = name, last = child, count++;
  }
  if (count < 2)
    strut_diagnose(said, bond->place, "expected a bond between two structures, a/b/node_node");
}

static void read_bond_groups(strut_ntrt *n, const structure *s, const strut_tree *map) {
  for (const strut_tree *outer = map->first; outer; outer = outer->next->next) {
    if (outer->next->kind != STRUT_TREE_MAP) {
      strut_diagnose(said_of(n, s), outer->next->place, "expected bonds or tags in '%.60s'",
                     outer->text);
      continue;
    }
    for (const strut_tree *inner = outer->next->first; inner; inner = inner->next->next) {
      const strut_tree *bond = strchr(outer->text, '/') ? outer : inner;
      const char *tags = bond == outer ? inner->text : outer->text;
      if (strchr(bond->text, '/') && !strchr(tags, '/'))
        read_bonds(n, s, bond, tags, inner->next);
      else
        strut_diagnose(said_of(n, s), inner->place,
                       "expected a bond such as a/b/node_node in tags, or tags in a bond");
    }
  }
}

static strut_document *document_of(strut_ntrt *n, const structure *s) {
  strut_document *document = &n->documents[s->file];
  strut_diagnostics *said = said_of(n, s);
  if (!document->root && strut_document_read(document, said)) return NULL;
  if (document->root && document->root->kind == STRUT_TREE_MAP) return document;
  if (document->root)
    strut_diagnose(said, document->root->place, "expected a mapping with nodes and pair_groups");
  return NULL;
}

static bool read_structure(strut_ntrt *n, structure *s) {
  enum { NODES, PAIRS, BUILDERS, STRUCTURES, BONDS, KEYS };
  static const char *const keys[KEYS] = {"nodes", "pair_groups", "builders", "substructures",
                                         "bond_groups"};
  const strut_tree *value[KEYS] = {NULL};
  strut_diagnostics *said = said_of(n, s);
  strut_document *document = document_of(n, s);
  if (!document) return false;
  for (const strut_tree *key = document->root->first; key; key = key->next->next) {
    size_t i = 0;
    while (i < KEYS && strcmp(keys[i], key->text) != 0) i++;
    if (i == KEYS)
      strut_diagnose(
          said, key->place,
          "expected nodes, pair_groups, builders, substructures or bond_groups, found '%.60s'",
          key->text);
    else if (key->next->kind != STRUT_TREE_MAP)
      strut_diagnose(said, key->next->place, "expected a mapping for '%s'", key->text);
    else
      value[i] = key->next;
  }
  s->first = n->node_count;
  if (value[STRUCTURES] && !read_substructures(n, s, value[STRUCTURES])) return false;
  if (value[BUILDERS]) read_builders(n, s, value[BUILDERS]);
  if (value[NODES] && !read_nodes(n, s, value[NODES])) return false;
  s->end = n->node_count;
  for (const strut_tree *key = value[PAIRS] ? value[PAIRS]->first : NULL; key;
       key = key->next->next)
    read_pairs(
        n, s, s, said, key->next,
        &(strut_ntrt_pair){.base = strut_import_text(n->scene, "%s%.200s", s->prefix, key->text),
                           .tags = key->text,
                           .place = key->place,
                           .said = said});
  if (value[BONDS]) read_bond_groups(n, s, value[BONDS]);
  if (!value[NODES] && !value[STRUCTURES])
    strut_diagnose(said, document->root->place, "expected mappings 'nodes' and 'pair_groups'");
  return !strut_diagnostics_full(said) && !n->scene->out_of_memory;
}

strut_status strut_ntrt_read(strut_ntrt *n) {
  structure whole = {.prefix = ""};
  n->documents = strut_arena_allocate(&n->scene->arena, n->scene->file_count, sizeof *n->documents);
  if (!n->documents) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < n->scene->file_count; i++) n->documents[i] = (strut_document){0};
  read_structure(n, &whole);
  return n->scene->out_of_memory ? STRUT_NO_MEMORY : STRUT_OK;
}

void strut_ntrt_free(strut_ntrt *n) {
  for (size_t i = 0; i < n->scene->file_count && n->documents; i++)
    strut_document_free(&n->documents[i]);
}
