/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A compiled scene on its way through time: model, state and a method's workspace in one.
 */
#ifndef STRUT_TESTS_SUPPORT_MOTION_H
#define STRUT_TESTS_SUPPORT_MOTION_H

#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "engine/run/simulate.h"
#include "engine/scene/experiment.h"

typedef struct motion {
  strut_model *model;
  strut_state *state;
  const strut_integrator *method;
  void *workspace;
  double step; /* [s] */
} motion;

/** Checks and compiles the scene and stands at its start; whatever fails, fails the test. */
void motion_begin(motion *m, const strut_scene *scene, double step);
/** The same by the method of that name, with the settings of the experiment. */
void motion_begin_by(motion *m, const strut_setup *setup, const char *method, double step);
void motion_steps(motion *m, int64_t count);
void motion_end(motion *m);

/** Checks and compiles; whatever fails, fails the test. Free it with strut_model_free. */
strut_model *motion_compile(const strut_scene *scene);

/** Runs the experiment with default options and expects STRUT_OK; free the summary. */
strut_summary motion_simulate(const strut_setup *setup);
/** Sets the experiment: step and duration [s]. */
void motion_experiment(strut_setup *setup, double step, double duration);

#endif
