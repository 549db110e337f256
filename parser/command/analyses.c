/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/analyses.h"

#include <string.h>

#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/reports.h"

strut_status strut_analysis_compute(strut_analysis *a, strut_error *error) {
  a->all = a->arguments->all;
  strut_status status = a->kind->compute(a, error);
  a->arguments = NULL;
  return status;
}

void strut_analysis_free(strut_analysis *a) {
  if (a->kind && a->kind->release) a->kind->release(a);
  strut_varied_scenes_free(&a->scenes);
  strut_arena_free(&a->arena);
}

#define END                                                                                        \
  { STRUT_OPTION_END, NULL, NULL, NULL }

/* ---- equilibria ---- */

static strut_status compute_equilibria(strut_analysis *a, strut_error *error) {
  strut_equilibria_options wanted;
  uint64_t seed;
  strut_status status =
      strut_equilibria_options_read(a->command, a->arguments, a->setup, &wanted, &seed);
  if (status != STRUT_OK) return status;
  wanted.interrupt = a->setup->experiment.interrupt;
  return strut_equilibria_find(a->model, &a->setup->experiment, &wanted, &a->result.equilibria,
                               error);
}

static strut_status judge_equilibria(const strut_analysis *a, strut_error *error) {
  const strut_equilibria *all = &a->result.equilibria;
  return all->count > 0 ? STRUT_OK : strut_fail(error, STRUT_NOT_SETTLED, "%s", all->remark);
}

static char *equilibria_json(const strut_analysis *a) {
  return strut_equilibria_json(&a->result.equilibria, a->model);
}

static char *equilibria_table(const strut_analysis *a) {
  return strut_equilibria_table(&a->result.equilibria, a->model, a->all);
}

static void warn_of_equilibria(const strut_analysis *a, const strut_listener *listener) {
  strut_warn_of_equilibria(listener, a->model, &a->result.equilibria);
}

static strut_status draw_equilibria(const strut_analysis *a, const strut_plot *plot,
                                    strut_error *error) {
  if (a->result.equilibria.count == 0) return STRUT_OK;
  return strut_equilibria_figure(plot, a->model, &a->result.equilibria, error);
}

static void free_equilibria(strut_analysis *a) { strut_equilibria_free(&a->result.equilibria); }

const strut_option strut_equilibria_analysis_options[] = {STRUT_EQUILIBRIA_OPTIONS, END};

const strut_analysis_kind strut_equilibria_analysis = {.files = {"equilibria.json"},
                                                       .asks = true,
                                                       .compute = compute_equilibria,
                                                       .verdict = judge_equilibria,
                                                       .json = equilibria_json,
                                                       .table = equilibria_table,
                                                       .warn = warn_of_equilibria,
                                                       .draw = draw_equilibria,
                                                       .release = free_equilibria};

/* ---- modes ---- */

static strut_status compute_modes(strut_analysis *a, strut_error *error) {
  strut_modes_options wanted;
  strut_status status = strut_modes_options_read(a->command, a->arguments, &wanted);
  if (status != STRUT_OK) return status;
  a->result.modes.count = (size_t)wanted.count;
  return strut_modes_find(a->model, &a->setup->experiment, &wanted, &a->result.modes.found, error);
}

static char *modes_json(const strut_analysis *a) {
  return strut_modes_json(a->model, &a->result.modes.found);
}

static char *modes_csv(const strut_analysis *a) { return strut_modes_csv(&a->result.modes.found); }

static char *modes_table(const strut_analysis *a) {
  return strut_modes_table(a->model, &a->result.modes.found);
}

static void warn_of_modes(const strut_analysis *a, const strut_listener *listener) {
  strut_warn_of_overload(listener, a->model, a->result.modes.found.q, "in this shape");
}

static strut_status draw_modes(const strut_analysis *a, const strut_plot *plot,
                               strut_error *error) {
  return strut_modes_figure(plot, a->model, &a->result.modes.found, a->result.modes.count, error);
}

static void free_modes(strut_analysis *a) { strut_modes_free(&a->result.modes.found); }

const strut_option strut_modes_analysis_options[] = {STRUT_MODES_OPTIONS, END};

const strut_analysis_kind strut_modes_analysis = {.files = {"modes.json", "modes.csv"},
                                                  .compute = compute_modes,
                                                  .json = modes_json,
                                                  .csv = modes_csv,
                                                  .table = modes_table,
                                                  .warn = warn_of_modes,
                                                  .draw = draw_modes,
                                                  .release = free_modes};

/* ---- rigidity ---- */

static strut_status compute_rigidity(strut_analysis *a, strut_error *error) {
  strut_named_shape *shape = &a->result.rigidity.shape;
  strut_status status = strut_named_shape_find(a->arguments, a->model, &a->setup->experiment,
                                               &a->arena, shape, error);
  if (status != STRUT_OK) return status;
  /* The name may be the option's text, which does not stay. */
  shape->name = strut_arena_text(&a->arena, shape->name, strlen(shape->name));
  if (!shape->name) return strut_no_memory(error, "");
  return strut_rigidity_find(a->model, shape->q, &a->result.rigidity.found, error);
}

static char *rigidity_json(const strut_analysis *a) {
  return strut_rigidity_json(&a->result.rigidity.found, a->model, a->result.rigidity.shape.name);
}

static char *rigidity_table(const strut_analysis *a) {
  return strut_rigidity_table(&a->result.rigidity.found, a->model, a->result.rigidity.shape.name);
}

static strut_status draw_rigidity(const strut_analysis *a, const strut_plot *plot,
                                  strut_error *error) {
  const strut_named_shape *shape = &a->result.rigidity.shape;
  return strut_rigidity_figure(plot, a->model, shape->q, shape->name, &a->result.rigidity.found,
                               error);
}

static void free_rigidity(strut_analysis *a) { strut_rigidity_free(&a->result.rigidity.found); }

const strut_option strut_rigidity_analysis_options[] = {STRUT_SHAPE_OPTIONS, END};

const strut_analysis_kind strut_rigidity_analysis = {.files = {"rigidity.json"},
                                                     .compute = compute_rigidity,
                                                     .json = rigidity_json,
                                                     .table = rigidity_table,
                                                     .draw = draw_rigidity,
                                                     .release = free_rigidity};

/* ---- form: the setup becomes that of the form ---- */

static strut_status compute_form(strut_analysis *a, strut_error *error) {
  const strut_scene *scene = &a->setup->scene;
  strut_form_options wanted = {0};
  strut_status status = strut_form_options_read(a->command, a->arguments, &wanted);
  if (status != STRUT_OK) return status;
  double(*drawn)[2] = strut_arena_allocate(&a->arena, scene->node_count, sizeof *drawn);
  if (!drawn) return strut_no_memory(error, "");
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(drawn[i], scene->nodes[i].position, sizeof *drawn);
  a->result.form.drawn = drawn;
  return strut_form_find(a->setup, &wanted, &a->result.form.found, error);
}

static char *form_json(const strut_analysis *a) {
  return strut_form_json(&a->result.form.found, &a->setup->scene);
}

static char *form_table(const strut_analysis *a) {
  return strut_form_table(&a->result.form.found, a->setup);
}

static strut_status draw_form(const strut_analysis *a, const strut_plot *plot, strut_error *error) {
  strut_model *model = NULL;
  strut_status status = strut_model_compile(&a->setup->scene, &model, error);
  if (status == STRUT_OK)
    status = strut_form_figure(plot, model, (const double(*)[2])a->result.form.drawn, error);
  strut_model_free(model);
  return status;
}

const strut_option strut_form_analysis_options[] = {STRUT_FORM_OPTIONS, END};

const strut_analysis_kind strut_form_analysis = {.files = {"form.json"},
                                                 .uncompiled = true,
                                                 .compute = compute_form,
                                                 .json = form_json,
                                                 .table = form_table,
                                                 .draw = draw_form};

/* ---- path ---- */

static strut_status compute_path(strut_analysis *a, strut_error *error) {
  strut_path_options wanted;
  strut_status status = strut_path_options_read(a->command, a->arguments, &wanted);
  if (status == STRUT_OK)
    status =
        strut_path_followed_read(a->command, a->arguments, &a->setup->scene, &a->scenes, &wanted);
  if (status != STRUT_OK) return status;
  return strut_path_follow(a->model, &a->setup->experiment, &wanted, &a->result.path, error);
}

static char *path_json(const strut_analysis *a) {
  return strut_path_json(&a->result.path, &a->setup->scene);
}

static char *path_csv(const strut_analysis *a) {
  return strut_path_csv(&a->result.path, &a->setup->scene);
}

static char *path_table(const strut_analysis *a) {
  return strut_path_table(&a->result.path, &a->setup->scene);
}

static void warn_of_path(const strut_analysis *a, const strut_listener *listener) {
  strut_warn_of_path(listener, &a->setup->scene, &a->result.path);
}

static strut_status draw_path(const strut_analysis *a, const strut_plot *plot, strut_error *error) {
  return strut_path_figure(plot, a->model, &a->result.path, error);
}

static void free_path(strut_analysis *a) { strut_path_free(&a->result.path); }

const strut_option strut_path_analysis_options[] = {STRUT_PATH_OPTIONS, END};

const strut_analysis_kind strut_path_analysis = {.files = {"path.json", "path.csv"},
                                                 .compute = compute_path,
                                                 .json = path_json,
                                                 .csv = path_csv,
                                                 .table = path_table,
                                                 .warn = warn_of_path,
                                                 .draw = draw_path,
                                                 .release = free_path};
