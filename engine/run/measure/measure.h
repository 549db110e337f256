/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Measures over the window: mean velocity (14) and its spread, contact duty and height. */
#ifndef STRUT_ENGINE_RUN_MEASURE_MEASURE_H
#define STRUT_ENGINE_RUN_MEASURE_MEASURE_H

#include "engine/model/state.h"
#include "engine/run/measure/quantities.h"
#include "engine/run/measure/summary.h"
#include "engine/run/measure/time_grid.h"

/**
 * The window is cut at marks: its ends and, in a run by periods, every period between. The tracked
 * point's x at a mark is found by cubic Hermite interpolation within the step around it, so that
 * periods that the step does not divide are measured exactly.
 */
typedef struct strut_measurement {
  strut_time_grid grid;
  int32_t node;          /* tracked node, or -1: centre of mass */
  double total_mass;     /* [kg] */
  bool by_periods;       /* the run is given in drive periods */
  size_t marks, next;    /* number of marks; the next one to pass */
  size_t capacity;       /* capacity for marks */
  double *time;          /* (marks) [s] */
  double *x;             /* (marks) tracked x there [m] */
  double last_x, last_v; /* tracked point after the latest step */
  int64_t window_steps;
  int64_t *contact_steps; /* (contacts) steps of the window that ended in contact */
  double *max_height;     /* (contacts) [m] */
  double *last_gap,
      *gap_before; /* (contacts) after the latest step, and after the one before it [m] */
  double fastest;  /* largest speed of a node at the start of the window and at marks [m/s] */
  strut_quantities *quantities; /* NULL where the scene names none */
  strut_arena arena;
  double *work;     /* (marks) work of the drives there [J] */
  double last_work; /* and after the latest step [J] */
  double weight;    /* of the structure [N] */
  bool ledger;      /* works are known */
} strut_measurement;

/**
 * Prepares for a run that starts at the time `begin`, without the offset of the grid [s]; capacity:
 * marks that a later window may need. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_measure_create(const strut_model *model, const strut_experiment *experiment,
                                  const strut_time_grid *grid, double begin, size_t capacity,
                                  strut_measurement *measure);
/** x [m] and velocity [m/s] of the tracked point. */
void strut_measure_tracked_point(const strut_model *model, const strut_state *state,
                                 const strut_measurement *measure, double *x, double *v);
/** Starts another window at `begin` [s] over `periods`, within the capacity for marks. */
void strut_measure_window(const strut_model *model, strut_state *state, double begin, double period,
                          size_t periods, strut_measurement *measure);
/** First step number after which strut_measure_step must be called for every step. */
int64_t strut_measure_first_step(const strut_measurement *measure);
/** Samples the tracked point and the quantities before the first measured step. */
void strut_measure_begin(const strut_model *model, strut_state *state, strut_measurement *measure);
/** Measures after each step from then on. Allocates nothing. */
void strut_measure_step(const strut_model *model, const strut_state *state,
                        strut_measurement *measure);
/** As strut_measure_step, with the quantities, which must exist. */
void strut_measure_step_quantities(const strut_model *model, strut_state *state,
                                   strut_measurement *measure);
/** Fills velocity, quantities, spread, window and contacts of the summary from the marks passed so far. */
void strut_measure_finish(const strut_measurement *measure, strut_summary *summary);
/** Is a mean velocity only rounding, as of a symmetric motion? */
bool strut_measure_is_zero(const strut_measurement *measure, double velocity);
void strut_measure_free(strut_measurement *measure);

#endif
