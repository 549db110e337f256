/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * All stationary points of one potential: found from many starts, merged, classified and connected.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/statics/minimise.h"
#include "engine/statics/potential.h"
#include "engine/statics/search/critical_point.h"

/**
 * Of `starts` that met `distinct` minima, `once` of these once and `twice` twice. The variance of
 * Good and Turing's estimate is Esty's, (once + 2 twice) / starts^2.
 */
STRUT_API strut_missed strut_estimate_missed(int64_t starts, int64_t distinct, int64_t once,
                                             int64_t twice);

typedef struct strut_critical_set {
  size_t count;
  strut_critical_point *points; /* minima by energy, then saddles by energy, then maxima */
  int64_t starts;               /* tried for minima */
  int64_t saddle_starts;        /* tried for saddles */
  int64_t exhausted, runaway;   /* starts that ended nowhere */
  strut_missed missed;          /* minima that were not found */
  int64_t unmet;                /* minima found that no random start met: their basins are small */
  int64_t unseen;               /* at least as many more minima exist, at 95 % */
  bool cut_short; /* the structure is too large for as many starts and climbs as it asks for */
  bool climbs;    /* saddles were looked for */
  strut_arena arena;
} strut_critical_set;

typedef struct strut_critical_effort {
  int64_t starts; /* random starts for minima; 0: until `missed` is small, within reason */
  uint64_t seed;
  int32_t searches;            /* searches that share the work limit, one per support set; 0: 1 */
  bool saddles;                /* look for saddles too, and where they lead down to */
  size_t extra_count;          /* starts that the caller knows of, tried first */
  const double *const *extra;  /* (extra_count) each (length) */
  size_t hint_count;           /* shapes close to a saddle with one negative eigenvalue */
  const double *const *hint;   /* (hint_count) each (length) */
  const strut_flag *interrupt; /* ends the search with STRUT_INTERRUPTED; may be NULL */
} strut_critical_effort;

/**
 * Starts: the model's own, mirror images member by member, `extra`, then random ones, each from a
 * generator of its own, so that threads change no bit; then what the minima found lead to, folded
 * or with the nodes of two put together, and both sides of every saddle, by steps short enough for
 * the smallest wells. Merged are points that a rigid motion of the whole, mirrored or not, carries
 * onto each other, if scene and supports fix at most three coordinates (then only placements
 * differ); else only equal points. Above STRUT_DENSE_STATICS coordinates only the model's own start
 * and `extra` are tried unless `starts` says otherwise. Below, the work is bounded, counted in
 * decomposed Hessians, to some ten seconds of one core in all; cut_short reports an early end.
 */
STRUT_API strut_status strut_critical_search(const strut_potential *potential,
                                             const strut_critical_effort *effort,
                                             strut_critical_set *set, strut_error *error);
STRUT_API void strut_critical_free(strut_critical_set *set);

/** The rigid motion that brings one shape nearest to another by least squares: x is mirrored first if side is -1. */
typedef struct strut_rigid_fit {
  double from[2], to[2], cosine, sine, side;
} strut_rigid_fit;
/** Of q onto a, both (2 nodes); shapes without extent are only shifted. */
strut_rigid_fit strut_rigid_fit_find(int32_t nodes, const double *a, const double *positions,
                                     double side);
void strut_rigid_fit_apply(const strut_rigid_fit *fit, const double at[2], double moved[2]);

/**
 * Largest distance between corresponding nodes after the best rigid motion carries b onto a, mirror
 * images allowed if `mirror`; *mirrored: one was used (may be NULL) [m].
 */
STRUT_API double strut_shape_distance(const strut_model *model, const double *first,
                                      const double *second, bool mirror, bool *mirrored);

/* Descents and climbs side by side: each task by itself, results read in the tasks' order.
 *
 * A task depends only on its own description, so the number of threads changes no bit.
 */

/** Tasks run, and their results are read, in groups of this size. */
enum { STRUT_BATCH = 64 };

typedef enum strut_task_kind {
  STRUT_TASK_SHAPE,        /* down from q */
  STRUT_TASK_FOLD,         /* down from fold `number` of q */
  STRUT_TASK_CROSS,        /* down by short steps from q with some nodes where `other` has them */
  STRUT_TASK_SHAKE,        /* down by short steps from q shaken, by `number` */
  STRUT_TASK_RANDOM,       /* down from random shape `number` */
  STRUT_TASK_CLIMB_MODE,   /* up from the minimum q along mode `number`, `side` +-1 */
  STRUT_TASK_CLIMB_SHAPE,  /* up from q itself, which is close to a saddle */
  STRUT_TASK_CLIMB_PAIR,   /* up from the highest point on the straight line from q to other */
  STRUT_TASK_CLIMB_RANDOM, /* up from random shape `number`, or from q shaken if not NULL */
  STRUT_TASK_DOWN          /* down from the saddle q along `other`, `side` +-1 */
} strut_task_kind;

typedef struct strut_task {
  strut_task_kind kind;
  int64_t number;
  double side;
  const double *q, *other; /* (length) */
  int32_t from;            /* index of the point that the task belongs to */
} strut_task;

typedef struct strut_task_result {
  strut_descent_end end;
  double *q;             /* (length) where it ended */
  int64_t hessian_count; /* Hessians decomposed */
} strut_task_result;

typedef struct strut_search_tasks strut_search_tasks;
/** climbs: will there be any? Only below STRUT_DENSE_STATICS coordinates. */
strut_status strut_search_tasks_create(const strut_potential *potential, uint64_t seed, bool climbs,
                                       strut_search_tasks **batch, strut_error *error);
void strut_search_tasks_free(strut_search_tasks *batch);

/**
 * Runs up to STRUT_BATCH tasks; the results are valid until the next call. Tasks that begin once
 * *interrupt is not 0 are left out, and then no result means anything; `interrupt` may be NULL.
 */
const strut_task_result *strut_search_tasks_run(strut_search_tasks *batch, const strut_task *task,
                                                size_t count, const strut_flag *interrupt);

/* A set of stationary points without duplicates, with copies of one shape merged. */

typedef struct strut_congruent_copy strut_congruent_copy;

typedef struct strut_stationary_set {
  const strut_potential *potential;
  strut_arena *arena;               /* of the points; the caller's */
  bool congruent;                   /* copies of one shape are one point */
  bool shifts[2], turns;            /* rigid motions that no support, load or ground forbids */
  double near;                      /* two shapes are one within this [m] */
  double flat;                      /* two energies may differ by this anyway [J] */
  size_t count, room[2];            /* of points, and of placements */
  strut_critical_point *points;     /* of strut_allocate */
  strut_congruent_copy **placement; /* (count) their different placements; of strut_allocate */
} strut_stationary_set;

void strut_stationary_set_start(strut_stationary_set *set, const strut_potential *potential,
                                strut_arena *arena);
void strut_stationary_set_free(strut_stationary_set *set);

/** Finds or judges and adds q; *index is its point, whose `found` has grown by one. */
strut_status strut_stationary_set_add(strut_stationary_set *set, const double *positions,
                                      int32_t *index, bool *fresh, strut_error *error);
/** The k-th different placement of a point (length), or NULL. */
const double *strut_stationary_set_placement(const strut_stationary_set *set, int32_t index,
                                             int32_t k);

/** Numbers the shapes: points of one number are mirror images of each other. */
void strut_number_shapes(const strut_stationary_set *like, strut_critical_point *points,
                         size_t count);

/* Climbs from a shape to a stationary point with a given number of unstable directions.
 *
 * The potential is turned upside down along the modes that are followed (image function), so that a
 * trust-region descent ends on a saddle: along the softest modes, or along the one that leans most
 * on a given direction.
 */

typedef struct strut_climber strut_climber;
/** For one thread at a time, in the arena; the minimiser of the same potential polishes the ends. NULL: out of memory. */
strut_climber *strut_climber_create(const strut_potential *potential, strut_minimiser *minimiser,
                                    strut_arena *arena);
/** Hessians decomposed so far: a measure of the work done. */
int64_t strut_climber_hessian_count(const strut_climber *climber);

/**
 * Moves q (length) up along `index` >= 1 modes and down all others. direction (n), or NULL: which
 * mode to follow first, with index 1. True if g = 0 there to what rounding allows.
 */
bool strut_climb(strut_climber *climber, int32_t index, const double *direction, double *positions);

/**
 * Moves q by `far` along mode number `mode` of its Hessian, ascending, idle ones not counted, to
 * start a climb; that direction is written to direction (n). False if there are fewer modes.
 */
bool strut_climb_away(strut_climber *climber, int32_t mode, double far, double *positions,
                      double *direction);

/* Shapes to start a search from: folds of a known shape, and random ones, each by its number alone. */

/** Number of folds of a shape: mirror images of the whole, of either side of a member, and
    of single nodes across the line through two of their neighbours. */
int64_t strut_fold_count(const strut_potential *potential);
