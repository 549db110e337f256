/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The motion between the steps of a run, for those who measure it: pieces without an event, one after the other.
 *
 * A method with events hands over each of its steps as it is accepted, before the event at its end
 * changes a mode. Of other methods the measurement makes one piece of each step of the grid.
 */
#ifndef STRUT_ENGINE_INTEGRATE_OBSERVER_H
#define STRUT_ENGINE_INTEGRATE_OBSERVER_H

#include "engine/model/state.h"

/** A piece of the motion; coordinate arrays are (length), pairs are for its begin and its end. */
typedef struct strut_motion_piece {
  double begin, length; /* without the state's time_offset [s] */
  double
      moment; /* signals that jump at the begin have their value from after it so much later [s] */
  const double *q[2], *v[2];        /* [m], [m/s] */
  const double *a[2];               /* [m/s^2]; NULL: of a method without events, see meter.h */
  const double *work[2], *power[2]; /* [J], [W]; only with the energy balance */
  bool smooth;    /* it continues the piece before: nothing has switched or jumped in between */
  bool ends_only; /* velocities have jumped within it: only its ends are known */
  /** Fills the state's held contact forces for an instant within the piece; NULL: they follow from
      q, v and t by the contacts' laws. */
  void (*hold)(const struct strut_motion_piece *piece, const strut_model *model,
               const strut_state *state, double t, const double *positions, const double *velocity);
  void *workspace; /* of the method */
} strut_motion_piece;

/** state->watched.observer; the state is at the end of the piece. */
typedef struct strut_observer {
  void (*see)(struct strut_observer *observer, strut_state *state, const strut_motion_piece *piece);
} strut_observer;

#endif
