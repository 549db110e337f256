/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mass solve for whoever asks once; the step's own loop has mass_kernel.h. */
#include "engine/model/mass_kernel.h"

void strut_mass_solve(const strut_model *model, const double *restrict force,
                      double *restrict acceleration, double *restrict work) {
  mass_kernel(model, force, acceleration, work);
}
