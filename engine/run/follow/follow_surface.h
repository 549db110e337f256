/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Periodic motions over two parameters: the surface G(z, p1, p2) = 0.
 *
 * Unknowns are those of follow_system.h and a second parameter, over its range as the first. At a point the
 * surface has a plane of tangents, the null space of [dP - 1, dG/dp1, dG/dp2], which is of full rank at
 * folds, too. Other points are found by Newton's method with two more equations.
 */
#ifndef STRUT_ENGINE_RUN_FOLLOW_SURFACE_H
#define STRUT_ENGINE_RUN_FOLLOW_SURFACE_H

#include "engine/run/follow/follow_system.h"

/** Makes the scene of two values [SI]; strut_setup_free releases it. */
typedef struct strut_follow_plane {
  strut_status (*setup)(void *context, const double values[2], strut_setup *setup,
                        strut_error *error);
  void *context;
} strut_follow_plane;

/** A motion on the surface. */
typedef struct strut_follow_surface_point {
  double value[2];         /* [SI] */
  double *y;               /* (both) */
  double *basis[2];        /* (n + 2) orthonormal tangents; once complete */
  double (*multiplier)[2]; /* (n) the largest first; once complete */
  size_t multipliers;
  double *jacobian; /* (n, n) of the period map, without shifts; once complete */
  bool complete;
} strut_follow_surface_point;

/** Must not move once it is open. Zero-initialise but for what stands before `second`. */
typedef struct strut_follow_surface {
  strut_follow_system s; /* over the first parameter; `scenes` and the range are filled by open */
  strut_follow_plane scenes;
  double low[2], high[2]; /* ranges [SI] */
  double second;          /* value of the second parameter in s [SI] */
  size_t m;               /* n + 2 */
  double *second_column;  /* (n) derivative of G to the second parameter over its range */
  double *f, *x;          /* (n), (m) scratch */
  double *matrix;         /* (m, m) scratch */
  strut_status status;    /* what stops everything */
  strut_error *error;
  strut_arena arena;
} strut_follow_surface;

/**
 * Prepares the equations at two values; s.repeats and what stands before it in s must be filled, and the
 * ranges. As strut_follow_open.
 */
strut_status strut_follow_surface_open(strut_follow_surface *u, const double value[2],
                                       strut_error *error);
void strut_follow_surface_close(strut_follow_surface *u);
/** Makes the model of two values. False: that scene is not valid, or status. */
bool strut_follow_surface_set(strut_follow_surface *u, const double value[2]);
/** An empty point in the arena; NULL: out of memory. */
strut_follow_surface_point *strut_follow_surface_point_new(const strut_follow_surface *u,
                                                           strut_arena *arena);
void strut_follow_surface_point_copy(const strut_follow_surface *u,
                                     const strut_follow_surface_point *from,
                                     strut_follow_surface_point *to);
/** Unknown i of b less that of a, each of order one; i up to n + 1. */
double strut_follow_surface_difference(const strut_follow_surface *u,
                                       const strut_follow_surface_point *a,
                                       const strut_follow_surface_point *b, size_t i);
/** Moves p by a multiple of a direction (n + 2); it is incomplete then. */
void strut_follow_surface_move(const strut_follow_surface *u, strut_follow_surface_point *p,
                               const double *direction, double factor);
/**
 * Newton's method from p to the motion with rows[k] . (p - base) = offset[k]. The derivative of an earlier
 * point serves while it makes the residual fall. False: there is none, or status.
 */
bool strut_follow_surface_correct(strut_follow_surface *u, strut_follow_surface_point *p,
                                  const strut_follow_surface_point *base,
                                  const double *const rows[2], const double offset[2]);
/** Derivative, tangents and multipliers at p, which is a motion. False as above. */
bool strut_follow_surface_complete(strut_follow_surface *u, strut_follow_surface_point *p);

#endif
