/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Measured quantities: columns of the motion, the programs over them, and their values over a window.
 */
#pragma once

#include "engine/base/status.h"
#include "engine/forces/observe.h"
#include "engine/model/state.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"
#include "engine/scene/quantity.h"

/* ---- columns of the motion, of which measured quantities are made, evaluated at a state ---- */

/** Distinct columns with their values now and over the window. */
typedef struct strut_columns {
  strut_instant instant;
  unsigned needs; /* bits of strut_observed_need */
  size_t count;
  strut_column *column;    /* (count) as their functions know them: strut_column_find */
  strut_observe **observe; /* (count) */
  double *value;           /* (count) now, SI */
  double *least, *most;    /* (count) over the window */
  double *largest;         /* (count) largest absolute value of the terms that it sums */
  int32_t *branch;         /* (count) which of several values one is, such as the largest force */
  double fastest;          /* largest speed of a node in the window [m/s]; only with `speeds` */
  bool speeds;    /* some column is a velocity, whose rounding scales with the node speeds */
  int32_t loaded; /* member of the largest force in the window; -1: none */
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
void strut_columns_evaluate(strut_columns *columns, const strut_state *state, double t);
/** Starts the window at the present values. Angles are within half a turn of 0 here. */
void strut_columns_begin(strut_columns *columns, const strut_state *state, double t);
/** Range of a column, or of the terms that it sums, in the window, SI. */
double strut_columns_span(const strut_columns *columns, size_t index);
/** Rounding error of a column in the window, SI. */
double strut_columns_noise(const strut_columns *columns, size_t index);

/* ---- the postfix program of a measured quantity; see engine/scene/quantity.h ---- */

/**
 * Evaluates a program; `index` (length): position of each column in `value`. *branch, if not NULL, gathers which side
 * of each kink (abs, min, max) and which step of each jump (floor, ...) the operands are on: where it changes between
 * two instants, there is a kink or a jump between them.
 */
STRUT_API double strut_quantity_program_evaluate(const strut_quantity_definition *definition,
                                                 const size_t *index, const double *value,
                                                 double *stack, uint64_t *branch);

/** Adds a branch to those gathered so far. */
static inline uint64_t strut_gather_branch(uint64_t all, uint64_t one) {
  return (all ^ one) * 1099511628211u;
}

/** Size of a term, its range, and two uncertainties that propagate alike. */
typedef struct strut_magnitude {
  double size;      /* largest absolute value of the terms */
  double low, high; /* between which its values lie */
  double span;      /* range */
  double noise;     /* rounding error */
  double still;     /* that where the value is at most 1, as counts in an exponential */
} strut_magnitude;

/*
 * Measured quantities of a run: evaluated over the pieces of the motion in the window, between their
 * ends too, and reduced over it and over each of its periods (meter.h).
 *
 * The mean of a single velocity, or of the rate of a length, is displacement over time.
 */

typedef struct strut_quantities strut_quantities;

/** Marks that divide the window: see measure.h. */
typedef struct strut_marks {
  double step;        /* dt [s] */
  double offset;      /* of the grid, see time_grid.h [s] */
  size_t count;       /* of marks */
  const double *time; /* (count) [s] */
  double *value; /* (count, quantities) filled with the values there; NULL: nobody wants them */
} strut_marks;

/** Allocates for the quantities of the scene in the arena; NULL: out of memory. */
strut_quantities *strut_quantities_create(const strut_model *model,
                                          const strut_experiment *experiment, strut_arena *arena);
/** Does a quantity of the scene need works or losses, which only the energy balance has? */
bool strut_quantities_need_balance(const strut_experiment *experiment);
/** Does the quantity tell the member of the largest force? */
STRUT_API bool strut_quantity_names_member(const strut_quantity_definition *definition);
/** Does a quantity depend on the motion between steps? */
bool strut_quantities_need_pieces(const strut_quantities *quantities);
/** The method shows its pieces: from the next window on they are measured instead of the steps of the grid. */
void strut_quantities_observe(strut_quantities *quantities);
/** Samples the values before the first step of a window; the state is observed until its end. */
void strut_quantities_begin(strut_quantities *quantities, const strut_marks *marks,
                            strut_state *state);
/** Measures after each step of `length` [s] from then on, shorter where the run ends. Allocates nothing. */
void strut_quantities_step(strut_quantities *quantities, double length, strut_state *state);
/** Fills summary->measured from the marks passed so far. */
void strut_quantities_finish(strut_quantities *quantities, strut_summary *summary);
