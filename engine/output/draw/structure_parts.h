/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the rooms that draw structures share.
 */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_STRUCTURE_PARTS_H
#define STRUT_ENGINE_OUTPUT_DRAW_STRUCTURE_PARTS_H

#include "engine/output/draw/structure.h"

/** Where a member's two ends are on the page [pt]. */
void strut_member_ends(const strut_window *window, const strut_model *model, const double *q,
                       size_t member, double ends[2][2]);
/** Depth of the hatching below the ground's line [pt]. */
#define STRUT_GROUND_DEPTH 7.0
/** Where the ground's line enters and leaves the window's neighbourhood [pt]. */
void strut_ground_line(const strut_window *window, const strut_model *model, double ends[2][2]);
/** Triangles under pinned nodes, rolling ones under nodes held in one direction. */
void strut_draw_supports(strut_canvas *canvas, const strut_window *window, const strut_model *model,
                         const double *q, double size, double opacity);

#endif
