/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The initial state; solver, run and output. See reader.h. */
#include <string.h>

#include "parser/read/reader.h"

static void store_start(strut_reader *reader, int32_t node, const double pair[2],
                        const strut_tree *value) {
  (void)value;
  memcpy(reader->scene->nodes[node].start, pair, 2 * sizeof *pair);
}

static void store_velocity(strut_reader *reader, int32_t node, const double pair[2],
                           const strut_tree *value) {
  memcpy(reader->scene->nodes[node].velocity, pair, 2 * sizeof *pair);
  if (reader->velocity_source) reader->velocity_source[node] = value;
}

/*
 * `settle` and `steady` are true, false or a mapping of their own: false where there is no mapping to read.
 */
static bool read_switch(strut_reader *reader, const strut_slot *slot, int key, strut_owner owner,
                        bool *wanted) {
  char expected[100];
  const strut_tree *value = slot->value;
  *wanted = value->kind == STRUT_TREE_MAP;
  if (*wanted) return true;
  int found = value->quoted ? -1 : strut_switch_find(value->text);
  *wanted = found == 1;
  if (found < 0)
    strut_report_error(reader, value->place, "expected %s, for '%s' of %s, found %s",
                       strut_key_expected(key, expected, sizeof expected), strut_key_at(key)->name,
                       owner.kind, strut_found(reader, value));
  return false;
}

static void read_settle(strut_reader *reader, const strut_slot *slot) {
  strut_settle *settle = &reader->experiment->settle;
  strut_owner initial = {"the initial state", NULL}, owner = {"the settling", NULL};
  if (!read_switch(reader, slot, STRUT_KEY_INITIAL_SETTLE, initial, &settle->wanted)) return;
  strut_read_fields(reader, STRUT_SECTION_SETTLE, slot->value, owner, &reader->settle);
  strut_store_fields(reader, &reader->settle, owner, &reader->scene->arena, settle, sizeof *settle);
}

/* Positions and velocities: of all nodes first, then of single ones. */
static void read_state(strut_reader *reader, int32_t configuration) {
  strut_scene *scene = reader->scene;
  const strut_slot *positions = strut_slot_of(&reader->initial, STRUT_KEY_INITIAL_POSITIONS);
  const strut_slot *velocities = strut_slot_of(&reader->initial, STRUT_KEY_INITIAL_VELOCITIES);
  const strut_slot *velocity = strut_slot_of(&reader->initial, STRUT_KEY_INITIAL_VELOCITY);
  for (size_t i = 0; configuration >= 0 && i < scene->node_count; i++)
    memcpy(scene->nodes[i].start, scene->configurations[configuration].position[i],
           sizeof scene->nodes[i].start);
  if (positions->state == STRUT_GIVEN)
    strut_read_node_pairs(reader, positions->value,
                          (strut_owner){"'positions' of the initial state", NULL}, STRUT_DIM_LENGTH,
                          store_start);
  if (velocity->state == STRUT_GIVEN)
    for (size_t i = 0; i < scene->node_count; i++)
      for (int c = 0; c < 2; c++)
        scene->nodes[i].velocity[c] = scene->nodes[i].fixed[c] ? 0.0 : velocity->number[c];
  if (velocities->state != STRUT_GIVEN) return;
  reader->velocity_source = strut_reader_allocate(reader, &reader->scratch, scene->node_count,
                                                  sizeof *reader->velocity_source);
  strut_read_node_pairs(reader, velocities->value,
                        (strut_owner){"'velocities' of the initial state", NULL},
                        STRUT_DIM_VELOCITY, store_velocity);
}

/* An equilibrium determines all positions, and that the structure is at rest. */
static void read_equilibrium(strut_reader *reader) {
  static const int rivals[] = {STRUT_KEY_INITIAL_CONFIGURATION, STRUT_KEY_INITIAL_POSITIONS,
                               STRUT_KEY_INITIAL_SETTLE};
  const strut_slot *equilibrium = strut_slot_of(&reader->initial, STRUT_KEY_INITIAL_EQUILIBRIUM);
  int32_t index = strut_find_configuration(reader, STRUT_KEY_INITIAL_EQUILIBRIUM);
  for (size_t i = 0; equilibrium->key && i < sizeof rivals / sizeof rivals[0]; i++) {
    const strut_slot *rival = strut_slot_of(&reader->initial, rivals[i]);
    if (!rival->key) continue;
    strut_report_error(reader, rival->key->place,
                       "the initial state gives both 'equilibrium' and '%s', expected one of them",
                       rival->key->text);
    return;
  }
  reader->scene->start_equilibrium = index;
}

void strut_read_initial(strut_reader *reader) {
  if (!strut_read_section(reader, STRUT_KEY_SCENE_INITIAL, STRUT_SECTION_INITIAL,
                          "the initial state", &reader->initial))
    return;
  read_state(reader, strut_find_configuration(reader, STRUT_KEY_INITIAL_CONFIGURATION));
  read_equilibrium(reader);
  const strut_slot *settle = strut_slot_of(&reader->initial, STRUT_KEY_INITIAL_SETTLE);
  if (settle->state == STRUT_GIVEN) read_settle(reader, settle);
}

/* Actuators, loads and signals, one after the other, for suggestions. */
static const char *driver_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  const strut_scene *scene = reader->scene;
  if (i < scene->actuator_count) return scene->actuators[i].name;
  i -= scene->actuator_count;
  if (i < scene->load_count) return scene->loads[i].name;
  i -= scene->load_count;
  return i < reader->named_count ? reader->named[i].name : NULL;
}

/* The signal of the actuator or load that `of` names, or the signal of that name. */
static int32_t find_signal_of(strut_reader *reader, const strut_tree *value, bool *broken) {
  const strut_scene *scene = reader->scene;
  int32_t a = strut_find_thing(reader, STRUT_THING_ACTUATOR, NULL, value->text);
  int32_t l = strut_find_thing(reader, STRUT_THING_LOAD, NULL, value->text);
  int32_t s = strut_find_named(reader, &reader->signal_names, NULL, value->text);
  int32_t found[3], count = 0;
  if (a >= 0) found[count++] = scene->actuators[a].signal;
  if (l >= 0 &&
      (scene->loads[l].signal >= 0 || reader->things[STRUT_THING_LOAD].source[l].broken || a < 0))
    found[count++] = scene->loads[l].signal;
  if (s >= 0) found[count++] = reader->named[s].index;
  *broken = true;
  if (!count) {
    const int sections[] = {STRUT_KEY_SCENE_ACTUATORS, STRUT_KEY_SCENE_LOADS,
                            STRUT_KEY_SCENE_SIGNALS};
    for (int i = 0; i < 3; i++)
      if (strut_slot_of(&reader->top, sections[i])->state == STRUT_BROKEN) return -1;
    size_t names = scene->actuator_count + scene->load_count + reader->named_count;
    strut_report_error(reader, value->place,
                       "unknown actuator, load or signal '%s' in 'of' of the run%s",
                       strut_sanitised_text(reader, value->text),
                       strut_hint(reader, value->text, driver_name, reader, names));
    return -1;
  }
  for (int32_t i = 1; i < count; i++)
    if (found[i] != found[0] && found[i] >= 0 && found[0] >= 0) {
      strut_report_error(reader, value->place,
                         "'%s' names several things with different signals; rename one of them",
                         strut_sanitised_text(reader, value->text));
      return -1;
    }
  if (found[0] < 0 && l >= 0 && a < 0 && !reader->things[STRUT_THING_LOAD].source[l].broken) {
    strut_report_error(reader, value->place,
                       "load '%s' has no signal whose periods could be counted",
                       strut_sanitised_text(reader, value->text));
    return -1;
  }
  *broken = found[0] < 0;
  return found[0];
}

static void read_of(strut_reader *reader) {
  strut_experiment *e = reader->experiment;
  const strut_slot *of = strut_slot_of(&reader->run, STRUT_KEY_RUN_OF);
  const strut_slot *periods = strut_slot_of(&reader->run, STRUT_KEY_RUN_PERIODS);
  strut_slot *top = strut_slot_of(&reader->top, STRUT_KEY_SCENE_RUN);
  bool broken = false;
  if (of->state == STRUT_GIVEN && periods->state == STRUT_ABSENT) {
    strut_report_error(reader, of->key->place, "the run gives 'of' without 'periods'");
    reader->run.broken = true;
  } else if (of->state == STRUT_ABSENT && periods->state == STRUT_GIVEN) {
    strut_report_error(
        reader, top->key->place,
        "the run lacks 'of', expected the actuator, load or signal whose periods count");
    reader->run.broken = true;
  } else if (of->state == STRUT_GIVEN) {
    e->period_signal = find_signal_of(reader, of->value, &broken);
    e->period_of = strut_keep_text(reader, of->value->text);
    if (broken) reader->run.broken = true;
  }
}

/* The length of a window: in periods if the run is in periods, otherwise in seconds. */
static void read_last(strut_reader *reader, strut_fields *fields, int key, strut_owner owner,
                      double *last) {
  const strut_slot *slot = strut_slot_of(fields, key);
  const strut_slot *periods = strut_slot_of(&reader->run, STRUT_KEY_RUN_PERIODS);
  const strut_slot *duration = strut_slot_of(&reader->run, STRUT_KEY_RUN_DURATION);
  if (slot->state != STRUT_GIVEN) return;
  if (!periods->key && !duration->key) {
    fields->broken = true;
    if (reader->purpose ==
        STRUT_FOR_STATICS) /* otherwise the missing length of the run is reported */
      strut_report_error(reader, slot->key->place,
                         "'last' of %s needs a run with a duration or periods", owner.kind);
    return;
  }
  strut_dimension dimension = periods->key ? STRUT_DIM_NONE : STRUT_DIM_TIME;
  if (!strut_read_number(reader, slot->value, "last", owner, dimension, STRUT_RANGE_ABOVE_ZERO,
                         last))
    fields->broken = true;
}

static void read_steady(strut_reader *reader, const strut_slot *slot) {
  strut_steady *steady = &reader->experiment->steady;
  strut_owner measurement = {"the measurement", NULL}, owner = {"the steady state", NULL};
  if (!read_switch(reader, slot, STRUT_KEY_MEASURE_STEADY, measurement, &steady->wanted)) return;
  strut_read_fields(reader, STRUT_SECTION_STEADY, slot->value, owner, &reader->steady);
  strut_store_fields(reader, &reader->steady, owner, &reader->scene->arena, steady, sizeof *steady);
}

static void read_run(strut_reader *reader) {
  strut_experiment *e = reader->experiment;
  strut_owner owner = {"the measurement", NULL}, run = {"the run", NULL};
  reader->measure = (strut_fields){.section = STRUT_SECTION_MEASURE};
  if (!strut_read_section(reader, STRUT_KEY_SCENE_RUN, STRUT_SECTION_RUN, run.kind, &reader->run))
    return;
  read_of(reader);
  strut_store_fields(reader, &reader->run, run, &reader->scene->arena, e, sizeof *e);
  const strut_slot *measure = strut_slot_of(&reader->run, STRUT_KEY_RUN_MEASURE);
  if (measure->state == STRUT_GIVEN) {
    strut_read_fields(reader, STRUT_SECTION_MEASURE, measure->value,
                      (strut_owner){"the measurement", NULL}, &reader->measure);
    const strut_slot *steady = strut_slot_of(&reader->measure, STRUT_KEY_MEASURE_STEADY);
    if (steady->state == STRUT_GIVEN) read_steady(reader, steady);
    read_last(reader, &reader->measure, STRUT_KEY_MEASURE_LAST, owner, &e->measure_last);
    strut_store_fields(reader, &reader->measure, owner, &reader->scene->arena, e, sizeof *e);
    strut_read_quantities(reader, strut_slot_of(&reader->measure, STRUT_KEY_MEASURE_QUANTITIES));
  }
  if (reader->measure.broken) reader->run.broken = true;
  if (reader->run.broken) e->duration = e->periods = 0.0;
}

/*
 * Settling uses the file's step even if the run is later given another step, method or accuracy, so that
 * it always ends in the same bits. A step below zero is chosen by the stability limit.
 */
static void choose_settling_step(strut_reader *reader) {
  strut_settle *settle = &reader->experiment->settle;
  if (!settle->wanted) return;
  const strut_slot *step = strut_slot_of(&reader->settle, STRUT_KEY_SETTLE_STEP);
  double given = reader->experiment->step;
  if (step->state == STRUT_GIVEN) given = step->number[0];
  settle->step = given > 0.0 ? given : -1.0;
}

void strut_read_experiment(strut_reader *reader) {
  strut_experiment *e = reader->experiment;
  strut_arena *arena = &reader->scene->arena;
  strut_owner solver = {"the solver", NULL}, output = {"the output", NULL};
  read_run(reader);
  if (strut_read_section(reader, STRUT_KEY_SCENE_SOLVER, STRUT_SECTION_SOLVER, solver.kind,
                         &reader->solver))
    strut_store_fields(reader, &reader->solver, solver, arena, e, sizeof *e);
  choose_settling_step(reader);
  if (!strut_read_section(reader, STRUT_KEY_SCENE_OUTPUT, STRUT_SECTION_OUTPUT, output.kind,
                          &reader->output))
    return;
  strut_store_fields(reader, &reader->output, output, arena, e, sizeof *e);
  read_last(reader, &reader->output, STRUT_KEY_OUTPUT_LAST, output, &e->output_last);
}
