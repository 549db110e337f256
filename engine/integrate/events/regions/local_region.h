/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The neighbourhood of some nodes in a large structure, stepped alone while the rest moves as is known.
 *
 * What happens at a node within a step reaches others by members and by the mass matrix. Its reach is the
 * number of neighbours, one after the other, behind which a given part of it is left, by a bound: of n
 * members in a row, j passed by their stiffness and n - j by their damping, remains C(n, j) x^j y^(n-j) / (n
 * + j + 1)!, where x and y are the largest sums of stiffnesses and dampings over a mass, times the step
 * squared and the step; of an entry of the inverse mass matrix (sqrt(c) - 1) / (sqrt(c) + 1), where c bounds
 * its condition after scaling (3 for rods alone). What masses alone pass on is not left out, however far: one
 * solution with the mass matrix of the whole adds it when the region has been stepped. The reach then counts
 * what members would make of that, beyond the region.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_REGIONS_LOCAL_REGION_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_REGIONS_LOCAL_REGION_H

#include "engine/model/mass.h"
#include "engine/model/state.h"

/** Who is next to whom, for all regions of a model. */
typedef struct strut_local_region_map {
  /* of each node, row by row */
  int32_t *member_start, *member;  /* (nodes + 1), (2 members) ascending */
  int32_t *mass_start, *mass_node; /* (nodes + 1); none where masses are not coupled */
  double *mass_value;
  double *diagonal;       /* (nodes) [kg]; 0 of supported ones */
  int32_t *rank, *ranked; /* (nodes) neighbours have close ranks; node of each rank */
  int32_t *contact;       /* (nodes) or -1 */
} strut_local_region_map;

/**
 * Bounds for what one neighbour passes on to the next: by stiffness over h^2, by damping over h, by an entry
 * of the inverse mass matrix (0 where masses are not coupled).
 */
typedef struct strut_local_passing {
  double stiffness, damping, mass; /* [1/s^2], [1/s], [1] */
} strut_local_passing;

/** A mass between a node of a region and one of its halo. */
typedef struct strut_local_coupling {
  int32_t own, halo; /* indices in `node` and `halo` */
  double mass;
} strut_local_coupling;

/** Arrays have space for the whole structure; counts are those of the present region. */
typedef struct strut_local_region {
  int32_t node_count, halo_count, member_count, contact_count;
  int32_t *node;    /* by rank */
  int32_t *halo;    /* nodes outside it that members or masses join to it; supported ones too */
  int32_t *member;  /* with at least one end in it, ascending */
  int32_t *contact; /* of its nodes, ascending */
  int32_t *slot;    /* (nodes) 1 + index in `node`; -1 - index in `halo`; 0 elsewhere */
  uint8_t *layer;   /* (nodes) 1 + neighbours from what it was grown from; 0 elsewhere */
  /* M of its nodes = L D L', row by row from the first entry that is not 0; not where masses are not coupled */
  size_t *row, room; /* (node_count + 1) begins of rows; space for so many entries */
  int32_t *first;
  double *lower;
  double *inverse; /* (node_count) of D */
  strut_local_coupling *coupling;
  int32_t coupling_count;
  double *pair;   /* (node_count, 2) scratch */
  double *halo_a; /* (halo_count, 2) accelerations of the halo, which its masses feel [m/s^2] */
  uint8_t *seen;  /* (nodes, members or contacts) marks, 0 between uses */
  int32_t *queue, *stack; /* (nodes) scratch of the growth */
  int reach;              /* neighbours up to which it grows */
} strut_local_region;

/** A region grows so far beyond the reach: what happens up to there from where it was grown keeps the bound. */
enum { STRUT_LOCAL_MARGIN = 1 };

/** Can regions of this model be stepped alone? */
bool strut_local_region_possible(const strut_model *model);
/** Both in the arena. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_local_region_map_create(const strut_model *model, strut_arena *arena,
                                           strut_local_region_map *map);
strut_status strut_local_region_create(const strut_model *model, const strut_local_region_map *map,
                                       strut_arena *arena, strut_local_region *region);
/**
 * The region about `start`, and about every node with seed[node] that is in it: those get joined[node] = 1.
 * False: its masses cannot be factored in the space that there is.
 */
bool strut_local_region_grow(const strut_model *model, const strut_local_region_map *map,
                             int32_t start, const uint8_t *seed, uint8_t *joined,
                             strut_local_region *region);
strut_status strut_local_passing_find(const strut_model *model, const strut_local_region_map *map,
                                      strut_local_passing *passing);
/** The reach for a part `left` and steps of h; 0: too far for regions to pay. */
int strut_local_reach(const strut_local_passing *passing, double h, double left);
/** Is a node of it so far from where it was grown that what happens there reaches beyond the region? */
bool strut_local_region_is_far(const strut_local_region *region, int32_t node);
/** region->pair, forces on its nodes, become accelerations, with the halo at rest. */
void strut_local_region_solve(const strut_model *model, const strut_local_region *region);
/** a = M^-1 (force - M' halo_a) at the region's nodes; arrays are those of the whole structure. */
void strut_local_region_divide(const strut_model *model, const strut_local_region *region,
                               const double *force, double *a);
/**
 * Adds to `force` (length) what a change (node_count, 2) of the motion of its nodes does to the halo by its
 * masses.
 */
void strut_local_region_pass_on(const strut_local_region *region, const double *change,
                                double *force);

#endif
