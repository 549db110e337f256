/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Judging a large structure: signs of the pivots, and the lowest eigenvalues by subspace iteration. */
#include <float.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/search/judge_parts.h"

enum { WANTED = 6, SPACE = 12, TURNS = 40 };

typedef struct lowest {
  const strut_sparse *hessian;
  strut_ldl *ldl;
  double *space, *image; /* (SPACE, n) */
  double value[SPACE];
  double form[SPACE * SPACE], basis[SPACE * SPACE];
  gsl_eigen_symmv_workspace *workspace;
} lowest;

static void make_orthonormal(lowest *l) {
  size_t n = (size_t)l->hessian->n;
  for (size_t k = 0; k < SPACE; k++) {
    double *x = l->space + k * n;
    for (int again = 0; again < 2; again++)
      for (size_t e = 0; e < k; e++) {
        double share = strut_dot(x, l->space + e * n, (ptrdiff_t)n);
        for (size_t i = 0; i < n; i++) x[i] -= share * l->space[e * n + i];
      }
    double length = sqrt(strut_dot(x, x, (ptrdiff_t)n));
    for (size_t i = 0; i < n; i++) x[i] /= length;
  }
}

/* Rayleigh-Ritz in the space: values ascending, vectors turned accordingly. */
static void project(lowest *l) {
  size_t n = (size_t)l->hessian->n, order[SPACE];
  double raw[SPACE];
  for (size_t k = 0; k < SPACE; k++)
    strut_sparse_multiply(l->hessian, l->space + k * n, l->image + k * n);
  for (size_t i = 0; i < SPACE; i++)
    for (size_t k = 0; k <= i; k++)
      l->form[i * SPACE + k] = l->form[k * SPACE + i] =
          strut_dot(l->space + i * n, l->image + k * n, (ptrdiff_t)n);
  gsl_matrix_view form = gsl_matrix_view_array(l->form, SPACE, SPACE);
  gsl_matrix_view basis = gsl_matrix_view_array(l->basis, SPACE, SPACE);
  gsl_vector_view value = gsl_vector_view_array(raw, SPACE);
  gsl_eigen_symmv(&form.matrix, &value.vector, &basis.matrix, l->workspace);
  for (size_t i = 0; i < SPACE; i++) {
    size_t k = i;
    for (; k > 0 && raw[order[k - 1]] > raw[i]; k--) order[k] = order[k - 1];
    order[k] = i;
  }
  memset(l->image, 0, SPACE * n * sizeof *l->image);
  for (size_t i = 0; i < SPACE; i++) {
    l->value[i] = raw[order[i]];
    for (size_t k = 0; k < SPACE; k++) {
      double weight = l->basis[k * SPACE + order[i]];
      for (size_t at = 0; at < n; at++) l->image[i * n + at] += weight * l->space[k * n + at];
    }
  }
  double *swap = l->space;
  l->space = l->image, l->image = swap;
}

static void iterate(lowest *l, double scale) {
  size_t n = (size_t)l->hessian->n;
  double before[WANTED] = {0};
  for (size_t i = 0; i < SPACE * n; i++) l->space[i] = sin(1.0 + 12.9898 * (double)i);
  for (int turn = 0; turn < TURNS; turn++) {
    bool settled = turn > 1;
    for (size_t k = 0; k < SPACE; k++) strut_ldl_solve(l->ldl, l->space + k * n);
    make_orthonormal(l);
    project(l);
    for (int i = 0; i < WANTED; i++) {
      double change = fabs(l->value[i] - before[i]);
      settled = settled && change <= fmax(1e-8 * fabs(l->value[i]), 1e-15 * scale);
      before[i] = l->value[i];
    }
    if (settled) return;
  }
}

/* Negative eigenvalues of H + shift; -1 without memory. A shift that meets a zero pivot is moved. */
static int32_t count_negative(const lowest *l, double shift, strut_inertia *inertia) {
  for (int i = 0; i < 8; i++, shift *= 1.125) {
    strut_status status = strut_ldl_factorise(l->ldl, l->hessian, shift, inertia);
    if (status == STRUT_OK) return inertia->negative;
    if (status == STRUT_NO_MEMORY) return -1;
  }
  return -1;
}

/* A factor of H + shift that is positive definite, the shift as small as powers of ten allow. */
static bool factorise_above(const lowest *l, double shift) {
  strut_inertia inertia;
  for (int i = 0; i < 25; i++, shift *= 10.0)
    if (strut_ldl_factorise(l->ldl, l->hessian, shift, &inertia) == STRUT_OK &&
        inertia.negative == 0)
      return true;
  return false;
}

bool strut_judge_sparse(const strut_judgement *j, strut_arena *arena, strut_critical_point *point) {
  size_t n = (size_t)j->hessian->n;
  strut_arena scratch = {0};
  lowest l = {.hessian = j->hessian};
  double scale = 0.0;
  for (size_t i = 0; i < n; i++) scale = fmax(scale, fabs(l.hessian->value[l.hessian->start[i]]));
  double noise = 64.0 * DBL_EPSILON * scale + 1e-300;
  strut_inertia inertia;
  l.space = strut_arena_allocate(&scratch, SPACE * n, sizeof *l.space);
  l.image = strut_arena_allocate(&scratch, SPACE * n, sizeof *l.image);
  l.workspace = gsl_eigen_symmv_alloc(SPACE);
  point->eigenvalues = strut_arena_allocate(arena, WANTED, sizeof *point->eigenvalues);
  bool good = l.space && l.image && l.workspace && point->eigenvalues &&
              strut_ldl_create(j->hessian, &l.ldl, NULL) == STRUT_OK;
  int32_t below = good ? count_negative(&l, noise, &inertia) : -1;
  int32_t above = good ? count_negative(&l, -noise, &inertia) : -1;
  good = good && below >= 0 && above >= 0 && factorise_above(&l, noise);
  if (good) {
    point->negative = below;
    point->zero = above > below ? above - below : 0;
    iterate(&l, scale);
    memcpy(point->eigenvalues, l.value, WANTED * sizeof *l.value);
    point->eigenvalue_count = WANTED;
    strut_judge_softest(j, l.space, SPACE, j->work, point);
  }
  if (l.workspace) gsl_eigen_symmv_free(l.workspace);
  strut_ldl_free(l.ldl);
  strut_arena_free(&scratch);
  return good;
}
