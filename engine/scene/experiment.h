/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The experiment on a scene: how its start is found, method, step and duration of a run, what is
 * measured and recorded, and how equilibria are searched.
 *
 * A scene compiles to one model, on which any number of experiments can run. Indices refer to the
 * arrays of the scene.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/scene/channels.h"
#include "engine/scene/quantity.h"
#include "engine/scene/scene.h"

#define STRUT_USUAL_BUDGET 20 /* see strut_experiment.budget */

/** More samples in a step are a mistake. */
#define STRUT_MOST_IN_STEP 1e5

/** Settling before t = 0: actuators, loads with a signal and the belt are off. */
typedef struct strut_settle {
  bool wanted;
  bool
      friction; /* friction is kept; off by default, as in the paper: then nothing holds on a slope */
  double speed;        /* at rest when every speed is below this [m/s]; paper 1e-8 */
  double acceleration; /* and every acceleration below this [m/s^2]; paper 1e-8 */
  double limit;        /* limit of the simulated time [s] */
  double evaluations;  /* limit of the force evaluations; 0: STRUT_SETTLE_EVALUATIONS */
  double step;  /* of the Runge-Kutta method that settles [s]; 0: the experiment's, whatever its
                          method; below zero: chosen by the stability limit */
  bool perturb; /* leave an unstable equilibrium and settle again */
} strut_settle;

static const double STRUT_SETTLE_EVALUATIONS = 4e7;

enum { STRUT_MOST_STARTS = 1000000000 };
#define STRUT_MOST_SEED 9007199254740992.0 /* 2^53: every seed is a number of the language */

/** Settings of the search for equilibria. */
typedef struct strut_search {
  size_t support_count;     /* sets of contact nodes to hold in turn; 0: all that are needed */
  strut_node_set *supports; /* (support_count) of each set the first node is pinned, others roll */
  int64_t
      starts; /* random starts for each set, up to STRUT_MOST_STARTS; 0: until few equilibria can be missing */
  uint64_t seed; /* up to STRUT_MOST_SEED */
} strut_search;

/**
 * A stage of a path: one of a load's factor, an actuator or a coordinate is followed from where it is to
 * `until`, or a held coordinate is let go, by taking its reaction away.
 */
typedef struct strut_path_stage {
  const char *load, *over,
      *release; /* load, or several such as "p, q"; actuator or NODE.x; NODE.x that a stage before or a support holds, and not in
                                        the first stage: one of them, else NULL */
  double until; /* factor, or in SI; of a release 0 */
  size_t hold_count;
  int32_t *hold;        /* (hold_count) coordinates held from its beginning, 2 node + 1 for y */
  int32_t stop;         /* coordinate at which it ends earlier, or -1 */
  double stop_distance; /* once it has moved so far in the stage [m] */
  int32_t steps;        /* maximum number of steps; 0: the usual ones */
} strut_path_stage;

/** Is the load among those that a stage or a path names, such as "p, q"? */
STRUT_API bool strut_path_names_load(const char *names, const char *load);

/** Stops a run by periods when the motion repeats itself. */
typedef struct strut_steady {
  bool wanted;
  double tolerance;   /* of the measured velocity, relative to it [1]; default 0.005 */
  double floor;       /* differences below this count as none [m/s]; 0: taken from the scene */
  int32_t successive; /* repetitions in a row that must agree; default 5 */
  double
      mean_tolerance; /* of an irregular motion's mean velocity [1], where the run continues one that was long enough; 0: tolerance */
  double
      creep; /* a motion without a period that stays slower ends as creeping [m/s]; 0: none does */
  int64_t creep_after; /* but not within so many periods */
  int64_t run_on;      /* least periods of a steady run's summary; 0: one */
} strut_steady;

/**
 * X(row, "word", steps): the methods of integration, in the order of their table; their rows strut_integrator_*
 * are in engine/integrate. steps: of a method that chooses its steps, the least number per period, or per run, where
 * the file has no longest step; else 0.
 */
#define STRUT_INTEGRATORS(X)                                                                       \
  X(rk4, "rk4", 0)                                                                                 \
  X(euler, "euler", 0)                                                                             \
  X(verlet, "verlet", 0)                                                                           \
  X(rk4_events, "rk4-events", 0)                                                                   \
  X(euler_events, "euler-events", 0)                                                               \
  X(verlet_events, "verlet-events", 0)                                                             \
  X(adaptive, "adaptive", 100)                                                                     \
  X(adaptive8, "adaptive8", 10)                                                                    \
  X(implicit, "implicit", 10)                                                                      \
  X(midpoint, "midpoint", 0)
/** Their words as the key table lists them: "rk4|euler|...". */
#define STRUT_INTEGRATOR_WORD(row, word, steps) "|" word
#define STRUT_INTEGRATOR_WORDS (&("" STRUT_INTEGRATORS(STRUT_INTEGRATOR_WORD))[1])

/** A number of `parameters` that results are differentiated by. */
typedef struct strut_derived_by {
  const char *name, *unit; /* unit "1": none */
} strut_derived_by;

/** The accuracy of a run whose scene has no solver, relative. */
#define STRUT_USUAL_ACCURACY 0.01
#define STRUT_MOST_ACCURACY 0.2

/** Start, method, duration and measurements of an experiment. */
typedef struct strut_experiment {
  const char *integrator; /* name in the table of methods; default "rk4" */
  bool integrator_named;  /* by the file or an option: strut_experiment_choose_method keeps it */
  double step;            /* dt [s], > 0; of an adaptive method the largest; 0: it is chosen */
  bool step_chosen;       /* the file gives none: strut_experiment_choose_method did */
  double tolerance;       /* of an adaptive method, relative [1]; default 1e-6 */
  double
      refine; /* factor of shorter steps after a touchdown [1], by methods that refine; 0: taken from the scene; 1: none */
  double refine_time;   /* duration of the refinement [s]; 0: taken from the scene */
  double refine_rate;   /* taken from the scene: fastest rate of a closed contact times the short
                             step [1]; default 0.25 */
  double refine_memory; /* taken from the scene: in relaxation times [1]; default 8 */
  double
      accuracy; /* wanted relative error of the measured quantity [1], by which method and step are chosen; 0: they are as given */
  bool exact_sums;       /* of quantities: for differences of runs */
  bool accuracy_assumed; /* the scene says nothing of the solver, so it is STRUT_USUAL_ACCURACY */
  double budget;         /* work allowed for it, in fine runs with a fixed step */
  strut_steady steady;
  strut_settle settle; /* before t = 0 */
  strut_search search; /* of equilibria */
  size_t stage_count;
  strut_path_stage *stages; /* (stage_count) of a path */
  bool path_friction;       /* paths keep friction */
  double duration;          /* [s]; 0 when given in periods */
  double periods;           /* number of periods of signal `period_signal`; 0 when in seconds */
  int32_t period_signal;    /* or -1 */
  const char *period_of;    /* the name the file used for it, or NULL */
  double measure_last;  /* window: the last periods (if periods > 0) or seconds; 0: the whole run */
  int32_t measure_node; /* whose velocity (14) is measured; -1: the centre of mass */
  size_t quantity_count;
  strut_quantity_definition *quantities; /* (quantity_count) measured beside that velocity */
  size_t derivative_count;
  strut_derived_by *derivatives; /* (derivative_count) of what is measured; not in written scenes */
  double output_every;           /* sampling interval [s]; 0: a thousandth of the recorded time */
  double output_last;            /* record only the last periods or seconds; 0: all */
  strut_channels channels;       /* default position, length, force */
  /* Ends statics on this experiment with STRUT_INTERRUPTED, soon after it is set; NULL: nothing does.
     Not part of what a file describes; runs and searches for all equilibria have options for it. */
  const strut_flag *interrupt;
  /* Hears which part of a search for equilibria or of a path is done, 0 to 1; NULL: nobody does. */
  void (*progress)(void *context, double fraction);
  void *progress_context;
} strut_experiment;

/** A scene and the experiment on it: what a file of the language describes. */
typedef struct strut_setup {
  strut_scene scene; /* its arena also owns the experiment's texts and arrays */
  strut_experiment experiment;
} strut_setup;

/** Tells who waits for statics on this experiment that this part is done. */
static inline void strut_experiment_advance(const strut_experiment *experiment, double fraction) {
  if (experiment->progress) experiment->progress(experiment->progress_context, fraction);
}

/** Shall statics on this experiment end? */
static inline bool strut_experiment_interrupted(const strut_experiment *experiment) {
  return experiment->interrupt && *experiment->interrupt;
}
/**
 * What a computation on this experiment returns whose loops end early once it is interrupted:
 * STRUT_INTERRUPTED then, else `status`.
 */
STRUT_API strut_status strut_experiment_end(const strut_experiment *experiment, strut_status status,
                                            strut_error *error);

/** The default experiment. */
STRUT_API strut_experiment strut_experiment_default(void);
/** Initialises the scene by strut_scene_init and the experiment by its default. */
STRUT_API void strut_setup_init(strut_setup *setup);
/** Frees all that the scene and the experiment own, and zeroes both. */
STRUT_API void strut_setup_free(strut_setup *setup);

/** Duration, drive period and measuring window of the experiment, in [s]. */
typedef struct strut_span {
  double duration;
  double period;       /* 0 when the run is given in seconds */
  double window_start; /* the window ends with the run */
  double record_start; /* first time to record */
  double record_every;
} strut_span;
STRUT_API strut_span strut_experiment_span(const strut_experiment *experiment,
                                           const strut_scene *scene);

/** Does the method of this name choose its steps, so that a run may leave out the longest one? */
STRUT_API bool strut_experiment_is_adaptive(const char *integrator);
/**
 * Without an accuracy: a method that sticks exactly, where none is named and friction does so; the longest step of
 * a method that chooses its steps, if missing, a part of the period or of the run.
 */
STRUT_API void strut_experiment_choose_method(strut_experiment *experiment,
                                              const strut_scene *scene);
