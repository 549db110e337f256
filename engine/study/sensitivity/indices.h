/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Sensitivity indices of one result from the points of Saltelli's design, with standard errors.
 *
 * First order: Saltelli et al., Computer Physics Communications 181 (2010) 259, (b) of table 2; total:
 * Jansen's, (f) there. Errors by the bootstrap over base samples.
 */
#ifndef STRUT_ENGINE_STUDY_SENSITIVITY_INDICES_H
#define STRUT_ENGINE_STUDY_SENSITIVITY_INDICES_H

#include <stddef.h>
#include <stdint.h>

#include "engine/base/export.h"
#include "engine/base/status.h"

/** A number and how well it is known. */
typedef struct strut_estimate {
  double value;     /* NAN: missing */
  double error;     /* standard error; NAN: unknown */
  double low, high; /* 95 % interval; NAN: unknown */
} strut_estimate;

/**
 * result (samples, count + 2): f at A, at A with parameter k of B, at B; NAN: missing, and then the whole
 * base sample is left out. first, total (count); missing where the result does not vary. *used: base
 * samples. STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_sensitivity_indices(const double *result, size_t samples, size_t count,
                                                 uint32_t seed, strut_estimate *first,
                                                 strut_estimate *total, size_t *used);

/** Mean of values (count), and its standard error as of independent ones; NANs are left out. */
STRUT_API strut_estimate strut_sensitivity_mean(const double *values, size_t count);
/** Standard deviation of the values themselves; NANs are left out. */
STRUT_API double strut_sensitivity_deviation(const double *values, size_t count);
/** Share of ones among values (count) that are 0 or 1, with Wilson's interval; NANs are left out. */
STRUT_API strut_estimate strut_sensitivity_share(const double *values, size_t count);

/**
 * Derivative from results at a step up and down, and at half a step up and down, whose parameters differ
 * by width and half_width. The value is that of half the step; the error the larger of the difference of
 * both, which curvature and kinks cause, and of what `noise`, the error of each result, causes.
 */
STRUT_API strut_estimate strut_sensitivity_derivative(const double result[4], double width,
                                                      double half_width, double noise);

#endif
