/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Equilibria, modes, rigidity, form, path, matrices: what the program's commands of these names do, without
 * files.
 */
#include <stdio.h>
#include <string.h>

#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/reports.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/statics/rigidity/rigidity_parts.h"
#include "parser/bindings/abi/handles.h"
#include "parser/command/messages.h"
#include "parser/command/statics_options.h"
#include "parser/write/write_scene.h"

/* ---- what all do alike ---- */

/*
 * Computes on the result's setup and, where it is compiled, its model; leaves an error that is not reported
 * yet in `what`.
 */
typedef strut_status (*analysis)(abi_call *call, const strutlib_scene *scene,
                                 strutlib_result *result, strut_error *what);

static void *make_detail(strutlib_result *result, size_t size, void (*release)(void *)) {
  abi_detail *detail = strut_allocate(1, size);
  if (detail) detail->release = release;
  result->detail = detail;
  return detail;
}

static strut_status take_reports(strutlib_result *result, char *json, char *table,
                                 strut_error *what) {
  result->json = json;
  result->table = table;
  return json && table && !result->messages.out_of_memory ? STRUT_OK : strut_no_memory(what, "");
}

static strut_status open_setup(abi_call *call, const strutlib_scene *scene, bool compiled,
                               strutlib_result *result) {
  strut_error what = {0};
  strut_status status = abi_setup(scene, STRUT_FOR_ANY, &result->setup, call->error);
  result->opened = status == STRUT_OK;
  result->setup.experiment.interrupt = abi_interrupt_of(call->control);
  if (status != STRUT_OK || !compiled) return status;
  status = strut_model_compile(&result->setup.scene, &result->model, &what);
  if (status != STRUT_OK) abi_call_fail(call, status, &what);
  return status;
}

static strutlib_result *analyse(const strutlib_scene *scene, const strut_command *command,
                                const abi_pairs *options, strutlib_control *control,
                                strutlib_error **error, bool compiled, analysis compute) {
  abi_call call;
  strut_error what = {0};
  abi_enter(error);
  strutlib_result *result = abi_result_create(command, error);
  strut_status status = result ? STRUT_OK : STRUT_NO_MEMORY;
  if (result)
    status = abi_call_begin(&call, scene, command, options, control, error, &result->messages);
  if (status == STRUT_OK) status = open_setup(&call, scene, compiled, result);
  if (status == STRUT_OK) {
    status = compute(&call, scene, result, &what);
    if (status != STRUT_OK) abi_call_fail(&call, status, &what);
  }
  if (status != STRUT_OK) {
    strutlib_result_free(result);
    result = NULL;
  }
  abi_leave();
  return result;
}

/* ---- equilibria ---- */

typedef struct equilibria_detail {
  abi_detail base;
  strut_equilibria all;
} equilibria_detail;

static void release_equilibria(void *detail) {
  equilibria_detail *d = detail;
  strut_equilibria_free(&d->all);
  strut_release(d);
}

const strut_equilibria *abi_result_equilibria(const strutlib_result *result) {
  if (result->command != &abi_equilibria_command) return NULL;
  return &((const equilibria_detail *)result->detail)->all;
}

static strut_status draw_equilibria(const strutlib_result *result, const strut_arguments *arguments,
                                    const char *path, strut_error *error) {
  strut_plot plot;
  strut_status status = abi_plot_read(arguments, path, &plot);
  if (status != STRUT_OK) return status;
  return strut_equilibria_figure(&plot, result->model, abi_result_equilibria(result), error);
}

static strut_status find_equilibria(abi_call *call, const strutlib_scene *scene,
                                    strutlib_result *result, strut_error *what) {
  (void)scene;
  uint64_t seed;
  strut_equilibria_options wanted;
  equilibria_detail *d = make_detail(result, sizeof *d, release_equilibria);
  if (!d) return strut_no_memory(what, "");
  strut_status status = strut_equilibria_options_read(result->command, &call->arguments,
                                                      &result->setup, &wanted, &seed);
  if (status != STRUT_OK) return status;
  wanted.interrupt = abi_interrupt_of(call->control);
  status = strut_equilibria_find(result->model, &result->setup.experiment, &wanted, &d->all, what);
  if (status != STRUT_OK) return status;
  if (d->all.count == 0) return strut_fail(what, STRUT_NOT_SETTLED, "%s", d->all.remark);
  strut_warn_of_equilibria(&call->listener, result->model, &d->all);
  result->draw = draw_equilibria;
  return take_reports(result, strut_equilibria_json(&d->all, result->model),
                      strut_equilibria_table(&d->all, result->model, call->arguments.all), what);
}

strutlib_result *strutlib_equilibria(const strutlib_scene *scene, size_t count,
                                     const char *const *names, const char *const *values,
                                     strutlib_control *control, strutlib_error **error) {
  return analyse(scene, &abi_equilibria_command, &(abi_pairs){count, names, values}, control, error,
                 true, find_equilibria);
}

/* ---- modes ---- */

typedef struct modes_detail {
  abi_detail base;
  strut_modes modes;
  int32_t count;
} modes_detail;

static void release_modes(void *detail) {
  modes_detail *d = detail;
  strut_modes_free(&d->modes);
  strut_release(d);
}

static strut_status draw_modes(const strutlib_result *result, const strut_arguments *arguments,
                               const char *path, strut_error *error) {
  const modes_detail *d = result->detail;
  strut_plot plot;
  strut_status status = abi_plot_read(arguments, path, &plot);
  if (status != STRUT_OK) return status;
  return strut_modes_figure(&plot, result->model, &d->modes, (size_t)d->count, error);
}

static strut_status find_modes(abi_call *call, const strutlib_scene *scene, strutlib_result *result,
                               strut_error *what) {
  (void)scene;
  strut_modes_options wanted;
  modes_detail *d = make_detail(result, sizeof *d, release_modes);
  if (!d) return strut_no_memory(what, "");
  strut_status status = strut_modes_options_read(result->command, &call->arguments, &wanted);
  if (status != STRUT_OK) return status;
  d->count = wanted.count;
  status = strut_modes_find(result->model, &result->setup.experiment, &wanted, &d->modes, what);
  if (status != STRUT_OK) return status;
  strut_warn_of_overload(&call->listener, result->model, d->modes.q, "in this shape");
  result->draw = draw_modes;
  return take_reports(result, strut_modes_json(result->model, &d->modes),
                      strut_modes_table(result->model, &d->modes), what);
}

strutlib_result *strutlib_modes(const strutlib_scene *scene, size_t count, const char *const *names,
                                const char *const *values, strutlib_control *control,
                                strutlib_error **error) {
  return analyse(scene, &abi_modes_command, &(abi_pairs){count, names, values}, control, error,
                 true, find_modes);
}

/* ---- rigidity ---- */

typedef struct rigidity_detail {
  abi_detail base;
  strut_rigidity rigidity;
  strut_named_shape shape; /* in the result's arena */
} rigidity_detail;

static void release_rigidity(void *detail) {
  rigidity_detail *d = detail;
  strut_rigidity_free(&d->rigidity);
  strut_release(d);
}

static strut_status draw_rigidity(const strutlib_result *result, const strut_arguments *arguments,
                                  const char *path, strut_error *error) {
  const rigidity_detail *d = result->detail;
  strut_plot plot;
  strut_status status = abi_plot_read(arguments, path, &plot);
  if (status != STRUT_OK) return status;
  return strut_rigidity_figure(&plot, result->model, d->shape.q, d->shape.name, &d->rigidity,
                               error);
}

static strut_status find_rigidity(abi_call *call, const strutlib_scene *scene,
                                  strutlib_result *result, strut_error *what) {
  (void)scene;
  const strut_model *model = result->model;
  rigidity_detail *d = make_detail(result, sizeof *d, release_rigidity);
  if (!d) return strut_no_memory(what, "");
  strut_status status = strut_named_shape_find(&call->arguments, model, &result->setup.experiment,
                                               &result->arena, &d->shape, what);
  if (status == STRUT_OK) {
    /* The name may be the option's text, which is the caller's. */
    d->shape.name = strut_arena_text(&result->arena, d->shape.name, strlen(d->shape.name));
    if (!d->shape.name) status = strut_no_memory(what, "");
  }
  if (status == STRUT_OK) status = strut_rigidity_find(model, d->shape.q, &d->rigidity, what);
  if (status != STRUT_OK) return status;
  result->draw = draw_rigidity;
  return take_reports(result, strut_rigidity_json(&d->rigidity, model, d->shape.name),
                      strut_rigidity_table(&d->rigidity, model, d->shape.name), what);
}

strutlib_result *strutlib_rigidity(const strutlib_scene *scene, size_t count,
                                   const char *const *names, const char *const *values,
                                   strutlib_control *control, strutlib_error **error) {
  return analyse(scene, &abi_rigidity_command, &(abi_pairs){count, names, values}, control, error,
                 true, find_rigidity);
}

/* ---- form ---- */

static strut_status draw_form(const strutlib_result *result, const strut_arguments *arguments,
                              const char *path, strut_error *error) {
  const double(*drawn)[2] = (const double(*)[2])result->drawn;
  strut_plot plot;
  strut_status status = abi_plot_read(arguments, path, &plot);
  if (status != STRUT_OK) return status;
  return strut_form_figure(&plot, result->model, drawn, error);
}

static strut_status find_form(abi_call *call, const strutlib_scene *scene, strutlib_result *result,
                              strut_error *what) {
  (void)scene;
  strut_form_options wanted = {0};
  strut_form form;
  strut_setup *setup = &result->setup;
  size_t nodes = setup->scene.node_count;
  strut_status status = strut_form_options_read(result->command, &call->arguments, &wanted);
  if (status != STRUT_OK) return status;
  result->drawn = strut_arena_allocate(&result->arena, 2 * nodes, sizeof *result->drawn);
  if (!result->drawn) return strut_no_memory(what, "");
  for (size_t i = 0; i < nodes; i++)
    memcpy(result->drawn + 2 * i, setup->scene.nodes[i].position, 2 * sizeof *result->drawn);
  status = strut_form_find(setup, &wanted, &form, what);
  if (status == STRUT_OK) status = strut_model_compile(&setup->scene, &result->model, what);
  if (status != STRUT_OK) return status;
  result->yaml = strut_setup_write(setup);
  if (!result->yaml) return strut_no_memory(what, "");
  result->draw = draw_form;
  return take_reports(result, strut_form_json(&form, &setup->scene), strut_form_table(&form, setup),
                      what);
}

strutlib_result *strutlib_form(const strutlib_scene *scene, size_t count, const char *const *names,
                               const char *const *values, strutlib_control *control,
                               strutlib_error **error) {
  return analyse(scene, &abi_form_command, &(abi_pairs){count, names, values}, control, error,
                 false, find_form);
}

/* ---- path ---- */

typedef struct path_detail {
  abi_detail base;
  strut_path path;
} path_detail;

static void release_path(void *detail) {
  path_detail *d = detail;
  strut_path_free(&d->path);
  strut_release(d);
}

static strut_status draw_path(const strutlib_result *result, const strut_arguments *arguments,
                              const char *path, strut_error *error) {
  const path_detail *d = result->detail;
  strut_plot plot;
  strut_status status = abi_plot_read(arguments, path, &plot);
  if (status != STRUT_OK) return status;
  return strut_path_figure(&plot, result->model, &d->path, error);
}

static strut_status follow(const strutlib_result *result, const strut_path_options *wanted,
                           path_detail *d, strut_error *what) {
  return strut_path_follow(result->model, &result->setup.experiment, wanted, &d->path, what);
}

static strut_status find_path(abi_call *call, const strutlib_scene *scene, strutlib_result *result,
                              strut_error *what) {
  strut_path_options wanted;
  strut_varied_scenes followed = {.file = scene->source->name,
                                  .text = scene->source->text,
                                  .length = scene->source->length,
                                  .source = scene->source->tree};
  const strut_scene *s = &result->setup.scene;
  path_detail *d = make_detail(result, sizeof *d, release_path);
  if (!d) return strut_no_memory(what, "");
  strut_status status = strut_path_options_read(result->command, &call->arguments, &wanted);
  if (status == STRUT_OK)
    status = strut_path_followed_read(result->command, &call->arguments, s, &followed, &wanted);
  if (status == STRUT_OK) status = follow(result, &wanted, d, what);
  strut_varied_scenes_free(&followed);
  if (status != STRUT_OK) return status;
  strut_warn_of_path(&call->listener, s, &d->path);
  result->draw = draw_path;
  return take_reports(result, strut_path_json(&d->path, s), strut_path_table(&d->path, s), what);
}

strutlib_result *strutlib_path(const strutlib_scene *scene, size_t count, const char *const *names,
                               const char *const *values, strutlib_control *control,
                               strutlib_error **error) {
  return analyse(scene, &abi_path_command, &(abi_pairs){count, names, values}, control, error, true,
                 find_path);
}

/* strutlib_matrices: what `strut export --matrices` writes, as arrays. */

/* Entries of a matrix, one after the other. */
typedef struct entries {
  size_t count, rows, columns;
  double *row, *column, *value;
} entries;

static bool reserve(strutlib_result *result, size_t most, size_t rows, size_t columns,
                    entries *to) {
  *to = (entries){.rows = rows, .columns = columns};
  to->row = strut_arena_allocate(&result->arena, most, sizeof(double));
  to->column = strut_arena_allocate(&result->arena, most, sizeof(double));
  to->value = strut_arena_allocate(&result->arena, most, sizeof(double));
  return to->row && to->column && to->value;
}

static void put(entries *to, int32_t row, int32_t column, double value) {
  to->row[to->count] = row;
  to->column[to->count] = column;
  to->value[to->count++] = value;
}

static bool show(strutlib_result *result, const char *name, const char *unit, const entries *m) {
  const size_t two[] = {2};
  char text[60];
  double *size = strut_arena_allocate(&result->arena, 2, sizeof *size);
  if (!size) return false;
  size[0] = (double)m->rows;
  size[1] = (double)m->columns;
  const struct {
    const char *part, *unit;
    const double *data;
  } parts[] = {{"row", "1", m->row}, {"column", "1", m->column}, {"value", unit, m->value}};
  for (size_t i = 0; i < 3; i++) {
    snprintf(text, sizeof text, "%s.%s", name, parts[i].part);
    if (!abi_result_add_array(result, text, parts[i].unit, parts[i].data, 1, &m->count))
      return false;
  }
  snprintf(text, sizeof text, "%s.size", name);
  return abi_result_add_array(result, text, "1", size, 1, two);
}

static bool add_symmetric(strutlib_result *result, const char *name, const char *unit,
                          const strut_sparse *from) {
  entries m;
  if (!from) return true;
  size_t n = (size_t)from->n;
  if (!reserve(result, 2 * (size_t)from->start[n], n, n, &m)) return false;
  for (int32_t j = 0; j < from->n; j++)
    for (int32_t k = from->start[j]; k < from->start[j + 1]; k++) {
      if (from->value[k] == 0.0) continue;
      put(&m, from->row[k], j, from->value[k]);
      if (from->row[k] != j) put(&m, j, from->row[k], from->value[k]);
    }
  return show(result, name, unit, &m);
}

static bool add_connectivity(strutlib_result *result, const strut_scene *scene) {
  entries m;
  if (!reserve(result, 2 * scene->member_count, scene->node_count, scene->member_count, &m))
    return false;
  for (size_t j = 0; j < scene->member_count; j++) {
    put(&m, scene->members[j].node[0], (int32_t)j, -1.0);
    put(&m, scene->members[j].node[1], (int32_t)j, 1.0);
  }
  return show(result, "connectivity", "1", &m);
}

static bool add_equilibrium(strutlib_result *result, const strut_equilibrium_matrix *a) {
  entries m;
  size_t rows = (size_t)a->rows;
  double *coordinate = strut_arena_allocate(&result->arena, rows, sizeof *coordinate);
  if (!coordinate || !reserve(result, (size_t)a->start[a->columns], rows, (size_t)a->columns, &m))
    return false;
  for (int32_t j = 0; j < a->columns; j++)
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++) put(&m, a->row[k], j, a->value[k]);
  for (size_t i = 0; i < rows; i++) coordinate[i] = a->coordinate[i];
  return show(result, "equilibrium", "1", &m) &&
         abi_result_add_array(result, "coordinates", "1", coordinate, 1, &rows);
}

static strut_status build(abi_call *call, strutlib_result *result, strut_error *what) {
  const strut_model *model = result->model;
  strut_arena arena = {0};
  strut_equilibrium_matrix equilibrium;
  strut_linear_matrices linear;
  strut_named_shape shape;
  strut_status status = strut_named_shape_find(&call->arguments, model, &result->setup.experiment,
                                               &arena, &shape, what);
  if (status == STRUT_OK)
    status = strut_equilibrium_matrix_build(model, shape.q, &arena, &equilibrium);
  if (status == STRUT_OK) status = strut_linear_matrices_build(model, shape.q, &arena, &linear);
  if (status == STRUT_OK &&
      !(add_connectivity(result, model->scene) && add_equilibrium(result, &equilibrium) &&
        add_symmetric(result, "mass", "kg", linear.mass) &&
        add_symmetric(result, "stiffness_elastic", "N/m", linear.elastic) &&
        add_symmetric(result, "stiffness_geometric", "N/m", linear.geometric) &&
        add_symmetric(result, "stiffness_contact", "N/m", linear.contact) &&
        add_symmetric(result, "damping", "N s/m", linear.damping)))
    status = STRUT_NO_MEMORY;
  strut_arena_free(&arena);
  return status;
}

strutlib_result *strutlib_matrices(const strutlib_scene *scene, size_t count,
                                   const char *const *names, const char *const *values,
                                   strutlib_control *control, strutlib_error **error) {
  abi_call call;
  strut_error what = {0};
  abi_enter(error);
  strutlib_result *result = abi_result_create(&abi_matrices_command, error);
  strut_status status = result ? STRUT_OK : STRUT_NO_MEMORY;
  if (result)
    status = abi_call_begin(&call, scene, &abi_matrices_command, &(abi_pairs){count, names, values},
                            control, error, &result->messages);
  if (status == STRUT_OK) status = abi_setup(scene, STRUT_FOR_ANY, &result->setup, error);
  if (status == STRUT_OK) {
    result->opened = true;
    result->setup.experiment.interrupt = abi_interrupt_of(control);
    status = strut_model_compile(&result->setup.scene, &result->model, &what);
    if (status == STRUT_OK) status = build(&call, result, &what);
    if (status != STRUT_OK) abi_call_fail(&call, status, &what);
  }
  if (status != STRUT_OK) {
    strutlib_result_free(result);
    result = NULL;
  }
  abi_leave();
  return result;
}
