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

static void release(void *detail) {
  strut_analysis_free(detail);
  strut_release(detail);
}

const strut_equilibria *abi_result_equilibria(const strutlib_result *result) {
  if (result->command != &abi_equilibria_command) return NULL;
  return &((const strut_analysis *)result->detail)->result.equilibria;
}

static strut_status draw(const strutlib_result *result, const strut_arguments *arguments,
                         const char *path, strut_error *error) {
  const strut_analysis *analysis = result->detail;
  strut_plot plot;
  strut_status status = abi_plot_read(arguments, path, &plot);
  return status == STRUT_OK ? analysis->kind->draw(analysis, &plot, error) : status;
}

static strut_status open_setup(abi_call *call, bool compiled, strutlib_result *result) {
  strut_status status = abi_setup(call->scene, STRUT_FOR_ANY_STATICS, &result->setup, call->error);
  result->opened = status == STRUT_OK;
  result->setup.experiment.interrupt = abi_interrupt_of(call->control);
  if (status != STRUT_OK || !compiled) return status;
  return strut_model_compile(&result->setup.scene, &result->model, &call->what);
}

static strut_status report(abi_call *call, strutlib_result *result) {
  const strut_analysis *analysis = result->detail;
  const strut_analysis_kind *kind = analysis->kind;
  strut_status status = kind->verdict ? kind->verdict(analysis, &call->what) : STRUT_OK;
  if (status != STRUT_OK) return status;
  if (kind->warn) kind->warn(analysis, &call->listener);
  result->json = strut_analysis_json(analysis);
  result->table = strut_analysis_text(analysis, STRUT_REPORT_WIDTH);
  call->complete = result->json && result->table && !call->messages.out_of_memory;
  return call->complete ? STRUT_OK : strut_no_memory(&call->what, "");
}

static strut_status analyse(abi_call *call, strutlib_result *result) {
  const strut_analysis_kind *kind = result->command->analysis;
  const abi_source *source = call->scene->source;
  strut_status status = open_setup(call, !kind->uncompiled, result);
  if (status != STRUT_OK) return status;
  strut_analysis *analysis = result->detail = strut_allocate(1, sizeof *analysis);
  if (!analysis) return strut_no_memory(&call->what, "");
  result->release = release;
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
  status = strut_analysis_compute(analysis, &call->what);
  if (status == STRUT_OK) status = report(call, result);
  if (status == STRUT_OK && kind->uncompiled) /* of the scene that it has made, for pages */
    (void)strut_model_compile(&result->setup.scene, &result->model, NULL);
  return status;
}

/* ---- matrices and the shape that they are of, as arrays ---- */

/* A matrix by columns. */
typedef struct matrix {
  size_t rows;
  int32_t columns;
  const int32_t *start, *row;
  const double *value;
  bool symmetric; /* only one triangle is there, and zeros, which are no entries */
} matrix;

/* Its entries, one after the other: row, column and value of each, and its size. */
static bool add_matrix(strutlib_result *result, const char *name, const char *unit,
                       const matrix *from) {
  static const char *const parts[] = {"row", "column", "value"};
  size_t most = (size_t)from->start[from->columns], count = 0;
  double *entries[3];
  char text[60];
  for (int i = 0; i < 3; i++)
    if (!(entries[i] = strut_arena_allocate(&result->arrays.arena, 2 * most, sizeof **entries)))
      return false;
  for (int32_t j = 0; j < from->columns; j++)
    for (int32_t k = from->start[j]; k < from->start[j + 1]; k++) {
      const double entry[] = {from->row[k], j, from->value[k]};
      if (from->symmetric && entry[2] == 0.0) continue;
      for (int i = 0; i < 3; i++) entries[i][count] = entry[i];
      count++;
      if (!from->symmetric || from->row[k] == j) continue;
      for (int i = 0; i < 3; i++) entries[i][count] = entry[i < 2 ? 1 - i : i];
      count++;
    }
  for (int i = 0; i < 3; i++) {
    snprintf(text, sizeof text, "%s.%s", name, parts[i]);
    const abi_array array = abi_array_of(text, i < 2 ? "1" : unit, entries[i], 1, &count);
    if (!abi_add_array(&result->arrays, &array)) return false;
  }
  snprintf(text, sizeof text, "%s.size", name);
  double *size = abi_new_array(&result->arrays, text, "1", 2, 1);
  if (size) size[0] = (double)from->rows, size[1] = from->columns;
  return size;
}

static bool add_symmetric(strutlib_result *result, const char *name, const char *unit,
                          const strut_sparse *from) {
  if (!from) return true;
  const matrix whole = {(size_t)from->n, from->n, from->start, from->row, from->value, true};
  return add_matrix(result, name, unit, &whole);
}

static bool add_connectivity(strutlib_result *result, const strut_scene *scene,
                             strut_arena *arena) {
  int32_t *start, *row;
  double *value;
  size_t m = scene->member_count;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(start, m + 1), STRUT_NEW(row, 2 * m),
                      STRUT_NEW(value, 2 * m)))
    return false;
  for (size_t k = 0; k < 2 * m; k++) {
    row[k] = scene->members[k / 2].node[k % 2];
    value[k] = k % 2 ? 1.0 : -1.0;
    start[k / 2 + 1] = (int32_t)k + 1;
  }
  const matrix whole = {scene->node_count, (int32_t)m, start, row, value, false};
  return add_matrix(result, "connectivity", "1", &whole);
}

static bool add_equilibrium(strutlib_result *result, const strut_equilibrium_matrix *from) {
  size_t rows = (size_t)from->rows;
  const matrix whole = {rows, from->columns, from->start, from->row, from->value, false};
  bool good = add_matrix(result, "equilibrium", "1", &whole);
  double *coordinate = good ? abi_new_array(&result->arrays, "coordinates", "1", rows, 1) : NULL;
  for (size_t i = 0; coordinate && i < rows; i++) coordinate[i] = from->coordinate[i];
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
  ABI_FILL(abi_new_array(&result->arrays, NAME, UNIT, COUNT, PARTS), COUNT, PARTS, VALUE)
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

static strut_status build_matrices(abi_call *call, strutlib_result *result) {
  strut_arena arena = {0};
  strut_equilibrium_matrix equilibrium;
  strut_linear_matrices linear;
  strut_rest_state shape;
  const char *at = call->arguments.at ? call->arguments.at : "drawn";
  strut_status status = open_setup(call, true, result);
  if (status != STRUT_OK) return status;
  const strut_model *model = result->model;
  status = strut_rest_state_find(model, &result->setup.experiment, at, &arena, &shape, &call->what);
  if (status == STRUT_OK)
    status = strut_equilibrium_matrix_build(model, shape.q, &arena, &equilibrium);
  if (status == STRUT_OK) status = strut_linear_matrices_build(model, shape.q, &arena, &linear);
  if (status == STRUT_OK &&
      !(add_connectivity(result, model->scene, &arena) && add_equilibrium(result, &equilibrium) &&
        add_symmetric(result, "mass", "kg", linear.mass) &&
        add_symmetric(result, "stiffness_elastic", "N/m", linear.elastic) &&
        add_symmetric(result, "stiffness_geometric", "N/m", linear.geometric) &&
        add_symmetric(result, "stiffness_contact", "N/m", linear.contact) &&
        add_symmetric(result, "damping", "N s/m", linear.damping) &&
        add_shape(result, model, shape.q)))
    status = STRUT_NO_MEMORY;
  strut_arena_free(&arena);
  call->complete = status == STRUT_OK;
  return status;
}

#define ANALYSE(NAME) ABI_CALL(NAME, analyse)
STRUT_ANALYSES(ANALYSE)
ABI_CALL(matrices, build_matrices)
