/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tangent stiffness and damping of a configuration: the matrices of small motions about it.
 */
#ifndef STRUT_ENGINE_FORCES_STIFFNESS_H
#define STRUT_ENGINE_FORCES_STIFFNESS_H

#include "engine/model/sparse.h"
#include "engine/model/state.h"

typedef struct strut_tangent {
  int32_t n;                 /* free coordinates */
  int32_t *coordinate;       /* (n) index into coordinate arrays */
  strut_sparse *stiffness;   /* K = sum c u u' + (t/L)(1 - u u') + ground [N/m] */
  strut_sparse *damping;     /* D = sum k u u' + ground [N s/m] */
  struct strut_rigid *rigid; /* NULL; for who wants the motions that rigid bars leave, rigid.h */
} strut_tangent;

/**
 * Which contacts count as closed. With those two that close all of them, Hunt-Crossley dampers and
 * smooth friction are taken as where half the weight rests on each contact: N chi and mu N / width.
 */
typedef enum strut_closed {
  STRUT_CLOSED_NONE,
  STRUT_CLOSED_TOUCHING, /* those below the ground in q */
  STRUT_CLOSED_ALL,      /* every node that may touch: the stiffest case */
  STRUT_CLOSED_UNDAMPED  /* the same without the ground's dampers, but with smooth friction */
} strut_closed;

/**
 * K and D at positions q (length) with rest lengths `rest` (slots), supports eliminated, members
 * slack there left out. Everything is in the arena. STRUT_OK or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_tangent_assemble(const strut_model *model, const double *q,
                                              const double *rest, strut_closed closed,
                                              strut_arena *arena, strut_tangent *tangent);

#endif
