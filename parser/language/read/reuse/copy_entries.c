/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Entries of copies, which become those of the scene, and what is laid over them. See copies.h. */
#include <string.h>

#include "parser/language/read/reuse/copies.h"
#include "parser/language/read/reuse/overlay.h"

/* The keys of a part, or of `next`, whose entries are copied, and the scene's keys where they go. */
static int scene_key(int key) {
  const strut_key *k = strut_key_at(key);
  strut_section below = strut_section_below(k);
  bool groups = strcmp(k->name, strut_key_at(STRUT_KEY_SCENE_GROUPS)->name) == 0;
  if (k->type != STRUT_TYPE_THINGS || (k->field.role != STRUT_FIELD_THINGS && !groups)) return -1;
  if (below == STRUT_SECTION_PART || below == STRUT_SECTION_PLACE) return -1;
  return strut_key_find(STRUT_SECTION_SCENE, k->name);
}

static void append(strut_entry_list *list, strut_tree *key) {
  if (list->last)
    list->last->next = key;
  else
    list->first = key;
  list->last = key->next;
  list->count++;
}

void strut_remember_node(strut_expansion *expansion, const strut_tree *key) {
  struct strut_copies *copies = expansion->copies;
  strut_reader *reader = expansion->reader;
  if (!strut_grow(&copies->nodes, &copies->node_capacity, copies->node_count,
                  sizeof *copies->nodes)) {
    reader->out_of_memory = expansion->stopped = true;
    return;
  }
  copies->nodes[copies->node_count] = key;
  strut_add_name(reader, &copies->node_entries, key->text, copies->node_count++);
}

/* Copies the entries of a mapping: a name and a head of its own for each. */
static void copy_entries(strut_expansion *expansion, const strut_tree *map, strut_copy *scope,
                         int key) {
  strut_reader *reader = expansion->reader;
  bool contacts = key < 0, nodes = key == STRUT_KEY_SCENE_NODES;
  strut_entry_list *list = contacts
                               ? &expansion->contacts
                               : &expansion->list[key - strut_section_first(STRUT_SECTION_SCENE)];
  struct pair {
    strut_placed_tree key;
    strut_tree value;
  } *pairs = strut_scratch_array(reader, map->count, sizeof *pairs);
  if (!pairs) expansion->stopped = true;
  for (const strut_tree *from = map->first; from && !expansion->stopped; from = from->next->next) {
    struct pair *pair = pairs++;
    const char *name = strut_scratch_text(reader, "%s%s", scope->prefix, from->text);
    pair->key = (strut_placed_tree){*from, scope};
    pair->key.tree.placed = true;
    pair->key.tree.text = name;
    pair->value = *from->next;
    pair->key.tree.next = &pair->value;
    pair->value.next = NULL;
    append(list, &pair->key.tree);
    if (nodes) strut_remember_node(expansion, &pair->key.tree);
  }
  expansion->copies->things += map->count;
}

void strut_copy_things(strut_expansion *expansion, strut_fields *fields, strut_copy *scope) {
  int first = strut_section_first(fields->section);
  for (int k = 0; k < strut_section_size(fields->section) && !expansion->stopped; k++) {
    const strut_slot *slot = &fields->slot[k];
    if (slot->state != STRUT_GIVEN)
      continue;  // before the look by name: a part may have 1e6 copies
    int key = scene_key(first + k);
    bool contacts = first + k == STRUT_KEY_PART_CONTACTS;
    if (key >= 0 || contacts) copy_entries(expansion, slot->value, scope, contacts ? -1 : key);
  }
}

size_t strut_count_things(strut_fields *fields) {
  size_t count = 0;
  for (int k = 0; k < strut_section_size(fields->section); k++)
    if (fields->slot[k].state == STRUT_GIVEN &&
        scene_key(strut_section_first(fields->section) + k) >= 0)
      count += fields->slot[k].value->count;
  return count;
}

void strut_add_merger(strut_expansion *expansion, strut_copy *scope, const strut_tree *own,
                      strut_copy *beyond, const strut_tree *other, const strut_tree *place) {
  strut_merger *merger = strut_scratch_array(expansion->reader, 1, sizeof *merger);
  if (!merger) return;
  *merger = (strut_merger){.scope = scope, .a = own, .place = place};
  if (other) merger->b = (strut_placed_tree){*other, beyond};
  merger->b.tree.placed = true;
  if (!expansion->copies->mergers_end) expansion->copies->mergers_end = &expansion->copies->mergers;
  *expansion->copies->mergers_end = merger;
  expansion->copies->mergers_end = &merger->next;
}

void strut_read_merge(strut_expansion *expansion, const strut_tree *value, strut_copy *scope,
                      int key) {
  if (!value) return;
  expansion->reader->scope = scope; /* one message for all copies */
  if (value->kind == STRUT_TREE_SCALAR && strcmp(value->text, "touching") == 0)
    strut_add_merger(expansion, scope, NULL, NULL, NULL, value);
  else if (value->kind != STRUT_TREE_MAP)
    strut_refuse_form(
        expansion->reader, key, value,
        (strut_owner){scope ? "part" : "the scene", scope ? scope->placement->part->name : NULL});
  for (const strut_tree *tree = value->kind == STRUT_TREE_MAP ? value->first : NULL; tree;
       tree = tree->next->next)
    if (strut_read_scalar(expansion->reader, tree->next, tree->text, (strut_owner){"'merge'", NULL},
                          "the name of a node")) {
      bool link = scope && scope->kind == STRUT_SCOPE_LINK;
      strut_tree other = *tree->next;
      if (link) other.text = strut_twisted(scope, other.text);
      strut_add_merger(expansion, scope, tree, link ? scope->next : scope, &other, value);
    }
  expansion->reader->scope = NULL;
}

/* ---- what the scene says about single things of copies ---- */

strut_section strut_section_of_things(int scene_key) {
  const strut_mapping_kind scene = {STRUT_SECTION_SCENE, false};
  strut_mapping_kind kind = strut_kind_below(scene, strut_key_at(scene_key)->name);
  return kind.things ? kind.section : STRUT_SECTION_COUNT;
}

void strut_lay_over_placed(strut_reader *reader, strut_tree *value, const strut_tree *over,
                           strut_section section) {
  const strut_overlay overlay = {.arena = &reader->scratch, .of_scene = true, .whole = true};
  if (value->kind == STRUT_TREE_SCALAR) return;
  strut_tree *joined = strut_lay_over(&overlay, (strut_mapping_kind){section, false}, value, over);
  if (!joined) reader->out_of_memory = true;
  if (!joined) return;
  joined->next = value->next;
  *value = *joined;
}

/* Can the value be laid over a placed thing? If not, that is reported. */
static bool check_value(strut_reader *reader, const strut_tree *key, int of) {
  const strut_tree *value = key->next;
  if (value->kind == STRUT_TREE_MAP || strut_is_removal(value)) {
    strut_tree *at = of == STRUT_KEY_SCENE_NODES ? strut_tree_find(value, "position", NULL) : NULL;
    if (!at) return true;
    return strut_report_error(
        reader, at->place,
        "'%s' is placed, so its position is given by its part; give other keys here",
        strut_sanitised_text(reader, key->text));
  }
  return strut_report_error(
      reader, value->place,
      "'%s' is placed already; expected keys that it should have, or remove, found %s",
      strut_sanitised_text(reader, key->text), strut_found(reader, value));
}

/* The entries of copies by name. */
typedef struct placed_index {
  strut_name_map names;
  strut_tree **key;
  size_t count;
  bool *removed;
} placed_index;

static bool index_placed(strut_reader *reader, strut_tree *first, size_t count, placed_index *all) {
  all->key = strut_scratch_array(reader, count, sizeof *all->key);
  all->removed = strut_scratch_array(reader, count, sizeof *all->removed);
  for (strut_tree *tree = first; tree && all->key && all->removed; tree = tree->next->next) {
    strut_add_name(reader, &all->names, tree->text, all->count);
    all->key[all->count++] = tree;
  }
  return all->key && all->removed;
}

/* The placed entry of that full name, which may be that of a port, or -1. */
static int32_t find_placed(const strut_reader *reader, const placed_index *all, const char *name,
                           int key) {
  int32_t entry = strut_name_map_find(&all->names, name);
  if (entry >= 0 || key != STRUT_KEY_SCENE_NODES) return entry;
  int32_t node = strut_name_map_find(&reader->copies->node_entries, name);
  return node < 0 ? -1 : strut_name_map_find(&all->names, reader->copies->nodes[node]->text);
}

static bool is_of_placement(const strut_reader *reader, const char *name) {
  strut_full_name full;
  strcpy(full.text, name);
  for (char *dot = strchr(full.text, '.'); dot; dot = strchr(dot + 1, '.')) {
    *dot = '\0';
    if (strut_placement_find(reader, full.text)) return true;
    *dot = '.';
  }
  return false;
}

/* Does the entry lack what one that stands by itself needs? Then a placed thing was meant. */
static bool lacks_body(const strut_tree *own, int key) {
  const strut_tree *value = own->next;
  if (strut_is_removal(value)) return true;
  if (value->kind != STRUT_TREE_MAP) return false;
  if (key == STRUT_KEY_SCENE_NODES) return !strut_tree_find(value, "position", NULL);
  return key == STRUT_KEY_SCENE_MEMBERS && !strut_tree_find(value, "nodes", NULL);
}

/* Applies one entry of the scene to those of the copies. False: it names none of them. */
static bool apply(strut_reader *reader, const strut_tree *own, placed_index *all, int key) {
  strut_full_name full;
  bool pattern = strut_is_pattern(own), found = false, fine = true;
  if (!strut_name_resolve_last(reader, own->text, &full)) return false;
  int32_t single = pattern ? -1 : find_placed(reader, all, full.text, key);
  for (size_t i = pattern ? 0 : (size_t)(single < 0 ? (int32_t)all->count : single); i < all->count;
       i++) {
    if (pattern && !strut_name_matches(full.text, all->key[i]->text)) continue;
    if (!found) fine = check_value(reader, own, key);
    found = true;
    if (fine && strut_is_removal(own->next)) {
      all->removed[i] = true;
      strut_add_name(reader, &reader->copies->removed, all->key[i]->text, i);
    } else if (fine) {
      strut_lay_over_placed(reader, all->key[i]->next, own->next, strut_section_of_things(key));
    }
    if (!pattern) break;
  }
  if (!found && pattern)
    strut_report_error(reader, own->place, "nothing that is placed fits '%s'",
                       strut_sanitised_text(reader, own->text));
  bool lost = !found && !pattern && is_of_placement(reader, full.text) && lacks_body(own, key);
  if (lost)
    strut_report_error(reader, own->place, "nothing that is placed is called '%s'%s",
                       strut_sanitised_text(reader, own->text),
                       strut_copy_hint_of(reader, full.text));
  return found || pattern || lost;
}

static void unlink_removed(placed_index *all, strut_tree **placed, size_t *placed_count) {
  strut_tree **link = placed;
  *placed_count = 0;
  for (size_t i = 0; i < all->count; i++) {
    if (all->removed[i]) continue;
    *link = all->key[i];
    link = &all->key[i]->next->next;
    ++*placed_count;
  }
  *link = NULL;
}

/*
 * The scene's own entries of a key without those that name entries of copies, which are laid over these. A new chain;
 * *count: their number, and *placed_count: that of the copies' entries that stay.
 */
static strut_tree *lay_over_copies(strut_reader *reader, const strut_tree *own, strut_tree **placed,
                                   size_t *placed_count, uint32_t *count, int key) {
  strut_tree_builder rest = strut_tree_begin(&reader->scratch, own);
  placed_index all = {0};
  bool indexed = false;
  for (const strut_tree *tree = own->first; tree; tree = tree->next->next) {
    bool may = strpbrk(tree->text, ".*") != NULL;
    if (may && !indexed && !index_placed(reader, *placed, *placed_count, &all)) break;
    indexed = indexed || may;
    if (may && apply(reader, tree, &all, key)) continue;
    if (!strut_tree_share(&rest, &reader->scratch, tree, tree->next)) reader->out_of_memory = true;
  }
  *count = rest.map ? rest.map->count : 0;
  if (indexed) unlink_removed(&all, placed, placed_count);
  strut_name_map_free(&all.names);
  return rest.map ? rest.map->first : NULL;
}

/* The scene's own entries of a key, then those of the copies. */
void strut_join_entries(strut_expansion *expansion, int key) {
  strut_reader *reader = expansion->reader;
  strut_slot *slot = strut_slot_of(&reader->top, key);
  strut_entry_list *list = &expansion->list[key - strut_section_first(STRUT_SECTION_SCENE)];
  if (!list->count || slot->state == STRUT_BROKEN) return;
  strut_tree *map = strut_scratch_array(reader, 1, sizeof *map);
  const strut_slot *place = strut_slot_of(&reader->top, STRUT_KEY_SCENE_PLACE);
  if (!map) return;
  *map = slot->state == STRUT_GIVEN ? *slot->value : *place->value;
  uint32_t count = 0;
  strut_tree *first = NULL;
  if (slot->state == STRUT_GIVEN)
    first = lay_over_copies(reader, slot->value, &list->first, &list->count, &count, key);
  map->count = (count + (uint32_t)list->count) & STRUT_TREE_COUNT_MASK;
  map->first = first ? first : list->first;
  strut_tree *last = first;
  while (last && last->next->next) last = last->next->next;
  if (last) last->next->next = list->first;
  if (!slot->key) slot->key = place->key;
  slot->value = map;
  slot->state = STRUT_GIVEN;
}
