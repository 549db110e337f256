/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mass solve for whoever asks once; the step's own loop has mass_kernel.h. */
#include "engine/model/hot.h"
#include "engine/model/mass.h"
#include "engine/model/mass_kernel.h"

void strut_mass_solve(const strut_model *model, const double *restrict force,
                      double *restrict acceleration, double *restrict work) {
  mass_kernel(model, force, acceleration, work);
}

/* The sparse part of the mass solve, long enough to be called. See mass.h. */

void strut_mass_factor_pair(const strut_mass_operator *op, const double *restrict f,
                            double *restrict a, double *restrict work) {
  int32_t n = op->factor->n;
  for (int32_t i = 0; i < n; i++)
    strut_pair_store(work + 2 * i, strut_pair_load(f + 2 * op->factor_node[i]));
  strut_factor_solve_pair(op->factor, work);
  for (int32_t i = 0; i < n; i++)
    strut_pair_store(a + 2 * op->factor_node[i], strut_pair_load(work + 2 * i));
}

void strut_mass_factor_single(const strut_mass_operator *op, const double *restrict f,
                              double *restrict a, double *restrict work) {
  int32_t n = op->factor->n;
  for (int32_t i = 0; i < n; i++) work[i] = f[2 * op->factor_node[i]];
  strut_factor_solve(op->factor, work);
  for (int32_t i = 0; i < n; i++) a[2 * op->factor_node[i]] = work[i];
}
