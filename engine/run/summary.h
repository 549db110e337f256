/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a run amounts to: the figures that people quote.
 */
#ifndef STRUT_ENGINE_RUN_SUMMARY_H
#define STRUT_ENGINE_RUN_SUMMARY_H

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
} strut_contact_summary;

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
  double step, step_limit; /* [s]; step_limit is INFINITY where nothing limits it */
  double wall_time;        /* seconds spent stepping; never written into a file */
  size_t node_count, contact_count;
  const char **node_names; /* (node_count) names owned by the scene */
  double *positions;       /* (node_count, 2) at the end [m] */
  strut_contact_summary *contacts; /* (contact_count) */
  strut_energy energy;
} strut_summary;

STRUT_API void strut_summary_free(strut_summary *summary);

#endif
