/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

#include <gsl/gsl_sort_vector.h>
#include <math.h>
#include <string.h>

/*
 * Eigenvalues of the stiffness. The dense method is good to the last bit of the largest eigenvalue:
 * with a bar of 1e11 N/m a soft one of 100 N/m would have seven digits left, and its sign at a
 * bifurcation none. So the soft ones are computed once more, as Ritz values of the soft
 * eigenvectors, from the members one by one: a motion that does not stretch a stiff bar then meets
 * none of its stiffness.
 */

enum { MOST_SOFT = 40 };

static const double SOFT = 1e-6;        /* of the largest eigenvalue: few digits are left */
static const double UNSIGNED = 1e-12;   /* likewise: not even the sign is sure */
static const double ZERO_VALUE = 1e-13; /* of a soft mode's largest parts: no sign below this */
static const double NO_VALUE = 1e-20;   /* of the largest eigenvalue, likewise */
static const double ROUNDING = 2e-16;   /* of a double */

static double held_motion(const strut_path_system *system, int32_t k, size_t mode) {
  double sum = 0;
  for (int32_t i = 0; i < system->n; i++)
    sum += system->held.motion[k][i] * gsl_matrix_get(system->algebra.vectors, (size_t)i, mode);
  return sum;
}

/* The stiffness seen by the modes first, first + 1, ... */
static void project(strut_path_system *system, size_t first, size_t count, double *sum) {
  double noise[MOST_SOFT] = {0}, along[MOST_SOFT], across[MOST_SOFT];
  memset(sum, 0, count * count * sizeof *sum);
  strut_mode_form form = {.model = system->model,
                          .row_of = system->potential->row_of,
                          .count = (int32_t)count,
                          .vector = gsl_matrix_ptr(system->algebra.vectors, 0, first),
                          .mode_step = 1,
                          .row_step = system->algebra.vectors->tda,
                          .sum = sum,
                          .noise = noise,
                          .along = along,
                          .across = across};
  for (int32_t i = 0; i < strut_force_count(system->model, true); i++)
    if (system->force[i].pose.acts) strut_mode_form_add(&form, &system->force[i], system->latest.q);
  for (int32_t i = 0; i < system->held.count; i++) {
    for (size_t k = 0; k < count; k++) along[k] = held_motion(system, i, first + k);
    for (size_t k = 0; k < count; k++)
      for (size_t l = 0; l <= k; l++) sum[k * count + l] += system->held.by * along[k] * along[l];
  }
  for (size_t k = 0; k < count; k++)
    for (size_t l = 0; l < k; l++) sum[l * count + k] = sum[k * count + l];
  system->spectrum.soft_parts = form.part;
}

/* Ritz values and vectors in place of the soft eigenvalues; false: out of memory. */
static bool refine(strut_path_system *system, size_t first, size_t count) {
  double form[MOST_SOFT * MOST_SOFT], turn[MOST_SOFT * MOST_SOFT], row[MOST_SOFT];
  project(system, first, count, form);
  if (!strut_symmetric_eigen(form, count, row, turn)) return false;
  for (size_t k = 0; k < count; k++) system->spectrum.value[first + k] = row[k];
  for (size_t i = 0; i < (size_t)system->n; i++) {
    double *soft = gsl_matrix_ptr(system->algebra.vectors, i, first);
    memcpy(row, soft, count * sizeof *row);
    for (size_t k = 0; k < count; k++) soft[k] = strut_dot(turn + k * count, row, (ptrdiff_t)count);
  }
  return true;
}

/* The largest stiffness that tension lends: what a soft eigenvalue is a difference of. */
static double largest_across(const strut_path_system *system) {
  double most = 0;
  for (int32_t j = 0; j < system->model->members.count; j++)
    if (system->force[j].pose.acts) most = fmax(most, fabs(system->force[j].across));
  return most;
}

static void find_vectors(strut_path_system *system) {
  gsl_matrix_memcpy(system->algebra.work, system->algebra.hessian);
  gsl_eigen_symmv(system->algebra.work, system->algebra.values, system->algebra.vectors,
                  system->algebra.eigen);
  gsl_eigen_symmv_sort(system->algebra.values, system->algebra.vectors, GSL_EIGEN_SORT_VAL_ASC);
}

/* The soft eigenvalues are contiguous: index of the first and their number, nearest to zero. */
static size_t find_soft(const strut_path_system *system, double below, size_t *first) {
  size_t count = 0, nearest = 0;
  for (size_t i = 1; i < (size_t)system->n; i++)
    if (fabs(system->spectrum.value[i]) < fabs(system->spectrum.value[nearest])) nearest = i;
  *first = nearest;
  if (fabs(system->spectrum.value[nearest]) > below) return 0;
  while (*first > 0 && nearest - *first < MOST_SOFT / 2 &&
         fabs(system->spectrum.value[*first - 1]) <= below)
    --*first;
  while (*first + count < (size_t)system->n && count < MOST_SOFT &&
         fabs(system->spectrum.value[*first + count]) <= below)
    count++;
  return count;
}

/* Where a contact slides: eigenvalues by their real parts, which are those that pass through zero. */
static bool find_unsymmetric(strut_path_system *system) {
  size_t n = (size_t)system->n;
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(n, n);
  gsl_eigen_nonsymmv_workspace *eigen = gsl_eigen_nonsymmv_alloc(n);
  gsl_permutation *order = gsl_permutation_alloc(n);
  bool found = values && vectors && eigen && order;
  gsl_matrix_memcpy(system->algebra.work, system->algebra.hessian);
  found = found && gsl_eigen_nonsymmv(system->algebra.work, values, vectors, eigen) == 0;
  if (found) {
    const gsl_vector_view real = gsl_vector_complex_real(values);
    gsl_sort_vector_index(order, &real.vector);
    for (size_t k = 0; k < n; k++) {
      size_t from = gsl_permutation_get(order, k);
      gsl_vector_complex_view column = gsl_matrix_complex_column(vectors, from);
      const gsl_vector_view vector = gsl_vector_complex_real(&column.vector);
      system->spectrum.value[k] = gsl_vector_get(&real.vector, from);
      gsl_matrix_set_col(system->algebra.vectors, k, &vector.vector);
    }
    double largest = fmax(fabs(system->spectrum.value[0]), fabs(system->spectrum.value[n - 1]));
    system->spectrum.noise = ROUNDING * largest;
    for (size_t k = 0; k < n; k++)
      system->spectrum.negative += system->spectrum.value[k] < -system->spectrum.noise;
  }
  gsl_vector_complex_free(values);
  gsl_matrix_complex_free(vectors);
  gsl_eigen_nonsymmv_free(eigen);
  gsl_permutation_free(order);
  return found;
}

bool strut_path_spectrum(strut_path_system *system, const double *unknowns,
                         strut_path_spectrum_detail wanted) {
  size_t first;
  if (!strut_path_evaluate(system, unknowns)) return false;
  system->spectrum.negative = system->spectrum.folded = strut_path_count_folded(system);
  if (system->n == 0) return true;
  if (strut_path_slides(system) || strut_path_has_rubbing(system)) return find_unsymmetric(system);
  if (wanted == STRUT_PATH_VECTORS) {
    find_vectors(system);
  } else {
    gsl_matrix_memcpy(system->algebra.work, system->algebra.hessian);
    gsl_eigen_symm(system->algebra.work, system->algebra.values, system->algebra.values_only);
    gsl_sort_vector(system->algebra.values);
  }
  double largest =
      fmax(fabs(system->spectrum.value[0]), fabs(system->spectrum.value[system->n - 1]));
  double below = (wanted == STRUT_PATH_SIGNS ? UNSIGNED : SOFT) * largest;
  size_t soft = find_soft(system, below, &first);
  if (soft && wanted != STRUT_PATH_VECTORS) {
    find_vectors(system);
    soft = find_soft(system, below, &first);
  }
  if (soft && !refine(system, first, soft)) return false;
  double parts = fmax(largest_across(system), soft ? system->spectrum.soft_parts : 0.0);
  double zero = fmax(ZERO_VALUE * parts, NO_VALUE * largest);
  system->spectrum.noise = ROUNDING * largest;
  for (size_t i = 0; i < (size_t)system->n; i++) {
    bool is_soft = i >= first && i < first + soft;
    if (system->spectrum.value[i] < (is_soft ? -zero : 0.0)) system->spectrum.negative++;
  }
  return true;
}
