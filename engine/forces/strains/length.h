/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Strain `length`: the distance of two nodes [m]. */
#ifndef STRUT_ENGINE_FORCES_STRAINS_LENGTH_H
#define STRUT_ENGINE_FORCES_STRAINS_LENGTH_H

#include "engine/forces/strains/path.h"

static inline double strut_strain_length(const uint32_t *at, int n, const double *q,
                                         double reference, double *b) {
  (void)n;
  return strut_strain_path(at, 2, q, reference, b);
}

static inline void strut_strain_length_bend(const uint32_t *at, int n, const double *q, double t,
                                            double *h) {
  (void)n;
  strut_strain_path_bend(at, 2, q, t, h);
}

#endif
