/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Scenes of the bench, ready to step, and a clock. */
#pragma once

#include "engine/integrate/integrator.h"

typedef struct bench_motion {
  strut_setup setup;
  strut_model *model;
  strut_state *state;
  const strut_integrator *method;
  void *workspace;
} bench_motion;

/** Reads a file below the project's folder; set: "name=value" of parameters, at most 3, NULL after the last. */
strut_status bench_read(strut_setup *setup, const char *file, const char *const *set,
                        strut_error *error);

/**
 * The crawler of Table 1 at state I as drawn, 10 Hz, 0.1 mm, friction 0.1, every node may touch the ground.
 * False, with a message on stderr, where it cannot be made.
 */
bool bench_crawler(bench_motion *m, const char *method, double step);
void bench_free(bench_motion *m);

/** CPU time of this thread [s]. */
double bench_seconds(void);
