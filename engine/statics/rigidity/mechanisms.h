/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Motions that stretch no member to first order: rigid-body, infinitesimal and finite ones.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_MECHANISMS_H
#define STRUT_ENGINE_STATICS_RIGIDITY_MECHANISMS_H

#include "engine/statics/rigidity/self_stress.h"

typedef enum strut_motion_kind {
  STRUT_MOTION_RIGID_BODY,    /* of the whole: what the supports leave of three */
  STRUT_MOTION_INFINITESIMAL, /* lengths change at second order: some self-stress stiffens it */
  STRUT_MOTION_FINITE,        /* lengths stay: followed, or no state of self-stress can stop it */
  STRUT_MOTION_UNDECIDED
} strut_motion_kind;

/** "rigid-body", "infinitesimal", "finite", "undecided". */
STRUT_API const char *strut_motion_kind_name(strut_motion_kind kind);

typedef struct strut_mechanism {
  strut_motion_kind kind;
  const double *motion; /* (rows) free coordinates; unit vector */
  double stiffness;     /* by the forces in the shape [N/m]; NAN where these do not balance */
  double stress_form;   /* the same by strut_mechanisms.stiffener [1/m]; NAN without one */
  double moved;         /* followed: largest change of a distance between nodes [m]; NAN: not */
  double strain;        /* and the largest relative change of a member's length on the way */
} strut_mechanism;

typedef struct strut_mechanisms {
  int32_t count; /* f */
  int32_t rigid_body, infinitesimal, finite, undecided;
  strut_mechanism *list; /* (count) rigid-body ones first; NULL: none or too many */
  bool by_forces;        /* the forces in the shape stiffen all that are not rigid-body */
  double
      *stiffener; /* (members, hinges) a self-stress that does, largest force 1; NULL: none found */
  bool stiffener_pulls; /* and presses no cable */
} strut_mechanisms;

/**
 * Sorts the motions of A at q (length). force (members) [N] are those in the shape, or NULL where
 * they do not balance. A mechanism is infinitesimal where a self-stress has a positive form
 * on all that are not rigid-body (prestress stability, Connelly and Whiteley 1996); finite where it
 * can be walked along by a tenth of the structure's size with all lengths kept. All in the arena.
 * STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_mechanisms_find(const strut_model *model,
                                             const strut_equilibrium_matrix *a, const double *q,
                                             const strut_null_spaces *spaces,
                                             const strut_self_stress *states, const double *force,
                                             strut_arena *arena, strut_mechanisms *mechanisms);

#endif
