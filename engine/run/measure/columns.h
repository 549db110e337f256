/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Columns of the motion, of which measured quantities are made, evaluated at a state. */
#ifndef STRUT_ENGINE_RUN_MEASURE_COLUMNS_H
#define STRUT_ENGINE_RUN_MEASURE_COLUMNS_H

#include "engine/forces/energy.h"
#include "engine/model/state.h"
#include "engine/scene/quantity.h"

/** Distinct columns with their values now and over the window. */
typedef struct strut_columns {
  const strut_model *model;
  double time;      /* of the latest evaluation, without the state's time_offset [s] */
  double normal[2]; /* of the ground */
  size_t count;
  strut_column *column;  /* (count) `item` of CONTACT indexes the model's contacts, -1: no contact;
                           those of HINGE, CELL, COLLISION index elements */
  double *value;         /* (count) now, SI */
  double *least, *most;  /* (count) over the window */
  double *largest;       /* (count) largest absolute value of the terms that it sums */
  double fastest;        /* largest speed of a node in the window [m/s]; only with `speeds` */
  bool forces;           /* some column needs the forces at the state */
  bool energies;         /* some column needs the stored energies */
  bool speeds;           /* some column is a velocity, whose rounding scales with the node speeds */
  strut_energies stored; /* [J]; with `energies` */
  int32_t loaded_now,
      loaded_most; /* member of the largest force now, and in the window; -1: none */
} strut_columns;

/** Allocates for `most` columns in the arena. False: out of memory. */
bool strut_columns_create(const strut_model *model, size_t most, strut_arena *arena,
                          strut_columns *columns);
/** Returns the index of a column, added if it is new. */
size_t strut_columns_add(strut_columns *columns, strut_column column);
/**
 * Evaluates all columns at the state, at time t [s] without its time_offset; updates forces and rest
 * lengths of the state, which follow from q, v and t. Angles continue from their last value.
 */
void strut_columns_evaluate(strut_columns *columns, strut_state *state, double t);
/** Starts the window at the present values. Angles are within half a turn of 0 here. */
void strut_columns_begin(strut_columns *columns, strut_state *state, double t);
/** Range of a column, or of the terms that it sums, in the window, SI. */
double strut_columns_span(const strut_columns *columns, size_t index);
/** Rounding error of a column in the window, SI. */
double strut_columns_noise(const strut_columns *columns, size_t index);

#endif
