/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Hot: the inverse of the mass matrix applied once per force evaluation. See mass.h. */
#pragma once

#include "engine/model/algebra/hot.h"
#include "engine/model/mass.h"
#include "engine/model/model.h"

/* x and y of one dense block of n nodes together: they have the same inverse. */
STRUT_INLINE void mass_block_pair(int32_t n, const double *restrict inverse,
                                  const uint32_t *restrict at, const double *restrict f,
                                  double *restrict a) {
  strut_pair x[STRUT_DENSE_BLOCK];
  for (int32_t j = 0; j < n; j++) x[j] = strut_pair_load(f + at[j]);
  for (int32_t i = 0; i < n; i++) {
    strut_pair sum = inverse[i * n] * x[0];
    for (int32_t j = 1; j < n; j++) sum += inverse[i * n + j] * x[j];
    strut_pair_store(a + at[i], sum);
  }
}

/* One coordinate of a block; f and a point at that coordinate of node 0. */
STRUT_INLINE void mass_block_single(int32_t n, const double *restrict inverse,
                                    const uint32_t *restrict at, const double *restrict f,
                                    double *restrict a) {
  for (int32_t i = 0; i < n; i++) {
    double sum = inverse[i * n] * f[at[0]];
    for (int32_t j = 1; j < n; j++) sum += inverse[i * n + j] * f[at[j]];
    a[at[i]] = sum;
  }
}

STRUT_INLINE void mass_blocks(const strut_mass_operator *op, bool pair, const double *restrict f,
                              double *restrict a) {
  const uint32_t *restrict at = op->block_at;
  const double *restrict inverse = op->block_inverse;
  const int32_t *restrict size = op->block_size;
  for (int32_t b = 0, count = op->block_count; b < count; b++) {
    int32_t n = size[b];
    if (!pair) {
      mass_block_single(n, inverse, at, f, a);
    } else if (n == 2) {
      mass_block_pair(2, inverse, at, f, a);
    } else if (n == 3) {
      mass_block_pair(3, inverse, at, f, a);
    } else {
      mass_block_pair(n, inverse, at, f, a);
    }
    at += n;
    inverse += n * n;
  }
}

/* a = M^-1 f; work: scratch. All (length). */
STRUT_LOOP void mass_kernel(const strut_model *model, const double *restrict f, double *restrict a,
                            double *restrict work) {
  const strut_mass *mass = model->mass;
  const double *restrict inverse = mass->inverse;
  for (int32_t i = 0; i < model->length && mass->any_single; i += STRUT_LANES)
    strut_lanes_store(a + i, strut_lanes_load_pairs(f + i) * strut_lanes_load(inverse + i));
  if (mass->diagonal) return;
  if (mass->shared) {
    mass_blocks(&mass->coordinate[0], true, f, a);
    if (mass->coordinate[0].factor) strut_mass_factor_pair(&mass->coordinate[0], f, a, work);
    return;
  }
  for (int c = 0; c < 2; c++) {
    mass_blocks(&mass->coordinate[c], false, f + c, a + c);
    if (mass->coordinate[c].factor)
      strut_mass_factor_single(&mass->coordinate[c], f + c, a + c, work);
  }
}
