/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a run amounts to: the figures that people quote.
 */
#ifndef STRUT_ENGINE_RUN_SUMMARY_H
#define STRUT_ENGINE_RUN_SUMMARY_H

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
  double moved;    /* sum of the absolute energies exchanged: the scale of the residual */
} strut_energy;

typedef struct strut_contact_summary {
  const char *node;  /* name; owned by the scene */
  double duty;       /* fraction of the window's steps in contact [1] */
  double max_height; /* largest height above the ground in the window [m] */
  double band_needed; /* where a step passes over its stick band: the width that would do [m/s]; or 0 */
} strut_contact_summary;

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
  int32_t repeats;      /* n of a period-n motion; 1: every drive period alike */
  int64_t periods;      /* drive periods simulated until that was known */
  double interval;      /* the velocity lies within +- this [m/s] */
  double residual;      /* change of the shape over one repetition, relative to the shape's motion */
  bool shot;            /* finished by Newton's method; else run on, and `reason` says why */
  int iterations;       /* of Newton's method; 0 where it was not asked for */
  char reason[200];
  size_t multiplier_count; /* Floquet multipliers, the largest first */
  double multiplier[STRUT_MOST_MULTIPLIERS][2]; /* real and imaginary part */
} strut_steady_summary;

/** How a run with a wanted accuracy chose its method; `wanted` is 0 without. */
typedef struct strut_accuracy_summary {
  double wanted;     /* relative [1] */
  double expected;   /* error of the velocity, relative to it or to `scale` if that is larger [1] */
  double scale;      /* [m/s] below which errors are not relative any more */
  bool kept;         /* expected <= wanted */
  char why[400];     /* which method and step, and why, in one or two sentences */
  int64_t check_evaluations; /* of the forces, spent on choosing and checking; not in the run's */
} strut_accuracy_summary;

/** The largest stable step of the shapes that a run went through, where it fell below the step. */
typedef struct strut_limit_fell {
  double limit, time; /* the lowest [s], and when that was [s]; limit 0: it never was */
  double since;       /* when it first was [s] */
  int64_t steps;      /* taken below it, by looks every so many steps */
} strut_limit_fell;

/** Owned by whoever made it with strut_simulate; strut_summary_free releases the arrays. */
typedef struct strut_summary {
  strut_status status;     /* STRUT_OK, STRUT_DIVERGED, STRUT_INTERRUPTED, ... */
  char reason[600];        /* one sentence where status is not STRUT_OK; else empty */
  double velocity;         /* (14): mean x-velocity over the window [m/s] */
  double velocity_spread;  /* standard deviation over the window's periods; NAN without periods */
  double window_start;     /* [s] */
  double duration;         /* simulated [s] */
  double settle_time;      /* simulated before t = 0 to come to rest [s]; not in duration */
  int64_t steps, force_evaluations; /* from t = 0 on */
  int64_t events;                   /* switches located in time; 0 with a method that locates none */
  char method[32];                  /* that ran */
  double step, step_limit; /* [s]; step_limit is INFINITY where nothing limits it */
  strut_limit_fell limit_fell;
  double wall_time;        /* seconds spent stepping; never written into a file */
  size_t node_count, contact_count;
  const char **node_names; /* (node_count) names owned by the scene */
  double *positions;       /* (node_count, 2) at the end [m] */
  strut_contact_summary *contacts; /* (contact_count) */
  strut_energy energy;
  strut_steady_summary steady;
  strut_accuracy_summary accuracy;
} strut_summary;

STRUT_API void strut_summary_free(strut_summary *summary);

#endif
