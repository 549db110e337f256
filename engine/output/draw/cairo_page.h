/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The painter of figures as the rest of strut calls it: with Cairo and Pango in a module (engine/base/library.h). */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_CAIRO_PAGE_H
#define STRUT_ENGINE_OUTPUT_DRAW_CAIRO_PAGE_H

#include "engine/base/library.h"
#include "engine/output/draw/figure.h"

typedef struct strut_cairo_library {
  strut_library_stamp stamp;
  /** As strut_figure_draw, of a picture; the figure's arena stays. */
  strut_status (*draw)(const strut_plot *plot, strut_figure *figure, strut_error *error);
  /** As strut_canvas_open_pixels. */
  strut_status (*open)(int width, int height, double scale, strut_canvas **canvas,
                       strut_error *error);
  /**
   * Draws a figure on the whole canvas, as high as it is. Returns what strut_canvas_pixels does, or NULL where memory
   * is out.
   */
  const unsigned char *(*paint)(strut_canvas *canvas, strut_figure *figure, size_t *stride);
  /** As strut_canvas_free. */
  void (*free)(strut_canvas *canvas);
} strut_cairo_library;

/** Fails where the libraries cannot be loaded. */
strut_status strut_cairo_load(const strut_cairo_library **library, strut_error *error);

#endif
