/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What searches a study's variables: the unit box they live in, the optimisers' interface, CMA-ES.
 */
#ifndef STRUT_ENGINE_STUDY_SEARCH_OPTIMISERS_H
#define STRUT_ENGINE_STUDY_SEARCH_OPTIMISERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"
#include "engine/scene/study.h"

/* Between the values of a search's variables and points of the unit box. */

/**
 * The value of a variable at a number of the box; numbers beyond it are brought in first. Values are rounded
 * to 15 digits. Whole numbers and choices have equal parts of the box each.
 */
strut_study_value strut_search_value(const strut_search_variable *variable, double number);
/** A number of the box that has this value. */
double strut_search_number(const strut_search_variable *variable, strut_study_value value);
/** Where the first search begins. */
double strut_search_start(const strut_search_variable *variable);
/** Do both have the same bits, or the same text? */
bool strut_search_same(strut_study_value a, strut_study_value b);
/** How many different values there are; 0: a continuum. */
int64_t strut_search_count(const strut_search_variable *variable);
/** Is it the lower (-1) or upper (1) bound of a range? 0: neither. */
int strut_search_bound(const strut_search_variable *variable, strut_study_value value);

/* Optimisers in the unit box, by the word of the language.
 *
 * An optimiser asks for the values of points and decides by them where to ask next. It keeps no best point
 * for its caller, and it ends when it is asked to stop or cannot continue. The same options and answers
 * give the same questions.
 */

/** Answers an optimiser. */
typedef struct strut_search_asker {
  void *context;
  /**
   * The values of `count` points (count, dimension), the smaller the better and all of them finite, two of
   * each point (count, 2) where the method is for two goals, and each with its derivatives by the numbers of the
   * point (count, 1 + dimension) where it follows them, NAN: there is none; and of each point how far it breaks each condition (count, conditions): at most 0 where it holds. False: the
   * optimiser must end.
   */
  bool (*ask)(void *context, size_t count, const double *points, double *values, double *broken);
} strut_search_asker;

typedef struct strut_search_task {
  strut_search_method method;
  size_t dimension, conditions; /* conditions: 0 where the values account for them */
  const double *start;          /* (dimension) in the box */
  const bool *wraps;            /* (dimension) numbers that may leave the box, modulo 1 */
  int64_t evaluations;          /* roughly how many will be answered */
  uint32_t seed;
} strut_search_task;

/** Does the method know conditions? Else broken ones have to make the values worse. */
bool strut_search_knows_conditions(strut_search_method method);
/** Does it ask for many points at once, a generation? Else for one after another. */
bool strut_search_has_generations(strut_search_method method);
/** Runs to the end. To be called in a thread of its own: random numbers are the thread's. False: no memory. */
bool strut_search_optimise(const strut_search_task *task, const strut_search_asker *asker);
bool strut_search_optimise_by_nsga2(const strut_search_task *task, const strut_search_asker *asker);

/** The next number in (0, 1) after a state, which begins as a seed: splitmix64. */
double strut_search_share(uint64_t *state);

/** Points spread evenly over the box: the additive sequence of the generalised golden ratio. */
typedef struct strut_search_spread {
  double golden;
  uint64_t seed; /* shifts the sequence */
} strut_search_spread;
strut_search_spread strut_search_spread_begin(size_t dimension, uint64_t seed);
/** The k-th number of the i-th point, which is the same in any order. */
double strut_search_spread_at(const strut_search_spread *spread, int64_t i, size_t k);

/** The same of methods of NLopt, in nlopt_optimiser.c. */
bool strut_search_optimise_by_nlopt(const strut_search_task *task, const strut_search_asker *asker);

/* Minimisation by CMA-ES, the evolution strategy with covariance matrix adaptation (N. Hansen, The CMA
 * evolution strategy: a tutorial, arXiv 1604.00772), with negative weights, asked for a generation and
 * given its values.
 *
 * Points lie in the unit box. Bounds: the strategy lives in all of space; a number beyond the box is
 * mirrored into it, and next to each bound the map is a parabola, so that a minimum on a bound is a
 * smooth one for the strategy. A number that wraps is taken modulo 1 instead. Values only have to be
 * comparable; one that is not finite is worst.
 *
 * The same options and values give the same points, bit by bit, so that a search is resumed by telling
 * it the values that are known.
 */

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
 * values are given. Owned by the search.
 */
STRUT_API const double *strut_cma_ask(strut_cma *cma);
/** values (population), in the order of the points; the smaller the better. */
STRUT_API void strut_cma_tell(strut_cma *cma, const double *values);
STRUT_API strut_cma_stop strut_cma_stopped(const strut_cma *cma);

/** The best point given so far (dimension) and its value; NULL and NAN before any was finite. */
STRUT_API const double *strut_cma_best(const strut_cma *cma, double *value);
STRUT_API int64_t strut_cma_evaluations(const strut_cma *cma);
/** Standard deviation of the k-th number in the next generation, in widths of the box. */
STRUT_API double strut_cma_deviation(const strut_cma *cma, size_t k);

#endif
