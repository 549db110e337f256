/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The path of equilibria that a load draws as its factor grows from 0, past limit points too.
 *
 * Arc-length continuation: predictor along the tangent, Newton's method with one condition on the
 * length of the step. Between events what is taut and what touches stays fixed, so that the path is
 * smooth there; each event is located on it, what changes is changed, and the walk goes on from it.
 */
#ifndef STRUT_ENGINE_STATICS_PATH_PATH_H
#define STRUT_ENGINE_STATICS_PATH_PATH_H

#include "engine/model/model.h"

/** Free coordinates that a path is followed with at most: its matrices are dense. */
enum { STRUT_PATH_COORDINATES = 600 };

typedef enum strut_path_event_kind {
  STRUT_PATH_LIMIT,       /* the factor turns back */
  STRUT_PATH_BIFURCATION, /* an eigenvalue of the stiffness changes its sign, the factor goes on */
  STRUT_PATH_SLACK,       /* a cable ceases to pull */
  STRUT_PATH_TAUT,        /* a cable begins to pull */
  STRUT_PATH_TOUCHDOWN,   /* a node meets the ground */
  STRUT_PATH_LIFT_OFF     /* a node leaves it */
} strut_path_event_kind;

/** "limit point", "bifurcation", "slack", "taut", "touchdown", "lift-off". */
STRUT_API const char *strut_path_event_name(strut_path_event_kind kind);

typedef struct strut_path_point {
  double factor;
  double arc;       /* from the beginning; coordinates in units of the structure's size, the factor
                       in units of `until` [1] */
  int32_t negative; /* eigenvalues of the stiffness below zero: 0 is stable */
  double *q;        /* (length) [m] */
} strut_path_point;

typedef struct strut_path_event {
  strut_path_event_kind kind;
  double factor, arc;
  int32_t index;      /* of the member or node that changes; of the node that moves most at a limit
                         point or bifurcation */
  const char *detail; /* in words */
  double *q;          /* (length) [m] */
} strut_path_event;

typedef enum strut_path_end {
  STRUT_PATH_UNTIL, /* the factor asked for */
  STRUT_PATH_STEPS, /* as many steps as allowed */
  STRUT_PATH_AWAY,  /* a node left all bounds, or the factor fell ten times below -until */
  STRUT_PATH_LOST   /* no equilibrium near: the remark says where */
} strut_path_end;

typedef struct strut_path {
  const char *load; /* the load's name, or NULL: all loads without a signal */
  size_t point_count, event_count;
  strut_path_point *points;
  strut_path_event *events;
  strut_path_end end;
  char remark[300]; /* why it ended before `until`; else empty */
  strut_arena arena;
} strut_path;

typedef struct strut_path_options {
  const char *load; /* NULL: all loads without a signal */
  double until;     /* factor to end at, may be negative; 0: 1 */
  int32_t steps;    /* most steps; 0: 400 */
} strut_path_options;

/**
 * Begins at the equilibrium that the start comes to rest in without the load. Gravity and other loads
 * stay as they are. A named load with a signal counts with its force alone. Friction and drives are
 * left out. strut_path_free releases it, after a failure too; the model must outlive it. STRUT_USAGE
 * for a load that is not there or no load at all, STRUT_NOT_SETTLED where there is no equilibrium to
 * begin at, STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_path_follow(const strut_model *model,
                                         const strut_path_options *options, strut_path *path,
                                         strut_error *error);
STRUT_API void strut_path_free(strut_path *path);

#endif
