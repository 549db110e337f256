/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the parts of a tradeoff share: single runs, the budget. What stops the study is its `status`, after which
 * nothing more is run.
 */
#pragma once

#include "engine/output/buffer.h"
#include "engine/study/tradeoff/tradeoff.h"

typedef strut_tradeoff_setting tradeoff_setting;

/** Result of one run. */
typedef struct tradeoff_outcome {
  bool good;          /* it did not fail */
  bool cannot;        /* the method cannot run this model at all; the study's error says why */
  bool cut;           /* by the bound on work */
  double evaluations; /* of the forces, without those of settling */
  double seconds;     /* CPU time of the stepping alone */
} tradeoff_outcome;

/** Remarks of variants that are not run. */
#define STRUT_TRADEOFF_NO_TIME "the CPU time was over"
#define STRUT_TRADEOFF_NO_WORK "the work is bounded"

enum { TRADEOFF_VARIANTS = 7 }; /* at most, the unchanged model included */

/** A point's scene in a variant, and its model once that was needed. */
typedef struct tradeoff_model {
  strut_scene scene; /* its contacts may be the arena's; all else is shared */
  strut_model *model;
  strut_arena arena;
} tradeoff_model;

/** What runs of an operating point have in common. */
typedef struct tradeoff_point {
  strut_experiment experiment; /* cut to the periods that are wanted */
  strut_span span;             /* of it */
  double longest;     /* step that can make sense: a part of the whole period or duration [s] */
  double size, scale; /* [m], [m/s] */
} tradeoff_point;

typedef struct tradeoff_study {
  const strut_setup *const *setups;
  const strut_tradeoff_options *options;
  strut_tradeoff *result;
  strut_status status; /* what stops everything */
  strut_error *error;
  double began;                  /* CPU clock [s] */
  double budget, stepping;       /* CPU time: limit, and of all steps so far [s] */
  tradeoff_point *points;        /* (points) */
  double *scratch, *spare;       /* (max(points, values)) */
  tradeoff_setting base, coarse; /* the latter for what one cheap run tells */
  double *coarse_value;          /* (values) of the unchanged model at the first point */
  double limit;                  /* of the base's method [s]; 0: unlimited */
  double least_unit;             /* of result->work_unit */
  double allowed;                /* force evaluations of the next run; 0: any number */
  size_t row_capacity;
  tradeoff_model *models; /* (points, TRADEOFF_VARIANTS) */
} tradeoff_study;

/** (count) zeros of that size in the result's arena; NULL: out of memory. */
void *strut_tradeoff_allocate(tradeoff_study *study, size_t count, size_t size);
/** This thread's CPU time [s]. */
double strut_tradeoff_cpu_clock(void);
/** Force evaluations left until a share of the bound on work is spent; below 0: over. */
double strut_tradeoff_work_left(const tradeoff_study *study, double share);
/** Is there CPU time for so many force evaluations? Where not, the study is marked as cut. */
bool strut_tradeoff_has_time(tradeoff_study *study, double evaluations);
/** Force evaluations that a setting plans at a point: what a run makes that no event interrupts. */
double strut_tradeoff_planned(const tradeoff_study *study, size_t point, tradeoff_setting setting);
/** The same of all points. */
double strut_tradeoff_planned_at_all(const tradeoff_study *study, tradeoff_setting setting);
/** The largest step up to `step` of which the period, or else the duration, is a multiple. */
double strut_tradeoff_fit_step(const tradeoff_study *study, size_t point, double step);
/**
 * The largest step of a method worth trying in a variant at the first point [s], INFINITY where
 * nothing limits it. False: the method cannot run it, and the study's error says why.
 */
bool strut_tradeoff_limit(tradeoff_study *study, int variant, const strut_integrator *method,
                          double *limit);
/**
 * Runs a variant with a setting at an operating point; its values go into (value_count) `value`,
 * NAN where it diverged.
 */
tradeoff_outcome strut_tradeoff_run(tradeoff_study *study, size_t point, int variant,
                                    tradeoff_setting setting, double *value);
/** Distance of two answers at a point: that of errors. INFINITY where one is not a number. */
double strut_tradeoff_distance(const tradeoff_study *study, size_t point, const double *value,
                               const double *reference);
/** Can forces of the scene jump or have kinks? */
bool strut_tradeoff_has_switches(const strut_scene *scene);
bool strut_tradeoff_is_adaptive(const strut_integrator *method);
/**
 * Can the method run the variant's friction law, and does it differ from all other methods in this
 * scene? Without contacts and slack members there are no events to locate.
 */
bool strut_tradeoff_can_run(const tradeoff_study *study, const strut_integrator *method,
                            int variant);

/** Lists the unchanged model and the variants that apply to it. */
void strut_tradeoff_list_variants(tradeoff_study *study);
/** A point's model in a variant, compiled once and kept. Fails as strut_model_compile. */
strut_status strut_tradeoff_compile(const tradeoff_study *study, size_t point, int variant,
                                    const strut_model **model);

/** Two methods, refined in turn: state of the search for one variant's references. */
typedef struct tradeoff_reference {
  int variant;
  const strut_integrator *method[2];
  double limit;            /* [s] first step of the first method */
  int *level, *idle;       /* (points) next level; levels in a row that did not help */
  double *work[2];         /* (points) force evaluations of the latest run by each method */
  double *latest, *before; /* (2, values), (points, 2, values) */
} tradeoff_reference;

/** Chooses the methods. Without any, the variant is marked as not run, with a remark. */
void strut_tradeoff_reference_begin(tradeoff_study *study, int variant, tradeoff_reference *self);
/**
 * Refines until every floor is at most `target`; after the first two levels for `most`
 * evaluations.
 */
void strut_tradeoff_reference_refine(tradeoff_study *study, tradeoff_reference *self, double target,
                                     double most);

/** Median, 90th percentile and worst of (count) values; scratch holds as many. */
strut_spread strut_spread_of(const double *values, size_t count, double *scratch);
/** Errors of one row. */
void strut_tradeoff_judge_row(tradeoff_study *study, strut_tradeoff_row *row);

enum { MOST_STEP_SERIES = 64 };

/* Settings that differ by their step alone. */
typedef struct step_series {
  int variant, group;
  tradeoff_setting first; /* its step is the method's limit */
  bool limited;           /* there is one */
  int next;               /* index of its next setting */
  double last_cost;       /* force evaluations of the latest row; 0: none yet */
  int kept;               /* rows up to it in a row whose errors are within half the accuracy */
  bool over;              /* nothing finer is run */
} step_series;

typedef struct step_series_list {
  step_series at[MOST_STEP_SERIES];
  size_t count;
  double cheapest; /* force evaluations of the cheapest row with half the error; 0: none */
} step_series_list;

/** Adds a series for each refinement of a method that makes a difference in this scene. */
void strut_tradeoff_add_method(tradeoff_study *study, step_series_list *all, int variant,
                               const strut_integrator *method);
/**
 * Runs all series from coarse to fine, the cheapest row next, within a share of the bound on work;
 * reports progress between two fractions.
 */
void strut_tradeoff_run_series(tradeoff_study *study, step_series_list *all, double share,
                               double from, double to);
/** Adds the row of the base to its method's series, or to one of its own, if the share allows. */
void strut_tradeoff_run_base(tradeoff_study *study, step_series_list *own, double share);

enum { STRUT_TRADEOFF_TEXT = 100 };

/** "verlet-events, refined 8". */
const char *strut_tradeoff_group_text(const strut_tradeoff_row *row,
                                      char text[STRUT_TRADEOFF_TEXT]);
/** "80 us", or "1e-05" of an adaptive method. */
const char *strut_tradeoff_step_text(const strut_tradeoff_row *row, char text[STRUT_TRADEOFF_TEXT]);
/** "rk4, 100 us": what costs are relative to. */
const char *strut_tradeoff_base_text(const strut_tradeoff *result,
                                     char text[3 * STRUT_TRADEOFF_TEXT]);
/** "velocity", "position", "energy". */
const char *strut_tradeoff_measure_text(strut_tradeoff_measure measure);
