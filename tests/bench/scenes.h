/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Scenes of the bench, ready to step: the paper's crawler, and chains of X-frames. */
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

/**
 * A chain of `members` / 5 X-frames (at least one), each two crossed bars and three cables and two
 * nodes more than the one before; the first two nodes are fixed. The cables are shorter than drawn,
 * so it vibrates. By rk4 with 0.1 ms; false as above.
 */
bool bench_chain(bench_motion *m, size_t members, strut_mass_model mass);
void bench_free(bench_motion *m);
