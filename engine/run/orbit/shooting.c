/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit/shooting.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"

static const double DIFFERENCE = 1e-6; /* step of the central differences, in scaled unknowns */
static const double ROUNDING = 1e-13;  /* residuals below this are rounding */
static const double CONVERGED = 1e-8;  /* largest residual of an orbit that counts as found */
enum { MOST_ROUNDS = 8, MOST_HALVINGS = 6 };

/* Unknowns are free coordinates over the size, then their velocities over size times 2 pi f. */
typedef struct shooting_problem {
  strut_period_map *map;
  size_t count, both;
  size_t *place;  /* (count) of an unknown in y */
  double *unit;   /* (count) [m], [m/s] */
  double *along;  /* (count) the shift along the ground, of length 1; zeros where there is none */
  double *matrix; /* (count, count) derivative of the map, without the neutral shift */
  double *work;   /* (count, count) */
  double *f, *change;           /* (count) */
  double *here, *there, *trial; /* (both) */
  strut_arena arena;
} shooting_problem;

static bool allocate_problem(shooting_problem *s) {
  strut_arena *a = &s->arena;
  size_t n = s->count, square = n * n;
  return (s->place = strut_arena_allocate(a, n, sizeof *s->place)) &&
         (s->unit = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->along = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->matrix = strut_arena_allocate(a, square, sizeof(double))) &&
         (s->work = strut_arena_allocate(a, square, sizeof(double))) &&
         (s->f = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->change = strut_arena_allocate(a, n, sizeof(double))) &&
         (s->here = strut_arena_allocate(a, s->both, sizeof(double))) &&
         (s->there = strut_arena_allocate(a, s->both, sizeof(double))) &&
         (s->trial = strut_arena_allocate(a, s->both, sizeof(double)));
}

static void choose_unknowns(shooting_problem *s) {
  const strut_model *m = s->map->model;
  size_t k = 0, nodes = (size_t)m->node_count, half = s->count / 2;
  for (size_t i = 0; i < 2 * nodes; i++) {
    if (m->fixed[i]) continue;
    s->place[k] = i, s->unit[k] = m->size;
    s->place[half + k] = (size_t)m->length + i,
                    s->unit[half + k] = m->size * STRUT_TAU / s->map->period;
    if (s->map->travels) s->along[k] = m->contacts.tangent[i % 2] / sqrt((double)nodes);
    k++;
  }
}

/*
 * Evaluates one application from y: scaled residual in f, end in s->there; returns the largest
 * residual.
 */
static double evaluate_residual(shooting_problem *s, const double *y, double *travel) {
  memcpy(s->there, y, s->both * sizeof(double));
  double gone = strut_period_map_apply(s->map, s->there), most = 0.0;
  if (travel) *travel = gone;
  if (!isfinite(gone)) return HUGE_VAL;
  for (size_t i = 0; i < s->count; i++) {
    s->f[i] = (s->there[s->place[i]] - y[s->place[i]]) / s->unit[i];
    most = fmax(most, fabs(s->f[i]));
  }
  return most;
}

/* Differentiates the map at y by central differences; false where the motion was lost. */
static bool differentiate(shooting_problem *s, const double *y) {
  size_t n = s->count;
  for (size_t j = 0; j < n; j++) {
    for (int side = -1; side <= 1; side += 2) {
      memcpy(s->there, y, s->both * sizeof(double));
      s->there[s->place[j]] += side * DIFFERENCE * s->unit[j];
      if (!isfinite(strut_period_map_apply(s->map, s->there))) return false;
      for (size_t i = 0; i < n; i++) {
        double part = side * s->there[s->place[i]] / s->unit[i] / (2.0 * DIFFERENCE);
        s->matrix[i * n + j] = side < 0 ? part : s->matrix[i * n + j] + part;
      }
    }
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) s->matrix[i * n + j] -= s->along[i] * s->along[j];
  return true;
}

bool strut_solve_dense(double *a, double *x, size_t n, double least) {
  for (size_t p = 0; p < n; p++) {
    size_t best = p;
    for (size_t i = p + 1; i < n; i++)
      if (fabs(a[i * n + p]) > fabs(a[best * n + p])) best = i;
    if (!(fabs(a[best * n + p]) > least)) return false;
    for (size_t j = 0; j < n && best != p; j++) {
      double keep = a[p * n + j];
      a[p * n + j] = a[best * n + j], a[best * n + j] = keep;
    }
    double keep = x[p];
    x[p] = x[best], x[best] = keep;
    for (size_t i = p + 1; i < n; i++) {
      double factor = a[i * n + p] / a[p * n + p];
      for (size_t j = p; j < n; j++) a[i * n + j] -= factor * a[p * n + j];
      x[i] -= factor * x[p];
    }
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t j = i + 1; j < n; j++) x[i] -= a[i * n + j] * x[j];
    x[i] /= a[i * n + i];
  }
  return true;
}

/* change = -(J - 1)^-1 f; false where it is singular. */
static bool solve_newton_step(shooting_problem *s) {
  size_t n = s->count;
  memcpy(s->work, s->matrix, n * n * sizeof(double));
  for (size_t i = 0; i < n; i++) s->work[i * n + i] -= 1.0, s->change[i] = -s->f[i];
  return strut_solve_dense(s->work, s->change, n, 1e-12);
}

/*
 * Line search along the change, halved until the residual falls; returns the new residual, or the
 * old one.
 */
static double search_line(shooting_problem *s, double before, double *travel) {
  double part = 1.0;
  for (int k = 0; k < MOST_HALVINGS && !strut_period_map_interrupted(s->map); k++, part *= 0.5) {
    double gone;
    memcpy(s->trial, s->here, s->both * sizeof(double));
    for (size_t i = 0; i < s->count; i++) s->trial[s->place[i]] += part * s->change[i] * s->unit[i];
    double left = evaluate_residual(s, s->trial, &gone);
    if (left < before) {
      memcpy(s->here, s->trial, s->both * sizeof(double));
      *travel = gone;
      return left;
    }
  }
  return before;
}

/*
 * Newton's method from s->here until the residual stops falling; the matrix is the derivative at
 * the last point.
 */
static double iterate_newton(shooting_problem *s, double *travel, strut_steady_summary *found) {
  double left = evaluate_residual(s, s->here, travel);
  for (int round = 0; round < MOST_ROUNDS; round++) {
    if (!differentiate(s, s->here)) return HUGE_VAL;
    if (left <= ROUNDING) break;
    evaluate_residual(s, s->here, NULL);
    if (!solve_newton_step(s)) {
      snprintf(found->reason, sizeof found->reason,
               "the period map has another neutral direction, so that the orbit is not isolated");
      break;
    }
    double before = left;
    left = search_line(s, before, travel);
    found->iterations++;
    if (left > 0.5 * before || (left <= CONVERGED * 1e-2 && left > 0.1 * before)) break;
  }
  return left;
}

static void find_multipliers(shooting_problem *s, strut_steady_summary *found) {
  size_t n = s->count;
  gsl_matrix_view view = gsl_matrix_view_array(s->work, n, n);
  gsl_eigen_nonsymm_workspace *w = gsl_eigen_nonsymm_alloc(n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  memcpy(s->work, s->matrix, n * n * sizeof(double));
  found->multiplier_count = 0;
  if (w && values && gsl_eigen_nonsymm(&view.matrix, values, w) == 0) {
    size_t kept = 0, room = n - (s->map->travels ? 1 : 0);
    if (room > STRUT_MOST_MULTIPLIERS) room = STRUT_MOST_MULTIPLIERS;
    for (size_t i = 0; i < n; i++) { /* insertion by magnitude, largest first */
      double re = GSL_REAL(gsl_vector_complex_get(values, i));
      double im = GSL_IMAG(gsl_vector_complex_get(values, i)), size = hypot(re, im);
      size_t at = kept;
      while (at > 0 && size > hypot(found->multiplier[at - 1][0], found->multiplier[at - 1][1]))
        at--;
      if (at >= room) continue;
      size_t last = kept < room ? kept : room - 1;
      memmove(found->multiplier + at + 1, found->multiplier + at,
              (last - at) * sizeof found->multiplier[0]);
      found->multiplier[at][0] = re, found->multiplier[at][1] = im;
      if (kept < room) kept++;
    }
    found->multiplier_count = kept;
  }
  gsl_eigen_nonsymm_free(w);
  gsl_vector_complex_free(values);
}

strut_status strut_shoot(strut_period_map *map, double *y, double *travel,
                         strut_steady_summary *found) {
  shooting_problem s = {.map = map, .both = 2 * (size_t)map->model->length + 1};
  found->shot = false, found->iterations = 0, found->multiplier_count = 0;
  found->reason[0] = '\0';
  for (int32_t i = 0; i < 2 * map->model->node_count; i++) s.count += map->model->fixed[i] ? 0 : 2;
  if (s.count == 0 || s.count > STRUT_MOST_SHOT) {
    snprintf(found->reason, sizeof found->reason,
             "%zu free coordinates and velocities; shooting supports 1 to %d", s.count,
             STRUT_MOST_SHOT);
    return STRUT_OK;
  }
  if (!allocate_problem(&s)) {
    strut_arena_free(&s.arena);
    return STRUT_NO_MEMORY;
  }
  choose_unknowns(&s);
  memcpy(s.here, y, s.both * sizeof(double));
  double gone = 0.0, left = iterate_newton(&s, &gone, found);
  bool interrupted = strut_period_map_interrupted(map);
  if (!interrupted && left <= CONVERGED) {
    found->shot = true;
    found->residual = left;
    memcpy(y, s.here, s.both * sizeof(double));
    *travel = gone;
    find_multipliers(&s, found);
  } else if (!interrupted && !found->reason[0]) {
    snprintf(found->reason, sizeof found->reason,
             "Newton's method did not converge: residual %.2g of the size", left);
  }
  strut_arena_free(&s.arena);
  return interrupted ? STRUT_INTERRUPTED : STRUT_OK;
}
