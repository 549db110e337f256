/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named shapes, the one in which a run starts, and the search for equilibria.
   See reader.h. */
#include <math.h>
#include <string.h>

#include "parser/read/copies.h"
#include "parser/read/reader.h"

/* Most positions that all configurations may have together, to bound the memory. */
enum { MOST_POSITIONS = 20000000 };

static const strut_owner search_owner = {"the search for equilibria", NULL};

static bool nodes_known(strut_reader *reader) {
  return strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN;
}

/* The configuration that is being read, which is the last one. */
static void take_position(strut_reader *reader, int32_t node, const double pair[2],
                          const strut_tree *value) {
  strut_scene *scene = reader->scene;
  (void)value;
  memcpy(scene->configurations[scene->configuration_count - 1].position[node], pair,
         2 * sizeof *pair);
}

/* One list of nodes; unknown ones are reported and left out. */
static bool read_set(strut_reader *reader, const strut_tree *list, const char *key,
                     strut_owner owner, strut_node_set *set) {
  bool fine = true;
  size_t most = list->count;
  for (const strut_tree *item = list->first; item; item = item->next)
    for (int32_t n = -1; strut_is_pattern(item) && (n = strut_next_match(reader, item, n)) >= 0;)
      most++;
  set->node = strut_reader_allocate(reader, &reader->scene->arena, most, sizeof *set->node);
  if (!set->node) return false;
  for (const strut_tree *item = list->first; item; item = item->next) {
    if (strut_is_pattern(item) && strut_next_match(reader, item, -1) >= 0) {
      for (int32_t n = -1; (n = strut_next_match(reader, item, n)) >= 0;)
        set->node[set->count++] = n;
      continue;
    }
    int32_t node = strut_read_reference(reader, item, key, owner, STRUT_THING_NODE);
    if (node >= 0)
      set->node[set->count++] = node;
    else
      fine = false;
  }
  return fine;
}

/* `[n1, n4]`, or a list of such lists. */
static bool read_sets(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                      strut_node_set **sets, size_t *count) {
  const strut_tree *list = slot->value;
  const char *key = slot->key->text;
  size_t lists = 0, alternatives;
  bool fine = true;
  for (const strut_tree *item = list->first; item; item = item->next)
    if (item->kind == STRUT_TREE_LIST) lists++;
  if (!list->count || (lists && lists != list->count)) {
    strut_report_error(
        reader, list->place,
        "expected nodes such as [n1, n2], or a list of such lists, for '%s' of %s, found %s", key,
        strut_owner_text(reader, owner), lists ? "a list of both" : strut_found(reader, list));
    return false;
  }
  if (!nodes_known(reader)) return false;
  alternatives = lists ? lists : 1;
  *sets = strut_reader_allocate(reader, &reader->scene->arena, alternatives, sizeof **sets);
  if (!*sets) return false;
  *count = alternatives;
  if (!lists) return read_set(reader, list, key, owner, *sets);
  const strut_tree *item = list->first;
  for (size_t i = 0; i < alternatives; i++, item = item->next)
    fine = read_set(reader, item, key, owner, &(*sets)[i]) && fine;
  return fine;
}

/*
 * Is this a key of a configuration rather than a node of that name? If there is such a node, a list of
 * two scalars for `contacts` is its position, and so is anything but a mapping for `shape`.
 */
static bool is_key(strut_reader *reader, const strut_tree *key) {
  const strut_tree *value = key->next;
  if (strut_key_find(STRUT_SECTION_CONFIGURATION, key->text) < 0) return false;
  if (strut_find_thing(reader, STRUT_THING_NODE, NULL, key->text) < 0) return true;
  if (strcmp(key->text, strut_key_at(STRUT_KEY_CONFIGURATION_SHAPE)->name) == 0)
    return value->kind == STRUT_TREE_MAP;
  return value->kind == STRUT_TREE_LIST && value->count &&
         !(value->count == 2 && value->first->kind == STRUT_TREE_SCALAR &&
           value->first->next->kind == STRUT_TREE_SCALAR);
}

/* Reports nodes beside `contacts` or `shape`; true if there are none. */
static bool keys_only(strut_reader *reader, const strut_tree *map, strut_owner owner) {
  bool fine = true;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    if (is_key(reader, key) || strut_find_thing(reader, STRUT_THING_NODE, NULL, key->text) < 0)
      continue;
    strut_report_error(
        reader, key->place,
        "node '%s' of %s belongs in its 'shape', as in {contacts: [...], shape: {%s: ...}}",
        strut_sanitised_text(reader, key->text), strut_owner_text(reader, owner),
        strut_sanitised_text(reader, key->text));
    fine = false;
  }
  return fine;
}

/* `{contacts: ..., shape: ...}` */
static bool read_keys(strut_reader *reader, const strut_tree *map, strut_owner owner,
                      strut_configuration *configuration) {
  strut_fields fields;
  if (!keys_only(reader, map, owner)) return false;
  strut_read_fields(reader, STRUT_SECTION_CONFIGURATION, map, owner, &fields);
  const strut_slot *contacts = strut_slot_of(&fields, STRUT_KEY_CONFIGURATION_CONTACTS);
  const strut_slot *shape = strut_slot_of(&fields, STRUT_KEY_CONFIGURATION_SHAPE);
  bool fine = !fields.broken;
  if (contacts->state == STRUT_GIVEN)
    fine =
        read_sets(reader, contacts, owner, &configuration->sets, &configuration->set_count) && fine;
  configuration->shaped = shape->state == STRUT_GIVEN;
  if (configuration->shaped)
    fine =
        strut_read_node_pairs(reader, shape->value, owner, STRUT_DIM_LENGTH, take_position) && fine;
  return fine;
}

bool strut_read_configuration(strut_reader *reader, const strut_tree *key, void *object) {
  strut_configuration *configuration = object;
  const strut_scene *scene = reader->scene;
  strut_owner owner = {"configuration", key->text};
  const strut_tree *value = key->next;
  bool keys = false;
  configuration->position = strut_reader_allocate(reader, &reader->scene->arena, scene->node_count,
                                                  sizeof *configuration->position);
  if (!configuration->position) return false;
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(configuration->position[i], scene->nodes[i].position, sizeof *configuration->position);
  if (value->kind != STRUT_TREE_MAP) {
    strut_report_error(reader, value->place,
                       "expected positions such as {n1: [10 mm, 0]} for %s, found %s",
                       strut_owner_text(reader, owner), strut_found(reader, value));
    return false;
  }
  for (const strut_tree *k = value->first; k; k = k->next->next) keys |= is_key(reader, k);
  if (keys) return read_keys(reader, value, owner, configuration);
  configuration->shaped = true; /* `{}` is the drawn shape */
  return strut_read_node_pairs(reader, value, owner, STRUT_DIM_LENGTH, take_position);
}

void strut_read_configurations(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_CONFIGURATIONS);
  size_t nodes = reader->scene->node_count;
  if (!map) return;
  if (map->count <= MOST_POSITIONS / (nodes + 1)) {
    strut_read_things(reader, STRUT_THING_CONFIGURATION);
    return;
  }
  strut_report_error(reader, map->place,
                     "%u configurations of %zu nodes are more than %d positions",
                     (unsigned)map->count, nodes, (int)MOST_POSITIONS);
}

int32_t strut_find_configuration(strut_reader *reader, int key) {
  const strut_slot *slot = strut_slot_of(&reader->initial, key);
  strut_owner owner = {"the initial state", NULL};
  if (slot->state != STRUT_GIVEN) return -1;
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_CONFIGURATIONS)->state == STRUT_BROKEN) return -1;
  strut_parameter_state *p = strut_parameter_find(reader, slot->value->text);
  int32_t direct = strut_find_thing(reader, STRUT_THING_CONFIGURATION, NULL, slot->value->text);
  if (!p || !p->text)
    return strut_read_reference(reader, slot->value, slot->key->text, owner,
                                STRUT_THING_CONFIGURATION);
  if (direct >= 0) {
    strut_report_error(reader, slot->value->place,
                       "'%s' is both a configuration and a text parameter; rename one of them",
                       p->name);
    return -1;
  }
  p->used = true;
  const char *text = p->set ? p->set->text : p->value->text;
  int32_t index = strut_find_thing(reader, STRUT_THING_CONFIGURATION, NULL, text);
  strut_place place = !p->set              ? p->value->place
                      : p->set->place.line ? p->set->place
                                           : p->key->place;
  if (index < 0)
    strut_report_error(reader, place, "unknown configuration '%s' in parameter '%s'%s",
                       strut_sanitised_text(reader, text), p->name,
                       strut_hint_of_things(reader, text, STRUT_THING_CONFIGURATION));
  return index;
}

void strut_read_search(strut_reader *reader) {
  strut_search *search = &reader->experiment->search;
  if (!strut_read_section(reader, STRUT_KEY_SCENE_EQUILIBRIA, STRUT_SECTION_EQUILIBRIA,
                          search_owner.kind, &reader->search))
    return;
  strut_store_fields(reader, &reader->search, search_owner, &reader->scene->arena, search,
                     sizeof *search);
  const strut_slot *supports = strut_slot_of(&reader->search, STRUT_KEY_EQUILIBRIA_SUPPORTS);
  if (supports->state == STRUT_GIVEN &&
      !read_sets(reader, supports, search_owner, &search->supports, &search->support_count))
    reader->search.broken = true;
}
