/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The points of a study: from a point's number to its values, at once and without a list.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_GRID_H
#define STRUT_ENGINE_STUDY_SWEEP_GRID_H

#include "engine/scene/study.h"
#include "engine/study/sweep/sweep.h"

/** Number of points; -1 beyond STRUT_STUDY_MOST_POINTS. Without axes there is one. */
STRUT_API int64_t strut_grid_points(const strut_study *study);
/** Number of columns: of all axes together, in their order. */
STRUT_API size_t strut_grid_columns(const strut_study *study);
/** The k-th column of all axes together, and through `axis` (may be NULL) whose it is. */
STRUT_API const strut_study_column *strut_grid_column(const strut_study *study, size_t k,
                                                      size_t *axis);
/**
 * Value i of a column whose axis has `count` values; a LIST must be one of numbers. What a range gives
 * between its ends is rounded to 15 digits, so that round numbers come out round, and the same from
 * every C library; the ends have their own bits.
 */
STRUT_API double strut_grid_value(const strut_study_column *column, int64_t i, int64_t count);
/** The values of all columns (strut_grid_columns) at a point from 0 on; the last axis is the fastest. */
STRUT_API void strut_grid_values(const strut_study *study, int64_t point,
                                 strut_study_value *values);

/**
 * The value to the 15 digits that a double can represent, counted from the first digit of `scale`.
 */
STRUT_API double strut_grid_rounded(double value, double scale);

/* Refinement of a map: which points of the finest grid are to be computed.
 *
 * A cell has its corners on a grid whose steps are 2^k of the finest ones. It is divided where points on
 * its edges that are known differ in a column; then its centre and the middles of its edges are wanted,
 * and its quarters are cells. A quarter's points may show to the cell beside it that this has to be
 * divided as well. What is wanted grows with what is known, and the largest set does not depend on the
 * order in which points are computed: threads, shards and interruptions change nothing.
 */

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
