/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes and members, and what drives them: actuators and loads. See reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/read/copies.h"
#include "parser/read/reader.h"

const char *strut_node_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  return i < reader->scene->node_count ? reader->scene->nodes[i].name : NULL;
}

const char *strut_member_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  return i < reader->scene->member_count ? reader->scene->members[i].name : NULL;
}

/* Notes how a node moves, for when signals are known; it is supported in those directions. */
static void note_moves(strut_reader *reader, const strut_slot *slot, strut_node *node) {
  size_t i = (size_t)(node - reader->scene->nodes);
  if (slot->state != STRUT_GIVEN) return;
  reader->node_moves[i] = slot->value;
  for (int c = 0; c < 2; c++) {
    bool reversed;
    int axis = strut_scope_axis(reader, c, &reversed);
    if (axis >= 0 && strut_tree_find(slot->value, c ? "y" : "x", NULL)) node->fixed[axis] = true;
  }
}

/* The axis of the scene that lies along one of the node's part; -1: none does, which is reported. */
static int turned_axis(strut_reader *reader, const strut_tree *at, strut_owner owner, int axis,
                       const char *what, bool backwards) {
  bool reversed;
  int turned = strut_scope_axis(reader, axis, &reversed);
  if (turned >= 0 && (backwards || !reversed)) return turned;
  strut_report_error(reader, at->place,
                     "%s %s along %c, which in this copy points %s; do it where it is placed",
                     strut_owner_text(reader, owner), what, axis ? 'y' : 'x',
                     turned >= 0 ? "the other way" : "along neither axis");
  return -1;
}

/* A support of a copy turns with it. */
static bool turn_support(strut_reader *reader, const strut_slot *slot, strut_node *node) {
  strut_owner owner = {"node", node->name};
  bool turned[2] = {node->fixed[0], node->fixed[1]};
  bool one = node->fixed[0] != node->fixed[1];
  if (!one || slot->state != STRUT_GIVEN || strut_scope_of(reader, slot->value) != reader->scope)
    return true;
  int axis = turned_axis(reader, slot->value, owner, node->fixed[1], "is fixed", true);
  if (axis < 0) return false;
  turned[axis] = true, turned[1 - axis] = false;
  memcpy(node->fixed, turned, sizeof turned);
  return true;
}

/* Reads one node; returns false where something about it could not be read. */
static bool read_node(strut_reader *reader, const strut_tree *key, strut_node *node) {
  const strut_tree *value = strut_expand_value(reader, key->next);
  strut_owner owner = {"node", node->name};
  bool fine = strut_read_name(reader, key, "node");
  node->position[0] = node->position[1] = (double)NAN;
  if (value->kind == STRUT_TREE_LIST) {
    fine =
        strut_read_pair(reader, value, "position", owner, STRUT_DIM_LENGTH, node->position) && fine;
    strut_place_point(reader, value, node->position);
    return fine;
  }
  if (value->kind == STRUT_TREE_SCALAR) {
    strut_report_error(reader, value->place,
                       "expected a position such as [10 mm, 0], or a mapping, for %s, found %s",
                       strut_owner_text(reader, owner), strut_found(reader, value));
    return false;
  }
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_NODE, value, owner, &fields);
  strut_apply_groups(reader, &fields, STRUT_KEY_NODE_GROUP, owner);
  strut_require(reader, &fields, owner, key->place);
  strut_store_fields(reader, &fields, &reader->scene->arena, node, sizeof *node);
  note_moves(reader, strut_slot_of(&fields, STRUT_KEY_NODE_MOVES), node);
  strut_place_point(reader, strut_slot_of(&fields, STRUT_KEY_NODE_POSITION)->value, node->position);
  return turn_support(reader, strut_slot_of(&fields, STRUT_KEY_NODE_FIXED), node) && fine &&
         !fields.broken;
}

void strut_read_nodes(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_NODES);
  if (!map) return;
  scene->nodes = strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->nodes);
  reader->node_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->node_source);
  reader->node_moves =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->node_moves);
  if (!scene->nodes || !reader->node_source || !reader->node_moves) return;
  strut_reserve_names(reader, &reader->node_names, map->count);
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->node_count);
    scene->nodes[i] = strut_node_default();
    scene->nodes[i].name = strut_keep_text(reader, key->text);
    strut_add_name(reader, &reader->node_names, scene->nodes[i].name, i);
    bool fine = read_node(reader, key, &scene->nodes[i]);
    memcpy(scene->nodes[i].start, scene->nodes[i].position, sizeof scene->nodes[i].start);
    reader->node_source[i] = (strut_source){key, key->next, !fine};
  }
}

int32_t strut_read_node(strut_reader *reader, const strut_tree *item, strut_owner owner) {
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state != STRUT_GIVEN) return -1;
  return strut_read_reference(reader, item, "nodes", owner, "node", &reader->node_names,
                              strut_node_name, reader->scene->node_count);
}

/* The nodes of `nodes: [a, b]` or `[a, p, q, b]`; -1 for what is unknown. */
static bool read_path(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                      strut_member *member) {
  if (slot->state != STRUT_GIVEN) return false;
  size_t count = slot->value->count;
  bool known = true;
  if (count > STRUT_MOST_ELEMENT_NODES) {
    strut_report_error(reader, slot->value->place,
                       "%s runs over %zu nodes, at most %d are possible",
                       strut_owner_text(reader, owner), count, STRUT_MOST_ELEMENT_NODES);
    return false;
  }
  if (count > 2)
    member->guides =
        strut_reader_allocate(reader, &reader->scene->arena, count - 2, sizeof(int32_t));
  if (count > 2 && !member->guides) return false;
  const strut_tree *item = slot->value->first;
  for (size_t k = 0; k < count; k++, item = item->next) {
    int32_t node = strut_read_node(reader, item, owner);
    known = known && node >= 0;
    if (k == 0 || k + 1 == count)
      member->node[k ? 1 : 0] = node;
    else
      member->guides[member->guide_count++] = node;
  }
  return known;
}

/* Four keys, of which a member has one at most, say the rest length in different ways. */
static void store_rest_length(strut_fields *fields, strut_member *member) {
  for (int kind = STRUT_REST_RATIO; kind <= STRUT_REST_FORCE_DENSITY; kind++) {
    const strut_slot *slot = strut_slot_of(fields, strut_rest_key((strut_rest_kind)kind));
    if (slot->state != STRUT_GIVEN) continue;
    member->rest_kind = (strut_rest_kind)kind;
    member->rest_value = slot->number[0];
  }
}

static bool read_maxwell(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                         strut_maxwell *maxwell) {
  char text[200];
  strut_fields fields;
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  snprintf(text, sizeof text, "the Maxwell branch of %.150s", strut_owner_text(reader, owner));
  strut_owner within = {text, NULL};
  strut_read_fields(reader, STRUT_SECTION_MAXWELL, slot->value, within, &fields);
  strut_require(reader, &fields, within, slot->value->place);
  strut_store_fields(reader, &fields, &reader->scene->arena, maxwell, sizeof *maxwell);
  return !fields.broken;
}

static bool read_member(strut_reader *reader, const strut_tree *key, strut_member *member) {
  strut_owner owner = {"member", member->name};
  bool fine = strut_read_name(reader, key, "member");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_MEMBER, strut_expand_value(reader, key->next), owner,
                    &fields);
  strut_apply_groups(reader, &fields, STRUT_KEY_MEMBER_GROUP, owner);
  strut_require(reader, &fields, owner, key->place);
  if (!read_path(reader, strut_slot_of(&fields, STRUT_KEY_MEMBER_NODES), owner, member)) {
    reader->ends_unknown = true;
    fine = false;
  }
  strut_store_fields(reader, &fields, &reader->scene->arena, member, sizeof *member);
  if (strut_slot_of(&fields, STRUT_KEY_MEMBER_MASS)->state == STRUT_BROKEN)
    reader->masses_unknown = true;
  store_rest_length(&fields, member);
  if (!strut_read_law(reader, strut_slot_of(&fields, STRUT_KEY_MEMBER_LAW), owner, STRUT_DIM_LENGTH,
                      STRUT_DIM_FORCE, &member->law))
    fine = false;
  if (!read_maxwell(reader, strut_slot_of(&fields, STRUT_KEY_MEMBER_MAXWELL), owner,
                    &member->maxwell))
    fine = false;
  return fine && !fields.broken;
}

void strut_read_members(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_MEMBERS);
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_MEMBERS)->state == STRUT_BROKEN)
    reader->ends_unknown = true;
  if (!map) return;
  scene->members = strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->members);
  reader->member_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->member_source);
  if (!scene->members || !reader->member_source) return;
  strut_reserve_names(reader, &reader->member_names, map->count);
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->member_count);
    scene->members[i] = strut_member_default();
    scene->members[i].name = strut_keep_text(reader, key->text);
    strut_add_name(reader, &reader->member_names, scene->members[i].name, i);
    bool fine = read_member(reader, key, &scene->members[i]);
    reader->member_source[i] = (strut_source){key, key->next, !fine};
  }
}

bool strut_read_node_pairs(strut_reader *reader, const strut_tree *map, strut_owner owner,
                           strut_dimension dimension, strut_pair_taker *take) {
  bool fine = true;
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN;
  for (const strut_tree *k = map->first; k; k = k->next->next) {
    double pair[2];
    int32_t node = strut_find_named(reader, &reader->node_names, k, k->text);
    if (node < 0 && known)
      strut_report_error(
          reader, k->place, "unknown node '%s' in %s%s", strut_sanitised_text(reader, k->text),
          strut_owner_text(reader, owner),
          strut_hint(reader, k->text, strut_node_name, reader, reader->scene->node_count));
    if (!strut_read_pair(reader, k->next, k->text, owner, dimension, pair) || node < 0)
      fine = false;
    else if (take) {
      if (strut_dimension_equal(dimension, STRUT_DIM_LENGTH))
        strut_place_point(reader, k->next, pair);
      take(reader, node, pair, k->next);
    }
  }
  return fine;
}

/* The signal of an actuator: what it adds to a rest length or angle, or a force, or a moment. */
static bool read_drive(strut_reader *reader, const strut_tree *key, strut_fields *fields,
                       strut_owner owner, bool hinge, bool cell, bool known,
                       strut_actuator *actuator) {
  static const int keys[] = {STRUT_KEY_ACTUATOR_SIGNAL, STRUT_KEY_ACTUATOR_FORCE,
                             STRUT_KEY_ACTUATOR_MOMENT};
  const strut_dimension dimensions[] = {hinge  ? STRUT_DIM_ANGLE
                                        : cell ? STRUT_DIM_STIFFNESS
                                               : STRUT_DIM_LENGTH,
                                        STRUT_DIM_FORCE, STRUT_DIM_MOMENT};
  int k = 0;
  while (k < 3 && strut_slot_of(fields, keys[k])->state == STRUT_ABSENT) k++;
  const strut_slot *slot = strut_slot_of(fields, keys[k < 3 ? k : 0]);
  if (k == 3 && !fields->broken)
    strut_report_error(reader, key->place,
                       "%s lacks 'signal', expected a signal such as {sine: {amplitude: 1 mm, "
                       "frequency: 10 Hz}}, or a signal's name; or 'force' or 'moment' instead",
                       strut_owner_text(reader, owner));
  if (k == 3) return false;
  if (known && slot->key && k > 0 && cell) {
    strut_report_error(reader, slot->key->place,
                       "%s gives a '%s' to a cell, whose pressure a 'signal' drives",
                       strut_owner_text(reader, owner), strut_key_at(keys[k])->name);
    return false;
  }
  if (known && slot->key && k > 0 && hinge != (k == 2)) {
    strut_report_error(reader, slot->key->place,
                       hinge ? "%s gives a 'force' to a hinge, which takes a 'moment'"
                             : "%s gives a 'moment' to a member, which takes a 'force'",
                       strut_owner_text(reader, owner));
    return false;
  }
  actuator->force = k > 0;
  reader->signal_quantity = k == 2 ? "moment" : known && cell ? "pressure" : NULL;
  if (slot->state == STRUT_GIVEN)
    actuator->signal = strut_read_signal(reader, slot->value, strut_key_at(keys[k])->name, owner,
                                         known || k > 0 ? &dimensions[k] : NULL);
  reader->signal_quantity = NULL;
  return actuator->signal >= 0;
}

static bool read_actuator(strut_reader *reader, const strut_tree *key, strut_actuator *actuator) {
  strut_owner owner = {"actuator", actuator->name};
  bool fine = strut_read_name(reader, key, "actuator");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_ACTUATOR, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *member = strut_slot_of(&fields, STRUT_KEY_ACTUATOR_MEMBER);
  const strut_slot *hinge = strut_slot_of(&fields, STRUT_KEY_ACTUATOR_HINGE);
  const strut_slot *cell = strut_slot_of(&fields, STRUT_KEY_ACTUATOR_CELL);
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_MEMBERS)->state != STRUT_BROKEN;
  if (member->state == STRUT_ABSENT && hinge->state == STRUT_ABSENT &&
      cell->state == STRUT_ABSENT && !fields.broken) {
    strut_report_error(reader, key->place,
                       "%s lacks 'member', expected the name of a member, or "
                       "'hinge' with the name of a hinge",
                       strut_owner_text(reader, owner));
    fine = false;
  }
  if (hinge->state == STRUT_GIVEN &&
      strut_slot_of(&reader->top, STRUT_KEY_SCENE_HINGES)->state != STRUT_BROKEN)
    actuator->hinge =
        strut_read_reference(reader, hinge->value, "hinge", owner, "hinge", &reader->hinge_names,
                             strut_hinge_name, reader->scene->hinge_count);
  if (cell->state == STRUT_GIVEN &&
      strut_slot_of(&reader->top, STRUT_KEY_SCENE_CELLS)->state != STRUT_BROKEN)
    actuator->cell =
        strut_read_reference(reader, cell->value, "cell", owner, "cell", &reader->cell_names,
                             strut_cell_name, reader->scene->cell_count);
  if (member->state == STRUT_GIVEN && known)
    actuator->member =
        strut_read_reference(reader, member->value, "member", owner, "member",
                             &reader->member_names, strut_member_name, reader->scene->member_count);
  /* of what, tells the signal's dimension */
  bool drives =
      member->state != STRUT_ABSENT || hinge->state != STRUT_ABSENT || cell->state != STRUT_ABSENT;
  fine = read_drive(reader, key, &fields, owner, hinge->key, cell->key, drives, actuator) && fine;
  return fine && !fields.broken &&
         (actuator->member >= 0 || actuator->hinge >= 0 || actuator->cell >= 0);
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
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->actuator_count);
    scene->actuators[i] = (strut_actuator){.name = strut_keep_text(reader, key->text),
                                           .member = -1,
                                           .signal = -1,
                                           .hinge = -1,
                                           .cell = -1};
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
  strut_place_vector(reader, strut_slot_of(&fields, STRUT_KEY_LOAD_FORCE)->value, load->force);
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
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->load_count);
    scene->loads[i] =
        (strut_load){.name = strut_keep_text(reader, key->text), .node = -1, .signal = -1};
    strut_add_name(reader, &reader->load_names, scene->loads[i].name, i);
    bool fine = read_load(reader, key, &scene->loads[i]);
    reader->load_source[i] = (strut_source){key, key->next, !fine};
  }
}

/* Turns per second or an angular velocity; a plain number is in rad/s. */
static bool read_speed(strut_reader *reader, const strut_tree *value, strut_owner owner,
                       double *speed) {
  const strut_dimension angular = {0, 0, -1, 1};
  strut_quantity q;
  char found[80];
  if (!strut_read_scalar(reader, value, "speed", owner, "a number") ||
      !strut_read_quantity(reader, value, "speed", owner, &q))
    return false;
  bool turns = !q.bare && strut_dimension_equal(q.dimension, STRUT_DIM_FREQUENCY);
  *speed = turns ? STRUT_TAU * q.value : q.value;
  if (turns || q.bare || strut_dimension_equal(q.dimension, angular)) return true;
  strut_report_error(reader, value->place,
                     "expected a speed such as '30 Hz' or '188 rad/s' for 'speed' of %s, found %s",
                     strut_owner_text(reader, owner),
                     strut_dimension_name(q.dimension, found, sizeof found));
  return false;
}

/* The angle counts from the copy's own x, and in a mirrored one clockwise. */
static void turn_unbalance(strut_reader *reader, const strut_slot *signal, strut_unbalance *u) {
  double ahead[2] = {1.0, 0.0};
  if (!reader->scope) return;
  strut_place_vector(reader, NULL, ahead);
  double turn = atan2(ahead[1], ahead[0]);
  bool flips = strut_scope_flips(reader);
  if (flips && signal->state == STRUT_GIVEN)
    strut_report_error(reader, signal->key->place,
                       "the angle of unbalance '%s' is a signal, which cannot turn the other way "
                       "round in a mirrored copy; give a 'speed'",
                       strut_local_name(reader, u->name));
  if (flips) u->speed = -u->speed;
  u->phase = flips ? turn - u->phase : turn + u->phase;
}

static bool read_unbalance(strut_reader *reader, const strut_tree *key, strut_unbalance *u) {
  strut_owner owner = {"unbalance", u->name};
  const strut_dimension angle = STRUT_DIM_ANGLE;
  bool fine = strut_read_name(reader, key, "unbalance");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_UNBALANCE, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *node = strut_slot_of(&fields, STRUT_KEY_UNBALANCE_NODE);
  const strut_slot *speed = strut_slot_of(&fields, STRUT_KEY_UNBALANCE_SPEED);
  const strut_slot *signal = strut_slot_of(&fields, STRUT_KEY_UNBALANCE_SIGNAL);
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN;
  if (node->state == STRUT_GIVEN && known)
    u->node = strut_read_reference(reader, node->value, "node", owner, "node", &reader->node_names,
                                   strut_node_name, reader->scene->node_count);
  if (u->node < 0) reader->ends_unknown = true;
  strut_store_fields(reader, &fields, &reader->scene->arena, u, sizeof *u);
  if (speed->state == STRUT_GIVEN)
    fine = read_speed(reader, speed->value, owner, &u->speed) && fine;
  if (signal->state == STRUT_GIVEN) {
    u->signal = strut_read_signal(reader, signal->value, "angle", owner, &angle);
    fine = u->signal >= 0 && fine;
  }
  if (speed->state == STRUT_ABSENT && signal->state == STRUT_ABSENT && !fields.broken) {
    strut_report_error(reader, key->place,
                       "%s lacks 'speed', expected one such as '30 Hz', or 'angle' with a signal",
                       strut_owner_text(reader, owner));
    fine = false;
  }
  if (!fine || fields.broken) reader->masses_unknown = true;
  turn_unbalance(reader, signal, u);
  return fine && !fields.broken && u->node >= 0;
}

static void read_unbalances(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_UNBALANCES);
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_UNBALANCES)->state == STRUT_BROKEN)
    reader->ends_unknown = reader->masses_unknown = true;
  if (!map) return;
  scene->unbalances =
      strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->unbalances);
  reader->unbalance_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->unbalance_source);
  if (!scene->unbalances || !reader->unbalance_source) return;
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->unbalance_count);
    scene->unbalances[i] =
        (strut_unbalance){.name = strut_keep_text(reader, key->text), .node = -1, .signal = -1};
    strut_add_name(reader, &reader->unbalance_names, scene->unbalances[i].name, i);
    bool fine = read_unbalance(reader, key, &scene->unbalances[i]);
    reader->unbalance_source[i] = (strut_source){key, key->next, !fine};
  }
}

static void read_moves_of(strut_reader *reader, size_t node) {
  strut_scene *scene = reader->scene;
  strut_owner owner = {"node", scene->nodes[node].name};
  const strut_dimension length = STRUT_DIM_LENGTH;
  strut_fields fields;
  strut_enter_scope(reader, reader->node_source[node].key);
  strut_read_fields(reader, STRUT_SECTION_MOVES, reader->node_moves[node], owner, &fields);
  if (fields.broken) reader->node_source[node].broken = true;
  for (int c = 0; c < 2; c++) {
    const strut_slot *slot = strut_slot_of(&fields, STRUT_KEY_MOVES_ALONG_X + c);
    if (slot->state != STRUT_GIVEN) continue;
    int32_t signal = strut_read_signal(reader, slot->value, c ? "y" : "x", owner, &length);
    int axis = turned_axis(reader, slot->key, owner, c, "moves", false);
    if (signal < 0 || axis < 0)
      reader->node_source[node].broken = true;
    else
      scene->support_motions[scene->support_motion_count++] =
          (strut_support_motion){(int32_t)node, axis, signal};
  }
}

static void read_moves(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  size_t most = 0;
  for (size_t i = 0; i < scene->node_count && reader->node_moves; i++)
    most += reader->node_moves[i] ? 2 : 0;
  if (!most) return;
  scene->support_motions =
      strut_reader_allocate(reader, &scene->arena, most, sizeof *scene->support_motions);
  for (size_t i = 0; i < scene->node_count && scene->support_motions; i++)
    if (reader->node_moves[i]) read_moves_of(reader, i);
  reader->scope = NULL;
}

void strut_read_drives(strut_reader *reader) {
  read_moves(reader);
  read_unbalances(reader);
  read_actuators(reader);
  read_loads(reader);
}
