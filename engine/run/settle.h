/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Settling before a run: dynamic relaxation with kinetic damping, and the stability of the
 * equilibrium found.
 *
 * The settled start does not depend on the method, step or accuracy of the run: settling always
 * uses the classical Runge-Kutta method with settle.step. Every command gets it from
 * strut_settle_experiment, hence the same bits.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/state.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

/** A model without drives, driven loads, belt and, unless kept, friction, and its state. */
typedef struct strut_relaxation {
  strut_scene scene;
  const strut_experiment *experiment;
  strut_model *model; /* of `scene` */
  strut_state *state;
  const struct strut_integrator *method;
  void *workspace;
  double *acceleration; /* (length) */
  double *still;        /* (length) zeros */
  double step;          /* [s] */
  double time;          /* simulated so far [s] */
  int64_t evaluations;  /* so far */
  const strut_flag *interrupt;
  strut_arena arena;
} strut_relaxation;

/**
 * Takes the step of the experiment, which may be changed before the relaxation runs.
 * STRUT_NO_MEMORY, STRUT_SINGULAR.
 */
strut_status strut_relaxation_create(const strut_model *model, const strut_experiment *experiment,
                                     strut_relaxation *relaxation, strut_error *error);
/**
 * Integrates from the positions of the state, at rest, and sets all velocities to zero whenever the
 * kinetic energy has passed a peak, until every speed and acceleration is below the limits of the
 * scene. Fails with STRUT_NOT_SETTLED where the limits of time or work are used up first,
 * STRUT_DIVERGED, STRUT_INTERRUPTED.
 */
strut_status strut_relaxation_run(strut_relaxation *relaxation, strut_error *error);
/**
 * Can straight grounds hold each part of the structure that nothing else holds along them? STRUT_NOT_SETTLED with
 * the coefficient of friction that it takes, STRUT_NO_MEMORY.
 */
strut_status strut_relaxation_check(strut_relaxation *relaxation, strut_error *error);
void strut_relaxation_free(strut_relaxation *relaxation);

/**
 * Settles the start of an experiment: q (length) are the positions [m], `how` the details. The step follows
 * from the stability limit where the scene gives no stable one, and is halved where it diverges. With
 * settle.perturb an unstable equilibrium is left. Fails as strut_relaxation_run.
 */
STRUT_API strut_status strut_settle_experiment(const strut_model *model,
                                               const strut_experiment *experiment,
                                               const strut_flag *interrupt, double *positions,
                                               strut_settle_summary *how, strut_error *error);

/** A settled start shared by several experiments, so that all start from the same bits. */
typedef struct strut_settled_start {
  const strut_model *model; /* starts at rest there: `own`, or the model given */
  strut_model *own;         /* NULL where settling was not requested */
  strut_scene *scene;       /* of `own`; its nodes are in the arena, all else is shared */
  double time;              /* simulated while settling [s] */
  strut_settle_summary how;
  strut_arena arena;
} strut_settled_start;

/**
 * Settles if the experiment requests it. Experiments on start->model must not settle again. Call
 * strut_settled_start_free, also after a failure; the model given must outlive the start.
 */
STRUT_API strut_status strut_settle_model(const strut_model *model,
                                          const strut_experiment *experiment,
                                          const strut_flag *interrupt, strut_settled_start *start,
                                          strut_error *error);
STRUT_API void strut_settled_start_free(strut_settled_start *start);
