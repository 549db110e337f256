/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The potential energy of a structure at rest, with its first and second derivatives.
 *
 * Actuators are at rest, loads with a signal left out; friction and damping do not act. Free
 * coordinates are those that neither the scene nor `held` fixes. Positions q are (length) as
 * everywhere; g and the Hessian are over the free coordinates, in their order.
 */
#pragma once

#include "engine/forces/tangent.h"

typedef struct strut_potential {
  const strut_model *model;
  bool ground;           /* contacts push with c_g depth; false: no ground */
  int32_t n;             /* free coordinates */
  int32_t *coordinate;   /* (n) index into coordinate arrays, of tied ones the first */
  int32_t *row_of;       /* (length) row of a coordinate, -1 where held */
  strut_sparse *pattern; /* of the Hessian: every member and contact, touching or not */
  int32_t *place;     /* where the entries of members and contacts stand in the pattern's values */
  double *force;      /* (length) gravity and constant loads [N] */
  double force_scale; /* sum of their magnitudes [N]: "the weight"; 0 without any */
} strut_potential;

/**
 * In `arena`. held: (length) 1 where a static support holds a coordinate besides the scene's own, or NULL.
 * The model must outlive it. STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_potential_create(const strut_model *model, const uint8_t *held,
                                              bool ground, strut_arena *arena,
                                              strut_potential **potential, strut_error *error);
/** Likewise, without ground, of coordinates that move together: rows (length) from 0 to n - 1, -1 where held. */
strut_status strut_potential_create_tied(const strut_model *model, const int32_t *rows, int32_t n,
                                         strut_arena *arena, strut_potential **potential,
                                         strut_error *error);

/** to (length) = q + factor * step (n). */
void strut_potential_move(const strut_potential *potential, const double *step, double factor,
                          const double *q, double *to);

/**
 * The potential that is stationary in equilibrium: (13), minus load times position, plus the energy
 * of the ground's springs.
 */
STRUT_API double strut_potential_value(const strut_potential *potential, const double *q);
/** The same with the angles of couples nearest to those in the shape `near`, on from where they jump by a turn. */
double strut_potential_value_near(const strut_potential *potential, const double *q,
                                  const double *near);

/** (13) alone: elastic energy of the members and gravity's, zero at the origin [J]. */
STRUT_API double strut_potential_energy(const strut_potential *potential, const double *q);

/** g (n) = dE/dq [N]: minus the net force. */
STRUT_API void strut_potential_gradient(const strut_potential *potential, const double *q,
                                        double *gradient);

/** Net force on every coordinate (length), held ones too [N]: minus the support reactions there. */
STRUT_API void strut_potential_force(const strut_potential *potential, const double *q,
                                     double *force);

/**
 * The rounding error that g may carry at best [N]: that of the largest sum of member forces and of
 * stiffness times the last bit of a coordinate. A residual below it is meaningless.
 */
STRUT_API double strut_potential_rounding(const strut_potential *potential, const double *q);

/** To visit all its forces at q that act with more than `least` [N]. */
strut_force_visit strut_potential_visit(const strut_potential *potential, const double *q,
                                        double least);

/** The largest stiffness of a model's members and elements [N/m]; see strut_force_stiffest. */
STRUT_API double strut_stiffest(const strut_model *model);

/**
 * The stiffness [N/m] of a member or a contact, or the largest slope of an element's law near its natural strain, of a
 * hinge over the square of the model's size; number: as in strut_force_begin.
 */
double strut_force_stiffest(const strut_model *model, int32_t number);

/**
 * True of a straight member or element that pushes and has shrunk to less than `share` of its natural length at q, with
 * rest lengths as drawn: it has no direction then, and its force no gradient. force: as strut_force_begin leaves it.
 */
bool strut_force_has_collapsed(const strut_model *model, double share, const double *q,
                               strut_force *force);

/** True where a hinge or a cell has collapsed. */
bool strut_shape_has_collapsed(const strut_model *model, const double *q);

/** A Hessian of zeros to be filled, in the arena; NULL: out of memory. */
STRUT_API strut_sparse *strut_potential_matrix(const strut_potential *potential,
                                               strut_arena *arena);
/** Fills it with the second derivatives at q; slack cables and open contacts give none [N/m]. */
STRUT_API void strut_potential_hessian(const strut_potential *potential, const double *q,
                                       strut_sparse *hessian);
/**
 * The same where cables and contacts that pull or push by no more than `least` [N] count as slack
 * and open: what remains where rounding alone decides.
 */
STRUT_API void strut_potential_hessian_above(const strut_potential *potential, const double *q,
                                             double least, strut_sparse *hessian);

/* The rigid-body motions of a whole structure that its supports leave free. */

/**
 * Fills up to three orthonormal rows (3, n) of `motion` with motions that move no held coordinate, and no contact
 * along its normal where `closed` (contacts), which may be NULL, is 1; returns how many there are.
 */
STRUT_API int32_t strut_rigid_motions(const strut_potential *potential, const double *q,
                                      const uint8_t *closed, double *motion);

/**
 * Finds the combinations of the first `count` rigid motions (count, n) that a stiffness resists with no more than
 * `tolerance` [N/m]: they come first then; returns how many. image (count, n): its products with them, overwritten.
 */
int32_t strut_rigid_motions_free(int32_t n, double tolerance, int32_t count, double *motion,
                                 double *image);
