/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Points of a table over two of its columns, coloured by a third, some of them marked.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_SCATTER_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_SCATTER_FIGURE_H

#include "engine/output/figures/table_figure.h"

typedef struct strut_scatter_figure {
  const char *title; /* may be NULL */
  double width;      /* [pt] */
  int x, y, value;   /* columns of numbers; value: STRUT_NO_COLUMN for one colour */
  strut_axis_choice x_axis, y_axis;
  strut_colours colours;      /* AUTO: sequential */
  const bool *shown, *marked; /* (rows) marked ones lie on top, in a ring */
} strut_scatter_figure;

/** As strut_table_curves. */
STRUT_API strut_status strut_table_scatter(const char *path, const strut_scatter_figure *figure,
                                           const strut_table *table, strut_error *error);

#endif
