/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where copies of parts lie: `repeat`, flip, scale, turn, move, or `onto` nodes outside. See copies.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/reuse/copies.h"

/* ---- how often, and where copy k lies ---- */

static bool read_count(strut_reader *reader, const strut_tree *value, strut_owner owner,
                       int64_t *count) {
  double number;
  if (!strut_read_number(reader, value, "count", owner, STRUT_DIM_NONE,
                         STRUT_WITHIN(WHOLE(1, STRUT_MOST_COPIES)), &number))
    return false;
  *count = (int64_t)number;
  return true;
}

/* A number, or [n, m]. */
static bool read_counts(strut_reader *reader, const strut_tree *value, strut_owner owner,
                        strut_repetition *repetition) {
  repetition->numbers = 1;
  repetition->count[1] = 1;
  if (value->kind == STRUT_TREE_SCALAR)
    return read_count(reader, value, owner, &repetition->count[0]);
  if (value->kind != STRUT_TREE_LIST || value->count != 2)
    return strut_refuse_form(reader, STRUT_KEY_REPEAT_COUNT, value, owner);
  repetition->numbers = 2;
  bool fine = read_count(reader, value->first, owner, &repetition->count[0]);
  return read_count(reader, value->first->next, owner, &repetition->count[1]) && fine;
}

static bool read_steps(strut_reader *reader, const strut_tree *value, strut_owner owner,
                       strut_repetition *repetition) {
  if (!value) return true;
  bool lists =
      value->kind == STRUT_TREE_LIST && value->count == 2 && value->first->kind == STRUT_TREE_LIST;
  if (lists != (repetition->numbers == 2))
    return strut_report_error(reader, value->place,
                              repetition->numbers == 2
                                  ? "a lattice has two steps, as in [[1 m, 0], [0, 1 m]], found %s"
                                  : "one count has one step, as in [1 m, 0], found %s",
                              strut_found(reader, value));
  const strut_tree *item = lists ? value->first : value;
  bool fine = true;
  for (int k = 0; k < repetition->numbers; k++, item = item->next)
    fine =
        strut_read_pair(reader, item, "step", owner, STRUT_DIM_LENGTH, repetition->step[k]) && fine;
  return fine;
}

static bool read_next(strut_reader *reader, const strut_tree *value, strut_owner owner,
                      strut_repetition *repetition) {
  if (!value) return true;
  bool list = value->kind == STRUT_TREE_LIST && value->count == 2;
  if (list != (repetition->numbers == 2) || (!list && value->kind != STRUT_TREE_MAP))
    return strut_refuse_form(reader, STRUT_KEY_REPEAT_NEXT, value, owner);
  repetition->next[0] = list ? value->first : value;
  repetition->next[1] = list ? value->first->next : NULL;
  return true;
}

static bool read_closed(strut_reader *reader, const strut_tree *value, const strut_tree *key,
                        strut_owner owner, strut_repetition *repetition) {
  if (!value) return true;
  int word = value->kind == STRUT_TREE_SCALAR ? strut_switch_find(value->text) : 1;
  repetition->closed = word == 1;
  repetition->twist = value->kind == STRUT_TREE_MAP ? value : NULL;
  if (word < 0 || value->kind == STRUT_TREE_LIST)
    return strut_refuse_form(reader, STRUT_KEY_REPEAT_CLOSED, value, owner);
  if (!repetition->closed || (repetition->numbers == 1 && repetition->next[0])) return true;
  return strut_report_error(reader, key->place,
                            repetition->numbers > 1
                                ? "a lattice cannot be closed; close a ring and repeat the ring"
                                : "'closed' needs 'next', which says what ties a copy to the "
                                  "next one");
}

bool strut_read_repeat(strut_reader *reader, const strut_slot *slot, const char *name,
                       strut_repetition *repetition) {
  char text[STRUT_LONGEST_NAME + 40];
  *repetition = (strut_repetition){.scale = 1.0, .count = {1, 1}};
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  snprintf(text, sizeof text, "'repeat' of '%s'", name);
  strut_owner owner = {text, NULL};
  const strut_tree *value = slot->value;
  if (value->kind != STRUT_TREE_MAP) return read_counts(reader, value, owner, repetition);
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_REPEAT, value, owner, &fields);
  strut_require(reader, &fields, slot->key->place);
  const strut_slot *turn = strut_slot_of(&fields, STRUT_KEY_REPEAT_TURN);
  const strut_slot *scale = strut_slot_of(&fields, STRUT_KEY_REPEAT_SCALE);
  const strut_slot *about = strut_slot_of(&fields, STRUT_KEY_REPEAT_ABOUT);
  strut_repeat_keys keys = {.scale = 1.0};
  if (fields.broken || !strut_store(reader, &fields, &keys) ||
      !read_counts(reader, keys.count, owner, repetition))
    return false;
  bool fine = read_steps(reader, keys.step, owner, repetition);
  fine = read_next(reader, keys.next, owner, repetition) && fine;
  fine = read_closed(reader, keys.closed, strut_slot_of(&fields, STRUT_KEY_REPEAT_CLOSED)->key,
                     owner, repetition) &&
         fine;
  repetition->turn = keys.turn, repetition->scale = keys.scale;
  memcpy(repetition->about, keys.about, sizeof repetition->about);
  const strut_slot *odd = turn->key ? turn : scale->key ? scale : about;
  if (repetition->numbers < 2 || !odd->key) return fine;
  return strut_report_error(
      reader, odd->key->place,
      "a lattice has steps only, no '%s'; place a row that turns, and repeat the row",
      odd->key->text);
}

static void turn_frame(strut_frame *frame, double angle) {
  double s, c;
  strut_sincos_turns(angle / STRUT_TAU, &s, &c);
  frame->axes[0][0] = c, frame->axes[0][1] = -s;
  frame->axes[1][0] = s, frame->axes[1][1] = c;
}

static double power(double base, int64_t exponent) {
  double result = 1.0;
  for (; exponent; exponent >>= 1, base *= base)
    if (exponent & 1) result *= base;
  return result;
}

static void move_point(const strut_frame *frame, double point[2]) {
  point[0] *= frame->scale, point[1] *= frame->scale;
  strut_frame_point(frame, point);
}

/* S^k, or i times one step and j times the other. */
strut_frame strut_repeated_frame(const strut_repetition *repetition, const int64_t number[2]) {
  strut_frame f = strut_frame_of_scene, once = strut_frame_of_scene;
  double k = (double)number[0];
  if (repetition->numbers == 2 || (repetition->turn == 0.0 && repetition->scale == 1.0)) {
    for (int c = 0; c < 2; c++)
      f.at[c] = k * repetition->step[0][c] +
                (repetition->numbers == 2 ? (double)number[1] * repetition->step[1][c] : 0.0);
    return f;
  }
  double s = power(repetition->scale, number[0]), origin[2] = {0.0, 0.0};
  turn_frame(&f, k * repetition->turn);
  f.scale = s;
  if (repetition->step[0][0] == 0.0 &&
      repetition->step[0][1] == 0.0) { /* `about` stays where it is */
    double away[2] = {s * repetition->about[0], s * repetition->about[1]};
    strut_frame_vector(&f, away);
    for (int c = 0; c < 2; c++) f.at[c] = repetition->about[c] - away[c];
    return f;
  }
  /* The images of the origin under S, S^2, S^4, ..., those of the bits of k. */
  double once_away[2] = {repetition->scale * repetition->about[0],
                         repetition->scale * repetition->about[1]};
  turn_frame(&once, repetition->turn);
  once.scale = repetition->scale;
  strut_frame_vector(&once, once_away);
  for (int c = 0; c < 2; c++)
    once.at[c] = repetition->about[c] + repetition->step[0][c] - once_away[c];
  for (int64_t bits = number[0], n = 1; bits; bits >>= 1, n *= 2) {
    if (bits & 1) move_point(&once, origin);
    double squared[2] = {once.at[0], once.at[1]};
    move_point(&once, squared);
    turn_frame(&once, (double)(2 * n) * repetition->turn);
    once.scale *= once.scale;
    memcpy(once.at, squared, sizeof squared);
  }
  memcpy(f.at, origin, sizeof origin);
  return f;
}

/* ---- where the first copy lies ---- */

/* The position of an entry of nodes, in the coordinates of its scope. */
static bool read_position(strut_reader *reader, const strut_tree *value, double position[2]) {
  const strut_tree *at =
      value->kind == STRUT_TREE_MAP ? strut_tree_find(value, "position", NULL) : value;
  return at && strut_read_pair(reader, at, "position", (strut_owner){"a node", NULL},
                               STRUT_DIM_LENGTH, position);
}

static bool refuse_node(strut_reader *reader, const strut_copy *copy, const strut_tree *name) {
  const char *text = strut_sanitised_text(reader, name->text);
  return copy ? strut_report_error(reader, name->place,
                                   "part '%s' has no node '%s' that can be laid onto others",
                                   copy->placement->part->name, text)
              : strut_report_error(
                    reader, name->place,
                    "unknown node '%s' in 'onto'; it names a node of what is placed before", text);
}

/* Where a node of a scope (NULL: the scene) lies, in the coordinates of that scope; `copy`: whose own it is, or NULL. */
static bool find_position(strut_expansion *expansion, strut_copy *scope, const strut_copy *copy,
                          const strut_tree *name, double position[2]) {
  strut_reader *reader = expansion->reader;
  strut_full_name full, resolved;
  snprintf(full.text, sizeof full.text, "%s%s", scope ? scope->prefix : "", name->text);
  int32_t i = strut_name_resolve_last(reader, full.text, &resolved)
                  ? strut_name_map_find(&expansion->copies->node_entries, resolved.text)
                  : -1;
  if (i < 0 || strut_name_hidden_by(reader, scope, resolved.text))
    return refuse_node(reader, copy, name);
  const strut_tree *key = expansion->copies->nodes[i];
  strut_copy *before = strut_enter_scope(reader, key);
  bool fine = read_position(reader, key->next, position);
  strut_place_point(reader, key->next, position);
  reader->scope = before;
  if (!fine || !scope) return fine;
  /* back into the frame of the scope */
  const strut_frame *frame = &scope->frame;
  double d[2] = {position[0] - frame->at[0], position[1] - frame->at[1]};
  for (int c = 0; c < 2; c++)
    position[c] = (frame->axes[0][c] * d[0] + frame->axes[1][c] * d[1]) / frame->scale;
  return true;
}

/* Shifts, and with two pairs turns, the frame so that nodes of the copy lie on others. */
static bool lay_onto(strut_expansion *expansion, strut_copy *copy, const strut_tree *map, bool fit,
                     strut_frame *frame) {
  strut_reader *reader = expansion->reader;
  double own[2][2], there[2][2];
  const strut_tree *tree = map->first;
  if (map->count < 1 || map->count > 2)
    return strut_report_error(reader, map->place,
                              "expected one or two pairs {own: there} for 'onto', found %u",
                              (unsigned)map->count);
  for (unsigned n = 0; n < map->count; n++, tree = tree->next->next) {
    if (!strut_read_scalar(reader, tree->next, "onto", (strut_owner){"a placement", NULL},
                           "the name of a node") ||
        !find_position(expansion, copy, copy, tree, own[n]) ||
        !find_position(expansion, copy->outer, NULL, tree->next, there[n]))
      return false;
    own[n][0] *= frame->scale, own[n][1] *= frame->scale;
    strut_frame_vector(frame, own[n]);
  }
  if (map->count == 2) {
    double a[2] = {own[1][0] - own[0][0], own[1][1] - own[0][1]};
    double b[2] = {there[1][0] - there[0][0], there[1][1] - there[0][1]};
    double la = hypot(a[0], a[1]), lb = hypot(b[0], b[1]);
    if (la == 0.0 || lb == 0.0 || (!fit && fabs(la / lb - 1.0) > 1e-9))
      return strut_report_error(
          reader, map->place, "the two nodes of the copy are %.6g m apart, those outside %.6g m%s",
          la, lb, la > 0.0 && lb > 0.0 ? "; say 'scale: fit', or change one" : "");
    strut_frame turn = strut_frame_of_scene;
    double c = (a[0] * b[0] + a[1] * b[1]) / (la * lb), s = (a[0] * b[1] - a[1] * b[0]) / (la * lb);
    turn.axes[0][0] = turn.axes[1][1] = c, turn.axes[0][1] = -s, turn.axes[1][0] = s;
    turn.scale = fit ? lb / la : 1.0;
    *frame = strut_frame_within(&turn, frame);
    strut_frame_vector(&turn, own[0]);
    own[0][0] *= turn.scale, own[0][1] *= turn.scale;
  }
  for (int c = 0; c < 2; c++) frame->at[c] = there[0][c] - own[0][c];
  return true;
}

/* The frame of the first copy by the placement's own keys. */
bool strut_read_frame(strut_expansion *expansion, strut_placing *placing, strut_copy *copy,
                      strut_frame *frame) {
  strut_reader *reader = expansion->reader;
  strut_owner owner = {"place", placing->placement->key->text};
  const strut_slot *turn = strut_slot_of(&placing->fields, STRUT_KEY_PLACE_TURN);
  const strut_tree *scale = placing->keys.scale, *onto = placing->keys.onto;
  bool fit = scale && scale->kind == STRUT_TREE_SCALAR && strcmp(scale->text, "fit") == 0;
  *frame = strut_frame_of_scene;
  if (turn->state == STRUT_GIVEN) turn_frame(frame, placing->keys.turn);
  memcpy(frame->at, placing->keys.at, sizeof frame->at);
  for (int c = 0; c < 2; c++)
    for (int row = 0; row < 2 && placing->keys.flip >> c & 1; row++) frame->axes[row][c] *= -1.0;
  if (scale && !fit &&
      !strut_read_number(reader, scale, "scale", owner, STRUT_DIM_NONE, STRUT_WITHIN(ABOVE_ZERO),
                         &frame->scale))
    return false;
  bool two = onto && onto->count == 2;
  if ((fit && !two) || (two && turn->key))
    return strut_report_error(reader, fit && !two ? scale->place : turn->key->place,
                              fit && !two ? "'scale: fit' needs two pairs in 'onto'"
                                          : "two pairs in 'onto' turn the copy; leave 'turn' out");
  return !onto || lay_onto(expansion, copy, onto, fit, frame);
}
