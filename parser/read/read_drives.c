/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What signals drive: actuators and loads. See reader.h. */
#include "parser/read/reader.h"

static bool read_actuator(strut_reader *reader, const strut_tree *key, strut_actuator *actuator) {
  strut_owner owner = {"actuator", actuator->name};
  strut_dimension length = STRUT_DIM_LENGTH;
  bool fine = strut_read_name(reader, key, "actuator");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_ACTUATOR, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *member = strut_slot_of(&fields, STRUT_KEY_ACTUATOR_MEMBER);
  const strut_slot *signal = strut_slot_of(&fields, STRUT_KEY_ACTUATOR_SIGNAL);
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_MEMBERS)->state != STRUT_BROKEN;
  if (member->state == STRUT_GIVEN && known)
    actuator->member =
        strut_read_reference(reader, member->value, "member", owner, "member",
                             &reader->member_names, strut_member_name, reader->scene->member_count);
  if (signal->state == STRUT_GIVEN)
    actuator->signal = strut_read_signal(reader, signal->value, "signal", owner, &length);
  return fine && !fields.broken && actuator->member >= 0 && actuator->signal >= 0;
}

static void read_actuators(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_ACTUATORS);
  if (!map) return;
  scene->actuators =
      strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->actuators);
  reader->actuator_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->actuator_source);
  if (!scene->actuators || !reader->actuator_source) return;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    size_t i = strut_next_entry(reader, &scene->actuator_count);
    scene->actuators[i] = (strut_actuator){strut_keep_text(reader, key->text), -1, -1};
    strut_add_name(reader, &reader->actuator_names, scene->actuators[i].name, i);
    bool fine = read_actuator(reader, key, &scene->actuators[i]);
    reader->actuator_source[i] = (strut_source){key, key->next, !fine};
  }
}

static bool read_load(strut_reader *reader, const strut_tree *key, strut_load *load) {
  strut_owner owner = {"load", load->name};
  strut_dimension factor = STRUT_DIM_NONE;
  bool fine = strut_read_name(reader, key, "load");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_LOAD, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *node = strut_slot_of(&fields, STRUT_KEY_LOAD_NODE);
  const strut_slot *signal = strut_slot_of(&fields, STRUT_KEY_LOAD_SIGNAL);
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN;
  if (node->state == STRUT_GIVEN && known)
    load->node =
        strut_read_reference(reader, node->value, "node", owner, "node", &reader->node_names,
                             strut_node_name, reader->scene->node_count);
  if (load->node < 0) reader->ends_unknown = true;
  strut_store_fields(reader, &fields, &reader->scene->arena, load, sizeof *load);
  if (signal->state == STRUT_GIVEN) {
    load->signal = strut_read_signal(reader, signal->value, "signal", owner, &factor);
    if (load->signal < 0) fine = false;
  }
  return fine && !fields.broken && load->node >= 0;
}

static void read_loads(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_LOADS);
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_LOADS)->state == STRUT_BROKEN)
    reader->ends_unknown = true;
  if (!map) return;
  scene->loads = strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->loads);
  reader->load_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->load_source);
  if (!scene->loads || !reader->load_source) return;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    size_t i = strut_next_entry(reader, &scene->load_count);
    scene->loads[i] =
        (strut_load){.name = strut_keep_text(reader, key->text), .node = -1, .signal = -1};
    strut_add_name(reader, &reader->load_names, scene->loads[i].name, i);
    bool fine = read_load(reader, key, &scene->loads[i]);
    reader->load_source[i] = (strut_source){key, key->next, !fine};
  }
}

void strut_read_drives(strut_reader *reader) {
  read_actuators(reader);
  read_loads(reader);
}
