/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/lu.h"

#include <math.h>

/* The row from j on with the largest entry in column j. */
static size_t find_pivot(const gsl_matrix *a, size_t j) {
  size_t pivot = j;
  for (size_t i = j + 1; i < a->size1; i++)
    if (fabs(gsl_matrix_get(a, i, j)) > fabs(gsl_matrix_get(a, pivot, j))) pivot = i;
  return pivot;
}

void strut_lu_factor(gsl_matrix *a, gsl_permutation *order) {
  gsl_permutation_init(order);
  for (size_t j = 0; j < a->size1; j++) {
    size_t pivot = find_pivot(a, j);
    if (pivot != j) {
      gsl_matrix_swap_rows(a, j, pivot);
      gsl_permutation_swap(order, j, pivot);
    }
    double diagonal = gsl_matrix_get(a, j, j);
    if (diagonal == 0.0) continue;
    for (size_t i = j + 1; i < a->size1; i++) {
      double factor = gsl_matrix_get(a, i, j) / diagonal;
      gsl_matrix_set(a, i, j, factor);
      for (size_t k = j + 1; k < a->size1 && factor != 0.0; k++)
        *gsl_matrix_ptr(a, i, k) -= factor * gsl_matrix_get(a, j, k);
    }
  }
}
