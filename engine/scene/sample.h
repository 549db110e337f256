/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Samples of several numbers at once, from distributions, in the unit cube by a low-discrepancy
 * sequence, by strata or at random; and the points of a sensitivity analysis. The same bits whenever and
 * wherever they are made.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/study.h"

/** Ways to fill the unit cube, in the order of the language. */
typedef enum strut_sample_scheme {
  STRUT_SAMPLE_SOBOL,  /* Sobol's sequence, shifted by the seed modulo 1 */
  STRUT_SAMPLE_LHS,    /* Latin hypercube: each number once in each of `count` strata */
  STRUT_SAMPLE_RANDOM, /* independent */
  STRUT_SAMPLE_SCHEME_COUNT
} strut_sample_scheme;

/** Distributions, in the order of the language, and their numbers. */
typedef enum strut_distribution_kind {
  STRUT_DISTRIBUTION_UNIFORM,     /* least, most */
  STRUT_DISTRIBUTION_LOG_UNIFORM, /* least, most, of one sign: the logarithm is uniform */
  STRUT_DISTRIBUTION_NORMAL,      /* mean, standard deviation */
  STRUT_DISTRIBUTION_LOGNORMAL,   /* median, standard deviation of the natural logarithm */
  STRUT_DISTRIBUTION_TRIANGULAR,  /* least, most likely, most */
  STRUT_DISTRIBUTION_COUNT
} strut_distribution_kind;

typedef struct strut_distribution {
  strut_distribution_kind kind;
  double number[3];
} strut_distribution;

enum { STRUT_SAMPLE_MOST_NUMBERS = 40, STRUT_SAMPLE_MOST_POINTS = 1000000 };

/** Why the numbers of a distribution are wrong, as the end of a sentence; NULL: they are right. */
STRUT_API const char *strut_distribution_flaw(const strut_distribution *distribution);
/** The value below which the share `u` lies, 0 < u < 1. */
STRUT_API double strut_distribution_value(const strut_distribution *distribution, double u);
/**
 * The lower triangle that makes numbers correlated, in place of their correlation (count, count). False: that is not
 * positive definite.
 */
STRUT_API bool strut_correlation_factor(size_t count, double *correlation);
/**
 * values[k] (count) from distribution k, k < number_count <= STRUT_SAMPLE_MOST_NUMBERS. factor (number_count,
 * number_count): what strut_correlation_factor has made, of the normal numbers behind the shares (a Gaussian copula);
 * NULL: independent. False: memory is out.
 */
STRUT_API bool strut_sample_make(strut_sample_scheme scheme, uint32_t seed, int64_t count,
                                 size_t number_count, const strut_distribution *distributions,
                                 const double *factor, double *const *values);

/* ---- sensitivity analyses ---- */

/** Most parameters: A and B are one sample. */
enum { STRUT_SENSITIVITY_MOST = STRUT_SAMPLE_MOST_NUMBERS / 2 };

/** Points of one analysis of `count` parameters. */
STRUT_API int64_t strut_sensitivity_points(const strut_study_sensitivity *sensitivity,
                                           size_t count);
/** First point of base sample `j`: A; then the mixed points in the order of parameters; then B. */
STRUT_API int64_t strut_sensitivity_sample(const strut_study_sensitivity *sensitivity, size_t count,
                                           int64_t j);
/**
 * values[i] (strut_sensitivity_points) from distribution i; with derivatives point 0 has the medians. False: memory is
 * out.
 */
STRUT_API bool strut_sensitivity_fill(const strut_study_sensitivity *sensitivity, size_t count,
                                      const strut_distribution *distributions,
                                      double *const *values);
