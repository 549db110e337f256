/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Summary of a run: its results. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/derivatives.h"
#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/scene/channels.h"
#include "engine/scene/value_rows.h"

/** Rows of STRUT_ENERGY_TABLE [J], and what belongs to their balance. */
typedef struct strut_energy {
#define STRUT_ENERGY_FIELD(name, kind, label) double name;
  STRUT_ENERGY_TABLE(STRUT_ENERGY_FIELD)
  double initial;  /* kinetic + elastic + gravity + contact at t = 0, and what later corrections of
                      the state (to an orbit) added */
  double residual; /* end total - initial - works + losses; 0 but for the integration error */
  double moved;    /* sum of the absolute energies exchanged, or the largest kinetic energy seen if
                      that is more: the scale of the residual */
  double rubbed;   /* the most that friction had given by some sample; 0: none */
  double placed;   /* scale of what the rounding of positions does to the balance */
} strut_energy;

/** State of the energy balance. Open: the residual is more than 1 % of the exchanged energy. */
typedef enum strut_balance {
  STRUT_BALANCE_NOT_KEPT,
  STRUT_BALANCE_CLOSED,
  STRUT_BALANCE_OPEN
} strut_balance;

typedef struct strut_contact_summary {
  const char *node;   /* name; owned by the scene */
  double duty;        /* fraction of the window's steps in contact [1] */
  double max_height;  /* largest height above the ground in the window [m] */
  double band_needed; /* width needed where a step passes over the stick band [m/s]; otherwise 0 */
} strut_contact_summary;

/** A hinge at the end. */
typedef struct strut_hinge_summary {
  const char *hinge;    /* its name, owned by the scene */
  double angle, moment; /* [rad], [N m] */
} strut_hinge_summary;

/** A cell at the end. */
typedef struct strut_cell_summary {
  const char *cell;      /* its name, owned by the scene */
  double area, pressure; /* [m^2], [N/m] */
} strut_cell_summary;

/** A member or a hinge that broke or was released. */
typedef struct strut_break_summary {
  const char *name; /* owned by the scene */
  bool hinge;
  bool released; /* at its time; otherwise it broke */
  double time;   /* [s] */
} strut_break_summary;

/** An element whose law folds and that jumped. */
typedef struct strut_jump_summary {
  const char *name;   /* of its member, hinge, ...; owned by the scene */
  int64_t count;      /* of jumps since the run began */
  double last, freed; /* time of the last one [s], energy that they set free [J] */
} strut_jump_summary;

/** A quantity of `measure` in the scene, over the window. */
typedef struct strut_measured {
  const char *name, *unit; /* owned by the scene */
  double value;            /* SI; NAN where the run did not reach the end of its window */
  double spread; /* standard deviation of the value of each of the window's periods; or NAN */
  double scale;  /* largest absolute value over the window, of the quantity and of the terms that it
                      is made of: relative errors mean nothing where the value is far below it */
  double expected; /* expected error, SI; NAN where unknown */
  double doubt;    /* uncertainty where steps are too coarse for what happens between them, SI */
  double left;     /* uncertainty of an extreme that samples between the steps do not resolve, SI */
  double rounding; /* a value or a difference below it is rounding, SI */
  bool kept;       /* expected is within the wanted error */
  bool zero;       /* zero by symmetry: only rounding */
  const char *member; /* that of a largest `largest_force`; owned by the scene; else NULL */
  bool arrival;       /* the time of an arrival: missing where the target was not reached */
  double margin; /* of ARRIVAL: how far from the target the extreme is that decides whether and when
                    it is reached, in SI of the expression; `rounding` is of that, too */
  bool undecided; /* of ARRIVAL: the error of that extreme may be as large */
} strut_measured;

/** "reached", "never" or "not decided"; NULL: no arrival, or the window was not reached. */
STRUT_API const char *strut_measured_arrival(const strut_measured *measured);

/** Derivative of the velocity or a measured quantity by a parameter. */
typedef struct strut_summary_derivative {
  const char *of, *by; /* owned by the scene, or constants */
  char unit[80];
  strut_derivative is;
} strut_summary_derivative;

/** Kind of motion that a run with steady detection found; STRUT_MOTION_NOT_WATCHED without. */
typedef enum strut_motion {
  STRUT_MOTION_NOT_WATCHED,
  STRUT_MOTION_PERIODIC,  /* repeats itself after `repeats` drive periods */
  STRUT_MOTION_IRREGULAR, /* never repeats, but its mean is known within `interval` */
  STRUT_MOTION_TRANSIENT, /* the run ended before any of these was established */
  STRUT_MOTION_CREEPING   /* slower than matters; velocity known within `interval` */
} strut_motion;

/** "periodic", "irregular", "transient", "creeping", or "" where not watched. */
STRUT_API const char *strut_motion_name(strut_motion motion);

typedef struct strut_steady_summary {
  strut_motion kind;
  int32_t repeats; /* n of a period-n motion; 1: every drive period is the same */
  int64_t periods; /* drive periods until that was known */
  double interval; /* half-width of the confidence interval of the velocity [m/s] */
  double residual; /* change of the shape over one repetition, relative to the shape's motion */
  double left;     /* of a decay: changes still to come, over that of one repetition [1] */
  double motion,
      fastest; /* range of the shape within a period; its largest change over one so far [1] */
  /* of a motion that has not repeated itself: the mean velocity over the latter half of the run, and its 95 % confidence
     interval by eight batches [m/s]; INFINITY of a run that was too short */
  double mean, scatter;
} strut_steady_summary;

/** Choice and check of the method for a wanted accuracy; `wanted` is 0 without. */
typedef struct strut_accuracy_summary {
  double wanted; /* relative [1] */
  double
      expected; /* expected error of the velocity, relative to it or to `scale` if larger [1]; NAN where unknown */
  double scale;  /* velocity below which errors are not relative [m/s] */
  bool kept;     /* expected <= wanted */
  bool assumed;  /* nobody asked for it: the scene has no solver */
  char why[400]; /* method, step and reason, in one or two sentences */
  int64_t
      check_evaluations; /* force evaluations for choosing and checking; not among those of the run */
} strut_accuracy_summary;

/** The largest stable step where it fell below the step during the run. */
typedef struct strut_step_limit_violation {
  double limit, time; /* lowest limit and its time [s]; limit 0: never below the step */
  double since;       /* time of the first violation [s] */
  int64_t steps;      /* steps taken above the limit, to the sampling interval */
} strut_step_limit_violation;

/** A warning about a result, once per cause. */
typedef struct strut_warning {
  const char
      *code; /* identifier for programs: "energy_balance", "stick_band", "step_limit"; a constant */
  char text[600]; /* finding, likely cause and remedy: a sentence without a full stop */
} strut_warning;
enum { STRUT_MOST_WARNINGS = 8 };
/** Settling of the start; all zero where the scene does not settle or the run starts elsewhere. */
typedef struct strut_settle_summary {
  double time;           /* simulated [s] */
  double step;           /* of the Runge-Kutta method that settled [s] */
  int64_t evaluations;   /* of the forces; not in the run's */
  int32_t perturbations; /* perturbations off an unstable equilibrium */
  bool unstable; /* the Hessian at rest, with the contacts as they are, has a negative eigenvalue */
  const char *node;   /* node that moves most in it; owned by the scene; NULL where stable */
  double stiffness;   /* the lowest eigenvalue of the Hessian [N/m]; 0 where stable */
  double growth_rate; /* of that motion without damping [1/s]; 0 where stable */
} strut_settle_summary;
STRUT_API extern const strut_value_rows strut_settle_values;

/** Filled by strut_simulate; strut_summary_free releases the arrays. */
typedef struct strut_summary {
  strut_status status;    /* STRUT_OK, STRUT_DIVERGED, STRUT_INTERRUPTED, ... */
  char reason[600];       /* one sentence where status is not STRUT_OK; else empty */
  double velocity;        /* (14): mean x-velocity over the window [m/s] */
  double velocity_spread; /* standard deviation over the window's periods; NAN without periods */
  bool velocity_zero;     /* zero by symmetry: only rounding beside the node speeds */
  struct {                /* of the velocity */
    double start;         /* [s] */
    double time;          /* between the marks that the velocity is measured by [s]; or NAN */
    double work;          /* of the drives in that time [J]; NAN without works */
  } window;
  double duration;    /* from t = 0 to the end, whose state, works and losses these are [s] */
  double settle_time; /* simulated before t = 0 to come to rest [s]; not in duration */
  bool controlled;    /* stepped from outside, */
  double input_work;  /* whose changes of inputs did this part of the drive work [J] */
  strut_settle_summary settle;
  struct {
    int64_t steps;       /* of the duration */
    int64_t evaluations; /* of forces, in these steps and in what corrected the state */
    int64_t events;      /* located in time; 0 with methods that locate none */
    int64_t forced;      /* steps in which contacts or laws switched too often to be followed */
    double wall_time;    /* seconds spent stepping; never written into a file */
  } spent;
  char method[32];         /* method used */
  double step, step_limit; /* [s]; step_limit is INFINITY where nothing limits it */
  strut_step_limit_violation limit_fell;
  bool feedback; /* signals follow sensors, which the step limit leaves out */
  struct {
    size_t node_count, contact_count, hinge_count, cell_count, break_count, jump_count;
    const char **node_names;         /* (node_count) names owned by the scene */
    double *positions;               /* (node_count, 2) [m] */
    strut_contact_summary *contacts; /* (contact_count) */
    strut_hinge_summary *hinges;     /* (hinge_count) */
    strut_cell_summary *cells;       /* (cell_count) */
    strut_break_summary *breaks;     /* (break_count) in the scene's order, members first */
    strut_jump_summary *jumps;       /* (jump_count) */
  } end;                             /* where and how things are at the end, or were on the way */
  const char *measured_node;         /* node of the measured velocity; NULL: centre of mass */
  size_t measured_count;
  strut_measured *measured; /* (measured_count) in the experiment's order */
  size_t derivative_count;
  strut_summary_derivative
      *derivatives; /* (derivative_count) for each of what is measured in turn */
  strut_energy energy;
  strut_balance balance;
  strut_steady_summary steady;
  strut_accuracy_summary accuracy;
  char caveat[400]; /* why the error of the result is not known, and how to learn it; else empty */
  size_t warning_count;
  strut_warning warnings[STRUT_MOST_WARNINGS];
  double weight;     /* of the whole structure [N] */
  strut_arena arena; /* of all arrays */
} strut_summary;

/** Rows of a strut_summary: what a run has, and the same with its wall time, which no file has. */
STRUT_API extern const strut_value_rows strut_summary_values, strut_timed_summary_values;
/** Rows of a strut_summary that are columns of studies only. */
STRUT_API extern const strut_value_rows strut_summary_column_values;

/** "closed" or "open"; NULL: not kept. */
STRUT_API const char *strut_balance_name(strut_balance balance);
/** Net work of the drives over the distance that the measured point moves [N]; NAN where it stands. */
STRUT_API double strut_summary_work_per_distance(const strut_summary *summary);
/** The same over the weight [1], as `strut compare` has it; NAN where drives do no work. */
STRUT_API double strut_summary_cost_of_transport(const strut_summary *summary);

/** Adds a warning with a printf-style text; replaces one with the same code. */
STRUT_API void strut_summary_warn(strut_summary *summary, const char *code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** Removes the warning with that code, if there is one. */
STRUT_API void strut_summary_withdraw(strut_summary *summary, const char *code);

STRUT_API void strut_summary_free(strut_summary *summary);

/** Was an accuracy requested that the answer does not have? */
STRUT_API bool strut_summary_is_inaccurate(const strut_summary *summary);

/**
 * Writes what the numbers are worth: one sentence without a full stop for people, the same in all
 * outputs; empty where the run did not complete.
 */
STRUT_API void strut_summary_worth(const strut_summary *summary, char *text, size_t size);

/** Adds a warning if a requested accuracy was not reached. */
STRUT_API void strut_summary_warn_of_accuracy(strut_summary *summary);

/** Adds a warning if the start settled on an unstable equilibrium. */
STRUT_API void strut_summary_warn_of_start(strut_summary *summary);

/**
 * Writes one sentence about a start that settled on an unstable equilibrium; false where it did
 * not.
 */
STRUT_API bool strut_settle_warning(const strut_settle_summary *how, char *text, size_t size);

/** Times at which a run shall tell the values of its experiment's quantities, whatever its steps. */
typedef struct strut_run_samples {
  size_t count;       /* >= 2 */
  const double *time; /* (count) ascending, from the start of the run, the last its end [s] */
  double *value;      /* (count, quantities) those that are not reached stay as they are */
} strut_run_samples;
