/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/read/overlay.h"

#include <string.h>

#include "engine/base/name_map.h"

/* ---- what a mapping is ---- */

strut_mapping_kind strut_kind_below(strut_mapping_kind kind, const char *key) {
  const strut_mapping_kind nothing = {STRUT_SECTION_COUNT, false};
  if (kind.section == STRUT_SECTION_COUNT) return nothing;
  if (kind.things) return (strut_mapping_kind){kind.section, false};
  int k = strut_key_find(kind.section, strut_key_current(kind.section, key));
  if (k < 0) return nothing;
  const strut_key *row = strut_key_at(k);
  if (row->type == STRUT_TYPE_SIGNAL) return (strut_mapping_kind){STRUT_SECTION_SIGNAL, false};
  return (strut_mapping_kind){strut_section_below(row), row->type == STRUT_TYPE_THINGS};
}

/* ---- keys that replace each other ---- */

/* Pairs of keys of which the first, laid over, also replaces the second. */
static const char *const rivals[][2] = {
    {"duration", "of"},           {"step", "accuracy"},      {"integrator", "accuracy"},
    {"equilibrium", "positions"}, {"equilibrium", "settle"}, {"configuration", "equilibrium"},
    {"positions", "equilibrium"}, {"settle", "equilibrium"}, {"equilibrium", "configuration"}};

enum { RIVALS = sizeof rivals / sizeof rivals[0] };

/* The name of a key in a mapping: it may have its former one. */
static const char *current(strut_mapping_kind kind, const strut_tree *key) {
  bool keys = kind.section != STRUT_SECTION_COUNT && !kind.things;
  return keys ? strut_key_current(kind.section, key->text) : key->text;
}

static int find_key(strut_mapping_kind kind, const char *name) {
  bool keys = kind.section != STRUT_SECTION_COUNT && !kind.things;
  return keys ? strut_key_find(kind.section, name) : -1;
}

/* The keys of a mapping by name. */
typedef struct key_index {
  strut_mapping_kind kind;
  strut_name_map names;
  const strut_tree **key;
  uint64_t sets;      /* bits: of some key, see keys_table.h */
  bool beats[RIVALS]; /* the first of the pair is there */
} key_index;

static bool index_keys(key_index *index, strut_mapping_kind kind, const strut_tree *map) {
  *index =
      (key_index){.kind = kind, .key = strut_allocate((size_t)map->count + 1, sizeof *index->key)};
  if (!index->key) return false;
  size_t count = 0;
  for (const strut_tree *k = map->first; k; k = k->next->next, count++) {
    const char *name = current(kind, k);
    index->key[count] = k;
    if (strut_name_map_add(&index->names, name, (int32_t)count) == -2) return false;
    int key = find_key(kind, name);
    if (key >= 0 && strut_key_at(key)->set) index->sets |= UINT64_C(1) << strut_key_at(key)->set;
    for (size_t i = 0; i < RIVALS && key >= 0; i++)
      if (strcmp(name, rivals[i][0]) == 0) index->beats[i] = true;
  }
  return true;
}

static void free_index(key_index *index) {
  strut_name_map_free(&index->names);
  strut_release(index->key);
}

/* The key that says the same, or NULL. */
static const strut_tree *same_key(const key_index *index, const strut_tree *key) {
  int32_t i = strut_name_map_find(&index->names, current(index->kind, key));
  return i < 0 ? NULL : index->key[i];
}

/* Does some key that is laid over say the same as this one in another way? */
static bool is_replaced(const key_index *over, const strut_tree *key) {
  const char *name = current(over->kind, key);
  int found = find_key(over->kind, name);
  if (found < 0) return false;
  for (size_t i = 0; i < RIVALS; i++)
    if (over->beats[i] && strcmp(name, rivals[i][1]) == 0) return true;
  return strut_key_at(found)->set && over->sets >> strut_key_at(found)->set & 1;
}

bool strut_says_otherwise(strut_mapping_kind kind, const strut_tree *map, const char *key) {
  int k = find_key(kind, key), set = k < 0 ? 0 : strut_key_at(k)->set;
  for (const strut_tree *other = map->first; other && set; other = other->next->next) {
    int o = find_key(kind, other->text);
    if (o >= 0 && o != k && strut_key_at(o)->set == set) return true;
  }
  return false;
}

/* ---- trees ---- */

/* A copy of the node that shares its children; NULL: memory is out. */
static strut_tree *copied(strut_arena *arena, const strut_tree *node) {
  strut_tree *copy = strut_arena_allocate(arena, 1, sizeof *copy);
  if (!copy) return NULL;
  *copy = *node;
  copy->next = NULL;
  return copy;
}

static strut_tree *marked_node(const strut_overlay *o, const strut_tree *node) {
  strut_tree *copy = copied(o->arena, node);
  if (copy) copy->place.line |= o->mark;
  return copy;
}

strut_tree *strut_mark_tree(const strut_overlay *o, const strut_tree *node) {
  strut_tree *copy = marked_node(o, node);
  if (!copy || !o->mark) return copy;
  strut_tree **end = &copy->first;
  for (const strut_tree *child = node->first; child; child = child->next) {
    *end = strut_mark_tree(o, child);
    if (!*end) return NULL;
    end = &(*end)->next;
  }
  return copy;
}

static bool is_removal(const strut_tree *value) {
  return value->kind == STRUT_TREE_SCALAR && !value->quoted && strcmp(value->text, "remove") == 0;
}

/* `[x, y]` of a node as {position: [x, y]}. NULL: memory is out. */
static strut_tree *written_out(strut_arena *arena, const strut_tree *list) {
  strut_tree *map = copied(arena, list), *key = copied(arena, list), *value = copied(arena, list);
  if (!map || !key || !value) return NULL;
  *key = (strut_tree){.kind = STRUT_TREE_SCALAR, .place = list->place, .text = "position"};
  key->next = value;
  map->kind = STRUT_TREE_MAP;
  map->count = 1;
  map->first = key;
  return map;
}

/* The value of a key that both mappings have. */
static strut_tree *joined(const strut_overlay *o, strut_mapping_kind kind, const strut_tree *below,
                          const strut_tree *over) {
  bool node = kind.section == STRUT_SECTION_NODE && !kind.things;
  bool list_below = below->kind == STRUT_TREE_LIST, list_over = over->kind == STRUT_TREE_LIST;
  if (node && list_below && over->kind == STRUT_TREE_MAP)
    below = written_out(o->arena, below);
  else if (node && list_over && below->kind == STRUT_TREE_MAP)
    over = written_out(o->arena, over);
  if (!below || !over) return NULL;
  bool part = kind.section == STRUT_SECTION_PART && !kind.things;
  if (part && strut_tree_find(over, "use", NULL)) return strut_mark_tree(o, over);
  if (below->kind == STRUT_TREE_MAP && over->kind == STRUT_TREE_MAP)
    return strut_lay_over(o, kind, below, over);
  return strut_mark_tree(o, over);
}

static const char *name_at(const void *context, size_t i) {
  const strut_tree *k = ((const strut_tree *)context)->first;
  while (k && i-- > 0) k = k->next->next;
  return k ? k->text : NULL;
}

/* Takes away what is not there? Things of copies are looked for when these are made. */
static bool removes_nothing(const strut_overlay *o, const strut_tree *base, const strut_tree *key) {
  if (!o->diagnostics || !is_removal(key->next) || strpbrk(key->text, ".*")) return false;
  const char *meant = base->count <= 1000 ? strut_did_you_mean(key->text, name_at, base) : NULL;
  int shown = (int)strcspn(key->text, "\n");
  strut_diagnose(o->diagnostics, key->place, "there is no '%.*s' to remove%s%.64s%s",
                 shown > 64 ? 64 : shown, key->text, meant ? "; did you mean '" : "",
                 meant ? meant : "", meant ? "'?" : "");
  return true;
}

/* A mapping that grows. */
typedef struct builder {
  strut_tree *map, **end;
} builder;

static bool append(builder *b, strut_tree *key, strut_tree *value) {
  if (!key || !value) return false;
  *b->end = key;
  key->next = value;
  b->end = &value->next;
  b->map->count++;
  return true;
}

/* The keys of the base, changed or not, then those that it has not. */
static bool join(const strut_overlay *o, const key_index *below, const strut_tree *base,
                 const key_index *above, const strut_tree *over, builder *b) {
  for (const strut_tree *k = base->first; k; k = k->next->next) {
    const strut_tree *by = same_key(above, k);
    if (by ? is_removal(by->next) : is_replaced(above, k)) continue;
    strut_mapping_kind value = strut_kind_below(below->kind, k->text);
    bool fine = by ? append(b, marked_node(o, by), joined(o, value, k->next, by->next))
                   : append(b, copied(o->arena, k), copied(o->arena, k->next));
    if (!fine) return false;
  }
  for (const strut_tree *k = over->first; k; k = k->next->next) {
    if (same_key(below, k) || removes_nothing(o, base, k)) continue;
    if (!append(b, marked_node(o, k), strut_mark_tree(o, k->next))) return false;
  }
  return true;
}

strut_tree *strut_lay_over(const strut_overlay *o, strut_mapping_kind kind, const strut_tree *base,
                           const strut_tree *over) {
  strut_tree *map = copied(o->arena, base);
  if (!map) return NULL;
  builder b = {map, &map->first};
  key_index below = {0}, above = {0};
  map->count = 0;
  map->first = NULL;
  bool fine = index_keys(&below, kind, base) && index_keys(&above, kind, over) &&
              join(o, &below, base, &above, over, &b);
  free_index(&below);
  free_index(&above);
  return fine ? map : NULL;
}
