/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Maps over two quantities: a category or a number at every grid point; doubtful ones are hatched.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_MAP_H
#define STRUT_ENGINE_OUTPUT_DRAW_MAP_H

#include "engine/output/draw/axes.h"
#include "engine/output/draw/palette.h"

typedef struct strut_map {
  const char *title; /* may be NULL */
  strut_axis x, y;   /* linear; an empty range: all cells */
  size_t columns, rows;
  const double *xs, *ys; /* (columns), (rows) ascending; cell edges are midpoints */
  const int *category;   /* (rows, columns) index into names, -1: no result; or NULL */
  size_t category_count;
  const char *const *names;     /* (category_count) */
  const double *value;          /* (rows, columns) where category is NULL; NAN: no result */
  double value_low, value_high; /* of the scale of colours; equal: from the values */
  const char *value_name, *value_unit;
  strut_colours colours;
  const bool *doubtful; /* (rows, columns) drawn hatched; or NULL */
  const char *doubt;    /* meaning of the hatching, for the legend */
} strut_map;

/** Draws a map with its legend or colour bar in a box. STRUT_NO_MEMORY. */
STRUT_API strut_status strut_draw_map(strut_canvas *canvas, strut_box box, const strut_map *map);

#endif
