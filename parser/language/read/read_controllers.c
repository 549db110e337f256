/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Oscillators, controllers and pipes: the programs of states and signals that they stand for. See reader.h. */
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/programs.h"

static const strut_dimension ANGULAR = {0, 0, -1, 1}; /* rad/s */

static strut_dimension times_seconds(strut_dimension dimension, float power) {
  dimension.s += power;
  return dimension;
}

/* ---- programs ---- */

static strut_instruction read_letter(strut_reader *reader, char letter, va_list *arguments) {
  static const char columns[] = "srxv", operations[] = "+-*/<>it";
  static const strut_column_kind kinds[] = {STRUT_COLUMN_SENSOR, STRUT_COLUMN_SENSOR_RATE,
                                            STRUT_COLUMN_STATE, STRUT_COLUMN_SIGNAL};
  static const strut_operation operation[] = {STRUT_OPERATION_ADD,      STRUT_OPERATION_SUBTRACT,
                                              STRUT_OPERATION_MULTIPLY, STRUT_OPERATION_DIVIDE,
                                              STRUT_OPERATION_MIN,      STRUT_OPERATION_MAX,
                                              STRUT_OPERATION_SIN,      STRUT_OPERATION_TANH};
  const char *column = strchr(columns, letter);
  if (letter == '#') {
    double number = va_arg(*arguments, double);
    strut_dimension dimension = va_arg(*arguments, strut_dimension);
    return (strut_instruction){.operation = STRUT_OPERATION_NUMBER,
                               .number = number,
                               .unit = strut_keep_unit(reader, dimension, NULL)};
  }
  if (!column)
    return (strut_instruction){.operation = operation[strchr(operations, letter) - operations]};
  return (strut_instruction){
      .operation = STRUT_OPERATION_COLUMN,
      .column = {.kind = kinds[column - columns], .item = va_arg(*arguments, int), .other = -1}};
}

static void put(strut_program_builder *self, strut_instruction instruction) {
  if (self->length == self->room) {
    size_t room = 2 * self->room + 64;
    strut_instruction *code = strut_scratch_array(self->reader, room, sizeof *code);
    if (!code) return;
    if (self->length) memcpy(code, self->code, self->length * sizeof *code);
    self->code = code, self->room = room;
  }
  self->code[self->length++] = instruction;
  self->stacked += 1 - (size_t)strut_operation_operands(instruction.operation);
  if (self->stacked > self->most) self->most = self->stacked;
}

void strut_build(strut_program_builder *self, const char *postfix, ...) {
  va_list arguments;
  va_start(arguments, postfix);
  for (; *postfix; postfix++) put(self, read_letter(self->reader, *postfix, &arguments));
  va_end(arguments);
}

strut_program strut_built(const strut_program_builder *self) {
  strut_instruction *code = strut_keep_array(self->reader, self->length, sizeof *code);
  if (code && self->length) memcpy(code, self->code, self->length * sizeof *code);
  return (strut_program){
      .length = code ? self->length : 0, .depth = self->most, .instruction = code};
}

const char *strut_made_name(strut_reader *reader, const strut_tree *key, const char *what,
                            const char *end, const strut_name_map *taken) {
  const char *name = strut_kept_text(reader, "%s_%s", key->text, end);
  strut_column column;
  strut_dimension dimension;
  bool variable = !taken && (strut_find_sensed(reader, name, &column, &dimension) ||
                             strut_parameter_find(reader, name));
  if (!taken) taken = &reader->signal_names;
  if (!variable && strut_name_map_find(taken, name) < 0) return name;
  strut_report_error(reader, key->place, "%s '%s' is called '%s', a name that is taken", what,
                     key->text, name);
  return NULL;
}

/* ---- oscillators ---- */

/* + K sin(other - own - bias); the strength is a frequency or an angular velocity. */
static bool put_coupling(strut_program_builder *self, const strut_tree *key, strut_owner owner,
                         int32_t own, double bias, strut_dimension rate) {
  strut_reader *reader = self->reader;
  int32_t other = strut_find_thing(reader, STRUT_THING_STATE, NULL, key->text);
  strut_quantity q;
  char found[80];
  bool phase = other >= 0 && strut_dimension_equal(reader->state_dimension[other], STRUT_DIM_ANGLE);
  if (!phase || other == own)
    return strut_report_error(
        reader, key->place, "%s is coupled to '%s', which is %s", strut_owner_text(reader, owner),
        strut_sanitised_text(reader, key->text), phase ? "itself" : "no oscillator");
  if (!strut_read_any_quantity(reader, key->next, "coupling", owner, "a number such as '3 rad/s'",
                               &q))
    return false;
  if (!q.bare && !strut_dimension_equal(q.dimension, ANGULAR) &&
      !strut_dimension_equal(q.dimension, STRUT_DIM_FREQUENCY))
    return strut_report_error(
        reader, key->next->place,
        "expected an angular velocity such as '3 rad/s' for the coupling of %s to '%s', found %s",
        strut_owner_text(reader, owner), strut_sanitised_text(reader, key->text),
        strut_dimension_name(q.dimension, found, sizeof found));
  strut_build(self, "#xx-", q.value, rate, other, own);
  if (bias != 0.0) strut_build(self, "#-", bias, STRUT_DIM_ANGLE);
  strut_build(self, "i*+");
  return true;
}

static bool read_feedback(strut_reader *reader, const strut_tree *value, strut_owner owner,
                          strut_program *program, strut_dimension *rate) {
  strut_quantity q;
  if (!value) return true;
  if (!strut_read_signal_program(reader, value, "feedback", owner, program, &q)) return false;
  if (strut_dimension_equal(q.dimension, ANGULAR)) *rate = ANGULAR;
  return q.bare || strut_dimension_equal(q.dimension, *rate) ||
         strut_refuse_dimension(reader, value, "feedback", owner, "an angular velocity",
                                q.dimension);
}

bool strut_read_oscillator(strut_reader *reader, const strut_tree *key, int32_t state) {
  strut_owner owner = {"oscillator", key->text};
  strut_fields fields;
  strut_oscillator o = {0};
  strut_program feedback = {0};
  strut_dimension rate = STRUT_DIM_FREQUENCY;
  strut_program_builder b = {.reader = reader};
  strut_read_fields(reader, STRUT_SECTION_OSCILLATOR, key->next, owner, &fields);
  strut_store(reader, &fields, &o);
  bool fine = read_feedback(reader, o.feedback, owner, &feedback, &rate);
  if (fields.broken) return false;
  strut_build(&b, "#", STRUT_TAU * o.frequency, rate);
  for (const strut_tree *other = o.coupling ? o.coupling->first : NULL; other;
       other = other->next->next)
    fine = put_coupling(&b, other, owner, state, o.bias, rate) && fine;
  for (size_t i = 0; i < feedback.length; i++) put(&b, feedback.instruction[i]);
  if (feedback.length) strut_build(&b, "+");
  reader->scene->states[state].rate = strut_built(&b);
  return fine;
}

/* ---- PID controllers ---- */

void strut_list_controllers(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_CONTROLLERS);
  if (!map || !reader->named) return;
  STRUT_ENTRIES (reader, key, map) {
    if (!strut_check_variable_name(reader, key, "controller")) continue;
    if (strut_name_map_find(&reader->signal_names, key->text) >= 0)
      strut_report_error(reader, key->place, "there is a signal '%s' already", key->text);
    else
      strut_list_signal(reader, key, true);
  }
}

/* A controller, and what its numbers measure. */
typedef struct controller {
  strut_controller keys;
  int32_t state; /* of the integral, or -1 */
  strut_dimension sensed, gained, signal;
} controller;

/* The numbers beside the gain, which decides what the signal measures. */
static bool read_numbers(strut_reader *reader, strut_fields *fields, controller *self) {
  const struct {
    int key;
    strut_dimension dimension;
  } numbers[] = {{STRUT_KEY_CONTROLLER_TARGET, self->sensed},
                 {STRUT_KEY_CONTROLLER_INTEGRAL, times_seconds(self->gained, -1.0f)},
                 {STRUT_KEY_CONTROLLER_DERIVATIVE, times_seconds(self->gained, 1.0f)},
                 {STRUT_KEY_CONTROLLER_LEAST, self->signal},
                 {STRUT_KEY_CONTROLLER_MOST, self->signal}};
  bool fine = true;
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    fine = strut_store_number(reader, fields, numbers[i].key, numbers[i].dimension, &self->keys) &&
           fine;
  return fine;
}

/* gain e + integral I - derivative ds/dt, within the limits if wanted; e = target - s. */
static void put_control(strut_program_builder *self, const controller *c, bool limited) {
  const strut_controller *keys = &c->keys;
  strut_build(self, "##s-*", keys->gain, c->gained, keys->target, c->sensed, keys->sensor);
  if (c->state >= 0)
    strut_build(self, "#x*+", keys->integral, times_seconds(c->gained, -1.0f), c->state);
  if (keys->derivative != 0.0)
    strut_build(self, "#r*-", keys->derivative, times_seconds(c->gained, 1.0f), keys->sensor);
  for (int k = 0; k < 2 && limited; k++)
    if (keys->limited[k]) strut_build(self, k ? "#<" : "#>", keys->limit[k], c->signal);
}

/* The state of the integral, NAME_integral: its rate is the error, less what limits cut off over the gain (no windup). */
static bool add_integral(strut_reader *reader, const strut_tree *key, controller *self) {
  strut_program_builder b = {.reader = reader};
  const char *name = strut_made_name(reader, key, "the integral of controller", "integral", NULL);
  if (!name) return false;
  self->state = strut_add_state(reader, key, name, times_seconds(self->sensed, 1.0f), 0.0);
  strut_build(&b, "#s-", self->keys.target, self->sensed, self->keys.sensor);
  if ((self->keys.limited[0] || self->keys.limited[1]) && self->keys.gain != 0.0) {
    put_control(&b, self, true);
    put_control(&b, self, false);
    strut_build(&b, "-#/+", self->keys.gain, self->gained);
  }
  reader->scene->states[self->state].rate = strut_built(&b);
  return true;
}

static bool check_controller(strut_reader *reader, const strut_tree *key, const controller *self) {
  const strut_sensor *sensor = &reader->scene->sensors[self->keys.sensor];
  const double *limit = self->keys.limit;
  if (self->keys.derivative != 0.0 && !strut_sensor_has_rate(sensor))
    return strut_report_error(
        reader, key->place,
        "controller '%s' takes the derivative of sensor '%s', whose rate is not known", key->text,
        sensor->name);
  if (!self->keys.limited[0] || !self->keys.limited[1] || limit[0] <= limit[1]) return true;
  return strut_report_error(reader, key->place,
                            "'least' of controller '%s' must not be above 'most', found %g and %g",
                            key->text, limit[0], limit[1]);
}

static int32_t read_pid(strut_reader *reader, const strut_tree *key) {
  strut_owner owner = {"controller", key->text};
  strut_fields fields;
  strut_quantity gain;
  controller c = {.keys = {.sensor = -1}, .state = -1};
  strut_program_builder b = {.reader = reader};
  strut_read_fields_of(reader, STRUT_SECTION_CONTROLLER, key, owner, &fields);
  if (strut_slot_of(&fields, STRUT_KEY_CONTROLLER_KIND)->state == STRUT_BROKEN) return -1;
  strut_require(reader, &fields, key->place);
  if (fields.broken) return -1;
  strut_store(reader, &fields, &c.keys);
  if (c.keys.sensor < 0 || reader->things[STRUT_THING_SENSOR].source[c.keys.sensor].broken)
    return -1;
  const strut_tree *value = strut_given(&fields, STRUT_KEY_CONTROLLER_GAIN);
  if (!strut_read_any_quantity(reader, value, "gain", owner, "a number such as '0.5'", &gain))
    return -1;
  const strut_dimension sensed = strut_sensor_dimension(&reader->scene->sensors[c.keys.sensor]);
  const strut_dimension gained = gain.bare ? STRUT_DIM_NONE : gain.dimension;
  c.keys.gain = gain.value, c.sensed = sensed, c.gained = gained;
  c.signal = (strut_dimension){gained.kg + sensed.kg, gained.m + sensed.m, gained.s + sensed.s,
                               gained.angle + sensed.angle};
  if (!read_numbers(reader, &fields, &c) || !check_controller(reader, key, &c)) return -1;
  if (c.keys.integral != 0.0 && !add_integral(reader, key, &c)) return -1;
  put_control(&b, &c, true);
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  signal.program = strut_built(&b);
  signal.every = c.keys.every;
  return strut_add_controller_signal(reader, key, &signal, c.signal, false,
                                     gain.bare ? value : NULL);
}

bool strut_is_relay(const strut_tree *map) {
  const strut_tree *kind = strut_tree_find(map, "kind", NULL);
  return kind && kind->kind == STRUT_TREE_SCALAR && strcmp(kind->text, "relay") == 0;
}

/* ---- relays: controllers that switch between two values ---- */

/* The two values, which measure the same; what that is, the use of the signal decides for plain numbers. */
static bool read_values(strut_reader *reader, strut_fields *fields, strut_relay *relay,
                        strut_quantity *unit) {
  const strut_tree *on = strut_given(fields, STRUT_KEY_RELAY_ON_VALUE),
                   *off = strut_given(fields, STRUT_KEY_RELAY_OFF_VALUE);
  if (!strut_read_any_quantity(reader, on, "on_value", fields->owner, "a number", unit))
    return false;
  relay->on = unit->value;
  if (!off) return true;
  if (!unit->bare)
    return strut_read_number(reader, off, "off_value", fields->owner, unit->dimension,
                             STRUT_WITHIN(ANY), &relay->off);
  if (!strut_read_any_quantity(reader, off, "off_value", fields->owner, "a number", unit))
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
  strut_read_fields_of(reader, STRUT_SECTION_RELAY, key, owner, &fields);
  strut_require(reader, &fields, key->place);
  if (fields.broken || !strut_read_signal_program(reader, of, "of", owner, &signal.program, &input))
    return -1;
  bool fine = strut_store(reader, &fields, &signal);
  for (int k = STRUT_KEY_RELAY_ON_ABOVE; k <= STRUT_KEY_RELAY_OFF_ABOVE; k++)
    fine = strut_store_number(reader, &fields, k, input.bare ? STRUT_DIM_NONE : input.dimension,
                              &signal) &&
           fine;
  fine = read_values(reader, &fields, &signal.relay, &unit) && fine;
  return fine ? strut_add_controller_signal(reader, key, &signal, unit.dimension, unit.bare, NULL)
              : -1;
}

/* Without a known `kind` it is read as a PID controller, which reports the kind. */
int32_t strut_read_controller(strut_reader *reader, const strut_tree *key) {
  if (strut_tree_find(key->next, "network", NULL)) return strut_read_network(reader, key);
  return strut_is_relay(key->next) ? read_relay(reader, key) : read_pid(reader, key);
}

/* ---- pipes ---- */

/*
 * What flows is an internal state, which changes the pressures that both gases would have as drawn. A pipe stands for
 * two sensors of pressure, that state, two signals and two actuators.
 */

size_t strut_pipes_most(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_PIPES);
  return map ? 2 * map->count : 0;
}

/* A sensor of the pressure at one end; its index, or -1. */
static int32_t add_sensor(strut_reader *reader, const strut_tree *key, const char *end,
                          int32_t cell) {
  const char *name = strut_made_name(reader, key, "a part of pipe", end,
                                     &reader->things[STRUT_THING_SENSOR].names);
  if (!name) return -1;
  strut_sensor *sensor = strut_add_thing(reader, STRUT_THING_SENSOR, key, name);
  sensor->kind = STRUT_COLUMN_PRESSURE, sensor->item = cell;
  return (int32_t)(sensor - reader->scene->sensors);
}

/* What has flowed changes the pressure of the drawn area by so much. */
static bool add_signal(strut_reader *reader, const strut_tree *key, const char *end, int32_t cell,
                       int32_t state, double sign) {
  const strut_dimension per_area = {0.0f, -2.0f, 0.0f, 0.0f};
  strut_program_builder b = {.reader = reader};
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  signal.name = strut_made_name(reader, key, "a part of pipe", end, &reader->signal_names);
  if (!signal.name) return false;
  strut_build(&b, "#x*", sign / fabs(strut_cell_drawn(reader->scene, (size_t)cell)), per_area,
              state);
  signal.program = strut_built(&b);
  int32_t index =
      strut_add_controller_signal(reader, key, &signal, STRUT_DIM_STIFFNESS, false, NULL);
  if (index < 0) return false;
  reader->pipe_drives[reader->pipe_drive_count++] = (strut_pipe_drive){key, end, cell, index};
  return true;
}

void strut_add_pipe_drives(strut_reader *reader) {
  for (size_t k = 0; k < reader->pipe_drive_count && reader->scene->actuators; k++) {
    const strut_pipe_drive *drive = &reader->pipe_drives[k];
    const char *name = strut_made_name(reader, drive->key, "a part of pipe", drive->end,
                                       &reader->things[STRUT_THING_ACTUATOR].names);
    if (!name) continue;
    strut_actuator *actuator = strut_add_thing(reader, STRUT_THING_ACTUATOR, drive->key, name);
    actuator->cell = drive->cell, actuator->signal = drive->signal;
  }
}

static bool check_gas(strut_reader *reader, const strut_tree *key, int32_t cell) {
  const strut_cell *c = &reader->scene->cells[cell];
  for (size_t k = 0; k < c->node_count; k++)
    if (c->node[k] < 0) return false; /* reported at the cell */
  if (c->law == STRUT_LAW_ISOTHERMAL) return c->node_count > 2;
  if (!reader->things[STRUT_THING_CELL].source[cell].broken)
    strut_report_error(reader, key->place,
                       "pipe '%s' joins cell '%s', which has no isothermal gas that could flow",
                       key->text, c->name);
  return false;
}

static void read_pipe(strut_reader *reader, const strut_tree *key) {
  strut_owner owner = {"pipe", key->text};
  strut_fields fields;
  strut_pipe pipe = {.cell = {-1, -1}};
  strut_program_builder b = {.reader = reader};
  bool fine = strut_check_variable_name(reader, key, "state");
  strut_read_fields_of(reader, STRUT_SECTION_PIPE, key, owner, &fields);
  strut_require(reader, &fields, key->place);
  if (fields.broken || !fine || !strut_store(reader, &fields, &pipe) || pipe.cell[0] < 0 ||
      pipe.cell[1] < 0)
    return;
  if (pipe.cell[0] == pipe.cell[1]) {
    strut_report_error(reader, key->place, "pipe '%s' joins cell '%s' to itself", key->text,
                       reader->scene->cells[pipe.cell[0]].name);
    return;
  }
  if (!check_gas(reader, key, pipe.cell[0]) || !check_gas(reader, key, pipe.cell[1])) return;
  int32_t from = add_sensor(reader, key, "from", pipe.cell[0]);
  int32_t to = from >= 0 ? add_sensor(reader, key, "to", pipe.cell[1]) : -1;
  if (to < 0) return;
  int32_t state = strut_add_state(reader, key, key->text, STRUT_DIM_MOMENT, 0.0);
  strut_build(&b, "#ss-*", pipe.conductance, STRUT_DIM_CONDUCTANCE, from, to);
  reader->scene->states[state].rate = strut_built(&b);
  if (add_signal(reader, key, "out", pipe.cell[0], state, -1.0))
    add_signal(reader, key, "in", pipe.cell[1], state, 1.0);
}

void strut_read_pipes(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_PIPES);
  if (!map || !reader->scene->sensors || !reader->scene->states) return;
  reader->pipe_drives = strut_scratch_array(reader, 2 * map->count, sizeof *reader->pipe_drives);
  STRUT_ENTRIES (reader, key, reader->pipe_drives ? map : NULL) read_pipe(reader, key);
}
