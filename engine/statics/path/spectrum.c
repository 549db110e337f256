/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Eigenvalues of the stiffness. The dense method is good to the last bit of the largest eigenvalue:
 * with a bar of 1e11 N/m a soft one of 100 N/m would have seven digits left, and its sign at a
 * bifurcation none. So the soft ones are computed once more, as Ritz values of the soft
 * eigenvectors, from the members one by one: a motion that does not stretch a stiff bar then meets
 * none of its stiffness.
 */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>

#include "engine/statics/path/system.h"

enum { MOST_SOFT = 40 };

static const double SOFT = 1e-6;        /* of the largest eigenvalue: few digits are left */
static const double UNSIGNED = 1e-12;   /* likewise: not even the sign is sure */
static const double ZERO_VALUE = 1e-13; /* of a soft mode's largest parts: no sign below this */
static const double NO_VALUE = 1e-20;   /* of the largest eigenvalue, likewise */
static const double ROUNDING = 2e-16;   /* of a double */

/* Displacement of a member's second end relative to its first in a mode of the free coordinates. */
static void relative_motion(const strut_path_system *s, int32_t j, size_t mode, double d[2]) {
  const strut_member_table *t = &s->model->members;
  for (uint32_t c = 0; c < 2; c++) {
    int32_t a = s->potential->row_of[t->from[j] + c], b = s->potential->row_of[t->to[j] + c];
    d[c] = (b >= 0 ? gsl_matrix_get(s->vectors, (size_t)b, mode) : 0.0) -
           (a >= 0 ? gsl_matrix_get(s->vectors, (size_t)a, mode) : 0.0);
  }
}

static double contact_motion(const strut_path_system *s, int32_t i, size_t mode) {
  const int32_t *row = s->potential->row_of + s->model->contacts.at[i];
  double sum = 0;
  for (int c = 0; c < 2; c++)
    if (row[c] >= 0) sum += s->terms.normal[c] * gsl_matrix_get(s->vectors, (size_t)row[c], mode);
  return sum;
}

static double held_motion(const strut_path_system *s, int32_t k, size_t mode) {
  double sum = 0;
  for (int32_t i = 0; i < s->n; i++)
    sum += s->held[k][i] * gsl_matrix_get(s->vectors, (size_t)i, mode);
  return sum;
}

/* ritz += factor part part^T */
static void add_square(gsl_matrix *ritz, const double *part, double factor) {
  for (size_t k = 0; k < ritz->size1; k++)
    for (size_t l = 0; l < ritz->size1; l++)
      *gsl_matrix_ptr(ritz, k, l) += factor * part[k] * part[l];
}

/* slope b b' + t d2e/dq2 of an element, and the largest of its parts. */
static void project_element(strut_path_system *s, int32_t i, size_t first, gsl_matrix *ritz) {
  const strut_element *e = &s->model->elements.element[i];
  const strut_element_pose *pose = &s->elements.element[i].pose;
  const uint32_t *at = s->model->elements.at + e->first;
  double along[MOST_SOFT], motion[MOST_SOFT][STRUT_MOST_GRADIENT];
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0};
  int32_t n = 2 * e->nodes;
  size_t count = ritz->size1;
  strut_element_bend(s->model, i, s->q, pose->force, bend);
  for (size_t k = 0; k < count; k++) {
    along[k] = 0.0;
    for (int32_t c = 0; c < n; c++) {
      int32_t row = s->potential->row_of[at[c / 2] + (uint32_t)(c % 2)];
      motion[k][c] = row >= 0 ? gsl_matrix_get(s->vectors, (size_t)row, first + k) : 0.0;
      along[k] += pose->b[c] * motion[k][c];
    }
  }
  add_square(ritz, along, pose->slope);
  for (size_t k = 0; k < count; k++)
    for (size_t l = 0; l < count; l++) {
      double sum = 0.0;
      for (int32_t a = 0; a < n; a++)
        for (int32_t b = 0; b < n; b++) sum += motion[k][a] * bend[a * n + b] * motion[l][b];
      *gsl_matrix_ptr(ritz, k, l) += sum;
      if (k == l)
        s->soft_parts =
            fmax(s->soft_parts, fmax(fabs(sum), fabs(pose->slope) * along[k] * along[k]));
    }
}

/* The stiffness seen by the modes first, first + 1, ... */
static void project(strut_path_system *s, size_t first, gsl_matrix *ritz) {
  double along[MOST_SOFT], across[MOST_SOFT];
  size_t count = ritz->size1;
  gsl_matrix_set_zero(ritz);
  for (int32_t j = 0; j < s->model->members.count; j++) {
    const strut_path_member *m = &s->member[j];
    if (!m->pulls) continue;
    for (size_t k = 0; k < count; k++) {
      double d[2];
      relative_motion(s, j, first + k, d);
      along[k] = m->length > 0 ? m->ux * d[0] + m->uy * d[1] : d[0];
      across[k] = m->length > 0 ? m->ux * d[1] - m->uy * d[0] : d[1];
    }
    add_square(ritz, along, m->length > 0 ? s->terms.stiffness[j] : m->across);
    add_square(ritz, across, m->across);
  }
  s->soft_parts = 0.0;
  for (int32_t i = 0; i < s->model->elements.count; i++)
    if (s->elements.element[i].acts) project_element(s, i, first, ritz);
  for (int32_t i = 0; i < s->model->contacts.count; i++) {
    for (size_t k = 0; k < count; k++) along[k] = contact_motion(s, i, first + k);
    if (s->touching[i]) add_square(ritz, along, s->terms.ground[i]);
  }
  for (int32_t i = 0; i < s->held_count; i++) {
    for (size_t k = 0; k < count; k++) along[k] = held_motion(s, i, first + k);
    add_square(ritz, along, s->held_by);
  }
}

/* Ritz values and vectors in place of the soft eigenvalues; false: out of memory. */
static bool refine(strut_path_system *s, size_t first, size_t count) {
  gsl_matrix *ritz = gsl_matrix_alloc(count, count), *turn = gsl_matrix_alloc(count, count);
  gsl_matrix *turned = gsl_matrix_alloc((size_t)s->n, count);
  gsl_vector *values = gsl_vector_alloc(count);
  gsl_eigen_symmv_workspace *eigen = gsl_eigen_symmv_alloc(count);
  bool made = ritz && turn && turned && values && eigen;
  if (made) {
    project(s, first, ritz);
    gsl_eigen_symmv(ritz, values, turn, eigen);
    gsl_eigen_symmv_sort(values, turn, GSL_EIGEN_SORT_VAL_ASC);
    gsl_matrix_view soft = gsl_matrix_submatrix(s->vectors, 0, first, (size_t)s->n, count);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1.0, &soft.matrix, turn, 0.0, turned);
    gsl_matrix_memcpy(&soft.matrix, turned);
    for (size_t k = 0; k < count; k++)
      gsl_vector_set(s->values, first + k, gsl_vector_get(values, k));
  }
  gsl_matrix_free(ritz);
  gsl_matrix_free(turn);
  gsl_matrix_free(turned);
  gsl_vector_free(values);
  gsl_eigen_symmv_free(eigen);
  return made;
}

/* The largest stiffness that tension lends: what a soft eigenvalue is a difference of. */
static double largest_across(const strut_path_system *s) {
  double most = 0;
  for (int32_t j = 0; j < s->model->members.count; j++)
    if (s->member[j].pulls) most = fmax(most, fabs(s->member[j].across));
  return most;
}

static void find_vectors(strut_path_system *s) {
  gsl_matrix_memcpy(s->work, s->hessian);
  gsl_eigen_symmv(s->work, s->values, s->vectors, s->eigen);
  gsl_eigen_symmv_sort(s->values, s->vectors, GSL_EIGEN_SORT_VAL_ASC);
}

/* The soft eigenvalues are contiguous: index of the first and their number, nearest to zero. */
static size_t find_soft(const strut_path_system *s, double below, size_t *first) {
  size_t count = 0, nearest = 0;
  for (size_t i = 1; i < (size_t)s->n; i++)
    if (fabs(gsl_vector_get(s->values, i)) < fabs(gsl_vector_get(s->values, nearest))) nearest = i;
  *first = nearest;
  if (fabs(gsl_vector_get(s->values, nearest)) > below) return 0;
  while (*first > 0 && nearest - *first < MOST_SOFT / 2 &&
         fabs(gsl_vector_get(s->values, *first - 1)) <= below)
    --*first;
  while (*first + count < (size_t)s->n && count < MOST_SOFT &&
         fabs(gsl_vector_get(s->values, *first + count)) <= below)
    count++;
  return count;
}

bool strut_path_spectrum(strut_path_system *s, const double *y, strut_path_spectrum_detail wanted) {
  size_t first;
  if (!strut_path_evaluate(s, y)) return false;
  s->negative = 0;
  if (s->n == 0) return true;
  if (wanted == STRUT_PATH_VECTORS) {
    find_vectors(s);
  } else {
    gsl_matrix_memcpy(s->work, s->hessian);
    gsl_eigen_symm(s->work, s->values, s->values_only);
    gsl_sort_vector(s->values);
  }
  double largest =
      fmax(fabs(gsl_vector_get(s->values, 0)), fabs(gsl_vector_get(s->values, (size_t)s->n - 1)));
  double below = (wanted == STRUT_PATH_SIGNS ? UNSIGNED : SOFT) * largest;
  size_t soft = find_soft(s, below, &first);
  if (soft && wanted != STRUT_PATH_VECTORS) {
    find_vectors(s);
    soft = find_soft(s, below, &first);
  }
  if (soft && !refine(s, first, soft)) return false;
  double parts = fmax(largest_across(s), soft ? s->soft_parts : 0.0);
  double zero = fmax(ZERO_VALUE * parts, NO_VALUE * largest);
  s->noise = ROUNDING * largest;
  for (size_t i = 0; i < (size_t)s->n; i++) {
    bool is_soft = i >= first && i < first + soft;
    if (gsl_vector_get(s->values, i) < (is_soft ? -zero : 0.0)) s->negative++;
  }
  return true;
}
