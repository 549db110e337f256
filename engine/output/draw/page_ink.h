/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How dark a page is, coarsely: what labels keep off. The canvas keeps it up to date.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_PAGE_INK_H
#define STRUT_ENGINE_OUTPUT_DRAW_PAGE_INK_H

#include <math.h>

#include "engine/output/draw/canvas.h"

/**
 * A coordinate [pt] on a grid of 1/64 pt, for decisions of layout: points that differ by rounding get the same one.
 * What is symmetric lies on multiples of 1/2 pt; the rounding changes far from those.
 */
static inline double strut_settle_coordinate(double x) { return floor(64.0 * x + 0.36) / 64.0; }

static inline strut_box strut_settle_box(strut_box b) {
  return (strut_box){strut_settle_coordinate(b.x), strut_settle_coordinate(b.y),
                     strut_settle_coordinate(b.width), strut_settle_coordinate(b.height)};
}

typedef struct strut_page_ink {
  int columns, rows;
  float *dark; /* (rows, columns) of squares of 1 pt: 0 blank to 1 black */
} strut_page_ink;

/** A blank page of that size [pt]. False: out of memory. */
bool strut_page_ink_create(strut_page_ink *ink, double width, double height);
void strut_page_ink_free(strut_page_ink *ink);
/** A line through (count) points, as far as it is inside `clip`. */
void strut_page_ink_line(strut_page_ink *ink, strut_box clip, const double (*points)[2],
                         size_t count, strut_pen pen);
/** A filled polygon, likewise. Light fills hide what is below. */
void strut_page_ink_fill(strut_page_ink *ink, strut_box clip, const double (*points)[2],
                         size_t count, const strut_fill *fill);
/** Sum of darkness inside a box [pt^2]. */
double strut_page_ink_sum(const strut_page_ink *ink, strut_box box);

#endif
