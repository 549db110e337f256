/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/forces/tangent.h"
#include "engine/model/mass.h"
#include "engine/model/pose.h"
#include "engine/statics/algebra.h"
#include "engine/statics/rigidity/rigidity_parts.h"

enum { ENTRIES = 4 }; /* of a column at most */

static void add_entry(strut_equilibrium_matrix *matrix, int32_t row, double value) {
  if (row < 0 || value == 0.0) return;
  int32_t at = matrix->start[matrix->columns]++;
  matrix->row[at] = row;
  matrix->value[at] = value;
}

static int compare_rows(const void *first, const void *second) {
  const double x = *(const double *)first, y = *(const double *)second;
  return x < y ? -1 : x > y;
}

/* The column after the last: the gradient of a force times `scale`, with the entries of a node that it meets twice summed. */
static void add_gradient(const strut_force *force, double scale, strut_equilibrium_matrix *matrix) {
  double entry[STRUT_MOST_GRADIENT][2];
  size_t count = 0;
  int32_t j = matrix->columns++;
  matrix->start[j + 1] = matrix->start[j];
  matrix->curved[j] = -1;
  for (int32_t k = 0; k < 2 * force->nodes; k++) {
    int32_t row = matrix->row_of[strut_force_coordinate(force, k)];
    if (row >= 0) entry[count][0] = row, entry[count++][1] = scale * force->pose.b[k];
  }
  qsort(entry, count, sizeof entry[0], compare_rows);
  for (size_t k = 0; k < count; k++) {
    double sum = entry[k][1];
    while (k + 1 < count && entry[k + 1][0] == entry[k][0]) sum += entry[++k][1];
    add_entry(matrix, (int32_t)entry[k][0], sum);
  }
  matrix->scale[j] = scale;
  matrix->length[j] = scale * force->pose.strain;
}

/* The column of an element, and what its forces lend to motions across it, where that bends; false: out of memory. */
static bool add_element(const strut_model *model, const strut_element *e, const double *positions,
                        strut_arena *arena, strut_equilibrium_matrix *matrix) {
  strut_force force;
  double scale = e->role == STRUT_ELEMENT_CELL    ? 1.0 / matrix->size
                 : e->role == STRUT_ELEMENT_HINGE ? matrix->size
                                                  : 1.0;
  int32_t element = (int32_t)(e - model->elements.element), j = matrix->columns;
  strut_force_begin(model, model->members.count + element, &force);
  strut_element_evaluate(model, element, model->members.rest, positions, (double)NAN, &force.pose);
  add_gradient(&force, scale, matrix);
  if (strut_element_is_of_member(e) && e->strain == STRUT_STRAIN_LENGTH) return true;
  size_t n = 2 * (size_t)e->nodes;
  double *bend = matrix->bend[j] = strut_arena_allocate(arena, n * n, sizeof *bend);
  if (!bend) return false;
  matrix->curved[j] = element;
  strut_element_bend(model, element, positions, scale, bend);
  double largest = matrix->curvature[j] = strut_largest_magnitude(bend, (ptrdiff_t)(n * n));
  for (size_t k = 0; k < n * n && largest > 0; k++) bend[k] /= largest;
  return true;
}

static bool add_member(const strut_model *model, const double *positions, strut_arena *arena,
                       strut_equilibrium_matrix *matrix) {
  const strut_member_table *members = &model->members;
  int32_t j = matrix->columns;
  strut_member_pose pose = strut_member_pose_at(members, members->rest, j, positions);
  strut_force force;
  matrix->direction[j][0] = pose.unit.x, matrix->direction[j][1] = pose.unit.y;
  if (strut_member_is_element(&model->elements, j))
    return add_element(model, strut_element_of_member(&model->elements, j), positions, arena,
                       matrix);
  strut_force_begin(model, j, &force);
  strut_force_set_member(members->stiffness[j], 0.0, pose.unit, pose.length, pose.stretch, &force);
  add_gradient(&force, 1.0, matrix);
  return true;
}

/* Hinges in the scene's order, then cells, then distances. */
static bool add_elements(const strut_model *model, const double *positions, strut_arena *arena,
                         strut_equilibrium_matrix *matrix) {
  const strut_element_table *elements = &model->elements;
  size_t hinges = model->scene->hinge_count, cells = hinges + model->scene->cell_count,
         all = cells + model->scene->distance_count;
  const strut_element **element = strut_arena_allocate(arena, all + 1, sizeof *element);
  if (!element) return false;
  for (int32_t i = 0; i < elements->count; i++) {
    const strut_element *e = &elements->element[i];
    if (e->role == STRUT_ELEMENT_HINGE) element[e->item] = e;
    if (e->role == STRUT_ELEMENT_CELL) element[hinges + (size_t)e->item] = e;
    if (e->role == STRUT_ELEMENT_DISTANCE) element[cells + (size_t)e->item] = e;
  }
  for (size_t i = 0; i < all; i++)
    if (!add_element(model, element[i], positions, arena, matrix)) return false;
  return true;
}

strut_status strut_equilibrium_matrix_build(const strut_model *model, const double *positions,
                                            strut_arena *arena, strut_equilibrium_matrix *matrix) {
  size_t members = (size_t)model->members.count, length = (size_t)model->length;
  size_t columns = (size_t)strut_equilibrium_columns(model);
  *matrix = (strut_equilibrium_matrix){.members = model->members.count,
                                       .size = model->size > 0 ? model->size : 1.0};
  size_t most = ENTRIES * members + 1;
  for (int32_t i = 0; i < model->elements.count; i++)
    most += 2 * (size_t)model->elements.element[i].nodes;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(matrix->coordinate, length),
                      STRUT_NEW(matrix->row_of, length), STRUT_NEW(matrix->direction, columns + 1),
                      STRUT_NEW(matrix->start, columns + 1), STRUT_NEW(matrix->curved, columns + 1),
                      STRUT_NEW(matrix->bend, columns + 1), STRUT_NEW(matrix->row, most)) ||
      !STRUT_NUMBERS(arena, most, &matrix->value) ||
      !STRUT_NUMBERS(arena, columns + 1, &matrix->length, &matrix->scale, &matrix->curvature))
    return STRUT_NO_MEMORY;
  matrix->rows = strut_number_free(model, NULL, matrix->row_of, matrix->coordinate);
  for (int32_t j = 0; j < model->members.count; j++)
    if (!add_member(model, positions, arena, matrix)) return STRUT_NO_MEMORY;
  return add_elements(model, positions, arena, matrix) ? STRUT_OK : STRUT_NO_MEMORY;
}

void strut_equilibrium_multiply(const strut_equilibrium_matrix *matrix, const double *t,
                                double *y) {
  memset(y, 0, (size_t)matrix->rows * sizeof *y);
  for (int32_t j = 0; j < matrix->columns; j++)
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++)
      y[matrix->row[k]] += matrix->value[k] * t[j];
}

void strut_equilibrium_elongate(const strut_equilibrium_matrix *matrix, const double *change,
                                double *e) {
  for (int32_t j = 0; j < matrix->columns; j++) {
    e[j] = 0.0;
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++)
      e[j] += matrix->value[k] * change[matrix->row[k]];
  }
}

typedef struct sums {
  strut_triplets mass, elastic, geometric, contact;
  const strut_model *model;
  const double *q;
  int32_t *row_of;
  int32_t touching;
} sums;

/* Along its strain into the elastic part, across it into the geometric one; contacts into one of their own. */
static void add_force(sums *self, const strut_force *force) {
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  int32_t n = 2 * force->nodes;
  bool contact = force->kind == STRUT_FORCE_CONTACT;
  strut_triplets *elastic = contact ? &self->contact : &self->elastic;
  self->touching += contact;
  if (contact || !(force->pose.strain > 0.0 || force->kind == STRUT_FORCE_ELEMENT)) {
    strut_force_stiffness(self->model, force, self->q,
                          k); /* or an isotropic spring, which has no direction */
    if (contact || force->across > 0.0) strut_force_add(force, k, self->row_of, elastic);
    return;
  }
  strut_force_square(force, force->pose.slope, k);
  strut_force_add(force, k, self->row_of, elastic);
  memset(k, 0, (size_t)(n * n) * sizeof *k);
  strut_force_bend(self->model, force, self->q, 1.0, k);
  strut_force_add(force, k, self->row_of, &self->geometric);
}

static bool reserve(const strut_model *model, sums *self, strut_arena *scratch) {
  size_t most = strut_tangent_entries(model, false), contacts = (size_t)model->contacts.count;
  return strut_triplets_reserve(&self->mass, strut_mass_entries(model), scratch) &&
         strut_triplets_reserve(&self->elastic, most + 1, scratch) &&
         strut_triplets_reserve(&self->geometric, most + 1, scratch) &&
         strut_triplets_reserve(&self->contact, 3 * contacts + 1, scratch);
}

strut_status strut_linear_matrices_build(const strut_model *model, const double *positions,
                                         strut_arena *arena, strut_linear_matrices *matrices) {
  strut_arena scratch = {0};
  sums s = {.model = model, .q = positions};
  strut_tangent tangent = {0};
  *matrices = (strut_linear_matrices){0};
  s.row_of = strut_arena_allocate(&scratch, (size_t)model->length, sizeof *s.row_of);
  int32_t *coordinate = strut_arena_allocate(&scratch, (size_t)model->length, sizeof *coordinate);
  strut_status status = STRUT_NO_MEMORY;
  if (s.row_of && coordinate && reserve(model, &s, &scratch)) {
    int32_t n = matrices->n = strut_number_free(model, NULL, s.row_of, coordinate);
    strut_mass_add(model, s.row_of, 1.0, true, &s.mass);
    strut_force_visit visit = {.model = model,
                               .q = positions,
                               .rest = model->members.rest,
                               .least = -HUGE_VAL,
                               .closed = STRUT_CLOSED_TOUCHING};
    for (const strut_force *force; (force = strut_force_next(&visit));) add_force(&s, force);
    matrices->mass = strut_sparse_build(n, &s.mass, arena);
    matrices->elastic = strut_sparse_build(n, &s.elastic, arena);
    matrices->geometric = strut_sparse_build(n, &s.geometric, arena);
    if (s.touching) matrices->contact = strut_sparse_build(n, &s.contact, arena);
    status = strut_tangent_assemble(model, positions, model->members.rest, STRUT_CLOSED_TOUCHING,
                                    arena, &tangent);
    matrices->damping = tangent.damping;
    bool built = matrices->mass && matrices->elastic && matrices->geometric &&
                 (matrices->contact || !s.touching);
    if (!built) status = STRUT_NO_MEMORY;
  }
  strut_arena_free(&scratch);
  return status;
}

/* Bases with more vectors, or more numbers, than these are not computed. */
enum { MOST_VECTORS = 200, MOST_NUMBERS = 4000000 };

static void decide_rank(const double *value, int32_t count, strut_null_spaces *spaces) {
  int32_t rank = 0;
  spaces->largest = value[0];
  while (rank < count && value[rank] > STRUT_RANK_TOLERANCE * value[0]) rank++;
  spaces->rank = rank;
  spaces->kept = rank > 0 ? value[rank - 1] : 0.0;
  spaces->dropped = rank < count ? value[rank] : 0.0;
  for (int32_t i = 0; i < rank; i++) spaces->weak += value[i] < STRUT_WEAK * value[0];
}

/*
 * Orthonormal rows that A, or its transpose, maps to zero: the right singular vectors of the values dropped. The rank
 * is decided by those of A. Not by GSL's one-sided Jacobi: it stops early where several values are zero.
 */
static strut_status find_null(const strut_equilibrium_matrix *matrix, bool transposed,
                              strut_arena *arena, strut_null_spaces *spaces, double **basis,
                              strut_error *error) {
  size_t n = (size_t)(transposed ? matrix->rows : matrix->columns),
         other = (size_t)(transposed ? matrix->columns : matrix->rows);
  strut_arena scratch = {0};
  gsl_matrix *u = strut_arena_matrix(&scratch, n > other ? n : other, n),
             *v = strut_arena_matrix(&scratch, n, n);
  gsl_vector *value = strut_arena_vector(&scratch, n), *work = strut_arena_vector(&scratch, n);
  bool made = u && v && value && work, good = made;
  for (int32_t j = 0; j < matrix->columns && made; j++)
    for (int32_t k = matrix->start[j]; k < matrix->start[j + 1]; k++) {
      size_t row = (size_t)matrix->row[k], column = (size_t)j;
      gsl_matrix_set(u, transposed ? column : row, transposed ? row : column, matrix->value[k]);
    }
  if (made) good = gsl_linalg_SV_decomp(u, v, value, work) == 0;
  if (good && !transposed) decide_rank(value->data, (int32_t)(n < other ? n : other), spaces);
  size_t count = good ? n - (size_t)spaces->rank : 0;
  if (good) made = (*basis = strut_arena_allocate(arena, count * n + 1, sizeof **basis));
  for (size_t i = 0; i < count * n && made; i++)
    (*basis)[i] = gsl_matrix_get(v, i % n, (size_t)spaces->rank + i / n);
  strut_arena_free(&scratch);
  if (!made) return strut_no_memory(error, "");
  return good ? STRUT_OK
              : strut_fail(error, STRUT_SINGULAR,
                           "the singular values of the equilibrium matrix did not converge");
}

/* Without rows or columns: rank 0, and unit vectors. */
static strut_status trivial(const strut_equilibrium_matrix *matrix, strut_arena *arena,
                            strut_null_spaces *spaces, strut_error *error) {
  size_t n = (size_t)(matrix->columns + matrix->rows);
  spaces->states = matrix->columns, spaces->motions = matrix->rows;
  if (n > MOST_VECTORS) return STRUT_OK;
  double *basis = strut_arena_allocate(arena, n * n + 1, sizeof *basis);
  if (!basis) return strut_no_memory(error, "");
  for (size_t i = 0; i < n; i++) basis[i * n + i] = 1.0;
  spaces->state = matrix->columns ? basis : NULL;
  spaces->motion = matrix->rows ? basis : NULL;
  return STRUT_OK;
}

strut_status strut_null_spaces_dense(const strut_equilibrium_matrix *matrix, strut_arena *arena,
                                     strut_null_spaces *spaces, strut_error *error) {
  *spaces = (strut_null_spaces){.dense = true};
  if (matrix->rows == 0 || matrix->columns == 0) return trivial(matrix, arena, spaces, error);
  strut_status status = find_null(matrix, false, arena, spaces, &spaces->state, error);
  if (status == STRUT_OK) status = find_null(matrix, true, arena, spaces, &spaces->motion, error);
  spaces->states = matrix->columns - spaces->rank, spaces->motions = matrix->rows - spaces->rank;
  return status;
}

strut_status strut_null_spaces_sparse(const strut_equilibrium_matrix *matrix, strut_arena *arena,
                                      strut_null_spaces *spaces, strut_error *error) {
  *spaces = (strut_null_spaces){.dropped = (double)NAN};
  if (matrix->rows == 0 || matrix->columns == 0) return trivial(matrix, arena, spaces, error);
  const strut_sparse_algebra_library *sparse = NULL;
  const strut_sparse_columns columns = {matrix->rows, matrix->columns, matrix->start, matrix->row,
                                        matrix->value};
  strut_sparse_null_spaces found = {.most_vectors = MOST_VECTORS, .most_numbers = MOST_NUMBERS};
  strut_status status = strut_sparse_algebra_load(&sparse, error);
  if (status == STRUT_OK)
    status = sparse->null_spaces(&columns, STRUT_RANK_TOLERANCE * sqrt(2.0), arena, &found, error);
  spaces->rank = found.rank, spaces->kept = found.smallest, spaces->largest = found.largest;
  spaces->states = matrix->columns - found.rank, spaces->motions = matrix->rows - found.rank;
  spaces->state = found.null, spaces->motion = found.left;
  return status;
}

strut_status strut_null_spaces_find(const strut_equilibrium_matrix *matrix, strut_arena *arena,
                                    strut_null_spaces *spaces, strut_error *error) {
  assert(matrix->rows >= 0 && matrix->columns >= 0);
  int32_t most = matrix->rows > matrix->columns ? matrix->rows : matrix->columns;
  return most <= STRUT_DENSE_RIGIDITY ? strut_null_spaces_dense(matrix, arena, spaces, error)
                                      : strut_null_spaces_sparse(matrix, arena, spaces, error);
}
