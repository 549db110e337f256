/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by a sparse L D L' factor of the Hessian, shifted until it is positive definite. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/descent_parts.h"

typedef struct room {
  const strut_potential *potential;
  strut_sparse *hessian;
  strut_ldl *ldl;
  strut_inertia inertia;
  double shift;         /* of the factor at hand; NAN: there is none */
  double scale;         /* largest diagonal entry */
  double *work, *other; /* (n) */
  strut_arena arena;
} room;

static void room_free(void *memory) {
  room *r = memory;
  if (!r) return;
  strut_ldl_free(r->ldl);
  strut_arena_free(&r->arena);
  strut_release(r);
}

void *strut_curvature_sparse_create(const strut_potential *potential) {
  room *r = strut_allocate(1, sizeof *r);
  if (!r) return NULL;
  r->potential = potential;
  r->hessian = strut_potential_matrix(potential, &r->arena);
  r->work = strut_arena_allocate(&r->arena, (size_t)potential->n, sizeof *r->work);
  r->other = strut_arena_allocate(&r->arena, (size_t)potential->n, sizeof *r->other);
  if (r->hessian && r->work && r->other &&
      strut_ldl_create(potential->pattern, &r->ldl, NULL) == STRUT_OK)
    return r;
  room_free(r);
  return NULL;
}

/* Pivots of this share of their diagonal are rounding: neither their size nor their sign counts. */
static const double NOISE = 32 * DBL_EPSILON;

/* Factorises H + shift; true where it is positive definite beyond rounding. */
static bool factorise(room *r, double shift) {
  bool good = strut_ldl_factorise(r->ldl, r->hessian, shift, &r->inertia) == STRUT_OK;
  r->shift = good ? shift : (double)NAN;
  return good && r->inertia.negative == 0 && r->inertia.smallest > NOISE;
}

static bool look(void *memory, const double *q) {
  room *r = memory;
  const strut_sparse *h = r->hessian;
  strut_potential_hessian(r->potential, q, r->hessian);
  r->scale = 0.0;
  for (int32_t k = 0; k < h->start[h->n]; k++)
    if (!isfinite(h->value[k])) return false;
  for (int32_t j = 0; j < h->n; j++) r->scale = fmax(r->scale, fabs(h->value[h->start[j]]));
  r->shift = (double)NAN;
  return true;
}

/* s = -(H + shift)^-1 g; its length. */
static double solve(room *r, const double *g, double *s) {
  int32_t n = r->hessian->n;
  for (int32_t i = 0; i < n; i++) s[i] = -g[i];
  strut_ldl_solve(r->ldl, s);
  return sqrt(strut_dot(s, s, n));
}

static strut_model_step judge(room *r, const double *g, const double *s) {
  int32_t n = r->hessian->n;
  strut_sparse_multiply(r->hessian, s, r->work);
  return (strut_model_step){sqrt(strut_dot(s, s, n)),
                            -strut_dot(g, s, n) - 0.5 * strut_dot(s, r->work, n)};
}

/* The smallest of the shifts tried at which H + shift is positive definite; false: none is. */
static bool lift(room *r, double *low, double *shift) {
  *low = 0.0;
  if (factorise(r, 0.0)) {
    *shift = 0.0;
    return true;
  }
  double next = 1e-14 * r->scale + 1e-300;
  for (int i = 0; i < 40; i++, next *= 10.0) {
    if (factorise(r, next)) {
      *shift = next;
      return true;
    }
    if (!isnan(r->shift)) *low = next;
  }
  return false;
}

/* From a shift that is larger than need be towards `low`, which is too small: a longer step. */
static double lengthen(room *r, const double *g, double radius, double low, double shift,
                       double length, double *s) {
  for (int i = 0; i < 3 && low > 0 && length < 0.7 * radius; i++) {
    double between = sqrt(low * shift);
    bool good = factorise(r, between);
    double longer = good ? solve(r, g, s) : HUGE_VAL;
    if (longer <= radius) {
      shift = between, length = longer;
      continue;
    }
    low = between;
    factorise(r, shift);
    length = solve(r, g, s);
  }
  return length;
}

/* From a shift whose step is too long upwards: Newton's method on 1/|s|, each trial a new factor. */
static void shorten(room *r, const double *g, double radius, double low, double length, double *s) {
  int32_t n = r->hessian->n;
  double high = HUGE_VAL, shift = low;
  for (int i = 0; i < 30 && !(length <= radius && length > 0.7 * radius); i++) {
    memcpy(r->other, s, (size_t)n * sizeof *s);
    strut_ldl_solve(r->ldl, r->other);
    double slope = strut_dot(s, r->other, n); /* -|s| d|s|/dshift */
    double next = shift + length * length * (length / (0.85 * radius) - 1.0) / slope;
    if (!(next > low && next < high))
      next = high == HUGE_VAL ? fmax(10.0 * low, 1e-14 * r->scale) : 0.5 * (low + high);
    if (high - low <= 1e-3 * high && length <= radius) break;
    if (!factorise(r, next)) break;
    shift = next;
    length = solve(r, g, s);
    *(length > radius ? &low : &high) = shift;
  }
  if (length <= radius) return;
  for (int32_t i = 0; i < n; i++) s[i] *= radius / length;
}

/* A step of 0.7 to 1 radius is good enough, or a shorter one where Newton's is. */
static strut_model_step descend(void *memory, const double *g, double radius, double still,
                                double *s) {
  room *r = memory;
  double low, shift;
  (void)still;
  if (!lift(r, &low, &shift)) return (strut_model_step){0};
  double length = solve(r, g, s);
  if (length > radius)
    shorten(r, g, radius, shift, length, s);
  else if (shift > 0)
    lengthen(r, g, radius, low, shift, length, s);
  return judge(r, g, s);
}

/* A factor does not know its stiff modes. */
static bool straighten(void *memory, const double *g, double *s) {
  (void)memory, (void)g, (void)s;
  return false;
}

static double newton(void *memory, const double *g, double *s) {
  room *r = memory;
  factorise(r, 0.0);
  if (isnan(r->shift) || r->inertia.smallest <= NOISE) factorise(r, 1e-13 * r->scale);
  return isnan(r->shift) ? HUGE_VAL : solve(r, g, s);
}

/* Inverse iteration from a start that leans on no motion, shifted to just below the lowest value. */
static bool ridge(void *memory, double *s) {
  room *r = memory;
  int32_t n = r->hessian->n;
  double low, shift, quotient = 0.0;
  if (!lift(r, &low, &shift)) return false;
  if (shift <= 1e-13 * r->scale) return false;
  for (int32_t i = 0; i < n; i++) s[i] = sin(1.0 + 12.9898 * i);
  for (int turn = 0; turn < 20; turn++) {
    strut_ldl_solve(r->ldl, s);
    double length = sqrt(strut_dot(s, s, n));
    for (int32_t i = 0; i < n; i++) s[i] /= length;
    strut_sparse_multiply(r->hessian, s, r->work);
    quotient = strut_dot(s, r->work, n);
    if (turn > 3 && quotient < 0) break;
  }
  return quotient < -1e-13 * r->scale;
}

const strut_curvature strut_curvature_sparse = {look,   descend, straighten,
                                                newton, ridge,   room_free};
