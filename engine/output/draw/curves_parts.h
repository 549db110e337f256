/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What curves, maps and work-precision diagrams share: looks, markers, thinning, legends.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_CURVES_PARTS_H
#define STRUT_ENGINE_OUTPUT_DRAW_CURVES_PARTS_H

#include "engine/output/draw/curves.h"

/** The pen of the i-th look: colour and dashes of its own. */
strut_pen strut_series_pen(size_t look);
/** Its marker at x, y. */
void strut_draw_marker(strut_canvas *canvas, size_t look, double x, double y, double size);
/** The fill of the i-th grey area. */
strut_fill strut_band_fill(int look);

/**
 * Thins (count) points of ascending x in place so that what is drawn stays the same: at most four in
 * each `grain` of x. Returns how many are left; points of any other order all stay.
 */
size_t strut_thin(double (*points)[2], size_t count, double grain);

/** One row of a legend: a line with a marker, or an area. */
typedef struct strut_legend_entry {
  const char *label;
  bool area;
  size_t look;       /* of a line */
  bool line, marker; /* which of them */
  strut_fill fill;   /* of an area */
} strut_legend_entry;

/** Size of the legend as a column of rows, or in lines that fill `width` (0: a column). */
void strut_legend_size(strut_canvas *canvas, const strut_legend_entry *entries, size_t count,
                       double width, double size[2]);
/** Draws it with its upper left corner at x, y; over data it needs a background. */
void strut_draw_legend(strut_canvas *canvas, const strut_legend_entry *entries, size_t count,
                       double width, double x, double y, bool background);

#endif
