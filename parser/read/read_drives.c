/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What drives a structure, beyond the rows: moving supports, actuators, loads, unbalances, sliders. See reader.h. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/read/copies.h"
#include "parser/read/reader.h"

/* ---- actuators and loads ---- */

/* The signal of an actuator: what it adds to a rest length or angle, or a force, or a moment. */
static bool read_drive(strut_reader *reader, strut_fields *fields, strut_owner owner, bool hinge,
                       bool cell, bool known, strut_actuator *actuator) {
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
    strut_report_error(reader, fields->key->place,
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

bool strut_read_actuator(strut_reader *reader, strut_fields *fields, strut_owner owner,
                         void *object) {
  strut_actuator *actuator = object;
  const strut_slot *member = strut_slot_of(fields, STRUT_KEY_ACTUATOR_MEMBER);
  const strut_slot *hinge = strut_slot_of(fields, STRUT_KEY_ACTUATOR_HINGE);
  const strut_slot *cell = strut_slot_of(fields, STRUT_KEY_ACTUATOR_CELL);
  bool driven =
      member->state != STRUT_ABSENT || hinge->state != STRUT_ABSENT || cell->state != STRUT_ABSENT;
  bool fine = driven || fields->broken;
  if (!fine)
    strut_report_error(reader, fields->key->place,
                       "%s lacks 'member', expected the name of a member, or "
                       "'hinge' with the name of a hinge",
                       strut_owner_text(reader, owner));
  /* what it drives decides what the signal measures */
  fine = read_drive(reader, fields, owner, hinge->key, cell->key, driven, actuator) && fine;
  return fine && (actuator->member >= 0 || actuator->hinge >= 0 || actuator->cell >= 0);
}

bool strut_read_load(strut_reader *reader, strut_fields *fields, strut_owner owner, void *object) {
  (void)owner;
  strut_place_vector(reader, strut_slot_of(fields, STRUT_KEY_LOAD_FORCE)->value,
                     ((strut_load *)object)->force);
  return true;
}

/* ---- unbalances ---- */

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

bool strut_read_unbalance(strut_reader *reader, strut_fields *fields, strut_owner owner,
                          void *object) {
  strut_unbalance *u = object;
  const strut_slot *speed = strut_slot_of(fields, STRUT_KEY_UNBALANCE_SPEED);
  const strut_slot *signal = strut_slot_of(fields, STRUT_KEY_UNBALANCE_SIGNAL);
  bool fine = speed->state != STRUT_GIVEN || read_speed(reader, speed->value, owner, &u->speed);
  if (speed->state == STRUT_ABSENT && signal->state == STRUT_ABSENT && !fields->broken) {
    strut_report_error(reader, fields->key->place,
                       "%s lacks 'speed', expected one such as '30 Hz', or 'angle' with a signal",
                       strut_owner_text(reader, owner));
    fine = false;
  }
  turn_unbalance(reader, signal, u);
  return fine;
}

/* ---- sliders ---- */

/* Reports the name of a beam, which is no member but makes some. */
static bool is_beam(strut_reader *reader, const strut_tree *value, strut_owner owner) {
  for (size_t i = 0; i < reader->beam_count && value->kind == STRUT_TREE_SCALAR; i++) {
    if (strcmp(reader->beams[i].name, value->text) != 0) continue;
    strut_report_error(reader, value->place,
                       "expected a member for 'member' of %s, found the beam '%s'; name one of its "
                       "bars, such as '%s.1'",
                       strut_owner_text(reader, owner), value->text, value->text);
    return true;
  }
  return false;
}

static double drawn_length(const strut_scene *scene, int32_t member) {
  const int32_t *node = scene->members[member].node;
  if (node[0] < 0 || node[1] < 0) return 0.0;
  return strut_distance(scene->nodes[node[0]].position, scene->nodes[node[1]].position);
}

/* A share of the member, or a length from its first node as drawn, which becomes a share. */
static bool read_position(strut_reader *reader, const strut_tree *value, strut_owner owner,
                          strut_sliding_mass *s) {
  strut_quantity q;
  char found[80];
  if (!strut_read_scalar(reader, value, "position", owner, "a number") ||
      !strut_read_quantity(reader, value, "position", owner, &q))
    return false;
  s->share = q.value;
  if (q.bare || strut_dimension_equal(q.dimension, STRUT_DIM_NONE)) return true;
  if (strut_dimension_equal(q.dimension, STRUT_DIM_LENGTH)) {
    double length = s->member >= 0 ? drawn_length(reader->scene, s->member) : 0.0;
    if (length > 0.0) s->share *= strut_scope_scale(reader, value) / length;
    return length > 0.0;
  }
  strut_report_error(
      reader, value->place,
      "expected a share such as '50 %%', or a length, for 'position' of %s, found %s",
      strut_owner_text(reader, owner), strut_dimension_name(q.dimension, found, sizeof found));
  return false;
}

bool strut_read_slider(strut_reader *reader, strut_fields *fields, strut_owner owner,
                       void *object) {
  strut_sliding_mass *s = object;
  const strut_slot *member = strut_slot_of(fields, STRUT_KEY_SLIDER_MEMBER);
  const strut_slot *position = strut_slot_of(fields, STRUT_KEY_SLIDER_POSITION);
  if (member->state == STRUT_GIVEN && !is_beam(reader, member->value, owner))
    s->member = strut_read_reference(reader, member->value, "member", owner, STRUT_THING_MEMBER);
  bool fine = position->state != STRUT_GIVEN || read_position(reader, position->value, owner, s);
  return fine && s->member >= 0;
}
