/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the drawing of a structure is made of, below and above its members. For structure.c. */
#ifndef STRUT_ENGINE_OUTPUT_DRAW_STRUCTURE_PARTS_H
#define STRUT_ENGINE_OUTPUT_DRAW_STRUCTURE_PARTS_H

#include "engine/output/draw/canvas.h"
#include "engine/output/draw/structure.h"

typedef struct strut_drawing {
  const strut_window *window;
  const strut_model *model;
  const double *q;
  const strut_structure_style *style;
  double thin, opacity;
} strut_drawing;

/** The longest straight part of a member on the page, where its name and its stop stand. */
void strut_longest_segment(const strut_window *window, const strut_model *model,
                           const double *positions, size_t member, double longest[2][2]);

/** A circle around a place of the plane, its radius in points. */
void strut_draw_round(strut_canvas *canvas, const strut_drawing *drawing, const double place[2],
                      double radius, const strut_fill *fill, const strut_pen *pen);
/** The colour of all but members and nodes, so opaque. */
strut_colour strut_thing_colour(const strut_drawing *drawing, double alpha);
/** Filled polygons. */
void strut_draw_cells(strut_canvas *canvas, const strut_drawing *drawing);
/** Bodies that may collide, as thick as they are. */
void strut_draw_collisions(strut_canvas *canvas, const strut_drawing *drawing);
/** Hinges, stops that act, distances, feet, and circles of guides. */
void strut_draw_elements(strut_canvas *canvas, const strut_drawing *drawing);

#endif
