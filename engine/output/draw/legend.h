/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Styles that distinguish series (colour, dashes, markers), keys and legends, and texts cut to fit.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_LEGEND_H
#define STRUT_ENGINE_OUTPUT_DRAW_LEGEND_H

#include "engine/output/draw/canvas.h"

/** The pen of the i-th style: its colour and dashes. */
STRUT_API strut_pen strut_series_pen(size_t look);
/** Draws the marker of a series at x, y. */
STRUT_API void strut_draw_marker(strut_canvas *canvas, size_t look, double x, double y,
                                 double size);
typedef enum strut_key_sign {
  STRUT_KEY_LINE,   /* a short line by `pen`, with the marker of a look if `marked` */
  STRUT_KEY_ARROW,  /* an arrow by `pen` */
  STRUT_KEY_DOT,    /* a circle by `fill` and `pen`, with `letter` beside it where there is one */
  STRUT_KEY_CLOUD,  /* a dot by `fill`, in the middle of where lines are */
  STRUT_KEY_AREA,   /* a box by `fill` */
  STRUT_KEY_SIGNED, /* the colours of strut_palette_signed between the words `before` and `text` */
  STRUT_KEY_WORDS   /* no sign */
} strut_key_sign;

/** What something in a figure means: in a legend beside data, or in the key below a figure. */
typedef struct strut_key_item {
  strut_key_sign sign;
  strut_pen pen;
  strut_fill fill;
  bool marked;
  size_t look;
  const char *before; /* for STRUT_KEY_SIGNED */
  const char *letter; /* for STRUT_KEY_DOT; or NULL */
  const char *text;   /* NULL: the item is left out */
} strut_key_item;

/**
 * Lays a key out in lines that fill the width of `box`, or as a column of items where that is 0, from its upper left
 * corner on; longer texts wrap. Draws it if `draw`. Returns the box that it takes.
 */
STRUT_API strut_box strut_draw_key(strut_canvas *canvas, strut_box box, const strut_key_item *items,
                                   size_t count, bool draw);

/**
 * Length of the longest prefix of `text` of at most `most` bytes that splits no UTF-8 character.
 */
STRUT_API int strut_text_bytes(const char *text, int most);
enum { STRUT_FITTED_TEXT = 320 };
/**
 * Copies as much of `text` as fits into `width` by `height` [pt] (0: any height), with an ellipsis
 * where it is cut; no UTF-8 character is split, and lines break at `font.width` only. Returns
 * `fitted`.
 */
STRUT_API const char *strut_text_fit(strut_canvas *canvas, const char *text, strut_font font,
                                     double width, double height, char fitted[STRUT_FITTED_TEXT]);

#endif
