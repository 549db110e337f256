/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Dense output: the state at any instant within a piece of the motion.
 *
 * Positions are the polynomials of fifth order through positions, velocities and accelerations at both
 * ends, velocities and works the cubics through their values and rates. Contact forces follow by
 * their own law, in the modes that a method with events has frozen.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_DENSE_H
#define STRUT_ENGINE_RUN_MEASURE_DENSE_H

#include "engine/integrate/observer.h"

typedef struct strut_dense {
  const strut_model *model;
  double *q, *v;             /* (length) at the instant */
  double *begin_q, *begin_v; /* (length) at the begin of a step of the grid */
  double *a[2];              /* (length) accelerations at its ends */
  double begin_work[STRUT_POWER_ROOM], power[2][STRUT_POWER_ROOM];
  /* what the state has at the end of the piece, while it is elsewhere */
  double *end_q, *end_v;
  double end_work[STRUT_POWER_ROOM];
  bool away;   /* the state has been elsewhere since strut_dense_return */
  bool coarse; /* positions and velocities by polynomials of one order less */
} strut_dense;

/** Allocates in the arena. False: out of memory. */
bool strut_dense_create(const strut_model *model, strut_arena *arena, strut_dense *dense);
/** Keeps the state as the begin of the next step of a method without events. */
void strut_dense_keep(strut_dense *dense, const strut_state *state);
/** The piece from the kept state to the present one, h apart; accelerations are computed when they
    are first needed. Its begin is at t [s]. */
strut_motion_piece strut_dense_step(strut_dense *dense, const strut_state *state, double t,
                                    double h);
/**
 * Moves the state to the fraction `s` of the piece. Returns the time there, without time_offset [s].
 * Just after the begin where s is 0.
 */
double strut_dense_place(strut_dense *dense, strut_state *state, strut_motion_piece *piece,
                         double s);
/** Moves the state back to the end of the piece, with all that follows from it as before. */
void strut_dense_return(strut_dense *dense, strut_state *state, const strut_motion_piece *piece);

#endif
