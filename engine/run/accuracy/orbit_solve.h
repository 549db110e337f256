/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Finding the periodic orbit for a wanted accuracy: state and steps shared by accuracy_orbit.c and orbit_solve.c. */
#pragma once

#include "engine/run/accuracy/accuracy.h"
#include "engine/run/orbit/orbit.h"

/** Largest tolerance of the reference method per velocity error; measured at random points. */
static const double STRUT_TOLERANCE_PER_ERROR = 1.0 / 1500.0;

/** For a sensitive orbit the tolerance is smaller by this factor. */
static const double STRUT_TIGHTENED = 25.0;

/** Part of the wanted error of the velocity to which the fixed point of a period map is sought. */
static const double STRUT_FIXED_POINT_PART = 0.1;

/** A state, and what was simulated from t = 0 up to it: nothing that was tried and left. */
typedef struct strut_orbit_place {
  double *y;   /* (2 length + 1) as of a period map */
  double time; /* from which it may be run on [s] */
  strut_energy energy;
  int64_t steps, events;
} strut_orbit_place;

/** The run or correction that gives the answer. */
typedef enum strut_orbit_answer {
  STRUT_ORBIT_NONE,
  STRUT_ORBIT_COARSE,    /* the coarse method, confirmed by a correction */
  STRUT_ORBIT_CORRECTED, /* the corrected coarse orbit */
  STRUT_ORBIT_REFERENCE, /* the reference method, run until it was steady itself */
  STRUT_ORBIT_STUCK,     /* the coarse method with half the step, confirmed by the full step */
  STRUT_ORBIT_IRREGULAR, /* a mean over many periods, by two steps */
  STRUT_ORBIT_DISPUTED,  /* periodic by the coarse method only: means over many periods */
  STRUT_ORBIT_CREEPING   /* slower than matters, by two steps */
} strut_orbit_answer;

/** The mean velocity of a motion that does not repeat itself, over the latter half of a run. */
typedef struct strut_orbit_mean {
  double velocity, interval; /* [m/s] and 95 % confidence */
  int64_t periods;           /* of the run; 0: there is none */
  double apart;              /* from the mean of another run, by other steps [m/s] */
  bool disputed;             /* by more than the scatter of both, and a third run does not decide */
} strut_orbit_mean;

typedef struct strut_orbit_solve {
  strut_accuracy *a;
  strut_status status;        /* what stops the search, after which nothing more is run */
  strut_experiment reference; /* with error control */
  strut_period_map coarse_map, reference_map;
  strut_summary coarse_run;     /* up to the steady state */
  size_t both;                  /* 2 length + 1 */
  strut_orbit_place end, known; /* where the latest run has ended; the orbit, whose y is orbit.y */
  double *fixed_point;          /* (both) of the coarse map */
  double travel;                /* over one application of it [m] */
  strut_orbit orbit;
  double error;         /* of orbit.velocity, estimated [m/s] */
  int64_t until_steady; /* evaluations of the coarse map up to its fixed point */
  int64_t counted;      /* evaluations of the present maps already in a->used */
  strut_orbit_answer answer;
  bool tightened; /* the reference tolerance was reduced for a sensitive orbit */
  bool followed;  /* the coarse run is one of the reference method: its start was too fast */
  bool lost;      /* the start was too fast, and runs from it do not agree */
  strut_summary last_run; /* the run that gave the answer, if any */
  strut_arena arena;
  double finer; /* how often the coarse map's step is in the first coarse one [1] */
  double apart; /* velocity of the orbit from that of the run that confirms it [m/s] */
  strut_orbit_mean mean;
} strut_orbit_solve;

/** The velocity that errors are relative to [m/s]. */
double strut_accuracy_velocity_scale(const strut_accuracy *accuracy, double velocity);
/** Adds the evaluations of both maps since the last call to a->used. */
void strut_orbit_solve_count_evaluations(strut_orbit_solve *solve);
/** Appends a continuation: costs add up, results are replaced; empties `part`. */
void strut_summary_append(strut_summary *whole, strut_summary *part);
/**
 * Runs `experiment` for at most `periods`, from solve->end or the start of the scene, until
 * it is steady within `tolerance` [1] over `successive` periods. The end becomes solve->end.
 */
void strut_orbit_solve_run_until_steady(strut_orbit_solve *solve, strut_experiment experiment,
                                        double tolerance, int32_t successive, double periods,
                                        bool from_end, strut_summary *summary);
/** The same, appended to the run so far, which stays as it is after a failure. */
void strut_orbit_solve_run_on(strut_orbit_solve *solve, strut_experiment experiment,
                              double tolerance, int32_t successive, double periods, bool from_end,
                              strut_summary *run);
/** Copies a place to another one. */
void strut_orbit_place_copy(const strut_orbit_solve *solve, const strut_orbit_place *from,
                            strut_orbit_place *to);
/** The place as the start or the end of a run. */
strut_snapshot strut_orbit_place_snapshot(const strut_orbit_solve *solve,
                                          const strut_orbit_place *place);
/** Turns the status of map evaluations into that of the search. False: it is over. */
bool strut_orbit_solve_check_maps(strut_orbit_solve *solve, strut_status status);
/** A state (both) in the arena; NULL: out of memory, which the status says. */
double *strut_orbit_solve_array(strut_orbit_solve *solve);

/**
 * The error to state of an answer, over the wanted one [1]: that of the orbit's velocity, and what the method, the fixed
 * point and a coarse orbit that stays as it is add. It is accepted up to 1.
 */
double strut_orbit_solve_error_share(const strut_orbit_solve *solve, strut_orbit_answer answer);
/**
 * Runs the reference method for at most `periods` until it is steady: from the orbit or, where the
 * answer depends on history, from the start of the scene. Fills solve->last_run; sets solve->answer
 * if the motion became periodic.
 */
void strut_orbit_solve_run_reference(strut_orbit_solve *solve, bool from_orbit, double periods);
/** Repeats the reference orbit with a tenth of the tolerance; replaces it where they disagree. */
void strut_orbit_solve_check_tolerance(strut_orbit_solve *solve);
/** The coarse method with half its step. */
strut_experiment strut_orbit_solve_halve_step(const strut_orbit_solve *solve);
/** solve->last_run is the answer, with that error [m/s]. */
void strut_orbit_solve_accept_last_run(strut_orbit_solve *solve, strut_orbit_answer end,
                                       double error);

/* orbit_means.c: motions that do not repeat themselves. */

/** Runs the coarse method on until periodic (true: solve->end is on the orbit) or not: then it is averaged. */
bool strut_orbit_solve_average_irregular(strut_orbit_solve *solve);
/**
 * The reference method (solve->last_run) did not become periodic, the coarse one did: the mean velocity by the
 * reference method over many periods from there must agree with the orbit's. Sets solve->answer.
 */
void strut_orbit_solve_average_disputed(strut_orbit_solve *solve);
/** Writes how the mean is known. */
void strut_orbit_solve_explain_mean(const strut_orbit_solve *solve, char *text, size_t size);

/** Did the coarse map pass no event, at a velocity within the stick band? */
bool strut_orbit_solve_is_stuck(const strut_orbit_solve *solve);
/**
 * All contacts stick for the whole period. The creep speed then depends on history, so there is no
 * orbit to correct. Runs the coarse method with half the step from the start of the scene; sets
 * solve->answer if both agree.
 */
void strut_orbit_solve_confirm_stuck(strut_orbit_solve *solve);
/** The coarse run creeps. Runs it on with half the step; sets solve->answer if that is as slow. */
void strut_orbit_solve_confirm_creep(strut_orbit_solve *solve);
/** Fills the request's summary from the answer; orbit: the run of its periods. */
void strut_orbit_solve_report(strut_orbit_solve *solve, const strut_summary *orbit);
