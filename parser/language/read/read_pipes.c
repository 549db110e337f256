/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Pipes between cells: what flows is an internal state, which changes the pressures that both gases would have as
 * drawn. A pipe stands for two sensors of pressure, that state, two signals and two actuators. See reader.h.
 */
#include <math.h>

#include "parser/language/read/program_builder.h"

size_t strut_pipes_most(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_PIPES);
  return map ? 2 * map->count : 0;
}

/* "NAME_END", unless that is taken; NULL where it was reported. */
static const char *name_of(strut_reader *reader, const strut_tree *key, const char *end,
                           const strut_name_map *taken) {
  const char *name = strut_arena_format(&reader->scratch, "%s_%s", key->text, end);
  if (!name) reader->out_of_memory = true;
  if (!name || strut_name_map_find(taken, name) < 0)
    return name ? strut_keep_text(reader, name) : NULL;
  strut_report_error(reader, key->place, "pipe '%s' calls a part of it '%s', a name that is taken",
                     key->text, name);
  return NULL;
}

/* A sensor of the pressure at one end; its index, or -1. */
static int32_t add_sensor(strut_reader *reader, const strut_tree *key, const char *end,
                          int32_t cell) {
  const char *name = name_of(reader, key, end, &reader->things[STRUT_THING_SENSOR].names);
  if (!name) return -1;
  strut_sensor *sensor = strut_add_thing(reader, STRUT_THING_SENSOR, key, name);
  sensor->kind = STRUT_COLUMN_PRESSURE, sensor->item = cell;
  return (int32_t)(sensor - reader->scene->sensors);
}

/* What has flowed changes the pressure of the drawn area by so much. */
static bool add_signal(strut_reader *reader, const strut_tree *key, const char *end, int32_t cell,
                       int32_t state, double sign) {
  strut_dimension per_area = {0.0f, -2.0f, 0.0f, 0.0f};
  const char *name = name_of(reader, key, end, &reader->signal_names);
  builder b;
  if (!name || !begin_program(reader, 3, &b)) return false;
  put_number(&b, sign / fabs(strut_cell_drawn(reader->scene, (size_t)cell)), per_area);
  put_column(&b, STRUT_COLUMN_STATE, state);
  put_operation(&b, STRUT_OPERATION_MULTIPLY);
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  signal.name = name;
  signal.program = end_program(&b);
  int32_t index =
      strut_add_controller_signal(reader, key, &signal, STRUT_DIM_STIFFNESS, false, NULL);
  if (index < 0) return false;
  reader->pipe_drives[reader->pipe_drive_count++] = (strut_pipe_drive){key, end, cell, index};
  return true;
}

void strut_add_pipe_drives(strut_reader *reader) {
  for (size_t k = 0; k < reader->pipe_drive_count && reader->scene->actuators; k++) {
    const strut_pipe_drive *drive = &reader->pipe_drives[k];
    const char *name =
        name_of(reader, drive->key, drive->end, &reader->things[STRUT_THING_ACTUATOR].names);
    if (!name) continue;
    strut_actuator *actuator = strut_add_thing(reader, STRUT_THING_ACTUATOR, drive->key, name);
    actuator->cell = drive->cell, actuator->signal = drive->signal;
  }
}

/* conductance (p_a - p_b) of the two sensors. */
static bool make_flow(strut_reader *reader, int32_t state, double conductance, int32_t from,
                      int32_t to) {
  builder b;
  strut_dimension flow = STRUT_DIM_CONDUCTANCE;
  if (!begin_program(reader, 5, &b)) return false;
  put_number(&b, conductance, flow);
  put_column(&b, STRUT_COLUMN_SENSOR, from);
  put_column(&b, STRUT_COLUMN_SENSOR, to);
  put_operation(&b, STRUT_OPERATION_SUBTRACT);
  put_operation(&b, STRUT_OPERATION_MULTIPLY);
  reader->scene->states[state].rate = end_program(&b);
  return true;
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
  bool fine = strut_check_variable_name(reader, key, "state");
  strut_read_fields_of(reader, STRUT_SECTION_PIPE, key, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  if (fields.broken || !fine || !strut_store(reader, &fields, owner, &pipe) || pipe.cell[0] < 0 ||
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
  if (make_flow(reader, state, pipe.conductance, from, to) &&
      add_signal(reader, key, "out", pipe.cell[0], state, -1.0))
    add_signal(reader, key, "in", pipe.cell[1], state, 1.0);
}

void strut_read_pipes(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_PIPES);
  if (!map || !reader->scene->sensors || !reader->scene->states) return;
  reader->pipe_drives =
      strut_reader_allocate(reader, &reader->scratch, 2 * map->count, sizeof *reader->pipe_drives);
  if (!reader->pipe_drives) return;
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key))
    read_pipe(reader, key);
}
