/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the parts of a tradeoff share: settings, single runs, the budget.
 */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_PARTS_H
#define STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_PARTS_H

#include "engine/study/tradeoff/tradeoff.h"

enum { STRUT_STUDY_VARIANTS = 7 }; /* most fidelities of a scene */

/** A point's scene in a fidelity, and its model once that has been asked for. */
typedef struct study_variant {
  strut_scene scene; /* its contacts may be the arena's; all else is shared */
  strut_model *model;
  strut_arena arena;
} study_variant;

typedef struct study_setting {
  const strut_integrator *method;
  double step, tolerance, refine; /* tolerance, refine: NAN where they say nothing */
} study_setting;

/** What one run gave. */
typedef struct study_outcome {
  strut_status status; /* STRUT_OK, or STRUT_DIVERGED for all that goes wrong on the way */
  bool cannot;         /* the method cannot run this model at all; error holds the reason */
  int64_t evaluations;
  double seconds;    /* CPU time of the stepping alone */
  double step_limit; /* [s] */
} study_outcome;

typedef struct study {
  const strut_setup *const *setups;
  const strut_tradeoff_options *options;
  strut_tradeoff *result;
  strut_error *error;
  double began;         /* CPU clock [s] */
  double budget;        /* [s] */
  double *size, *scale; /* (points) [m], [m/s] */
  double *scratch;      /* (max(points, values)) */
  study_setting base;
  double limit; /* of the base's method [s]; 0 where there is none */
  double *base_evaluations, *base_seconds, *base_timed; /* (points); [s], [s] of the clock */
  size_t row_room;
  study_variant *variants; /* (points, STRUT_STUDY_VARIANTS) */
} study;

/** This thread's CPU time [s]. */
double strut_study_clock(void);
/** CPU time left until a share of the budget is spent [s]; below 0: over. */
double strut_study_left(const study *s, double share);
/** strut_simulate's experiment for `point`, cut to the periods that are wanted. */
strut_experiment strut_study_experiment(const study *s, size_t point);
/** The largest step up to `step` of which the period, or else the duration, is a multiple. */
double strut_study_fit(const study *s, size_t point, double step);
/** Duration and period of that experiment. */
strut_span strut_study_span(const study *s, size_t point);
/** The longest step that can make sense: a part of the period, or else of the duration [s]. */
double strut_study_longest(const study *s, size_t point);
/**
 * Runs a fidelity with a setting at an operating point; its values go into (value_count) `value`,
 * NAN where it diverged. Fails with STRUT_INTERRUPTED and STRUT_NO_MEMORY alone.
 */
strut_status strut_study_run(const study *s, size_t point, int fidelity, study_setting setting,
                             double *value, study_outcome *outcome);
/** Distance of two answers at a point: that of errors. INFINITY where one is not a number. */
double strut_study_distance(const study *s, size_t point, const double *value,
                            const double *reference);
/** Whether forces of the scene can jump or have kinks. */
bool strut_study_switches(const strut_scene *scene);
bool strut_study_adaptive(const strut_integrator *method);
/**
 * Whether a method can run a fidelity's law of friction, and differs in this scene from all others:
 * where nothing touches or goes slack there are no events to locate.
 */
bool strut_study_able(const study *s, const strut_integrator *method, int fidelity);
/** Whether it is wanted, too. */
bool strut_study_allowed(const study *s, const strut_integrator *method, int fidelity);

/** Lists the scene's own model and those that make sense beside it. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_study_list_fidelities(study *s);
/** Changes a scene into that of a fidelity; new contacts come from the arena. */
strut_status strut_study_change_scene(const study *s, int fidelity, strut_scene *scene,
                                      strut_arena *arena);
/** The model of a point in a fidelity, compiled once and kept. Fails as strut_model_compile. */
strut_status strut_study_model(const study *s, size_t point, int fidelity,
                               const strut_model **model);
/** Frees all of them. */
void strut_study_free_models(study *s);

/** Two methods, refined in turn: state of the search for one fidelity's references. */
typedef struct study_reference {
  int fidelity;
  const strut_integrator *method[2];
  double limit;            /* [s] first step of the first method */
  int *level, *idle;       /* (points) next level; levels in a row that did not help */
  double last_cost;        /* CPU time of the latest level of one point [s] */
  double *latest, *before; /* (2, values), (points, 2, values) */
} study_reference;

/** Chooses the methods. Where there are none, the fidelity is not run and says why. */
strut_status strut_study_reference_begin(study *s, int fidelity, study_reference *r);
/** Refines until every floor is at most `target` or the share of the budget is spent. */
strut_status strut_study_reference_refine(study *s, study_reference *r, double target,
                                          double share);

/** Errors, spreads and fronts of all rows, from values and references. */
void strut_study_judge(study *s);
/** The smallest worst error of a row, not counting what a floor hides; 1 where there is none. */
double strut_study_smallest(const study *s, int fidelity);

#endif
