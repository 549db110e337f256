/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Refinement of a map: which points of the finest grid are to be computed.
 *
 * A cell has its corners on a grid whose steps are 2^k of the finest ones. It is divided where points on
 * its edges that are known differ in a column; then its centre and the middles of its edges are wanted,
 * and its quarters are cells. A quarter's points may show to the cell beside it that this has to be
 * divided as well. What is wanted grows with what is known, and the largest set does not depend on the
 * order in which points are computed: threads, shards and interruptions change nothing.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_REFINE_H
#define STRUT_ENGINE_STUDY_SWEEP_REFINE_H

#include "engine/study/sweep/sweep.h"

typedef struct strut_refinement strut_refinement;

/**
 * The refinement of a plan whose study has one. STRUT_BAD_SCENE where the table has no column of that
 * name; STRUT_NO_MEMORY. The plan must outlive it.
 */
STRUT_API strut_status strut_refinement_create(const strut_sweep_plan *plan,
                                               strut_refinement **refinement, strut_error *error);
STRUT_API void strut_refinement_free(strut_refinement *refinement); /* NULL is allowed */
/** Takes note of all points of a file that are done. */
STRUT_API void strut_refinement_learn(strut_refinement *refinement, strut_slots *slots);
/** Marks all points that are wanted by what is known; how many of them are not known. */
STRUT_API int64_t strut_refinement_choose(strut_refinement *refinement);
/** Is the point wanted? `refinement` is a strut_refinement, as strut_sweep_options has it. */
STRUT_API bool strut_refinement_wants(const void *refinement, int64_t point);
/** The number of wanted points of a file, and of those that are done. */
STRUT_API void strut_refinement_count(const strut_refinement *refinement, strut_slots *slots,
                                      int64_t *wanted, int64_t *done);
/** Points of the coarsest grid. */
STRUT_API int64_t strut_refinement_coarse(const strut_sweep_plan *plan);
/**
 * The known point that stands for any point of the finest grid: itself, or the nearest corner of the
 * smallest cell around it whose corners are known. -1: there is none.
 */
STRUT_API int64_t strut_refinement_stand_in(const strut_refinement *refinement, int64_t point);

#endif
