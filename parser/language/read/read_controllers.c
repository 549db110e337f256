/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Oscillators and controllers: the programs of states and signals that they stand for. See reader.h. */
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/program_builder.h"
#include "parser/language/read/reader.h"

/* ---- oscillators ---- */

/* The strength of a coupling: a frequency or an angular velocity. */
static bool read_strength(strut_reader *reader, const strut_tree *key, strut_owner owner,
                          double *strength) {
  strut_dimension angular = {0, 0, -1, 1};
  strut_quantity q;
  char found[80];
  if (!strut_read_scalar(reader, key->next, "coupling", owner, "a number such as '3 rad/s'") ||
      !strut_read_quantity(reader, key->next, "coupling", owner, &q))
    return false;
  *strength = q.value;
  if (q.bare || strut_dimension_equal(q.dimension, angular) ||
      strut_dimension_equal(q.dimension, STRUT_DIM_FREQUENCY))
    return true;
  strut_report_error(reader, key->next->place,
                     "expected an angular velocity such as '3 rad/s' for the coupling of %s to "
                     "'%s', found %s",
                     strut_owner_text(reader, owner), strut_sanitised_text(reader, key->text),
                     strut_dimension_name(q.dimension, found, sizeof found));
  return false;
}

/* + K sin(other - own - bias) */
static bool put_coupling(builder *self, const strut_tree *key, strut_owner owner, int32_t own,
                         double bias, strut_dimension rate) {
  strut_reader *reader = self->reader;
  int32_t other = strut_find_thing(reader, STRUT_THING_STATE, NULL, key->text);
  double strength;
  bool phase = other >= 0 && strut_dimension_equal(reader->state_dimension[other], STRUT_DIM_ANGLE);
  if (!phase || other == own)
    strut_report_error(reader, key->place, "%s is coupled to '%s', which is %s",
                       strut_owner_text(reader, owner), strut_sanitised_text(reader, key->text),
                       phase ? "itself" : "no oscillator");
  if (!phase || other == own || !read_strength(reader, key, owner, &strength)) return false;
  put_number(self, strength, rate);
  put_column(self, STRUT_COLUMN_STATE, other);
  put_column(self, STRUT_COLUMN_STATE, own);
  put_operation(self, STRUT_OPERATION_SUBTRACT);
  if (bias != 0.0) {
    put_number(self, bias, STRUT_DIM_ANGLE);
    put_operation(self, STRUT_OPERATION_SUBTRACT);
  }
  put_operation(self, STRUT_OPERATION_SIN);
  put_operation(self, STRUT_OPERATION_MULTIPLY);
  put_operation(self, STRUT_OPERATION_ADD);
  return true;
}

static bool read_feedback(strut_reader *reader, const strut_tree *value, strut_owner owner,
                          strut_program *program, strut_dimension *rate) {
  strut_quantity q;
  char found[80];
  strut_dimension angular = {0, 0, -1, 1};
  if (!value) return true;
  if (!strut_read_signal_program(reader, value, "feedback", owner, program, &q)) return false;
  if (strut_dimension_equal(q.dimension, angular)) *rate = angular;
  if (q.bare || strut_dimension_equal(q.dimension, *rate)) return true;
  strut_report_error(
      reader, value->place, "expected an angular velocity for 'feedback' of %s, found %s",
      strut_owner_text(reader, owner), strut_dimension_name(q.dimension, found, sizeof found));
  return false;
}

bool strut_read_oscillator(strut_reader *reader, const strut_tree *key, int32_t state) {
  strut_owner owner = {"oscillator", key->text};
  strut_fields fields;
  strut_oscillator o = {0};
  strut_program feedback = {0};
  strut_dimension rate = STRUT_DIM_FREQUENCY;
  builder b;
  strut_read_fields(reader, STRUT_SECTION_OSCILLATOR, key->next, owner, &fields);
  strut_store_fields(reader, &fields, owner, &reader->scratch, &o, sizeof o);
  bool fine = read_feedback(reader, o.feedback, owner, &feedback, &rate);
  size_t couplings = o.coupling ? o.coupling->count : 0;
  if (fields.broken || !begin_program(reader, 2 + 9 * couplings + feedback.length, &b))
    return false;
  put_number(&b, STRUT_TAU * o.frequency, rate);
  const strut_tree *other = couplings ? o.coupling->first : NULL;
  for (; other; other = other->next->next)
    fine = put_coupling(&b, other, owner, state, o.bias, rate) && fine;
  for (size_t i = 0; i < feedback.length; i++) put(&b, feedback.instruction[i]);
  if (feedback.length) put_operation(&b, STRUT_OPERATION_ADD);
  reader->scene->states[state].rate = end_program(&b);
  return fine;
}

/* ---- controllers ---- */

/* A controller, and what its numbers measure. */
typedef struct controller {
  strut_controller keys;
  int32_t state;               /* of the integral, or -1 */
  const strut_tree *bare_gain; /* where it has no unit */
  strut_dimension sensed, gained, signal;
} controller;

void strut_list_controllers(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_CONTROLLERS);
  if (!map || !reader->named) return;
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    bool fine = strut_check_variable_name(reader, key, "controller");
    if (fine && strut_name_map_find(&reader->signal_names, key->text) >= 0) {
      strut_report_error(reader, key->place, "there is a signal '%s' already", key->text);
      fine = false;
    }
    if (!fine) continue;
    reader->named[reader->named_count] =
        (strut_named_signal){key->text, key, STRUT_SIGNAL_UNREAD, -1, true};
    strut_add_name(reader, &reader->signal_names, key->text, reader->named_count++);
  }
}

/* The gain decides what the signal measures. */
static bool read_gain(strut_reader *reader, strut_fields *fields, strut_owner owner,
                      controller *self) {
  strut_quantity q;
  const strut_slot *slot = strut_slot_of(fields, STRUT_KEY_CONTROLLER_GAIN);
  if (!strut_read_scalar(reader, slot->value, "gain", owner, "a number such as '0.5'") ||
      !strut_read_quantity(reader, slot->value, "gain", owner, &q))
    return false;
  self->keys.gain = q.value;
  if (q.bare) self->bare_gain = slot->value;
  self->gained = q.bare ? STRUT_DIM_NONE : q.dimension;
  self->signal =
      (strut_dimension){self->gained.kg + self->sensed.kg, self->gained.m + self->sensed.m,
                        self->gained.s + self->sensed.s, self->gained.angle + self->sensed.angle};
  return true;
}

static bool read_numbers(strut_reader *reader, strut_fields *fields, strut_owner owner,
                         controller *self) {
  if (!read_gain(reader, fields, owner, self)) return false;
  strut_dimension per_second = self->gained, seconds = self->gained;
  per_second.s -= 1.0f, seconds.s += 1.0f;
  const struct {
    int key;
    strut_dimension dimension;
  } numbers[] = {{STRUT_KEY_CONTROLLER_TARGET, self->sensed},
                 {STRUT_KEY_CONTROLLER_INTEGRAL, per_second},
                 {STRUT_KEY_CONTROLLER_DERIVATIVE, seconds},
                 {STRUT_KEY_CONTROLLER_LEAST, self->signal},
                 {STRUT_KEY_CONTROLLER_MOST, self->signal}};
  bool fine = true;
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    fine = strut_store_number(reader, fields, numbers[i].key, owner, numbers[i].dimension,
                              &self->keys) &&
           fine;
  return fine;
}

static void put_error(builder *self, const controller *c) {
  put_number(self, c->keys.target, c->sensed);
  put_column(self, STRUT_COLUMN_SENSOR, c->keys.sensor);
  put_operation(self, STRUT_OPERATION_SUBTRACT);
}

/* gain e + integral I - derivative ds/dt, within the limits if wanted. */
static void put_control(builder *self, const controller *c, bool limited) {
  strut_dimension per_second = c->gained, seconds = c->gained;
  per_second.s -= 1.0f, seconds.s += 1.0f;
  put_number(self, c->keys.gain, c->gained);
  put_error(self, c);
  put_operation(self, STRUT_OPERATION_MULTIPLY);
  if (c->state >= 0) {
    put_number(self, c->keys.integral, per_second);
    put_column(self, STRUT_COLUMN_STATE, c->state);
    put_operation(self, STRUT_OPERATION_MULTIPLY);
    put_operation(self, STRUT_OPERATION_ADD);
  }
  if (c->keys.derivative != 0.0) {
    put_number(self, c->keys.derivative, seconds);
    put_column(self, STRUT_COLUMN_SENSOR_RATE, c->keys.sensor);
    put_operation(self, STRUT_OPERATION_MULTIPLY);
    put_operation(self, STRUT_OPERATION_SUBTRACT);
  }
  for (int k = 0; k < 2 && limited; k++) {
    if (!c->keys.limited[k]) continue;
    put_number(self, c->keys.limit[k], c->signal);
    put_operation(self, k ? STRUT_OPERATION_MIN : STRUT_OPERATION_MAX);
  }
}

enum { MOST_INSTRUCTIONS = 64 };

/* The rate of the integral: the error, less what the limits cut off over the gain (no windup). */
static bool make_integral(strut_reader *reader, const controller *self) {
  builder b;
  if (!begin_program(reader, MOST_INSTRUCTIONS, &b)) return false;
  put_error(&b, self);
  if ((self->keys.limited[0] || self->keys.limited[1]) && self->keys.gain != 0.0) {
    put_control(&b, self, true);
    put_control(&b, self, false);
    put_operation(&b, STRUT_OPERATION_SUBTRACT);
    put_number(&b, self->keys.gain, self->gained);
    put_operation(&b, STRUT_OPERATION_DIVIDE);
    put_operation(&b, STRUT_OPERATION_ADD);
  }
  reader->scene->states[self->state].rate = end_program(&b);
  return true;
}

/* The state of the integral, as NAME_integral. */
static bool add_integral(strut_reader *reader, const strut_tree *key, controller *self) {
  const char *name = strut_arena_format(&reader->scratch, "%s_integral", key->text);
  strut_dimension dimension = self->sensed;
  dimension.s += 1.0f;
  if (!name) reader->out_of_memory = true;
  if (!name) return false;
  if (strut_name_map_find(&reader->things[STRUT_THING_STATE].names, name) >= 0 ||
      strut_name_map_find(&reader->things[STRUT_THING_SENSOR].names, name) >= 0 ||
      strut_name_map_find(&reader->signal_names, name) >= 0 || strut_parameter_find(reader, name)) {
    strut_report_error(reader, key->place,
                       "the integral of controller '%s' is called '%s', a name that is taken",
                       key->text, name);
    return false;
  }
  self->state = strut_add_state(reader, key, name, dimension, 0.0);
  return make_integral(reader, self);
}

static int32_t read_pid(strut_reader *reader, const strut_tree *key) {
  strut_owner owner = {"controller", key->text};
  strut_fields fields;
  controller c = {.keys = {.sensor = -1}, .state = -1};
  builder b;
  strut_read_fields_of(reader, STRUT_SECTION_CONTROLLER, key, owner, &fields);
  if (strut_slot_of(&fields, STRUT_KEY_CONTROLLER_KIND)->state == STRUT_BROKEN) return -1;
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *sensor = strut_slot_of(&fields, STRUT_KEY_CONTROLLER_SENSOR);
  const strut_slot *gain = strut_slot_of(&fields, STRUT_KEY_CONTROLLER_GAIN);
  if (fields.broken || sensor->state != STRUT_GIVEN || gain->state != STRUT_GIVEN) return -1;
  strut_store_fields(reader, &fields, owner, &reader->scratch, &c.keys, sizeof c.keys);
  if (c.keys.sensor < 0 || reader->things[STRUT_THING_SENSOR].source[c.keys.sensor].broken)
    return -1;
  const strut_sensor *sensed = &reader->scene->sensors[c.keys.sensor];
  c.sensed = strut_sensor_dimension(sensed);
  if (!read_numbers(reader, &fields, owner, &c)) return -1;
  if (c.keys.derivative != 0.0 && !strut_sensor_has_rate(sensed)) {
    strut_report_error(
        reader, key->place,
        "controller '%s' takes the derivative of sensor '%s', whose rate is not known", key->text,
        reader->scene->sensors[c.keys.sensor].name);
    return -1;
  }
  if (c.keys.limited[0] && c.keys.limited[1] && c.keys.limit[0] > c.keys.limit[1]) {
    strut_report_error(reader, key->place,
                       "'least' of controller '%s' must not be above 'most', found %g and %g",
                       key->text, c.keys.limit[0], c.keys.limit[1]);
    return -1;
  }
  if (c.keys.integral != 0.0 && !add_integral(reader, key, &c)) return -1;
  if (!begin_program(reader, MOST_INSTRUCTIONS, &b)) return -1;
  put_control(&b, &c, true);
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  signal.program = end_program(&b);
  signal.every = c.keys.every;
  return strut_add_controller_signal(reader, key, &signal, c.signal, false, c.bare_gain);
}

bool strut_is_relay(const strut_tree *map) {
  const strut_tree *kind = map->kind == STRUT_TREE_MAP ? strut_tree_find(map, "kind", NULL) : NULL;
  return kind && kind->kind == STRUT_TREE_SCALAR && strcmp(kind->text, "relay") == 0;
}

/* ---- relays: controllers that switch between two values ---- */

/* The thresholds, in the unit of the input. */
static bool read_thresholds(strut_reader *reader, const strut_tree *key, strut_owner owner,
                            strut_fields *fields, strut_dimension input, strut_signal *relay) {
  static const int pairs[2][2] = {{STRUT_KEY_RELAY_OFF_ABOVE, STRUT_KEY_RELAY_ON_BELOW},
                                  {STRUT_KEY_RELAY_ON_ABOVE, STRUT_KEY_RELAY_OFF_BELOW}};
  const int *pair = pairs[strut_slot_of(fields, STRUT_KEY_RELAY_ON_ABOVE)->state == STRUT_GIVEN];
  if (strut_slot_of(fields, pair[0])->state != STRUT_GIVEN ||
      strut_slot_of(fields, pair[1])->state != STRUT_GIVEN) {
    strut_report_error(reader, key->place,
                       "controller '%s' needs two thresholds: on_above with off_below, or on_below "
                       "with off_above",
                       key->text);
    return false;
  }
  bool fine = strut_store_number(reader, fields, pair[0], owner, input, relay);
  return strut_store_number(reader, fields, pair[1], owner, input, relay) && fine;
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

static int32_t read_relay(strut_reader *reader, const strut_tree *key) {
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
  strut_store_fields(reader, &fields, owner, &reader->scene->arena, &signal, sizeof signal);
  bool fine = read_thresholds(reader, key, owner, &fields,
                              input.bare ? STRUT_DIM_NONE : input.dimension, &signal);
  fine = read_values(reader, owner, &fields, &signal.relay, &unit) && fine;
  return fine ? strut_add_controller_signal(reader, key, &signal, unit.dimension, unit.bare, NULL)
              : -1;
}

/* Without a known `kind` it is read as a PID controller, which reports the kind. */
int32_t strut_read_controller(strut_reader *reader, const strut_tree *key) {
  const strut_tree *map = key->next;
  if (map->kind == STRUT_TREE_MAP && strut_tree_find(map, "network", NULL))
    return strut_read_network(reader, key);
  return strut_is_relay(map) ? read_relay(reader, key) : read_pid(reader, key);
}
