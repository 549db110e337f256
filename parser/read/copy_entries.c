/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Entries of copies, which become those of the scene. See expansion.h. */
#include <string.h>

#include "parser/read/expansion.h"

/* The keys of a part, or of `next`, whose entries are copied, and the scene's keys where they go. */
static int scene_key(int key) {
  const strut_key *k = strut_key_at(key);
  if (k->type != STRUT_TYPE_THINGS) return -1;
  int of_scene = strut_key_find(STRUT_SECTION_SCENE, k->name);
  bool own = of_scene == STRUT_KEY_SCENE_MERGE || of_scene == STRUT_KEY_SCENE_PARAMETERS ||
             of_scene == STRUT_KEY_SCENE_PARTS || of_scene == STRUT_KEY_SCENE_PLACE;
  return own ? -1 : of_scene;
}

static void append(strut_entry_list *list, strut_tree *key) {
  if (list->last)
    list->last->next = key;
  else
    list->first = key;
  list->last = key->next;
  list->count++;
}

void strut_remember_node(strut_expansion *e, const strut_tree *key) {
  struct strut_copies *c = e->copies;
  strut_reader *reader = e->reader;
  if (c->node_count == c->node_capacity) {
    size_t capacity = c->node_capacity ? 2 * c->node_capacity : 256;
    const strut_tree **nodes = strut_reallocate(c->nodes, capacity, sizeof *nodes);
    if (!nodes) {
      reader->out_of_memory = e->stopped = true;
      return;
    }
    c->nodes = nodes, c->node_capacity = capacity;
  }
  c->nodes[c->node_count] = key;
  strut_add_name(reader, &c->node_entries, key->text, c->node_count++);
}

/* Copies the entries of a mapping: a name and a head of its own for each. */
static void copy_entries(strut_expansion *e, const strut_tree *map, strut_copy *scope, int key) {
  strut_reader *reader = e->reader;
  bool contacts = key < 0, nodes = key == STRUT_KEY_SCENE_NODES;
  strut_entry_list *list =
      contacts ? &e->contacts : &e->list[key - strut_section_first(STRUT_SECTION_SCENE)];
  struct pair {
    strut_placed_tree key;
    strut_tree value;
  } *pairs = strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *pairs);
  if (!pairs) e->stopped = true;
  for (const strut_tree *from = map->first; from && !e->stopped; from = from->next->next) {
    struct pair *pair = pairs++;
    const char *name = strut_arena_format(&reader->scratch, "%s%s", scope->prefix, from->text);
    if (!name) reader->out_of_memory = e->stopped = true;
    pair->key = (strut_placed_tree){*from, scope};
    pair->key.tree.placed = true;
    pair->key.tree.text = name;
    pair->value = *from->next;
    pair->key.tree.next = &pair->value;
    pair->value.next = NULL;
    if (e->stopped) return;
    append(list, &pair->key.tree);
    if (nodes) strut_remember_node(e, &pair->key.tree);
  }
  e->copies->things += map->count;
}

/* All that a part, or `next`, holds. */
void strut_copy_things(strut_expansion *e, strut_fields *fields, strut_copy *scope) {
  int first = strut_section_first(fields->section);
  for (int k = 0; k < strut_section_size(fields->section) && !e->stopped; k++) {
    const strut_slot *slot = &fields->slot[k];
    if (slot->state != STRUT_GIVEN)
      continue;  // before the look by name: a part may have 1e6 copies
    int key = scene_key(first + k);
    bool contacts = first + k == STRUT_KEY_PART_CONTACTS;
    if (key >= 0 || contacts) copy_entries(e, slot->value, scope, contacts ? -1 : key);
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

void strut_add_merger(strut_expansion *e, strut_copy *scope, const strut_tree *a,
                      const strut_tree *b, const strut_tree *place) {
  strut_merger *m = strut_reader_allocate(e->reader, &e->reader->scratch, 1, sizeof *m);
  if (!m) return;
  *m = (strut_merger){.scope = scope, .a = a, .b = b, .place = place};
  if (!e->copies->mergers_end) e->copies->mergers_end = &e->copies->mergers;
  *e->copies->mergers_end = m;
  e->copies->mergers_end = &m->next;
}

/* `touching`, or a mapping of names. */
void strut_read_merge(strut_expansion *e, const strut_slot *slot, strut_copy *scope, int key) {
  const strut_tree *value = slot->value;
  if (slot->state != STRUT_GIVEN || e->weighing) return;
  e->reader->scope = scope; /* one message for all copies */
  if (value->kind == STRUT_TREE_SCALAR && strcmp(value->text, "touching") == 0)
    strut_add_merger(e, scope, NULL, NULL, value);
  else if (value->kind != STRUT_TREE_MAP)
    strut_refuse_form(
        e->reader, key, value,
        (strut_owner){scope ? "part" : "the scene", scope ? scope->placement->part->name : NULL});
  for (const strut_tree *k = value->kind == STRUT_TREE_MAP ? value->first : NULL; k;
       k = k->next->next)
    if (strut_read_scalar(e->reader, k->next, k->text, (strut_owner){"'merge'", NULL},
                          "the name of a node"))
      strut_add_merger(e, scope, k, k->next, value);
  e->reader->scope = NULL;
}

/* The scene's own entries of a key, then those of the copies. */
void strut_join_entries(strut_expansion *e, int key) {
  strut_reader *reader = e->reader;
  strut_slot *slot = strut_slot_of(&reader->top, key);
  strut_entry_list *list = &e->list[key - strut_section_first(STRUT_SECTION_SCENE)];
  if (!list->count || slot->state == STRUT_BROKEN) return;
  strut_tree *map = strut_reader_allocate(reader, &reader->scratch, 1, sizeof *map);
  const strut_slot *place = strut_slot_of(&reader->top, STRUT_KEY_SCENE_PLACE);
  if (!map) return;
  *map = slot->state == STRUT_GIVEN ? *slot->value : *place->value;
  uint32_t count = 0;
  strut_tree *first = NULL;
  if (slot->state == STRUT_GIVEN)
    first = strut_lay_over_copies(reader, slot->value, &list->first, &list->count, &count, key);
  map->count = (count + (uint32_t)list->count) & STRUT_TREE_COUNT_MASK;
  map->first = first ? first : list->first;
  strut_tree *last = first;
  while (last && last->next->next) last = last->next->next;
  if (last) last->next->next = list->first;
  if (!slot->key) slot->key = place->key;
  slot->value = map;
  slot->state = STRUT_GIVEN;
}
