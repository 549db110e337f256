/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes, members, hinges, cells, collisions and distances, and their laws, beyond their rows. See reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/copies.h"

/* ---- nodes ---- */

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

/* `[x, y]`, or the keys of a node. */
static bool read_place_and_keys(strut_reader *reader, const strut_tree *key, strut_node *node) {
  const strut_tree *value = key->next;
  strut_owner owner = {"node", node->name};
  node->position[0] = node->position[1] = (double)NAN;
  if (value->kind == STRUT_TREE_LIST) {
    bool fine = strut_read_pair(reader, value, "position", owner, STRUT_DIM_LENGTH, node->position);
    strut_place_point(reader, value, node->position);
    return fine;
  }
  if (value->kind == STRUT_TREE_SCALAR)
    return strut_report_error(
        reader, value->place,
        "expected a position such as [10 mm, 0], or a mapping, for %s, found %s",
        strut_owner_text(reader, owner), strut_found(reader, value));
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_NODE, value, owner, &fields);
  strut_apply_groups(reader, &fields, STRUT_KEY_NODE_GROUP);
  strut_require(reader, &fields, key->place);
  strut_store(reader, &fields, node);
  note_moves(reader, strut_slot_of(&fields, STRUT_KEY_NODE_MOVES), node);
  strut_place_point(reader, strut_slot_of(&fields, STRUT_KEY_NODE_POSITION)->value, node->position);
  return turn_support(reader, strut_slot_of(&fields, STRUT_KEY_NODE_FIXED), node) && !fields.broken;
}

bool strut_read_node(strut_reader *reader, const strut_tree *key, void *object) {
  strut_node *node = object;
  bool fine = read_place_and_keys(reader, key, node);
  memcpy(node->start, node->position, sizeof node->start);
  return fine;
}

void strut_read_nodes(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_NODES);
  size_t count = map ? map->count : 0;
  reader->node_moves = strut_scratch_array(reader, count, sizeof *reader->node_moves);
  if (reader->node_moves) strut_read_things(reader, STRUT_THING_NODE);
}

/* ---- supports that move, once signals are known ---- */

static void read_moves_of(strut_reader *reader, size_t node) {
  strut_scene *scene = reader->scene;
  strut_owner owner = {"node", scene->nodes[node].name};
  strut_source *source = &reader->things[STRUT_THING_NODE].source[node];
  strut_moves moves = {{-1, -1}};
  strut_fields fields;
  strut_enter_scope(reader, source->key);
  strut_read_object(reader, STRUT_SECTION_MOVES, reader->node_moves[node], owner, &fields, &moves);
  if (fields.broken) source->broken = true;
  for (int c = 0; c < 2; c++) {
    const strut_slot *slot = strut_slot_of(&fields, STRUT_KEY_MOVES_ALONG_X + c);
    if (slot->state != STRUT_GIVEN) continue;
    int axis = turned_axis(reader, slot->key, owner, c, "moves", false);
    if (moves.signal[c] < 0 || axis < 0)
      source->broken = true;
    else
      scene->support_motions[scene->support_motion_count++] =
          (strut_support_motion){(int32_t)node, axis, moves.signal[c]};
  }
}

void strut_read_moves(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  size_t most = 0;
  for (size_t i = 0; i < scene->node_count && reader->node_moves; i++)
    most += reader->node_moves[i] ? 2 : 0;
  if (!most) return;
  scene->support_motions = strut_keep_array(reader, most, sizeof *scene->support_motions);
  for (size_t i = 0; i < scene->node_count && scene->support_motions; i++)
    if (reader->node_moves[i]) read_moves_of(reader, i);
  reader->scope = NULL;
}

/* ---- positions and velocities by node ---- */

/* Does another key name the node that this one names by a text parameter? */
static bool is_named_twice(strut_reader *reader, const strut_tree *map, const strut_tree *tree,
                           int32_t node) {
  if (strcmp(reader->scene->nodes[node].name, tree->text) == 0) return false;
  for (const strut_tree *other = map->first; other; other = other->next->next)
    if (other != tree && strut_find_thing(reader, STRUT_THING_NODE, other, other->text) == node) {
      strut_report_error(reader, tree->place, "'%s' and '%s' are one node",
                         strut_sanitised_text(reader, other->text),
                         strut_sanitised_text(reader, tree->text));
      return true;
    }
  return false;
}

bool strut_read_node_pairs(strut_reader *reader, const strut_tree *map, strut_owner owner,
                           strut_dimension dimension, void *pairs, size_t stride) {
  bool fine = true;
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN;
  for (const strut_tree *tree = map->first; tree; tree = tree->next->next) {
    double pair[2];
    int32_t node = strut_find_thing(reader, STRUT_THING_NODE, tree, tree->text);
    if (node < 0 && known)
      strut_report_error(reader, tree->place, "unknown node '%s' in %s%s",
                         strut_sanitised_text(reader, tree->text), strut_owner_text(reader, owner),
                         strut_hint_of_things(reader, tree->text, STRUT_THING_NODE));
    bool length = strut_dimension_equal(dimension, STRUT_DIM_LENGTH);
    bool measured = length && tree->next->kind == STRUT_TREE_MAP;
    bool read = measured ? strut_read_data_point(reader, tree->next, owner, pair)
                         : strut_read_pair(reader, tree->next, tree->text, owner, dimension, pair);
    fine = read && node >= 0 && !is_named_twice(reader, map, tree, node) && fine;
    if (!read || node < 0) continue;
    if (length) strut_place_point(reader, tree->next, pair);
    memcpy((char *)pairs + (size_t)node * stride, pair, sizeof pair);
  }
  return fine;
}

/* ---- laws ---- */

/* force / strain^power */
static strut_dimension per_strain(strut_dimension force, strut_dimension strain, int power) {
  float n = (float)power;
  return (strut_dimension){force.kg - n * strain.kg, force.m - n * strain.m, force.s - n * strain.s,
                           force.angle - n * strain.angle};
}

static bool read_numbers(strut_reader *reader, strut_fields *fields, strut_dimension strain,
                         strut_dimension force, strut_law *law) {
  bool fine = true;
  for (int p = 0; p < STRUT_LAW_NUMBER_COUNT; p++) {
    const strut_law_parameter *row = strut_law_parameter_at(p);
    fine =
        strut_store_number(reader, fields, strut_key_find(STRUT_SECTION_LAW, row->key),
                           row->power < 0 ? strain : per_strain(force, strain, row->power), law) &&
        fine;
  }
  return fine;
}

static bool read_coefficients(strut_reader *reader, const strut_tree *list, strut_owner owner,
                              strut_dimension strain, strut_dimension force, strut_law *law) {
  double *c = strut_keep_array(reader, list->count, sizeof *c);
  bool fine = c != NULL;
  for (const strut_tree *item = c ? list->first : NULL; item; item = item->next) {
    strut_dimension dimension = per_strain(force, strain, (int)law->count + 1);
    fine = strut_read_number(reader, item, "coefficients", owner, dimension, STRUT_WITHIN(ANY),
                             &c[law->count++]) &&
           fine;
  }
  law->force = c;
  return fine;
}

static bool read_points(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                        strut_dimension strain, strut_dimension force, strut_law *law) {
  const strut_tree *list = slot->value;
  const char *key = slot->key->text;
  double *x = strut_keep_array(reader, list->count, sizeof *x);
  double *y = strut_keep_array(reader, list->count, sizeof *y);
  bool fine = x && y;
  for (const strut_tree *point = fine ? list->first : NULL; point; point = point->next) {
    size_t i = law->count++;
    if (point->kind != STRUT_TREE_LIST || point->count != 2) {
      fine = strut_refuse_value(reader, point, key, owner, "a point such as [2 mm, 3 N]");
      continue;
    }
    fine = strut_read_number(reader, point->first, key, owner, strain, STRUT_WITHIN(ANY), &x[i]) &&
           fine;
    fine = strut_read_number(reader, point->first->next, key, owner, force, STRUT_WITHIN(ANY),
                             &y[i]) &&
           fine;
    if (!fine || i == 0 || x[i] > x[i - 1] || law->kind == STRUT_LAW_FOLDING) continue;
    fine = strut_report_error(
        reader, point->place,
        "expected points with increasing x for 'points' of %s, found %g after %g; "
        "a law that folds back is of the kind curve",
        strut_owner_text(reader, owner), x[i], x[i - 1]);
  }
  law->x = x, law->force = y;
  return fine;
}

/* Reports a number that the law needs and does not have, or has and does not need. */
static bool check_needs(strut_reader *reader, strut_fields *fields, const strut_law *law) {
  const char *kind = strut_law_at(law->kind)->word, *text = strut_owner_text(reader, fields->owner);
  bool fine = true, data = strut_mentions(fields, STRUT_KEY_LAW_DATA);
  for (int p = 0; p < STRUT_LAW_PARAMETER_COUNT; p++) {
    const char *name = strut_law_parameter_at(p)->key;
    int key = strut_key_find(STRUT_SECTION_LAW, name);
    bool needed = strut_law_needs(law->kind, p) && !(data && key == STRUT_KEY_LAW_POINTS);
    if (!strut_mentions(fields, key) && needed)
      fine = strut_report_error(reader, fields->map->place,
                                "%s lacks '%s', which the kind %s needs", text, name, kind);
    else if (strut_mentions(fields, key) && !strut_law_allows(law->kind, p))
      fine = strut_report_error(reader, strut_slot_of(fields, key)->key->place,
                                "%s gives '%s', which the kind %s does not have", text, name, kind);
  }
  bool points = strut_mentions(fields, STRUT_KEY_LAW_POINTS);
  if (law->kind == STRUT_LAW_FOLDING &&
      points == strut_mentions(fields, STRUT_KEY_LAW_CONTROL_POINTS))
    fine =
        strut_report_error(reader, fields->map->place, "%s needs 'points' or 'control_points', %s",
                           text, points ? "not both" : "and has neither");
  return fine;
}

/* `law: bilinear` lacks its numbers and is refused; the others are complete. */
static bool read_word(strut_reader *reader, const strut_tree *value, strut_owner owner,
                      strut_law *law) {
  static const char words[] = "tension_only|compression_only" STRUT_LAWS(STRUT_LAW_WORD, );
  strut_key key = *strut_key_at(STRUT_KEY_MEMBER_LAW);
  int word;
  key.words = words;
  if (!strut_read_word(reader, &key, value, owner, &word)) return false;
  if (word < 2) {
    law->carries = word ? STRUT_CARRIES_COMPRESSION : STRUT_CARRIES_TENSION;
    return true;
  }
  law->kind = (strut_law_kind)(word - 2);
  if (!strut_law_at(law->kind)->needs && law->kind != STRUT_LAW_FOLDING) return true;
  return strut_report_error(reader, value->place,
                            "the law %s of %s needs numbers: write a mapping {kind: %s, ...}",
                            value->text, strut_owner_text(reader, owner), value->text);
}

bool strut_read_law(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                    strut_dimension strain, strut_dimension force, strut_law *law) {
  strut_fields fields;
  if (slot->state == STRUT_ABSENT) return true;
  if (slot->state != STRUT_GIVEN) return false;
  if (slot->value->kind == STRUT_TREE_SCALAR) return read_word(reader, slot->value, owner, law);
  strut_owner within = strut_owner_within(reader, "law", owner);
  strut_read_fields(reader, STRUT_SECTION_LAW, slot->value, within, &fields);
  const strut_tree *coefficients = strut_given(&fields, STRUT_KEY_LAW_COEFFICIENTS),
                   *data = strut_given(&fields, STRUT_KEY_LAW_DATA);
  const strut_slot *points = strut_slot_of(&fields, STRUT_KEY_LAW_POINTS);
  strut_store(reader, &fields, law);
  bool fine = !fields.broken && check_needs(reader, &fields, law);
  if (!read_numbers(reader, &fields, strain, force, law) || !fine) return false;
  if (coefficients) return read_coefficients(reader, coefficients, within, strain, force, law);
  if (data)
    return strut_read_data_law(reader, data, strut_given(&fields, STRUT_KEY_LAW_OVER), within,
                               (const strut_dimension[]){strain, force}, law);
  if (strut_given(&fields, STRUT_KEY_LAW_CONTROL_POINTS)) {
    law->source = STRUT_LAW_CONTROL_POINTS;
    points = strut_slot_of(&fields, STRUT_KEY_LAW_CONTROL_POINTS);
  }
  return points->state != STRUT_GIVEN || read_points(reader, points, within, strain, force, law);
}

/* ---- members ---- */

bool strut_read_member(strut_reader *reader, strut_fields *fields, void *object) {
  if (strut_slot_of(fields, STRUT_KEY_MEMBER_MASS)->state == STRUT_BROKEN)
    reader->masses_unknown = true;
  (void)object;
  return true;
}

void strut_read_rayleigh(strut_reader *reader) {
  strut_fields fields;
  strut_owner owner = {"rayleigh", NULL};
  if (strut_read_section(reader, STRUT_KEY_SCENE_RAYLEIGH, STRUT_SECTION_RAYLEIGH, owner.kind,
                         &fields))
    strut_store(reader, &fields, reader->scene);
}

void strut_read_lattice(strut_reader *reader) {
  strut_slot *slot = strut_slot_of(&reader->top, STRUT_KEY_SCENE_LATTICE);
  strut_owner owner = {"lattice", NULL};
  strut_scene *scene = reader->scene;
  if (slot->state != STRUT_GIVEN) return;
  const strut_tree *item = slot->value->first;
  bool list =
      slot->value->kind == STRUT_TREE_LIST && slot->value->count >= 1 && slot->value->count <= 2;
  for (const strut_tree *step = item; list && step; step = step->next)
    list = step->kind == STRUT_TREE_LIST && step->count == 2;
  if (!list) {
    strut_report_error(reader, slot->value->place,
                       "a lattice has one or two steps, as in [[1 m, 0]] or "
                       "[[1 m, 0], [0, 1 m]], found %s",
                       strut_found(reader, slot->value));
    return;
  }
  scene->lattice_count = (int32_t)slot->value->count;
  for (int k = 0; k < scene->lattice_count; k++, item = item->next)
    if (!strut_read_pair(reader, item, "lattice", owner, STRUT_DIM_LENGTH, scene->lattice[k]))
      scene->lattice_count = 0, k = 2; /* the check has nothing to add */
}

/* ---- hinges, cells, collisions ---- */

bool strut_read_hinge(strut_reader *reader, strut_fields *fields, void *object) {
  strut_hinge *hinge = object;
  (void)fields;
  if (strut_scope_flips(reader)) { /* counter-clockwise is the other way round */
    int32_t first = hinge->node[0];
    hinge->node[0] = hinge->node[2], hinge->node[2] = first;
  }
  return true;
}

bool strut_read_cell(strut_reader *reader, strut_fields *fields, void *object) {
  const strut_slot *gas = strut_slot_of(fields, STRUT_KEY_CELL_GAS);
  strut_cell *cell = object;
  if (gas->state == STRUT_ABSENT && !strut_mentions(fields, STRUT_KEY_CELL_PRESSURE))
    cell->law = STRUT_LAW_LINEAR;
  return gas->state != STRUT_GIVEN || strut_read_nested(reader, strut_key_at(STRUT_KEY_CELL_GAS),
                                                        fields, object, sizeof(strut_cell));
}

bool strut_read_distance(strut_reader *reader, strut_fields *fields, void *object) {
  strut_distance_spring *spring = object;
  (void)fields;
  if (strut_scope_flips(reader)) { /* left is the other side */
    int32_t first = spring->line[0];
    spring->line[0] = spring->line[1], spring->line[1] = first;
  }
  return true;
}
