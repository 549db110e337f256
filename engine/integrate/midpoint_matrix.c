/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/midpoint_matrix.h"

#include <math.h>
#include <string.h>

#include "engine/model/mass.h"

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
  size_t most = strut_tangent_entries(model, false) + mass_entries(model);
  bool good = strut_triplets_reserve(&sum, most, &scratch);
  if (good) {
    add_masses(model, row_of, &sum);
    strut_tangent_add_pattern(model, row_of, false, &sum);
    m->matrix = strut_sparse_build(m->n, &sum, arena);
  }
  strut_arena_free(&scratch);
  return good && m->matrix;
}

static bool make_members(const strut_model *model, strut_arena *arena, strut_midpoint_matrix *m) {
  const strut_member_table *t = &model->members;
  m->lightness = strut_arena_allocate(arena, (size_t)t->count, sizeof *m->lightness);
  m->direction = strut_arena_allocate(arena, (size_t)t->count, sizeof *m->direction);
  m->slope = strut_arena_allocate(arena, (size_t)t->count, sizeof *m->slope);
  if (!m->lightness || !m->direction || !m->slope) return false;
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
  size_t both = (size_t)model->length, entries_most = strut_tangent_entries(model, false);
  int32_t *row_of = strut_arena_allocate(arena, both, sizeof *row_of);
  m->coordinate = strut_arena_allocate(arena, both, sizeof *m->coordinate);
  m->place = strut_arena_allocate(arena, entries_most, sizeof *m->place);
  if (!row_of || !m->coordinate || !m->place) return false;
  m->n = strut_number_free(model, NULL, row_of, m->coordinate);
  if (m->n == 0) return true;
  if (!make_members(model, arena, m)) return false;
  if (!make_pattern(model, row_of, arena, m)) return false;
  size_t entries = (size_t)m->matrix->start[m->n];
  m->mass = strut_arena_allocate(arena, entries, sizeof *m->mass);
  m->factor = strut_refactor_create(m->matrix, arena);
  if (!m->mass || !m->factor) return false;
  memcpy(m->mass, m->matrix->value, entries * sizeof *m->mass);
  strut_tangent_find_places(model, row_of, false, m->matrix, m->place);
  return true;
}

/* The direction of a member's force; 0 where it has none. */
static strut_vec2 force_direction(const strut_discrete_gradient *step, int32_t j) {
  strut_vec2 sum = {step->sum[0][j], step->sum[1][j]};
  return strut_vec2_unit(sum, strut_vec2_length(sum));
}

/* Adds h^2/2 of what the forces of member j change by with its end: B, -B, B. */
static void add_member(const strut_discrete_gradient *step, int32_t j, double tension,
                       strut_midpoint_matrix *m) {
  double half = 0.5 * step->h * step->h, lengths = step->lengths[j];
  strut_vec2 u = m->direction[j] = force_direction(step, j);
  bool shapeless = u.x == 0.0 && u.y == 0.0; /* as an isotropic spring */
  m->slope[j] = step->slope[j];
  strut_stiffness_block block =
      strut_block_of(step->slope[j], shapeless ? step->slope[j] : tension / lengths, u);
  for (int k = 0; k < 3; k++) block.part[k] *= half;
  strut_block_scatter(&block, STRUT_MEMBER_ENTRIES, m->place + STRUT_MEMBER_ENTRIES * j,
                      m->matrix->value);
}

/* What the average force changes by with the end; it turns with half of the force there. */
static void add_element(const strut_model *model, const strut_discrete_gradient *step, int32_t i,
                        const double *rest, const double *q, bool clip, strut_midpoint_matrix *m) {
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  int32_t n = 2 * model->elements.element[i].nodes;
  strut_element_pose pose;
  strut_element_evaluate(model, i, rest, q, step->strain0[i], &pose);
  double half = 0.5 * step->h * step->h, along = half * step->element_slope[i];
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++) k[r * n + c] = along * pose.b[r] * pose.b[c];
  if (!clip) strut_element_bend(model, i, q, 0.5 * half * pose.force, k);
  strut_element_scatter(model, i, k, m->place + strut_places_of_elements(model), m->matrix->value);
}

bool strut_midpoint_matrix_update(const strut_model *model, const strut_discrete_gradient *step,
                                  const double *rest, const double *q, const double *tension,
                                  bool stiff, strut_midpoint_matrix *m) {
  for (bool clip = stiff;; clip = true) {
    double whole = 1.0 + 0.5 * step->h * model->mass_damping;
    for (int32_t k = 0; k < m->matrix->start[m->n]; k++) m->matrix->value[k] = whole * m->mass[k];
    for (int32_t j = 0; j < model->members.count; j++)
      add_member(step, j, clip ? fmax(tension[j], 0.0) : tension[j], m);
    for (int32_t i = 0; i < model->elements.count; i++)
      add_element(model, step, i, rest, q, clip, m);
    if (strut_refactor_apply(m->factor, m->matrix) < 0) return true;
    if (clip) return false;
  }
}

bool strut_midpoint_matrix_stale(const strut_model *model, const strut_discrete_gradient *step,
                                 const strut_midpoint_matrix *m) {
  const double much = 1e-3;
  for (int32_t j = 0; j < model->members.count; j++) {
    double per_mass = 0.5 * step->h * step->h * m->lightness[j];
    strut_vec2 u = force_direction(step, j), before = m->direction[j];
    double sine = u.x * before.y - u.y * before.x;
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
