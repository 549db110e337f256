/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A key below a drawing: signs with their meaning, as many in a line as fit; texts cut to fit.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_LEGEND_H
#define STRUT_ENGINE_OUTPUT_DRAW_LEGEND_H

#include "engine/output/draw/canvas.h"

typedef enum strut_key_sign {
  STRUT_KEY_LINE,   /* a short line by `pen` */
  STRUT_KEY_ARROW,  /* an arrow by `pen` */
  STRUT_KEY_DOT,    /* a circle by `fill` and `pen`, with `letter` beside it where there is one */
  STRUT_KEY_SIGNED, /* the colours of strut_palette_signed between the words `before` and `text` */
  STRUT_KEY_WORDS   /* no sign */
} strut_key_sign;

typedef struct strut_key_item {
  strut_key_sign sign;
  strut_pen pen;
  strut_fill fill;
  const char *before; /* for STRUT_KEY_SIGNED */
  const char *letter; /* for STRUT_KEY_DOT; or NULL */
  const char *text;
} strut_key_item;

/** Height [pt] that a key takes in a box so wide. */
STRUT_API double strut_key_height(strut_canvas *canvas, double width, const strut_key_item *items,
                                  size_t count);
/** Draws it from the upper left corner of `box` on; texts longer than a line are cut. */
STRUT_API void strut_draw_key(strut_canvas *canvas, strut_box box, const strut_key_item *items,
                              size_t count);

/** Bytes of the longest beginning of `text`, of at most `most` bytes, that splits no letter. */
STRUT_API int strut_text_bytes(const char *text, int most);
enum { STRUT_FITTED_TEXT = 320 };
/**
 * Copies of `text` what goes into `width` by `height` [pt] (0: any height), ending in an ellipsis
 * where that is not all of it, a letter cut in two left out; lines break at `font.width` only.
 * Returns `fitted`.
 */
STRUT_API const char *strut_text_fit(strut_canvas *canvas, const char *text, strut_font font,
                                     double width, double height, char fitted[STRUT_FITTED_TEXT]);

#endif
