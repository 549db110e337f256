/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the two halves of a path's picture share: the path put in order, and its places to stop at.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_PATH_FIGURE_PARTS_H
#define STRUT_ENGINE_OUTPUT_FIGURES_PATH_FIGURE_PARTS_H

#include "engine/output/draw/canvas.h"
#include "engine/statics/path/path.h"

enum { STRUT_PATH_STOPS = 10, STRUT_PATH_STOP_TEXT = 160 };

/** A point or an event of the path. */
typedef struct strut_path_vertex {
  double value, motion; /* the parameter [its unit]; what moves [m] */
  double height;        /* what the curve shows of it: a load [N], a reaction [N], or the value */
  bool unstable;        /* what leads from here to the next */
  const double *q, *force; /* (length) [m], (members) [N] */
} strut_path_vertex;

/** A shape that is drawn: the beginning, events, the end. */
typedef struct strut_path_stop {
  size_t vertex;
  strut_colour colour;
  char letter[4]; /* of an event; else empty */
  char text[STRUT_PATH_STOP_TEXT];
} strut_path_stop;

typedef struct strut_path_picture {
  strut_canvas *canvas;
  const strut_model *model;
  const strut_path *path;
  bool upright;       /* the motion is drawn upwards, over the parameter */
  int32_t coordinate; /* index into q of what the curve is drawn over */
  double sign;        /* 1 or -1: the way that it goes */
  size_t count, stop_count;
  strut_path_vertex *vertices; /* (count) */
  strut_path_stop stops[STRUT_PATH_STOPS];
  size_t events_left;  /* that did not get a stop */
  double larger;       /* motion is drawn so many times larger than it is */
  double *shape;       /* (length) for a shape on its way to the page */
  double *taut;        /* (members) its cables: 0 where slack */
  double (*points)[2]; /* (count) likewise for lines */
  size_t other_count, other_room;
  double (*others)[2]; /* (other_room, 2) lines that names keep off [pt] */
} strut_path_picture;

/** What is followed over the motion, or the motion over it, in a box. */
void strut_path_draw_curve(strut_path_picture *picture, strut_box box);
/** The shapes of all stops over each other. */
void strut_path_draw_shapes(strut_path_picture *picture, strut_box box);
/** Height [pt] that the shapes take where they are `width` [pt] wide. */
double strut_path_shapes_height(strut_path_picture *picture, double width);
/** Whether a load of the scene belongs to what grows along the path. */
bool strut_path_load_grows(const strut_path *path, const strut_load *load);

#endif
