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
  strut_follow_surface *u = context;
  const double values[2] = {value, u->second};
  return u->scenes.setup(u->scenes.context, values, setup, error);
}

strut_status strut_follow_surface_open(strut_follow_surface *u, const double value[2],
                                       strut_error *error) {
  u->s.scenes = (strut_follow_scenes){setup_first, u};
  u->s.low = u->low[0], u->s.high = u->high[0];
  u->second = value[1];
  u->error = error;
  strut_status status = strut_follow_open(&u->s, value[0], error);
  if (status) return status;
  size_t n = u->s.n;
  u->m = n + 2;
  bool good = (u->second_column = strut_arena_allocate(&u->arena, n, sizeof(double))) &&
              (u->f = strut_arena_allocate(&u->arena, n, sizeof(double))) &&
              (u->x = strut_arena_allocate(&u->arena, u->m, sizeof(double))) &&
              (u->matrix = strut_arena_allocate(&u->arena, u->m * u->m, sizeof(double)));
  return good ? STRUT_OK : strut_no_memory(error, "");
}

void strut_follow_surface_close(strut_follow_surface *u) {
  strut_follow_close(&u->s);
  strut_arena_free(&u->arena);
}

bool strut_follow_surface_set(strut_follow_surface *u, const double value[2]) {
  if (u->status) return false;
  if (u->second != value[1]) u->s.value = (double)NAN; /* the model is that of another one */
  u->second = value[1];
  strut_status status = strut_follow_set_value(&u->s, value[0], u->error);
  if (status == STRUT_BAD_SCENE) return false;
  u->status = status;
  return status == STRUT_OK;
}

strut_follow_surface_point *strut_follow_surface_point_new(const strut_follow_surface *u,
                                                           strut_arena *arena) {
  size_t n = u->s.n;
  strut_follow_surface_point *p = strut_arena_allocate(arena, 1, sizeof *p);
  bool good = p && (p->y = strut_arena_allocate(arena, u->s.both, sizeof(double))) &&
              (p->basis[0] = strut_arena_allocate(arena, u->m, sizeof(double))) &&
              (p->basis[1] = strut_arena_allocate(arena, u->m, sizeof(double))) &&
              (p->jacobian = strut_arena_allocate(arena, n * n, sizeof(double))) &&
              (p->multiplier = strut_arena_allocate(arena, n, sizeof *p->multiplier));
  return good ? p : NULL;
}

void strut_follow_surface_point_copy(const strut_follow_surface *u,
                                     const strut_follow_surface_point *from,
                                     strut_follow_surface_point *to) {
  size_t n = u->s.n;
  memcpy(to->value, from->value, sizeof to->value);
  memcpy(to->y, from->y, u->s.both * sizeof(double));
  to->complete = from->complete;
  if (!from->complete) return;
  for (int k = 0; k < 2; k++) memcpy(to->basis[k], from->basis[k], u->m * sizeof(double));
  memcpy(to->multiplier, from->multiplier, n * sizeof *to->multiplier);
  memcpy(to->jacobian, from->jacobian, n * n * sizeof(double));
  to->multipliers = from->multipliers;
}

double strut_follow_surface_difference(const strut_follow_surface *u,
                                       const strut_follow_surface_point *a,
                                       const strut_follow_surface_point *b, size_t i) {
  const strut_follow_system *s = &u->s;
  if (i < s->n) return (b->y[s->place[i]] - a->y[s->place[i]]) / strut_follow_unit(s, i);
  size_t k = i - s->n;
  return (b->value[k] - a->value[k]) / (u->high[k] - u->low[k]);
}

void strut_follow_surface_move(const strut_follow_surface *u, strut_follow_surface_point *p,
                               const double *direction, double factor) {
  strut_follow_move(&u->s, p->y, direction, factor);
  for (size_t k = 0; k < 2; k++)
    p->value[k] += factor * direction[u->s.n + k] * (u->high[k] - u->low[k]);
  p->complete = false;
}

static bool interrupted(strut_follow_surface *u) {
  if (!u->s.how.interrupt || !*u->s.how.interrupt) return false;
  u->status = strut_fail(u->error, STRUT_INTERRUPTED,
                         "interrupted at %.9g and %.9g of the parameters", u->s.value, u->second);
  return true;
}

/* Fills the derivative of G at y and the values, f being the residual there. */
static bool differentiate(strut_follow_surface *u, const double *y, const double value[2],
                          const double *f) {
  strut_follow_system *s = &u->s;
  double range = u->high[1] - u->low[1], step = DIFFERENCE * range;
  bool lost = false;
  if (value[1] + step > u->high[1]) step = -step;
  const double beside[2] = {value[0], value[1] + step};
  if (!strut_follow_surface_set(u, value)) return false;
  u->status = strut_follow_differentiate(s, y, f, &lost, u->error);
  if (u->status || lost || interrupted(u) || !strut_follow_surface_set(u, beside)) return false;
  if (!isfinite(strut_follow_residual(s, y, u->second_column))) return false;
  for (size_t i = 0; i < s->n; i++)
    u->second_column[i] = (u->second_column[i] - f[i]) * range / step;
  return strut_follow_surface_set(u, value);
}

/* rows[k] . (p - base) - offset[k] */
static double off_plane(const strut_follow_surface *u, const strut_follow_surface_point *p,
                        const strut_follow_surface_point *base, const double *row, double offset) {
  double sum = -offset;
  for (size_t i = 0; i < u->m; i++) sum += row[i] * strut_follow_surface_difference(u, base, p, i);
  return sum;
}

bool strut_follow_surface_correct(strut_follow_surface *u, strut_follow_surface_point *p,
                                  const strut_follow_surface_point *base,
                                  const double *const rows[2], const double offset[2]) {
  strut_follow_system *s = &u->s;
  const strut_follow_border border = {
      2, {s->derivative.column, u->second_column}, {rows[0], rows[1]}};
  double before = HUGE_VAL, left = HUGE_VAL;
  int made = 0;
  for (int round = 0; round < MOST_ROUNDS; round++) {
    if (interrupted(u) || !strut_follow_surface_set(u, p->value)) return false;
    left = strut_follow_residual(s, p->y, u->f);
    double off[2];
    for (int k = 0; k < 2; k++) {
      off[k] = off_plane(u, p, base, rows[k], offset[k]);
      left = fmax(left, fabs(off[k]));
    }
    if (!isfinite(left) || interrupted(u)) return false;
    if (left <= CONVERGED) return true;
    bool slow = left > SLOW * before;
    if (slow && left <= ACCEPTED) return true;
    if (slow || !s->derivative.known) {
      if (made++ == MOST_DERIVATIVES) return false;
      if (!differentiate(u, p->y, p->value, u->f)) return false;
    } else if (round > 0) {
      strut_follow_update(s, &border, u->f, u->x);
    }
    for (size_t i = 0; i < s->n; i++) u->x[i] = -u->f[i];
    for (size_t k = 0; k < 2; k++) u->x[s->n + k] = -off[k];
    if (!strut_follow_solve_with(s, &border, u->matrix, u->x)) return false;
    for (size_t i = 0; i < u->m; i++)
      if (!(fabs(u->x[i]) <= LONGEST)) return false;
    strut_follow_surface_move(u, p, u->x, 1.0);
    before = left;
  }
  return left <= ACCEPTED;
}

/* Orthonormal vectors of the null space: the last columns of Q in the factors Q R of the transpose. */
static bool find_basis(strut_follow_surface *u, strut_follow_surface_point *p) {
  const strut_follow_system *s = &u->s;
  size_t n = s->n, m = u->m;
  gsl_matrix *transpose = gsl_matrix_alloc(m, n), *q = gsl_matrix_alloc(m, m);
  gsl_matrix *r = gsl_matrix_alloc(m, n);
  gsl_vector *scale = gsl_vector_alloc(n);
  bool good = transpose && q && r && scale;
  for (size_t i = 0; i < n && good; i++) {
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(transpose, j, i, s->derivative.jacobian[i * n + j] - (i == j));
    gsl_matrix_set(transpose, n, i, s->derivative.column[i]);
    gsl_matrix_set(transpose, n + 1, i, u->second_column[i]);
  }
  if (good) {
    gsl_linalg_QR_decomp(transpose, scale);
    gsl_linalg_QR_unpack(transpose, scale, q, r);
    for (size_t i = 0; i < m; i++)
      for (size_t k = 0; k < 2; k++) p->basis[k][i] = gsl_matrix_get(q, i, n + k);
  } else {
    u->status = strut_no_memory(u->error, "");
  }
  gsl_matrix_free(transpose);
  gsl_matrix_free(q);
  gsl_matrix_free(r);
  gsl_vector_free(scale);
  return good;
}

bool strut_follow_surface_complete(strut_follow_surface *u, strut_follow_surface_point *p) {
  strut_follow_system *s = &u->s;
  if (p->complete) return true;
  if (!strut_follow_surface_set(u, p->value) || !isfinite(strut_follow_residual(s, p->y, u->f)))
    return false;
  if (!differentiate(u, p->y, p->value, u->f)) return false;
  if (!strut_follow_multipliers(s, u->matrix, p->multiplier, &p->multipliers)) {
    u->status = strut_no_memory(u->error, "");
    return false;
  }
  memcpy(p->jacobian, s->derivative.jacobian, s->n * s->n * sizeof(double));
  p->complete = find_basis(u, p);
  return p->complete;
}
