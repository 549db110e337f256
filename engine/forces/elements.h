/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Forces, energy and stiffness of elements: each a strain e with a law, written once for all pairs.
 *
 * With t the force of the law and b = de/dq: the nodes feel -t b, the tangent stiffness is
 * (dt/de) b b' + t d2e/dq2, the damping is c b b', and the drive's power is -t de0/dt. An element that
 * carries one sign only acts where x = e - e0 and t both have that sign. `rest` (slots) holds natural
 * strains: the model's own, or a state's driven ones.
 */
#pragma once

#include "engine/model/state.h"

/** Entries of an element's gradient at most. */
enum { STRUT_MOST_GRADIENT = 2 * STRUT_MOST_ELEMENT_NODES };

/** An element in a configuration. */
typedef struct strut_element_pose {
  double strain, natural; /* e, e0 */
  double force;           /* t of the law [N], [N m]; 0 where the element does not act */
  double energy, slope;   /* [J], dt/de; 0 where it does not act */
  bool acts;
  double b[STRUT_MOST_GRADIENT]; /* (2 nodes) de/dq */
} strut_element_pose;

/** Natural strain of an element. */
static inline double strut_element_natural(const strut_element *element, const double *rest) {
  return element->slot >= 0 ? rest[element->slot] : element->natural;
}

/** The piece of a curve on which an element is at x, by what `rest` remembers; -1: by x alone. */
static inline int strut_element_piece(const strut_element *element, const double *rest, double x) {
  if (element->law != STRUT_LAW_FOLDING) return -1;
  return strut_folding_follow(element->numbers.curve, (int)rest[element->slot + STRUT_CURVE_PIECE],
                              x, NULL);
}

/**
 * The element at positions q, without dampers. turn: the value near which an angle is taken; NAN: its
 * natural one.
 */
STRUT_API void strut_element_evaluate(const strut_model *model, int32_t element, const double *rest,
                                      const double *q, double turn, strut_element_pose *pose);
/** Strain at q, near `turn` where it is an angle, and its gradient b. */
double strut_element_strain(const strut_model *model, int32_t element, const double *q, double turn,
                            double *b);
/** de/dt at velocities v, for a pose of the same element. */
double strut_element_rate(const strut_model *model, int32_t element, const strut_element_pose *pose,
                          const double *velocity);
/** h (2 nodes, 2 nodes) += t d2e/dq2. */
void strut_element_bend(const strut_model *model, int32_t element, const double *q, double t,
                        double *h);
/**
 * Adds the forces of all elements at q and v to `force`, with the state's natural strains and frozen
 * modes; with the state's balance their powers.
 */
void strut_elements_add_forces(const strut_model *model, const strut_state *state, const double *q,
                               const double *velocity, double *force);
/**
 * After a step has been accepted: the angles of hinges at the state's positions are those near which later ones are
 * taken, so that they are continuous over whole turns.
 */
void strut_elements_keep_turns(const strut_model *model, strut_state *state);
/** Elastic energy of all elements but loads [J], or those `near`; turn: see strut_element_evaluate, or NULL. */
double strut_elements_energy(const strut_model *model, const double *rest, const double *turn,
                             const double *q, const strut_nearby *near);
/** Elastic force of member j at q, of its spring or of its elements, tension positive [N]. */
STRUT_API double strut_member_elastic_tension(const strut_model *model, const double *rest,
                                              int32_t member, const double *q);
/** Length of member j at q, over its guides [m]. */
STRUT_API double strut_member_path_length(const strut_model *model, int32_t member,
                                          const double *q);

/** A cell with next to no area left, or turned over, or -1: it encloses nothing any more. */
STRUT_API int32_t strut_cell_that_collapsed(const strut_model *model, const double *q);
/** A member whose stiffness follows its rest length, next to none of which is left, or -1. */
STRUT_API int32_t strut_member_that_is_wound_in(const strut_model *model, const double *rest);
/** Strain beyond the natural one, its rate, and the force as if the element acted. */
typedef struct strut_element_motion {
  double stretch, rate, force;
} strut_element_motion;
/** Of an element at q and v, with the state's natural strains and frozen piece. */
strut_element_motion strut_element_move(const strut_model *model, const strut_state *state,
                                        int32_t element, const double *q, const double *velocity);

/** Force of an element with its damper at positions q and velocities v, with the state's natural strains; `pose`
    is filled as well. */
double strut_element_measure_at(const strut_model *model, const strut_state *state, int32_t element,
                                const double *q, const double *velocity, strut_element_pose *pose);
