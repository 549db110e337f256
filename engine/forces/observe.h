/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Values of observables (engine/scene/observables.h): of the state, for recording and measuring, and at positions and
 * velocities within a step, for sensors.
 */
#pragma once

#include "engine/forces/forces.h"
#include "engine/model/model.h"
#include "engine/model/state.h"

/** What observables are taken of. */
typedef struct strut_instant {
  const strut_model *model;
  const strut_state *state;
  const double *q, *v;
  double time; /* without the state's time_offset [s] */
  bool
      sensed; /* within a step: forces without those that hold rigid bars, and without those of actuators */
  /* what strut_instant_show has computed */
  strut_energies stored;                /* [J] */
  double *spin;                         /* (nodes) parts of the angular momentum [kg m^2/s] */
  double *momentum, *relative_velocity; /* (nodes, 2) scratch */
  /* of the observable that was taken last */
  double size;    /* magnitude of the terms that it sums; below 0: that of its value */
  int32_t branch; /* which of several it is, such as the largest force */
  int32_t loaded; /* the member of the largest force, or -1 */
} strut_instant;

/** A value, and its rate where that follows from positions and velocities alone, else 0. */
typedef struct strut_observed {
  double value, rate;
} strut_observed;

/** Takes the observable of an item, by strut_column_find. */
typedef strut_observed strut_observe(strut_instant *instant, int32_t item, int32_t other);
STRUT_API strut_observe *strut_observe_at(strut_column_kind kind);

/** The value of an item of the scene. */
STRUT_API double strut_observe_item(strut_instant *instant, strut_column_kind kind, int32_t item);

/** Allocates in the arena; false: memory is out. */
bool strut_instant_create(const strut_model *model, strut_arena *arena, strut_instant *instant);
/**
 * From now on the instant shows this state at time t [s] without its time_offset; `needs` has a bit for each
 * strut_observed_need. Updates forces and rest lengths of the state, which follow from q, v and t.
 */
void strut_instant_show(strut_instant *instant, const strut_state *state, unsigned needs, double t);
