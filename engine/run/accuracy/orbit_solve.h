/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the parts of the way to an accuracy by the steady orbit share. Only accuracy_*.c include this.
 */
#ifndef STRUT_ENGINE_RUN_ACCURACY_ORBIT_SOLVE_H
#define STRUT_ENGINE_RUN_ACCURACY_ORBIT_SOLVE_H

#include "engine/run/accuracy/accuracy.h"
#include "engine/run/orbit/orbit.h"

/** Largest error of the accurate method's velocity over its tolerance, by random points. */
static const double STRUT_TOLERANCE_PER_ERROR = 1.0 / 1500.0;

/** What the cheap map has cost until it was steady. */
typedef struct strut_orbit_solve_cost {
  int64_t evaluations, events, applied;
} strut_orbit_solve_cost;

/** Which run or correction has the answer. */
typedef enum strut_orbit_solve_end {
  STRUT_WAY_NONE,
  STRUT_WAY_CHEAP,     /* the cheap method, which a correction confirms */
  STRUT_WAY_CORRECTED, /* its orbit, corrected */
  STRUT_WAY_ACCURATE,  /* the accurate method ran until it was steady itself */
  STRUT_WAY_STUCK,     /* the cheap method with half the step, which the whole one confirms */
  STRUT_WAY_IRREGULAR, /* a mean over many periods, by two steps */
  STRUT_WAY_DISPUTED   /* periodic by the cheap method, not by the accurate one: means over many */
} strut_orbit_solve_end;

typedef struct strut_orbit_solve {
  strut_accuracy *a;
  strut_experiment accurate;
  strut_period_map cheap, fine;
  strut_summary run; /* of the cheap method, to its steady state */
  strut_snapshot end;
  double *base;  /* (2 length + 1) fixed point of the cheap map */
  double travel; /* over one application of it [m] */
  strut_orbit orbit;
  double error; /* of orbit.velocity, estimated [m/s] */
  strut_orbit_solve_cost settled;
  int64_t counted; /* evaluations of the present maps that a->used contains */
  strut_orbit_solve_end found;
  bool tightened;     /* the accurate method's tolerance, for a sensitive orbit */
  strut_summary last; /* of the run with which the way ended, if there was one */
  strut_arena arena;
} strut_orbit_solve;

/** The velocity that errors are relative to [m/s]. */
double strut_accuracy_scale(const strut_accuracy *a, double velocity);
/** Adds what the maps have cost since the latest count to a->used. */
void strut_orbit_solve_count(strut_orbit_solve *way);
/** Adds what a further part of the run cost to the whole, and takes its results; empties `part`. */
void strut_summary_append(strut_summary *whole, strut_summary *part);
/**
 * A run of `experiment` by at most `periods`, from way->end or the scene's start, until it is steady to
 * `tolerance` [1] over `successive` periods; its end is way->end.
 */
strut_status strut_orbit_solve_run(strut_orbit_solve *way, strut_experiment experiment,
                                   double tolerance, int32_t successive, double periods,
                                   bool from_end, strut_summary *summary);
/** The end of the run so far becomes the orbit to go on from. */
void strut_orbit_solve_keep_end(strut_orbit_solve *way);

/** Way->orbit becomes what runs go on from. */
void strut_orbit_solve_start_later_runs(strut_orbit_solve *way);
/** Of work on the maps, which returned `status`: whether there was memory, and no interrupt. */
strut_status strut_orbit_solve_map_status(strut_orbit_solve *way, strut_status status);

/** accuracy_check.c. The error of the orbit's velocity, in parts of what is wanted. */
double strut_orbit_solve_tolerance_share(const strut_orbit_solve *way);
/**
 * The accurate method by at most `periods` until it is steady: from the orbit found, of which it then is
 * independent, or, where that depends on how it came to be, from the scene's start. way->last is of it,
 * and way->found tells whether it became periodic.
 */
strut_status strut_orbit_solve_accurate(strut_orbit_solve *way, bool from_orbit, double periods);
/** Whether a smaller tolerance would change what strut_orbit_solve_accurate found; takes it where it would. */
strut_status strut_orbit_solve_check(strut_orbit_solve *way);
/**
 * accuracy_irregular.c. The mean over many periods that do not repeat each other, by the cheap method
 * with its step, whose run was found irregular or is gone on with, and half of it. way->found tells whether there is one; *periodic, that the first of the
 * runs became periodic after all, at way->end, and way->run is of it.
 */
strut_status strut_orbit_solve_irregular(strut_orbit_solve *way, bool *periodic);
/** No switch in the periods that the cheap map went through, of a motion within the stick band. */
bool strut_orbit_solve_is_stuck(const strut_orbit_solve *way);
/**
 * Stuck through all of the period: at which speed within the stick band is a matter of how it came to
 * be, not of an orbit. By the cheap method with half the step from the scene's start, where that agrees.
 */
strut_status strut_orbit_solve_stuck(strut_orbit_solve *way);
/**
 * Where the accurate method, which way->last is of, found no end to what the cheap one calls periodic:
 * by the cheap one with half the step. Their differences are the error.
 */
strut_status strut_orbit_solve_disputed(strut_orbit_solve *way);

#endif
