/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A comparison as JSON, with all that the table has no room for. */
#include <math.h>
#include <string.h>

#include "engine/output/json_value.h"
#include "engine/study/compare/compare_report.h"

static void add_units(strut_json *json) {
  struct cJSON *units = strut_json_object(json, json->root, "units");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row told = strut_compare_row_of((strut_compare_quantity)row);
    if (*told.unit) strut_json_text(json, units, told.key, told.unit);
  }
}

static void add_cells(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
  struct cJSON *values = strut_json_object(json, to, "values");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++) {
    strut_compare_row told = strut_compare_row_of((strut_compare_quantity)row);
    double v = c->cell[row].value;
    if (isfinite(v) && !*told.unit)
      strut_json_integer(json, values, told.key, (int64_t)v);
    else
      strut_json_number(json, values, told.key, v);
  }
  struct cJSON *reasons = strut_json_object(json, to, "why_empty");
  for (int row = 0; row < STRUT_COMPARE_QUANTITIES; row++)
    if (c->cell[row].reason)
      strut_json_text(json, reasons, strut_compare_row_of((strut_compare_quantity)row).key,
                      c->cell[row].reason);
}

static void add_states(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
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

static void add_shape(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
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

static void add_motion(strut_json *json, struct cJSON *to, const strut_compare_column *c) {
  strut_json_text(json, to, "motion", c->motion);
  if (c->repeats > 0) strut_json_integer(json, to, "repeats", c->repeats);
  if (c->motion) strut_json_bool(json, to, "still", c->still);
  strut_json_text(json, to, "how", c->how);
  struct cJSON *contacts = strut_json_object(json, to, "contacts");
  for (size_t i = 0; i < c->contact_count; i++) {
    struct cJSON *contact = strut_json_object(json, contacts, c->contacts[i].node);
    strut_json_number(json, contact, "duty", c->contacts[i].duty);
    strut_json_number(json, contact, "max_height", c->contacts[i].max_height);
  }
}

static void add_differences(strut_json *json, struct cJSON *to, const strut_compare_input *in) {
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

static void add_parameters(strut_json *json, struct cJSON *to, const strut_scene *scene) {
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
  add_units(&json);
  struct cJSON *models = strut_json_array(&json, json.root, "models");
  for (size_t i = 0; i < r->count; i++) {
    const strut_compare_column *c = &r->columns[i];
    struct cJSON *model = strut_json_object(&json, models, NULL);
    strut_json_text(&json, model, "model", c->input->label);
    strut_json_text(&json, model, "name", c->input->setup->scene.name);
    strut_json_text(&json, model, "status", strut_status_text(c->status));
    strut_json_text(&json, model, "reason", c->status == STRUT_OK ? NULL : c->message);
    add_parameters(&json, model, &c->input->setup->scene);
    add_cells(&json, model, c);
    add_states(&json, model, c);
    add_shape(&json, model, c);
    add_motion(&json, model, c);
    if (i > 0) add_differences(&json, model, c->input);
  }
  return strut_json_end(&json);
}
