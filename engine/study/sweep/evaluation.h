/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Single points of a study, one after the other, whose scenes come from outside: no grid, no files.
 *
 * An evaluation gives what a sweep would write into the row of that point, with the same bits. What the
 * points have in common, their equilibria, is kept from one to the next.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_EVALUATION_H
#define STRUT_ENGINE_STUDY_SWEEP_EVALUATION_H

#include "engine/base/flag.h"
#include "engine/study/sweep/sweep.h"

/** For one thread. */
typedef struct strut_evaluator strut_evaluator;

/** One result: a number in SI (NAN: missing) or a word. */
typedef struct strut_evaluated {
  const char *name, *unit; /* unit "1": none */
  const char *word;        /* NULL: it is a number */
  double number;
} strut_evaluated;

/** Valid until the next evaluation. */
typedef struct strut_evaluation {
  strut_status status; /* STRUT_OK, or why there are no results */
  const char *message; /* likewise */
  size_t count;
  const strut_evaluated *results; /* (count) in the order of the table */
  size_t warning_count;
  const char *const *warnings; /* (warning_count) sentences */
  bool inaccurate;             /* a requested accuracy was not reached; there are results */
} strut_evaluation;

/**
 * `interrupt` ends a computation early; may be NULL. `threads`, 1 or more: of searches within an
 * evaluation, on which results do not depend. NULL: memory is out.
 */
STRUT_API strut_evaluator *strut_evaluator_create(const strut_flag *interrupt, int threads);
STRUT_API void strut_evaluator_free(strut_evaluator *evaluator); /* NULL is allowed */

/**
 * Computes what the study, which has no axes, wants of a scene; takes the setup over. Failures of the
 * computation are in the evaluation. STRUT_INTERRUPTED.
 */
STRUT_API strut_status strut_evaluate(strut_evaluator *evaluator, const strut_study *study,
                                      strut_setup *setup, strut_evaluation *evaluation);

#endif
