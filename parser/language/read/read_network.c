/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Controllers that are neural networks: each neuron becomes a signal. See reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/read/csv.h"
#include "parser/language/read/program_builder.h"
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

static bool fail_network(network *n, const char *what, const char *text) {
  const strut_tree *value = strut_tree_find(n->key->next, "network", NULL);
  return strut_report_error(n->reader, value->place, "network '%s', line %zu: %s%s",
                            strut_sanitised_text(n->reader, value->text), n->line, what,
                            text ? strut_sanitised_text(n->reader, text) : "");
}

/* A signal of the network with a name of its own. */
static int32_t add_neuron(network *n, const char *name, const strut_signal *signal) {
  strut_reader *reader = n->reader;
  strut_signal named = *signal;
  if (!name) reader->out_of_memory = true;
  if (!name) return -1;
  if (strut_name_map_find(&reader->signal_names, name) >= 0 || strut_parameter_find(reader, name)) {
    strut_report_error(reader, n->key->place,
                       "a neuron of controller '%s' is called '%s', a name that is taken",
                       n->key->text, name);
    return -1;
  }
  named.name = strut_keep_text(reader, name);
  return strut_add_controller_signal(reader, n->key, &named, STRUT_DIM_NONE, false, NULL);
}

/* bias + w1 x1 + w2 x2 + ..., and its tanh unless it is `linear`. */
static bool make_neuron(network *n, const double *weight, bool linear, strut_signal *signal) {
  builder b;
  if (!begin_program(n->reader, 4 * n->before + 2, &b)) return false;
  put_number(&b, weight[n->before], STRUT_DIM_NONE);
  for (size_t i = 0; i < n->before; i++) {
    put_number(&b, weight[i], STRUT_DIM_NONE);
    put_column(&b, STRUT_COLUMN_SIGNAL, n->first + (int32_t)i);
    put_operation(&b, STRUT_OPERATION_MULTIPLY);
    put_operation(&b, STRUT_OPERATION_ADD);
  }
  if (!linear) put_operation(&b, STRUT_OPERATION_TANH);
  *signal = strut_signal_default(STRUT_EXPRESSION);
  signal->program = end_program(&b);
  return true;
}

/* The numbers of a line become a neuron's weights. */
static bool read_weights(network *n, char *line) {
  size_t count = 0;
  char *rest = line;
  for (char *cell; (cell = rest); count++) {
    rest = strchr(cell, ',');
    if (rest) *rest++ = '\0';
    cell += strspn(cell, " \t");
    size_t length = strlen(cell);
    while (length && strchr(" \t\r", cell[length - 1])) cell[--length] = '\0';
    double value;
    if (!strut_csv_number(cell, &value) || !isfinite(value))
      return fail_network(n, "expected a number, found ", *cell ? cell : "nothing");
    if (count <= n->before) n->weight[count] = value;
  }
  if (count == n->before + 1) return true;
  char text[120];
  snprintf(text, sizeof text,
           "%zu numbers, expected %zu: a weight for each of %zu values, and a bias", count,
           n->before + 1, n->before);
  return fail_network(n, text, NULL);
}

/* The neurons so far are the values before those to come. */
static bool end_layer(network *n) {
  if (!n->width) return true;
  n->passes *= (double)n->width;
  if (n->passes > MOST_PASSES)
    return fail_network(n,
                        "the network is too large to be evaluated as signals; give it to strut's "
                        "run step by step from Python",
                        NULL);
  n->first = n->layer, n->before = n->width, n->width = 0, n->layers++;
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
static bool is_text(network *n, const strut_safe_text *text) {
  const char *end = memchr(text->text, '\0', text->length);
  for (const char *c = text->text; end && c < end; c++) n->line += *c == '\n';
  return !end || fail_network(n, "a NUL byte is not allowed; the file is damaged", NULL);
}

/* All neurons of the text; those of the last layer are the last signals. */
static bool read_layers(network *n, char *text) {
  size_t layers = count_layers(text);
  char *next = text;
  for (char *line; (line = next); n->line++) {
    next = strchr(line, '\n');
    if (next) *next++ = '\0';
    char first = first_of(line);
    if (!first && !end_layer(n)) return false;
    if (!first || first == '#') continue;
    line[strcspn(line, "#")] = '\0';
    strut_signal signal;
    bool linear = n->keys.last == 1 && n->layers + 1 == layers;
    if (n->neurons++ == MOST_NEURONS) return fail_network(n, "more than 1000 neurons", NULL);
    if (!read_weights(n, line) || !make_neuron(n, n->weight, linear, &signal)) return false;
    int32_t index = add_neuron(n,
                               strut_arena_format(&n->reader->scratch, "%s_%zu_%zu", n->key->text,
                                                  n->layers + 1, n->width + 1),
                               &signal);
    if (index < 0) return false;
    if (n->width++ == 0) n->layer = index;
  }
  if (n->neurons == 0) n->line = 1;
  if (n->neurons == 0) return fail_network(n, "there is no neuron in this file", NULL);
  return end_layer(n);
}

/* Each input is a signal, so that neurons share it. */
static bool read_inputs(network *n, strut_owner owner) {
  strut_reader *reader = n->reader;
  const strut_tree *list = n->keys.inputs;
  if (list->kind != STRUT_TREE_LIST || list->count == 0)
    return strut_refuse_form(reader, STRUT_KEY_NETWORK_INPUTS, list, owner);
  for (const strut_tree *item = list->first; item; item = item->next) {
    strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
    strut_quantity q;
    char found[80];
    if (!strut_read_scalar(reader, item, "inputs", owner, "an expression without unit") ||
        !strut_read_signal_program(reader, item, "inputs", owner, &signal.program, &q))
      return false;
    if (!q.bare && !strut_dimension_equal(q.dimension, STRUT_DIM_NONE))
      return strut_report_error(
          reader, item->place,
          "expected a number without unit for 'inputs' of %s, found %s; divide it by "
          "what is usual",
          strut_owner_text(reader, owner), strut_dimension_name(q.dimension, found, sizeof found));
    const char *name =
        strut_arena_format(&reader->scratch, "%s_in_%zu", n->key->text, n->before + 1);
    int32_t index = add_neuron(n, name, &signal);
    if (index < 0) return false;
    if (n->before++ == 0) n->first = index;
  }
  return true;
}

/* The output times the scale, whose unit is that of the signal. */
static int32_t add_output(network *n, strut_owner owner) {
  const strut_tree *value = n->keys.scale;
  strut_quantity scale = {.value = 1.0, .bare = true};
  builder b;
  if (n->keys.output > (int64_t)n->before) {
    strut_report_error(n->reader, n->key->place,
                       "controller '%s' is output %d of a network that has %zu", n->key->text,
                       (int)n->keys.output, n->before);
    return -1;
  }
  if (value &&
      !strut_read_any_quantity(n->reader, value, "scale", owner, "a number such as '5 mm'", &scale))
    return -1;
  strut_dimension dimension = scale.bare ? STRUT_DIM_NONE : scale.dimension;
  if (!begin_program(n->reader, 3, &b)) return -1;
  put_number(&b, scale.value, dimension);
  put_column(&b, STRUT_COLUMN_SIGNAL, n->first + (int32_t)n->keys.output - 1);
  put_operation(&b, STRUT_OPERATION_MULTIPLY);
  strut_signal signal = strut_signal_default(STRUT_EXPRESSION);
  signal.program = end_program(&b);
  signal.every = n->keys.every;
  return strut_add_controller_signal(n->reader, n->key, &signal, dimension, scale.bare,
                                     scale.bare ? value : NULL);
}

/* The text of the file that `value` names, relative to the file that says so. */
static bool open_network(network *n, const strut_tree *value, strut_safe_text *text) {
  const strut_diagnostics *d = n->reader->diagnostics;
  const char *from = value->place.file ? d->used[value->place.file - 1].file : d->file;
  const char *folder = strut_folder_of(d->file, &n->reader->scratch);
  strut_error error = {0};
  if (!folder) n->reader->out_of_memory = true;
  if (!folder) return false;
  strut_status status = strut_safe_read(folder, from, value->text, LARGEST_FILE, text, &error);
  if (status == STRUT_NO_MEMORY) n->reader->out_of_memory = true;
  if (status != STRUT_OK && status != STRUT_NO_MEMORY)
    strut_report_error(n->reader, value->place, "%s", error.message);
  return status == STRUT_OK;
}

int32_t strut_read_network(strut_reader *reader, const strut_tree *key) {
  strut_owner owner = {"controller", key->text};
  strut_fields fields;
  network n = {.reader = reader, .key = key, .keys = {.output = 1}, .passes = 1.0, .line = 1};
  strut_safe_text text = {0};
  strut_read_fields(reader, STRUT_SECTION_NETWORK, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *file = strut_slot_of(&fields, STRUT_KEY_NETWORK_FILE);
  if (fields.broken || file->state != STRUT_GIVEN) return -1;
  strut_store(reader, &fields, owner, &n.keys);
  if (!read_inputs(&n, owner) || !open_network(&n, file->value, &text)) return -1;
  n.passes = (double)n.before;
  n.weight = strut_reader_allocate(reader, &reader->scratch, n.before + MOST_NEURONS + 1,
                                   sizeof *n.weight);
  bool fine = n.weight && is_text(&n, &text) && read_layers(&n, text.text);
  strut_safe_text_free(&text);
  return fine ? add_output(&n, owner) : -1;
}
