/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Coming to rest before a run: dynamic relaxation with kinetic damping, and whether the rest is stable.
 *
 * Where a structure settles does not depend on the method, step or accuracy of the run: it is always
 * the classical Runge-Kutta method that settles, with settle.step. Every command that wants the
 * settled start gets it from strut_settle_experiment, hence the same bits.
 */
#ifndef STRUT_ENGINE_RUN_SETTLE_H
#define STRUT_ENGINE_RUN_SETTLE_H

#include <signal.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/model/state.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

/** A model without drives, driven loads, belt and, unless kept, friction, with a state that relaxes. */
typedef struct strut_relaxation {
  strut_scene scene;
  const strut_experiment *experiment;
  strut_model *model; /* of it */
  strut_state *state;
  const struct strut_integrator *method;
  void *workspace;
  double *acceleration; /* (length) */
  double step;          /* [s] */
  double time;          /* simulated so far [s] */
  int64_t evaluations;  /* so far */
  const volatile sig_atomic_t *interrupt;
  strut_arena arena;
} strut_relaxation;

/** The step is the experiment's; it may be changed before it runs. STRUT_NO_MEMORY, STRUT_SINGULAR. */
strut_status strut_relaxation_create(const strut_model *model, const strut_experiment *experiment,
                                     strut_relaxation *relaxation, strut_error *error);
/**
 * Integrates from the state's positions, at rest, and sets all velocities to zero whenever the
 * kinetic energy has passed a peak, until every speed and acceleration is below the scene's limits.
 * Fails with STRUT_NOT_SETTLED where the scene's limits of time or work are used up before,
 * STRUT_DIVERGED, STRUT_INTERRUPTED.
 */
strut_status strut_relaxation_run(strut_relaxation *relaxation, strut_error *error);
void strut_relaxation_free(strut_relaxation *relaxation);

/** A relaxation by itself, with the step as the experiment gives it; *time is the time it took [s]. */
strut_status strut_settle_state(const strut_model *model, const strut_experiment *experiment,
                                strut_state *state, const volatile sig_atomic_t *interrupt,
                                double *time, strut_error *error);

/**
 * The start of an experiment, settled: q (length) are the positions
 * [m], *time what it simulated [s], `how` tells the rest. The step is chosen by the stability limit
 * where the scene gives none that is stable; one that proves too large on the way is halved. With
 * settle.perturb an unstable equilibrium is left. limits: of models seen before, may be NULL. Fails as
 * strut_relaxation_run.
 */
STRUT_API strut_status strut_settle_experiment(const strut_model *model,
                                               const strut_experiment *experiment,
                                               strut_step_limits *limits,
                                               const volatile sig_atomic_t *interrupt, double *q,
                                               double *time, strut_settle_summary *how,
                                               strut_error *error);

/** A start that has settled once, for experiments that are to begin with the same bits. */
typedef struct strut_settled_start {
  const strut_model *model; /* that starts at rest there: `own`, or the one given */
  strut_model *own;         /* NULL where nothing had to settle */
  strut_scene *scene;       /* of `own`; its nodes are the arena's, all else is shared */
  double time;              /* what settling simulated [s] */
  strut_settle_summary how;
  strut_arena arena;
} strut_settled_start;

/**
 * Settles where the experiment wants it. What then runs on start->model must not settle again.
 * strut_settled_start_free, after a failure too; the model given must outlive it.
 */
STRUT_API strut_status strut_settle_model(const strut_model *model,
                                          const strut_experiment *experiment,
                                          const volatile sig_atomic_t *interrupt,
                                          strut_settled_start *start, strut_error *error);
STRUT_API void strut_settled_start_free(strut_settled_start *start);

#endif
