/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of tables: maps over two columns, and work-precision diagrams.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_TABLE_MAP_H
#define STRUT_ENGINE_OUTPUT_FIGURES_TABLE_MAP_H

#include "engine/output/draw/palette.h"
#include "engine/output/figures/table_figure.h"

/** Columns by number; STRUT_NO_COLUMN for none. */
typedef struct strut_table_map_figure {
  const char *title;
  double width;    /* [pt] */
  int x, y, value; /* value: texts are categories, numbers get a scale of colours */
  strut_table_axis x_axis, y_axis;
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

/** x is the cost, y the error (a cell without a finite number: diverged). */
typedef struct strut_table_savings_figure {
  const char *title;
  double width;
  strut_table_axis x_axis, y_axis;
  int x, y, by, label; /* by: the method; label: what stands beside points of the front */
} strut_table_savings_figure;

/** Draws a work-precision diagram. */
STRUT_API strut_status strut_table_savings(const char *path,
                                           const strut_table_savings_figure *figure,
                                           const strut_table *table, strut_error *error);

#endif
