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

enum { STRUT_NO_COLUMN = -1, STRUT_MOST_Y = 20, STRUT_MOST_PANELS = 24 };

/** Selection of rows, and whether their differences are drawn. */
typedef struct strut_table_choice {
  int only; /* rows whose column has the text `only_value` */
  const char *only_value;
  int difference; /* its two texts are two sides: the second minus the first; of categories, the
                     second with doubt where the first differs */
} strut_table_choice;

typedef enum strut_table_kind {
  STRUT_TABLE_CURVES, /* y over x, all y of one unit */
  STRUT_TABLE_MAP,    /* value over x and y: texts are categories, numbers get a colour scale */
  STRUT_TABLE_POINTS  /* y over x, coloured by value; the marked ones on top, in a ring */
} strut_table_kind;

/** What is drawn of a table. Columns by number, STRUT_NO_COLUMN for none. */
typedef struct strut_table_figure {
  strut_table_kind kind;
  int x, y[STRUT_MOST_Y], y_count;
  int panels; /* a panel for each of its texts */
  strut_table_choice choice;
  /* Of curves. */
  int by;   /* a curve for each of its texts */
  int band; /* grey where it has the text `band_value`, midway to the next points */
  const char *band_value;
  size_t label_count;
  const char *const *labels; /* (label_count) of all curves in their order; none: by the columns */
  bool log_x, log_y,
      between; /* between: of a difference, the first side is interpolated linearly */
  /* Of maps and points. */
  int value, doubt; /* doubt: hatched where it is not empty, 0, false or no */
  strut_colours colours;
  bool spread;                /* cells of a map without a row are as the nearest that have one */
  const bool *shown, *marked; /* (rows) shown, NULL: all; of points those with a ring */
} strut_table_figure;

/** One without any column but the first as x and y. */
#define STRUT_TABLE_FIGURE                                                                         \
  (strut_table_figure) {                                                                           \
    .y_count = 1, .panels = STRUT_NO_COLUMN, .by = STRUT_NO_COLUMN, .band = STRUT_NO_COLUMN,       \
    .value = STRUT_NO_COLUMN, .doubt = STRUT_NO_COLUMN, .choice = {                                \
      .only = STRUT_NO_COLUMN,                                                                     \
      .difference = STRUT_NO_COLUMN                                                                \
    }                                                                                              \
  }

/** Number of the column of that name, of `length` bytes; STRUT_NO_COLUMN where there is none, or no name. */
STRUT_API int strut_table_column_of(const strut_table *table, const char *name, size_t length);

/**
 * Draws into the plot's file. Rows of a map are in any order; points of its grid without a row have no answer.
 * STRUT_USAGE for a column without numbers where numbers are needed, y of different units, too many panels or
 * curves, or too large a grid; otherwise as strut_figure_draw.
 */
STRUT_API strut_status strut_table_draw(const strut_plot *plot, const strut_table_figure *figure,
                                        const strut_table *table, strut_error *error);

#endif
