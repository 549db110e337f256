/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Densities that are nearly those of some shape. A structure that stands by itself in the plane
 * needs a matrix of densities D with three null vectors (1, x, y): shape and densities are improved
 * in turn, each the nearest that fits the other. Then both together by Gauss and Newton, with
 * weight and supports, each step the shortest from what was given.
 */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "engine/statics/algebra.h"
#include "engine/statics/equilibria/equilibria_parts.h"
#include "engine/statics/form/parts.h"
#include "engine/statics/search/critical.h"

enum { MOST_COORDINATES = 400, TURNS = 500, NEAREST_STEPS = 30, STEPS = 60, NULLITY = 3 };

static const double CUT = 1e-9;      /* of the largest singular value: below it is none */
static const double STILL = 1e-14;   /* of density times size: forces that are none */
static const double SETTLED = 1e-13; /* of shape and densities: they change no more */
static const double EXACT = 1e-10;   /* of density times size: what rounding may leave */

/* Room for the eigenvectors of a matrix. */
typedef struct eigen_room {
  gsl_matrix *matrix, *vectors;
  gsl_vector *values;
  gsl_eigen_symmv_workspace *work;
} eigen_room;

/* x onto the span of the three null-most eigenvectors of D(q). How far it went. */
static double project_shape(const strut_scene *scene, const double *drawn, const double *positions,
                            const eigen_room *room, double *vector) {
  gsl_matrix *matrix = room->matrix, *vectors = room->vectors;
  gsl_vector *values = room->values;
  size_t n = scene->node_count;
  double change = 0;
  gsl_matrix_set_zero(matrix);
  for (size_t j = 0; j < scene->member_count; j++) {
    size_t a = (size_t)scene->members[j].node[0], b = (size_t)scene->members[j].node[1];
    *gsl_matrix_ptr(matrix, a, a) += positions[j];
    *gsl_matrix_ptr(matrix, b, b) += positions[j];
    *gsl_matrix_ptr(matrix, a, b) -= positions[j];
    *gsl_matrix_ptr(matrix, b, a) -= positions[j];
  }
  gsl_eigen_symmv(matrix, values, vectors, room->work);
  gsl_eigen_symmv_sort(values, vectors, GSL_EIGEN_SORT_ABS_ASC);
  for (size_t c = 0; c < 2; c++) {
    for (size_t i = 0; i < n; i++) gsl_vector_set(values, i, 0.0);
    for (size_t k = 0; k < NULLITY && k < n; k++) {
      double share = 0;
      for (size_t i = 0; i < n; i++) share += gsl_matrix_get(vectors, i, k) * drawn[2 * i + c];
      for (size_t i = 0; i < n; i++)
        *gsl_vector_ptr(values, i) += share * gsl_matrix_get(vectors, i, k);
    }
    for (size_t i = 0; i < n; i++) {
      change = fmax(change, fabs(gsl_vector_get(values, i) - vector[2 * i + c]));
      vector[2 * i + c] = gsl_vector_get(values, i);
    }
  }
  return change;
}

/* The directions of density space that leave forces in x, and how much: balance = U S V'. */
static bool decompose(const strut_scene *scene, const double *vector, gsl_matrix *balance,
                      gsl_matrix *matrix, gsl_vector *s, gsl_vector *room) {
  gsl_matrix_set_zero(balance);
  for (size_t j = 0; j < scene->member_count; j++)
    for (size_t c = 0; c < 2; c++) {
      size_t a = 2 * (size_t)scene->members[j].node[0] + c;
      size_t b = 2 * (size_t)scene->members[j].node[1] + c;
      gsl_matrix_set(balance, j, a, vector[b] - vector[a]);
      gsl_matrix_set(balance, j, b, vector[a] - vector[b]);
    }
  return gsl_linalg_SV_decomp(balance, matrix, s, room) == 0;
}

/*
 * q onto the densities that hold x: without its parts that leave forces. Where there are too few
 * members for a state of self-stress in every shape, the part that leaves least is kept.
 */
static double project_densities(const strut_scene *scene, const gsl_matrix *matrix,
                                const gsl_vector *vector, double *positions) {
  size_t b = scene->member_count, most = 2 * scene->node_count - NULLITY;
  double change = 0;
  for (size_t k = 0; k < b && k < most; k++) {
    double share = 0;
    if (k + 1 == b || !(gsl_vector_get(vector, k) > CUT * gsl_vector_get(vector, 0))) break;
    for (size_t j = 0; j < b; j++) share += gsl_matrix_get(matrix, j, k) * positions[j];
    for (size_t j = 0; j < b; j++) positions[j] -= share * gsl_matrix_get(matrix, j, k);
    change = fmax(change, fabs(share));
  }
  return change;
}

/* Shape and densities in turn; rows of `balance` beyond the members are zero. */
static bool take_turns(strut_former *former, const double *drawn, double *vector,
                       double *positions) {
  const strut_scene *scene = former->scene;
  size_t n = scene->node_count, b = scene->member_count, tall = b > 2 * n ? b : 2 * n;
  strut_arena arena = {0};
  const eigen_room eigen = {strut_arena_matrix(&arena, n, n), strut_arena_matrix(&arena, n, n),
                            strut_arena_vector(&arena, n), gsl_eigen_symmv_alloc(n)};
  gsl_matrix *balance = strut_arena_matrix(&arena, tall, 2 * n);
  gsl_matrix *matrix = strut_arena_matrix(&arena, 2 * n, 2 * n);
  gsl_vector *s = strut_arena_vector(&arena, 2 * n), *room = strut_arena_vector(&arena, 2 * n);
  bool good =
      eigen.matrix && eigen.vectors && eigen.values && eigen.work && balance && matrix && s && room;
  double largest = 0;
  for (size_t j = 0; j < b; j++) largest = fmax(largest, fabs(positions[j]));
  for (int k = 0; k < TURNS && good; k++) {
    double moved = project_shape(scene, drawn, positions, &eigen, vector), changed = 0;
    good = decompose(scene, vector, balance, matrix, s, room);
    if (good) changed = project_densities(scene, balance, s, positions);
    if (moved <= SETTLED * former->size && changed <= SETTLED * largest) break;
  }
  gsl_eigen_symmv_free(eigen.work);
  strut_arena_free(&arena);
  return good;
}

/* Turns and shifts x so that it lies as the drawn shape does at the coordinates that are held. */
static void lay_down(const strut_scene *scene, const uint8_t *held, const double *drawn,
                     double *vector) {
  const strut_rigid_fit fit = strut_rigid_fit_find((int32_t)scene->node_count, drawn, vector, 1.0);
  double shift[2] = {0}, count[2] = {0};
  for (size_t i = 0; i < scene->node_count; i++) {
    strut_rigid_fit_apply(&fit, vector + 2 * i, vector + 2 * i);
    for (size_t c = 0; c < 2; c++)
      if (held[2 * i + c]) shift[c] += drawn[2 * i + c] - vector[2 * i + c], count[c] += 1;
  }
  for (size_t i = 0; i < 2 * scene->node_count; i++)
    if (count[i % 2] > 0) vector[i] += shift[i % 2] / count[i % 2];
}

/* Unknowns of Gauss and Newton: free coordinates in units of size, densities in units of `unit`. */
typedef struct joint {
  strut_former *f;
  const int32_t *row_of; /* (2 nodes) */
  int32_t n;
  double unit; /* [N/m] */
  double *x, *q;
  const double *x_given, *q_given;
  gsl_matrix *slope; /* (n + members, n): the transpose of the derivative */
  gsl_vector *force, *step, *away;
} joint;

/* Net forces [unit size] and their derivatives. The largest force. */
static double evaluate(joint *self) {
  const strut_scene *scene = self->f->scene;
  double size = self->f->size, most = 0;
  gsl_matrix_set_zero(self->slope);
  for (size_t i = 0; i < 2 * scene->node_count; i++)
    if (self->row_of[i] >= 0)
      gsl_vector_set(self->force, (size_t)self->row_of[i],
                     self->f->potential->force[i] / (self->unit * size));
  for (size_t j = 0; j < scene->member_count; j++)
    for (size_t c = 0; c < 2; c++) {
      size_t at[2] = {2 * (size_t)scene->members[j].node[0] + c,
                      2 * (size_t)scene->members[j].node[1] + c};
      double d = (self->x[at[1]] - self->x[at[0]]) / size, q = self->q[j] / self->unit;
      for (int e = 0; e < 2; e++) {
        int32_t row = self->row_of[at[e]], other = self->row_of[at[1 - e]];
        if (row < 0) continue;
        *gsl_vector_ptr(self->force, (size_t)row) += e ? -q * d : q * d;
        *gsl_matrix_ptr(self->slope, (size_t)self->n + j, (size_t)row) += e ? -d : d;
        *gsl_matrix_ptr(self->slope, (size_t)row, (size_t)row) -= q;
        if (other >= 0) *gsl_matrix_ptr(self->slope, (size_t)other, (size_t)row) += q;
      }
    }
  for (int32_t i = 0; i < self->n; i++)
    most = fmax(most, fabs(gsl_vector_get(self->force, (size_t)i)));
  return most;
}

/* Away from what was given, in the unknowns' units. */
static void deviation(const joint *self, gsl_vector *out) {
  const strut_scene *scene = self->f->scene;
  for (size_t i = 0; i < 2 * scene->node_count; i++)
    if (self->row_of[i] >= 0)
      gsl_vector_set(out, (size_t)self->row_of[i], (self->x[i] - self->x_given[i]) / self->f->size);
  for (size_t j = 0; j < scene->member_count; j++)
    gsl_vector_set(out, (size_t)self->n + j, (self->q[j] - self->q_given[j]) / self->unit);
}

/* One step: onto the linearised equilibria, at first to the one nearest to what was given. */
static bool improve(joint *self, bool nearest) {
  const strut_scene *scene = self->f->scene;
  deviation(self, self->away);
  gsl_vector_scale(self->force, -1.0);
  if (nearest) gsl_blas_dgemv(CblasTrans, 1.0, self->slope, self->away, 1.0, self->force);
  bool good = strut_shortest(self->slope, CUT, self->force, self->step);
  if (nearest) gsl_vector_sub(self->step, self->away);
  for (size_t i = 0; i < 2 * scene->node_count && good; i++)
    if (self->row_of[i] >= 0)
      self->x[i] += self->f->size * gsl_vector_get(self->step, (size_t)self->row_of[i]);
  for (size_t j = 0; j < scene->member_count && good; j++)
    self->q[j] += self->unit * gsl_vector_get(self->step, (size_t)self->n + j);
  return good;
}

static strut_status not_found(const joint *self, strut_error *error) {
  uint8_t *marked = strut_allocate(self->f->scene->node_count, 1);
  char names[200];
  if (!marked) return strut_no_memory(error, "");
  for (size_t i = 0; i < 2 * self->f->scene->node_count; i++)
    if (self->row_of[i] >= 0 && fabs(gsl_vector_get(self->force, (size_t)self->row_of[i])) > EXACT)
      marked[i / 2] = 1;
  strut_list_nodes(self->f->scene, marked, sizeof names, names);
  strut_release(marked);
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "no shape and densities near the given ones are in equilibrium: forces remain "
                    "at %s; check supports, loads and densities there",
                    names);
}

static strut_status solve(joint *self, strut_error *error) {
  double left = evaluate(self);
  for (int k = 0; k < STEPS; k++) {
    double before = left;
    if (!improve(self, k < NEAREST_STEPS)) return strut_no_memory(error, "");
    left = evaluate(self);
    if (!isfinite(left)) break;
    if (left <= STILL || (k > NEAREST_STEPS && left <= EXACT && left >= before)) break;
  }
  return left <= EXACT ? STRUT_OK : not_found(self, error);
}

strut_status strut_form_nearest(strut_former *former, const uint8_t *held, bool standing,
                                double *vector, double *positions, strut_error *error) {
  size_t coordinates = 2 * former->scene->node_count, members = former->scene->member_count;
  double *x_given = strut_arena_allocate(&former->arena, coordinates, sizeof *x_given);
  double *q_given = strut_arena_allocate(&former->arena, members, sizeof *q_given);
  int32_t *row_of = strut_arena_allocate(&former->arena, coordinates, sizeof *row_of);
  joint p = {.f = former,
             .row_of = row_of,
             .x = vector,
             .q = positions,
             .x_given = x_given,
             .q_given = q_given};
  if (!x_given || !q_given || !row_of) return strut_no_memory(error, "");
  if (coordinates > MOST_COORDINATES)
    return strut_fail(error, STRUT_SINGULAR,
                      "the densities alone determine no shape, and the structure is too large to "
                      "adjust them: %zu coordinates, at most %d",
                      coordinates, MOST_COORDINATES);
  const double *origin = former->scene->nodes[0].position; /* keeps digits */
  for (size_t i = 0; i < coordinates; i++) vector[i] -= origin[i % 2];
  memcpy(x_given, vector, coordinates * sizeof *vector);
  if (standing && !take_turns(former, x_given, vector, positions))
    return strut_no_memory(error, "");
  if (standing) lay_down(former->scene, held, x_given, vector);
  for (size_t i = 0; i < coordinates; i++) row_of[i] = held[i] ? -1 : p.n++;
  for (size_t i = 0; i < coordinates; i++)
    if (held[i]) vector[i] = former->scene->nodes[i / 2].position[i % 2] - origin[i % 2];
  memcpy(x_given, vector, coordinates * sizeof *vector);
  memcpy(q_given, positions, members * sizeof *positions);
  for (size_t j = 0; j < members; j++) p.unit = fmax(p.unit, fabs(positions[j]));
  p.slope = strut_arena_matrix(&former->arena, (size_t)p.n + members, (size_t)p.n);
  p.force = strut_arena_vector(&former->arena, (size_t)p.n);
  p.step = strut_arena_vector(&former->arena, (size_t)p.n + members);
  p.away = strut_arena_vector(&former->arena, (size_t)p.n + members);
  strut_status status = p.slope && p.force && p.step && p.away && p.unit > 0
                            ? solve(&p, error)
                            : strut_no_memory(error, "");
  for (size_t i = 0; i < coordinates; i++) vector[i] += origin[i % 2];
  return status;
}
