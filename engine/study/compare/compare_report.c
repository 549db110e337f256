/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table and the CSV of a comparison. */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"

enum {
  LABELS = 24, /* width of the column of labels */
  NARROWEST = 11,
  WIDEST = 26,
  DIGITS = 4,
  CELL = 80,
  MOST_STATES = 8,
  MOST_DIFFERENCES = 30,
  MOST_TEXT = 60
};

/* ---- cells ---- */

static void cell_text(strut_compare_quantity quantity, const strut_compare_cell *cell,
                      char text[CELL]) {
  const char *unit = strut_compare_row_of(quantity).unit;
  double v = cell->value;
  if (!isfinite(v))
    snprintf(text, CELL, "-");
  else if (!*unit)
    snprintf(text, CELL, "%.0f", v);
  else if (quantity == STRUT_COMPARE_DUTY || quantity == STRUT_COMPARE_VELOCITY_ERROR)
    snprintf(text, CELL, "%.3g %%", 100.0 * v);
  else if (strcmp(unit, "1") == 0)
    snprintf(text, CELL, "%.4g", v);
  else if (strcmp(unit, "kg") == 0)
    snprintf(text, CELL, "%s", strut_quantity_of(1000.0 * v, DIGITS, "g").text);
  else if (strcmp(unit, "1/s") == 0)
    snprintf(text, CELL, "%s", strut_quantity_of(v, 3, "").text);
  else
    snprintf(text, CELL, "%s",
             strut_quantity_of(v, quantity == STRUT_COMPARE_CPU ? 2 : DIGITS,
                               strcmp(unit, "s/s") == 0 ? "s" : unit)
                 .text);
}

/* Letters of a UTF-8 text, as a terminal's columns. */
static int letters(const char *text) {
  int count = 0;
  for (; *text; text++) count += ((unsigned char)*text & 0xC0) != 0x80;
  return count;
}

/* Cut to `most` letters, the last a dot where that is not all; padded on the left to `width`. */
static void add_right(strut_buffer *to, const char *text, int width) {
  int count = letters(text), most = width - 1;
  strut_buffer_add(to, "%*s", count > most ? 1 : width - count, "");
  for (int shown = 0; *text; text++) {
    bool first = ((unsigned char)*text & 0xC0) != 0x80;
    if (first && count > most && shown == most - 1) {
      strut_buffer_add(to, "~");
      return;
    }
    shown += first;
    strut_buffer_add(to, "%c", *text);
  }
}

static int column_width(const strut_compare_column *c) {
  int width = letters(c->input->label) + 2;
  for (int i = 0; i < STRUT_COMPARE_QUANTITIES; i++) {
    char text[CELL];
    cell_text((strut_compare_quantity)i, &c->cell[i], text);
    if (letters(text) + 2 > width) width = letters(text) + 2;
  }
  return width < NARROWEST ? NARROWEST : width > WIDEST ? WIDEST : width;
}

/* A row is row_info where some structure has it. */
static bool has_values(const strut_compare *r, int row) {
  for (size_t i = 0; i < r->count; i++)
    if (isfinite(r->columns[i].cell[row].value)) return true;
  return false;
}

/* The names that the scenes have, by label. */
static void add_scene_names(strut_buffer *to, const strut_compare *r) {
  int width = 0;
  for (size_t i = 0; i < r->count; i++) {
    int here = letters(r->columns[i].input->label);
    if (*r->columns[i].input->setup->scene.name && here > width) width = here;
  }
  for (size_t i = 0; i < r->count; i++) {
    const strut_compare_input *in = r->columns[i].input;
    if (*in->setup->scene.name)
      strut_buffer_add(to, "%s:%*s %s\n", in->label, width - letters(in->label), "",
                       in->setup->scene.name);
  }
  if (width > 0) strut_buffer_add(to, "\n");
}

static void add_block(strut_buffer *to, const strut_compare *r, size_t first, size_t end) {
  const char *group = "";
  strut_buffer_add(to, "%-*s", LABELS, "");
  for (size_t i = first; i < end; i++)
    add_right(to, r->columns[i].input->label, column_width(&r->columns[i]));
  strut_buffer_add(to, "\n");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row row_info = strut_compare_row_of((strut_compare_quantity)row);
    if (!has_values(r, row)) continue;
    if (strcmp(group, row_info.group) != 0) strut_buffer_add(to, "%s\n", row_info.group);
    group = row_info.group;
    strut_buffer_add(to, "  %-*s", LABELS - 2, row_info.label);
    for (size_t i = first; i < end; i++) {
      char text[CELL];
      cell_text((strut_compare_quantity)row, &r->columns[i].cell[row], text);
      add_right(to, text, column_width(&r->columns[i]));
    }
    strut_buffer_add(to, "\n");
  }
}

/* ---- what has no place in the table ---- */

static void add_states(strut_buffer *to, const strut_compare_column *c) {
  if (c->state_count == 0) return;
  strut_buffer_add(to, "  %s: equilibria", c->input->label);
  for (size_t i = 0; i < c->state_count && i < MOST_STATES; i++)
    strut_buffer_add(to, "%s %s (%s)", i ? "," : "", c->states[i].name,
                     strut_quantity_of(c->states[i].energy, 6, "J").text);
  if (c->state_count > MOST_STATES)
    strut_buffer_add(to, " and %zu more", c->state_count - MOST_STATES);
  strut_buffer_add(to, "\n");
}

static void add_motion(strut_buffer *to, const strut_compare_column *c) {
  if (!c->motion) return;
  strut_buffer_add(to, "  %s moves %s", c->input->label,
                   c->motion[0] == 'p'   ? "periodically"
                   : c->motion[0] == 'i' ? "irregularly"
                                         : "without becoming steady");
  if (c->repeats > 1) strut_buffer_add(to, ", with a period of %d drive periods", (int)c->repeats);
  if (c->still) strut_buffer_add(to, ", without travel");
  const char *between = "; contact duty of";
  for (size_t i = 0; i < c->contact_count; i++) {
    if (!(c->contacts[i].duty > 0.0)) continue;
    strut_buffer_add(to, "%s %s %.3g %%", between, c->contacts[i].node,
                     100.0 * c->contacts[i].duty);
    between = ",";
  }
  strut_buffer_add(to, "\n");
}

static void add_remarks(strut_buffer *to, const strut_compare_column *c) {
  for (size_t i = 0; i < c->input->without_count; i++)
    strut_buffer_add(to, "  %s has no parameter '%s' and keeps the values of its file\n",
                     c->input->label, c->input->without[i]);
  if (c->status != STRUT_OK) strut_buffer_add(to, "  %s: %s\n", c->input->label, c->message);
}

static void add_value(strut_buffer *to, const char *text) {
  bool long_text = strlen(text) > MOST_TEXT;
  int bytes = (int)strlen(text);
  if (long_text)
    for (bytes = MOST_TEXT; bytes > 0 && ((unsigned char)text[bytes] & 0xC0) == 0x80; bytes--) {
    }
  strut_buffer_add(to, "%.*s%s", bytes, text, long_text ? "..." : "");
}

static void add_differences(strut_buffer *to, const strut_compare *r,
                            const strut_compare_column *c) {
  const strut_compare_input *in = c->input;
  strut_buffer_add(to, "\n%s against %s: ", in->label, r->columns[0].input->label);
  if (in->difference_count == 0) strut_buffer_add(to, "no difference");
  strut_buffer_add(to, "\n");
  for (size_t i = 0; i < in->difference_count && i < MOST_DIFFERENCES; i++) {
    const strut_difference *d = &in->differences[i];
    strut_buffer_add(to, "  %c %s: ", !d->was ? '+' : !d->is ? '-' : '~', d->where);
    if (d->was) add_value(to, d->was);
    if (d->was && d->is) strut_buffer_add(to, " -> ");
    if (d->is) add_value(to, d->is);
    strut_buffer_add(to, "\n");
  }
  if (in->difference_count > MOST_DIFFERENCES)
    strut_buffer_add(to, "  ... and %zu more; --json lists all\n",
                     in->difference_count - MOST_DIFFERENCES);
}

char *strut_compare_table(const strut_compare *r, int columns) {
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  add_scene_names(&table, r);
  for (size_t first = 0, end; first < r->count; first = end) {
    int used = LABELS;
    for (end = first; end < r->count; end++) {
      used += column_width(&r->columns[end]);
      if (used > columns && end > first) break;
    }
    if (first) strut_buffer_add(&table, "\n");
    add_block(&table, r, first, end);
  }
  strut_buffer_add(&table, "\n");
  for (size_t i = 0; i < r->count; i++) add_states(&table, &r->columns[i]);
  for (size_t i = 0; i < r->count; i++) add_motion(&table, &r->columns[i]);
  for (size_t i = 0; i < r->count; i++) add_remarks(&table, &r->columns[i]);
  for (size_t i = 1; i < r->count; i++) add_differences(&table, r, &r->columns[i]);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

/* ---- CSV ---- */

char *strut_compare_csv(const strut_compare *r) {
  strut_buffer csv = {0};
  strut_buffer_add(&csv, "model,name");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row row_info = strut_compare_row_of((strut_compare_quantity)row);
    strut_buffer_add(&csv, ",%s", row_info.key);
    if (*row_info.unit && strcmp(row_info.unit, "1") != 0)
      strut_buffer_add(&csv, " [%s]", row_info.unit);
  }
  strut_buffer_add(&csv, "\n");
  for (size_t i = 0; i < r->count; i++) {
    const strut_compare_column *c = &r->columns[i];
    strut_csv_add_text(&csv, "%s", c->input->label);
    strut_buffer_add(&csv, ",");
    strut_csv_add_text(&csv, "%s", c->input->setup->scene.name);
    for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
      char text[STRUT_NUMBER_TEXT] = "";
      if (isfinite(c->cell[row].value)) strut_number_text(c->cell[row].value, text);
      strut_buffer_add(&csv, ",%s", text);
    }
    strut_buffer_add(&csv, "\n");
  }
  return strut_buffer_take(&csv);
}

/* ---- JSON ---- */

static void put_units(strut_json *json) {
  struct cJSON *units = strut_json_object(json, json->root, "units");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row row_info = strut_compare_row_of((strut_compare_quantity)row);
    if (*row_info.unit) strut_json_text(json, units, row_info.key, row_info.unit);
  }
}

static void put_cells(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
  struct cJSON *values = strut_json_object(json, to, "values");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row row_info = strut_compare_row_of((strut_compare_quantity)row);
    double v = c->cell[row].value;
    if (isfinite(v) && !*row_info.unit)
      strut_json_integer(json, values, row_info.key, (int64_t)v);
    else
      strut_json_number(json, values, row_info.key, v);
  }
  struct cJSON *reasons = strut_json_object(json, to, "reasons");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++)
    if (c->cell[row].reason)
      strut_json_text(json, reasons, strut_compare_row_of((strut_compare_quantity)row).key,
                      c->cell[row].reason);
}

static void put_states(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
  struct cJSON *states = strut_json_array(json, to, "states");
  for (size_t i = 0; i < c->state_count; i++) {
    struct cJSON *state = strut_json_object(json, states, NULL);
    strut_json_text(json, state, "name", c->states[i].name);
    strut_json_number(json, state, "energy", c->states[i].energy);
  }
  struct cJSON *barriers = strut_json_array(json, to, "barriers");
  for (size_t i = 0; i < c->barrier_count; i++) {
    struct cJSON *barrier = strut_json_object(json, barriers, NULL);
    strut_json_text(json, barrier, "from", c->barriers[i].from);
    strut_json_text(json, barrier, "to", c->barriers[i].to);
    strut_json_number(json, barrier, "height", c->barriers[i].height);
  }
}

static void put_shape(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
  const strut_scene *scene = &c->input->setup->scene;
  strut_json_text(json, to, "shape", c->shape);
  struct cJSON *nodes = strut_json_object(json, to, "nodes");
  for (size_t i = 0; c->q && i < scene->node_count; i++) {
    struct cJSON *node = strut_json_object(json, nodes, scene->nodes[i].name);
    strut_json_numbers(json, node, "position", c->q + 2 * i, 2);
    if (c->stiffness) strut_json_numbers(json, node, "stiffness", c->stiffness[i], 2);
  }
  for (int d = 0; d < 2; d++)
    strut_json_text(json, to, d ? "softest_in_y" : "softest_in_x",
                    c->softest[d] < 0 ? NULL : scene->nodes[c->softest[d]].name);
}

static void put_motion(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
  strut_json_text(json, to, "motion", c->motion);
  if (c->repeats > 0) strut_json_integer(json, to, "repeats", c->repeats);
  if (c->motion) strut_json_bool(json, to, "still", c->still);
  strut_json_text(json, to, "velocity_method", c->how);
  struct cJSON *contacts = strut_json_object(json, to, "contacts");
  for (size_t i = 0; i < c->contact_count; i++) {
    struct cJSON *contact = strut_json_object(json, contacts, c->contacts[i].node);
    strut_json_number(json, contact, "duty", c->contacts[i].duty);
    strut_json_number(json, contact, "max_height", c->contacts[i].max_height);
  }
}

static void put_differences(strut_json *json, struct cJSON *to, const strut_compare_input *in) {
  struct cJSON *list = strut_json_array(json, to, "differences");
  for (size_t i = 0; i < in->difference_count; i++) {
    const strut_difference *d = &in->differences[i];
    struct cJSON *row = strut_json_object(json, list, NULL);
    strut_json_text(json, row, "where", d->where);
    strut_json_text(json, row, "change", !d->was ? "added" : !d->is ? "removed" : "changed");
    strut_json_text(json, row, "was", d->was);
    strut_json_text(json, row, "is", d->is);
  }
  struct cJSON *without = strut_json_array(json, to, "without_parameters");
  for (size_t i = 0; i < in->without_count; i++)
    strut_json_text(json, without, NULL, in->without[i]);
}

static void put_parameters(strut_json *json, struct cJSON *to, const strut_scene *scene) {
  struct cJSON *parameters = strut_json_object(json, to, "parameters");
  for (size_t i = 0; i < scene->parameter_count; i++) {
    const strut_parameter *p = &scene->parameters[i];
    if (isnan(p->value))
      strut_json_text(json, parameters, p->name, p->text);
    else
      strut_json_number(json, parameters, p->name, p->value);
  }
}

char *strut_compare_json(const strut_compare *r) {
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_number(&json, json.root, "accuracy", r->no_motion ? (double)NAN : r->accuracy);
  put_units(&json);
  struct cJSON *models = strut_json_array(&json, json.root, "models");
  for (size_t i = 0; i < r->count; i++) {
    const strut_compare_column *c = &r->columns[i];
    struct cJSON *model = strut_json_object(&json, models, NULL);
    strut_json_text(&json, model, "model", c->input->label);
    strut_json_text(&json, model, "name", c->input->setup->scene.name);
    strut_json_text(&json, model, "status", strut_status_text(c->status));
    strut_json_text(&json, model, "reason", c->status == STRUT_OK ? NULL : c->message);
    put_parameters(&json, model, &c->input->setup->scene);
    put_cells(&json, model, c);
    put_states(&json, model, c);
    put_shape(&json, model, c);
    put_motion(&json, model, c);
    if (i > 0) put_differences(&json, model, c->input);
  }
  return strut_json_end(&json);
}
