/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/symmetric.h"

#include <gsl/gsl_eigen.h>
#include <math.h>

/* One sign of two, so that results do not depend on the way there. */
static void turn(double *vector, size_t n) {
  size_t largest = 0;
  for (size_t i = 1; i < n; i++)
    if (fabs(vector[i]) > 1.000001 * fabs(vector[largest])) largest = i;
  if (vector[largest] >= 0) return;
  for (size_t i = 0; i < n; i++) vector[i] = -vector[i];
}

bool strut_symmetric_eigen(double *matrix, size_t n, double *value, double *vector) {
  if (n == 0) return true;
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(n);
  if (!work) return false;
  gsl_matrix_view a = gsl_matrix_view_array(matrix, n, n);
  gsl_matrix_view v = gsl_matrix_view_array(vector, n, n);
  gsl_vector_view d = gsl_vector_view_array(value, n);
  bool good = gsl_eigen_symmv(&a.matrix, &d.vector, &v.matrix, work) == 0 &&
              gsl_eigen_symmv_sort(&d.vector, &v.matrix, GSL_EIGEN_SORT_VAL_ASC) == 0 &&
              gsl_matrix_transpose(&v.matrix) == 0;
  gsl_eigen_symmv_free(work);
  for (size_t i = 0; good && i < n; i++) turn(vector + i * n, n);
  return good;
}
