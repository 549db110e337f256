/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named shapes, the start of a run, and the experiment; stages of a path. See reader.h. */
#include <string.h>

#include "engine/scene/things.h"
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/copies.h"

/* ---- named shapes, and the search for equilibria ---- */

/* Most positions that all configurations may have together, to bound the memory. */
enum { MOST_POSITIONS = 20000000 };

static const strut_owner search_owner = {"the search for equilibria", NULL};

/* One list of nodes; unknown ones are reported and left out. */
static bool read_set(strut_reader *reader, const strut_tree *list, const char *key,
                     strut_owner owner, strut_node_set *set) {
  bool fine = true;
  size_t most = list->count;
  for (const strut_tree *item = list->first; item; item = item->next)
    for (int32_t n = -1; strut_is_pattern(item) && (n = strut_next_match(reader, item, n)) >= 0;)
      most++;
  set->node = strut_keep_array(reader, most, sizeof *set->node);
  if (!set->node) return false;
  for (const strut_tree *item = list->first; item; item = item->next) {
    if (strut_is_pattern(item) && strut_next_match(reader, item, -1) >= 0) {
      for (int32_t n = -1; (n = strut_next_match(reader, item, n)) >= 0;)
        set->node[set->count++] = n;
      continue;
    }
    int32_t node = strut_read_reference(reader, item, key, owner, STRUT_THING_NODE);
    if (node >= 0)
      set->node[set->count++] = node;
    else
      fine = false;
  }
  return fine;
}

bool strut_read_node_sets(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                          strut_node_set **sets, size_t *count) {
  const strut_tree *list = slot->value;
  const char *key = slot->key->text;
  size_t lists = 0, alternatives;
  bool fine = true;
  for (const strut_tree *item = list->first; item; item = item->next)
    if (item->kind == STRUT_TREE_LIST) lists++;
  if (!list->count || (lists && lists != list->count))
    return strut_report_error(
        reader, list->place,
        "expected nodes such as [n1, n2], or a list of such lists, for '%s' of %s, found %s", key,
        strut_owner_text(reader, owner), lists ? "a list of both" : strut_found(reader, list));
  if (!strut_entries(reader, STRUT_KEY_SCENE_NODES)) return false;
  alternatives = lists ? lists : 1;
  *sets = strut_keep_array(reader, alternatives, sizeof **sets);
  if (!*sets) return false;
  *count = alternatives;
  if (!lists) return read_set(reader, list, key, owner, *sets);
  const strut_tree *item = list->first;
  for (size_t i = 0; i < alternatives; i++, item = item->next)
    fine = read_set(reader, item, key, owner, &(*sets)[i]) && fine;
  return fine;
}

/*
 * Is this a key of a configuration rather than a node of that name? If there is such a node, a list of
 * two scalars for `contacts` is its position, and so is anything but a mapping for `shape`.
 */
static bool is_key(strut_reader *reader, const strut_tree *key) {
  const strut_tree *value = key->next;
  if (strut_key_find(STRUT_SECTION_CONFIGURATION, key->text) < 0) return false;
  if (strut_find_thing(reader, STRUT_THING_NODE, NULL, key->text) < 0) return true;
  if (strcmp(key->text, strut_key_at(STRUT_KEY_CONFIGURATION_SHAPE)->name) == 0)
    return value->kind == STRUT_TREE_MAP;
  return value->kind == STRUT_TREE_LIST && value->count &&
         !(value->count == 2 && value->first->kind == STRUT_TREE_SCALAR &&
           value->first->next->kind == STRUT_TREE_SCALAR);
}

/* Reports nodes beside `contacts` or `shape`; true if there are none. */
static bool keys_only(strut_reader *reader, const strut_tree *map, strut_owner owner) {
  bool fine = true;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    if (is_key(reader, key) || strut_find_thing(reader, STRUT_THING_NODE, NULL, key->text) < 0)
      continue;
    fine = strut_report_error(
        reader, key->place,
        "node '%s' of %s belongs in its 'shape', as in {contacts: [...], shape: {%s: ...}}",
        strut_sanitised_text(reader, key->text), strut_owner_text(reader, owner),
        strut_sanitised_text(reader, key->text));
  }
  return fine;
}

static bool read_shape(strut_reader *reader, const strut_tree *map, strut_owner owner,
                       strut_configuration *configuration) {
  return strut_read_node_pairs(reader, map, owner, STRUT_DIM_LENGTH, configuration->position,
                               sizeof *configuration->position);
}

/* `{contacts: ..., shape: ...}` */
static bool read_keys(strut_reader *reader, const strut_tree *map, strut_owner owner,
                      strut_configuration *configuration) {
  strut_fields fields;
  if (!keys_only(reader, map, owner)) return false;
  strut_read_fields(reader, STRUT_SECTION_CONFIGURATION, map, owner, &fields);
  const strut_tree *shape = strut_given(&fields, STRUT_KEY_CONFIGURATION_SHAPE);
  bool fine = strut_store(reader, &fields, configuration) && !fields.broken;
  configuration->shaped = shape != NULL;
  return (!shape || read_shape(reader, shape, owner, configuration)) && fine;
}

bool strut_read_configuration(strut_reader *reader, const strut_tree *key, void *object) {
  strut_configuration *configuration = object;
  const strut_scene *scene = reader->scene;
  strut_owner owner = {"configuration", key->text};
  const strut_tree *value = key->next;
  bool keys = false;
  configuration->position =
      strut_keep_array(reader, scene->node_count, sizeof *configuration->position);
  if (!configuration->position) return false;
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(configuration->position[i], scene->nodes[i].position, sizeof *configuration->position);
  if (value->kind != STRUT_TREE_MAP)
    return strut_report_error(reader, value->place,
                              "expected positions such as {n1: [10 mm, 0]} for %s, found %s",
                              strut_owner_text(reader, owner), strut_found(reader, value));
  for (const strut_tree *tree = value->first; tree; tree = tree->next->next)
    keys |= is_key(reader, tree);
  if (keys) return read_keys(reader, value, owner, configuration);
  configuration->shaped = true; /* `{}` is the drawn shape */
  return read_shape(reader, value, owner, configuration);
}

void strut_read_configurations(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_CONFIGURATIONS);
  size_t nodes = reader->scene->node_count;
  if (!map) return;
  if (map->count <= MOST_POSITIONS / (nodes + 1)) {
    strut_read_things(reader, STRUT_THING_CONFIGURATION);
    return;
  }
  strut_report_error(reader, map->place,
                     "%u configurations of %zu nodes are more than %d positions",
                     (unsigned)map->count, nodes, (int)MOST_POSITIONS);
}

/* The one that a key of the initial state names, itself or through a text parameter; -1: absent, or reported. */
static int32_t find_configuration(strut_reader *reader, int key) {
  const strut_slot *slot = strut_slot_of(&reader->initial, key);
  strut_owner owner = {"the initial state", NULL};
  if (slot->state != STRUT_GIVEN) return -1;
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_CONFIGURATIONS)->state == STRUT_BROKEN) return -1;
  return strut_read_reference(reader, slot->value, slot->key->text, owner,
                              STRUT_THING_CONFIGURATION);
}

void strut_read_search(strut_reader *reader) {
  if (strut_read_section(reader, STRUT_KEY_SCENE_EQUILIBRIA, STRUT_SECTION_EQUILIBRIA,
                         search_owner.kind, &reader->search) &&
      !strut_store(reader, &reader->search, &reader->experiment->search))
    reader->search.broken = true;
}

/* ---- the initial state; solver, run and output ---- */

/* `settle` and `steady` are true, false or a mapping of their own, whose values are of `within`. */
static void read_switch(strut_reader *reader, strut_fields *of, int key, const char *owner,
                        strut_owner within, strut_fields *fields) {
  char expected[100], *e = (char *)reader->experiment;
  const strut_key *k = strut_key_at(key);
  const strut_tree *value = strut_given(of, key);
  if (!value) return;
  bool map = value->kind == STRUT_TREE_MAP;
  int found = map ? 1 : value->quoted ? -1 : strut_switch_find(value->text);
  if (found == 1) strut_store_choice(k, e);
  if (found < 0)
    strut_report_error(reader, value->place, "expected %s, for '%s' of %s, found %s",
                       strut_key_expected(key, expected, sizeof expected), k->name, owner,
                       strut_found(reader, value));
  if (!map) return;
  strut_read_fields(reader, strut_section_below(k), value, within, fields);
  strut_store_fields(reader, fields, e + k->field.offset, k->field.size);
}

/* Positions and velocities: of all nodes first, then of single ones. */
static void read_state(strut_reader *reader, int32_t configuration) {
  strut_scene *scene = reader->scene;
  const strut_tree *positions = strut_given(&reader->initial, STRUT_KEY_INITIAL_POSITIONS),
                   *velocities = strut_given(&reader->initial, STRUT_KEY_INITIAL_VELOCITIES);
  const strut_slot *velocity = strut_slot_of(&reader->initial, STRUT_KEY_INITIAL_VELOCITY);
  for (size_t i = 0; configuration >= 0 && i < scene->node_count; i++)
    memcpy(scene->nodes[i].start, scene->configurations[configuration].position[i],
           sizeof scene->nodes[i].start);
  if (positions && scene->nodes)
    strut_read_node_pairs(reader, positions,
                          (strut_owner){"'positions' of the initial state", NULL}, STRUT_DIM_LENGTH,
                          scene->nodes->start, sizeof *scene->nodes);
  if (velocity->state == STRUT_GIVEN)
    for (size_t i = 0; i < scene->node_count; i++)
      for (int c = 0; c < 2; c++)
        scene->nodes[i].velocity[c] = scene->nodes[i].fixed[c] ? 0.0 : velocity->number[c];
  if (!velocities || !scene->nodes) return;
  strut_read_node_pairs(reader, velocities,
                        (strut_owner){"'velocities' of the initial state", NULL},
                        STRUT_DIM_VELOCITY, scene->nodes->velocity, sizeof *scene->nodes);
}

void strut_read_initial(strut_reader *reader) {
  if (!strut_read_section(reader, STRUT_KEY_SCENE_INITIAL, STRUT_SECTION_INITIAL,
                          "the initial state", &reader->initial))
    return;
  read_state(reader, find_configuration(reader, STRUT_KEY_INITIAL_CONFIGURATION));
  /* An equilibrium determines all positions, and that the structure is at rest. */
  int32_t equilibrium = find_configuration(reader, STRUT_KEY_INITIAL_EQUILIBRIUM);
  if (strut_check_rules(reader, &reader->initial)) reader->scene->start_equilibrium = equilibrium;
  read_switch(reader, &reader->initial, STRUT_KEY_INITIAL_SETTLE, "the initial state",
              (strut_owner){"the settling", NULL}, &reader->settle);
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
    strut_report_error(reader, value->place,
                       "unknown actuator, load or signal '%s' in 'of' of the run%s",
                       strut_sanitised_text(reader, value->text),
                       strut_hint(reader, value->text, driver_name, reader));
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
  strut_experiment *experiment = reader->experiment;
  const strut_tree *of = strut_given(&reader->run, STRUT_KEY_RUN_OF);
  bool broken = false;
  if (!of || !strut_mentions(&reader->run, STRUT_KEY_RUN_PERIODS)) return;
  experiment->period_signal = find_signal_of(reader, of, &broken);
  experiment->period_of = strut_keep_text(reader, of->text);
  if (broken) reader->run.broken = true;
}

/* The length of a window: in periods if the run is in periods, otherwise in seconds. */
static void read_last(strut_reader *reader, strut_fields *fields, int key, double *last) {
  const strut_slot *slot = strut_slot_of(fields, key);
  const strut_slot *periods = strut_slot_of(&reader->run, STRUT_KEY_RUN_PERIODS);
  const strut_slot *duration = strut_slot_of(&reader->run, STRUT_KEY_RUN_DURATION);
  if (slot->state != STRUT_GIVEN) return;
  if (!periods->key && !duration->key) {
    fields->broken = true;
    if (reader->purpose ==
        STRUT_FOR_STATICS) /* otherwise the missing length of the run is reported */
      strut_report_error(reader, slot->key->place,
                         "'last' of %s needs a run with a duration or periods", fields->owner.kind);
    return;
  }
  strut_dimension dimension = periods->key ? STRUT_DIM_NONE : STRUT_DIM_TIME;
  if (!strut_read_number(reader, slot->value, "last", fields->owner, dimension,
                         STRUT_WITHIN(ABOVE_ZERO), last))
    fields->broken = true;
}

static void read_run(strut_reader *reader) {
  strut_experiment *experiment = reader->experiment;
  strut_owner owner = {"the measurement", NULL}, run = {"the run", NULL};
  reader->measure = (strut_fields){.section = STRUT_SECTION_MEASURE};
  if (!strut_read_section(reader, STRUT_KEY_SCENE_RUN, STRUT_SECTION_RUN, run.kind, &reader->run))
    return;
  read_of(reader);
  strut_store(reader, &reader->run, experiment);
  const strut_tree *measure = strut_given(&reader->run, STRUT_KEY_RUN_MEASURE);
  if (measure) {
    strut_read_fields(reader, STRUT_SECTION_MEASURE, measure, owner, &reader->measure);
    read_switch(reader, &reader->measure, STRUT_KEY_MEASURE_STEADY, owner.kind,
                (strut_owner){"the steady state", NULL}, &reader->steady);
    read_last(reader, &reader->measure, STRUT_KEY_MEASURE_LAST, &experiment->measure_last);
    strut_store(reader, &reader->measure, experiment);
    strut_read_quantities(reader, strut_slot_of(&reader->measure, STRUT_KEY_MEASURE_QUANTITIES));
    const strut_slot *by = strut_slot_of(&reader->measure, STRUT_KEY_MEASURE_DERIVATIVES);
    experiment->derivative_count =
        strut_read_derivatives(reader, by, owner, NULL, &experiment->derivatives);
  }
  if (reader->measure.broken) reader->run.broken = true;
  if (reader->run.broken) experiment->duration = experiment->periods = 0.0;
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
  strut_experiment *experiment = reader->experiment;
  strut_owner solver = {"the solver", NULL}, output = {"the output", NULL};
  read_run(reader);
  if (strut_read_section(reader, STRUT_KEY_SCENE_SOLVER, STRUT_SECTION_SOLVER, solver.kind,
                         &reader->solver))
    strut_store(reader, &reader->solver, experiment);
  experiment->accuracy_assumed =
      (reader->purpose == STRUT_FOR_RUN || reader->purpose == STRUT_FOR_RUN_STEP_LATER) &&
      strut_slot_of(&reader->top, STRUT_KEY_SCENE_SOLVER)->state == STRUT_ABSENT;
  if (experiment->accuracy_assumed) experiment->accuracy = STRUT_USUAL_ACCURACY;
  bool named = strut_given(&reader->solver, STRUT_KEY_SOLVER_INTEGRATOR);
  experiment->integrator_named = named && !(experiment->accuracy > 0.0); /* which chooses one */
  choose_settling_step(reader);
  if (!strut_read_section(reader, STRUT_KEY_SCENE_OUTPUT, STRUT_SECTION_OUTPUT, output.kind,
                          &reader->output))
    return;
  strut_store(reader, &reader->output, experiment);
  read_last(reader, &reader->output, STRUT_KEY_OUTPUT_LAST, &experiment->output_last);
}

/* ---- stages of a path ---- */

int32_t strut_read_coordinate(strut_reader *reader, const strut_tree *value, const char *key,
                              strut_owner owner) {
  if (value->kind != STRUT_TREE_SCALAR) {
    strut_refuse_value(reader, value, key, owner, "NODE.x or NODE.y");
    return -1;
  }
  int32_t at = strut_coordinate_find(reader->scene, value->text);
  if (at < 0)
    strut_report_error(
        reader, value->place,
        "unknown coordinate '%s' in '%s' of %s, expected a node with its axis, such as "
        "%s.x",
        strut_sanitised_text(reader, value->text), key, strut_owner_text(reader, owner),
        reader->scene->node_count ? reader->scene->nodes[0].name : "node");
  return at;
}

/* A load, or a list of loads as one text, "p, q"; NULL: reported. */
static const char *read_loads(strut_reader *reader, const strut_tree *value, strut_owner owner) {
  bool list = value->kind == STRUT_TREE_LIST && value->count;
  const char *names = NULL;
  for (const strut_tree *item = list ? value->first : value; item; item = item->next) {
    int32_t load = strut_read_reference(reader, item, "load", owner, STRUT_THING_LOAD);
    if (load < 0) return NULL;
    const char *name = reader->scene->loads[load].name;
    if (names && strut_path_names_load(names, name)) {
      strut_report_error(reader, item->place, "%s names load '%s' twice",
                         strut_owner_text(reader, owner), name);
      return NULL;
    }
    names = names ? strut_arena_format(&reader->scene->arena, "%s, %s", names, name)
                  : strut_arena_text(&reader->scene->arena, name, strlen(name));
    if (!names || !list) break;
  }
  return names;
}

/* What the stage follows, and the dimension of its value; false: reported. */
static bool read_followed(strut_reader *reader, strut_fields *fields, strut_path_stage *stage,
                          strut_dimension *dimension) {
  const strut_tree *load = strut_given(fields, STRUT_KEY_STAGE_LOAD),
                   *over = strut_given(fields, STRUT_KEY_STAGE_OVER),
                   *release = strut_given(fields, STRUT_KEY_STAGE_RELEASE);
  *dimension = STRUT_DIM_NONE;
  if (load) return (stage->load = read_loads(reader, load, fields->owner));
  if (release) return strut_read_coordinate(reader, release, "release", fields->owner) >= 0;
  *dimension = STRUT_DIM_LENGTH;
  int32_t actuator = strut_find_thing(reader, STRUT_THING_ACTUATOR, NULL, over->text);
  if (actuator < 0) return strut_read_coordinate(reader, over, "over", fields->owner) >= 0;
  const strut_actuator *a = &reader->scene->actuators[actuator];
  if (a->member < 0) *dimension = a->hinge >= 0 ? STRUT_DIM_ANGLE : STRUT_DIM_STIFFNESS;
  if (!a->force) return true;
  return strut_report_error(
      reader, over->place,
      "actuator '%s' in 'over' of %s gives a force, which statics leaves out; use a load", a->name,
      strut_owner_text(reader, fields->owner));
}

/* Where it ends: 1 of a load, 0 of a release, else it must be given. */
static bool read_until(strut_reader *reader, strut_fields *fields, strut_dimension dimension,
                       strut_path_stage *stage) {
  const strut_slot *until = strut_slot_of(fields, STRUT_KEY_STAGE_UNTIL);
  bool given = until->state == STRUT_GIVEN;
  stage->until = stage->load ? 1.0 : 0.0;
  return !given || strut_read_number(reader, until->value, "until", fields->owner, dimension,
                                     STRUT_WITHIN(ANY), &stage->until);
}

/* `stop: {NODE.x: LENGTH}` */
static bool read_stop(strut_reader *reader, const strut_tree *map, strut_owner owner,
                      strut_path_stage *stage) {
  stage->stop = -1;
  if (!map) return true;
  if (map->kind != STRUT_TREE_MAP || map->count != 1)
    return strut_refuse_value(reader, map, "stop", owner, "{NODE.x: LENGTH}");
  stage->stop = strut_read_coordinate(reader, map->first, "stop", owner);
  if (stage->stop < 0 ||
      !strut_read_number(reader, map->first->next, "stop", owner, STRUT_DIM_LENGTH,
                         STRUT_WITHIN(ANY), &stage->stop_distance))
    return false;
  if (stage->stop_distance != 0.0) return true;
  return strut_report_error(reader, map->first->next->place,
                            "'stop' of %s is 0, where the stage begins",
                            strut_owner_text(reader, owner));
}

static bool read_stage(strut_reader *reader, const strut_tree *item, int number,
                       strut_path_stage *stage) {
  strut_fields fields;
  strut_dimension dimension;
  strut_owner owner = {strut_scratch_text(reader, "stage %d", number), NULL};
  if (item->kind != STRUT_TREE_MAP)
    return strut_report_error(reader, item->place,
                              "expected a stage such as {load: NAME}, found %s",
                              strut_found(reader, item));
  bool fine = strut_read_object(reader, STRUT_SECTION_STAGE, item, owner, &fields, stage);
  if (fields.broken) return false;
  fine = read_followed(reader, &fields, stage, &dimension) &&
         read_until(reader, &fields, dimension, stage) && fine;
  return read_stop(reader, strut_given(&fields, STRUT_KEY_STAGE_STOP), owner, stage) && fine;
}

/* A release needs a coordinate that supports or earlier stages hold, and a stage before. */
static bool check_releases(strut_reader *reader, const strut_tree *item) {
  const strut_scene *scene = reader->scene;
  const strut_experiment *experiment = reader->experiment;
  bool fine = true;
  uint8_t *held = strut_scratch_array(reader, 2 * scene->node_count, sizeof *held);
  if (!held) return false;
  for (size_t i = 0; i < 2 * scene->node_count; i++) held[i] = scene->nodes[i / 2].fixed[i % 2];
  for (size_t k = 0; item; item = item->next, k++) {
    const strut_path_stage *stage = &experiment->stages[k];
    for (size_t i = 0; i < stage->hold_count; i++) held[stage->hold[i]] = 1;
    int32_t over = stage->over ? strut_coordinate_find(scene, stage->over) : -1;
    if (over >= 0) held[over] = 1;
    if (!stage->release) continue;
    int32_t at = strut_coordinate_find(scene, stage->release);
    if (k == 0 || !held[at])
      fine =
          strut_report_error(reader, item->place, "stage %zu releases '%s', which %s", k + 1,
                             strut_sanitised_text(reader, stage->release),
                             held[at] ? "must have been held in a stage before" : "nothing holds");
    held[at] = 0;
  }
  return fine;
}

/* A stage must not end where the one before of the same load has ended. */
static bool check_ends(strut_reader *reader, const strut_tree *item) {
  const strut_path_stage *stage = reader->experiment->stages;
  for (size_t k = 0; item; item = item->next, k++)
    for (size_t i = k; i-- > 0 && stage[k].load;) {
      if (!stage[i].load || strcmp(stage[i].load, stage[k].load) != 0) continue;
      if (stage[i].until != stage[k].until || stage[i].stop >= 0) break;
      return strut_report_error(
          reader, item->place,
          "stage %zu ends where it starts: stage %zu took load '%s' to %g already", k + 1, i + 1,
          stage[k].load, stage[k].until);
    }
  return true;
}

void strut_read_stages(strut_reader *reader) {
  strut_experiment *experiment = reader->experiment;
  strut_fields path;
  strut_owner owner = {"the path", NULL};
  const strut_tree *value = strut_given(&reader->top, STRUT_KEY_SCENE_PATH);
  if (!value) return;
  if (value->kind != STRUT_TREE_MAP) {
    strut_report_error(reader, value->place, "expected {stages: [...]} for 'path', found %s",
                       strut_found(reader, value));
    return;
  }
  strut_read_fields(reader, STRUT_SECTION_SCENE_PATH, value, owner, &path);
  if (path.broken) return;
  strut_store(reader, &path, experiment);
  const strut_tree *stages = strut_given(&path, STRUT_KEY_SCENE_PATH_STAGES);
  if (!stages) return;
  if (stages->kind != STRUT_TREE_LIST || !stages->count) {
    strut_report_error(reader, stages->place,
                       "expected a list of stages such as [{load: NAME}, {over: NODE.x, until: 1 "
                       "mm}], found %s",
                       strut_found(reader, stages));
    return;
  }
  experiment->stages = strut_keep_array(reader, stages->count, sizeof *experiment->stages);
  bool fine = experiment->stages;
  int number = 0;
  for (const strut_tree *item = stages->first; item && experiment->stages; item = item->next) {
    fine = read_stage(reader, item, number + 1, &experiment->stages[number]) && fine;
    number++;
  }
  fine = fine && check_releases(reader, stages->first) && check_ends(reader, stages->first);
  experiment->stage_count = fine ? (size_t)number : 0;
}
