/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Which facet of a surface is nearest to a point, and which pieces of a profile are near: by trees of bounds
 * where there are many, with the answers of a search through all of them, ties included.
 */
#ifndef STRUT_ENGINE_MODEL_SURFACE_SEARCH_H
#define STRUT_ENGINE_MODEL_SURFACE_SEARCH_H

#include "engine/base/memory.h"
#include "engine/model/model.h"
#include "engine/model/surfaces.h"

/** Signed distance of a point from the line of a facet [m]. */
static inline double strut_facet_across(const strut_facet *facet, const double p[2]) {
  return (p[0] - facet->point[0]) * facet->axes.normal[0] +
         (p[1] - facet->point[1]) * facet->axes.normal[1];
}

/** Position of a point along a facet, from where that begins [m]. */
static inline double strut_facet_along(const strut_facet *facet, const double p[2]) {
  return (p[0] - facet->point[0]) * facet->axes.tangent[0] +
         (p[1] - facet->point[1]) * facet->axes.tangent[1];
}

/** The point of a facet that is nearest to some point. */
typedef struct strut_facet_foot {
  double at[2], distance; /* [m] */
  bool held;              /* it is an end of the facet */
} strut_facet_foot;

/** The largest signed distance of p from the lines of all facets but `except` (-1: of all); *which: the first
    facet that has it. -INFINITY, and facet 0, where there is none. */
double strut_surface_outermost(const strut_surface *surface, const double p[2], int32_t except,
                               int32_t *which);
/** The first of the facets that are nearest to p, as far as they reach; -1: p is not finite. */
int32_t strut_surface_nearest(const strut_surface *surface, const double p[2],
                              strut_facet_foot *foot);

/** Makes the tree over the facets of a compiled surface, where they are many; false: out of memory. */
bool strut_surface_bound_facets(strut_arena *arena, strut_surface *surface);
/** Makes the tree over the pieces of one profile, likewise, for all of them. */
bool strut_surface_bound_pieces(strut_arena *arena, strut_surface *pieces, size_t count);

/**
 * Contacts from `first` on that are those of one node with all pieces of a long profile, which is searched by
 * a tree; 0 where it begins none.
 */
int32_t strut_contacts_of_profile(const strut_contact_table *contacts, int32_t first);
/** The contact of these whose gap in q is least, the first of several; *gap: that [m]. */
int32_t strut_contacts_lowest(const strut_contact_table *contacts, int32_t first,
                              const double *positions, const strut_ground_motion *motion,
                              double *gap);
/** Of the pieces of a long profile, `first` on, the one whose gap from p is least; its number. */
int32_t strut_surface_lowest(const strut_surface *first, const double p[2], double *gap);
/** strut_contacts_near of all nodes, with no margin; all contacts where there is one straight line at rest. */
int32_t strut_contacts_all_near(const strut_contact_table *contacts, const double *positions,
                                const strut_ground_motion *motion, int32_t *list);

#endif
