/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Structures drawn to scale: members, nodes, supports, and what they are seen through. */
#pragma once

#include "engine/model/model.h"
#include "engine/output/draw/canvas.h"

/** A window onto the plane: the same scale in x and y, centred in its box. */
typedef struct strut_window {
  strut_box box;    /* on the page [pt] */
  double scale;     /* [pt/m] */
  double left, top; /* the plane's x and y at the box's upper left corner [m] */
} strut_window;

/** Smallest and largest x and y [m]. Starts as strut_bounds_none(). */
typedef struct strut_bounds {
  double low[2], high[2];
} strut_bounds;

STRUT_API strut_bounds strut_bounds_none(void);
/** Widens the bounds to hold a rectangle, or a point as both its corners. */
STRUT_API void strut_bounds_widen(strut_bounds *bounds, const double low[2], const double high[2]);
/** Widens the bounds by all nodes of a shape q (model->length). */
STRUT_API void strut_bounds_add(strut_bounds *bounds, const strut_model *model,
                                const double *positions);
/** The bounds of one shape. */
STRUT_API strut_bounds strut_bounds_of(const strut_model *model, const double *positions);
/** Makes the bounds as large as `size`, about their middle and from their foot on. */
STRUT_API void strut_bounds_share(strut_bounds *bounds, const double size[2]);
/** The larger extent [m]. */
STRUT_API double strut_bounds_extent(const strut_bounds *bounds);
/** The window in `box` that shows the bounds with `margin` [pt] around them for names and arrows. */
STRUT_API strut_window strut_window_fit(strut_box box, strut_bounds bounds, double margin);
/** Maps a point of the plane [m] to the page [pt]. */
STRUT_API void strut_window_point(const strut_window *window, const double position[2],
                                  double point[2]);

typedef enum strut_colouring {
  STRUT_COLOUR_KIND,  /* bars dark, springs and cables by kind */
  STRUT_COLOUR_FORCE, /* strut_palette_signed(value / limit) */
  STRUT_COLOUR_ONE    /* all in `colour` */
} strut_colouring;

/** Style of a structure; zero-initialised: coloured by kind, thick and opaque. */
typedef struct strut_structure_style {
  strut_colouring colouring;
  const double *values; /* (member_count) force [N] or strain; for STRUT_COLOUR_FORCE */
  double limit;         /* largest |value| of the colour scale */
  const double
      *slack_forces;   /* (member_count) [N]: a cable with 0 is drawn slack; NULL: by length */
  strut_colour colour; /* for STRUT_COLOUR_ONE */
  double thinness;     /* widths are divided by 1 + thinness */
  double fringe;       /* added to widths: members dashed, to be seen below the same ones [pt] */
  bool node_names, no_nodes, no_supports;
  bool member_names; /* too, where there are node_names */
  double time;       /* at which masses that slide stand where they are drawn [s] */
} strut_structure_style;

/**
 * Members, nodes, supports, cells (filled), hinges (an arc from arm to arm), stops that act (a bar across
 * their member) and masses on members (filled circles) of the shape q (model->length). Widths adapt to how
 * many there are.
 */
STRUT_API void strut_draw_structure(strut_canvas *canvas, const strut_window *window,
                                    const strut_model *model, const double *positions,
                                    const strut_structure_style *style);
