/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Figures of tables: curves in panels with grey bands, maps, clouds of points. */
#pragma once

#include <stdbool.h>

#include "engine/base/status.h"
#include "engine/output/draw/figure.h"
#include "engine/output/record_files.h"
#include "engine/scene/study.h"

enum { STRUT_NO_COLUMN = -1, STRUT_MOST_Y = 20, STRUT_MOST_TABLE_GROUPS = 40 };

/** Number of the column of that name, of `length` bytes; STRUT_NO_COLUMN where there is none, or no name. */
STRUT_API int strut_table_column_of(const strut_table *table, const char *name, size_t length);

/** Has figures show a column, if there is one of that name, in a unit. */
STRUT_API void strut_table_show_unit(strut_table *table, const char *name, strut_file_unit shown);

/**
 * Draws lines, a map or points as a figure of a study says, whose columns the table has. Rows of a map are in any order;
 * points of its grid without a row have no answer or, `spread`, that of the nearest with one. STRUT_USAGE for a column without numbers where numbers are needed, y
 * of different units, too many panels or curves, or too large a grid; otherwise as strut_figure_draw.
 */
STRUT_API strut_status strut_table_draw(const strut_plot *plot, const strut_study_figure *figure,
                                        const strut_table *table, bool spread, strut_error *error);

/* Tables from tables: rows of a text, or those of a second side less the first. */

/**
 * The rows that have `text` in a column (or any, STRUT_NO_COLUMN) and are `shown` (rows; NULL: all). STRUT_USAGE where
 * none has the text; STRUT_NO_MEMORY. `chosen`, zero-initialised, refers to texts and numbers of `from`
 * and has room for two more columns.
 */
STRUT_API strut_status strut_table_choose(const strut_table *from, int column, const char *text,
                                          const bool *shown, strut_table *chosen,
                                          strut_error *error);

enum { STRUT_KEYS_OF_ROWS = 3 };
/** Which rows are compared, and what of them; columns by number. */
typedef struct strut_table_pairing {
  int keys[STRUT_KEYS_OF_ROWS]; /* equal in rows that are compared; STRUT_NO_COLUMN: unused */
  bool between;                 /* the first side is interpolated linearly over the last key */
  const int *values;            /* (value_count) compared columns, of which at most one has texts */
  size_t value_count;
} strut_table_pairing;
/**
 * Of the two texts in a column of a chosen table keeps the rows of the second, their numbers less those of the first,
 * NAN without such a row; where texts differ says a further column, the last. STRUT_USAGE where there are not two texts;
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_table_subtract(strut_table *table, int column,
                                            const strut_table_pairing *pairing, strut_error *error);

/** The different texts of a column, in their order; of no column, one group without a name. */
typedef struct strut_table_groups {
  size_t count;
  const char *name[STRUT_MOST_TABLE_GROUPS];
  size_t row[STRUT_MOST_TABLE_GROUPS]; /* the first of each */
} strut_table_groups;

/** STRUT_USAGE where there are more than `most`, named `what` in the message ("panels"). */
STRUT_API strut_status strut_table_groups_find(const strut_table *table, int column, size_t most,
                                               const char *what, strut_table_groups *groups,
                                               strut_error *error);
