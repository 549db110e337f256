/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra/cholmod_factor.h"

#include <assert.h>
#include <cholmod.h>

struct strut_cholmod_factor {
  cholmod_common common;
  cholmod_factor *symbolic, *numeric; /* the latter NULL where there are no numbers */
};

static void start_cholmod(cholmod_common *common) {
  cholmod_start(common);
  common->supernodal = CHOLMOD_SIMPLICIAL;
  common->final_ll = 0;
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_AMD;
  common->postorder = 1;
  common->print = 0;
  common->error_handler = NULL;
}

/* A view of our matrix as CHOLMOD's; nothing is copied. */
static cholmod_sparse view(const strut_sparse *matrix) {
  cholmod_sparse result = {0};
  result.nrow = result.ncol = (size_t)matrix->n;
  result.nzmax = (size_t)matrix->start[matrix->n];
  result.p = matrix->start;
  result.i = matrix->row;
  result.x = matrix->value;
  result.stype = -1;
  result.itype = CHOLMOD_INT;
  result.xtype = CHOLMOD_REAL;
  result.dtype = CHOLMOD_DOUBLE;
  result.sorted = 1;
  result.packed = 1;
  return result;
}

static void free_factor(strut_cholmod_factor *factor) {
  if (!factor) return;
  cholmod_free_factor(&factor->numeric, &factor->common);
  cholmod_free_factor(&factor->symbolic, &factor->common);
  cholmod_finish(&factor->common);
  strut_release(factor);
}

static strut_cholmod_factor *analyse(const strut_sparse *pattern, double *nonzeros) {
  strut_cholmod_factor *factor = strut_allocate(1, sizeof *factor);
  if (!factor) return NULL;
  start_cholmod(&factor->common);
  cholmod_sparse a = view(pattern);
  factor->symbolic = cholmod_analyze(&a, &factor->common);
  *nonzeros = factor->common.lnz;
  if (factor->symbolic) return factor;
  free_factor(factor);
  return NULL;
}

static bool factorise(strut_cholmod_factor *factor, const strut_sparse *matrix,
                      strut_cholmod_columns *columns) {
  cholmod_common *common = &factor->common;
  cholmod_sparse a = view(matrix);
  double beta[2] = {0.0, 0.0};
  assert((size_t)matrix->n == factor->symbolic->n);
  cholmod_factor *self = factor->numeric = cholmod_copy_factor(factor->symbolic, common);
  if (!self || !cholmod_factorize_p(&a, beta, NULL, 0, self, common) ||
      common->status < CHOLMOD_OK || !cholmod_change_factor(CHOLMOD_REAL, 0, 0, 1, 1, self, common))
    return false;
  *columns = (strut_cholmod_columns){.n = (int32_t)self->n,
                                     .finished = (int32_t)self->minor,
                                     .order = self->Perm,
                                     .start = self->p,
                                     .row = self->i,
                                     .value = self->x};
  return true;
}

extern STRUT_API const strut_cholmod_library strut_cholmod_table;
const strut_cholmod_library strut_cholmod_table = {
    .stamp = STRUT_LIBRARY_STAMP(strut_cholmod_library),
    .analyse = analyse,
    .factorise = factorise,
    .free = free_factor,
};

strut_status strut_cholmod_load(const strut_cholmod_library **library, strut_error *error) {
  (void)error;
  *library = &strut_cholmod_table;
  return STRUT_OK;
}
