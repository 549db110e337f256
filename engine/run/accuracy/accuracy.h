/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Runs to a wanted accuracy: chooses method and step by cost, and checks the answer. */
#pragma once

#include <math.h>

#include "engine/model/model.h"
#include "engine/run/recorder.h"
#include "engine/run/simulate.h"

/**
 * Runs an experiment so that the error of the measured velocity is within experiment.accuracy,
 * relative to the velocity or, where that is small, to a thousandth of the structure's size per
 * period (or per run). Of a motion without a period that stays below a fifth of that speed, it is only
 * known that it creeps, and its mean velocity with an error of its own.
 *
 * The velocity is the mean over the experiment's window or, with experiment.steady, that of the
 * steady motion. A run by periods whose motion becomes steady long before its window is made with
 * the cheapest method, and its orbit is then corrected by an accurate one (orbit.h). Any other run
 * is made with the cheapest method, with half its step, and with error control and ever smaller
 * tolerances, until two agree; rigid bars with ever smaller steps. Where there is no ground and
 * stiff members hold explicit steps far below the motion, implicit midpoint comes first
 * (accuracy_midpoint.c). summary->accuracy reports the choice with its reason, the cost of the
 * checks and the expected error; `kept` is false where the accuracy was not reached. The
 * experiment's own method and step are ignored. Results and errors as strut_simulate.
 */
STRUT_API strut_status strut_simulate_accurately(const strut_model *model,
                                                 const strut_experiment *experiment,
                                                 const strut_run_options *options,
                                                 strut_summary *summary, strut_error *error);

/** strut_simulate_accurately where the experiment asks for an accuracy, else strut_simulate. */
STRUT_API strut_status strut_simulate_as_asked(const strut_model *model,
                                               const strut_experiment *experiment,
                                               const strut_run_options *options,
                                               strut_summary *summary, strut_error *error);

/* Shared by the strategies in accuracy_midpoint.c, accuracy_orbit.c and accuracy_ladder.c. */

/** Part of the largest stable step that the coarse method takes. */
static const double STRUT_COARSE_STEP = 0.82;

typedef struct strut_accuracy {
  const strut_model *model;    /* of the settled start */
  const strut_scene *scene;    /* model->scene */
  strut_experiment experiment; /* as requested, without settling */
  const strut_run_options *options;
  strut_experiment coarse; /* the cheapest method with its largest sensible step */
  double target,
      scale; /* wanted relative error [1]; velocity below which errors are not relative [m/s] */
  bool single_method;        /* only one method suits the scene: compare different steps of it */
  bool creeps;               /* a run has warned that feet creep within wide bands */
  int64_t check_evaluations; /* force evaluations that are not part of the answer */
  int64_t budget;            /* force evaluations allowed in total */
  int64_t used, allowed;     /* made so far; allowed until the present strategy must stop */
  strut_summary *summary;
  strut_error *error;
  bool stiff; /* the coarse method's step is bounded by stability, not by the period or the run */
} strut_accuracy;

/** Is a wanted error kept? Only where the estimate of the error, in the same unit, can be trusted (`confirmed`). */
static inline bool strut_accuracy_is_kept(bool confirmed, double expected, double wanted) {
  return confirmed && expected <= wanted;
}

/** Does the energy balance leave open what the accuracy asked for does not explain? */
bool strut_accuracy_balance_is_open(const strut_accuracy *accuracy, const strut_summary *summary);
/** The shortest period or duration of a signal [s]; HUGE_VAL: none. `stops`: only of those that the breaks at which
    methods with events stop do not resolve. */
double strut_accuracy_signal_time(const strut_accuracy *accuracy, bool stops);
/** Announces the next part of the work to the progress display. */
void strut_accuracy_begin_phase(const strut_accuracy *accuracy, const char *name);
/** Force evaluations that the budget allows at least. */
double strut_accuracy_least_budget(const strut_accuracy *accuracy);
/** Force evaluations left for the next run, at least 1. */
int64_t strut_accuracy_evaluations_left(const strut_accuracy *accuracy);
/** The answer of the request is a run that was a check until now; where it is recorded it is made again. */
strut_status strut_accuracy_deliver(strut_accuracy *accuracy, const strut_experiment *experiment,
                                    strut_summary *run);
/** Runs the model with another experiment; STRUT_WORK_LIMIT if it exceeds the evaluations left. */
strut_status strut_accuracy_run(strut_accuracy *accuracy, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary);
/**
 * Drive periods in which the motion must become steady: all where the run ends when it is steady.
 * Otherwise half of those before the window, so that the rest of the transient dies out.
 */
double strut_accuracy_transient_periods(const strut_accuracy *accuracy);
/** Is the mean over the window that of the steady motion? */
bool strut_accuracy_orbit_covers_window(const strut_accuracy *accuracy,
                                        const strut_steady_summary *steady);
/**
 * Tries implicit midpoint, halving the step until two runs agree, their positions converge at the
 * expected order and no motion that matters is too fast for the step; as long as a run costs less
 * than one by the cheapest explicit method. *done is false where this fails or does not apply.
 */
strut_status strut_accuracy_try_midpoint(strut_accuracy *accuracy, bool *done);
/** Tries to find a periodic orbit; *done is false if that fails. */
strut_status strut_accuracy_try_orbit(strut_accuracy *accuracy, bool *done);
/** Repeats the run with ever finer steps and tolerances until two runs agree. */
strut_status strut_accuracy_climb_ladder(strut_accuracy *accuracy);

/* Node positions near the end of a run, to compare the motions of two runs. */

typedef struct strut_track {
  const strut_model *model; /* any run of this model may be recorded */
  size_t capacity, count;   /* capacity; moments of the latest run */
  double *time;             /* (capacity) [s] */
  double *position;         /* (capacity, node_count, 2) [m] */
  strut_sink sink;          /* for the run */
} strut_track;

/** A track of up to `capacity` moments, in the arena. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_track_create(const strut_model *model, size_t capacity, strut_arena *arena,
                                strut_track *track);
/**
 * Largest distance between two tracks at the same moments over the nodes' range of motion: 0 for
 * the same motion, about 1 for unrelated ones. Travel along the ground is left out. HUGE_VAL where
 * the moments differ, except by whole periods [s] if `period` is not 0. Motions below 1e-4 of the
 * size count as that.
 */
double strut_track_distance(const strut_track *first, const strut_track *second, double period);

/* The runs of accuracy_ladder.c and what accuracy_judge.c makes of them. */

enum { STRUT_LADDER_RUNS = 12 }; /* at most */
/** Shift of the start, over the size of the structure: no model is known to so many digits. */
#define STRUT_LADDER_SHIFT 1e-12

/** Doubt of an arrival above which it is not decided: more than the ladder accepts of any two runs. */
#define STRUT_LADDER_UNDECIDED 0.3

/** One run with its result. */
typedef struct strut_rung {
  strut_experiment e;
  strut_summary s;
  strut_track track;
  int64_t cost; /* force evaluations */
} strut_rung;

typedef struct strut_ladder {
  strut_accuracy *a;
  strut_rung rung[3], *now, *before;
  double unit;                   /* the longest steps and moments divide it [s] */
  double moment;                 /* between moments of a track [s] */
  double change, earlier_change; /* relative, of the latest two runs and of the two before */
  double earliest_change;        /* of the two before those */
  double *difference;            /* (quantities) of the latest two runs, SI */
  double *shifted;               /* (quantities) what a shifted start changes, SI */
  double sensitivity;            /* the same as `change` */
  double shift;                  /* of that start, over the size of the structure */
  double *results;               /* (runs, quantities + 1) of each run, then the velocity, SI */
  size_t worst;                  /* index of the quantity with the largest relative error */
  double distance;               /* of the latest two tracks */
  double earlier_distance;       /* of the two before */
  int runs, coarse_runs;         /* of all, the first ones, by the coarse method */
  int tried, failures;           /* runs, with those that failed; the latter */
  int unrelated;           /* latest runs whose motion has nothing of that of the run before */
  double expected, margin; /* estimated error of the latest run, relative; reported over that */
  double unsteady;         /* how far that run is from its steady motion, as `change` */
  bool same_motion, creeps, kept, budget_spent;
  bool implicit;  /* runs with error control are by the implicit method */
  bool precise;   /* or by the method of higher order */
  bool imprecise; /* that method has failed */
  bool failed;    /* a finer run has failed, after one that is the answer */
  const strut_model *model;
  strut_arena arena;
} strut_ladder;

/** How many of the runs were by a method with error control; at most zero as long as there are coarse runs only. */
static inline int strut_ladder_runs_with_error_control(const strut_ladder *ladder) {
  return ladder->runs - ladder->coarse_runs;
}

static inline double strut_ladder_velocity_size(const strut_ladder *ladder, double velocity) {
  return fmax(fabs(velocity), ladder->a->scale);
}

/** Error allowed for quantity i, in its unit, relative to its value or a thousandth of its largest term. */
double strut_ladder_tolerated_error(const strut_ladder *ladder, const strut_measured *measured,
                                    size_t i);
/** Error of the extreme that decides an arrival, over its distance from the target, by two runs. 0 is certain. */
double strut_ladder_arrival_doubt(const strut_measured *one, const strut_measured *other);
/** Decides whether the latest of two or more runs is accurate enough, and estimates its error. */
void strut_ladder_judge(strut_ladder *ladder);
/** Have the motions of the latest runs had nothing in common, so that the start may be what decides? */
bool strut_ladder_is_lost(const strut_ladder *ladder);
/** Lets the coarse method go on where one or two more halved steps should do, for less than another method takes. */
void strut_ladder_extend_coarse(strut_ladder *ladder);
/** No more runs follow: those that met a limit may still agree well enough. */
void strut_ladder_judge_last(strut_ladder *ladder);
/** Fills the summary's accuracy and quantities. */
void strut_ladder_report(strut_ladder *ladder);
