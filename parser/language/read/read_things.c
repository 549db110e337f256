/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All things of a scene, kind by kind, by the rows of their keys. See reader.h. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/programs.h"
#include "parser/language/read/reuse/copies.h"

/* How a kind is read, beside the rows of its section. */
typedef struct kind {
  int key;               /* of the scene */
  strut_section section; /* of its things; not used with `read` */
  int group;             /* the key that names groups, or -1 */
  bool joins;    /* it uses nodes: where it names unknown ones, others are not reported as unused */
  bool chooses;  /* and says which in several ways, so that it may be a fault of any of its keys */
  bool heavy;    /* it may have mass */
  bool variable; /* expressions use its name */
  strut_thing_reader *read;
} kind;

static const kind kinds[STRUT_THING_COUNT] = {
    [STRUT_THING_NODE] = {STRUT_KEY_SCENE_NODES, .read = strut_read_node},
    [STRUT_THING_MEMBER] = {STRUT_KEY_SCENE_MEMBERS, STRUT_SECTION_MEMBER, STRUT_KEY_MEMBER_GROUP,
                            .joins = true},
    [STRUT_THING_HINGE] = {STRUT_KEY_SCENE_HINGES, STRUT_SECTION_HINGE, STRUT_KEY_HINGE_GROUP,
                           .joins = true, .chooses = true},
    [STRUT_THING_CELL] = {STRUT_KEY_SCENE_CELLS, STRUT_SECTION_CELL, -1, .joins = true},
    [STRUT_THING_COLLISION] = {STRUT_KEY_SCENE_COLLISIONS, STRUT_SECTION_COLLISION, -1,
                               .joins = true, .chooses = true},
    [STRUT_THING_DISTANCE] = {STRUT_KEY_SCENE_DISTANCES, STRUT_SECTION_DISTANCE, -1, .joins = true,
                              .chooses = true},
    [STRUT_THING_FOOT] = {STRUT_KEY_SCENE_FEET, STRUT_SECTION_FOOT, -1},
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
  return strut_hint(reader, word, thing_name, &context);
}

int32_t strut_read_reference(strut_reader *reader, const strut_tree *value, const char *key,
                             strut_owner owner, strut_thing thing) {
  const things_context context = {reader->scene, thing};
  const strut_namespace names = {strut_thing_at(thing)->word, &reader->things[thing].names,
                                 thing_name, &context};
  if (strut_slot_of(&reader->top, kinds[thing].key)->state == STRUT_BROKEN) return -1;
  return strut_read_name_of(reader, value, key, owner, &names);
}

/* ---- things ---- */

static bool read_thing(strut_reader *reader, strut_thing thing, const strut_tree *key,
                       const char *name, void *object) {
  const kind *self = &kinds[thing];
  const strut_thing_row *row = strut_thing_at(thing);
  strut_owner owner = {row->word, name};
  strut_fields fields;
  bool fine = self->variable ? strut_check_variable_name(reader, key, row->word)
                             : strut_read_name(reader, key, row->word);
  if (self->read) return self->read(reader, key, object) && fine;
  strut_read_fields_of(reader, self->section, key, owner, &fields);
  if (self->group >= 0) strut_apply_groups(reader, &fields, self->group);
  strut_require(reader, &fields, key->place);
  fine = strut_store_fields(reader, &fields, object, row->size) && fine && !fields.broken;
  if (self->chooses && fields.broken) fields.unresolved = true;
  if (fields.unresolved && self->joins) reader->ends_unknown = true;
  if (!fine && self->heavy) reader->masses_unknown = true;
  return fine && !fields.unresolved;
}

bool strut_reserve_things(strut_reader *reader, strut_thing thing, size_t more) {
  const strut_thing_row *row = strut_thing_at(thing);
  strut_things_read *things = &reader->things[thing];
  char *at = (char *)reader->scene + row->array, *before;
  size_t count = strut_thing_count(reader->scene, thing);
  char *array = strut_keep_array(reader, count + more, row->size);
  strut_source *source = strut_scratch_array(reader, count + more, sizeof *source);
  if (!array || !source) return false;
  memcpy(&before, at, sizeof before);
  if (count) memcpy(array, before, count * row->size);
  if (count) memcpy(source, things->source, count * sizeof *source);
  memcpy(at, &array, sizeof array);
  things->source = source;
  return true;
}

void *strut_add_thing(strut_reader *reader, strut_thing thing, const strut_tree *key,
                      const char *name) {
  const strut_thing_row *row = strut_thing_at(thing);
  char *array, *scene = (char *)reader->scene;
  size_t i = strut_next_entry(reader, (size_t *)(void *)(scene + row->count));
  memcpy(&array, scene + row->array, sizeof array);
  char *object = array + i * row->size;
  memcpy(object, row->usual, row->size);
  memcpy(object + row->name, &name, sizeof name);
  strut_add_name(reader, &reader->things[thing].names, name, i);
  reader->things[thing].source[i] = (strut_source){key, key->next, false};
  return object;
}

void strut_read_things(strut_reader *reader, strut_thing thing) {
  const kind *self = &kinds[thing];
  strut_things_read *things = &reader->things[thing];
  const strut_tree *map = strut_entries(reader, self->key);
  bool broken = strut_slot_of(&reader->top, self->key)->state == STRUT_BROKEN;
  if (broken && self->joins) reader->ends_unknown = true;
  if (broken && self->heavy) reader->masses_unknown = true;
  bool of_pipes = thing == STRUT_THING_SENSOR || thing == STRUT_THING_ACTUATOR;
  size_t most = (map ? map->count : 0) + (of_pipes ? strut_pipes_most(reader) : 0);
  if (!most || !strut_reserve_things(reader, thing, most) || !map) return;
  strut_reserve_names(reader, &things->names, map->count);
  STRUT_ENTRIES (reader, key, map) {
    const char *name = strut_keep_text(reader, key->text);
    size_t i = strut_thing_count(reader->scene, thing);
    void *object = strut_add_thing(reader, thing, key, name);
    things->source[i].broken = !read_thing(reader, thing, key, name, object);
  }
}

/* ---- the values of a mapping into an object ---- */

/* The code that a section has beside its rows. */
static strut_section_reader *const by_hand[STRUT_SECTION_COUNT] = {
    [STRUT_SECTION_MEMBER] = strut_read_member,
    [STRUT_SECTION_HINGE] = strut_read_hinge,
    [STRUT_SECTION_CELL] = strut_read_cell,
    [STRUT_SECTION_DISTANCE] = strut_read_distance,
    [STRUT_SECTION_ACTUATOR] = strut_read_actuator,
    [STRUT_SECTION_LOAD] = strut_read_load,
    [STRUT_SECTION_UNBALANCE] = strut_read_unbalance,
    [STRUT_SECTION_SLIDER] = strut_read_slider,
    [STRUT_SECTION_SENSOR] = strut_read_sensor,
    [STRUT_SECTION_STARTS] = strut_read_trigger};

/* ---- single values ---- */

static const char *store_text(strut_reader *reader, const strut_key *key, const strut_slot *slot) {
  char word[40] = "";
  if (key->type == STRUT_TYPE_WORD) strut_word_at(key->words, slot->word, word, sizeof word);
  return strut_keep_text(reader, key->type == STRUT_TYPE_WORD ? word : slot->value->text);
}

static void store_value(strut_reader *reader, const strut_key *key, const strut_slot *slot,
                        void *field) {
  bool word = key->type == STRUT_TYPE_WORD, words = key->type == STRUT_TYPE_WORDS;
  double number = word ? (double)key->field.first + slot->word : slot->number[0];
  if (key->field.turns) number /= STRUT_TAU;
  switch (key->field.type) {
    case STRUT_FIELD_DOUBLE: *(double *)field = number; break;
    case STRUT_FIELD_INT32: *(int32_t *)field = (int32_t)number; break;
    case STRUT_FIELD_UINT32: *(uint32_t *)field = (uint32_t)number; break;
    case STRUT_FIELD_INT64: *(int64_t *)field = (int64_t)number; break;
    case STRUT_FIELD_UINT64: *(uint64_t *)field = words ? slot->words : (uint64_t)number; break;
    case STRUT_FIELD_BOOL: *(bool *)field = slot->word == 1; break;
    case STRUT_FIELD_DOUBLE_PAIR: memcpy(field, slot->number, sizeof slot->number); break;
    case STRUT_FIELD_BOOL_PAIR:
      for (int c = 0; c < 2; c++) ((bool *)field)[c] = (slot->word >> c & 1) != 0;
      break;
    case STRUT_FIELD_TEXT: *(const char **)field = store_text(reader, key, slot); break;
    case STRUT_FIELD_INSTRUCTION:
    case STRUT_FIELD_NODE_SET:
    case STRUT_FIELD_TREE:
    case STRUT_FIELD_OBJECT: assert(false);
  }
}

void strut_store_choice(const strut_key *key, void *object) {
  char *tag = (char *)object + key->field.tag;
  if (!key->field.chosen || key->field.tag_value != key->field.tag_last) return;
  if (key->field.tag_size == sizeof(bool))
    *(bool *)(void *)tag = key->field.tag_value != 0;
  else
    *(uint32_t *)(void *)tag = key->field.tag_value;
}

bool strut_store_number(strut_reader *reader, strut_fields *fields, int key,
                        strut_dimension dimension, void *object) {
  const strut_key *k = strut_key_at(key);
  const strut_slot *slot = strut_slot_of(fields, key);
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  assert(k->field.type == STRUT_FIELD_DOUBLE);
  strut_store_choice(k, object);
  return strut_read_number(reader, slot->value, k->name, fields->owner, dimension, k->limits,
                           (double *)(void *)((char *)object + k->field.offset));
}

/* ---- references and lists ---- */

/* The things, or coordinates, that a name, or a list of names, refers to; -1 for what is unknown. */
static bool read_references(strut_reader *reader, const strut_key *key, const strut_tree *value,
                            strut_owner owner, int32_t *index) {
  const strut_tree *item = value->kind == STRUT_TREE_LIST ? value->first : value;
  bool known = true;
  for (; item; item = item == value ? NULL : item->next) {
    *index = key->field.kind == STRUT_THING_COUNT
                 ? strut_read_coordinate(reader, item, key->name, owner)
                 : strut_read_reference(reader, item, key->name, owner, key->field.kind);
    known = *index++ >= 0 && known;
  }
  return known;
}

/* `[a, b]` or `[a, p, q, b]`; -1 for what is unknown. */
static bool store_path(strut_reader *reader, const strut_key *key, const strut_tree *list,
                       strut_owner owner, char *object) {
  size_t count = list->count, *between = (size_t *)(void *)(object + key->field.number);
  int32_t *ends = (int32_t *)(void *)(object + key->field.offset), *guides = NULL;
  bool known = true;
  if (count > STRUT_MOST_ELEMENT_NODES)
    return strut_report_error(reader, list->place,
                              "%s runs over %zu nodes, at most %d are possible",
                              strut_owner_text(reader, owner), count, STRUT_MOST_ELEMENT_NODES);
  if (count > 2) guides = strut_keep_array(reader, count - 2, sizeof *guides);
  if (count > 2 && !guides) return false;
  memcpy(object + key->field.beside, &guides, sizeof guides);
  for (const strut_tree *item = list->first; item; item = item->next) {
    bool end = item == list->first || !item->next;
    int32_t node = strut_read_reference(reader, item, key->name, owner, key->field.kind);
    known = known && node >= 0;
    if (end)
      ends[item == list->first ? 0 : 1] = node;
    else
      guides[(*between)++] = node;
  }
  return known;
}

/* x, y, or an angle, turned with the copy that it is in. */
static bool store_direction(strut_reader *reader, const strut_key *key, const strut_tree *value,
                            strut_owner owner, double *direction) {
  if (!strut_read_scalar(reader, value, key->name, owner, key->words)) return false;
  bool y = strcmp(value->text, "y") == 0;
  double angle = y ? 0.25 * STRUT_TAU : 0.0;
  if (!y && strcmp(value->text, "x") != 0 &&
      !strut_read_number(reader, value, key->name, owner, STRUT_DIM_ANGLE, STRUT_WITHIN(ANY),
                         &angle))
    return false;
  *direction = angle;
  if (!strut_scope_of(reader, value)) return true;
  double vector[2] = {y ? 0.0 : cos(angle), y ? 1.0 : sin(angle)};
  strut_place_vector(reader, value, vector);
  *direction = atan2(vector[1], vector[0]);
  return true;
}

static bool read_numbers(strut_reader *reader, const strut_key *key, const strut_tree *list,
                         strut_owner owner, double *number) {
  strut_dimension dimension = key->type == STRUT_TYPE_PROFILE ? STRUT_DIM_LENGTH : STRUT_DIM_TIME;
  bool fine = true;
  for (const strut_tree *item = list->first; item; item = item->next) {
    if (key->type == STRUT_TYPE_PROFILE) {
      fine = strut_read_pair(reader, item, key->name, owner, dimension, number) && fine;
      number += 2;
    } else {
      fine = strut_read_number(reader, item, key->name, owner, dimension, STRUT_WITHIN(ANY),
                               number++) &&
             fine;
    }
  }
  return fine;
}

static bool read_texts(strut_reader *reader, const strut_key *key, const strut_tree *list,
                       strut_owner owner, const char **text, size_t *count) {
  *count = 0;
  for (const strut_tree *item = list->first; item; item = item->next)
    if (strut_read_scalar(reader, item, key->name, owner, key->words))
      text[(*count)++] = item->text;
  return *count == list->count;
}

static bool store_list(strut_reader *reader, const strut_key *key, const strut_slot *slot,
                       strut_owner owner, char *object) {
  const strut_field *field = &key->field;
  size_t count = slot->value->count;
  if (field->type == STRUT_FIELD_NODE_SET)
    return strut_read_node_sets(reader, slot, owner, (void *)(object + field->offset),
                                (void *)(object + field->number));
  bool things = field->type == STRUT_FIELD_INT32;
  if (things && field->kind != STRUT_THING_COUNT && count > STRUT_MOST_ELEMENT_NODES)
    return strut_report_error(reader, slot->value->place,
                              "%s has %zu nodes, at most %d are possible",
                              strut_owner_text(reader, owner), count, STRUT_MOST_ELEMENT_NODES);
  size_t size = things                                   ? sizeof(int32_t)
                : field->type == STRUT_FIELD_DOUBLE_PAIR ? 2 * sizeof(double)
                : field->type == STRUT_FIELD_TEXT        ? sizeof(const char *)
                                                         : sizeof(double);
  void *array = strut_keep_array(reader, count, size);
  if (!array) return false;
  memcpy(object + field->offset, &array, sizeof array);
  *(size_t *)(void *)(object + field->number) = count;
  if (field->type == STRUT_FIELD_TEXT)
    return read_texts(reader, key, slot->value, owner, array,
                      (size_t *)(void *)(object + field->number));
  return things ? read_references(reader, key, slot->value, owner, array)
                : read_numbers(reader, key, slot->value, owner, array);
}

/* ---- mappings ---- */

bool strut_read_nested(strut_reader *reader, const strut_key *key, strut_fields *outer,
                       void *object, size_t object_size) {
  strut_fields fields;
  const strut_slot *slot = &outer->slot[key - strut_key_at(strut_section_first(key->section))];
  strut_owner within =
      strut_owner_within(reader, *key->words ? key->words : key->name, outer->owner);
  strut_read_fields(reader, strut_section_below(key), slot->value, within, &fields);
  fields.key = slot->key, fields.outer = outer;
  strut_require(reader, &fields, slot->key->place);
  return strut_store_fields(reader, &fields, object, object_size) && !fields.broken;
}

/* A law's strain and force follow from what its force measures: a moment acts on an angle, a pressure on an area. */
static bool store_nested(strut_reader *reader, const strut_key *key, strut_fields *fields,
                         const strut_slot *slot, char *object) {
  void *within = object + key->field.offset;
  if (key->type != STRUT_TYPE_LAW)
    return strut_read_nested(reader, key, fields, within, key->field.size);
  strut_dimension strain = key->measure == STRUT_MEASURE_MOMENT     ? STRUT_DIM_ANGLE
                           : key->measure == STRUT_MEASURE_PRESSURE ? STRUT_DIM_AREA
                                                                    : STRUT_DIM_LENGTH;
  return strut_read_law(reader, slot, fields->owner, strain, strut_measure_dimension(key->measure),
                        within);
}

static bool store_key(strut_reader *reader, const strut_key *key, strut_fields *fields,
                      strut_slot *slot, char *object) {
  const strut_dimension dimension = strut_measure_dimension(key->measure);
  void *field = object + key->field.offset;
  bool fine = true;
  if (key->field.type == STRUT_FIELD_TREE) {
    *(const strut_tree **)field = slot->value;
    return true;
  }
  if (key->measure == STRUT_MEASURE_CONTEXT || key->field.later) return true;
  switch (key->field.role) {
    case STRUT_FIELD_VALUE:
      if (key->type == STRUT_TYPE_SIGNAL)
        fine = (*(int32_t *)field = strut_read_signal(reader, slot->value, key->name, fields->owner,
                                                      &dimension)) >= 0;
      else if (key->field.direction)
        fine = store_direction(reader, key, slot->value, fields->owner, field);
      else if (!strut_diagnostics_full(reader->diagnostics)) /* else the object will not be used */
        store_value(reader, key, slot, field);
      break;
    case STRUT_FIELD_REFERENCE:
      fine = read_references(reader, key, slot->value, fields->owner, field);
      break;
    case STRUT_FIELD_PATH:
      fine = store_path(reader, key, slot->value, fields->owner, object);
      break;
    case STRUT_FIELD_LIST: fine = store_list(reader, key, slot, fields->owner, object); break;
    case STRUT_FIELD_NESTED: fine = store_nested(reader, key, fields, slot, object); break;
    case STRUT_FIELD_PLACES:
    case STRUT_FIELD_BY_HAND:
    case STRUT_FIELD_NONE:
    case STRUT_FIELD_SECTION:
    case STRUT_FIELD_THINGS: return true;
  }
  strut_store_choice(key, object);
  return fine;
}

static bool is_reference(const strut_field *field) {
  return field->role == STRUT_FIELD_REFERENCE || field->role == STRUT_FIELD_PATH ||
         (field->role == STRUT_FIELD_LIST && field->type == STRUT_FIELD_INT32);
}

bool strut_store_fields(strut_reader *reader, strut_fields *fields, void *object,
                        size_t object_size) {
  int size = strut_section_size(fields->section);
  const strut_key *keys = strut_key_at(strut_section_first(fields->section));
  bool fine = strut_check_rules(reader, fields);
  for (int i = 0; i < size; i++) {
    strut_slot *slot = &fields->slot[i];
    bool given = slot->state == STRUT_GIVEN;
    if (!given && keys[i].need != STRUT_REQUIRED) continue;
    assert(!keys[i].field.object_size || keys[i].field.object_size == object_size);
    bool read = given && store_key(reader, &keys[i], fields, slot, object);
    if (!read && is_reference(&keys[i].field)) fields->unresolved = true;
    if (given && !read) fine = false;
  }
  (void)object_size;
  if (by_hand[fields->section]) fine = by_hand[fields->section](reader, fields, object) && fine;
  return fine;
}

bool strut_read_sized_object(strut_reader *reader, strut_section section, const strut_tree *map,
                             strut_owner owner, strut_fields *fields, void *object, size_t size) {
  strut_read_fields(reader, section, map, owner, fields);
  if (!fields->broken) strut_require(reader, fields, map->place);
  return strut_store_fields(reader, fields, object, size) && !fields->broken;
}
