/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors, signals as expressions of the time, sensors and other signals, and networks of them. See reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/read/csv.h"
#include "parser/language/read/programs.h"
#include "parser/language/read/reuse/copies.h"
#include "parser/language/read/reuse/used_files.h"

strut_dimension strut_sensor_dimension(const strut_sensor *sensor) {
  return strut_column_dimension(strut_sensor_column(sensor).kind);
}

bool strut_check_variable_name(strut_reader *reader, const strut_tree *key, const char *kind) {
  const char *name = strut_local_name(reader, key->text);
  size_t length = strlen(name), word = strspn(name, STRUT_LETTERS STRUT_DIGITS ".");
  if (!strut_read_name(reader, key, kind)) return false;
  if (strchr(STRUT_DIGITS ".", *name) || (word && name[word - 1] == '.')) word = 0;
  bool sensor = strcmp(kind, "sensor") == 0, signal = strcmp(kind, "controller") == 0;
  const char *other =
      strcmp(name, "t") == 0 || strcmp(name, "time") == 0 ? "the time"
      : strut_expression_reserved(name, length)           ? "a function or a constant"
      : strut_parameter_find(reader, name)                ? "a parameter"
      : !signal && strut_name_map_find(&reader->signal_names, name) >= 0 ? "a signal"
      : sensor && strut_name_map_find(&reader->things[STRUT_THING_STATE].names, name) >= 0
          ? "a state"
          : NULL;
  if (word != length)
    strut_report_error(reader, key->place,
                       "'%s' cannot be the name of a %s, since expressions could not read it; "
                       "use letters, digits and '_', and begin with a letter",
                       strut_sanitised_text(reader, name), kind);
  else if (other)
    strut_report_error(reader, key->place,
                       "%s %s cannot be called '%s', which means %s in expressions",
                       strcmp(kind, "oscillator") == 0 ? "an" : "a", kind, name, other);
  else
    return true;
  return false;
}

/* A direction turns with the copy; the scene's sensors know those of the axes only. */
static bool turn_sensor(strut_reader *reader, const strut_tree *place, strut_sensor *sensor) {
  bool reversed;
  strut_column seen = strut_sensor_column(sensor);
  int from = (int)(seen.kind - STRUT_COLUMN_NODE_X) % 2;
  int axis = strut_scope_axis(reader, from, &reversed);
  int turn = axis < 0 ? 0 : axis - from;
  if (sensor->length)
    sensor->of->column.kind = (strut_column_kind)((int)seen.kind + turn);
  else
    sensor->along = (uint32_t)((int)sensor->along + turn);
  if (axis >= 0 && !reversed) return true;
  strut_report_error(
      reader, place->place,
      "sensor '%s' looks along %c, which in this copy points %s; sense a length or an "
      "angle, or sense it outside of the part",
      strut_local_name(reader, sensor->name), "xy"[from],
      axis < 0 ? "along neither axis" : "the other way");
  return false;
}

static bool read_of(strut_reader *reader, const strut_tree *value, strut_owner owner,
                    strut_sensor *sensor) {
  strut_column seen;
  sensor->of = strut_read_column(reader, value, "of", owner, &seen);
  sensor->length = sensor->of != NULL;
  const char *why = sensor->of ? strut_observable_unsensed(seen.kind) : NULL;
  if (why)
    strut_report_error(reader, value->place, "%s cannot see '%s': %s",
                       strut_owner_text(reader, owner), strut_sanitised_text(reader, value->text),
                       why);
  return sensor->of && !why;
}

bool strut_read_sensor(strut_reader *reader, strut_fields *fields, void *object) {
  strut_sensor *sensor = object;
  const strut_tree *along = strut_given(fields, STRUT_KEY_SENSOR_ALONG),
                   *of = strut_given(fields, STRUT_KEY_SENSOR_OF);
  if (fields->broken || (of && !read_of(reader, of, fields->owner, sensor))) return false;
  strut_column_kind kind = strut_sensor_column(sensor).kind;
  bool directed = kind >= STRUT_COLUMN_NODE_X && kind <= STRUT_COLUMN_NODE_VY;
  return !directed || turn_sensor(reader, of ? of : along, sensor);
}

/* ---- expressions ---- */

bool strut_find_sensed(strut_reader *reader, const char *name, strut_column *column,
                       strut_dimension *dimension) {
  int32_t sensor = strut_find_thing(reader, STRUT_THING_SENSOR, NULL, name);
  int32_t state = strut_find_thing(reader, STRUT_THING_STATE, NULL, name);
  if (state >= 0) {
    column->kind = STRUT_COLUMN_STATE, column->item = state;
    *dimension = reader->state_dimension[state];
    return true;
  }
  if (sensor < 0) return false;
  column->kind = STRUT_COLUMN_SENSOR, column->item = sensor;
  *dimension = strut_sensor_dimension(&reader->scene->sensors[sensor]);
  if (reader->things[STRUT_THING_SENSOR].source[sensor].broken)
    dimension->kg = (float)NAN; /* any */
  return true;
}

int strut_find_sensor_rate(strut_reader *reader, strut_piece piece, strut_column *column,
                           strut_dimension *dimension, strut_refusal *refusal) {
  const char *name = strut_piece_text(reader, piece);
  int32_t i = strut_find_thing(reader, STRUT_THING_SENSOR, NULL, name);
  bool broken = i >= 0 && reader->things[STRUT_THING_SENSOR].source[i].broken;
  if (i >= 0 && (broken || strut_sensor_has_rate(&reader->scene->sensors[i]))) {
    column->kind = STRUT_COLUMN_SENSOR_RATE, column->item = i;
    *dimension = strut_sensor_dimension(&reader->scene->sensors[i]);
    dimension->s -= 1.0f;
    if (broken) dimension->kg = (float)NAN; /* any */
    return 1;
  }
  if (i >= 0)
    snprintf(refusal->text, sizeof refusal->text,
             "the rate of sensor '%s' is not known, only those of lengths, angles, positions, "
             "areas and distances",
             name);
  else
    snprintf(refusal->text, sizeof refusal->text, "unknown sensor '%.*s'%s",
             piece.length > 40 ? 40 : (int)piece.length, piece.text,
             strut_hint_of_things(reader, name, STRUT_THING_SENSOR));
  return -1;
}

bool strut_find_variable(strut_reader *reader, strut_piece piece, strut_column *column,
                         strut_dimension *dimension) {
  const char *name = strut_piece_text(reader, piece);
  if (strut_find_sensed(reader, name, column, dimension)) return true;
  if (strut_find_named(reader, &reader->signal_names, NULL, name) < 0) return false;
  column->kind = STRUT_COLUMN_SIGNAL;
  column->item = strut_use_signal(reader, name, dimension);
  return true;
}

strut_piece strut_whole_name(strut_piece owner, strut_piece field) {
  return (strut_piece){owner.text, (size_t)(field.text - owner.text) + field.length};
}

/* A word of an expression that is no parameter. */
static int find_word(strut_reader *reader, strut_piece word, strut_column *column,
                     strut_dimension *dimension, strut_refusal *refusal) {
  const char *name = strut_piece_text(reader, word);
  if (strcmp(name, "t") == 0 || strcmp(name, "time") == 0) {
    column->kind = STRUT_COLUMN_TIME;
    *dimension = STRUT_DIM_TIME;
    return 1;
  }
  if (strut_find_variable(reader, word, column, dimension)) return column->item >= 0 ? 1 : -1;
  const char *hint = strut_hint_of_things(reader, name, STRUT_THING_SENSOR);
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_SENSORS)->state == STRUT_BROKEN) return -1;
  if (!*hint) return 0;
  snprintf(refusal->text, sizeof refusal->text, "unknown sensor '%.*s'%s", (int)word.length,
           word.text, hint);
  return -1;
}

static int find_column(void *context, const char *kind, strut_piece owner, strut_piece field,
                       strut_column *column, strut_dimension *dimension, strut_refusal *refusal) {
  if (!owner.length && !kind) return find_word(context, field, column, dimension, refusal);
  if (kind && strcmp(kind, "rate") == 0)
    return strut_find_sensor_rate(context, owner, column, dimension, refusal);
  if (!kind && strut_find_variable(context, strut_whole_name(owner, field), column, dimension))
    return column->item >= 0 ? 1 : -1;
  snprintf(
      refusal->text, sizeof refusal->text,
      "a signal reads the motion by sensors: write sensors: {NAME: {length: MEMBER}}, and NAME "
      "here");
  return -1;
}

static int find_pair(void *context, strut_piece word, strut_piece first, strut_piece second,
                     strut_column *column, strut_dimension *dimension, strut_refusal *refusal) {
  (void)word, (void)first, (void)second;
  return find_column(context, "node", word, first, column, dimension, refusal);
}

/* Behind a number, t is the time rather than a tonne: 10 Hz*t. */
static int claims_word(void *context, strut_piece word) {
  strut_reader *reader = context;
  if (word.length == 1 && *word.text == 't') return 1;
  int32_t sensor =
      strut_find_thing(reader, STRUT_THING_SENSOR, NULL, strut_piece_text(reader, word));
  return sensor >= 0 ? -1 : 0;
}

bool strut_read_signal_program(strut_reader *reader, const strut_tree *value, const char *key,
                               strut_owner owner, strut_program *program,
                               strut_quantity *quantity) {
  strut_compiler compiler = {.column = find_column, .pair = find_pair, .claims = claims_word};
  if (strut_ends_at_comma(reader, value, key, owner)) return false;
  program->instruction = strut_compile(reader, value, key, owner, &compiler, quantity);
  if (!program->instruction) return false;
  program->length = compiler.length;
  program->depth = compiler.depth;
  return true;
}

/* ---- internal states ---- */

int32_t strut_add_state(strut_reader *reader, const strut_tree *key, const char *name,
                        strut_dimension dimension, double start) {
  strut_internal_state *state =
      strut_add_thing(reader, STRUT_THING_STATE, key, strut_keep_text(reader, name));
  size_t i = (size_t)(state - reader->scene->states);
  state->start = start;
  state->unit = strut_keep_unit(reader, dimension, NULL);
  reader->state_dimension[i] = dimension;
  return (int32_t)i;
}

/* The value at t = 0, whose unit is that of the state. */
static bool read_start(strut_reader *reader, const strut_tree *key, strut_quantity *start) {
  strut_owner owner = {"state", key->text};
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_STATE, key->next, owner, &fields);
  strut_require(reader, &fields, key->place);
  return !fields.broken &&
         strut_read_any_quantity(reader, strut_given(&fields, STRUT_KEY_STATE_START), "start",
                                 owner, "a number such as '0 rad'", start);
}

static bool read_phase(strut_reader *reader, const strut_tree *key, strut_quantity *start) {
  strut_owner owner = {"oscillator", key->text};
  strut_fields fields;
  strut_oscillator o = {.phase = 0.0};
  strut_read_fields_of(reader, STRUT_SECTION_OSCILLATOR, key, owner, &fields);
  strut_require(reader, &fields, key->place);
  bool fine = !fields.broken && strut_store(reader, &fields, &o);
  *start = (strut_quantity){.value = o.phase, .dimension = STRUT_DIM_ANGLE};
  return fine;
}

static void list_states(strut_reader *reader, int of, bool oscillators) {
  const strut_tree *map = strut_entries(reader, of);
  STRUT_ENTRIES (reader, key, map) {
    strut_quantity q = {.bare = true};
    bool fine = strut_check_variable_name(reader, key, oscillators ? "oscillator" : "state");
    fine = (oscillators ? read_phase(reader, key, &q) : read_start(reader, key, &q)) && fine;
    int32_t i =
        strut_add_state(reader, key, key->text, q.bare ? STRUT_DIM_NONE : q.dimension, q.value);
    reader->things[STRUT_THING_STATE].source[i].broken = !fine;
  }
}

void strut_list_states(strut_reader *reader) {
  size_t most = strut_entry_count(reader, STRUT_KEY_SCENE_STATES) +
                strut_entry_count(reader, STRUT_KEY_SCENE_OSCILLATORS) +
                strut_entry_count(reader, STRUT_KEY_SCENE_CONTROLLERS) +
                strut_entry_count(reader, STRUT_KEY_SCENE_PIPES) + 1;
  reader->state_dimension = strut_scratch_array(reader, most, sizeof *reader->state_dimension);
  if (!strut_reserve_things(reader, STRUT_THING_STATE, most) || !reader->state_dimension) return;
  list_states(reader, STRUT_KEY_SCENE_STATES, false);
  list_states(reader, STRUT_KEY_SCENE_OSCILLATORS, true);
}

/* The rate of a state must have its unit per second; of an angle, an angle may be left out. */
static bool read_rate(strut_reader *reader, const strut_tree *key, size_t state) {
  const strut_owner owner = {"state", key->text};
  const strut_tree *rate = strut_tree_find(key->next, "rate", NULL);
  strut_quantity q;
  char expected[80];
  if (!strut_read_signal_program(reader, rate, "rate", owner, &reader->scene->states[state].rate,
                                 &q))
    return false;
  strut_dimension wanted = reader->state_dimension[state];
  wanted.s -= 1.0f;
  strut_dimension plain = wanted;
  plain.angle -= 1.0f;
  bool angle = wanted.angle != 0.0f && strut_dimension_equal(q.dimension, plain);
  return q.bare || angle || strut_dimension_equal(q.dimension, wanted) ||
         strut_refuse_dimension(reader, rate, "rate", owner,
                                strut_dimension_name(wanted, expected, sizeof expected),
                                q.dimension);
}

static void read_rates(strut_reader *reader, int of, bool oscillators) {
  const strut_tree *map = strut_entries(reader, of);
  STRUT_ENTRIES (reader, key, map) {
    int32_t i = strut_name_map_find(&reader->things[STRUT_THING_STATE].names, key->text);
    strut_source *source = i < 0 ? NULL : &reader->things[STRUT_THING_STATE].source[i];
    if (!source || source->broken) continue;
    source->broken =
        !(oscillators ? strut_read_oscillator(reader, key, i) : read_rate(reader, key, (size_t)i));
  }
}

void strut_read_states(strut_reader *reader) {
  read_rates(reader, STRUT_KEY_SCENE_STATES, false);
  read_rates(reader, STRUT_KEY_SCENE_OSCILLATORS, true);
}

/* ---- controllers that are neural networks: each neuron becomes a signal ---- */

enum { LARGEST_FILE = 1 << 20, MOST_NEURONS = 1000, MOST_PASSES = 20000 };

/* The layers of a network as they are read; weights of a neuron stand side by side, the bias last. */
typedef struct network {
  strut_reader *reader;
  const strut_tree *key; /* of the controller */
  strut_network keys;
  double *weight;
  size_t weights, before;        /* before: values of the layer before, and first the inputs */
  size_t neurons, layers, width; /* width: neurons of this layer so far */
  double passes;                 /* evaluations of inputs for one of the output */
  int32_t first, layer; /* signals of the values before, and of this layer's first neuron */
  size_t line;
} network;

static bool fail_network(network *self, const char *what, const char *text) {
  const strut_tree *value = strut_tree_find(self->key->next, "network", NULL);
  return strut_report_error(self->reader, value->place, "network '%s', line %zu: %s%s",
                            strut_sanitised_text(self->reader, value->text), self->line, what,
                            text ? strut_sanitised_text(self->reader, text) : "");
}

static int32_t add_neuron(network *self, const char *end, const strut_signal *signal) {
  strut_signal named = *signal;
  named.name = strut_made_name(self->reader, self->key, "a neuron of controller", end, NULL);
  return named.name ? strut_add_controller_signal(self->reader, self->key, &named, STRUT_DIM_NONE,
                                                  false, NULL)
                    : -1;
}

/* The tanh of bias + w1 x1 + w2 x2 + ... */
static strut_signal make_neuron(const network *self) {
  strut_program_builder b = {.reader = self->reader};
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  strut_build(&b, "#", self->weight[self->before], STRUT_DIM_NONE);
  for (size_t i = 0; i < self->before; i++)
    strut_build(&b, "#v*+", self->weight[i], STRUT_DIM_NONE, self->first + (int32_t)i);
  strut_build(&b, "t");
  signal.program = strut_built(&b);
  return signal;
}

static bool read_weights(network *self, char *line) {
  size_t count = 0;
  char *rest = line;
  for (char *cell; (cell = rest); count++) {
    rest = strchr(cell, ',');
    if (rest) *rest++ = '\0';
    cell += strspn(cell, " \t");
    size_t length = strlen(cell);
    while (length && strchr(" \t\r", cell[length - 1])) cell[--length] = '\0';
    double value;
    if (!strut_csv_number(cell, 0, &value) || !isfinite(value))
      return fail_network(self, "expected a number, found ", *cell ? cell : "nothing");
    if (count <= self->before) self->weight[count] = value;
  }
  if (count == self->before + 1) return true;
  char text[120];
  snprintf(text, sizeof text,
           "%zu numbers, expected %zu: a weight for each of %zu values, and a bias", count,
           self->before + 1, self->before);
  return fail_network(self, text, NULL);
}

/* The neurons so far are the values before those to come. */
static bool end_layer(network *self) {
  if (!self->width) return true;
  self->passes *= (double)self->width;
  if (self->passes > MOST_PASSES)
    return fail_network(self,
                        "the network is too large to be evaluated as signals; give it to strut's "
                        "run step by step from Python",
                        NULL);
  self->first = self->layer, self->before = self->width, self->width = 0, self->layers++;
  return true;
}

/* What the first letter of a line says: '#' that it is a comment, '\0' that it is empty. */
static char first_of(const char *line) {
  char first = line[strspn(line, " \t\r")];
  return first == '\n' ? '\0' : first;
}

/* A damaged file may have NUL bytes, at which a text would end. */
static bool is_text(network *self, const strut_safe_text *text) {
  const char *end = memchr(text->text, '\0', text->length);
  for (const char *c = text->text; end && c < end; c++) self->line += *c == '\n';
  return !end || fail_network(self, "a NUL byte is not allowed; the file is damaged", NULL);
}

/* All neurons of the text; those of the last layer are the last signals. */
static bool read_layers(network *self, char *text) {
  char *next = text;
  for (char *line; (line = next); self->line++) {
    next = strchr(line, '\n');
    if (next) *next++ = '\0';
    char first = first_of(line);
    if (!first && !end_layer(self)) return false;
    if (!first || first == '#') continue;
    line[strcspn(line, "#")] = '\0';
    char end[60];
    if (self->neurons++ == MOST_NEURONS) return fail_network(self, "more than 1000 neurons", NULL);
    if (!read_weights(self, line)) return false;
    strut_signal signal = make_neuron(self);
    snprintf(end, sizeof end, "%zu_%zu", self->layers + 1, self->width + 1);
    int32_t index = add_neuron(self, end, &signal);
    if (index < 0) return false;
    if (self->width++ == 0) self->layer = index;
  }
  if (self->neurons == 0) self->line = 1;
  if (self->neurons == 0) return fail_network(self, "there is no neuron in this file", NULL);
  if (!end_layer(self)) return false;
  for (size_t i = 0; i < self->before && self->keys.last == 1; i++) /* the last layer is linear */
    self->reader->signals[(size_t)self->first + i].program.length--;
  return true;
}

/* Each input is a signal, so that neurons share it. */
static bool read_inputs(network *self, strut_owner owner) {
  strut_reader *reader = self->reader;
  const strut_tree *list = self->keys.inputs;
  if (list->kind != STRUT_TREE_LIST || list->count == 0)
    return strut_refuse_form(reader, STRUT_KEY_NETWORK_INPUTS, list, owner);
  for (const strut_tree *item = list->first; item; item = item->next) {
    strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
    strut_quantity q;
    char end[60];
    if (!strut_read_scalar(reader, item, "inputs", owner, "an expression without unit") ||
        !strut_read_signal_program(reader, item, "inputs", owner, &signal.program, &q))
      return false;
    if (!q.bare && !strut_dimension_equal(q.dimension, STRUT_DIM_NONE)) {
      char found[80];
      return strut_report_error(
          reader, item->place,
          "expected a number without unit for 'inputs' of %s, found %s; divide it by what is usual",
          strut_owner_text(reader, owner), strut_dimension_name(q.dimension, found, sizeof found));
    }
    snprintf(end, sizeof end, "in_%zu", self->before + 1);
    int32_t index = add_neuron(self, end, &signal);
    if (index < 0) return false;
    if (self->before++ == 0) self->first = index;
  }
  return true;
}

/* The output times the scale, whose unit is that of the signal. */
static int32_t add_output(network *self, strut_owner owner) {
  const strut_tree *value = self->keys.scale;
  strut_quantity scale = {.value = 1.0, .bare = true};
  strut_program_builder b = {.reader = self->reader};
  if (self->keys.output > (int64_t)self->before) {
    strut_report_error(self->reader, self->key->place,
                       "controller '%s' is output %d of a network that has %zu", self->key->text,
                       (int)self->keys.output, self->before);
    return -1;
  }
  if (value && !strut_read_any_quantity(self->reader, value, "scale", owner,
                                        "a number such as '5 mm'", &scale))
    return -1;
  strut_dimension dimension = scale.bare ? STRUT_DIM_NONE : scale.dimension;
  strut_build(&b, "#v*", scale.value, dimension, self->first + (int32_t)self->keys.output - 1);
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  signal.program = strut_built(&b);
  signal.every = self->keys.every;
  return strut_add_controller_signal(self->reader, self->key, &signal, dimension, scale.bare,
                                     scale.bare ? value : NULL);
}

int32_t strut_read_network(strut_reader *reader, const strut_tree *key) {
  strut_owner owner = {"controller", key->text};
  strut_fields fields;
  network n = {.reader = reader, .key = key, .keys = {.output = 1}, .passes = 1.0, .line = 1};
  strut_safe_text text = {0};
  strut_read_fields(reader, STRUT_SECTION_NETWORK, key->next, owner, &fields);
  strut_require(reader, &fields, key->place);
  const strut_tree *file = strut_given(&fields, STRUT_KEY_NETWORK_FILE);
  if (fields.broken || !file) return -1;
  strut_store(reader, &fields, &n.keys);
  if (!read_inputs(&n, owner) || !strut_read_file_of(reader, file, LARGEST_FILE, &text)) return -1;
  n.passes = (double)n.before;
  n.weight = strut_scratch_array(reader, n.before + MOST_NEURONS + 1, sizeof *n.weight);
  bool fine = n.weight && is_text(&n, &text) && read_layers(&n, text.text);
  strut_safe_text_free(&text);
  return fine ? add_output(&n, owner) : -1;
}
