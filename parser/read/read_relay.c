/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Relays: controllers that switch between two values. See reader.h. */
#include <string.h>

#include "parser/read/reader.h"

/* The thresholds, in the unit of the input. */
static bool read_thresholds(strut_reader *reader, const strut_tree *key, strut_owner owner,
                            strut_fields *fields, strut_dimension input, strut_relay *relay) {
  static const int rising[2] = {STRUT_KEY_RELAY_OFF_ABOVE, STRUT_KEY_RELAY_ON_ABOVE};
  static const int falling[2] = {STRUT_KEY_RELAY_ON_BELOW, STRUT_KEY_RELAY_OFF_BELOW};
  relay->on_above = strut_slot_of(fields, STRUT_KEY_RELAY_ON_ABOVE)->state == STRUT_GIVEN;
  const strut_slot *up = strut_slot_of(fields, rising[relay->on_above]);
  const strut_slot *down = strut_slot_of(fields, falling[relay->on_above]);
  if (up->state != STRUT_GIVEN || down->state != STRUT_GIVEN) {
    strut_report_error(reader, key->place,
                       "controller '%s' needs two thresholds: on_above with off_below, or on_below "
                       "with off_above",
                       key->text);
    return false;
  }
  bool fine = strut_read_number(reader, up->value, strut_key_at(rising[relay->on_above])->name,
                                owner, input, STRUT_RANGE_ANY, &relay->upper);
  return strut_read_number(reader, down->value, strut_key_at(falling[relay->on_above])->name, owner,
                           input, STRUT_RANGE_ANY, &relay->lower) &&
         fine;
}

/* The two values, which measure the same; what that is, the use of the signal decides for plain numbers. */
static bool read_values(strut_reader *reader, strut_owner owner, strut_fields *fields,
                        strut_relay *relay, strut_quantity *unit) {
  const strut_slot *on = strut_slot_of(fields, STRUT_KEY_RELAY_ON_VALUE);
  const strut_slot *off = strut_slot_of(fields, STRUT_KEY_RELAY_OFF_VALUE);
  if (!strut_read_scalar(reader, on->value, "on_value", owner, "a number") ||
      !strut_read_quantity(reader, on->value, "on_value", owner, unit))
    return false;
  relay->on = unit->value;
  if (off->state != STRUT_GIVEN) return true;
  if (!unit->bare)
    return strut_read_number(reader, off->value, "off_value", owner, unit->dimension,
                             STRUT_RANGE_ANY, &relay->off);
  if (!strut_read_scalar(reader, off->value, "off_value", owner, "a number") ||
      !strut_read_quantity(reader, off->value, "off_value", owner, unit))
    return false;
  relay->off = unit->value;
  return true;
}

int32_t strut_read_relay(strut_reader *reader, const strut_tree *key) {
  strut_owner owner = {"controller", key->text};
  strut_fields fields;
  strut_signal signal = strut_signal_default(STRUT_RELAY);
  strut_quantity input, unit = {.bare = true};
  const strut_tree *of = strut_tree_find(key->next, "of", NULL);
  if (strut_ends_at_comma(reader, of, "of", owner)) return -1;
  strut_read_fields(reader, STRUT_SECTION_RELAY, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  if (fields.broken || !of ||
      strut_slot_of(&fields, STRUT_KEY_RELAY_ON_VALUE)->state != STRUT_GIVEN)
    return -1;
  if (!strut_read_signal_program(reader, of, "of", owner, &signal.program, &input)) return -1;
  strut_store_fields(reader, &fields, &reader->scene->arena, &signal.relay, sizeof signal.relay);
  bool fine = read_thresholds(reader, key, owner, &fields,
                              input.bare ? STRUT_DIM_NONE : input.dimension, &signal.relay);
  fine = read_values(reader, owner, &fields, &signal.relay, &unit) && fine;
  const strut_slot *every = strut_slot_of(&fields, STRUT_KEY_RELAY_EVERY);
  if (every->state == STRUT_GIVEN) signal.every = every->number[0];
  return fine ? strut_add_controller_signal(reader, key, &signal, unit.dimension, unit.bare, NULL)
              : -1;
}
