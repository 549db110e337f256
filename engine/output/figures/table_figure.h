/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of tables: curves in panels with grey bands, maps, clouds of points.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_FIGURE_H

#include <stdbool.h>

#include "engine/base/status.h"
#include "engine/output/draw/figure.h"
#include "engine/output/record_files.h"
#include "engine/scene/study.h"

enum { STRUT_NO_COLUMN = -1, STRUT_MOST_Y = 20, STRUT_MOST_PANELS = 24 };

/** Selection of rows, and whether their differences are drawn. */
typedef struct strut_table_choice {
  int only; /* rows whose column has the text `only_value` */
  const char *only_value;
  int difference; /* its two texts are two sides: the second minus the first; of categories, the
                     second with doubt where the first differs */
} strut_table_choice;

/** What a figure of a search shows besides. Zero: all rows, without rings. */
typedef struct strut_table_marks {
  const bool *shown, *marked; /* (rows) shown, NULL: all; of points those with a ring */
  bool spread;                /* cells of a map without a row are as the nearest that have one */
} strut_table_marks;

/** Number of the column of that name, of `length` bytes; STRUT_NO_COLUMN where there is none, or no name. */
STRUT_API int strut_table_column_of(const strut_table *table, const char *name, size_t length);

/**
 * Draws lines, a map or points as a figure of a study says, whose columns the table has. Rows of a map are in any order;
 * points of its grid without a row have no answer. STRUT_USAGE for a column without numbers where numbers are needed, y
 * of different units, too many panels or curves, or too large a grid; otherwise as strut_figure_draw.
 */
STRUT_API strut_status strut_table_draw(const strut_plot *plot, const strut_study_figure *figure,
                                        const strut_table *table, strut_table_marks marks,
                                        strut_error *error);

#endif
