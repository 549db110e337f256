/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of tables: curves in panels with grey bands.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_FIGURE_H

#include <stdbool.h>

#include "engine/base/status.h"
#include "engine/output/draw/chart.h"
#include "engine/output/record_files.h"

enum { STRUT_NO_COLUMN = -1, STRUT_MOST_Y = 20, STRUT_MOST_PANELS = 24 };

/** Selection of rows, and whether their differences are drawn. */
typedef struct strut_table_choice {
  int only; /* rows whose column has the text `only_value` */
  const char *only_value;
  int difference; /* its two texts are two sides: the second minus the first; of categories, the
                     second with doubt where the first differs */
} strut_table_choice;
#define STRUT_TABLE_ALL                                                                            \
  { .only = STRUT_NO_COLUMN, .difference = STRUT_NO_COLUMN }

/** Curves from the columns of a table. Columns by number, STRUT_NO_COLUMN for none. */
typedef struct strut_table_figure {
  const char *title;               /* may be NULL */
  double width;                    /* [pt] */
  int x, y[STRUT_MOST_Y], y_count; /* all y of one unit */
  strut_axis_choice x_axis, y_axis;
  int by;     /* a curve for each of its texts */
  int panels; /* a panel for each of its texts */
  int band;   /* grey where it has the text `band_value`, midway to the next points */
  const char *band_value;
  bool log_x, log_y;
  strut_table_choice choice;
  bool between; /* of a difference: the first side is interpolated linearly */
} strut_table_figure;

/**
 * Draws curves into the file `path`. STRUT_USAGE for a column without numbers where numbers are
 * needed, y of different units, or too many panels; otherwise as strut_canvas_open and
 * strut_canvas_commit.
 */
STRUT_API strut_status strut_table_curves(const char *path, const strut_table_figure *figure,
                                          const strut_table *table, strut_error *error);

/** Columns by number; STRUT_NO_COLUMN for none. */
typedef struct strut_table_map_figure {
  const char *title;
  double width;    /* [pt] */
  int x, y, value; /* value: texts are categories, numbers get a colour scale */
  strut_axis_choice x_axis, y_axis;
  strut_colours colours;
  int panels, doubt; /* doubt: hatched where it is not empty, 0, false or no */
  strut_table_choice choice;
} strut_table_map_figure;

/**
 * Draws a map, or one in each panel, of rows in any order; points of the grid without a row have no
 * answer. STRUT_USAGE where x or y are no numbers or the grid would be too large.
 */
STRUT_API strut_status strut_table_map(const char *path, const strut_table_map_figure *figure,
                                       const strut_table *table, strut_error *error);

#endif
