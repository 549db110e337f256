/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a run amounts to: the figures that people quote.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_SUMMARY_H
#define STRUT_ENGINE_RUN_MEASURE_SUMMARY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** Where the energy is and where it went, in [J]; works and losses count from t = 0. */
typedef struct strut_energy {
  double kinetic, elastic, gravity; /* at the end; gravity is zero at y = 0 (x = 0) */
  double contact;                   /* elastic energy of the ground's springs at the end */
  double drive_work;                /* done on the structure by the actuators */
  double load_work;                 /* by loads */
  double belt_work;                 /* by the moving ground */
  double dissipated_members, dissipated_contact, dissipated_friction; /* positive: lost */
  double initial;  /* kinetic + elastic + gravity + contact at t = 0 */
  double residual; /* end total - initial - works + losses; 0 but for the integration error */
  double moved;    /* sum of the absolute energies exchanged, or the largest kinetic energy seen if
                      that is more: the scale of the residual */
} strut_energy;

/** Does the energy balance close? Open: the residual is more than 1 % of what moved. */
typedef enum strut_balance {
  STRUT_BALANCE_NOT_KEPT,
  STRUT_BALANCE_CLOSED,
  STRUT_BALANCE_OPEN
} strut_balance;

typedef struct strut_contact_summary {
  const char *node;  /* name; owned by the scene */
  double duty;       /* fraction of the window's steps in contact [1] */
  double max_height; /* largest height above the ground in the window [m] */
  double
      band_needed; /* where a step passes over its stick band: the width that would do [m/s]; or 0 */
} strut_contact_summary;

/** One of the quantities that the scene's `measure` names, over the window. */
typedef struct strut_measured {
  const char *name, *unit; /* owned by the scene */
  double value;            /* SI; NAN where the run did not come to the end of its window */
  double spread; /* standard deviation of the value of each of the window's periods; or NAN */
  double scale;  /* largest absolute value over the window, of the quantity and of the terms that it
                      is made of: relative errors mean nothing where the value is far below it */
  double expected; /* error to expect, SI; NAN where that is not known */
  bool kept;       /* expected is within what is wanted */
  bool zero;       /* zero by symmetry: the value is nothing but rounding */
} strut_measured;

/** What a run that stops when it is steady found; `kind` is STRUT_MOTION_NOT_WATCHED without it. */
typedef enum strut_motion {
  STRUT_MOTION_NOT_WATCHED,
  STRUT_MOTION_PERIODIC,  /* repeats itself after `repeats` drive periods */
  STRUT_MOTION_IRREGULAR, /* never agreed, but its mean is known within `interval` */
  STRUT_MOTION_TRANSIENT  /* the time ran out before either could be said */
} strut_motion;

enum { STRUT_MOST_MULTIPLIERS = 8 };
typedef struct strut_steady_summary {
  strut_motion kind;
  int32_t repeats; /* n of a period-n motion; 1: every drive period alike */
  int64_t periods; /* drive periods simulated until that was known */
  double interval; /* the velocity lies within +- this [m/s] */
  double residual; /* change of the shape over one repetition, relative to the shape's motion */
  bool shot;       /* finished by Newton's method; else run on, and `reason` says why */
  int iterations;  /* of Newton's method; 0 where it was not asked for */
  char reason[200];
  size_t multiplier_count;                      /* Floquet multipliers, the largest first */
  double multiplier[STRUT_MOST_MULTIPLIERS][2]; /* real and imaginary part */
} strut_steady_summary;

/** How a run with a wanted accuracy chose its method; `wanted` is 0 without. */
typedef struct strut_accuracy_summary {
  double wanted;   /* relative [1] */
  double expected; /* error of the velocity, relative to it or to `scale` if that is larger [1];
                        NAN where the runs that were made do not tell it */
  double scale;    /* [m/s] below which errors are not relative any more */
  bool kept;       /* expected <= wanted */
  char why[400];   /* which method and step, and why, in one or two sentences */
  int64_t check_evaluations; /* of the forces, spent on choosing and checking; not in the run's */
} strut_accuracy_summary;

/** The largest stable step of the shapes that a run went through, where it fell below the step. */
typedef struct strut_step_limit_violation {
  double limit, time; /* the lowest [s], and when that was [s]; limit 0: it never was */
  double since;       /* when it first was [s] */
  int64_t steps;      /* taken below it, by looks every so many steps */
} strut_step_limit_violation;

/** What a user must know of a result beside its figures: once per cause. */
typedef struct strut_warning {
  const char *code; /* for programs: "energy_balance", "stick_band", "step_limit"; a constant */
  char text[600]; /* what it is, its likely cause and the remedy: a sentence without a full stop */
} strut_warning;
enum { STRUT_MOST_WARNINGS = 8 };
/** How the start came to rest; all zero where the scene does not settle or the run starts elsewhere. */
typedef struct strut_settle_summary {
  double step;           /* of the Runge-Kutta method that settled [s] */
  int64_t evaluations;   /* of the forces; not in the run's */
  int32_t perturbations; /* times it was pushed off an unstable equilibrium */
  bool unstable;         /* the Hessian at rest, contacts as they are, has a negative direction */
  const char *node;      /* that moves most in it; owned by the scene; NULL where stable */
  double stiffness;      /* the lowest eigenvalue of the Hessian [N/m]; 0 where stable */
  double growth_rate;    /* of that motion without damping [1/s]; 0 where stable */
} strut_settle_summary;

/** Owned by whoever made it with strut_simulate; strut_summary_free releases the arrays. */
typedef struct strut_summary {
  strut_status status;    /* STRUT_OK, STRUT_DIVERGED, STRUT_INTERRUPTED, ... */
  char reason[600];       /* one sentence where status is not STRUT_OK; else empty */
  double velocity;        /* (14): mean x-velocity over the window [m/s] */
  double velocity_spread; /* standard deviation over the window's periods; NAN without periods */
  bool velocity_zero;     /* zero by symmetry: nothing but rounding beside the nodes' speeds */
  double window_start;    /* [s] */
  double duration;        /* simulated [s] */
  double settle_time;     /* simulated before t = 0 to come to rest [s]; not in duration */
  strut_settle_summary settle;
  int64_t steps, force_evaluations; /* from t = 0 on */
  int64_t events;          /* switches located in time; 0 with a method that locates none */
  char method[32];         /* that ran */
  double step, step_limit; /* [s]; step_limit is INFINITY where nothing limits it */
  strut_step_limit_violation limit_fell;
  double wall_time; /* seconds spent stepping; never written into a file */
  size_t node_count, contact_count;
  const char **node_names;         /* (node_count) names owned by the scene */
  double *positions;               /* (node_count, 2) at the end [m] */
  strut_contact_summary *contacts; /* (contact_count) */
  const char *measured_node;       /* whose velocity it is; NULL: the centre of mass's */
  size_t measured_count;
  strut_measured *measured; /* (measured_count) in the experiment's order */
  strut_energy energy;
  strut_balance balance;
  strut_steady_summary steady;
  strut_accuracy_summary accuracy;
  char caveat[400]; /* why the error of the result is not known, and how to learn it; else empty */
  size_t warning_count;
  strut_warning warnings[STRUT_MOST_WARNINGS];
} strut_summary;

/** Adds a warning with a printf-style text; one whose code is there already is replaced. */
STRUT_API void strut_summary_warn(strut_summary *summary, const char *code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

STRUT_API void strut_summary_free(strut_summary *summary);

/** Warns of a start that settled on an unstable equilibrium, if it did. */
STRUT_API void strut_summary_warn_of_start(strut_summary *summary);

/** One sentence about a start that settled on an unstable equilibrium; false where it did not. */
STRUT_API bool strut_settle_warning(const strut_settle_summary *how, char *text, size_t size);

#endif
