/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A run to a wanted accuracy: the method is chosen by what it costs, and the answer is checked.
 */
#ifndef STRUT_ENGINE_RUN_ACCURACY_H
#define STRUT_ENGINE_RUN_ACCURACY_H

#include "engine/run/simulate.h"

/**
 * Runs the scene's experiment so that the measured velocity is within experiment.accuracy, relative
 * to it or, where it is small, to a thousandth of the structure's size per period (or per run).
 *
 * A run by periods whose motion becomes steady is made with the cheapest method, and its orbit is
 * then corrected by an accurate one (orbit.h); any other run is repeated, finer each time, until
 * two agree. summary->accuracy says what was done, why, what it cost to check, and the error to
 * expect; `kept` is false where the accuracy was not reached. The scene's own method and step are not
 * used. Results and errors as strut_simulate.
 */
STRUT_API strut_status strut_simulate_accurately(const strut_scene *scene,
                                                 const strut_run_options *options,
                                                 strut_summary *summary, strut_error *error);

/* accuracy_orbit.c, accuracy_plain.c: the two ways. Share what follows. */

typedef struct strut_accuracy {
  const strut_scene *scene;
  const strut_run_options *options;
  strut_experiment cheap; /* the cheapest method with the largest step it should take */
  double wanted, scale;   /* [1], [m/s] */
  int64_t spent;          /* evaluations of the forces that the answer does not rest on */
  strut_summary *summary;
  strut_error *error;
} strut_accuracy;

/** The run of a scene with another experiment. */
strut_status strut_accuracy_run(const strut_accuracy *a, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary);
/** By the steady orbit. *done is false where there is none to be had. */
strut_status strut_accuracy_by_orbit(strut_accuracy *a, bool *done);
/** By runs that are ever finer. */
strut_status strut_accuracy_by_repetition(strut_accuracy *a);

#endif
