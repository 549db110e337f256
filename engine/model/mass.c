/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/mass.h"

#include "engine/base/indices.h"
#include "engine/model/algebra/hot.h"
#include "engine/model/mass_kernel.h"

/* Disjoint sets of rows that masses couple: parent[i] leads to the smallest row of the set. */
static void join_coupled(const strut_sparse *matrix, int32_t *parent) {
  for (int32_t i = 0; i < matrix->n; i++) parent[i] = i;
  for (int32_t j = 0; j < matrix->n; j++)
    for (int32_t k = matrix->start[j] + 1; k < matrix->start[j + 1]; k++) {
      int32_t a = strut_index_root(parent, j), b = strut_index_root(parent, matrix->row[k]);
      if (a < b) parent[b] = a;
      if (b < a) parent[a] = b;
    }
  for (int32_t i = 0; i < matrix->n; i++) parent[i] = strut_index_root(parent, i);
}

/* Inverse of a small positive definite matrix in place, by Gauss-Jordan; false if it is not one. */
static bool invert_small(int32_t n, double *matrix) {
  for (int32_t p = 0; p < n; p++) {
    double pivot = matrix[p * n + p];
    if (!(pivot > 0)) return false;
    matrix[p * n + p] = 1.0;
    for (int32_t j = 0; j < n; j++) matrix[p * n + j] /= pivot;
    for (int32_t i = 0; i < n; i++) {
      if (i == p) continue;
      double factor = matrix[i * n + p];
      matrix[i * n + p] = 0.0;
      for (int32_t j = 0; j < n; j++) matrix[i * n + j] -= factor * matrix[p * n + j];
    }
  }
  return true;
}

/* What each row of M becomes, found from the size of its coupled set. */
typedef struct sorting {
  int32_t *root, *size; /* of each row's set; size stands at the root */
  int32_t *order;       /* rows, sets together, each set's rows ascending */
  int32_t *place;       /* scratch */
} sorting;

static bool sort_rows(const strut_sparse *matrix, strut_arena *scratch, sorting *self) {
  size_t n = (size_t)matrix->n;
  if (!STRUT_ALLOCATE(scratch, STRUT_NEW(self->root, n), STRUT_NEW(self->size, n),
                      STRUT_NEW(self->order, n), STRUT_NEW(self->place, n + 1)))
    return false;
  join_coupled(matrix, self->root);
  for (int32_t i = 0; i < matrix->n; i++) self->size[self->root[i]]++;
  for (int32_t i = 0, at = 0; i < matrix->n; at += self->size[i++]) self->place[i] = at;
  for (int32_t i = 0; i < matrix->n; i++) self->order[self->place[self->root[i]]++] = i;
  return true;
}

static double entry(const strut_sparse *matrix, int32_t i, int32_t j) {
  int32_t column = i < j ? i : j, row = i < j ? j : i;
  for (int32_t k = matrix->start[column]; k < matrix->start[column + 1]; k++)
    if (matrix->row[k] == row) return matrix->value[k];
  return 0.0;
}

/* Dense inverses of all sets of 2 to STRUT_DENSE_BLOCK rows. */
static strut_status make_blocks(strut_model *model, const sorting *self, strut_mass_operator *op,
                                strut_mass *mass, strut_error *error) {
  const strut_sparse *matrix = op->matrix;
  size_t nodes = 0, entries = 0;
  for (int32_t i = 0; i < matrix->n; i++)
    if (self->size[i] > 1 && self->size[i] <= STRUT_DENSE_BLOCK) {
      op->block_count++;
      nodes += (size_t)self->size[i];
      entries += (size_t)(self->size[i] * self->size[i]);
    }
  if (!op->block_count) return STRUT_OK;
  int32_t *size = strut_arena_allocate(&model->arena, (size_t)op->block_count, sizeof *size);
  uint32_t *at = strut_arena_allocate(&model->arena, nodes, sizeof *at);
  double *inverse = strut_arena_allocate(&model->arena, entries, sizeof *inverse);
  if (!size || !at || !inverse) return strut_no_memory(error, "for the model");
  op->block_size = size, op->block_at = at, op->block_inverse = inverse;
  mass->dense_entries += entries;
  for (int32_t first = 0; first < matrix->n;) {
    const int32_t *rows = self->order + first;
    int32_t n = self->size[self->root[rows[0]]];
    first += n;
    if (n < 2 || n > STRUT_DENSE_BLOCK) continue;
    for (int32_t i = 0; i < n; i++)
      for (int32_t j = 0; j < n; j++) inverse[i * n + j] = entry(matrix, rows[i], rows[j]);
    if (!invert_small(n, inverse))
      return strut_fail(error, STRUT_SINGULAR, "the mass matrix of node '%s' is singular",
                        model->scene->nodes[op->matrix_node[rows[0]]].name);
    for (int32_t i = 0; i < n; i++) *at++ = 2 * (uint32_t)op->matrix_node[rows[i]];
    inverse += n * n;
    *size++ = n;
  }
  return STRUT_OK;
}

/* The rows of large sets as one matrix of their own; its node list is returned in *node. */
static strut_status take_rest(strut_arena *scratch, const sorting *self, const strut_sparse *matrix,
                              const int32_t *matrix_node, strut_sparse *rest, int32_t **node) {
  int32_t *map;
  if (!STRUT_ALLOCATE(scratch, STRUT_NEW(map, matrix->n), STRUT_NEW(*node, matrix->n),
                      STRUT_NEW(rest->start, (size_t)matrix->n + 1),
                      STRUT_NEW(rest->row, (size_t)matrix->start[matrix->n]),
                      STRUT_NEW(rest->value, (size_t)matrix->start[matrix->n])))
    return STRUT_NO_MEMORY;
  int32_t nonzeros = 0;
  for (int32_t i = 0; i < matrix->n; i++)
    if (self->size[self->root[i]] > STRUT_DENSE_BLOCK) {
      (*node)[rest->n] = matrix_node[i];
      map[i] = rest->n++;
    }
  for (int32_t j = 0, column = 0; j < matrix->n; j++) {
    if (self->size[self->root[j]] <= STRUT_DENSE_BLOCK) continue;
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++, nonzeros++) {
      rest->row[nonzeros] = map[matrix->row[k]];
      rest->value[nonzeros] = matrix->value[k];
    }
    rest->start[++column] = nonzeros;
  }
  return STRUT_OK;
}

static strut_status make_factor(strut_model *model, strut_arena *scratch, const sorting *self,
                                strut_mass_operator *op, strut_mass *mass, int coordinate,
                                strut_error *error) {
  strut_sparse rest = {0};
  int32_t *node = NULL;
  if (take_rest(scratch, self, op->matrix, op->matrix_node, &rest, &node))
    return strut_no_memory(error, "for the model");
  if (!rest.n) return STRUT_OK;
  strut_factor *factor = NULL;
  strut_status status = strut_factor_create(&rest, &factor, error);
  if (status) return status;
  mass->owned_factor[coordinate] = factor;
  mass->factor_nonzeros += (size_t)factor->start[factor->n] + (size_t)factor->n;
  op->factor = factor;
  int32_t *ordered = strut_arena_allocate(&model->arena, (size_t)rest.n, sizeof *ordered);
  if (!ordered) return strut_no_memory(error, "for the model");
  for (int32_t i = 0; i < rest.n; i++) ordered[i] = node[factor->order[i]];
  op->factor_node = ordered;
  return STRUT_OK;
}

static strut_status make_operator(strut_model *model, strut_arena *scratch, strut_mass *mass,
                                  int coordinate, strut_error *error) {
  strut_mass_operator *op = &mass->coordinate[coordinate];
  sorting s = {0};
  strut_sparse *matrix = NULL;
  int32_t *node = NULL;
  strut_status status = strut_mass_matrix(model, coordinate, scratch, &matrix, &node);
  double *inverse = strut_arena_allocate(&model->arena, (size_t)model->length, sizeof *inverse);
  if (status || !inverse || !sort_rows(matrix, scratch, &s))
    return strut_no_memory(error, "for the model");
  op->matrix = matrix, op->matrix_node = node, op->inverse = inverse;
  mass->matrix_nonzeros += (size_t)matrix->start[matrix->n];
  for (int32_t i = 0; i < matrix->n; i++)
    if (s.size[s.root[i]] == 1) {
      inverse[2 * node[i] + coordinate] = 1.0 / matrix->value[matrix->start[i]];
      mass->any_single = true;
    }
  status = make_blocks(model, &s, op, mass, error);
  return status ? status : make_factor(model, scratch, &s, op, mass, coordinate, error);
}

/* A free coordinate without mass cannot be moved: such a model is for statics only. */
static bool has_massless_node(const strut_model *model) {
  if (model->sliding.massless_node) return true;
  for (int32_t i = 0; i < model->node_count; i++)
    if (!(model->weight[i] > 0) && !(model->fixed[2 * i] && model->fixed[2 * i + 1])) return true;
  return false;
}

strut_status strut_mass_create(strut_model *model, strut_mass **result, strut_error *error) {
  *result = NULL;
  if (has_massless_node(model)) return STRUT_OK;
  strut_mass *mass = strut_allocate(1, sizeof *mass);
  if (!mass) return strut_no_memory(error, "for the model");
  strut_arena scratch = {0};
  strut_status status = make_operator(model, &scratch, mass, 0, error);
  mass->shared = true;
  for (int32_t i = 0; i < model->node_count; i++)
    if (model->fixed[2 * i] != model->fixed[2 * i + 1]) mass->shared = false;
  if (!status && mass->shared) /* x and y have one matrix */
    mass->coordinate[1] = mass->coordinate[0];
  else if (!status)
    status = make_operator(model, &scratch, mass, 1, error);
  double *inverse = (double *)mass->coordinate[0].inverse; /* of both coordinates */
  for (int32_t i = 0; i < model->node_count && !status; i++)
    inverse[2 * i + 1] = mass->coordinate[1].inverse[2 * i + (mass->shared ? 0 : 1)];
  strut_arena_free(&scratch);
  if (status) {
    strut_mass_free(mass);
    return status;
  }
  const strut_mass_operator *op = mass->coordinate;
  mass->inverse = op[0].inverse;
  for (int32_t i = 0; i < model->feedback.state_count; i++) { /* the rate of a state is its force */
    ((double *)op[0].inverse)[model->feedback.base + i] = 1.0;
    mass->any_single = true;
  }
  mass->diagonal = !op[0].block_count && !op[0].factor && !op[1].block_count && !op[1].factor;
  *result = mass;
  return STRUT_OK;
}

void strut_mass_free(strut_mass *mass) {
  if (!mass) return;
  strut_factor_free(mass->owned_factor[0]);
  strut_factor_free(mass->owned_factor[1]);
  strut_release(mass);
}

/* Masses at both ends, and what they share. */
static void add_ends(const int32_t *row_of, const uint32_t end[2], double first, double second,
                     double shared, strut_triplets *sum) {
  for (uint32_t c = 0; c < 2; c++) {
    int32_t a = row_of[end[0] + c], b = row_of[end[1] + c];
    if (a >= 0) strut_triplets_add(sum, a, a, first);
    if (b >= 0) strut_triplets_add(sum, b, b, second);
    if (a >= 0 && b >= 0 && shared > 0.0) strut_triplets_add(sum, a, b, shared);
  }
}

void strut_mass_add(const strut_model *model, const int32_t *row_of, double factor, bool moving,
                    strut_triplets *sum) {
  const strut_member_table *members = &model->members;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    if (row_of[at] >= 0 && model->point_mass[at / 2] > 0)
      strut_triplets_add(sum, row_of[at], row_of[at], factor * model->point_mass[at / 2]);
  for (int32_t j = 0; j < members->count; j++) {
    const uint32_t end[2] = {members->from[j], members->to[j]};
    double mass = factor * members->mass[j], own = consistent ? mass / 3.0 : mass / 2.0;
    if (mass > 0.0) add_ends(row_of, end, own, own, consistent ? mass / 6.0 : 0.0, sum);
  }
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *item = &model->sliding.item[i];
    double mass = factor * item->mass, far = item->start, near = 1.0 - far;
    if (moving || item->signal < 0)
      add_ends(row_of, item->at, mass * near * near, mass * far * far, mass * near * far, sum);
  }
}

strut_status strut_mass_matrix(strut_model *model, int coordinate, strut_arena *scratch,
                               strut_sparse **matrix, int32_t **node) {
  size_t count = (size_t)model->node_count;
  strut_triplets sum = {0};
  int32_t n = 0, *row_of = strut_arena_allocate(scratch, 2 * count, sizeof *row_of);
  *node = strut_arena_allocate(&model->arena, count, sizeof **node);
  if (!row_of || !*node || !strut_triplets_reserve(&sum, strut_mass_entries(model), scratch))
    return STRUT_NO_MEMORY;
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    row_of[at] = at % 2 != coordinate || model->fixed[at] ? -1 : n;
    if (row_of[at] >= 0) (*node)[n++] = at / 2;
  }
  strut_mass_add(model, row_of, 1.0, false, &sum);
  *matrix = strut_sparse_build(n, &sum, &model->arena);
  return *matrix ? STRUT_OK : STRUT_NO_MEMORY;
}

/* The mass solve for single evaluations; the step's own loop has mass_kernel.h. */

void strut_mass_solve(const strut_model *model, const double *restrict force,
                      double *restrict acceleration, double *restrict work) {
  mass_kernel(model, force, acceleration, work);
}

/* The sparse part of the mass solve, long enough to be called. See mass.h. */

void strut_mass_factor_pair(const strut_mass_operator *op, const double *restrict f,
                            double *restrict acceleration, double *restrict work) {
  int32_t n = op->factor->n;
  for (int32_t i = 0; i < n; i++)
    strut_pair_store(work + 2 * i, strut_pair_load(f + 2 * op->factor_node[i]));
  strut_factor_solve_pair(op->factor, work);
  for (int32_t i = 0; i < n; i++)
    strut_pair_store(acceleration + 2 * op->factor_node[i], strut_pair_load(work + 2 * i));
}

void strut_mass_factor_single(const strut_mass_operator *op, const double *restrict f,
                              double *restrict acceleration, double *restrict work) {
  int32_t n = op->factor->n;
  for (int32_t i = 0; i < n; i++) work[i] = f[2 * op->factor_node[i]];
  strut_factor_solve(op->factor, work);
  for (int32_t i = 0; i < n; i++) acceleration[2 * op->factor_node[i]] = work[i];
}
