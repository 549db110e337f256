/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Dense matrices by GSL: what sparse ones are compared with. */
#pragma once

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_sort_vector.h>

#include "engine/model/algebra/linear_solver.h"
#include "tests/support/test.h"

FREED_BY(gsl_matrix_free, gsl_matrix)
FREED_BY(gsl_vector_free, gsl_vector)

/** All entries of a symmetric matrix, with `shift` added to its diagonal. */
static inline gsl_matrix *dense_of(const strut_sparse *m, double shift) {
  gsl_matrix *a = gsl_matrix_calloc((size_t)m->n, (size_t)m->n);
  for (int32_t j = 0; j < m->n; j++)
    for (int32_t k = m->start[j]; k < m->start[j + 1]; k++) {
      size_t i = (size_t)m->row[k], c = (size_t)j;
      double value = m->value[k] + (i == c ? shift : 0);
      gsl_matrix_set(a, i, c, value), gsl_matrix_set(a, c, i, value);
    }
  return a;
}

/** Eigenvalues of K x = value M x in ascending order, M the identity where it is NULL; both are destroyed. */
static inline gsl_vector *dense_eigenvalues(gsl_matrix *k, gsl_matrix *m) {
  gsl_vector *values = gsl_vector_alloc(k->size1);
  gsl_eigen_symm_workspace *plain = m ? NULL : gsl_eigen_symm_alloc(k->size1);
  gsl_eigen_gensymm_workspace *pair = m ? gsl_eigen_gensymm_alloc(k->size1) : NULL;
  assert_int_equal(m ? gsl_eigen_gensymm(k, m, values, pair) : gsl_eigen_symm(k, values, plain), 0);
  if (plain) gsl_eigen_symm_free(plain);
  if (pair) gsl_eigen_gensymm_free(pair);
  gsl_sort_vector(values);
  return values;
}
