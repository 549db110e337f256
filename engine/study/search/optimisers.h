/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What searches a study's variables: the unit box they live in, the optimisers' interface. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
  const int64_t *counts; /* (dimension) values of variables, whose grid is searched; or NULL */
  int64_t evaluations;   /* roughly how many will be answered */
  uint32_t seed;
} strut_search_task;

/** Does the method know conditions? Else broken ones have to make the values worse. */
bool strut_search_knows_conditions(strut_search_method method);
/** Does it ask for many points at once, a generation? Else for one after another. */
bool strut_search_has_generations(strut_search_method method);
/** Runs to the end. To be called in a thread of its own: random numbers are the thread's. False: no memory. */
STRUT_API bool strut_search_optimise(const strut_search_task *task,
                                     const strut_search_asker *asker);
/** CMA-ES, by generations of `population`; spread: the standard deviation at the start, in widths of the box. */
STRUT_API bool strut_search_optimise_by_cma(const strut_search_task *task,
                                            const strut_search_asker *asker, size_t population,
                                            double spread);
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
/** The start of a task, then such points: (count, dimension). */
void strut_search_spread_points(const strut_search_task *task, size_t count, double *points);

/** The same of methods of NLopt, in nlopt_optimiser.c. */
bool strut_search_optimise_by_nlopt(const strut_search_task *task, const strut_search_asker *asker);
