/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What canvas.c needs of Cairo and Pango: a page, ink on it, and its bytes.
 *
 * Only cairo_page.c sees their headers. Lengths are points, x right and y down, as in canvas.h.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_CAIRO_PAGE_H
#define STRUT_ENGINE_OUTPUT_DRAW_CAIRO_PAGE_H

#include "engine/base/library.h"
#include "engine/output/draw/canvas.h"

typedef struct strut_cairo_page strut_cairo_page;

typedef enum strut_page_format {
  STRUT_PAGE_SVG,
  STRUT_PAGE_PDF,
  STRUT_PAGE_PNG,
  STRUT_PAGE_PIXELS /* stays in memory */
} strut_page_format;

typedef struct strut_page_request {
  strut_page_format format;
  double width, height; /* [pt] */
  double scale;         /* pixels for each point, of PNG and pixels; else 1 */
  const char *title;    /* of a PDF */
  void *context;
  /* Receives the file's bytes; STRUT_OK, STRUT_NO_MEMORY or STRUT_FILE_TROUBLE. */
  strut_status (*write)(void *context, const void *bytes, size_t count);
} strut_page_request;

typedef enum strut_outline_kind {
  STRUT_OUTLINE_LINE,
  STRUT_OUTLINE_SEGMENTS, /* points 2 i and 2 i + 1 belong together */
  STRUT_OUTLINE_CLOSED,
  STRUT_OUTLINE_CIRCLE /* around its only point */
} strut_outline_kind;

typedef struct strut_outline {
  strut_outline_kind kind;
  size_t count;
  const double (*points)[2]; /* (count) */
  double radius;
} strut_outline;

/** A text as it was drawn. */
typedef struct strut_drawn_text {
  const char *text; /* valid UTF-8; until the next text is drawn or measured */
  strut_box ink;
  bool whole; /* all of it is on the page and inside the clip */
} strut_drawn_text;

typedef struct strut_cairo_library {
  strut_library_stamp stamp;
  /** A page; its context must live as long. NULL: out of memory. */
  strut_cairo_page *(*open)(const strut_page_request *request);
  /** See strut_canvas_pixels. */
  const unsigned char *(*pixels)(strut_cairo_page *page, size_t *stride);
  /**
   * Writes what is left of the file. STRUT_NO_MEMORY; STRUT_FILE_TROUBLE, with *reason NULL where `write` failed,
   * else in Cairo's words.
   */
  strut_status (*finish)(strut_cairo_page *page, const char **reason);
  /** NULL is allowed. What an unfinished page still has to write is written. */
  void (*free)(strut_cairo_page *page);
  void (*clear)(strut_cairo_page *page, strut_colour colour);
  void (*clip)(strut_cairo_page *page, strut_box box);
  void (*unclip)(strut_cairo_page *page);
  /** A fill or a pen may be NULL. */
  void (*draw)(strut_cairo_page *page, const strut_outline *outline, const strut_fill *fill,
               const strut_pen *pen);
  /** See strut_canvas_ink. */
  double (*ink)(strut_cairo_page *page, strut_box box);
  /** The following as the functions of canvas.h that are named like them. */
  strut_drawn_text (*text)(strut_cairo_page *page, const double at[2], const char *text,
                           strut_font font);
  void (*text_size)(strut_cairo_page *page, const char *text, strut_font font, double *width,
                    double *height);
} strut_cairo_library;

/** Fails where the libraries cannot be loaded (engine/base/library.h). */
strut_status strut_cairo_load(const strut_cairo_library **library, strut_error *error);

#endif
