/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The points of a study: from a point's number to its values, at once and without a list.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_GRID_H
#define STRUT_ENGINE_STUDY_SWEEP_GRID_H

#include "engine/scene/study.h"

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

#endif
