/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Oscillators and controllers: the programs of states and signals that they stand for. See reader.h. */
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/read/reader.h"

/* A program under construction. */
typedef struct builder {
  strut_reader *reader;
  strut_instruction *code; /* in the scene's memory */
  size_t length, room, stacked, most;
} builder;

static bool begin_program(strut_reader *reader, size_t room, builder *b) {
  *b = (builder){.reader = reader, .room = room};
  b->code = strut_reader_allocate(reader, &reader->scene->arena, room, sizeof *b->code);
  return b->code != NULL;
}

static void put(builder *b, strut_instruction p) {
  if (b->length == b->room) return;
  b->code[b->length++] = p;
  b->stacked += 1 - (size_t)strut_operation_operands(p.operation);
  if (b->stacked > b->most) b->most = b->stacked;
}

static void put_number(builder *b, double number, strut_dimension dimension) {
  char unit[STRUT_SUFFIX_TEXT];
  strut_dimension_suffix(dimension, unit, sizeof unit);
  put(b, (strut_instruction){.operation = STRUT_OPERATION_NUMBER,
                             .number = number,
                             .unit = *unit ? strut_keep_text(b->reader, unit) : NULL});
}

static void put_column(builder *b, strut_column_kind kind, int32_t item) {
  put(b, (strut_instruction){.operation = STRUT_OPERATION_COLUMN,
                             .column = {.kind = kind, .item = item, .other = -1}});
}

static void put_operation(builder *b, strut_operation operation) {
  put(b, (strut_instruction){.operation = operation});
}

static strut_program end_program(const builder *b) {
  return (strut_program){.length = b->length, .depth = b->most, .instruction = b->code};
}

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
static bool put_coupling(builder *b, const strut_tree *key, strut_owner owner, int32_t own,
                         double bias, strut_dimension rate) {
  strut_reader *reader = b->reader;
  int32_t other = strut_find_named(reader, &reader->state_names, NULL, key->text);
  double strength;
  bool phase = other >= 0 && strut_dimension_equal(reader->state_dimension[other], STRUT_DIM_ANGLE);
  if (!phase || other == own)
    strut_report_error(reader, key->place, "%s is coupled to '%s', which is %s",
                       strut_owner_text(reader, owner), strut_sanitised_text(reader, key->text),
                       phase ? "itself" : "no oscillator");
  if (!phase || other == own || !read_strength(reader, key, owner, &strength)) return false;
  put_number(b, strength, rate);
  put_column(b, STRUT_COLUMN_STATE, other);
  put_column(b, STRUT_COLUMN_STATE, own);
  put_operation(b, STRUT_OPERATION_SUBTRACT);
  if (bias != 0.0) {
    put_number(b, bias, STRUT_DIM_ANGLE);
    put_operation(b, STRUT_OPERATION_SUBTRACT);
  }
  put_operation(b, STRUT_OPERATION_SIN);
  put_operation(b, STRUT_OPERATION_MULTIPLY);
  put_operation(b, STRUT_OPERATION_ADD);
  return true;
}

static bool read_feedback(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                          strut_program *program, strut_dimension *rate) {
  strut_quantity q;
  char found[80];
  strut_dimension angular = {0, 0, -1, 1};
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  if (!strut_read_signal_program(reader, slot->value, "feedback", owner, program, &q)) return false;
  if (strut_dimension_equal(q.dimension, angular)) *rate = angular;
  if (q.bare || strut_dimension_equal(q.dimension, *rate)) return true;
  strut_report_error(
      reader, slot->value->place, "expected an angular velocity for 'feedback' of %s, found %s",
      strut_owner_text(reader, owner), strut_dimension_name(q.dimension, found, sizeof found));
  return false;
}

bool strut_read_oscillator(strut_reader *reader, const strut_tree *key, int32_t state) {
  strut_owner owner = {"oscillator", key->text};
  strut_fields fields;
  strut_program feedback = {0};
  strut_dimension rate = STRUT_DIM_FREQUENCY;
  builder b;
  strut_read_fields(reader, STRUT_SECTION_OSCILLATOR, key->next, owner, &fields);
  const strut_slot *coupling = strut_slot_of(&fields, STRUT_KEY_OSCILLATOR_COUPLING);
  const strut_slot *bias = strut_slot_of(&fields, STRUT_KEY_OSCILLATOR_BIAS);
  const strut_slot *frequency = strut_slot_of(&fields, STRUT_KEY_OSCILLATOR_FREQUENCY);
  bool fine = read_feedback(reader, strut_slot_of(&fields, STRUT_KEY_OSCILLATOR_FEEDBACK), owner,
                            &feedback, &rate);
  size_t couplings = coupling->state == STRUT_GIVEN ? coupling->value->count : 0;
  if (fields.broken || !begin_program(reader, 2 + 9 * couplings + feedback.length, &b))
    return false;
  put_number(&b, STRUT_TAU * frequency->number[0], rate);
  const strut_tree *other = couplings ? coupling->value->first : NULL;
  for (; other; other = other->next->next)
    fine = put_coupling(&b, other, owner, state, bias->state == STRUT_GIVEN ? bias->number[0] : 0.0,
                        rate) &&
           fine;
  for (size_t i = 0; i < feedback.length; i++) put(&b, feedback.instruction[i]);
  if (feedback.length) put_operation(&b, STRUT_OPERATION_ADD);
  reader->scene->states[state].rate = end_program(&b);
  return fine;
}

/* ---- controllers ---- */

/* The numbers of a controller, and what they measure. */
typedef struct controller {
  int32_t sensor, state; /* state: of the integral, or -1 */
  double target, gain, integral, derivative, limit[2], every;
  bool limited[2];
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

/* A number of the controller; absent ones stay as they are. */
static bool read_part(strut_reader *reader, strut_fields *fields, int key, strut_owner owner,
                      strut_dimension dimension, double *number) {
  const strut_slot *slot = strut_slot_of(fields, key);
  return slot->state != STRUT_GIVEN ||
         strut_read_number(reader, slot->value, strut_key_at(key)->name, owner, dimension,
                           STRUT_RANGE_ANY, number);
}

/* The gain decides what the signal measures. */
static bool read_gain(strut_reader *reader, strut_fields *fields, strut_owner owner,
                      controller *c) {
  strut_quantity q;
  const strut_slot *slot = strut_slot_of(fields, STRUT_KEY_CONTROLLER_GAIN);
  if (!strut_read_scalar(reader, slot->value, "gain", owner, "a number such as '0.5'") ||
      !strut_read_quantity(reader, slot->value, "gain", owner, &q))
    return false;
  c->gain = q.value;
  if (q.bare) c->bare_gain = slot->value;
  c->gained = q.bare ? STRUT_DIM_NONE : q.dimension;
  c->signal = (strut_dimension){c->gained.kg + c->sensed.kg, c->gained.m + c->sensed.m,
                                c->gained.s + c->sensed.s, c->gained.angle + c->sensed.angle};
  return true;
}

static bool read_numbers(strut_reader *reader, strut_fields *fields, strut_owner owner,
                         controller *c) {
  if (!read_gain(reader, fields, owner, c)) return false;
  strut_dimension per_second = c->gained, seconds = c->gained;
  per_second.s -= 1.0f, seconds.s += 1.0f;
  bool fine = read_part(reader, fields, STRUT_KEY_CONTROLLER_TARGET, owner, c->sensed, &c->target);
  fine =
      read_part(reader, fields, STRUT_KEY_CONTROLLER_INTEGRAL, owner, per_second, &c->integral) &&
      fine;
  fine =
      read_part(reader, fields, STRUT_KEY_CONTROLLER_DERIVATIVE, owner, seconds, &c->derivative) &&
      fine;
  for (int k = 0; k < 2; k++) {
    int key = k ? STRUT_KEY_CONTROLLER_MOST : STRUT_KEY_CONTROLLER_LEAST;
    c->limited[k] = strut_slot_of(fields, key)->state == STRUT_GIVEN;
    fine = read_part(reader, fields, key, owner, c->signal, &c->limit[k]) && fine;
  }
  const strut_slot *every = strut_slot_of(fields, STRUT_KEY_CONTROLLER_EVERY);
  if (every->state == STRUT_GIVEN) c->every = every->number[0];
  return fine;
}

static void put_error(builder *b, const controller *c) {
  put_number(b, c->target, c->sensed);
  put_column(b, STRUT_COLUMN_SENSOR, c->sensor);
  put_operation(b, STRUT_OPERATION_SUBTRACT);
}

/* gain e + integral I - derivative ds/dt, within the limits if wanted. */
static void put_control(builder *b, const controller *c, bool limited) {
  strut_dimension per_second = c->gained, seconds = c->gained;
  per_second.s -= 1.0f, seconds.s += 1.0f;
  put_number(b, c->gain, c->gained);
  put_error(b, c);
  put_operation(b, STRUT_OPERATION_MULTIPLY);
  if (c->state >= 0) {
    put_number(b, c->integral, per_second);
    put_column(b, STRUT_COLUMN_STATE, c->state);
    put_operation(b, STRUT_OPERATION_MULTIPLY);
    put_operation(b, STRUT_OPERATION_ADD);
  }
  if (c->derivative != 0.0) {
    put_number(b, c->derivative, seconds);
    put_column(b, STRUT_COLUMN_SENSOR_RATE, c->sensor);
    put_operation(b, STRUT_OPERATION_MULTIPLY);
    put_operation(b, STRUT_OPERATION_SUBTRACT);
  }
  for (int k = 0; k < 2 && limited; k++) {
    if (!c->limited[k]) continue;
    put_number(b, c->limit[k], c->signal);
    put_operation(b, k ? STRUT_OPERATION_MIN : STRUT_OPERATION_MAX);
  }
}

enum { MOST_INSTRUCTIONS = 64 };

/* The rate of the integral: the error, less what the limits cut off over the gain (no windup). */
static bool make_integral(strut_reader *reader, const controller *c) {
  builder b;
  if (!begin_program(reader, MOST_INSTRUCTIONS, &b)) return false;
  put_error(&b, c);
  if ((c->limited[0] || c->limited[1]) && c->gain != 0.0) {
    put_control(&b, c, true);
    put_control(&b, c, false);
    put_operation(&b, STRUT_OPERATION_SUBTRACT);
    put_number(&b, c->gain, c->gained);
    put_operation(&b, STRUT_OPERATION_DIVIDE);
    put_operation(&b, STRUT_OPERATION_ADD);
  }
  reader->scene->states[c->state].rate = end_program(&b);
  return true;
}

/* The state of the integral, as NAME_integral. */
static bool add_integral(strut_reader *reader, const strut_tree *key, controller *c) {
  const char *name = strut_arena_format(&reader->scratch, "%s_integral", key->text);
  strut_dimension dimension = c->sensed;
  dimension.s += 1.0f;
  if (!name) reader->out_of_memory = true;
  if (!name) return false;
  if (strut_name_map_find(&reader->state_names, name) >= 0 ||
      strut_name_map_find(&reader->sensor_names, name) >= 0 ||
      strut_name_map_find(&reader->signal_names, name) >= 0 || strut_parameter_find(reader, name)) {
    strut_report_error(reader, key->place,
                       "the integral of controller '%s' is called '%s', a name that is taken",
                       key->text, name);
    return false;
  }
  c->state = strut_add_state(reader, key, name, dimension, 0.0);
  return make_integral(reader, c);
}

static int32_t read_pid(strut_reader *reader, const strut_tree *key) {
  strut_owner owner = {"controller", key->text};
  strut_fields fields;
  controller c = {.state = -1};
  builder b;
  strut_read_fields(reader, STRUT_SECTION_CONTROLLER, key->next, owner, &fields);
  if (strut_slot_of(&fields, STRUT_KEY_CONTROLLER_KIND)->state == STRUT_BROKEN) return -1;
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *sensor = strut_slot_of(&fields, STRUT_KEY_CONTROLLER_SENSOR);
  const strut_slot *gain = strut_slot_of(&fields, STRUT_KEY_CONTROLLER_GAIN);
  if (fields.broken || sensor->state != STRUT_GIVEN || gain->state != STRUT_GIVEN) return -1;
  c.sensor =
      strut_read_reference(reader, sensor->value, "sensor", owner, "sensor", &reader->sensor_names,
                           strut_sensor_name, reader->scene->sensor_count);
  if (c.sensor < 0 || reader->sensor_source[c.sensor].broken) return -1;
  strut_sensor_kind kind = reader->scene->sensors[c.sensor].kind;
  c.sensed = strut_sensor_dimension(kind);
  if (!read_numbers(reader, &fields, owner, &c)) return -1;
  if (c.derivative != 0.0 && !strut_sensor_has_rate(kind)) {
    strut_report_error(
        reader, key->place,
        "controller '%s' takes the derivative of sensor '%s', whose rate is not known", key->text,
        reader->scene->sensors[c.sensor].name);
    return -1;
  }
  if (c.limited[0] && c.limited[1] && c.limit[0] > c.limit[1]) {
    strut_report_error(reader, key->place,
                       "'least' of controller '%s' must not be above 'most', found %g and %g",
                       key->text, c.limit[0], c.limit[1]);
    return -1;
  }
  if (c.integral != 0.0 && !add_integral(reader, key, &c)) return -1;
  if (!begin_program(reader, MOST_INSTRUCTIONS, &b)) return -1;
  put_control(&b, &c, true);
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  signal.program = end_program(&b);
  signal.every = c.every;
  return strut_add_controller_signal(reader, key, &signal, c.signal, false, c.bare_gain);
}

bool strut_is_relay(const strut_tree *map) {
  const strut_tree *kind = map->kind == STRUT_TREE_MAP ? strut_tree_find(map, "kind", NULL) : NULL;
  return kind && kind->kind == STRUT_TREE_SCALAR && strcmp(kind->text, "relay") == 0;
}

/* Without `kind`, or with one that is none, it is a PID controller, whose keys say so. */
int32_t strut_read_controller(strut_reader *reader, const strut_tree *key) {
  return strut_is_relay(key->next) ? strut_read_relay(reader, key) : read_pid(reader, key);
}
