/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The table of a study, a CSV file (RFC 4180) with units in its header such as "velocity [m/s]".
 *
 * One row for each point in their order: its number as `point`, the columns of the study, and
 * `status` and `message`, "completed" and nothing or why it failed. A number that there is not is an
 * empty cell; every other reads back to the same bits.
 */
#ifndef STRUT_ENGINE_STUDY_RESULTS_STUDY_TABLE_H
#define STRUT_ENGINE_STUDY_RESULTS_STUDY_TABLE_H

#include "engine/study/results/slots.h"

/**
 * Writes the table as directory/name, whole or not at all. Point p is in sources[p % count], as
 * shards are; one source holds all. The bytes depend on the rows only. STRUT_USAGE where a point is
 * missing.
 */
STRUT_API strut_status strut_study_table_write(const char *directory, const char *name,
                                               strut_slots *const *sources, size_t count,
                                               strut_error *error);

/**
 * The same of the rows that there are, in their order; *rows (may be NULL) receives their number. Others
 * may write the sources meanwhile.
 */
STRUT_API strut_status strut_study_table_write_partial(const char *directory, const char *name,
                                                       strut_slots *const *sources, size_t count,
                                                       int64_t *rows, strut_error *error);

/** The same of some points, which have rows, in this order. */
STRUT_API strut_status strut_study_table_write_points(const char *directory, const char *name,
                                                      strut_slots *source, const int64_t *points,
                                                      size_t count, strut_error *error);

#endif
