/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Evaluates the postfix program of a measured quantity; see engine/scene/quantity.h.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_QUANTITY_PROGRAM_H
#define STRUT_ENGINE_RUN_MEASURE_QUANTITY_PROGRAM_H

#include "engine/base/export.h"
#include "engine/scene/quantity.h"

/** Evaluates a program; `index` (length): position of each column in `value`. */
STRUT_API double strut_quantity_program_evaluate(const strut_quantity_definition *definition,
                                                 const size_t *index, const double *value,
                                                 double *stack);

/** Size of a term, and two uncertainties that propagate alike. */
typedef struct strut_magnitude {
  double size;  /* largest absolute value of the terms */
  double span;  /* range */
  double noise; /* rounding error */
} strut_magnitude;

/** Evaluates the program on magnitudes: sums take the larger size and add range and rounding. */
strut_magnitude strut_quantity_program_magnitude(const strut_quantity_definition *definition,
                                                 const size_t *index, const strut_magnitude *value,
                                                 strut_magnitude *stack);

#endif
