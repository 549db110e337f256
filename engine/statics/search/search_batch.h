/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Descents and climbs side by side: each task by itself, results read in the tasks' order.
 *
 * A task depends only on its own description, so the number of threads changes no bit.
 */
#ifndef STRUT_ENGINE_STATICS_SEARCH_SEARCH_BATCH_H
#define STRUT_ENGINE_STATICS_SEARCH_SEARCH_BATCH_H

#include <signal.h>

#include "engine/statics/minimise.h"

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
                                                size_t count,
                                                const volatile sig_atomic_t *interrupt);

#endif
