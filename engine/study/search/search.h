/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a row of the table is worth to a search: its goal, and by how much conditions are broken.
 */
#pragma once

#include "engine/study/sweep/sweep.h"

/**
 * Adds the columns `objective`, `objective_2` where there are two goals, and `violation` to the plan of a
 * study that searches, behind all others.
 */
strut_status strut_search_add_columns(strut_sweep_plan *plan, strut_error *error);
/**
 * The goal of a row of a point that did not fail; NAN where it has no value. *second: the same of the second
 * goal, 0 where there is one. broken (condition_count)
 * receives how far each condition is broken, relative to its right side where that is not 0, at most 0 where
 * it holds; of words 1 and 0. What has no value counts as 1. The row needs the columns before those.
 */
double strut_search_score(const strut_sweep_plan *plan, const double *numbers,
                          const char (*words)[STRUT_SLOT_WORD], double *second, double *broken);
/** The largest of `broken`, at least 0. */
double strut_search_violation(const strut_study_search *search, const double *broken);

/* A study that searches: optimisers choose its points, whose rows are kept like those of any study.
 *
 * A search that is run again asks for the same points; what is in the file of slots already answers it, so
 * that an interrupted search is resumed by repeating it. Every search is a sequence of its own: the rows do
 * not depend on how many run side by side.
 */

/** An evaluated point of the searched parameters, all scenarios together. */
typedef struct strut_search_point {
  int64_t evaluation;              /* its place on the axis of evaluations; -1: there is none */
  int64_t worst;                   /* point of the study: its worst scenario */
  double objective;                /* there, as maximised or minimised; NAN: failed */
  double second;                   /* likewise of the second goal, in its worst scenario; 0: none */
  double violation;                /* the largest of all scenarios */
  bool failed, valueless;          /* some scenario failed; has no goal */
  const strut_study_value *values; /* (variable_count) */
} strut_search_point;

/** How a search ended. */
typedef enum strut_search_end {
  STRUT_SEARCH_USED_UP,   /* all evaluations were computed */
  STRUT_SEARCH_CONVERGED, /* the method saw no way to go on */
  STRUT_SEARCH_REPEATS,   /* it asked for known points again and again */
  STRUT_SEARCH_ENUMERATED /* there are no other points */
} strut_search_end;

enum { STRUT_SEARCH_LATEST = 10 };

/** An evaluation of a search. */
typedef struct strut_search_step {
  int64_t worst; /* point of the study */
  double best;   /* the best objective of feasible points up to here; NAN: none */
} strut_search_step;

/** One search. */
typedef struct strut_search_outcome {
  int64_t outer;           /* point of the axes before the searches */
  int32_t start;           /* from 0 */
  strut_search_point best; /* of feasible points, or the one that breaks conditions least */
  strut_search_end end;
  int64_t evaluations, repeated, failed, feasible, valueless; /* valueless: the goal has no value */
  double top[STRUT_SEARCH_LATEST];                            /* the best objectives, best first */
  size_t top_count;
  strut_search_step *steps; /* (evaluations) */
  bool constant;            /* all objectives are the same */
  double least, most;       /* objectives of all points, feasible or not */
} strut_search_outcome;

/** A point beside the best one, along one variable. */
typedef struct strut_search_neighbour {
  bool there;
  strut_search_point point;
} strut_search_neighbour;

/** What the best point of one outer point is worth. */
typedef struct strut_search_worth {
  size_t best;  /* its search among the outcomes */
  bool checked; /* it was computed more exactly: */
  strut_search_point check;
  strut_search_neighbour (*neighbours)[2]; /* (variable_count) 1 % of the range below and above */
  int *bound;                              /* (variable_count) -1 or 1: it lies on a bound */
  int32_t agreeing; /* starts whose best is within 1 % of the best's size, itself included */
} strut_search_worth;

/** Feasible points none of which is better than another in both goals, by the first goal. */
typedef struct strut_search_front {
  size_t count, room;
  strut_search_point *points;
} strut_search_front;

typedef struct strut_search_result {
  size_t outcome_count, worth_count;
  strut_search_outcome *outcomes; /* (outcome_count) by outer point, then start */
  strut_search_worth *worths;     /* (worth_count) of each outer point that has a best */
  size_t front_count;             /* of two goals: the outer points; else 0 */
  strut_search_front *fronts;     /* (front_count) */
  strut_arena arena;
} strut_search_result;

/** As strut_sweep_run. The result is complete on STRUT_OK; release it in any case. */
STRUT_API strut_status strut_search_run(const strut_sweep_plan *plan, strut_slots *slots,
                                        const strut_sweep_options *options,
                                        strut_sweep_state *state, strut_search_result *result,
                                        strut_error *error);
/**
 * Are there several points to compute at the same time: generations, searches side by side, or scenarios?
 * Otherwise workers cannot share the search.
 */
STRUT_API bool strut_search_is_parallel(const strut_sweep_plan *plan);
STRUT_API void strut_search_result_free(strut_search_result *result);

/** The values of all columns of the axes at a point of the study whose variables have `values`. */
STRUT_API void strut_search_values(const strut_sweep_plan *plan, int64_t point,
                                   const strut_study_value *values, strut_study_value *all);

/**
 * The size that changes of a best objective are compared with: its own, or 0 where it is far below that of the
 * tenth best, as that of a difference which vanishes.
 */
STRUT_API double strut_search_size(const strut_search_outcome *outcome);

/** Is point a better than b for the study? */
STRUT_API bool strut_search_better(const strut_study_search *search,
                                   const strut_search_point *first,
                                   const strut_search_point *second);
