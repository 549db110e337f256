/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/follow/follow_parts.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "engine/run/orbit/orbit.h"

/* Residuals of an orbit: wanted, and accepted where rounding or kinks prevent that; a step too long. */
static const double CONVERGED = 1e-7, ACCEPTED = 2e-6, LONGEST = 2.0;
/* Reduction below which a new derivative is made; step of the difference over the second parameter. */
static const double SLOW = 0.4, DIFFERENCE = 1e-5;
enum { MOST_ROUNDS = 14, MOST_DERIVATIVES = 3 };

static strut_status setup_first(void *context, double value, strut_setup *setup,
                                strut_error *error) {
  strut_follow_surface *surface = context;
  const double values[2] = {value, surface->second};
  return surface->scenes.setup(surface->scenes.context, values, setup, error);
}

strut_status strut_follow_surface_open(strut_follow_surface *surface, const double value[2],
                                       strut_error *error) {
  surface->s.scenes = (strut_follow_scenes){setup_first, surface};
  surface->s.low = surface->low[0], surface->s.high = surface->high[0];
  surface->second = value[1];
  surface->error = error;
  strut_status status = strut_follow_open(&surface->s, value[0], error);
  if (status) return status;
  size_t n = surface->s.n;
  surface->m = n + 2;
  bool good = (surface->second_column = strut_arena_allocate(&surface->arena, n, sizeof(double))) &&
              (surface->f = strut_arena_allocate(&surface->arena, n, sizeof(double))) &&
              (surface->x = strut_arena_allocate(&surface->arena, surface->m, sizeof(double))) &&
              (surface->matrix =
                   strut_arena_allocate(&surface->arena, surface->m * surface->m, sizeof(double)));
  return good ? STRUT_OK : strut_no_memory(error, "");
}

void strut_follow_surface_close(strut_follow_surface *surface) {
  strut_follow_close(&surface->s);
  strut_arena_free(&surface->arena);
}

bool strut_follow_surface_set(strut_follow_surface *surface, const double value[2]) {
  if (surface->status) return false;
  if (surface->second != value[1])
    surface->s.value = (double)NAN; /* the model is that of another one */
  surface->second = value[1];
  strut_status status = strut_follow_set_value(&surface->s, value[0], surface->error);
  if (status == STRUT_BAD_SCENE) return false;
  surface->status = status;
  return status == STRUT_OK;
}

strut_follow_surface_point *strut_follow_surface_point_new(const strut_follow_surface *surface,
                                                           strut_arena *arena) {
  size_t n = surface->s.n;
  strut_follow_surface_point *point = strut_arena_allocate(arena, 1, sizeof *point);
  bool good = point && (point->y = strut_arena_allocate(arena, surface->s.both, sizeof(double))) &&
              (point->basis[0] = strut_arena_allocate(arena, surface->m, sizeof(double))) &&
              (point->basis[1] = strut_arena_allocate(arena, surface->m, sizeof(double))) &&
              (point->jacobian = strut_arena_allocate(arena, n * n, sizeof(double))) &&
              (point->multiplier = strut_arena_allocate(arena, n, sizeof *point->multiplier));
  return good ? point : NULL;
}

void strut_follow_surface_point_copy(const strut_follow_surface *surface,
                                     const strut_follow_surface_point *from,
                                     strut_follow_surface_point *to) {
  size_t n = surface->s.n;
  memcpy(to->value, from->value, sizeof to->value);
  memcpy(to->y, from->y, surface->s.both * sizeof(double));
  to->complete = from->complete;
  if (!from->complete) return;
  for (int k = 0; k < 2; k++) memcpy(to->basis[k], from->basis[k], surface->m * sizeof(double));
  memcpy(to->multiplier, from->multiplier, n * sizeof *to->multiplier);
  memcpy(to->jacobian, from->jacobian, n * n * sizeof(double));
  to->multipliers = from->multipliers;
}

double strut_follow_surface_difference(const strut_follow_surface *surface,
                                       const strut_follow_surface_point *first,
                                       const strut_follow_surface_point *second, size_t i) {
  const strut_follow_system *system = &surface->s;
  if (i < system->n)
    return (second->y[system->place[i]] - first->y[system->place[i]]) /
           strut_follow_unit(system, i);
  size_t k = i - system->n;
  return (second->value[k] - first->value[k]) / (surface->high[k] - surface->low[k]);
}

void strut_follow_surface_move(const strut_follow_surface *surface,
                               strut_follow_surface_point *point, const double *direction,
                               double factor) {
  strut_follow_move(&surface->s, point->y, direction, factor);
  for (size_t k = 0; k < 2; k++)
    point->value[k] += factor * direction[surface->s.n + k] * (surface->high[k] - surface->low[k]);
  point->complete = false;
}

static bool interrupted(strut_follow_surface *surface) {
  if (!surface->s.how.interrupt || !*surface->s.how.interrupt) return false;
  surface->status = strut_fail(surface->error, STRUT_INTERRUPTED,
                               "interrupted at %.9g and %.9g of the parameters", surface->s.value,
                               surface->second);
  return true;
}

/* Fills the derivative of G at y and the values, f being the residual there. */
static bool differentiate(strut_follow_surface *surface, const double *unknowns,
                          const double value[2], const double *f) {
  strut_follow_system *system = &surface->s;
  double range = surface->high[1] - surface->low[1], step = DIFFERENCE * range;
  bool lost = false;
  if (value[1] + step > surface->high[1]) step = -step;
  const double beside[2] = {value[0], value[1] + step};
  if (!strut_follow_surface_set(surface, value)) return false;
  surface->status = strut_follow_differentiate(system, unknowns, f, &lost, surface->error);
  if (surface->status || lost || interrupted(surface) || !strut_follow_surface_set(surface, beside))
    return false;
  if (!isfinite(strut_follow_residual(system, unknowns, surface->second_column))) return false;
  for (size_t i = 0; i < system->n; i++)
    surface->second_column[i] = (surface->second_column[i] - f[i]) * range / step;
  return strut_follow_surface_set(surface, value);
}

/* rows[k] . (p - base) - offset[k] */
static double off_plane(const strut_follow_surface *surface,
                        const strut_follow_surface_point *point,
                        const strut_follow_surface_point *base, const double *row, double offset) {
  double sum = -offset;
  for (size_t i = 0; i < surface->m; i++)
    sum += row[i] * strut_follow_surface_difference(surface, base, point, i);
  return sum;
}

bool strut_follow_surface_correct(strut_follow_surface *surface, strut_follow_surface_point *point,
                                  const strut_follow_surface_point *base,
                                  const double *const rows[2], const double offset[2]) {
  strut_follow_system *system = &surface->s;
  const strut_follow_border border = {
      2, {system->derivative.column, surface->second_column}, {rows[0], rows[1]}};
  double before = HUGE_VAL, left = HUGE_VAL;
  int made = 0;
  for (int round = 0; round < MOST_ROUNDS; round++) {
    if (interrupted(surface) || !strut_follow_surface_set(surface, point->value)) return false;
    left = strut_follow_residual(system, point->y, surface->f);
    double off[2];
    for (int k = 0; k < 2; k++) {
      off[k] = off_plane(surface, point, base, rows[k], offset[k]);
      left = fmax(left, fabs(off[k]));
    }
    if (!isfinite(left) || interrupted(surface)) return false;
    if (left <= CONVERGED) return true;
    bool slow = left > SLOW * before;
    if (slow && left <= ACCEPTED) return true;
    if (slow || !system->derivative.known) {
      if (made++ == MOST_DERIVATIVES) return false;
      if (!differentiate(surface, point->y, point->value, surface->f)) return false;
    } else if (round > 0) {
      strut_follow_update(system, &border, surface->f, surface->x);
    }
    for (size_t i = 0; i < system->n; i++) surface->x[i] = -surface->f[i];
    for (size_t k = 0; k < 2; k++) surface->x[system->n + k] = -off[k];
    if (!strut_follow_solve_with(system, &border, surface->matrix, surface->x)) return false;
    for (size_t i = 0; i < surface->m; i++)
      if (!(fabs(surface->x[i]) <= LONGEST)) return false;
    strut_follow_surface_move(surface, point, surface->x, 1.0);
    before = left;
  }
  return left <= ACCEPTED;
}

/* Orthonormal vectors of the null space: the last columns of Q in the factors Q R of the transpose. */
static bool find_basis(strut_follow_surface *surface, strut_follow_surface_point *point) {
  const strut_follow_system *system = &surface->s;
  size_t n = system->n, m = surface->m;
  gsl_matrix *transpose = gsl_matrix_alloc(m, n), *q = gsl_matrix_alloc(m, m);
  gsl_matrix *matrix = gsl_matrix_alloc(m, n);
  gsl_vector *scale = gsl_vector_alloc(n);
  bool good = transpose && q && matrix && scale;
  for (size_t i = 0; i < n && good; i++) {
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(transpose, j, i, system->derivative.jacobian[i * n + j] - (i == j));
    gsl_matrix_set(transpose, n, i, system->derivative.column[i]);
    gsl_matrix_set(transpose, n + 1, i, surface->second_column[i]);
  }
  if (good) {
    gsl_linalg_QR_decomp(transpose, scale);
    gsl_linalg_QR_unpack(transpose, scale, q, matrix);
    for (size_t i = 0; i < m; i++)
      for (size_t k = 0; k < 2; k++) point->basis[k][i] = gsl_matrix_get(q, i, n + k);
  } else {
    surface->status = strut_no_memory(surface->error, "");
  }
  gsl_matrix_free(transpose);
  gsl_matrix_free(q);
  gsl_matrix_free(matrix);
  gsl_vector_free(scale);
  return good;
}

bool strut_follow_surface_complete(strut_follow_surface *surface,
                                   strut_follow_surface_point *point) {
  strut_follow_system *system = &surface->s;
  if (point->complete) return true;
  if (!strut_follow_surface_set(surface, point->value) ||
      !isfinite(strut_follow_residual(system, point->y, surface->f)))
    return false;
  if (!differentiate(surface, point->y, point->value, surface->f)) return false;
  if (!strut_follow_multipliers(system, surface->matrix, point->multiplier, &point->multipliers)) {
    surface->status = strut_no_memory(surface->error, "");
    return false;
  }
  memcpy(point->jacobian, system->derivative.jacobian, system->n * system->n * sizeof(double));
  point->complete = find_basis(surface, point);
  return point->complete;
}
