/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Controllers that are neural networks: each neuron becomes a signal. See reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/read/csv.h"
#include "parser/language/read/reuse/copies.h"
#include "parser/language/read/reuse/used_files.h"

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

/* bias + w1 x1 + w2 x2 + ..., and its tanh unless it is `linear`. */
static strut_signal make_neuron(const network *self, bool linear) {
  strut_program_builder b = {.reader = self->reader};
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  strut_build(&b, "#", self->weight[self->before], STRUT_DIM_NONE);
  for (size_t i = 0; i < self->before; i++)
    strut_build(&b, "#v*+", self->weight[i], STRUT_DIM_NONE, self->first + (int32_t)i);
  if (!linear) strut_build(&b, "t");
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

/* Lines with numbers, in a row, are a layer. */
static size_t count_layers(const char *text) {
  size_t layers = 0;
  bool within = false;
  for (const char *line = text; line; line = strchr(line, '\n')) {
    if (*line == '\n') line++;
    char first = first_of(line);
    if (first == '#') continue;
    layers += first && !within;
    within = first != '\0';
  }
  return layers;
}

/* A damaged file may have NUL bytes, at which a text would end. */
static bool is_text(network *self, const strut_safe_text *text) {
  const char *end = memchr(text->text, '\0', text->length);
  for (const char *c = text->text; end && c < end; c++) self->line += *c == '\n';
  return !end || fail_network(self, "a NUL byte is not allowed; the file is damaged", NULL);
}

/* All neurons of the text; those of the last layer are the last signals. */
static bool read_layers(network *self, char *text) {
  size_t layers = count_layers(text);
  char *next = text;
  for (char *line; (line = next); self->line++) {
    next = strchr(line, '\n');
    if (next) *next++ = '\0';
    char first = first_of(line);
    if (!first && !end_layer(self)) return false;
    if (!first || first == '#') continue;
    line[strcspn(line, "#")] = '\0';
    char end[60];
    bool linear = self->keys.last == 1 && self->layers + 1 == layers;
    if (self->neurons++ == MOST_NEURONS) return fail_network(self, "more than 1000 neurons", NULL);
    if (!read_weights(self, line)) return false;
    strut_signal signal = make_neuron(self, linear);
    snprintf(end, sizeof end, "%zu_%zu", self->layers + 1, self->width + 1);
    int32_t index = add_neuron(self, end, &signal);
    if (index < 0) return false;
    if (self->width++ == 0) self->layer = index;
  }
  if (self->neurons == 0) self->line = 1;
  if (self->neurons == 0) return fail_network(self, "there is no neuron in this file", NULL);
  return end_layer(self);
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
  strut_require(reader, &fields, owner, key->place);
  const strut_tree *file = strut_given(&fields, STRUT_KEY_NETWORK_FILE);
  if (fields.broken || !file) return -1;
  strut_store(reader, &fields, owner, &n.keys);
  if (!read_inputs(&n, owner) || !strut_read_file_of(reader, file, LARGEST_FILE, &text)) return -1;
  n.passes = (double)n.before;
  n.weight = strut_reader_allocate(reader, &reader->scratch, n.before + MOST_NEURONS + 1,
                                   sizeof *n.weight);
  bool fine = n.weight && is_text(&n, &text) && read_layers(&n, text.text);
  strut_safe_text_free(&text);
  return fine ? add_output(&n, owner) : -1;
}
