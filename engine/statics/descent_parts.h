/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the descent asks of the Hessian, answered by eigenvectors or by a sparse factor.
 */
#ifndef STRUT_ENGINE_STATICS_DESCENT_PARTS_H
#define STRUT_ENGINE_STATICS_DESCENT_PARTS_H

#include "engine/statics/minimise.h"

/** A step and what the quadratic model makes of it. */
typedef struct strut_model_step {
  double length;    /* |s| [m] */
  double reduction; /* -(g's + s'Hs/2) [J] */
} strut_model_step;

/** The two ways to take a Hessian apart. Rows are those of the potential; all arrays are (n). */
typedef struct strut_curvature {
  /** Takes the Hessian at q apart; false: not finite, or out of memory. */
  bool (*look)(void *room, const double *q);
  /** The lowest point of the model within |s| <= radius. still [N]: a force that rounding explains. */
  strut_model_step (*descend)(void *room, const double *g, double radius, double still, double *s);
  /**
   * Adds to the step that descend gave last what brings the stiff modes back into balance, whose
   * gradient at its end is g: the way bends with every bar that turns. False: there are none.
   */
  bool (*straighten)(void *room, const double *g, double *s);
  /** The Newton step, directions without stiffness left out; its length. */
  double (*newton)(void *room, const double *g, double *s);
  /** The unit direction of most negative curvature; false where none is negative beyond rounding. */
  bool (*ridge)(void *room, double *s);
  void (*free)(void *room);
} strut_curvature;

extern const strut_curvature strut_curvature_dense, strut_curvature_sparse;
/** Rooms for the two; NULL: out of memory. */
void *strut_curvature_dense_create(const strut_potential *potential);
void *strut_curvature_sparse_create(const strut_potential *potential);

/** How many Hessians it has taken apart so far: a measure of its work. */
int64_t strut_minimiser_hessian_count(const strut_minimiser *minimiser);

/**
 * From a saddle at q down one side (+1 or -1) of direction (length), by steps short enough to stay in
 * the valley they began in; true if q has come to a minimum.
 */
bool strut_descend_along(strut_minimiser *minimiser, const double *direction, double side,
                         double *q);

/** From q by short steps, which pass over no well that is wider than a hundredth of the structure. */
strut_descent_end strut_descend_gently(strut_minimiser *minimiser, double *q);

#endif
