/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/json.h"

#include <cjson/cJSON.h>
#include <math.h>

#include "engine/output/json_settle.h"

/* Every helper does nothing once memory was out, so that only the end has to ask. */

static void add_steady(strut_json *json, cJSON *to, const strut_steady_summary *s) {
  double sizes[STRUT_MOST_MULTIPLIERS];
  if (s->kind == STRUT_MOTION_NOT_WATCHED) return;
  cJSON *steady = strut_json_object(json, to, "steady");
  strut_json_text(json, steady, "kind", strut_motion_name(s->kind));
  strut_json_integer(json, steady, "repeats", s->repeats);
  strut_json_integer(json, steady, "periods", s->periods);
  strut_json_number(json, steady, "velocity_interval", s->interval);
  strut_json_number(json, steady, "residual", s->residual);
  if (!s->shot && !s->reason[0]) return;
  strut_json_bool(json, steady, "shot", s->shot);
  strut_json_text(json, steady, "reason", s->reason[0] ? s->reason : NULL);
  strut_json_integer(json, steady, "iterations", s->iterations);
  for (size_t i = 0; i < s->multiplier_count; i++)
    sizes[i] = hypot(s->multiplier[i][0], s->multiplier[i][1]);
  strut_json_numbers(json, steady, "multipliers", &s->multiplier[0][0], 2 * s->multiplier_count);
  strut_json_numbers(json, steady, "multiplier_sizes", sizes, s->multiplier_count);
}

static void add_accuracy(strut_json *json, cJSON *to, const strut_accuracy_summary *a) {
  if (!(a->wanted > 0.0)) return;
  cJSON *accuracy = strut_json_object(json, to, "accuracy");
  strut_json_number(json, accuracy, "wanted", a->wanted);
  strut_json_number(json, accuracy, "expected", a->expected);
  strut_json_bool(json, accuracy, "kept", a->kept);
  strut_json_number(json, accuracy, "scale", a->scale);
  strut_json_text(json, accuracy, "why", a->why);
  strut_json_integer(json, accuracy, "check_evaluations", a->check_evaluations);
}

static void add_limit_violation(strut_json *json, cJSON *to,
                                const strut_step_limit_violation *fell) {
  if (!(fell->limit > 0.0)) return;
  cJSON *object = strut_json_object(json, to, "step_limit_violation");
  strut_json_number(json, object, "limit", fell->limit);
  strut_json_number(json, object, "time", fell->time);
  strut_json_number(json, object, "since", fell->since);
  strut_json_integer(json, object, "steps", fell->steps);
}

static void add_warnings(strut_json *json, cJSON *to, const strut_summary *s) {
  cJSON *warnings = strut_json_array(json, to, "warnings");
  for (size_t i = 0; i < s->warning_count; i++) {
    cJSON *warning = strut_json_object(json, warnings, NULL);
    strut_json_text(json, warning, "code", s->warnings[i].code);
    strut_json_text(json, warning, "text", s->warnings[i].text);
  }
}

void strut_json_settle(strut_json *json, cJSON *to, const strut_settle_summary *how) {
  char warning[300];
  if (how->evaluations == 0) return;
  cJSON *object = strut_json_object(json, to, "settle");
  bool unstable = strut_settle_warning(how, warning, sizeof warning);
  strut_json_number(json, object, "step", how->step);
  strut_json_integer(json, object, "evaluations", how->evaluations);
  strut_json_integer(json, object, "perturbations", how->perturbations);
  strut_json_bool(json, object, "stable", !how->unstable);
  strut_json_text(json, object, "node", how->node);
  strut_json_number(json, object, "stiffness", unstable ? how->stiffness : (double)NAN);
  strut_json_number(json, object, "growth_rate", unstable ? how->growth_rate : (double)NAN);
  strut_json_text(json, object, "warning", unstable ? warning : NULL);
}

static void add_run(strut_json *json, cJSON *to, const strut_summary *s, bool with_wall_time) {
  strut_json_text(json, to, "status", strut_status_text(s->status));
  strut_json_text(json, to, "reason", s->reason[0] ? s->reason : NULL);
  add_warnings(json, to, s);
  char worth[200];
  strut_summary_worth(s, worth, sizeof worth);
  strut_json_text(json, to, "worth", worth[0] ? worth : NULL);
  strut_json_text(json, to, "caveat", s->caveat[0] ? s->caveat : NULL);
  strut_json_number(json, to, "velocity", s->velocity);
  strut_json_number(json, to, "velocity_spread", s->velocity_spread);
  if (s->velocity_zero) strut_json_bool(json, to, "velocity_zero", true);
  strut_json_number(json, to, "window_start", s->window_start);
  strut_json_number(json, to, "window_duration", s->window_time);
  strut_json_number(json, to, "window_drive_work", s->window_work);
  strut_json_number(json, to, "duration", s->duration);
  strut_json_number(json, to, "settle_time", s->settle_time);
  strut_json_settle(json, to, &s->settle);
  strut_json_integer(json, to, "steps", s->steps);
  strut_json_integer(json, to, "force_evaluations", s->force_evaluations);
  strut_json_integer(json, to, "events", s->events);
  strut_json_text(json, to, "method", s->method);
  strut_json_number(json, to, "step", s->step);
  strut_json_number(json, to, "step_limit", s->step_limit);
  add_limit_violation(json, to, &s->limit_fell);
  add_steady(json, to, &s->steady);
  add_accuracy(json, to, &s->accuracy);
  if (with_wall_time) strut_json_number(json, to, "wall_time", s->wall_time);
}

static void add_parameters(strut_json *json, cJSON *to, const strut_scene *scene) {
  cJSON *parameters = strut_json_object(json, to, "parameters");
  for (size_t i = 0; i < scene->parameter_count; i++) {
    const strut_parameter *parameter = &scene->parameters[i];
    if (isnan(parameter->value)) {
      strut_json_text(json, parameters, parameter->name, parameter->text);
    } else {
      strut_json_number(json, parameters, parameter->name, parameter->value);
    }
  }
}

static void add_nodes(strut_json *json, cJSON *to, const strut_summary *s) {
  cJSON *nodes = strut_json_object(json, to, "nodes");
  for (size_t i = 0; i < s->node_count; i++) {
    cJSON *node = strut_json_object(json, nodes, s->node_names[i]);
    strut_json_numbers(json, node, "position", s->positions + 2 * i, 2);
  }
}

/* The key exists only if the scene has hinges. */
static void add_hinges(strut_json *json, cJSON *to, const strut_summary *s) {
  cJSON *hinges = s->hinge_count ? strut_json_object(json, to, "hinges") : NULL;
  for (size_t i = 0; i < s->hinge_count; i++) {
    cJSON *hinge = strut_json_object(json, hinges, s->hinges[i].hinge);
    strut_json_number(json, hinge, "angle", s->hinges[i].angle);
    strut_json_number(json, hinge, "moment", s->hinges[i].moment);
  }
}

/* Likewise of cells. */
static void add_cells(strut_json *json, cJSON *to, const strut_summary *s) {
  cJSON *cells = s->cell_count ? strut_json_object(json, to, "cells") : NULL;
  for (size_t i = 0; i < s->cell_count; i++) {
    cJSON *cell = strut_json_object(json, cells, s->cells[i].cell);
    strut_json_number(json, cell, "area", s->cells[i].area);
    strut_json_number(json, cell, "pressure", s->cells[i].pressure);
  }
}

/* The key exists only if something broke or was released. */
static void add_breaks(strut_json *json, cJSON *to, const strut_summary *s) {
  cJSON *broken = s->break_count ? strut_json_object(json, to, "broken") : NULL;
  for (size_t i = 0; i < s->break_count; i++) {
    cJSON *one = strut_json_object(json, broken, s->breaks[i].name);
    strut_json_number(json, one, "time", s->breaks[i].time);
    strut_json_bool(json, one, "released", s->breaks[i].released);
  }
}

static void add_contacts(strut_json *json, cJSON *to, const strut_summary *s) {
  cJSON *contacts = strut_json_object(json, to, "contacts");
  for (size_t i = 0; i < s->contact_count; i++) {
    cJSON *contact = strut_json_object(json, contacts, s->contacts[i].node);
    strut_json_number(json, contact, "duty", s->contacts[i].duty);
    strut_json_number(json, contact, "max_height", s->contacts[i].max_height);
    if (s->contacts[i].band_needed > 0.0)
      strut_json_number(json, contact, "stick_velocity_needed", s->contacts[i].band_needed);
  }
}

/* The key exists only if the scene measures quantities. */
static void add_measured(strut_json *json, cJSON *to, const strut_summary *s) {
  if (!s->measured_count) return;
  cJSON *measured = strut_json_object(json, to, "measured");
  for (size_t i = 0; i < s->measured_count; i++) {
    const strut_measured *m = &s->measured[i];
    cJSON *quantity = strut_json_object(json, measured, m->name);
    strut_json_number(json, quantity, "value", m->value);
    strut_json_text(json, quantity, "unit", m->unit);
    strut_json_number(json, quantity, "spread", m->spread);
    strut_json_number(json, quantity, "scale", m->scale);
    strut_json_bool(json, quantity, "zero", m->zero);
    if (m->member) strut_json_text(json, quantity, "member", m->member);
    if (!isfinite(m->expected)) continue;
    strut_json_number(json, quantity, "expected", m->expected);
    strut_json_bool(json, quantity, "kept", m->kept);
  }
}

static void add_energy(strut_json *json, cJSON *to, const strut_summary *s) {
  static const char *const balances[] = {NULL, "closed", "open"};
  const strut_energy *e = &s->energy;
  cJSON *energy = strut_json_object(json, to, "energy");
#define ADD_TERM(name, kind, label) strut_json_number(json, energy, #name, e->name);
  STRUT_ENERGY_TABLE(ADD_TERM)
#undef ADD_TERM
  strut_json_number(json, energy, "initial", e->initial);
  strut_json_number(json, energy, "residual", e->residual);
  strut_json_number(json, energy, "exchanged", e->moved);
  strut_json_text(json, energy, "balance", balances[s->balance]);
}

char *strut_summary_json(const strut_summary *summary, const strut_scene *scene,
                         bool with_wall_time) {
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_integer(&json, json.root, "language", STRUT_LANGUAGE_VERSION);
  add_run(&json, json.root, summary, with_wall_time);
  add_measured(&json, json.root, summary);
  add_parameters(&json, json.root, scene);
  add_nodes(&json, json.root, summary);
  add_hinges(&json, json.root, summary);
  add_cells(&json, json.root, summary);
  add_breaks(&json, json.root, summary);
  add_contacts(&json, json.root, summary);
  add_energy(&json, json.root, summary);
  return strut_json_end(&json);
}
