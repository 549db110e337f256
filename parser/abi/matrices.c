/* SPDX-License-Identifier: GPL-3.0-or-later */
/* strutlib_matrices: what `strut export --matrices` writes, as arrays. */
#include <stdio.h>
#include <string.h>

#include "engine/statics/rigidity/equilibrium_matrix.h"
#include "engine/statics/rigidity/linear_matrices.h"
#include "parser/abi/handles.h"
#include "parser/command/statics_options.h"

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
    status = abi_call_begin(&call, scene, &abi_matrices_command, count, names, values, control,
                            error, &result->messages);
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
