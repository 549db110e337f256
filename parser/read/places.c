/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The place in the text of each finding of the scene's check. See reader.h. */
#include <string.h>

#include "parser/read/reader.h"

/* The item of a thing's groups that gives `key`; the later group wins. */
static strut_group_item *group_item(strut_reader *reader, const strut_tree *map, const char *key) {
  strut_tree *named = strut_tree_find(map, "group", NULL);
  strut_group *groups[STRUT_MOST_GROUPS];
  size_t count = named ? strut_groups_named(reader, named, groups) : 0;
  while (count > 0) {
    const strut_group *group = groups[--count];
    for (size_t i = 0; i < group->count; i++)
      if (strcmp(group->items[i].slot.key->text, key) == 0) return &group->items[i];
  }
  return NULL;
}

/* The value of the thing's own key, else of its group's, else the thing's name. False: the group's
   value has a finding already. */
static bool thing_place(strut_reader *reader, const strut_source *source, const char *key,
                        strut_place *place) {
  const strut_tree *value = strut_expand_value(reader, source->value);
  bool map = value->kind == STRUT_TREE_MAP;
  strut_enter_scope(reader, source->key);
  const strut_tree *own = key && map ? strut_tree_find(value, key, NULL) : NULL;
  strut_group_item *item = key && map && !own ? group_item(reader, value, key) : NULL;
  *place = own ? own->place : item ? item->slot.value->place : source->key->place;
  if (!item) return true;
  bool first = !item->found;
  item->found = true;
  return first;
}

/* The value of a key of the ground, the solver, ..., else the key of the whole section. */
static strut_place field_place(strut_reader *reader, strut_fields *fields, const char *key,
                               int section) {
  int found = key ? strut_key_find(fields->section, key) : -1;
  const strut_slot *slot = found < 0 ? NULL : strut_slot_of(fields, found);
  if (slot && slot->value) return slot->value->place;
  const strut_tree *whole = strut_slot_of(&reader->top, section)->key;
  return whole ? whole->place : strut_root_place(reader);
}

static bool node_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_source *source = &reader->things[STRUT_THING_NODE].source[finding->index];
  bool mass = finding->key && strcmp(finding->key, "mass") == 0;
  bool velocity = finding->key && strcmp(finding->key, "velocity") == 0;
  if ((mass || !finding->key) && reader->ends_unknown) return false;
  if (mass && reader->masses_unknown) return false;
  if (!velocity) return thing_place(reader, source, finding->key, place);
  const strut_tree *own = reader->velocity_source ? reader->velocity_source[finding->index] : NULL;
  *place = own ? own->place : source->key->place;
  return true;
}

/* The value of a ground's own key, else its name. */
static strut_place ground_place(strut_reader *reader, size_t ground, const char *key) {
  if (!reader->things[STRUT_THING_GROUND].source)
    return field_place(reader, &reader->ground, key, STRUT_KEY_SCENE_GROUND);
  int found = key ? strut_key_find(STRUT_SECTION_GROUND, key) : -1;
  const strut_slot *slot = found < 0 ? NULL : strut_slot_of(&reader->grounds[ground], found);
  return slot && slot->value ? slot->value->place
                             : reader->things[STRUT_THING_GROUND].source[ground].key->place;
}

/* The contact's own key, its group's, the ground's, or the name of the contact. */
static bool contact_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_source *source = &reader->things[STRUT_THING_CONTACT].source[finding->index];
  int32_t g = reader->scene->contacts[finding->index].ground;
  *place = ground_place(reader, (size_t)g, finding->key);
  if (!source->key) return true;
  strut_place before = *place, mine;
  bool fresh = thing_place(reader, source, finding->key, &mine);
  bool ground = mine.line == source->key->place.line && mine.column == source->key->place.column &&
                finding->key && strut_key_find(STRUT_SECTION_GROUND, finding->key) >= 0;
  *place = ground ? before : mine;
  return fresh;
}

static bool signal_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_tree *value = reader->signal_state[finding->index].value;
  const strut_tree *own = finding->key && value->kind == STRUT_TREE_MAP
                              ? strut_tree_find(value, finding->key, NULL)
                              : NULL;
  *place = own ? own->place : value->place;
  return true;
}

/* Findings about things of a scene. */
static bool many_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_source *source = &reader->things[finding->subject].source[finding->index];
  if (source->broken) return false;
  bool of_ground =
      finding->subject == STRUT_ON_CONFIGURATION || finding->subject == STRUT_ON_SENSOR;
  if (of_ground && reader->ground.broken) return false;
  if (finding->subject == STRUT_ON_NODE) return node_place(reader, finding, place);
  if (finding->subject == STRUT_ON_CONTACT) return contact_place(reader, finding, place);
  return thing_place(reader, source, finding->key, place);
}

/* Findings about the ground, the initial state, the solver and other single mappings. */
static bool single_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const struct {
    strut_fields *fields;
    int section;
    bool broken; /* what it depends on, too */
  } mappings[] = {
      [STRUT_ON_GROUND] = {&reader->ground, STRUT_KEY_SCENE_GROUND, false},
      [STRUT_ON_SCENE] = {&reader->top, STRUT_KEY_SCENE_NODES, false},
      [STRUT_ON_INITIAL] = {&reader->settle, STRUT_KEY_SCENE_INITIAL, false},
      [STRUT_ON_EQUILIBRIA] = {&reader->search, STRUT_KEY_SCENE_EQUILIBRIA, reader->ground.broken},
      [STRUT_ON_SOLVER] = {&reader->solver, STRUT_KEY_SCENE_SOLVER, false},
      [STRUT_ON_RUN] = {&reader->run, STRUT_KEY_SCENE_RUN, reader->run.broken},
      [STRUT_ON_OUTPUT] = {&reader->output, STRUT_KEY_SCENE_OUTPUT, reader->run.broken}};
  const char *key = finding->key;
  strut_subject subject = finding->subject;
  strut_fields *fields = mappings[subject].fields;
  int section = mappings[subject].section;
  bool measured = key && (strcmp(key, "last") == 0 || strcmp(key, "node") == 0);
  if (subject == STRUT_ON_RUN && measured) fields = &reader->measure;
  bool broken = fields->broken || mappings[subject].broken;
  if (subject == STRUT_ON_GROUND && reader->things[STRUT_THING_GROUND].source) {
    *place = ground_place(reader, finding->index, key);
    return !reader->grounds[finding->index].broken;
  }
  if (subject == STRUT_ON_GROUND && key && strcmp(key, "slope") == 0 &&
      strut_slot_of(fields, STRUT_KEY_GROUND_SLOPE)->state == STRUT_GIVEN)
    broken = false; /* it does not depend on other keys */
  if (subject == STRUT_ON_SCENE) {
    int found = key ? strut_key_find(STRUT_SECTION_SCENE, key) : -1;
    broken = found >= 0 && strut_slot_of(fields, found)->state == STRUT_BROKEN;
  }
  if (!broken) *place = field_place(reader, fields, key, section);
  return !broken;
}

void strut_place_findings(strut_reader *reader, const strut_findings *findings) {
  for (size_t i = 0; i < findings->count; i++) {
    const strut_finding *finding = &findings->items[i];
    strut_place place;
    bool many = strut_subject_is_thing(finding->subject) && finding->subject != STRUT_ON_GROUND;
    bool fresh = finding->subject == STRUT_ON_SIGNAL ? signal_place(reader, finding, &place)
                 : many                              ? many_place(reader, finding, &place)
                                                     : single_place(reader, finding, &place);
    if (fresh) strut_report_error(reader, place, "%s", finding->message);
    reader->scope = NULL;
  }
  /* A finding is left out where its cause was reported; never is a scene with one accepted. */
  if (findings->count && !reader->diagnostics->count)
    strut_report_error(reader, strut_root_place(reader), "%s", findings->items[0].message);
}
