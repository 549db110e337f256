/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eigenpairs by inverse iteration in twice a double's precision, and how far off they are. */
#include <math.h>
#include <string.h>

#include "engine/statics/modes/parts.h"

enum { MOST_ITERATIONS = 5 };

/* Below the largest eigenvalue by this much there is nothing but zero. */
static const double NOTHING = 1e-24;
/* Eigenvalues are one where they differ by less than this, relative. */
static const double CLUSTER = 1e-6;
static const double OFFSET =
    1e-7; /* of the shift from the eigenvalue, so that it stays invertible */
static const double GOOD = 1e-13; /* relative error at which nothing is left to do */

typedef struct pair {
  strut_dd *x, *mx, *kx;
  double value, error, residual; /* error absolute */
} pair;

static double dot(const strut_dd *x, const strut_dd *y, int32_t n) {
  strut_dd sum = dd_of(0.0);
  for (int32_t i = 0; i < n; i++) sum = dd_add(sum, dd_mul(x[i], y[i]));
  return dd_double(sum);
}

static strut_dd exact_dot(const strut_dd *x, const strut_dd *y, int32_t n) {
  strut_dd sum = dd_of(0.0);
  for (int32_t i = 0; i < n; i++) sum = dd_add(sum, dd_mul(x[i], y[i]));
  return sum;
}

/*
 * The quotient of x and its distance to an eigenvalue: at most |r|, and |r|^2 / gap, with the
 * norm of M^-1, which is at most twice that of its diagonal. Rows without mass store energy
 * |r|^2 / k.
 */
static void measure(const strut_vibration *v, double gap, pair *p) {
  const strut_sparse *a = v->shape->pattern;
  strut_vibration_mass(v, p->x, p->mx);
  strut_vibration_stiffness(v, p->x, p->kx);
  strut_dd square = exact_dot(p->x, p->mx, v->n);
  strut_dd value = dd_div(exact_dot(p->x, p->kx, v->n), square);
  double rest = 0.0, idle = 0.0, size = 0.0, r2 = 0.0, kx2 = 0.0, mx2 = 0.0;
  for (int32_t i = 0; i < v->n; i++) {
    strut_dd inertia = dd_mul(value, p->mx[i]);
    double r = dd_double(dd_sub(p->kx[i], inertia)), m = v->m[a->start[i]];
    r2 += r * r, kx2 += p->kx[i].hi * p->kx[i].hi, mx2 += inertia.hi * inertia.hi;
    if (v->mass[i] > 0)
      rest += 2.0 * r * r / m;
    else if (fabs(v->k[a->start[i]].hi) > 0)
      idle += r * r / fabs(v->k[a->start[i]].hi);
  }
  size = dd_double(square);
  p->value = dd_double(value);
  rest /= size;
  double norm = sqrt(rest);
  p->error = (gap > 0 ? fmin(norm, rest / gap) : norm) + idle / size;
  p->residual = sqrt(r2) / (sqrt(kx2) + sqrt(mx2));
  if (!(kx2 + mx2 > 0)) p->residual = 0.0;
}

static bool together(const strut_modes_work *work, double a, double b) {
  double nothing = NOTHING * work->v->largest;
  return fabs(a - b) <= CLUSTER * fmax(fabs(a), fabs(b)) || fabs(a - b) <= nothing;
}

/* To the nearest eigenvalue that is not in the same cluster; 0: none is known. */
static double gap_of(const strut_modes_work *work, int32_t i) {
  const strut_eigen_set *set = &work->set;
  double gap = 0.0;
  for (int32_t k = i - 1; k >= 0; k--)
    if (!together(work, set->value[k], set->value[i])) {
      gap = set->value[i] - set->value[k];
      break;
    }
  for (int32_t k = i + 1; k < set->count; k++)
    if (!together(work, set->value[k], set->value[i])) {
      double above = set->value[k] - set->value[i];
      gap = gap > 0 ? fmin(gap, above) : above;
      break;
    }
  return fabs(gap);
}

static void subtract(strut_dd *x, strut_dd factor, const double *y, int32_t n) {
  for (int32_t i = 0; i < n; i++) x[i] = dd_sub(x[i], dd_scale(factor, y[i]));
}

/* x'Mx = 1 after what earlier vectors of the same eigenvalue take; false: nothing of it is left. */
static bool normalise(const strut_modes_work *work, int32_t index, double value, pair *p) {
  const strut_eigen_set *set = &work->set;
  int32_t n = set->n;
  strut_vibration_mass(work->v, p->x, p->mx);
  double before = dot(p->x, p->mx, n);
  for (int32_t k = index - 1; k >= 0; k--) {
    if (!together(work, set->value[k], value)) continue;
    const double *y = set->vector + (size_t)k * (size_t)n;
    strut_dd share = dd_of(0.0);
    for (int32_t i = 0; i < n; i++) share = dd_add(share, dd_scale(p->mx[i], y[i]));
    subtract(p->x, share, y, n);
    strut_vibration_mass(work->v, p->x, p->mx);
  }
  double square = dot(p->x, p->mx, n);
  if (!(square > 1e-6 * before)) return false;
  strut_dd scale = dd_div(dd_of(1.0), dd_sqrt(exact_dot(p->x, p->mx, n)));
  for (int32_t i = 0; i < n; i++) p->x[i] = dd_mul(p->x[i], scale);
  return true;
}

/* Noise counts as an error of its own: it is no use to be much better than it. */
static bool good_enough(const strut_modes_work *work, int32_t i, const pair *p) {
  double size = fabs(p->value);
  return p->error <= GOOD * size || size <= NOTHING * work->v->largest ||
         (p->error <= 1e-3 * work->set.noise[i] && p->error <= 1e-10 * size);
}

static void improve(strut_modes_work *work, int32_t index, double gap, pair *p) {
  const strut_vibration *v = work->v;
  for (int i = 0; i < MOST_ITERATIONS && !good_enough(work, index, p); i++) {
    double shift = p->value - OFFSET * fabs(p->value), before = p->error;
    strut_extended_factorise(work->solver.extended, v->shape->pattern, v->k, v->m, -shift);
    for (int k = 0; k < 2; k++) {
      strut_vibration_mass(v, p->x, p->mx);
      memcpy(p->x, p->mx, (size_t)v->n * sizeof *p->x);
      strut_extended_solve(work->solver.extended, p->x);
      if (!normalise(work, index, p->value, p)) {
        p->error = HUGE_VAL;
        return;
      }
    }
    measure(v, gap, p);
    if (i > 1 && !(p->error < 0.5 * before)) return;
  }
}

static void swap(double *a, double *b) {
  double c = *a;
  *a = *b, *b = c;
}

/* Insertion: what was sorted stays nearly so. */
static void sort(strut_eigen_set *set) {
  size_t n = (size_t)set->n;
  for (int32_t i = 1; i < set->count; i++)
    for (int32_t k = i; k > 0 && set->value[k] < set->value[k - 1]; k--) {
      swap(&set->value[k], &set->value[k - 1]);
      swap(&set->noise[k], &set->noise[k - 1]);
      swap(&set->error[k], &set->error[k - 1]);
      swap(&set->residual[k], &set->residual[k - 1]);
      double *x = set->vector + (size_t)k * n, *y = x - n;
      for (size_t j = 0; j < n; j++) swap(&x[j], &y[j]);
    }
}

strut_status strut_modes_refine(strut_modes_work *work, strut_error *error) {
  const strut_vibration *v = work->v;
  strut_eigen_set *set = &work->set;
  size_t n = (size_t)v->n;
  strut_arena scratch = {0};
  pair p = {.x = strut_arena_allocate(&scratch, n, sizeof *p.x),
            .mx = strut_arena_allocate(&scratch, n, sizeof *p.mx),
            .kx = strut_arena_allocate(&scratch, n, sizeof *p.kx)};
  strut_status status = STRUT_OK;
  if (!p.x || !p.mx || !p.kx) status = strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  for (int32_t i = 0; i < set->count && status == STRUT_OK; i++) {
    double *x = set->vector + (size_t)i * n, gap = gap_of(work, i);
    for (size_t k = 0; k < n; k++) p.x[k] = dd_of(x[k]);
    measure(v, gap, &p);
    improve(work, i, gap, &p);
    set->value[i] = p.value;
    set->error[i] = p.error;
    set->residual[i] = p.residual;
    if (!(p.error < HUGE_VAL)) continue;
    for (size_t k = 0; k < n; k++) x[k] = dd_double(p.x[k]);
  }
  if (status == STRUT_OK) sort(set);
  strut_arena_free(&scratch);
  return status;
}
