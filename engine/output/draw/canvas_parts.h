/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the rooms of the canvas share: the page itself, and nobody else's business.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_CANVAS_PARTS_H
#define STRUT_ENGINE_OUTPUT_DRAW_CANVAS_PARTS_H

#include "engine/output/buffer.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/file.h"

struct _cairo;
struct _PangoLayout;

struct strut_canvas {
  struct _cairo *cairo;
  struct _PangoLayout *layout; /* used for every text in turn */
  strut_box box;
  strut_file file;  /* zero for pixels in memory */
  strut_buffer svg; /* gathered, for strut_canvas_renumber */
  bool is_svg, is_png;
};

/** Sets the colour of what is drawn next. */
void strut_canvas_ink(strut_canvas *canvas, strut_colour colour);
/** A coordinate that Cairo can take: the page's neighbourhood at most; not a number is far away. */
double strut_canvas_near(double coordinate);
/** Numbers the surfaces of an SVG's text anew, in place. False when memory is out. */
bool strut_canvas_renumber(char *svg);
/** The layout of texts, or NULL when memory is out. */
struct _PangoLayout *strut_canvas_layout_create(struct _cairo *cairo);
/** NULL is allowed. */
void strut_canvas_layout_free(struct _PangoLayout *layout);

#endif
