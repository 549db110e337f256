/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/equilibrium_matrix.h"

#include <math.h>
#include <string.h>

#include "engine/forces/tangent.h"
#include "engine/model/pose.h"

enum { ENTRIES = 4 }; /* of a column at most */

static void add_entry(strut_equilibrium_matrix *a, int32_t row, double value) {
  if (row < 0 || value == 0.0) return;
  int32_t at = a->start[a->columns]++;
  a->row[at] = row;
  a->value[at] = value;
}

/* The column after the last; rows of the node that comes first in the model come first. */
static void add_column(const strut_model *model, const double *q, strut_equilibrium_matrix *a) {
  int32_t j = a->columns;
  uint32_t from = model->members.from[j], to = model->members.to[j];
  strut_vec2 span = strut_member_span(&model->members, j, q);
  double length = a->length[j] = strut_vec2_length(span);
  strut_vec2 u = strut_vec2_unit(span, length);
  a->direction[j][0] = u.x, a->direction[j][1] = u.y;
  double sign = from < to ? -1.0 : 1.0;
  uint32_t first = from < to ? from : to, second = from < to ? to : from;
  a->columns++;
  a->start[j + 1] = a->start[j];
  add_entry(a, a->row_of[first], sign * u.x);
  add_entry(a, a->row_of[first + 1], sign * u.y);
  add_entry(a, a->row_of[second], -sign * u.x);
  add_entry(a, a->row_of[second + 1], -sign * u.y);
}

strut_status strut_equilibrium_matrix_build(const strut_model *model, const double *q,
                                            strut_arena *arena, strut_equilibrium_matrix *a) {
  size_t members = (size_t)model->members.count, length = (size_t)model->length;
  *a = (strut_equilibrium_matrix){0};
  a->coordinate = strut_arena_allocate(arena, length, sizeof *a->coordinate);
  a->row_of = strut_arena_allocate(arena, length, sizeof *a->row_of);
  a->length = strut_arena_allocate(arena, members + 1, sizeof *a->length);
  a->direction = strut_arena_allocate(arena, members + 1, sizeof *a->direction);
  a->start = strut_arena_allocate(arena, members + 1, sizeof *a->start);
  a->row = strut_arena_allocate(arena, ENTRIES * members + 1, sizeof *a->row);
  a->value = strut_arena_allocate(arena, ENTRIES * members + 1, sizeof *a->value);
  if (!a->coordinate || !a->row_of || !a->length || !a->direction || !a->start || !a->row ||
      !a->value)
    return STRUT_NO_MEMORY;
  a->rows = strut_number_free(model, NULL, a->row_of, a->coordinate);
  for (int32_t j = 0; j < model->members.count; j++) add_column(model, q, a);
  return STRUT_OK;
}

void strut_equilibrium_multiply(const strut_equilibrium_matrix *a, const double *t, double *y) {
  memset(y, 0, (size_t)a->rows * sizeof *y);
  for (int32_t j = 0; j < a->columns; j++)
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++) y[a->row[k]] += a->value[k] * t[j];
}

void strut_equilibrium_elongate(const strut_equilibrium_matrix *a, const double *d, double *e) {
  for (int32_t j = 0; j < a->columns; j++) {
    e[j] = 0.0;
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++) e[j] += a->value[k] * d[a->row[k]];
  }
}

void strut_equilibrium_dense(const strut_equilibrium_matrix *a, double *dense) {
  for (int32_t j = 0; j < a->columns; j++)
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++)
      dense[(size_t)a->row[k] * (size_t)a->columns + (size_t)j] = a->value[k];
}
