/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Figures of tables: curves in panels with grey bands, maps, clouds of points. */
#pragma once

#include <stdbool.h>

#include "engine/base/status.h"
#include "engine/output/draw/figure.h"
#include "engine/output/record_files.h"
#include "engine/scene/study.h"

enum { STRUT_NO_COLUMN = -1, STRUT_MOST_Y = 20 };

/** What a figure of a search shows besides. Zero: all rows, without rings. */
typedef struct strut_table_marks {
  const bool *shown, *marked; /* (rows) shown, NULL: all; of points those with a ring */
  bool spread;                /* cells of a map without a row are as the nearest that have one */
} strut_table_marks;

/** Number of the column of that name, of `length` bytes; STRUT_NO_COLUMN where there is none, or no name. */
STRUT_API int strut_table_column_of(const strut_table *table, const char *name, size_t length);

/** Has figures show a column, if there is one of that name, in a unit. */
STRUT_API void strut_table_show_unit(strut_table *table, const char *name, strut_file_unit shown);

/**
 * Draws lines, a map or points as a figure of a study says, whose columns the table has. Rows of a map are in any order;
 * points of its grid without a row have no answer. STRUT_USAGE for a column without numbers where numbers are needed, y
 * of different units, too many panels or curves, or too large a grid; otherwise as strut_figure_draw.
 */
STRUT_API strut_status strut_table_draw(const strut_plot *plot, const strut_study_figure *figure,
                                        const strut_table *table, strut_table_marks marks,
                                        strut_error *error);

/* Rows of a table that are drawn: all, those of a text, or those of a second side less the first. */

enum { STRUT_MOST_TABLE_GROUPS = 40, STRUT_KEYS_OF_ROWS = 3 };

/** The row of the first side, or two and a weight between them; SIZE_MAX if no row fits. */
typedef struct strut_table_partner {
  size_t row, next;
  double weight; /* of `next` */
} strut_table_partner;

/** Columns by number. */
typedef struct strut_table_rows {
  const strut_table *table;
  int keys[STRUT_KEYS_OF_ROWS]; /* equal in rows that are compared; STRUT_NO_COLUMN: unused */
  bool between;                 /* the first side is interpolated linearly over the last key */
  const int *values;            /* (value_count) compared columns */
  size_t value_count;
  /* Found: */
  bool *shown;                  /* (rows) */
  const char *side[2];          /* of a difference the texts: first, second */
  strut_table_partner *partner; /* (rows) of a difference, else NULL */
} strut_table_rows;

/**
 * Finds in the arena what is shown: first the rows with `text` in column `only`; then, of the two texts of column
 * `difference`, those of the second. STRUT_USAGE where there is no such row, or there are not two texts;
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_table_rows_choose(strut_table_rows *rows, int only, const char *text,
                                               int difference, strut_arena *arena,
                                               strut_error *error);
/** True if there is a difference of this column. */
STRUT_API bool strut_table_compares(const strut_table_rows *rows, int column);
/** A number; of a compared column less its partner's, NAN without one. */
STRUT_API double strut_table_number(const strut_table_rows *rows, int column, size_t row);
/** True if the text is another one than its partner's, or there is no partner. */
STRUT_API bool strut_table_differs(const strut_table_rows *rows, int column, size_t row);

/** The different texts of a column in the rows shown, in their order; of no column, one group without a name. */
typedef struct strut_table_groups {
  size_t count;
  const char *name[STRUT_MOST_TABLE_GROUPS];
  size_t row[STRUT_MOST_TABLE_GROUPS]; /* the first of each */
} strut_table_groups;

/** STRUT_USAGE where there are more than `most`, named `what` in the message ("panels"). */
STRUT_API strut_status strut_table_groups_find(const strut_table_rows *rows, int column,
                                               size_t most, const char *what,
                                               strut_table_groups *groups, strut_error *error);
/** True if a row is shown and belongs to a group of that column. */
STRUT_API bool strut_table_belongs(const strut_table_rows *rows, int column, const char *name,
                                   size_t row);
