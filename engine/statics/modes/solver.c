/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/modes/parts.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "engine/base/memory.h"

/* A positive definite matrix of that pattern: what CHOLMOD makes of it has the pattern of L. */
static strut_status find_pattern(const strut_sparse *pattern, strut_factor **factor,
                                 strut_error *error) {
  strut_arena arena = {0};
  size_t n = (size_t)pattern->n, count = (size_t)pattern->start[pattern->n];
  double *sum = strut_arena_allocate(&arena, n, sizeof *sum);
  strut_sparse sample = *pattern;
  sample.value = strut_arena_allocate(&arena, count, sizeof *sample.value);
  strut_status status = STRUT_NO_MEMORY;
  if (sum && sample.value) {
    for (int32_t j = 0; j < sample.n; j++)
      for (int32_t k = sample.start[j] + 1; k < sample.start[j + 1]; k++) {
        sample.value[k] = -1.0;
        sum[j] += 1.0;
        sum[sample.row[k]] += 1.0;
      }
    for (int32_t j = 0; j < sample.n; j++) sample.value[sample.start[j]] = 2.0 + sum[j];
    status = strut_factor_create(&sample, factor, error);
  } else {
    strut_fail(error, status, "out of memory while factorising a matrix");
  }
  strut_arena_free(&arena);
  return status;
}

strut_status strut_extended_create(const strut_sparse *pattern, strut_extended_factor **result,
                                   strut_error *error) {
  strut_extended_factor *f = *result = strut_allocate(1, sizeof *f);
  if (!f) return strut_no_memory(error, "while factorising a matrix");
  f->n = pattern->n;
  strut_status status = find_pattern(pattern, &f->owned, error);
  if (status == STRUT_OK) {
    size_t n = (size_t)f->n;
    f->pattern = f->owned;
    strut_release(f->owned->value); /* the sample's numbers mean nothing */
    f->owned->value = NULL;
    f->value = strut_allocate((size_t)f->owned->start[n], sizeof *f->value);
    f->diagonal = strut_allocate(n, sizeof *f->diagonal);
    f->work = strut_allocate(n, sizeof *f->work);
    f->inverse = strut_allocate(n, sizeof *f->inverse);
    f->next = strut_allocate(2 * n, sizeof *f->next);
    f->at = strut_allocate(n, sizeof *f->at);
    if (f->value && f->diagonal && f->work && f->inverse && f->next && f->at) {
      for (int32_t i = 0; i < f->n; i++) f->inverse[f->owned->order[i]] = i;
      return STRUT_OK;
    }
    status = strut_no_memory(error, "while factorising a matrix");
  }
  strut_extended_free(f);
  *result = NULL;
  return status;
}

void strut_extended_free(strut_extended_factor *factor) {
  if (!factor) return;
  strut_factor_free(factor->owned);
  strut_release(factor->value);
  strut_release(factor->diagonal);
  strut_release(factor->work);
  strut_release(factor->inverse);
  strut_release(factor->next);
  strut_release(factor->at);
  strut_release(factor);
}

/* The lower triangle of P A P' into L's places and D. */
static void take_matrix(strut_extended_factor *f, const strut_sparse *a, const strut_dd *k,
                        const double *m, double shift) {
  const int32_t *start = f->pattern->start, *row = f->pattern->row;
  memset(f->value, 0, (size_t)start[f->n] * sizeof *f->value);
  for (int32_t j = 0; j < f->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      strut_dd value = m ? dd_add(k[at], dd_product(shift, m[at])) : k[at];
      int32_t p = f->inverse[a->row[at]], q = f->inverse[j];
      if (p == q) {
        f->diagonal[p] = value;
        continue;
      }
      int32_t column = p < q ? p : q, wanted = p < q ? q : p;
      int32_t low = start[column], high = start[column + 1] - 1;
      while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (row[middle] < wanted)
          low = middle + 1;
        else
          high = middle;
      }
      f->value[low] = value;
    }
}

/* Column j loses what the earlier column c, from its entry `at` in row j on, takes from it. */
static void subtract_column(strut_extended_factor *f, int32_t c, int32_t at, int32_t j) {
  const int32_t *row = f->pattern->row;
  strut_dd factor = dd_negative(dd_mul(f->value[at], f->diagonal[c]));
  f->diagonal[j] = dd_add(f->diagonal[j], dd_mul(factor, f->value[at]));
  for (int32_t k = at + 1; k < f->pattern->start[c + 1]; k++)
    f->work[row[k]] = dd_add(f->work[row[k]], dd_mul(factor, f->value[k]));
}

/* Keeps count of the signs, and of the pivot that cancelled most; none is left at zero. */
static void look_at_pivot(strut_extended_factor *f, int32_t j, double before) {
  double size = fabs(f->diagonal[j].hi), loss = before > 0 ? size / before : 0.0;
  if (loss < f->loss) f->loss = loss, f->weakest = f->pattern->order[j];
  if (!(size > before * STRUT_DD_EPSILON))
    f->diagonal[j] = dd_of(before > 0 ? before * STRUT_DD_EPSILON : STRUT_DD_EPSILON);
  if (f->diagonal[j].hi < 0) f->negative++;
}

void strut_extended_factorise(strut_extended_factor *f, const strut_sparse *pattern,
                              const strut_dd *k, const double *m, double shift) {
  const int32_t *start = f->pattern->start, *row = f->pattern->row;
  int32_t *head = f->next, *next = f->next + f->n; /* columns whose next entry is in row j */
  take_matrix(f, pattern, k, m, shift);
  f->negative = f->weakest = 0;
  f->loss = 1.0;
  for (int32_t j = 0; j < f->n; j++) head[j] = -1, f->work[j] = dd_of(0.0);
  for (int32_t j = 0; j < f->n; j++) {
    double before = fabs(f->diagonal[j].hi);
    for (int32_t i = start[j]; i < start[j + 1]; i++) f->work[row[i]] = f->value[i];
    for (int32_t c = head[j], after; c >= 0; c = after) {
      after = next[c];
      before =
          fmax(before, fabs(f->diagonal[c].hi) * f->value[f->at[c]].hi * f->value[f->at[c]].hi);
      subtract_column(f, c, f->at[c], j);
      if (++f->at[c] < start[c + 1]) next[c] = head[row[f->at[c]]], head[row[f->at[c]]] = c;
    }
    look_at_pivot(f, j, before);
    for (int32_t i = start[j]; i < start[j + 1]; i++) {
      f->value[i] = dd_div(f->work[row[i]], f->diagonal[j]);
      f->work[row[i]] = dd_of(0.0);
    }
    f->at[j] = start[j];
    if (start[j] < start[j + 1]) next[j] = head[row[start[j]]], head[row[start[j]]] = j;
  }
}

void strut_extended_solve(const strut_extended_factor *f, strut_dd *x) {
  const int32_t *start = f->pattern->start, *row = f->pattern->row;
  strut_dd *y = f->work;
  for (int32_t i = 0; i < f->n; i++) y[i] = x[f->pattern->order[i]];
  for (int32_t j = 0; j < f->n; j++) {
    strut_dd negative = dd_negative(y[j]);
    for (int32_t k = start[j]; k < start[j + 1]; k++)
      y[row[k]] = dd_add(y[row[k]], dd_mul(negative, f->value[k]));
  }
  for (int32_t j = f->n - 1; j >= 0; j--) {
    strut_dd sum = dd_div(y[j], f->diagonal[j]);
    for (int32_t k = start[j]; k < start[j + 1]; k++)
      sum = dd_sub(sum, dd_mul(f->value[k], y[row[k]]));
    y[j] = sum;
  }
  for (int32_t i = 0; i < f->n; i++) x[f->pattern->order[i]] = y[i];
}

/* Relative to the largest eigenvalue: a smaller shift may drown in a plain factor's rounding. */
static const double SAFE_SHIFT = 1e-10;
static const double SAFE_PIVOT = 1e-9; /* relative: what is less may have the wrong sign */

enum { CORRECTIONS = 2 };
/* A correction this small beside the solution leaves an error of its square: no further one is worth it. */
static const double ENOUGH = 1e-10;

strut_status strut_modes_solver_create(const strut_vibration *v, strut_modes_solver *solver,
                                       strut_error *error) {
  size_t n = (size_t)v->n, entries = (size_t)v->shape->pattern->start[n];
  *solver = (strut_modes_solver){.v = v, .sum = *v->shape->pattern};
  solver->sum.value = strut_arena_allocate(&solver->arena, entries, sizeof(double));
  solver->b = strut_arena_allocate(&solver->arena, n, sizeof *solver->b);
  solver->r = strut_arena_allocate(&solver->arena, n, sizeof *solver->r);
  solver->mx = strut_arena_allocate(&solver->arena, n, sizeof *solver->mx);
  solver->step = strut_arena_allocate(&solver->arena, n, sizeof *solver->step);
  if (!solver->sum.value || !solver->b || !solver->r || !solver->mx || !solver->step)
    return strut_no_memory(error, "");
  strut_status status = strut_ldl_create(v->shape->pattern, &solver->plain, error);
  if (status != STRUT_OK) return status;
  return strut_extended_create(v->shape->pattern, &solver->extended, error);
}

void strut_modes_solver_free(strut_modes_solver *solver) {
  strut_ldl_free(solver->plain);
  strut_extended_free(solver->extended);
  strut_arena_free(&solver->arena);
  *solver = (strut_modes_solver){0};
}

static bool factorise_plainly(strut_modes_solver *s) {
  const strut_vibration *v = s->v;
  strut_inertia inertia;
  for (int32_t i = 0; i < s->sum.start[v->n]; i++)
    s->sum.value[i] = v->k[i].hi + s->shift * v->m[i];
  if (strut_ldl_factorise(s->plain, &s->sum, 0.0, &inertia) != STRUT_OK) return false;
  if (!(inertia.smallest > SAFE_PIVOT)) return false;
  s->negative = inertia.negative;
  s->weakest = inertia.row;
  s->loss = inertia.smallest;
  return true;
}

static bool is_interrupted(const strut_modes_solver *s) { return s->interrupt && *s->interrupt; }

void strut_modes_factorise(strut_modes_solver *s, double shift) {
  const strut_vibration *v = s->v;
  if (is_interrupted(s)) return;
  s->shift = shift;
  s->is_plain = fabs(shift) >= SAFE_SHIFT * v->largest && factorise_plainly(s);
  if (s->is_plain) return;
  strut_extended_factorise(s->extended, v->shape->pattern, v->k, v->m, shift);
  s->negative = s->extended->negative;
  s->weakest = s->extended->weakest;
  s->loss = s->extended->loss;
}

void strut_modes_solve(strut_modes_solver *s, strut_dd *x) {
  const strut_vibration *v = s->v;
  int32_t n = v->n;
  if (is_interrupted(s)) return;
  if (!s->is_plain) {
    strut_extended_solve(s->extended, x);
    return;
  }
  memcpy(s->b, x, (size_t)n * sizeof *x);
  for (int32_t i = 0; i < n; i++) s->step[i] = dd_double(x[i]);
  strut_ldl_solve(s->plain, s->step);
  for (int32_t i = 0; i < n; i++) x[i] = dd_of(s->step[i]);
  for (int k = 0; k < CORRECTIONS; k++) {
    strut_vibration_stiffness(v, x, s->r);
    strut_vibration_mass(v, x, s->mx);
    for (int32_t i = 0; i < n; i++)
      s->step[i] = dd_double(dd_sub(s->b[i], dd_add(s->r[i], dd_scale(s->mx[i], s->shift))));
    strut_ldl_solve(s->plain, s->step);
    double size = 0.0, change = 0.0;
    for (int32_t i = 0; i < n; i++) {
      size = fmax(size, fabs(x[i].hi));
      change = fmax(change, fabs(s->step[i]));
      x[i] = dd_add(x[i], dd_of(s->step[i]));
    }
    if (change <= ENOUGH * size) break;
  }
}
