/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/midpoint_matrix.h"

#include <math.h>
#include <string.h>

/* Row and column of a member's k-th place among its four coordinates: the lower triangle by rows. */
static const int32_t row_of_place[STRUT_MIDPOINT_PLACES] = {0, 1, 1, 2, 2, 2, 3, 3, 3, 3};
static const int32_t column_of_place[STRUT_MIDPOINT_PLACES] = {0, 0, 1, 0, 1, 2, 0, 1, 2, 3};

/* Rows of the four coordinates of member j; -1 where supported. */
static void rows_of(const strut_model *model, const int32_t *row_of, int32_t j, int32_t row[4]) {
  for (int c = 0; c < 2; c++) {
    row[c] = row_of[model->members.from[j] + (uint32_t)c];
    row[2 + c] = row_of[model->members.to[j] + (uint32_t)c];
  }
}

static void add_masses(const strut_model *model, const int32_t *row_of, strut_triplets *sum) {
  for (int c = 0; c < 2; c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    for (int32_t j = 0; j < op->matrix->n; j++)
      for (int32_t k = op->matrix->start[j]; k < op->matrix->start[j + 1]; k++)
        strut_triplets_add(sum, row_of[2 * op->matrix_node[op->matrix->row[k]] + c],
                           row_of[2 * op->matrix_node[j] + c], op->matrix->value[k]);
  }
}

static size_t mass_entries(const strut_model *model) {
  const strut_mass_operator *op = model->mass->coordinate;
  return (size_t)op[0].matrix->start[op[0].matrix->n] +
         (size_t)op[1].matrix->start[op[1].matrix->n];
}

/* M with room for what members add: the pattern of the step's matrix. */
static bool make_pattern(const strut_model *model, const int32_t *row_of, strut_arena *arena,
                         strut_midpoint_matrix *m) {
  strut_arena scratch = {0};
  strut_triplets sum = {0};
  size_t most = STRUT_MIDPOINT_PLACES * (size_t)model->members.count + mass_entries(model);
  bool good = strut_triplets_reserve(&sum, most, &scratch);
  if (good) {
    add_masses(model, row_of, &sum);
    for (int32_t j = 0; j < model->members.count; j++) {
      int32_t row[4];
      rows_of(model, row_of, j, row);
      for (int k = 0; k < STRUT_MIDPOINT_PLACES; k++) {
        int32_t a = row[row_of_place[k]], b = row[column_of_place[k]];
        if (a >= 0 && b >= 0) strut_triplets_add(&sum, a, b, 0.0);
      }
    }
    m->matrix = strut_sparse_build(m->n, &sum, arena);
  }
  strut_arena_free(&scratch);
  return good && m->matrix;
}

static int32_t find_place(const strut_sparse *matrix, int32_t a, int32_t b) {
  int32_t column = a < b ? a : b, row = a < b ? b : a;
  for (int32_t k = matrix->start[column]; k < matrix->start[column + 1]; k++)
    if (matrix->row[k] == row) return k;
  return -1;
}

static void find_places(const strut_model *model, const int32_t *row_of, strut_midpoint_matrix *m) {
  for (int32_t j = 0; j < model->members.count; j++) {
    int32_t row[4];
    rows_of(model, row_of, j, row);
    for (int k = 0; k < STRUT_MIDPOINT_PLACES; k++) {
      int32_t a = row[row_of_place[k]], b = row[column_of_place[k]];
      m->place[STRUT_MIDPOINT_PLACES * j + k] = a >= 0 && b >= 0 ? find_place(m->matrix, a, b) : -1;
    }
  }
}

static bool make_members(const strut_model *model, strut_arena *arena, strut_midpoint_matrix *m) {
  const strut_member_table *t = &model->members;
  double **all[] = {&m->lightness, &m->way[0], &m->way[1], &m->slope};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    if (!(*all[i] = strut_arena_allocate(arena, (size_t)t->count, sizeof(double)))) return false;
  for (int32_t j = 0; j < t->count; j++)
    for (int e = 0; e < 2; e++) {
      uint32_t at = e ? t->to[j] : t->from[j];
      if (!model->fixed[at] || !model->fixed[at + 1])
        m->lightness[j] += 1.0 / model->weight[at / 2];
    }
  return true;
}

bool strut_midpoint_matrix_create(const strut_model *model, strut_arena *arena,
                                  strut_midpoint_matrix *m) {
  size_t both = (size_t)model->length, members = (size_t)model->members.count;
  int32_t *row_of = strut_arena_allocate(arena, both, sizeof *row_of);
  m->coordinate = strut_arena_allocate(arena, both, sizeof *m->coordinate);
  m->place = strut_arena_allocate(arena, STRUT_MIDPOINT_PLACES * members, sizeof *m->place);
  if (!row_of || !m->coordinate || !m->place) return false;
  m->n = 0;
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    row_of[at] = model->fixed[at] ? -1 : m->n;
    if (!model->fixed[at]) m->coordinate[m->n++] = at;
  }
  if (m->n == 0) return true;
  if (!make_members(model, arena, m)) return false;
  if (!make_pattern(model, row_of, arena, m)) return false;
  size_t entries = (size_t)m->matrix->start[m->n];
  m->mass = strut_arena_allocate(arena, entries, sizeof *m->mass);
  m->factor = strut_refactor_create(m->matrix, arena);
  if (!m->mass || !m->factor) return false;
  memcpy(m->mass, m->matrix->value, entries * sizeof *m->mass);
  find_places(model, row_of, m);
  return true;
}

/* The direction of a member's force; 0 where it has none. */
static void way_of(const strut_discrete_gradient *step, int32_t j, double way[2]) {
  double x = step->sum[0][j], y = step->sum[1][j], size = sqrt(x * x + y * y);
  way[0] = size > 0.0 ? x / size : 0.0;
  way[1] = size > 0.0 ? y / size : 0.0;
}

/* Adds h^2/2 of what the forces of member j change by with its end: B, -B, B. */
static void add_member(const strut_discrete_gradient *step, int32_t j, double tension,
                       strut_midpoint_matrix *m) {
  double half = 0.5 * step->h * step->h, lengths = step->lengths[j], way[2];
  const int32_t *place = m->place + STRUT_MIDPOINT_PLACES * j;
  double *value = m->matrix->value;
  way_of(step, j, way);
  double ux = m->way[0][j] = way[0], uy = m->way[1][j] = way[1];
  bool shapeless = ux == 0.0 && uy == 0.0; /* as an isotropic spring */
  m->slope[j] = step->slope[j];
  double across = shapeless ? step->slope[j] : tension / lengths, along = step->slope[j] - across;
  double block[3] = {half * (across + along * ux * ux), half * along * ux * uy,
                     half * (across + along * uy * uy)};
  for (int k = 0; k < STRUT_MIDPOINT_PLACES; k++) {
    int32_t row = row_of_place[k], column = column_of_place[k];
    double part = block[row % 2 + column % 2];
    if (place[k] >= 0) value[place[k]] += row / 2 == column / 2 ? part : -part;
  }
}

bool strut_midpoint_matrix_update(const strut_model *model, const strut_discrete_gradient *step,
                                  const double *tension, bool stiff, strut_midpoint_matrix *m) {
  for (bool clip = stiff;; clip = true) {
    memcpy(m->matrix->value, m->mass, (size_t)m->matrix->start[m->n] * sizeof *m->mass);
    for (int32_t j = 0; j < model->members.count; j++)
      add_member(step, j, clip ? fmax(tension[j], 0.0) : tension[j], m);
    if (strut_refactor_apply(m->factor, m->matrix) < 0) return true;
    if (clip) return false;
  }
}

bool strut_midpoint_matrix_stale(const strut_model *model, const strut_discrete_gradient *step,
                                 const strut_midpoint_matrix *m) {
  const double much = 1e-3;
  for (int32_t j = 0; j < model->members.count; j++) {
    double per_mass = 0.5 * step->h * step->h * m->lightness[j], way[2];
    way_of(step, j, way);
    double sine = way[0] * m->way[1][j] - way[1] * m->way[0][j];
    double change = fabs(step->slope[j] - m->slope[j]);
    if (per_mass * step->slope[j] * sine * sine > much) return true;
    if (per_mass * change > much * (1.0 + per_mass * m->slope[j])) return true;
  }
  return false;
}

void strut_midpoint_matrix_mass(const strut_midpoint_matrix *m, const double *x, double *product) {
  const strut_sparse *a = m->matrix;
  for (int32_t i = 0; i < m->n; i++) product[i] = 0.0;
  for (int32_t j = 0; j < m->n; j++) {
    double xj = x[m->coordinate[j]];
    product[j] += m->mass[a->start[j]] * xj;
    for (int32_t k = a->start[j] + 1; k < a->start[j + 1]; k++) {
      product[a->row[k]] += m->mass[k] * xj;
      product[j] += m->mass[k] * x[m->coordinate[a->row[k]]];
    }
  }
}
