/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equilibria, modes, rigidity, form, path, matrices: what the program's commands of these names do, without files. */
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/result_values.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/statics/rigidity/rigidity_parts.h"
#include "parser/bindings/abi/handles.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/analyses.h"

typedef struct analysis_detail {
  strut_analysis analysis; /* of the result's setup and model */
} analysis_detail;

static void release(void *detail) {
  analysis_detail *self = detail;
  strut_analysis_free(&self->analysis);
  strut_release(self);
}

const strut_equilibria *abi_result_equilibria(const strutlib_result *result) {
  if (result->command != &abi_equilibria_command) return NULL;
  return &((const analysis_detail *)result->detail)->analysis.result.equilibria;
}

static strut_status draw(const strutlib_result *result, const strut_arguments *arguments,
                         const char *path, strut_error *error) {
  const strut_analysis *analysis = &((const analysis_detail *)result->detail)->analysis;
  strut_plot plot;
  strut_status status = abi_plot_read(arguments, path, &plot);
  return status == STRUT_OK ? analysis->kind->draw(analysis, &plot, error) : status;
}

static strut_status compute_and_report(abi_call *call, const strutlib_scene *scene,
                                       strutlib_result *result, strut_error *what) {
  const strut_analysis_kind *kind = result->command->analysis;
  const abi_source *source = scene->source;
  analysis_detail *self = strut_allocate(1, sizeof *self);
  if (!self) return strut_no_memory(what, "");
  strut_analysis *analysis = &self->analysis;
  result->release = release;
  result->detail = self;
  result->draw = draw;
  *analysis = (strut_analysis){.kind = kind,
                               .arguments = &call->arguments,
                               .setup = &result->setup,
                               .model = result->model,
                               .interrupt = abi_interrupt_of(call->control),
                               .scenes = {.file = source->name,
                                          .text = source->text,
                                          .length = source->length,
                                          .source = source->tree}};
  strut_status status = strut_analysis_compute(analysis, what);
  if (status == STRUT_OK && analysis->kind->verdict)
    status = analysis->kind->verdict(analysis, what);
  if (status != STRUT_OK) return status;
  if (analysis->kind->warn) analysis->kind->warn(analysis, &call->listener);
  result->json = strut_analysis_json(analysis);
  result->table = strut_analysis_text(analysis, STRUT_REPORT_WIDTH);
  bool complete = result->json && result->table && !result->messages.out_of_memory;
  return complete ? STRUT_OK : strut_no_memory(what, "");
}

/* ---- matrices and the shape that they are of, as arrays ---- */

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

static bool show(strutlib_result *result, const char *name, const char *unit, const entries *self) {
  static const char *const parts[] = {"row", "column", "value"};
  const double *const data[] = {self->row, self->column, self->value};
  char text[60];
  for (int i = 0; i < 3; i++) {
    snprintf(text, sizeof text, "%s.%s", name, parts[i]);
    if (!abi_result_add_array(result, text, i < 2 ? "1" : unit, data[i], 1, &self->count))
      return false;
  }
  snprintf(text, sizeof text, "%s.size", name);
  double *size = abi_result_new_array(result, text, "1", 2, 1);
  if (size) size[0] = (double)self->rows, size[1] = (double)self->columns;
  return size;
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

static bool add_equilibrium(strutlib_result *result, const strut_equilibrium_matrix *matrix) {
  entries m;
  size_t rows = (size_t)matrix->rows;
  if (!reserve(result, (size_t)matrix->start[matrix->columns], rows, (size_t)matrix->columns, &m))
    return false;
  for (int32_t j = 0; j < matrix->columns; j++)
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++)
      put(&m, matrix->row[k], j, matrix->value[k]);
  bool good = show(result, "equilibrium", "1", &m);
  double *coordinate = good ? abi_result_new_array(result, "coordinates", "1", rows, 1) : NULL;
  for (size_t i = 0; coordinate && i < rows; i++) coordinate[i] = matrix->coordinate[i];
  return coordinate;
}

/* Of a rigid bar that of the start, otherwise the rest length without drives. */
static double made_length(const strut_model *model, size_t i) {
  const strut_scene *scene = model->scene;
  const strut_member *member = &scene->members[i];
  if (scene->bar_model != STRUT_BARS_RIGID || member->kind != STRUT_BAR)
    return model->members.rest[i];
  return strut_distance(scene->nodes[member->node[0]].start, scene->nodes[member->node[1]].start);
}

/* What programs need to write the structure in other formats. */
static bool add_shape(strutlib_result *result, const strut_model *model, const double *q) {
  const strut_member *members = model->scene->members;
  const size_t n = model->scene->node_count, m = model->scene->member_count;
#define SHAPE(NAME, UNIT, COUNT, PARTS, VALUE)                                                     \
  ABI_FILL(abi_result_new_array(result, NAME, UNIT, COUNT, PARTS), COUNT, PARTS, VALUE)
  SHAPE("position", "m", n, 2, q[2 * i + c]);
  SHAPE("weight", "kg", n, 1, model->weight[i]);
  SHAPE("length", "m", m, 1, strut_member_path_length(model, (int32_t)i, q));
  SHAPE("rest_length", "m", m, 1, made_length(model, i));
  SHAPE("tension", "N", m, 1,
        strut_member_elastic_tension(model, model->members.rest, (int32_t)i, q));
  SHAPE("damping_coefficient", "N s/m", m, 1,
        members[i].guide_count > 0 ? members[i].damping : model->members.damping[i]);
  return true;
}

static strut_status build_matrices(abi_call *call, strutlib_result *result, strut_error *what) {
  const strut_model *model = result->model;
  strut_arena arena = {0};
  strut_equilibrium_matrix equilibrium;
  strut_linear_matrices linear;
  strut_rest_state shape;
  const char *at = call->arguments.at;
  strut_status status = strut_rest_state_find(model, &result->setup.experiment, at ? at : "drawn",
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
        add_symmetric(result, "damping", "N s/m", linear.damping) &&
        add_shape(result, model, shape.q)))
    status = STRUT_NO_MEMORY;
  strut_arena_free(&arena);
  return status;
}

/* ---- calls ---- */

static strut_status open_setup(abi_call *call, const strutlib_scene *scene, bool compiled,
                               strutlib_result *result) {
  strut_error what = {0};
  strut_status status = abi_setup(scene, STRUT_FOR_ANY_STATICS, &result->setup, call->error);
  result->opened = status == STRUT_OK;
  result->setup.experiment.interrupt = abi_interrupt_of(call->control);
  if (status != STRUT_OK || !compiled) return status;
  status = strut_model_compile(&result->setup.scene, &result->model, &what);
  if (status != STRUT_OK) abi_call_fail(call, status, &what);
  return status;
}

/* What a command computes: its analysis, or the matrices. */
static strutlib_result *analyse(const strutlib_scene *scene, const strut_command *command,
                                const abi_pairs *options, strutlib_control *control,
                                strutlib_error **error) {
  const strut_analysis_kind *kind = command->analysis;
  abi_call call;
  strut_error what = {0};
  abi_enter(error);
  strutlib_result *result = abi_result_create(command, error);
  strut_status status = result ? STRUT_OK : STRUT_NO_MEMORY;
  if (result)
    status = abi_call_begin(&call, scene, command, options, control, error, &result->messages);
  if (status == STRUT_OK) status = open_setup(&call, scene, !(kind && kind->uncompiled), result);
  if (status == STRUT_OK) {
    status = kind ? compute_and_report(&call, scene, result, &what)
                  : build_matrices(&call, result, &what);
    if (status != STRUT_OK) abi_call_fail(&call, status, &what);
  }
  if (status == STRUT_OK && kind && kind->uncompiled) /* of the scene that it has made, for pages */
    (void)strut_model_compile(&result->setup.scene, &result->model, &what);
  return abi_result_leave(result, status == STRUT_OK);
}

#define CALL(NAME)                                                                                 \
  strutlib_result *strutlib_##NAME(const strutlib_scene *scene, size_t count,                      \
                                   const char *const *names, const char *const *values,            \
                                   strutlib_control *control, strutlib_error **error) {            \
    const abi_pairs options = {count, names, values};                                              \
    return analyse(scene, &abi_##NAME##_command, &options, control, error);                        \
  }
STRUT_ANALYSES(CALL)
CALL(matrices)
