/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports of modes and of a form that was found. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/report/reports.h"
#include "engine/output/run_report.h"
#include "engine/scene/signal_program.h"

enum { MOST_ROWS = 40, DIGITS = 6 };

static const char *name_of(const strut_model *model, int32_t node) {
  return model->scene->nodes[node].name;
}

/* Two numbers for every node, by name. */
static void add_nodes(strut_json *json, struct cJSON *row, const char *key,
                      const strut_model *model, const double *values) {
  struct cJSON *nodes = strut_json_object(json, row, key);
  for (int32_t i = 0; i < model->node_count; i++)
    strut_json_numbers(json, nodes, name_of(model, i), values + 2 * i, 2);
}

/* What acts in a run, but not in modes. */
static const char *left_out(const strut_model *model) {
  bool feedback = strut_scene_has_feedback(model->scene), maxwell = model->feedback.maxwell_count;
  return feedback && maxwell ? "the feedback of sensors and Maxwell branches, which have relaxed"
         : feedback          ? "the feedback of sensors"
         : maxwell           ? "Maxwell branches, which have relaxed"
                             : NULL;
}

/* A mode as a row; its description, the last one, is always in quotes in the CSV. */
enum { MODE_CELLS = 10 };
static void fill_cells(const strut_mode *m, strut_report_value cells[MODE_CELLS]) {
  const strut_report_value row[MODE_CELLS] = {
      {"frequency", "Hz", m->angular_frequency / STRUT_TAU, NULL, true},
      {"angular_frequency", "1/s", m->angular_frequency, NULL, false},
      {"eigenvalue", "1/s^2", m->eigenvalue, NULL, false},
      {"damping_ratio", "1", m->damping_ratio, NULL, true},
      {"damped_frequency", "Hz", m->damped_frequency / STRUT_TAU, NULL, true},
      {"decay_rate", "1/s", m->decay_rate, NULL, true},
      {"residual", "1", m->residual, NULL, false},
      {"error", "1", m->error, NULL, true},
      {"kind", "1", 0.0, strut_mode_kind_name(m->kind), true},
      {"description", "1", 0.0, m->description, true}};
  memcpy(cells, row, sizeof row);
}

static void add_mode(strut_json *json, struct cJSON *list, const strut_model *model,
                     const strut_mode *mode) {
  struct cJSON *row = strut_json_object(json, list, NULL);
  strut_report_value cells[MODE_CELLS];
  fill_cells(mode, cells);
  strut_json_cells(json, row, cells, MODE_CELLS);
  add_nodes(json, row, "shape", model, mode->shape);
}

static void add_idle(strut_json *json, const char *key, const strut_model *model,
                     const strut_modes *modes, strut_idleness kind) {
  struct cJSON *list = strut_json_array(json, json->root, key);
  for (size_t j = 0; j < model->scene->member_count; j++)
    if (modes->idleness[j] == kind)
      strut_json_text(json, list, NULL, model->scene->members[j].name);
}

/* Members that take no part here. */
static void add_idle_lines(strut_buffer *table, const strut_model *model,
                           const strut_modes *modes) {
  static const char *const words[][2] = {
      [STRUT_SLACK] = {"slack", "."},
      [STRUT_JUST_TAUT] = {"just taut, without prestress",
                           ". They act one way only, and count as slack here."}};
  const strut_member *member = model->scene->members;
  size_t count[STRUT_JUST_TAUT + 1] = {0}, first[STRUT_JUST_TAUT + 1];
  for (size_t j = model->scene->member_count; j-- > 0;)
    count[modes->idleness[j]]++, first[modes->idleness[j]] = j;
  for (int k = STRUT_SLACK; k <= STRUT_JUST_TAUT; k++) {
    if (!count[k]) continue;
    strut_buffer_add(table, "  %s: %s", words[k][0], member[first[k]].name);
    if (count[k] > 1) strut_buffer_add(table, " and %zu more", count[k] - 1);
    strut_buffer_add(table, "%s\n", words[k][1]);
  }
  if (count[STRUT_SLACK] + count[STRUT_JUST_TAUT])
    strut_buffer_add(table, "  strut rigidity counts these as members, and so fewer mechanisms\n");
}

char *strut_modes_json(const strut_model *model, const strut_modes *modes) {
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", model->scene->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_text(&json, json.root, "at", modes->at);
  add_nodes(&json, json.root, "nodes", model, modes->q);
  strut_json_integer(&json, json.root, "coordinates", modes->coordinates);
  struct cJSON *contacts = strut_json_array(&json, json.root, "contacts");
  for (int32_t i = 0; i < modes->closed_count; i++)
    strut_json_text(&json, contacts, NULL, name_of(model, modes->closed[i]));
  add_idle(&json, "slack", model, modes, STRUT_SLACK);
  add_idle(&json, "just_taut", model, modes, STRUT_JUST_TAUT);
  strut_json_text(&json, json.root, "method", modes->dense ? "dense" : "sparse");
  strut_json_number(&json, json.root, "condition", modes->condition);
  strut_json_bool(&json, json.root, "at_rest", modes->at_rest);
  strut_json_settle(&json, json.root, &modes->settle);
  strut_json_text(&json, json.root, "damping",
                  modes->damped_exactly ? "quadratic eigenproblem" : "modal quotient");
  strut_json_text(&json, json.root, "left_out", left_out(model));
  struct cJSON *list = strut_json_array(&json, json.root, "modes");
  for (size_t i = 0; i < modes->count; i++) add_mode(&json, list, model, &modes->list[i]);
  return strut_json_end(&json);
}

static void add_head(strut_buffer *table, const strut_model *model, const strut_modes *modes) {
  const char *name = model->scene->name;
  strut_buffer_add(table, "%s%smodes at %s", name, *name ? ": " : "", modes->at);
  for (int32_t i = 0; i < modes->closed_count; i++)
    strut_buffer_add(table, "%s%s", i ? ", " : ", on ", name_of(model, modes->closed[i]));
  strut_buffer_add(
      table, "\n  %d coordinates, %s; condition number %.2g\n", (int)modes->coordinates,
      modes->dense ? "all modes computed" : "the lowest modes computed", modes->condition);
  if (!modes->at_rest)
    strut_buffer_add(table,
                     "  this shape is not an equilibrium: the structure moves away from it%s\n",
                     model->contacts.count ? " where friction does not hold it" : "");
  char warning[300];
  if (strut_settle_warning(&modes->settle, warning, sizeof warning))
    strut_buffer_add(table, "  %s\n", warning);
  if (left_out(model)) strut_buffer_add(table, "  without %s\n", left_out(model));
  add_idle_lines(table, model, modes);
  if (!modes->damped_exactly)
    strut_buffer_add(table,
                     "  damping ratios by modal quotient, coupling between modes neglected\n");
}

static void add_row(strut_buffer *table, size_t i, const strut_mode *mode) {
  char frequency[STRUT_QUANTITY_TEXT] = "not known", ratio[STRUT_QUANTITY_TEXT] = "";
  if (mode->kind != STRUT_MODE_UNKNOWN)
    strut_quantity_text(mode->angular_frequency / STRUT_TAU, DIGITS, "Hz", frequency);
  if (isfinite(mode->damping_ratio)) snprintf(ratio, sizeof ratio, "%.4g", mode->damping_ratio);
  strut_buffer_add(table, "  %4zu %14s %10s %8.1e  %-10s %s\n", i + 1, frequency, ratio,
                   mode->error, strut_mode_kind_name(mode->kind), mode->description);
}

char *strut_modes_table(const strut_model *model, const strut_modes *modes) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer table = {0};
  add_head(&table, model, modes);
  strut_buffer_add(&table, "\n  %4s %14s %10s %8s  %-10s %s\n", "mode", "frequency", "damping",
                   "error", "kind", "shape");
  for (size_t i = 0; i < modes->count && i < MOST_ROWS; i++) add_row(&table, i, &modes->list[i]);
  if (modes->count > MOST_ROWS)
    strut_buffer_add(&table, "  ... and %zu more; --json lists all\n", modes->count - MOST_ROWS);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

char *strut_modes_csv(const strut_modes *modes) {
  strut_buffer csv = {0};
  strut_report_value cells[MODE_CELLS];
  fill_cells(&(strut_mode){.description = ""}, cells);
  strut_buffer_add(&csv, "mode");
  strut_csv_add_columns(&csv, cells, MODE_CELLS);
  for (size_t i = 0; i < modes->count; i++) {
    fill_cells(&modes->list[i], cells);
    strut_buffer_add(&csv, "\n%zu", i + 1);
    strut_csv_add_cells(&csv, cells, MODE_CELLS - 1);
    strut_buffer_add(&csv, ",\"%s\"", modes->list[i].description);
  }
  strut_buffer_add(&csv, "\n");
  return strut_buffer_take(&csv);
}

enum { MOST_MEMBERS = 40, FORM_REPORT_DIGITS = 6 };

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, FORM_REPORT_DIGITS, unit);
}

static void form_report_add_head(strut_buffer *table, const strut_form *form,
                                 const strut_setup *setup) {
  const strut_scene *scene = &setup->scene;
  strut_buffer_add(table, "%s%sform by %s\n", scene->name, *scene->name ? ": " : "",
                   strut_form_source_name(form->from));
  strut_buffer_add(table, "  displacement      at most %s from the drawn positions\n",
                   in(form->moved, "m").text);
  if (form->from == STRUT_FORM_DENSITIES)
    strut_buffer_add(table, "  force densities   changed by %.3g of the largest\n",
                     form->density_change);
  if (form->from == STRUT_FORM_PRESTRESS)
    strut_buffer_add(table, "  cable tension     at least %s\n", in(form->least_tension, "N").text);
  strut_buffer_add(table, "  residual force    %s at the start\n", in(form->residual, "N").text);
  if (form->run_added)
    strut_buffer_add(table, "  run added         %s with a step of %s\n",
                     in(setup->experiment.duration, "s").text,
                     in(setup->experiment.step, "s").text);
  if (form->massless) strut_buffer_add(table, "  no run            a free node has no mass\n");
  if (form->driven)
    strut_buffer_add(table, "  drives            at rest here; running the model moves them\n");
}

/* A member at the start. */
typedef struct pose {
  strut_rest rest;
  double length, force, density;
} pose;

/* model: of the scene, or NULL where it has straight members with a linear law only. */
static pose pose_of(const strut_scene *scene, const strut_model *model, size_t j) {
  const strut_member *m = &scene->members[j];
  const double *a = scene->nodes[m->node[0]].start, *b = scene->nodes[m->node[1]].start;
  pose p = {.length = hypot(b[0] - a[0], b[1] - a[1])};
  if (!strut_member_rest(scene, j, &p.rest)) return p;
  if (model && strut_element_of_member(&model->elements, (int32_t)j)) {
    p.length = strut_member_path_length(model, (int32_t)j, model->start);
    p.force = strut_member_elastic_tension(model, model->members.rest, (int32_t)j, model->start);
    p.density = p.length > 0 ? p.force / p.length : 0;
    return p;
  }
  p.force = p.rest.stiffness * (p.length - p.rest.length);
  if (m->kind == STRUT_CABLE && p.force < 0) p.force = 0;
  p.density = p.length > 0 ? p.force / p.length : 0;
  return p;
}

/* The model of a scene whose members have other laws, guides or stops; else NULL. */
static strut_model *compile_elements(const strut_scene *scene) {
  strut_model *model = NULL;
  strut_error error = {0};
  if (strut_model_compile(scene, &model, &error) != STRUT_OK) return NULL;
  if (model->elements.count) return model;
  strut_model_free(model);
  return NULL;
}

char *strut_form_table(const strut_form *form, const strut_setup *setup) {
  const strut_scene *scene = &setup->scene;
  strut_buffer table = {0};
  strut_model *model = compile_elements(scene);
  strut_c_locale locale = strut_c_locale_enter();
  form_report_add_head(&table, form, setup);
  strut_buffer_add(&table, "\n  %-12s %-6s %14s %14s %14s %14s\n", "member", "kind", "length",
                   "rest length", "force", "force density");
  for (size_t j = 0; j < scene->member_count && j < MOST_MEMBERS; j++) {
    const strut_member *m = &scene->members[j];
    pose p = pose_of(scene, model, j);
    strut_buffer_add(&table, "  %-12s %-6s %14s %14s %14s %14s\n", m->name,
                     strut_member_kind_name(m->kind), in(p.length, "m").text,
                     in(p.rest.length, "m").text, in(p.force, "N").text, in(p.density, "N/m").text);
  }
  if (scene->member_count > MOST_MEMBERS)
    strut_buffer_add(&table, "  ... and %zu more\n", scene->member_count - MOST_MEMBERS);
  strut_c_locale_leave(locale);
  strut_model_free(model);
  return strut_buffer_take(&table);
}

static void add_figures(strut_json *json, const strut_form *form, const strut_scene *scene) {
  struct cJSON *root = json->root;
  strut_json_text(json, root, "name", scene->name);
  strut_json_text(json, root, "strut_version", STRUT_VERSION);
  strut_json_text(json, root, "from", strut_form_source_name(form->from));
  strut_json_number(json, root, "moved", form->moved);
  strut_json_number(json, root, "residual", form->residual);
  strut_json_number(json, root, "density_change", form->density_change);
  strut_json_number(json, root, "least_tension", form->least_tension);
  strut_json_bool(json, root, "run_added", form->run_added);
  strut_json_bool(json, root, "driven", form->driven);
  strut_json_bool(json, root, "massless", form->massless);
}

char *strut_form_json(const strut_form *form, const strut_scene *scene) {
  strut_json json = strut_json_begin();
  add_figures(&json, form, scene);
  struct cJSON *nodes = strut_json_object(&json, json.root, "nodes");
  struct cJSON *lengths = strut_json_object(&json, json.root, "lengths");
  struct cJSON *rests = strut_json_object(&json, json.root, "rest_lengths");
  struct cJSON *forces = strut_json_object(&json, json.root, "forces");
  struct cJSON *densities = strut_json_object(&json, json.root, "densities");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_json_numbers(&json, nodes, scene->nodes[i].name, scene->nodes[i].start, 2);
  strut_model *model = compile_elements(scene);
  for (size_t j = 0; j < scene->member_count; j++) {
    const char *name = scene->members[j].name;
    pose p = pose_of(scene, model, j);
    strut_json_number(&json, lengths, name, p.length);
    strut_json_number(&json, rests, name, p.rest.length);
    strut_json_number(&json, forces, name, p.force);
    strut_json_number(&json, densities, name, p.density);
  }
  strut_model_free(model);
  return strut_json_end(&json);
}
