/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals, and what they drive: actuators and loads. See reader.h. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/read/programs.h"
#include "parser/language/read/reuse/copies.h"

/* The dimension of a signal under construction. */
typedef struct meaning {
  const strut_dimension *expected; /* NULL: anything */
  strut_dimension dimension;       /* found so far, unless bare */
  bool bare;
} meaning;

/* Appends a signal; returns its index, or -1 where memory is out. */
static int32_t add_signal(strut_reader *reader, const strut_signal *signal, const meaning *self,
                          const strut_tree *value) {
  size_t i = reader->signal_count, states = reader->signal_capacity;
  if (!strut_grow(&reader->signal_state, &states, i, sizeof *reader->signal_state) ||
      !strut_grow(&reader->signals, &reader->signal_capacity, i, sizeof *reader->signals)) {
    reader->out_of_memory = true;
    return -1;
  }
  reader->signal_count++;
  reader->signals[i] = *signal;
  reader->signal_state[i] = (strut_signal_state){self->dimension, self->bare, value, NULL};
  return (int32_t)i;
}

/* A value of the signal: as expected, or of the same dimension as those before it. */
static bool read_value(strut_reader *reader, const strut_tree *value, const char *key,
                       strut_owner owner, meaning *self, double *number) {
  strut_quantity quantity;
  if (self->expected || !self->bare)
    return strut_read_number(reader, value, key, owner,
                             self->expected ? *self->expected : self->dimension, STRUT_WITHIN(ANY),
                             number);
  if (!strut_read_any_quantity(reader, value, key, owner, "a number", &quantity)) return false;
  *number = quantity.value;
  if (strut_dimension_equal(quantity.dimension, STRUT_DIM_LENGTH) && !quantity.bare)
    *number *= strut_scope_scale(reader, value);
  self->bare = quantity.bare;
  self->dimension = quantity.dimension;
  return true;
}

/* A sine, half-sine, square or ramp: its amplitude measures what the user of the signal needs. */
static bool read_wave(strut_reader *reader, strut_section section, const strut_tree *map,
                      strut_owner owner, meaning *self, strut_signal *signal) {
  strut_fields fields;
  strut_read_fields(reader, section, map, owner, &fields);
  strut_require(reader, &fields, map->place);
  bool fine = !fields.broken;
  for (int i = 0; i < strut_section_size(section); i++) {
    const strut_slot *slot = &fields.slot[i];
    const strut_key *key = strut_key_at(strut_section_first(section) + i);
    if (slot->state == STRUT_GIVEN && key->measure == STRUT_MEASURE_CONTEXT)
      fine = read_value(reader, slot->value, key->name, owner, self, &signal->amplitude) && fine;
  }
  strut_store(reader, &fields, signal);
  return fine;
}

static bool read_table(strut_reader *reader, const strut_tree *list, strut_owner owner,
                       meaning *self, strut_signal *signal) {
  double *time = strut_keep_array(reader, list->count, sizeof *time);
  double *value = strut_keep_array(reader, list->count, sizeof *value);
  bool fine = true;
  if (!time || !value) return false;
  for (const strut_tree *point = list->first; point; point = point->next) {
    if (point->kind != STRUT_TREE_LIST || point->count != 2) {
      fine = strut_refuse_value(reader, point, "table", owner, "a point such as [0.1 s, 2]");
      continue;
    }
    size_t i = signal->point_count++;
    fine = strut_read_number(reader, point->first, "table", owner, STRUT_DIM_TIME,
                             STRUT_WITHIN(ANY), &time[i]) &&
           fine;
    fine = read_value(reader, point->first->next, "table", owner, self, &value[i]) && fine;
  }
  signal->time = time;
  signal->value = value;
  return fine;
}

static int32_t read_signal(strut_reader *reader, const strut_tree *value, const char *key,
                           strut_owner owner, const strut_dimension *expected);

static bool read_sum(strut_reader *reader, const strut_tree *list, strut_owner owner, meaning *self,
                     strut_signal *signal) {
  int32_t *terms = strut_keep_array(reader, list->count, sizeof *terms);
  bool fine = terms != NULL;
  for (const strut_tree *item = terms ? list->first : NULL; item; item = item->next) {
    const strut_dimension *expected = self->expected ? self->expected
                                      : self->bare   ? NULL
                                                     : &self->dimension;
    int32_t term = read_signal(reader, item, "sum", owner, expected);
    if (term < 0) {
      fine = false;
      continue;
    }
    terms[signal->term_count++] = term;
    if (!self->expected && self->bare && !reader->signal_state[term].bare) {
      self->bare = false;
      self->dimension = reader->signal_state[term].dimension;
    }
  }
  signal->terms = terms;
  return fine;
}

/* What a signal that has no numbers of its own measures cannot be scaled. */
static bool check_unscaled(strut_reader *reader, const strut_tree *value, const char *what) {
  return strut_scope_scale(reader, value) == 1.0 ||
         strut_report_error(reader, value->place,
                            "the lengths in %s are not scaled, but this copy is; make the size a "
                            "parameter of the part and 'set' it",
                            what);
}

static bool read_expression(strut_reader *reader, const strut_tree *value, strut_owner owner,
                            meaning *self, strut_signal *signal) {
  char wanted[200];
  strut_quantity q;
  if (!strut_read_signal_program(reader, value, "expression", owner, &signal->program, &q))
    return false;
  self->bare = q.bare;
  self->dimension = q.dimension;
  if (!check_unscaled(reader, value, "an expression")) return false;
  if (!self->expected || q.bare || strut_dimension_equal(q.dimension, *self->expected)) return true;
  strut_expected_quantity(reader->signal_quantity, *self->expected, wanted, sizeof wanted);
  return strut_refuse_dimension(reader, value, "expression", owner, wanted, q.dimension);
}

static bool read_data(strut_reader *reader, strut_fields *fields, meaning *self,
                      strut_signal *signal) {
  const strut_slot *data = strut_slot_of(fields, STRUT_KEY_SIGNAL_DATA);
  const strut_slot *over = strut_slot_of(fields, STRUT_KEY_SIGNAL_OVER);
  self->bare = false;
  return strut_read_data_signal(reader, data->value,
                                over->state == STRUT_GIVEN ? over->value : NULL, fields->owner,
                                self->expected, &self->dimension, signal) &&
         check_unscaled(reader, data->value, "data");
}

bool strut_read_trigger(strut_reader *reader, strut_fields *fields, void *object) {
  strut_trigger *trigger = object;
  int key =
      strut_given(fields, STRUT_KEY_STARTS_ABOVE) ? STRUT_KEY_STARTS_ABOVE : STRUT_KEY_STARTS_BELOW;
  if (fields->broken || trigger->item < 0) return false;
  if (!strut_given(fields, STRUT_KEY_STARTS_SENSOR)) return true;
  strut_dimension dimension = strut_sensor_dimension(&reader->scene->sensors[trigger->item]);
  return strut_store_number(reader, fields, key, dimension, trigger);
}

/* A signal written out: a mapping with one key. */
static int32_t read_literal(strut_reader *reader, const strut_tree *map, strut_owner owner,
                            const strut_dimension *expected) {
  meaning m = {expected, STRUT_DIM_NONE, true};
  strut_fields fields;
  const strut_tree *expression = strut_tree_find(map, "expression", NULL);
  if (strut_ends_at_comma(reader, expression, "expression", owner)) return -1;
  strut_read_fields(reader, STRUT_SECTION_SIGNAL, map, owner, &fields);
  int chosen = STRUT_DATA; /* a relay is a controller */
  while (chosen >= 0 && fields.slot[chosen].state != STRUT_GIVEN) chosen--;
  if (chosen < 0) strut_check_rules(reader, &fields);
  if (chosen < 0 || fields.broken) return -1;
  const strut_tree *value = fields.slot[chosen].value;
  strut_signal signal = strut_signal_default((strut_signal_kind)chosen);
  bool fine = strut_store(reader, &fields, &signal);
  if (signal.kind == STRUT_CONSTANT)
    fine = read_value(reader, value, "constant", owner, &m, &signal.amplitude) && fine;
  else if (signal.kind == STRUT_TABLE)
    fine = read_table(reader, value, owner, &m, &signal) && fine;
  else if (signal.kind == STRUT_EXPRESSION)
    fine = read_expression(reader, value, owner, &m, &signal) && fine;
  else if (signal.kind == STRUT_DATA)
    fine = read_data(reader, &fields, &m, &signal) && fine;
  else if (signal.kind == STRUT_SUM)
    fine = read_sum(reader, value, owner, &m, &signal) && fine;
  else
    fine = read_wave(reader, strut_wave_section(signal.kind), value, owner, &m, &signal) && fine;
  if (m.expected) m.bare = false, m.dimension = *m.expected;
  signal.owner = strut_keep_text(reader, strut_owner_text(reader, owner));
  return fine ? add_signal(reader, &signal, &m, value) : -1;
}

static const char *stacked_name(strut_reader *reader, size_t i) {
  return reader->signal_stack[i]->name;
}

/* The signal of that number among the named ones, read when it is first needed. */
static int32_t read_named(strut_reader *reader, strut_named_signal *named) {
  strut_owner owner = {"signal", named->name};
  if (named->state == STRUT_SIGNAL_READ) return named->index;
  if (named->state == STRUT_SIGNAL_READING) {
    size_t first = 0;
    while (reader->signal_stack[first] != named) first++;
    strut_report_error(reader, named->key->place, "%s '%s' contains itself: %s",
                       named->controller ? "controller" : "signal", named->name,
                       strut_format_cycle(reader, stacked_name, first, reader->signal_depth));
    return -1;
  }
  if (reader->signal_depth >= STRUT_DEEPEST_SIGNAL) {
    strut_report_error(reader, named->key->place, "signals are nested more than %d deep",
                       STRUT_DEEPEST_SIGNAL);
    return -1;
  }
  named->state = STRUT_SIGNAL_READING;
  reader->signal_stack[reader->signal_depth++] = named;
  strut_copy *scope = strut_enter_scope(reader, named->key);
  const strut_tree *value = named->key->next;
  bool fine = named->controller || strut_read_name(reader, named->key, "signal");
  int32_t index = named->controller ? strut_read_controller(reader, named->key)
                                    : read_signal(reader, value, named->name, owner, NULL);
  if (index >= 0 && !named->controller && value->kind == STRUT_TREE_SCALAR) {
    /* Another name for a signal: a sum of one term. */
    int32_t *term = strut_keep_array(reader, 1, sizeof *term);
    strut_signal sum = strut_signal_default(STRUT_SUM);
    meaning m = {NULL, reader->signal_state[index].dimension, reader->signal_state[index].bare};
    if (term) *term = index;
    sum.terms = term;
    sum.term_count = 1;
    index = term ? add_signal(reader, &sum, &m, value) : -1;
  }
  reader->scope = scope;
  reader->signal_depth--;
  named->state = STRUT_SIGNAL_READ;
  named->index = fine ? index : -1;
  if (named->index >= 0) reader->signals[index].name = strut_keep_text(reader, named->name);
  return named->index;
}

/* A controller's signal is a number of its sensor's kind where its gain has no unit, which may be a slip. */
static void refuse_gain(strut_reader *reader, const strut_signal_state *state,
                        const strut_tree *value, const char *wanted) {
  char found[80];
  size_t item = reader->diagnostics->count;
  strut_report_error(reader, state->gain->place,
                     "the gain of controller '%s' has no unit, so that its signal is %s, expected "
                     "%s; give it the unit of the signal over that of the sensor",
                     value->text, strut_dimension_name(state->dimension, found, sizeof found),
                     wanted);
  strut_diagnose_note(reader->diagnostics, item, value->place, "the signal is used here");
}

/* May the signal stand where `expected` is needed? Its first use decides for a bare one. */
static bool claim(strut_reader *reader, int32_t index, const strut_tree *value,
                  const strut_dimension *expected) {
  assert(index >= 0 && (size_t)index < reader->signal_count);
  strut_signal_state *state = &reader->signal_state[index];
  char wanted[200], found[80];
  if (!expected) return true;
  if (state->bare) {
    state->bare = false;
    state->dimension = *expected;
  }
  if (strut_dimension_equal(state->dimension, *expected)) return true;
  strut_expected_quantity(reader->signal_quantity, *expected, wanted, sizeof wanted);
  if (state->gain)
    refuse_gain(reader, state, value, wanted);
  else
    strut_report_error(reader, value->place, "expected %s here, but signal '%s' is %s", wanted,
                       value->text, strut_dimension_name(state->dimension, found, sizeof found));
  return false;
}

static int32_t read_signal(strut_reader *reader, const strut_tree *value, const char *key,
                           strut_owner owner, const strut_dimension *expected) {
  if (value->kind == STRUT_TREE_MAP) return read_literal(reader, value, owner, expected);
  if (!strut_read_scalar(reader, value, key, owner, "a signal or the name of one")) return -1;
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_SIGNALS)->state == STRUT_BROKEN) return -1;
  const strut_namespace names = {"signal", &reader->signal_names, strut_row_name,
                                 STRUT_NAMED(reader->named, reader->named_count)};
  int32_t i = strut_read_name_of(reader, value, key, owner, &names);
  if (i < 0) return -1;
  int32_t index = read_named(reader, &reader->named[i]);
  return index >= 0 && claim(reader, index, value, expected) ? index : -1;
}

int32_t strut_use_signal(strut_reader *reader, const char *name, strut_dimension *dimension) {
  int32_t i = strut_find_named(reader, &reader->signal_names, NULL, name);
  int32_t index = i < 0 ? -1 : read_named(reader, &reader->named[i]);
  *dimension = (strut_dimension){.kg = (float)NAN}; /* any, where it could not be read */
  if (index < 0) return -1;
  strut_signal_state *state = &reader->signal_state[index];
  *dimension = state->dimension;
  if (state->bare) dimension->kg = (float)NAN;
  return index;
}

int32_t strut_read_signal(strut_reader *reader, const strut_tree *value, const char *key,
                          strut_owner owner, const strut_dimension *expected) {
  if (value->kind == STRUT_TREE_MAP) owner = strut_owner_within(reader, "signal", owner);
  return read_signal(reader, value, key, owner, expected);
}

void strut_list_signal(strut_reader *reader, const strut_tree *key, bool controller) {
  reader->named[reader->named_count] =
      (strut_named_signal){key->text, key, STRUT_SIGNAL_UNREAD, -1, controller};
  strut_add_name(reader, &reader->signal_names, key->text, reader->named_count++);
}

void strut_list_signals(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_SIGNALS);
  size_t count = (map ? map->count : 0) + strut_entry_count(reader, STRUT_KEY_SCENE_CONTROLLERS);
  if (!count) return;
  reader->named = strut_scratch_array(reader, count, sizeof *reader->named);
  for (const strut_tree *key = map && reader->named ? map->first : NULL; key; key = key->next->next)
    strut_list_signal(reader, key, false);
}

int32_t strut_add_controller_signal(strut_reader *reader, const strut_tree *key,
                                    const strut_signal *signal, strut_dimension dimension,
                                    bool bare, const strut_tree *gain) {
  const meaning m = {NULL, dimension, bare};
  int32_t index = add_signal(reader, signal, &m, key->next);
  if (index >= 0) reader->signal_state[index].gain = gain;
  return index;
}

/* Relays come first, since what is written has no other controllers. */
void strut_read_controllers(strut_reader *reader) {
  for (size_t i = 0; i < 2 * reader->named_count; i++) {
    strut_named_signal *named = &reader->named[i % reader->named_count];
    if (!named->controller || (i < reader->named_count && !strut_is_relay(named->key->next)))
      continue;
    if (read_named(reader, named) < 0) reader->failed = true;
  }
}

void strut_read_signals(strut_reader *reader) {
  for (size_t i = 0; i < reader->named_count; i++) read_named(reader, &reader->named[i]);
}

void strut_keep_signals(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  scene->signals = strut_keep_array(reader, reader->signal_count, sizeof *scene->signals);
  if (!scene->signals) return;
  if (reader->signal_count)
    memcpy(scene->signals, reader->signals, reader->signal_count * sizeof *scene->signals);
  for (size_t i = 0; i < reader->signal_count; i++)
    scene->signals[i].unit = strut_keep_unit(reader, reader->signal_state[i].dimension, "1");
  scene->signal_count = reader->signal_count;
}

/* What drives a structure, beyond the rows: moving supports, actuators, loads, unbalances, sliders. See reader.h. */

/* ---- actuators and loads ---- */

/* What it drives decides what its signal measures: what it adds to a rest length or angle, or a force, or a moment. */
bool strut_read_actuator(strut_reader *reader, strut_fields *fields, void *object) {
  static const int keys[] = {STRUT_KEY_ACTUATOR_SIGNAL, STRUT_KEY_ACTUATOR_FORCE,
                             STRUT_KEY_ACTUATOR_MOMENT};
  strut_actuator *actuator = object;
  bool hinge = strut_mentions(fields, STRUT_KEY_ACTUATOR_HINGE),
       cell = strut_mentions(fields, STRUT_KEY_ACTUATOR_CELL);
  const strut_dimension dimensions[] = {hinge  ? STRUT_DIM_ANGLE
                                        : cell ? STRUT_DIM_STIFFNESS
                                               : STRUT_DIM_LENGTH,
                                        STRUT_DIM_FORCE, STRUT_DIM_MOMENT};
  uint32_t k = 0;
  while (k < 2 && !strut_mentions(fields, keys[k])) k++;
  const strut_tree *signal = fields->broken ? NULL : strut_given(fields, keys[k]);
  actuator->force = k;
  reader->signal_quantity = k == 2 ? "moment" : cell ? "pressure" : NULL;
  if (signal)
    actuator->signal = strut_read_signal(reader, signal, strut_key_at(keys[k])->name, fields->owner,
                                         &dimensions[k]);
  reader->signal_quantity = NULL;
  return actuator->signal >= 0 &&
         (actuator->member >= 0 || actuator->hinge >= 0 || actuator->cell >= 0);
}

bool strut_read_load(strut_reader *reader, strut_fields *fields, void *object) {
  strut_load *load = object;
  const strut_slot *force = strut_slot_of(fields, STRUT_KEY_LOAD_FORCE);
  if (force->key) strut_place_vector(reader, force->value, load->force);
  /* the nodes of a hinge in a mirrored copy change places instead */
  if (strut_scope_flips(reader) && load->member >= 0) load->moment = -load->moment;
  return true;
}

/* ---- unbalances ---- */

/* Turns per second or an angular velocity; a plain number is in rad/s. */
static bool read_speed(strut_reader *reader, const strut_tree *value, strut_owner owner,
                       double *speed) {
  const strut_dimension angular = {0, 0, -1, 1};
  strut_quantity q;
  if (!strut_read_any_quantity(reader, value, "speed", owner, "a number", &q)) return false;
  bool turns = !q.bare && strut_dimension_equal(q.dimension, STRUT_DIM_FREQUENCY);
  *speed = turns ? STRUT_TAU * q.value : q.value;
  if (turns || q.bare || strut_dimension_equal(q.dimension, angular)) return true;
  return strut_refuse_dimension(reader, value, "speed", owner,
                                "a speed such as '30 Hz' or '188 rad/s'", q.dimension);
}

/* The angle counts from the copy's own x, and in a mirrored one clockwise. */
static void turn_unbalance(strut_reader *reader, const strut_slot *signal,
                           strut_unbalance *unbalance) {
  double ahead[2] = {1.0, 0.0};
  if (!reader->scope) return;
  strut_place_vector(reader, NULL, ahead);
  double turn = atan2(ahead[1], ahead[0]);
  bool flips = strut_scope_flips(reader);
  if (flips && signal->state == STRUT_GIVEN)
    strut_report_error(reader, signal->key->place,
                       "the angle of unbalance '%s' is a signal, which cannot turn the other way "
                       "round in a mirrored copy; give a 'speed'",
                       strut_local_name(reader, unbalance->name));
  if (flips) unbalance->speed = -unbalance->speed;
  unbalance->phase = flips ? turn - unbalance->phase : turn + unbalance->phase;
}

bool strut_read_unbalance(strut_reader *reader, strut_fields *fields, void *object) {
  strut_unbalance *unbalance = object;
  const strut_slot *signal = strut_slot_of(fields, STRUT_KEY_UNBALANCE_SIGNAL);
  const strut_tree *speed = strut_given(fields, STRUT_KEY_UNBALANCE_SPEED);
  bool fine = !speed || read_speed(reader, speed, fields->owner, &unbalance->speed);
  turn_unbalance(reader, signal, unbalance);
  return fine;
}

/* ---- sliders ---- */

/* Is it the name of a beam, which is no member but makes some? Then that is reported. */
static bool is_beam(strut_reader *reader, const strut_tree *value, strut_owner owner) {
  for (size_t i = 0; i < reader->beam_count && value->kind == STRUT_TREE_SCALAR; i++)
    if (strcmp(reader->beams[i].name, value->text) == 0)
      return !strut_report_error(reader, value->place,
                                 "expected a member for 'member' of %s, found the beam '%s'; name "
                                 "one of its bars, such as "
                                 "'%s.1'",
                                 strut_owner_text(reader, owner), value->text, value->text);
  return false;
}

static double drawn_length(const strut_scene *scene, int32_t member) {
  const int32_t *node = scene->members[member].node;
  if (node[0] < 0 || node[1] < 0) return 0.0;
  return strut_distance(scene->nodes[node[0]].position, scene->nodes[node[1]].position);
}

/* A share of the member, or a length from its first node as drawn, which becomes a share. */
static bool read_position(strut_reader *reader, const strut_tree *value, strut_owner owner,
                          strut_sliding_mass *mass) {
  strut_quantity q;
  if (!strut_read_any_quantity(reader, value, "position", owner, "a number", &q)) return false;
  mass->share = q.value;
  if (q.bare || strut_dimension_equal(q.dimension, STRUT_DIM_NONE)) return true;
  if (strut_dimension_equal(q.dimension, STRUT_DIM_LENGTH)) {
    double length = mass->member >= 0 ? drawn_length(reader->scene, mass->member) : 0.0;
    if (length > 0.0) mass->share *= strut_scope_scale(reader, value) / length;
    return length > 0.0;
  }
  return strut_refuse_dimension(reader, value, "position", owner,
                                "a share such as '50 %', or a length,", q.dimension);
}

bool strut_read_slider(strut_reader *reader, strut_fields *fields, void *object) {
  strut_sliding_mass *mass = object;
  const strut_tree *member = strut_given(fields, STRUT_KEY_SLIDER_MEMBER),
                   *position = strut_given(fields, STRUT_KEY_SLIDER_POSITION);
  if (member && !is_beam(reader, member, fields->owner))
    mass->member =
        strut_read_reference(reader, member, "member", fields->owner, STRUT_THING_MEMBER);
  bool fine = !position || read_position(reader, position, fields->owner, mass);
  return fine && mass->member >= 0;
}
