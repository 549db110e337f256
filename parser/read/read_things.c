/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All things of a scene, kind by kind. See reader.h. */
#include <assert.h>
#include <string.h>

#include "parser/read/reader.h"

/* How a kind is read, beside the rows of its section. */
typedef struct kind {
  int key;               /* of the scene */
  strut_section section; /* of its things; not used with `read` */
  int group;             /* the key that names groups, or -1 */
  bool joins;    /* it uses nodes: where it names unknown ones, others are not reported as unused */
  bool heavy;    /* it may have mass */
  bool variable; /* expressions use its name */
  strut_thing_reader *read;
} kind;

static const kind kinds[STRUT_THING_COUNT] = {
    [STRUT_THING_NODE] = {STRUT_KEY_SCENE_NODES, .read = strut_read_node},
    [STRUT_THING_MEMBER] = {STRUT_KEY_SCENE_MEMBERS, STRUT_SECTION_MEMBER, STRUT_KEY_MEMBER_GROUP,
                            .joins = true},
    [STRUT_THING_HINGE] = {STRUT_KEY_SCENE_HINGES, STRUT_SECTION_HINGE, STRUT_KEY_HINGE_GROUP,
                           .joins = true},
    [STRUT_THING_CELL] = {STRUT_KEY_SCENE_CELLS, STRUT_SECTION_CELL, -1, .joins = true},
    [STRUT_THING_COLLISION] = {STRUT_KEY_SCENE_COLLISIONS, STRUT_SECTION_COLLISION, -1,
                               .joins = true},
    [STRUT_THING_ACTUATOR] = {STRUT_KEY_SCENE_ACTUATORS, STRUT_SECTION_ACTUATOR, -1},
    [STRUT_THING_LOAD] = {STRUT_KEY_SCENE_LOADS, STRUT_SECTION_LOAD, -1, .joins = true},
    [STRUT_THING_UNBALANCE] = {STRUT_KEY_SCENE_UNBALANCES, STRUT_SECTION_UNBALANCE, -1,
                               .joins = true, .heavy = true},
    [STRUT_THING_SLIDER] = {STRUT_KEY_SCENE_SLIDERS, STRUT_SECTION_SLIDER, -1},
    [STRUT_THING_SIGNAL] = {STRUT_KEY_SCENE_SIGNALS},
    [STRUT_THING_SENSOR] = {STRUT_KEY_SCENE_SENSORS, STRUT_SECTION_SENSOR, -1, .variable = true},
    [STRUT_THING_STATE] = {STRUT_KEY_SCENE_STATES},
    [STRUT_THING_CONFIGURATION] = {STRUT_KEY_SCENE_CONFIGURATIONS,
                                   .read = strut_read_configuration},
    [STRUT_THING_GROUND] = {STRUT_KEY_SCENE_GROUNDS},
    [STRUT_THING_CONTACT] = {STRUT_KEY_SCENE_GROUND}};

int strut_key_of_things(strut_thing thing) { return kinds[thing].key; }

/* ---- names ---- */

typedef struct things_context {
  const strut_scene *scene;
  strut_thing kind;
} things_context;

static const char *thing_name(const void *context, size_t i) {
  const things_context *things = context;
  return strut_thing_name(things->scene, things->kind, i);
}

const char *strut_hint_of_things(strut_reader *reader, const char *word, strut_thing thing) {
  const things_context context = {reader->scene, thing};
  return strut_hint(reader, word, thing_name, &context, strut_thing_count(reader->scene, thing));
}

int32_t strut_read_reference(strut_reader *reader, const strut_tree *value, const char *key,
                             strut_owner owner, strut_thing thing) {
  const things_context context = {reader->scene, thing};
  const strut_namespace names = {strut_thing_at(thing)->word, &reader->things[thing].names,
                                 thing_name, &context, strut_thing_count(reader->scene, thing)};
  if (strut_slot_of(&reader->top, kinds[thing].key)->state == STRUT_BROKEN) return -1;
  return strut_read_name_of(reader, value, key, owner, &names);
}

/* ---- things ---- */

static bool read_thing(strut_reader *reader, strut_thing thing, const strut_tree *key,
                       const char *name, void *object) {
  const kind *k = &kinds[thing];
  const strut_thing_row *row = strut_thing_at(thing);
  strut_owner owner = {row->word, name};
  strut_fields fields;
  bool fine = k->variable ? strut_check_variable_name(reader, key, row->word)
                          : strut_read_name(reader, key, row->word);
  if (k->read) return k->read(reader, key, object) && fine;
  strut_read_fields_of(reader, k->section, key, owner, &fields);
  if (k->group >= 0) strut_apply_groups(reader, &fields, k->group, owner);
  strut_require(reader, &fields, owner, key->place);
  fine = strut_store_fields(reader, &fields, owner, &reader->scene->arena, object, row->size) &&
         fine && !fields.broken;
  if (fields.unresolved && k->joins) reader->ends_unknown = true;
  if (!fine && k->heavy) reader->masses_unknown = true;
  return fine && !fields.unresolved;
}

void strut_read_things(strut_reader *reader, strut_thing thing) {
  const kind *k = &kinds[thing];
  const strut_thing_row *row = strut_thing_at(thing);
  strut_things_read *things = &reader->things[thing];
  strut_scene *scene = reader->scene;
  size_t *count = (size_t *)(void *)((char *)scene + row->count);
  const strut_tree *map = strut_entries(reader, k->key);
  bool broken = strut_slot_of(&reader->top, k->key)->state == STRUT_BROKEN;
  if (broken && k->joins) reader->ends_unknown = true;
  if (broken && k->heavy) reader->masses_unknown = true;
  if (!map) return;
  char *array = strut_reader_allocate(reader, &scene->arena, map->count, row->size);
  things->source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *things->source);
  memcpy((char *)scene + row->array, &array, sizeof array);
  if (!array || !things->source) return;
  strut_reserve_names(reader, &things->names, map->count);
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, count);
    char *object = array + i * row->size;
    const char *name = strut_keep_text(reader, key->text);
    memcpy(object, row->usual, row->size);
    memcpy(object + row->name, &name, sizeof name);
    strut_add_name(reader, &things->names, name, i);
    bool fine = read_thing(reader, thing, key, name, object);
    things->source[i] = (strut_source){key, key->next, !fine};
  }
}
