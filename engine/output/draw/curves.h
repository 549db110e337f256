/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
  * Curves over one quantity: lines with markers, grey bands, and a legend placed clear of them.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_CURVES_H
#define STRUT_ENGINE_OUTPUT_DRAW_CURVES_H

#include "engine/output/draw/axes.h"

typedef struct strut_series {
  const char *label; /* in the legend; NULL: not there */
  size_t count;
  const double *x, *y;         /* (count) SI; a y that is not finite breaks the line */
  int look;                    /* index of colour, dashes and marker; -1: the series' own index */
  bool points, steps, no_line; /* markers at the points; a staircase; no line between */
  bool right;                  /* y belongs to the right axis */
} strut_series;

/** A grey area from x = low to high; its label goes into the legend, or is NULL. */
typedef struct strut_band {
  double low, high;
  const char *label;
  int look; /* index of grey and hatching */
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
 * Draws curves in a box. Points are thinned to the visible ones: first, least, largest and last in
 * each quarter of a point. Fails with STRUT_NO_MEMORY only.
 */
STRUT_API strut_status strut_draw_curves(strut_canvas *canvas, strut_box box,
                                         const strut_curves *curves);

#endif
