/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Weighted least squares under equations and lower bounds, by an active set. Steps are taken in the
 * null space of the equations, from a point that satisfies everything.
 */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

#include "engine/statics/form/parts.h"
#include "engine/statics/lu.h"

enum { ROUNDS = 1000 };

static const double CUT = 1e-11;  /* of the largest singular value */
static const double ZERO = 1e-12; /* of a step, of a multiplier */

/* Columns that A maps to nothing: (count, k), in the arena of nobody; NULL: out of memory. */
static gsl_matrix *null_space(int32_t rows, int32_t count, const double *equations) {
  size_t n = (size_t)count, m = (size_t)rows, tall = m > n ? m : n, k = 0;
  gsl_matrix *a = gsl_matrix_calloc(tall, n), *v = gsl_matrix_alloc(n, n), *basis = NULL;
  gsl_vector *s = gsl_vector_alloc(n), *w = gsl_vector_alloc(n);
  if (a && v && s && w) {
    for (size_t i = 0; i < m; i++)
      for (size_t j = 0; j < n; j++) gsl_matrix_set(a, i, j, equations[i * n + j]);
    gsl_linalg_SV_decomp(a, v, s, w);
    while (k < n && gsl_vector_get(s, k) > CUT * gsl_vector_get(s, 0)) k++;
    basis = gsl_matrix_calloc(n, n - k + 1); /* one column to spare: GSL knows no empty matrix */
    for (size_t i = 0; i < n && basis; i++)
      for (size_t j = k; j < n; j++) gsl_matrix_set(basis, i, j - k, gsl_matrix_get(v, i, j));
  }
  gsl_matrix_free(a);
  gsl_matrix_free(v);
  gsl_vector_free(s);
  gsl_vector_free(w);
  return basis;
}

typedef struct problem {
  size_t count, free; /* unknowns; columns of the basis in use */
  const gsl_matrix *basis;
  const double *weight, *low;
  double *x;
  uint8_t *active;
  gsl_matrix *system;
  gsl_vector *right, *solution;
  gsl_permutation *order;
} problem;

/* The step (free) to the least sum with the active bounds kept, and their multipliers behind it. */
static size_t find_step(problem *p) {
  size_t size = p->free;
  gsl_matrix_set_zero(p->system);
  gsl_vector_set_zero(p->right);
  for (size_t i = 0; i < p->count; i++) {
    double square = p->weight[i] * p->weight[i];
    for (size_t a = 0; a < p->free; a++) {
      double za = gsl_matrix_get(p->basis, i, a);
      *gsl_vector_ptr(p->right, a) -= square * p->x[i] * za;
      for (size_t b = 0; b < p->free; b++)
        *gsl_matrix_ptr(p->system, a, b) += square * za * gsl_matrix_get(p->basis, i, b);
    }
    if (!p->active[i]) continue;
    for (size_t a = 0; a < p->free; a++) {
      gsl_matrix_set(p->system, a, size, gsl_matrix_get(p->basis, i, a));
      gsl_matrix_set(p->system, size, a, gsl_matrix_get(p->basis, i, a));
    }
    size++;
  }
  return size;
}

static bool solve_step(problem *p, size_t size) {
  gsl_matrix_view a = gsl_matrix_submatrix(p->system, 0, 0, size, size);
  gsl_vector_view b = gsl_vector_subvector(p->right, 0, size);
  gsl_vector_view x = gsl_vector_subvector(p->solution, 0, size);
  gsl_permutation order = {size, p->order->data};
  strut_lu_factor(&a.matrix, &order);
  for (size_t i = 0; i < size; i++)
    if (gsl_matrix_get(&a.matrix, i, i) == 0) return false;
  return gsl_linalg_LU_solve(&a.matrix, &order, &b.vector, &x.vector) == 0;
}

static double along(const problem *p, size_t i) {
  double sum = 0;
  for (size_t a = 0; a < p->free; a++)
    sum += gsl_matrix_get(p->basis, i, a) * gsl_vector_get(p->solution, a);
  return sum;
}

/* As far as the bounds allow; the one that stops it becomes active. True: nothing moved. */
static bool advance(problem *p) {
  double share = 1, most = 0, scale = 0;
  size_t stop = p->count;
  for (size_t i = 0; i < p->count; i++) {
    double step = along(p, i), room = p->low[i] - p->x[i];
    most = fmax(most, fabs(step)), scale = fmax(scale, fabs(p->x[i]));
    if (p->active[i] || !(step < 0) || !isfinite(room)) continue;
    if (room / step < share) share = fmax(room / step, 0), stop = i;
  }
  for (size_t i = 0; i < p->count; i++) p->x[i] += share * along(p, i);
  if (stop < p->count) p->active[stop] = 1, p->x[stop] = p->low[stop];
  return stop == p->count && most <= ZERO * scale;
}

/* Lets go of the bound that pulls hardest the wrong way; false: none does. */
static bool release(problem *p) {
  size_t at = p->free, worst = p->count;
  double least = 0, scale = 0;
  for (size_t i = 0; i < p->count; i++) {
    if (!p->active[i]) continue;
    double multiplier = gsl_vector_get(p->solution, at++);
    scale = fmax(scale, fabs(multiplier));
    if (multiplier > least) least = multiplier, worst = i;
  }
  if (worst == p->count || least <= ZERO * scale) return false;
  p->active[worst] = 0;
  return true;
}

bool strut_bounded_squares(int32_t rows, int32_t count, const double *equations,
                           const double *weight, const double *low, double *x) {
  size_t n = (size_t)count;
  gsl_matrix *basis = null_space(rows, count, equations);
  problem p = {.count = n,
               .free = basis ? basis->size2 - 1 : 0,
               .basis = basis,
               .weight = weight,
               .low = low,
               .x = x};
  size_t room = p.free + n + 1;
  p.active = strut_allocate(n, 1);
  p.system = gsl_matrix_alloc(room, room);
  p.right = gsl_vector_alloc(room);
  p.solution = gsl_vector_alloc(room);
  p.order = gsl_permutation_alloc(room);
  bool good = basis && p.active && p.system && p.right && p.solution && p.order;
  for (int k = 0; k < ROUNDS && good && p.free > 0; k++) {
    if (!solve_step(&p, find_step(&p))) break;
    if (advance(&p) && !release(&p)) break;
  }
  gsl_matrix_free(basis);
  strut_release(p.active);
  gsl_matrix_free(p.system);
  gsl_vector_free(p.right);
  gsl_vector_free(p.solution);
  gsl_permutation_free(p.order);
  return good;
}
