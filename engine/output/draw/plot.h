/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Where a figure goes, its width, and what replaces its title and axes. */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_PLOT_H
#define STRUT_ENGINE_OUTPUT_DRAW_PLOT_H

#include "engine/output/draw/axes.h"

typedef struct strut_plot {
  const char *path;       /* ends with .svg, .pdf or .png; NULL: no figure is wanted */
  double width;           /* [pt] */
  const char *title;      /* replaces the figure's own; NULL: the model's name */
  strut_axis_choice x, y; /* of a figure with one pair of axes */
} strut_plot;

/** The title that was given, else `name`. */
static inline const char *strut_plot_title(const strut_plot *plot, const char *name) {
  return plot->title ? plot->title : name;
}

#endif
