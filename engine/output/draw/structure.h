/* SPDX-License-Identifier: GPL-3.0-or-later */
/** How structures are drawn to scale, and what they take of the plane. */
#pragma once

#include "engine/model/model.h"
#include "engine/output/draw/canvas.h"

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

typedef enum strut_colouring {
  STRUT_COLOUR_KIND,  /* as strut_kind_pen */
  STRUT_COLOUR_FORCE, /* by the scale of signed values up to `limit` */
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
  bool no_nodes, no_supports;
  bool member_names; /* where nodes have theirs */
  double time;       /* at which masses that slide stand where they are drawn [s] */
} strut_structure_style;

/** Is a member driven by an actuator? */
STRUT_API bool strut_member_is_driven(const strut_scene *scene, size_t member);
/** The pen of members of a kind, of its width in large structures; those that are driven in another colour. */
STRUT_API strut_pen strut_kind_pen(strut_member_kind kind, bool driven);
