/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What kind of stationary point a shape is: eigenvalues, motions without stiffness, label. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/rigid_motions.h"
#include "engine/statics/search/critical.h"
#include "engine/statics/search/judge_parts.h"
#include "engine/statics/spectrum.h"

static const double LARGEST = 1e150; /* entry of a stiffness matrix */

const char *strut_stability_name(strut_stability stability) {
  static const char *const names[] = {"stable", "floppy", "saddle", "maximum"};
  return names[stability];
}

/* Few coordinates: all eigenvalues, each with its own error. */
static bool judge_dense(const strut_judgement *j, const double *q, strut_arena *arena,
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
    strut_judge_softest(j, spectrum.vector, n, j->work, point);
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

/* Whether products of two entries, as factors and eigenvalues form them, are numbers. */
static bool is_finite(const strut_sparse *h) {
  for (int32_t k = 0; k < h->start[h->n]; k++)
    if (!(fabs(h->value[k]) < LARGEST)) return false;
  return true;
}

static bool judge(strut_judgement *j, const double *q, strut_arena *arena,
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
  if (!(dense ? judge_dense(j, q, arena, point) : strut_judge_sparse(j, arena, point)))
    return false;
  if (point->zero < point->rigid) point->zero = point->rigid;
  point->label = label_of(point, p->n);
  return true;
}

strut_status strut_critical_judge(const strut_potential *potential, const double *q,
                                  strut_arena *arena, strut_critical_point *point,
                                  strut_error *error) {
  size_t n = (size_t)potential->n, length = (size_t)potential->model->length;
  strut_arena scratch = {0};
  strut_judgement j = {.potential = potential};
  *point = (strut_critical_point){.found = 1, .placements = 1, .down = {-1, -1}};
  point->q = strut_arena_allocate(arena, length, sizeof *point->q);
  point->softest = strut_arena_allocate(arena, length, sizeof *point->softest);
  j.motion = strut_arena_allocate(&scratch, 3 * n, sizeof *j.motion);
  j.work = strut_arena_allocate(&scratch, 3 * n, sizeof *j.work);
  j.hessian = strut_potential_matrix(potential, &scratch);
  bool good = point->q && point->softest && j.motion && j.work && j.hessian;
  if (good) {
    memcpy(point->q, q, length * sizeof *q);
    good = judge(&j, q, arena, point);
  }
  bool finite = good || !j.hessian || is_finite(j.hessian);
  strut_arena_free(&scratch);
  if (!finite)
    return strut_fail(error, STRUT_DIVERGED,
                      "the structure moves to where energies and stiffnesses leave the range of "
                      "numbers; check the units of sizes, stiffnesses and loads");
  return good ? STRUT_OK : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
}
