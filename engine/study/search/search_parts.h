/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of a search share. Internal to engine/study/search. */
#pragma once

#include "engine/study/search/optimisers.h"
#include "engine/study/search/search.h"
#include "engine/study/sweep/sweep_parts.h"

/** How the points of the study are numbered: (outer * rows + row) * scenarios + scenario. */
typedef struct strut_search_layout {
  int64_t outers, rows, scenarios;
  size_t variables, conditions;
} strut_search_layout;

strut_search_layout strut_search_layout_of(const strut_sweep_plan *plan);

/* batch.c: points of the study side by side */

/** A point that is to be computed. */
typedef struct strut_batch_point_wanted {
  int64_t point;
  const strut_study_value *values; /* of the variables */
} strut_batch_point_wanted;

typedef struct strut_search_batch {
  const strut_sweep_plan *plan;
  const strut_sweep_options *given; /* by the caller */
  strut_points points;              /* slots, state and error are the caller's */
  strut_sweep_options options;      /* with the hooks of the search */
  int64_t first_check;              /* rows from here on are those of search 0 */
  size_t count, capacity;
  size_t first;                     /* of the wanted points in the order of this process */
  strut_batch_point_wanted *wanted; /* (count) */
  strut_arena arena;
} strut_search_batch;

strut_status strut_search_batch_begin(strut_search_batch *batch);
void strut_search_batch_free(strut_search_batch *batch);
/** Adds the points of all scenarios of a row that have no result yet. False: no memory. */
bool strut_search_batch_add(strut_search_batch *batch, int64_t outer, int64_t row,
                            const strut_study_value *values);
/** Computes what was added, or waits until other workers have, and forgets it. */
strut_status strut_search_batch_run(strut_search_batch *batch);

/* judge.c: rows to points of the search */

/**
 * The worst of the scenarios of a row, all of which are there, for the point with these values; broken
 * (condition_count) is the largest of each. STRUT_FILE_TROUBLE where the rows have other values.
 */
strut_status strut_search_judge(const strut_sweep_plan *plan, strut_slots *slots, int64_t outer,
                                int64_t row, strut_search_point *point, double *broken,
                                strut_error *error);

/** Derivatives (variables) of the goal by numbers of the box, at a point whose row has those of its columns. */
strut_status strut_search_gradient(const strut_sweep_plan *plan, strut_slots *slots,
                                   const strut_search_point *point, double *gradient,
                                   strut_error *error);

/* judge.c */

/** Takes a feasible point into the front, unless another is as good in both goals. False: no memory. */
bool strut_search_front_take(const strut_study_search *search, strut_search_front *front,
                             const strut_search_point *point, strut_arena *arena);

/* judge.c */

/** Computes the best points of all outer points more exactly, and their neighbours. */
strut_status strut_search_find_worth(strut_search_batch *batch, strut_search_result *result);

/* An optimiser in a thread of its own, whose questions are answered from outside.
 *
 * So the questions of several optimisers can be answered side by side, whatever library they come from. An
 * optimiser only runs between an answer and its next question.
 */

typedef struct strut_dialogue strut_dialogue;

/** A question of an optimiser: the values and broken conditions of points, as of a strut_search_asker. */
typedef struct strut_question {
  size_t count;
  const double *points;    /* (count, dimension) */
  double *values, *broken; /* to be filled */
} strut_question;

/** Starts the optimiser; the task and what it points to must outlive it. NULL: no memory, or no thread. */
strut_dialogue *strut_dialogue_begin(const strut_search_task *task);
/** Waits for the next question. False: the optimiser has ended. */
bool strut_dialogue_question(strut_dialogue *dialogue, strut_question *question);
/** Says that the question is answered. */
void strut_dialogue_answer(strut_dialogue *dialogue);
/** Ends the optimiser, after a question or its end. False: it had no memory. NULL is allowed. */
bool strut_dialogue_end(strut_dialogue *dialogue);
