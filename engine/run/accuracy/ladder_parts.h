/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The runs of accuracy_ladder.c and what accuracy_judge.c makes of them. */
#ifndef STRUT_ENGINE_RUN_ACCURACY_LADDER_PARTS_H
#define STRUT_ENGINE_RUN_ACCURACY_LADDER_PARTS_H

#include <math.h>

#include "engine/run/accuracy/accuracy.h"

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
  double expected, margin; /* estimated error of the latest run, relative; reported over that */
  bool same_motion, kept, budget_spent;
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

/**
 * Error allowed for quantity i, in its unit. Relative ones refer to its value, or to a thousandth
 * of its largest term if that is larger.
 */
double strut_ladder_tolerated_error(const strut_ladder *ladder, const strut_measured *measured,
                                    size_t i);
/**
 * Error of the extreme that decides an arrival, by two runs, over its distance from the target: 0 is certain, above
 * STRUT_LADDER_UNDECIDED nothing is known.
 */
double strut_ladder_arrival_doubt(const strut_measured *one, const strut_measured *other);
/** Decides whether the latest of two or more runs is accurate enough, and estimates its error. */
void strut_ladder_judge(strut_ladder *ladder);
/** Lets the coarse method go on where one or two more halved steps should do, for less than another method takes. */
void strut_ladder_extend_coarse(strut_ladder *ladder);
/** No more runs follow: those that met a limit may still agree well enough. */
void strut_ladder_judge_last(strut_ladder *ladder);
/** Fills the summary's accuracy and quantities. */
void strut_ladder_report(strut_ladder *ladder);

#endif
