/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/reports.h"

#include <math.h>

#include "engine/base/c_locale.h"
#include "engine/forces/elements.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"

enum { MOST_MEMBERS = 40, DIGITS = 7 };

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

static void add_head(strut_buffer *table, const strut_form *form, const strut_setup *setup) {
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
  static const char *const kinds[] = {"bar", "spring", "cable"};
  strut_buffer table = {0};
  strut_model *model = compile_elements(scene);
  strut_c_locale locale = strut_c_locale_enter();
  add_head(&table, form, setup);
  strut_buffer_add(&table, "\n  %-12s %-6s %14s %14s %14s %14s\n", "member", "kind", "length",
                   "rest length", "force", "force density");
  for (size_t j = 0; j < scene->member_count && j < MOST_MEMBERS; j++) {
    const strut_member *m = &scene->members[j];
    pose p = pose_of(scene, model, j);
    strut_buffer_add(&table, "  %-12s %-6s %14s %14s %14s %14s\n", m->name, kinds[m->kind],
                     in(p.length, "m").text, in(p.rest.length, "m").text, in(p.force, "N").text,
                     in(p.density, "N/m").text);
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
