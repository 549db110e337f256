/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Axes: from a quantity's range to ticks, labels and a place on the page, with no tuning.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_AXES_H
#define STRUT_ENGINE_OUTPUT_DRAW_AXES_H

#include "engine/output/draw/canvas.h"

/** One axis as wanted. Its label reads "name in prefix unit", such as "velocity in mm/s". */
typedef struct strut_axis {
  const char *name, *unit; /* the values' SI unit; "" for none. A prefix is chosen for the ticks */
  bool logarithmic;
  double low, high;        /* the range; both NAN: from the data, with a little room */
} strut_axis;

/** A pair of axes laid out in a box. strut_axes_place makes it. */
typedef struct strut_axes {
  strut_axis x, y;  /* ranges resolved */
  strut_box frame;  /* where data go [pt] */
} strut_axes;

/** Widens an axis whose range is from the data by a value; not finite ones do nothing. */
STRUT_API void strut_axis_include(strut_axis *axis, double value);
/**
 * Lays out a frame in `box`, leaving room for ticks, labels and a title (NULL: none); panels side by
 * side line up when their boxes do.
 */
STRUT_API strut_axes strut_axes_place(strut_canvas *canvas, strut_box box, strut_axis x,
                                      strut_axis y, const char *title);
/** Frame, ticks, faint grid, labels and title: before the data, so that these lie above the grid. */
STRUT_API void strut_draw_axes(strut_canvas *canvas, const strut_axes *axes, const char *title);
/** Where a pair of values is on the page. */
STRUT_API void strut_axes_point(const strut_axes *axes, double x, double y, double point[2]);

enum { STRUT_MOST_TICKS = 40 };
/** Round values in [low, high], about `wanted` of them: 1, 2 or 5 times a power of ten. */
STRUT_API size_t strut_ticks(double low, double high, int wanted, double ticks[STRUT_MOST_TICKS]);
/** The prefix for values up to `largest`: factor such as 1e-3 and text such as "m" ("" for 1). */
STRUT_API const char *strut_prefix(double largest, const char *unit, double *factor);

#endif
