/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/search/search_batch.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "engine/model/pose.h"
#include "engine/statics/curvature.h"
#include "engine/statics/search/saddle.h"
#include "engine/statics/search/starts.h"

/* Climbs and crossings draw from numbers of their own. */
static const uint64_t CLIMBS = 0x5ad1e5u, CROSSES = 0xc0551u;

typedef struct worker {
  strut_minimiser *minimiser;
  strut_climber *climber;
  double *direction; /* (n) */
} worker;

struct strut_search_tasks {
  const strut_potential *potential;
  uint64_t seed;
  int worker_count;
  worker *workers;
  strut_task_result result[STRUT_BATCH];
  strut_arena arena;
};

static int thread_count(void) {
#ifdef _OPENMP
  int most = omp_in_parallel() ? 1 : omp_get_max_threads();
  return most < STRUT_BATCH ? most : STRUT_BATCH;
#else
  return 1;
#endif
}

strut_status strut_search_tasks_create(const strut_potential *potential, uint64_t seed, bool climbs,
                                       strut_search_tasks **batch, strut_error *error) {
  strut_search_tasks *b = *batch = strut_allocate(1, sizeof *b);
  size_t length = (size_t)potential->model->length;
  if (!b) return strut_no_memory(error, "");
  b->potential = potential;
  b->seed = seed;
  b->worker_count = thread_count();
  b->workers = strut_arena_allocate(&b->arena, (size_t)b->worker_count, sizeof *b->workers);
  bool good = b->workers != NULL;
  for (int i = 0; i < STRUT_BATCH && good; i++)
    good = (b->result[i].q = strut_arena_allocate(&b->arena, length, sizeof(double)));
  for (int i = 0; i < b->worker_count && good; i++) {
    worker *w = &b->workers[i];
    w->direction = strut_arena_allocate(&b->arena, (size_t)potential->n, sizeof *w->direction);
    good = w->direction && strut_minimiser_create(potential, &w->minimiser, NULL) == STRUT_OK;
    if (good && climbs) good = (w->climber = strut_climber_create(potential));
  }
  if (good) return STRUT_OK;
  strut_search_tasks_free(b);
  *batch = NULL;
  return strut_no_memory(error, "");
}

void strut_search_tasks_free(strut_search_tasks *batch) {
  if (!batch) return;
  for (int i = 0; batch->workers && i < batch->worker_count; i++) {
    strut_minimiser_free(batch->workers[i].minimiser);
    strut_climber_free(batch->workers[i].climber);
  }
  strut_arena_free(&batch->arena);
  strut_release(batch);
}

/* Shift along x that brings b over a; 0 if something holds the structure along x. */
static double slide_onto(const strut_potential *p, const double *a, const double *b) {
  double sum = 0.0;
  int32_t nodes = p->model->node_count;
  for (int32_t i = 0; i < nodes; i++) {
    if (p->row_of[2 * i] < 0 || p->force[2 * i] != 0.0) return 0.0;
    sum += a[2 * i] - b[2 * i];
  }
  if (p->ground && p->model->contacts.count && !strut_contacts_are_level(&p->model->contacts))
    return 0.0;
  return nodes ? sum / nodes : 0.0;
}

/* The highest of seven points on the straight line from a to b. */
static void highest_between(const strut_potential *p, const double *a, const double *b, double *q) {
  size_t length = (size_t)p->model->length;
  double highest = -HUGE_VAL, best = 0.5, slide = slide_onto(p, a, b);
  for (int k = 1; k <= 8; k++) { /* the eighth time for good */
    double t = k < 8 ? k / 8.0 : best;
    for (size_t i = 0; i < length; i++) q[i] = a[i] + t * (b[i] + (i % 2 ? 0.0 : slide) - a[i]);
    double value = strut_potential_value(p, q);
    if (k < 8 && value > highest) highest = value, best = t;
  }
}

static bool climb_task(const strut_search_tasks *b, worker *w, const strut_task *task, double *q) {
  assert(w->climber);
  const strut_potential *p = b->potential;
  double far = 0.02 * (p->model->size > 0 ? p->model->size : 1.0);
  size_t bytes = (size_t)p->model->length * sizeof *q;
  if (task->kind == STRUT_TASK_CLIMB_MODE) {
    memcpy(q, task->q, bytes);
    return strut_climb_away(w->climber, (int32_t)task->number, task->side * far, q, w->direction) &&
           strut_climb(w->climber, 1, w->direction, q);
  }
  int32_t index = 1;
  if (task->kind == STRUT_TASK_CLIMB_PAIR) {
    highest_between(p, task->q, task->other, q);
  } else if (task->kind == STRUT_TASK_CLIMB_SHAPE) {
    memcpy(q, task->q, bytes);
  } else if (task->q) {
    memcpy(q, task->q, bytes);
    strut_shake(p, b->seed ^ CLIMBS, (uint64_t)task->number, q);
  } else {
    strut_random_shape(p, b->seed ^ CLIMBS, (uint64_t)task->number, q);
    index = 1 + (int32_t)(task->number / 2 % (p->n < 4 ? p->n : 4));
  }
  return index <= p->n && strut_climb(w->climber, index, NULL, q);
}

static strut_descent_end descend_task(const strut_search_tasks *b, worker *w,
                                      const strut_task *task, double *q) {
  const strut_potential *p = b->potential;
  if (task->kind == STRUT_TASK_RANDOM)
    strut_random_shape(p, b->seed, (uint64_t)task->number, q);
  else
    memcpy(q, task->q, (size_t)p->model->length * sizeof *q);
  if (task->kind == STRUT_TASK_FOLD) strut_fold(p, task->number, q);
  if (task->kind == STRUT_TASK_CROSS) {
    strut_cross(p, b->seed ^ CROSSES, (uint64_t)task->number, task->other, q);
    return strut_descend_gently(w->minimiser, q);
  }
  if (task->kind == STRUT_TASK_SHAKE) {
    strut_shake(p, b->seed ^ CROSSES, (uint64_t)task->number, q);
    return strut_descend_gently(w->minimiser, q);
  }
  if (task->kind != STRUT_TASK_DOWN) return strut_minimise(w->minimiser, q, 0.0).end;
  return strut_descend_along(w->minimiser, task->other, task->side, q) ? STRUT_DESCENT_REACHED
                                                                       : STRUT_DESCENT_EXHAUSTED;
}

static int64_t hessians_of(const worker *w) {
  return strut_minimiser_hessian_count(w->minimiser) +
         (w->climber ? strut_climber_hessian_count(w->climber) : 0);
}

static void run_task(strut_search_tasks *b, worker *w, const strut_task *task,
                     strut_task_result *result) {
  bool up = task->kind >= STRUT_TASK_CLIMB_MODE && task->kind <= STRUT_TASK_CLIMB_RANDOM;
  int64_t before = hessians_of(w);
  if (up)
    result->end =
        climb_task(b, w, task, result->q) ? STRUT_DESCENT_REACHED : STRUT_DESCENT_EXHAUSTED;
  else
    result->end = descend_task(b, w, task, result->q);
  result->hessian_count = hessians_of(w) - before;
}

/* What the threads of a batch share: each takes the next task as soon as it has finished one. */
typedef struct batch_run {
  strut_search_tasks *tasks;
  const strut_task *task;
  int count;
  const volatile sig_atomic_t *interrupt;
  atomic_int next, worker;
} batch_run;

static void *work(void *context) {
  batch_run *run = context;
  worker *w = &run->tasks->workers[atomic_fetch_add(&run->worker, 1)];
  for (int i; (i = atomic_fetch_add(&run->next, 1)) < run->count;)
    if (!run->interrupt || !*run->interrupt)
      run_task(run->tasks, w, &run->task[i], &run->tasks->result[i]);
  return NULL;
}

/* Threads of their own and not OpenMP's, which between the batches of a search wait by spinning: half again as
   much processor time, on a busy machine taken from others. */
const strut_task_result *strut_search_tasks_run(strut_search_tasks *batch, const strut_task *task,
                                                size_t count,
                                                const volatile sig_atomic_t *interrupt) {
  assert(count <= STRUT_BATCH);
  batch_run run = {.tasks = batch, .task = task, .count = (int)count, .interrupt = interrupt};
  pthread_t thread[STRUT_BATCH];
  int most = batch->worker_count < run.count ? batch->worker_count : run.count, started = 0;
  while (started + 1 < most && pthread_create(&thread[started], NULL, work, &run) == 0) started++;
  work(&run);
  for (int i = 0; i < started; i++) pthread_join(thread[i], NULL);
  return batch->result;
}
