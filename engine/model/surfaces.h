/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Surfaces that nodes may touch, where these are not one straight line at rest.
 *
 * A contact is a node and a surface. Its gap is the signed distance of the node from the surface, negative
 * inside the solid; its normal is the gradient of that distance, its tangent is to the right of the normal,
 * and along the tangent the gap bends by the curvature. Of a line normal and tangent are constant, of a
 * circle they turn with the node, of a piece of a profile they are those of its nearest segment or corner.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "engine/scene/scene.h"

/** Unit vectors along a surface and out of it. */
typedef struct strut_contact_axes {
  double tangent[2], normal[2];
} strut_contact_axes;

/** One straight segment. */
typedef struct strut_facet {
  double point[2]; /* where it begins [m] */
  strut_contact_axes axes;
  double length; /* [m]; INFINITY of a line */
} strut_facet;

/** Bounds of the lines of some facets. */
typedef struct strut_line_bounds {
  double middle[2];                     /* a point among them [m] */
  double normal_low[2], normal_high[2]; /* of their normals */
  double least, most;                   /* signed distances of `middle` from them [m] */
} strut_line_bounds;

/** Bounds of consecutive facets, a node of a tree (pose.h). */
typedef struct strut_facet_bounds {
  double low[2], high[2]; /* as far as they reach [m] */
  strut_line_bounds lines;
} strut_facet_bounds;

/** A line, a circle, or a convex piece of a profile. */
typedef struct strut_surface {
  int32_t ground, piece;                 /* in the scene */
  int32_t facets;                        /* 0: a circle */
  const strut_facet *facet;              /* (facets) in the direction of the profile */
  const strut_facet_bounds *bounds;      /* a tree over them; NULL where they are few */
  int32_t pieces;                        /* of its ground, all of which follow each other */
  const struct strut_piece_index *index; /* trees over these; NULL where they are few */
  double before, beyond;    /* how far the first and the last of them reach further [m] */
  double centre[2], radius; /* of a circle [m] */
  bool inside;              /* its free space is inside */
  double belt_speed;        /* [m/s], along the tangent */
  bool moves;               /* it is shaken */
} strut_surface;

/** Displacement of a shaken ground at some time, with its rates. */
typedef struct strut_ground_motion {
  double place[2], rate[2], bend[2]; /* [m], [m/s], [m/s^2] */
} strut_ground_motion;

/** Where a node is against a surface. */
typedef struct strut_contact_pose {
  strut_contact_axes axes;
  double gap;       /* [m] */
  double curvature; /* second derivative of the gap along the tangent [1/m] */
  int32_t facet;    /* the nearest; 0 of a circle */
} strut_contact_pose;

/** Of a point against a surface at rest. `facet`: the line of this segment alone; -1: the nearest. */
STRUT_API void strut_surface_find(const strut_surface *surface, const double point[2],
                                  int32_t facet, strut_contact_pose *pose);
/** By how much facet `facet` is nearer to a point inside the solid than every other one [m]; negative where
    another is. *nearest: the nearest. */
STRUT_API double strut_surface_margin(const strut_surface *surface, const double point[2],
                                      int32_t facet, int32_t *nearest);

struct strut_model;
/** Compiles the surfaces and contacts of a scene with `grounds`; false: out of memory. */
STRUT_API bool strut_surfaces_compile(struct strut_model *model);
