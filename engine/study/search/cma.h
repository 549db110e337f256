/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Minimisation by CMA-ES, the evolution strategy with covariance matrix adaptation (N. Hansen, The CMA
 * evolution strategy: a tutorial, arXiv 1604.00772), with negative weights, asked for a generation and
 * told its values.
 *
 * Points lie in the unit box. Bounds: the strategy lives in all of space; a number beyond the box is
 * mirrored into it, and next to each bound the map is a parabola, so that a minimum on a bound is a
 * smooth one for the strategy. A number that wraps is taken modulo 1 instead. Values only have to be
 * comparable; one that is not finite is worst.
 *
 * The same options and values give the same points, bit by bit, so that a search is resumed by telling
 * it the values that are known.
 */
#ifndef STRUT_ENGINE_STUDY_SEARCH_CMA_H
#define STRUT_ENGINE_STUDY_SEARCH_CMA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/export.h"
#include "engine/base/status.h"

typedef struct strut_cma strut_cma;

enum { STRUT_CMA_MOST_NUMBERS = 200, STRUT_CMA_MOST_POPULATION = 100000 };

/** Reasons to stop. */
typedef enum strut_cma_stop {
  STRUT_CMA_GOES_ON,
  STRUT_CMA_EVALUATIONS, /* the evaluations are used up */
  STRUT_CMA_TARGET,      /* the target is reached */
  STRUT_CMA_POINT,       /* the search distribution is narrower than point_tolerance */
  STRUT_CMA_FLAT,        /* values of generations differ by no more than value_tolerance */
  STRUT_CMA_STAGNANT,    /* the best values of many generations have not improved */
  STRUT_CMA_CONDITION    /* the distribution's axes differ too much to go on (1e7) */
} strut_cma_stop;

/** Zero means the default of a number. */
typedef struct strut_cma_options {
  size_t dimension;       /* of points, 1 to STRUT_CMA_MOST_NUMBERS */
  const double *start;    /* (dimension) in the box; NULL: its middle */
  double spread;          /* standard deviation at the start, in widths of the box; 0: 0.3 */
  size_t population;      /* points of a generation; 0: 4 + floor(3 ln dimension) */
  size_t multiple;        /* raises the population to a multiple of this; 0: 1 */
  uint32_t seed;          /* of the Mersenne twister */
  int64_t evaluations;    /* the most; the last generation may exceed them; 0: no limit */
  double target;          /* used if has_target */
  int has_target;         /* a value <= target ends the search */
  double point_tolerance; /* in widths of the box; 0: 1e-9 */
  double value_tolerance; /* in the values' unit; 0: none but equal values */
  const bool *wraps;      /* (dimension) numbers whose 0 and 1 are the same; NULL: none */
} strut_cma_options;

/** STRUT_USAGE for options out of range, STRUT_NO_MEMORY. Release with strut_cma_free. */
STRUT_API strut_status strut_cma_create(const strut_cma_options *options, strut_cma **cma,
                                        strut_error *error);
STRUT_API void strut_cma_free(strut_cma *cma);

/** Points of each generation. */
STRUT_API size_t strut_cma_population(const strut_cma *cma);
/**
 * The points of the generation, (population, dimension), each number in [0, 1]: the same until their
 * values are told. Owned by the search.
 */
STRUT_API const double *strut_cma_ask(strut_cma *cma);
/** values (population), in the order of the points; the smaller the better. */
STRUT_API void strut_cma_tell(strut_cma *cma, const double *values);
STRUT_API strut_cma_stop strut_cma_stopped(const strut_cma *cma);
/** A sentence's end: why it stopped. */
STRUT_API const char *strut_cma_stop_text(strut_cma_stop stop);

/** The best point told so far (dimension) and its value; NULL and NAN before any was finite. */
STRUT_API const double *strut_cma_best(const strut_cma *cma, double *value);
STRUT_API int64_t strut_cma_evaluations(const strut_cma *cma);
/** Standard deviation of the k-th number in the next generation, in widths of the box. */
STRUT_API double strut_cma_deviation(const strut_cma *cma, size_t k);

#endif
