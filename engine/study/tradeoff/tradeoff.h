/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Error against cost: methods, steps and model variants of one scene against converged references.
 *
 * Two errors are kept apart. The *step error* of a run is its distance from the converged answer of
 * the same model. The *model error* of a variant (lumped masses, another friction law, ...) is the
 * distance of its converged answer from that of the unchanged model. The *total error* is the
 * distance of a run from the latter.
 *
 * A reference is what two different methods agree on, each refined until they agree to a hundredth
 * of the accuracy; how far they still differ is the *floor*, and no error is given as smaller than
 * it. The finest of these runs is the *reference run*: all work is bounded by a multiple of its
 * force evaluations, or of those of the scene's own run where no accuracy is requested and these
 * are more. Costs are force evaluations, so that the same study gives the same numbers.
 */
#pragma once

#include <stdbool.h>

#include "engine/base/flag.h"
#include "engine/integrate/integrator.h"
#include "engine/output/draw/chart.h"
#include "engine/scene/experiment.h"
#include "engine/scene/scene.h"
#include "engine/scene/value_rows.h"

typedef enum strut_tradeoff_measure {
  STRUT_TRADEOFF_AUTOMATIC, /* velocity with contacts or a run by periods, where it is not
                                0; else position */
  STRUT_TRADEOFF_VELOCITY,  /* summary.velocity, relative to it or to `scale` if that is larger */
  STRUT_TRADEOFF_POSITION,  /* of all nodes at the end: the farthest off, over the scene's size */
  STRUT_TRADEOFF_ENERGY     /* |energy residual| over the energy exchanged; needs no reference */
} strut_tradeoff_measure;

enum { STRUT_TRADEOFF_MOST_STEPS = 40 };

/** What zeros in strut_tradeoff_options stand for. */
#define STRUT_TRADEOFF_USUAL_STEPS 8
#define STRUT_TRADEOFF_USUAL_PERIODS 120
#define STRUT_TRADEOFF_USUAL_BUDGET 600 /* [s] */
/** Bound on the force evaluations of a study, in reference runs. */
#define STRUT_TRADEOFF_MOST_WORK 30

/** Zero-initialise for the defaults. */
typedef struct strut_tradeoff_options {
  strut_tradeoff_measure measure;
  double accuracy; /* the error that the study is for: methods are refined until they keep half of
                      it; 0: by `steps` */
  int steps;      /* at most, per method, five per decade from its limit down; 0: the usual ones, or
                     as many as `accuracy` takes */
  double periods; /* maximum for a run given in periods; 0: the usual ones */
  double budget;  /* CPU time after which nothing is begun [s]; 0: the usual one */
  const strut_integrator *const *methods; /* (method_count) only these; 0: all */
  size_t method_count;
  bool own_model;                                   /* skip variants of the model */
  const strut_flag *interrupt;                      /* may be NULL */
  void (*progress)(void *context, double fraction); /* may be NULL */
  void *progress_context;
} strut_tradeoff_options;

/** Statistics over the operating points. Infinite: diverged. */
typedef struct strut_spread {
  double median; /* of an even number the mean of the middle two */
  double ninety; /* 90th percentile */
  double worst;
  const double *values; /* (count) */
  size_t count;
} strut_spread;

/** A variant of the model. The first is the unchanged one. */
typedef struct strut_model_variant {
  int kind;         /* what it changes, of tradeoff_models.c */
  char name[120];   /* such as "lumped masses" */
  char remark[600]; /* why it could not be run, or what was assumed; may be empty */
  bool run;
  char reference[2][100]; /* the two settings that agree, of the first operating point */
  double *value;          /* (points, values) the reference */
  double *floor;          /* (points) where the two agree; relative as errors are */
  double *model_error;    /* (points); 0 for the first */
  strut_spread model_spread, floor_spread;
} strut_model_variant;

typedef struct strut_tradeoff_setting {
  const strut_integrator *method;
  double step;      /* [s]; fitted to each point's periods. Of an adaptive method the largest */
  double tolerance; /* NAN where the method is not adaptive */
  double refine;    /* as strut_experiment.refine; NAN where nothing is refined */
} strut_tradeoff_setting;

/** One setting, run at every operating point. */
typedef struct strut_tradeoff_row {
  int variant; /* index */
  int group;   /* settings that differ by their step or tolerance alone */
  strut_tradeoff_setting setting;
  bool base;             /* costs are relative to it */
  double *value;         /* (points, values); NAN where it diverged */
  double *forces;        /* (points) force evaluations; NAN where it diverged */
  double *error, *total; /* (points) step error and total error; INFINITY where it diverged */
  strut_spread error_spread, total_spread;
  size_t diverged;    /* points */
  bool above;         /* its step is above the stability limit: runs refuse it */
  double evaluations; /* of the forces over those of the base: median over the points */
  double rate;        /* the same per simulated second [1/s] */
  double cpu;         /* CPU time over that of the base; NAN: not measured */
  double seconds;     /* CPU time of a run, median over the points [s]; NAN: not measured */
  bool front; /* Pareto-optimal among the rows of its variant, by `evaluations` and worst error */
  bool total_front; /* likewise by worst total error */
} strut_tradeoff_row;

/** A study; release with strut_tradeoff_free. Names, setups and methods outlive it. */
typedef struct strut_tradeoff {
  const char *name;                 /* of the scene */
  const strut_setup *const *setups; /* (point_count) */
  strut_tradeoff_measure measure;
  size_t point_count, value_count, variant_count, row_count, group_count;
  double scale;    /* velocities below it have errors relative to it [m/s]; of the first point */
  double periods;  /* run; 0 where the run is given in seconds */
  double duration; /* of the first point [s] */
  strut_tradeoff_setting base_setting; /* what costs are relative to */
  double base_evaluations;             /* of the first point */
  double base_seconds;                 /* NAN: not run */
  int base;                            /* row; -1: not run, its evaluations are those planned */
  double accuracy;                     /* as requested; 0: none */
  double work;                         /* force evaluations of all runs */
  double work_unit; /* of a reference run at all points, or of the scene's own run where that takes
                       more and no accuracy is requested */
  size_t left_out;  /* series of steps that the bound on work or time kept from finer ones */
  bool cut;         /* the CPU time was over: another machine may measure more */
  double spent;     /* CPU time [s] */
  strut_model_variant *variants;
  strut_tradeoff_row *rows;
  strut_arena arena;
} strut_tradeoff;

/** Flags (count) the points that no other one is better than in both; one that is not finite never is. */
STRUT_API void strut_pareto_front(const double (*points)[2], size_t count, bool *front);

/**
 * Runs everything. `setups` are (count) operating points of one model, alike but for their
 * parameters; as strut_simulate wants them. STRUT_USAGE where there is nothing to measure; else the
 * status of the base's own run where it has none, STRUT_INTERRUPTED, STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_tradeoff_make(const strut_setup *const *setups, size_t count,
                                           const strut_tradeoff_options *options,
                                           strut_tradeoff *result, strut_error *error);
/** A zeroed struct is allowed. */
STRUT_API void strut_tradeoff_free(strut_tradeoff *result);

/** Errors of the recommendations, in descending order: the accuracy, else decades from 2 % down. */
STRUT_API size_t strut_tradeoff_level_count(const strut_tradeoff *result);
STRUT_API double strut_tradeoff_level(const strut_tradeoff *result, size_t i);
/** The largest worst total error of a row and of all finer ones of its group. */
STRUT_API double strut_tradeoff_promise(const strut_tradeoff *result, int row);
/** Answer to the question which setting of the unchanged model to use for an error. */
typedef struct strut_tradeoff_advice {
  double error;
  bool known; /* the reference's floor is at most a tenth of half the error */
  /** The cheapest row of the unchanged model whose worst total error stays within `error`, and that of
      all smaller steps or tolerances of its group too, of which there is one at least: a single small
      error at a large step is luck. Its step is stable. -1: none. */
  int row;
  int half; /* the same for half the error */
  double
      cost;  /* of half the error over that of `row`, interpolated between the steps of the group of
                  `half`; NAN: not measured */
  int other; /* the best of all other methods; -1: none */
} strut_tradeoff_advice;
STRUT_API strut_tradeoff_advice strut_tradeoff_advise(const strut_tradeoff *result, double error);

/**
 * Rows of a strut_tradeoff, one of `settings` per setting. CPU times in them are measurements: they differ from run to
 * run, everything else does not unless the study was cut.
 */
STRUT_API extern const strut_value_rows strut_tradeoff_values;

/** Draws it. Over several operating points a marker is the median and a bar leads to the worst. */
STRUT_API strut_status strut_tradeoff_figure(const strut_plot *plot, const strut_tradeoff *result,
                                             strut_error *error);
