/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A compiled scene on its way through time: model, state and a method's workspace in one. With it come
 * scenes made by hand and assertions about numbers.
 */
#pragma once

#include "engine/base/memory.h"
#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "engine/run/simulate.h"
#include "engine/scene/experiment.h"
#include "tests/support/build.h"
#include "tests/support/check.h"

FREED_BY(strut_model_free, strut_model)
FREED_BY(strut_state_free, strut_state)

typedef struct motion {
  strut_model *model;
  strut_state *state;
  const strut_integrator *method;
  void *workspace;
  double step; /* [s] */
} motion;

/** Checks and compiles the scene and stands at its start; whatever fails, fails the test. */
motion motion_begin(const strut_scene *scene, double step);
/** The same by the method of that name, with the settings of the experiment. */
motion motion_begin_by(const strut_setup *setup, const char *method, double step);
void motion_steps(motion *m, int64_t count);
void motion_free(motion *m);

/** Lengths [m] and forces [N] (tension positive) of all members, as they are recorded. */
void motion_members(const strut_model *model, const strut_state *state, double *length,
                    double *force);

/** Checks and compiles; whatever fails, fails the test. Free it with strut_model_free. */
strut_model *motion_compile(const strut_scene *scene);

/** Compiles and runs the experiment; free the summary, whatever comes of it. */
strut_status motion_try(const strut_setup *setup, strut_run_options options, strut_summary *summary,
                        strut_error *error);
/** The same with default options, and expects STRUT_OK. */
strut_summary motion_simulate(const strut_setup *setup);
/** Sets the experiment: step and duration [s], and the method. */
void motion_experiment(strut_setup *setup, double step, double duration);
void motion_experiment_by(strut_setup *setup, double step, double duration, const char *method);
