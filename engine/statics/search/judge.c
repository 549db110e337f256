/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Classifies a stationary point: small structures by all eigenvalues, large ones by a factor's
 * signs.
 */
#include <assert.h>
#include <float.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/rigid_motions.h"
#include "engine/statics/search/critical.h"
#include "engine/statics/spectrum.h"

typedef struct judgement {
  const strut_potential *potential;
  strut_sparse *hessian; /* at the shape, without cables and contacts that rounding alone closes */
  double least;          /* [N] what they must pull or push by */
  double *motion;        /* (3, n) rigid-body motions without stiffness, orthonormal */
  int32_t rigid;         /* number of rigid-body motions */
  double *work;          /* (3 n) */
} judgement;

/* The direction of a mode without its share of rigid-body motions; false where little is left. */
static bool without_rigid(const judgement *j, const double *mode, double *direction) {
  size_t n = (size_t)j->potential->n;
  double square = 0.0;
  memcpy(direction, mode, n * sizeof *direction);
  for (size_t k = 0; k < (size_t)j->rigid; k++) {
    const double *motion = j->motion + k * n;
    double share = 0.0;
    for (size_t i = 0; i < n; i++) share += motion[i] * mode[i];
    for (size_t i = 0; i < n; i++) direction[i] -= share * motion[i];
  }
  for (size_t i = 0; i < n; i++) square += direction[i] * direction[i];
  if (square < 0.25) return false;
  for (size_t i = 0; i < n; i++) direction[i] /= sqrt(square);
  return true;
}

/* The first of `count` modes (count, n), softest first, that is no rigid motion, as the softest. */
static void set_softest(const judgement *j, const double *modes, int32_t count, double *direction,
                        strut_critical_point *point) {
  const strut_potential *p = j->potential;
  for (size_t i = 0; i < (size_t)count; i++) {
    if (!without_rigid(j, modes + i * (size_t)p->n, direction)) continue;
    for (int32_t k = 0; k < p->n; k++) point->softest[p->coordinate[k]] = direction[k];
    return;
  }
}

/* Large structures: signs of the pivots, and the lowest eigenvalues by subspace iteration. */

enum { WANTED = 6, SPACE = 12, TURNS = 40 };

typedef struct lowest {
  const strut_sparse *hessian;
  strut_ldl *ldl;
  double *space, *image; /* (SPACE, n) */
  double value[SPACE];
  double form[SPACE * SPACE], basis[SPACE * SPACE];
  gsl_eigen_symmv_workspace *workspace;
} lowest;

static void orthonormalise(lowest *l) {
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
static void project_subspace(lowest *l) {
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

/* False: out of memory. */
static bool iterate_subspace(lowest *l, double scale) {
  size_t n = (size_t)l->hessian->n;
  double before[WANTED] = {0};
  for (size_t i = 0; i < SPACE * n; i++) l->space[i] = sin(1.0 + 12.9898 * (double)i);
  for (int turn = 0; turn < TURNS; turn++) {
    bool settled = turn > 1;
    if (!strut_ldl_solve_many(l->ldl, l->space, SPACE)) return false;
    orthonormalise(l);
    project_subspace(l);
    for (int i = 0; i < WANTED; i++) {
      double change = fabs(l->value[i] - before[i]);
      settled = settled && change <= fmax(1e-8 * fabs(l->value[i]), 1e-15 * scale);
      before[i] = l->value[i];
    }
    if (settled) break;
  }
  return true;
}

/*
 * Negative eigenvalues of H + shift; -1 without memory. A shift that meets a zero pivot is moved.
 */
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

/* Signs of D and the lowest eigenvalues; false: out of memory. */
static bool judge_sparse(const judgement *j, strut_arena *arena, strut_critical_point *point) {
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
  int32_t above = good ? count_negative(&l, -noise, &inertia) : -1;
  /* where none is below the upper bound, none is below the lower one, and its factor serves */
  int32_t below = above > 0 ? count_negative(&l, noise, &inertia) : above;
  good = good && below >= 0 && above >= 0 && (below == 0 || factorise_above(&l, noise));
  if (good) {
    point->negative = below;
    point->zero = above > below ? above - below : 0;
    good = iterate_subspace(&l, scale);
  }
  if (good) {
    memcpy(point->eigenvalues, l.value, WANTED * sizeof *l.value);
    point->eigenvalue_count = WANTED;
    set_softest(j, l.space, SPACE, j->work, point);
  }
  if (l.workspace) gsl_eigen_symmv_free(l.workspace);
  strut_ldl_free(l.ldl);
  strut_arena_free(&scratch);
  return good;
}

/* Classification of a stationary point: eigenvalues, motions without stiffness, label. */

static const double LARGEST = 1e150; /* entry of a stiffness matrix */

const char *strut_stability_name(strut_stability stability) {
  static const char *const names[] = {"stable", "floppy", "saddle", "maximum"};
  assert((size_t)stability < sizeof names / sizeof names[0]);
  return names[stability];
}

/* Few coordinates: all eigenvalues, each with its own error. */
static bool judge_dense(const judgement *j, const double *q, strut_arena *arena,
                        strut_critical_point *point) {
  int32_t n = j->potential->n;
  strut_spectrum spectrum;
  strut_spectrum_workspace *room = strut_spectrum_create(j->potential);
  bool good = room && strut_spectrum_compute(room, q, j->least, true, &spectrum);
  point->eigenvalues = strut_arena_allocate(arena, (size_t)n, sizeof *point->eigenvalues);
  if (good && point->eigenvalues) {
    for (int32_t i = 0; i < n; i++) {
      double value = point->eigenvalues[i] = spectrum.value[i], error = 16.0 * spectrum.noise[i];
      if (value < -error) point->negative++;
      if (fabs(value) <= error) point->zero++;
    }
    point->eigenvalue_count = n;
    set_softest(j, spectrum.vector, n, j->work, point);
  }
  strut_spectrum_free(room);
  return good && point->eigenvalues;
}

static strut_stability label_of(const strut_critical_point *point, int32_t n) {
  if (point->negative > 0)
    return point->negative == n - point->rigid ? STRUT_MAXIMUM : STRUT_SADDLE;
  return point->zero > point->rigid ? STRUT_FLOPPY : STRUT_STABLE;
}

static double largest_diagonal(const strut_sparse *h) {
  double largest = 0.0;
  for (int32_t j = 0; j < h->n; j++) largest = fmax(largest, fabs(h->value[h->start[j]]));
  return largest;
}

/* True if products of two entries, as factors and eigenvalues form them, cannot overflow. */
static bool is_finite(const strut_sparse *h) {
  for (int32_t k = 0; k < h->start[h->n]; k++)
    if (!(fabs(h->value[k]) < LARGEST)) return false;
  return true;
}

static bool judge_point(judgement *j, const double *q, strut_arena *arena,
                        strut_critical_point *point) {
  const strut_potential *p = j->potential;
  double size = p->model->size > 0 ? p->model->size : 1.0;
  strut_potential_gradient(p, q, j->work);
  for (int32_t i = 0; i < p->n; i++) point->residual = fmax(point->residual, fabs(j->work[i]));
  point->potential = strut_potential_value(p, q);
  j->least = 32.0 * strut_potential_rounding(p, q);
  strut_potential_hessian_above(p, q, j->least, j->hessian);
  double noise = p->n * DBL_EPSILON * largest_diagonal(j->hessian) + 64.0 * j->least / size;
  j->rigid = strut_rigid_motions(p, q, j->motion);
  j->rigid = strut_rigid_motions_free(j->hessian, noise, j->rigid, j->motion, j->work);
  point->rigid = j->rigid;
  bool dense = p->n <= STRUT_DENSE_STATICS;
  if (!(dense ? judge_dense(j, q, arena, point) : judge_sparse(j, arena, point))) return false;
  if (point->zero < point->rigid) point->zero = point->rigid;
  point->label = label_of(point, p->n);
  return true;
}

strut_status strut_critical_judge(const strut_potential *potential, const double *q,
                                  strut_arena *arena, strut_critical_point *point,
                                  strut_error *error) {
  size_t n = (size_t)potential->n, length = (size_t)potential->model->length;
  strut_arena scratch = {0};
  judgement j = {.potential = potential};
  *point = (strut_critical_point){.found = 1, .placements = 1, .down = {-1, -1}};
  point->q = strut_arena_allocate(arena, length, sizeof *point->q);
  point->softest = strut_arena_allocate(arena, length, sizeof *point->softest);
  j.motion = strut_arena_allocate(&scratch, 3 * n, sizeof *j.motion);
  j.work = strut_arena_allocate(&scratch, 3 * n, sizeof *j.work);
  j.hessian = strut_potential_matrix(potential, &scratch);
  bool good = point->q && point->softest && j.motion && j.work && j.hessian;
  if (good) {
    memcpy(point->q, q, length * sizeof *q);
    good = judge_point(&j, q, arena, point);
  }
  bool finite = good || !j.hessian || is_finite(j.hessian);
  strut_arena_free(&scratch);
  if (!finite)
    return strut_fail(error, STRUT_DIVERGED,
                      "the structure moves to where energies and stiffnesses leave the range of "
                      "numbers; check the units of sizes, stiffnesses and loads");
  return good ? STRUT_OK : strut_no_memory(error, "");
}
