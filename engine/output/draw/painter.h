/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The painter of charts and of views, panels with structures. For figure.c. */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_PAINTER_H
#define STRUT_ENGINE_OUTPUT_DRAW_PAINTER_H

#include "engine/base/memory.h"
#include "engine/output/draw/figure.h"

/** Settles ranges and scales that are not given, the same for all the panels. False: out of memory. */
bool strut_panels_settle(strut_panel *panels, size_t count, strut_arena *arena);
/**
 * Appends what a panel's legend says, unless it is there already. Returns how many items there are then; `items` has
 * room for strut_panel_legend_room more.
 */
size_t strut_panel_legend(const strut_panel *panel, strut_key_item *items, size_t count);
size_t strut_panel_legend_room(const strut_panel *panel);
/** Draws a chart with settled axes in a box, with its legend or without. False: out of memory. */
bool strut_draw_chart(strut_canvas *canvas, strut_box box, const strut_panel *panel, bool legend,
                      strut_arena *arena);
/** Limits of a map's cells along x or y. */
void strut_map_limits(const double *at, size_t count, double limits[2]);

/**
 * Thins (count) points of ascending x in place to at most four in each `grain` of x, which leaves
 * the drawn line unchanged. Returns the number kept; points in another order are all kept.
 */
size_t strut_thin(double (*points)[2], size_t count, double grain);

/** Draws shapes, trails and marks of a view into a box: that of all its window, margins included. */
strut_window strut_draw_view(strut_canvas *canvas, strut_box box, const strut_panel *view);
/**
 * Lays (count) panels with views out from the upper left corner of `box` on, as many to a row as make the structures
 * largest, with the figure's foot below if `foot`; draws them if `draw`. Returns the height [pt].
 */
double strut_draw_views(strut_canvas *canvas, strut_box box, const strut_figure *figure,
                        const strut_panel *panels, size_t count, bool foot, bool draw);
/**
 * The figure's scale bar (of a window, if there is one), keys and scale of colours; draws them if `draw`.
 * Returns their height [pt].
 */
double strut_draw_foot(strut_canvas *canvas, strut_box box, const strut_figure *figure,
                       const strut_window *window, bool draw);

#endif
