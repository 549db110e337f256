/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A run to a wanted accuracy: the method is chosen by what it costs, and the answer is checked.
 */
#ifndef STRUT_ENGINE_RUN_ACCURACY_ACCURACY_H
#define STRUT_ENGINE_RUN_ACCURACY_ACCURACY_H

#include "engine/run/simulate.h"

/**
 * Runs an experiment so that the measured velocity is within experiment.accuracy, relative
 * to it or, where it is small, to a thousandth of the structure's size per period (or per run).
 *
 * The velocity is the mean over the experiment's window, or, with experiment.steady, that of the steady
 * motion. A run by periods whose motion becomes steady long before its window is made with the
 * cheapest method, and its orbit is then corrected by an accurate one (orbit.h). Any other run is made
 * with the cheapest method and with one of error control, then with ever smaller tolerances, until two
 * agree; rigid bars with ever smaller steps. Where there is no ground and stiff members hold explicit
 * steps far below the motion, implicit midpoint comes first (accuracy_midpoint.c). summary->accuracy says what was done, why, what it cost
 * to check, and the error to expect; `kept` is false where the accuracy was not reached. The
 * experiment's own method and step are not used. Results and errors as strut_simulate.
 */
STRUT_API strut_status strut_simulate_accurately(const strut_model *model,
                                                 const strut_experiment *experiment,
                                                 const strut_run_options *options,
                                                 strut_summary *summary, strut_error *error);

/* Shared by the strategies in accuracy_midpoint.c, accuracy_orbit.c and accuracy_ladder.c. */

typedef struct strut_accuracy {
  const strut_model *model;    /* of the settled start */
  const strut_scene *scene;    /* model->scene */
  strut_experiment experiment; /* wanted, but that it does not settle */
  const strut_run_options *options;
  strut_experiment cheap; /* the cheapest method with the largest step it should take */
  double wanted, scale;   /* [1], [m/s] */
  bool halving;           /* the scene has one method only: compare it with itself */
  int64_t spent;          /* evaluations of the forces that the answer does not rest on */
  int64_t budget;         /* evaluations that the whole may take */
  int64_t used, allowed;  /* made so far, and how many may be made until the present way gives up */
  strut_summary *summary;
  strut_error *error;
} strut_accuracy;

/** The shortest time in which a signal does something of its own [s]; HUGE_VAL: none. */
double strut_accuracy_signal_time(const strut_scene *scene);
/** Tells whoever shows progress that another part of the work begins. */
void strut_accuracy_begin_phase(const strut_accuracy *a, const char *name);
/** Evaluations that the next run may take, at least 1. */
int64_t strut_accuracy_left(const strut_accuracy *a);
/** The run of a scene with another experiment; STRUT_WORK_LIMIT where it takes more than are left. */
strut_status strut_accuracy_run(strut_accuracy *a, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary);
/**
 * Drive periods in which the motion must have become steady: all where the run ends when it is. Else
 * what is then left of the transient is to be gone when the window begins, hence half of those before.
 */
double strut_accuracy_periods(const strut_accuracy *a);
/** Is the mean over the window that over a steady motion found so? */
bool strut_accuracy_orbit_answers(const strut_accuracy *a, const strut_steady_summary *steady);
/**
 * By implicit midpoint, with half the step again and again until two runs agree, their positions
 * converge as its order says and no motion is left that is too fast for the step and would matter;
 * as long as a run costs less than one by the cheapest explicit method. *done is false where that is
 * not so, or the scene is none for it.
 */
strut_status strut_accuracy_by_midpoint(strut_accuracy *a, bool *done);
/** By the steady orbit. *done is false where there is none to be had. */
strut_status strut_accuracy_by_orbit(strut_accuracy *a, bool *done);
/** By runs that are ever finer. */
strut_status strut_accuracy_by_repetition(strut_accuracy *a);

#endif
