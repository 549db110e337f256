/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a row of the table is worth to a search: its goal, and by how much conditions are broken.
 */
#ifndef STRUT_ENGINE_STUDY_SEARCH_SCORE_H
#define STRUT_ENGINE_STUDY_SEARCH_SCORE_H

#include "engine/study/sweep/sweep.h"

/** Adds the columns `objective`, `objective_2` where there are two goals, and `violation` to the plan of a study that searches, behind all others. */
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

#endif
