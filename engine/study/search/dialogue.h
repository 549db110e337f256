/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * An optimiser in a thread of its own, whose questions are answered from outside.
 *
 * So the questions of several optimisers can be answered side by side, whatever library they come from. An
 * optimiser only runs between an answer and its next question.
 */
#ifndef STRUT_ENGINE_STUDY_SEARCH_DIALOGUE_H
#define STRUT_ENGINE_STUDY_SEARCH_DIALOGUE_H

#include "engine/base/status.h"
#include "engine/study/search/optimiser.h"

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

#endif
