/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Curves over one quantity: lines with markers, grey bands, a legend that gets out of their way.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_CURVES_H
#define STRUT_ENGINE_OUTPUT_DRAW_CURVES_H

#include "engine/output/draw/axes.h"

typedef struct strut_series {
  const char *label; /* in the legend; NULL: not there */
  size_t count;
  const double *x, *y; /* (count) SI; where y is not finite the line is broken */
  int look;            /* colour, dashes and marker: series of one look belong together; -1: own */
  bool points, steps, no_line; /* markers at the points; a staircase; no line between */
  bool right;                  /* y belongs to the right axis */
} strut_series;

/** A grey area from x = low to high, with a word for the legend or NULL. */
typedef struct strut_band {
  double low, high;
  const char *label;
  int look; /* which of the greys and hatches */
} strut_band;

typedef struct strut_curves {
  const char *title; /* may be NULL */
  strut_axis x, y;
  const strut_axis *right; /* a second y axis for series of another unit; NULL: none */
  size_t series_count, band_count;
  const strut_series *series;
  const strut_band *bands;
  double cursor; /* a vertical line at this x; NAN: none */
} strut_curves;

/**
 * Draws them in a box. Many points are thinned to what can be seen: the first, least, largest
 * and last in each quarter of a point. STRUT_NO_MEMORY when there is none.
 */
STRUT_API strut_status strut_draw_curves(strut_canvas *canvas, strut_box box,
                                         const strut_curves *curves);

#endif
