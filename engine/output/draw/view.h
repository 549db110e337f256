/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The painter of views, panels with structures. For figure.c. */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_VIEW_H
#define STRUT_ENGINE_OUTPUT_DRAW_VIEW_H

#include "engine/output/draw/figure.h"

/** Draws shapes, trails and marks of a view into a box: that of all its window, margins included. */
strut_window strut_draw_view(strut_canvas *canvas, strut_box box, const strut_panel *view);
/**
 * Lays (count) panels with views out from the upper left corner of `box` on, as many to a row as make the structures
 * largest, with the figure's foot below if `foot`; draws them if `draw`. Returns the height [pt].
 */
double strut_draw_views(strut_canvas *canvas, strut_box box, const strut_figure *figure,
                        const strut_panel *panels, size_t count, bool foot, bool draw);
/** A mark's dot or ring at a place on the page [pt], and its text, which stays inside. */
void strut_draw_mark(strut_canvas *canvas, strut_box inside, const double at[2],
                     const strut_mark *mark);
/**
 * The figure's scale bar (of a window, if there is one), keys and scale of colours; draws them if `draw`.
 * Returns their height [pt].
 */
double strut_draw_foot(strut_canvas *canvas, strut_box box, const strut_figure *figure,
                       const strut_window *window, bool draw);

#endif
