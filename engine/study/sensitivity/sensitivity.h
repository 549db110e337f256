/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Sensitivity indices of one result from the points of Saltelli's design, with standard errors.
 *
 * First order: Saltelli et al., Computer Physics Communications 181 (2010) 259, (b) of table 2; total:
 * Jansen's, (f) there. Errors by the bootstrap over base samples.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/derivatives.h"
#include "engine/base/memory.h"
#include "engine/scene/study.h"
#include "engine/scene/value_rows.h"
#include "engine/study/results/slots.h"

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

/* The sensitivity analysis of a study, from the rows of its points: see scene/sensitivity_design.h.
 *
 * A result is a column of numbers; whether such a column is above 0, or above,
 * within or below a threshold; or whether a column of texts has a
 * certain one. Each is described at every point of the study's other axes.
 */

/** X(NAME, word), in the order of the rows of a result. */
#define STRUT_SENSITIVITY_MEASURES(X)                                                              \
  X(MEAN, "mean")               /* of the samples; the error is that of the mean */                \
  X(DEVIATION, "deviation")     /* standard deviation of the samples */                            \
  X(SHARE, "share")             /* of the samples for which it is so, with Wilson's interval */    \
  X(DERIVATIVE, "derivative")   /* by a parameter, at the medians */                               \
  X(ELASTICITY, "elasticity")   /* the derivative times parameter over result, at the medians */   \
  X(FIRST_ORDER, "first_order") /* part of the variance owed to the parameter alone */             \
  X(TOTAL, "total")             /* the same with all that it does together with others */

typedef enum strut_sensitivity_measure {
#define STRUT_SENSITIVITY_ENUM(name, word) STRUT_SENSITIVITY_##name,
  STRUT_SENSITIVITY_MEASURES(STRUT_SENSITIVITY_ENUM) STRUT_SENSITIVITY_MEASURE_COUNT
} strut_sensitivity_measure;

typedef struct strut_sensitivity_row {
  int64_t point;  /* the study's first point with the same values of the other axes */
  const char *of; /* "velocity", "velocity > 0", "outcome = I" */
  strut_sensitivity_measure measure;
  const char *parameter; /* NULL: of all together */
  const char *unit;      /* "1": none */
  strut_estimate estimate;
  size_t used;         /* base samples, samples or points that it is made of */
  const char *verdict; /* of a derivative, "differentiable", ...; else NULL */
} strut_sensitivity_row;

typedef struct strut_sensitivity_result {
  const strut_study *study;
  strut_slots *slots;
  size_t count;
  strut_sensitivity_row *rows; /* (count) point after point */
  strut_arena arena;
} strut_sensitivity_result;

/** The list "effects" of a strut_sensitivity_result, while its study and slots are there. */
STRUT_API extern const strut_value_rows strut_sensitivity_values;

/**
 * All rows, from a file of all points. What failed counts as missing. Release the arena, after a
 * failure too. STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_sensitivity_find(const strut_study *study, strut_slots *slots,
                                              strut_sensitivity_result *result, strut_error *error);
/**
 * Writes directory/sensitivity.csv: the other axes, of, measure, parameter, value, error, low, high, unit,
 * used, verdict.
 */
STRUT_API strut_status strut_sensitivity_write(const strut_sensitivity_result *result,
                                               const char *directory, strut_error *error);
