/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points that searches ask for at the same time, on all threads. See search_parts.h. */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "engine/base/memory.h"
#include "engine/study/search/search_parts.h"
#include "engine/study/sweep/grid.h"

/* Times between two looks at what other workers have done, which grow [ns]. */
enum { SHORTEST_PAUSE = 2000000, LONGEST_PAUSE = 500000000 };

static int by_point(const void *a, const void *b) {
  int64_t first = ((const strut_batch_point_wanted *)a)->point;
  int64_t second = ((const strut_batch_point_wanted *)b)->point;
  return (first > second) - (first < second);
}

/* The variables' values at a point of the batch. */
static void give_values(const void *context, int64_t point, strut_study_value *values) {
  const strut_search_batch *b = context;
  const strut_study_search *search = b->plan->study->search;
  const strut_batch_point_wanted key = {.point = point};
  const strut_batch_point_wanted *found = bsearch(&key, b->wanted, b->count, sizeof key, by_point);
  for (size_t i = 0; found && i < search->variable_count; i++)
    values[search->column + i] = found->values[i];
}

/* The best point is computed with a tenth of the error, or half the step. */
static void make_exact(const void *context, int64_t point, strut_setup *setup) {
  const strut_search_batch *b = context;
  const strut_study *study = b->plan->study;
  const strut_search_layout layout = strut_search_layout_of(b->plan);
  strut_experiment *e = &setup->experiment;
  if (point / layout.scenarios % layout.rows != b->first_check) return;
  if (study->check_accuracy > 0.0)
    e->accuracy = study->check_accuracy;
  else if (e->accuracy > 0.0)
    e->accuracy /= study->half_step ? 2.0 : 10.0;
  else
    e->step /= 2.0, e->tolerance /= 10.0;
}

strut_search_layout strut_search_layout_of(const strut_sweep_plan *plan) {
  const strut_study *study = plan->study;
  const strut_study_search *search = study->search;
  strut_search_layout l = {.outers = 1,
                           .rows = study->axes[search->axis].count,
                           .scenarios = 1,
                           .variables = search->variable_count,
                           .conditions = search->condition_count};
  for (size_t i = 0; i < search->axis; i++) l.outers *= study->axes[i].count;
  for (size_t i = 1; i <= search->scenario_axes; i++)
    l.scenarios *= study->axes[search->axis + i].count;
  return l;
}

static bool choose_point(void *context, int64_t i, int64_t *point) {
  const strut_search_batch *b = context;
  *point = b->wanted[(b->first + (size_t)i) % b->count].point;
  return strut_slots_claim(b->points.slots, *point);
}

/* With the columns of the search. */
static void compute_point(void *context, strut_sweep_job *job, int64_t point) {
  const strut_search_batch *b = context;
  const strut_study_search *search = b->plan->study->search;
  double broken[STRUT_SEARCH_MOST_CONDITIONS], second;
  strut_sweep_compute(&b->points.worker, point, job);
  if (job->status || job->cells.row.status) return;
  double goal =
      strut_search_score(b->plan, job->cells.numbers, job->cells.row.words, &second, broken);
  strut_sweep_number(&job->cells, goal);
  if (search->second.text) strut_sweep_number(&job->cells, second);
  strut_sweep_number(&job->cells, strut_search_violation(search, broken));
}

strut_status strut_search_batch_begin(strut_search_batch *b) {
  const strut_study_search *search = b->plan->study->search;
  b->options = *b->given;
  b->options.wants = NULL;
  b->options.directory = NULL;
  b->options.values = give_values;
  b->options.adjust = make_exact;
  b->options.point_context = b;
  b->first_check = search->starts * search->evaluations;
  b->points.context = b;
  b->points.choose = choose_point, b->points.compute = compute_point;
  b->points.shared = true;
  strut_points_begin(&b->points);
  return strut_points_open(&b->points, b->plan, &b->options, &b->arena);
}

void strut_search_batch_free(strut_search_batch *b) {
  strut_points_close(&b->points);
  strut_release(b->wanted);
  strut_arena_free(&b->arena);
}

static bool add_point(strut_search_batch *b, int64_t point, const strut_study_value *values) {
  if (b->count == b->capacity) {
    size_t capacity = b->capacity ? 2 * b->capacity : 64;
    strut_batch_point_wanted *more = strut_reallocate(b->wanted, capacity, sizeof *more);
    if (!more) return false;
    b->wanted = more;
    b->capacity = capacity;
  }
  b->wanted[b->count++] = (strut_batch_point_wanted){point, values};
  return true;
}

bool strut_search_batch_add(strut_search_batch *b, int64_t outer, int64_t row,
                            const strut_study_value *values) {
  const strut_search_layout l = strut_search_layout_of(b->plan);
  bool fine = true;
  for (int64_t i = 0; i < l.scenarios && fine; i++) {
    int64_t point = (outer * l.rows + row) * l.scenarios + i;
    if (!strut_slots_done(b->points.slots, point)) fine = add_point(b, point, values);
  }
  return fine;
}

/* Leaves only the points that are still without a row. */
static void forget_done(strut_search_batch *b) {
  size_t left = 0;
  for (size_t i = 0; i < b->count; i++)
    if (!strut_slots_done(b->points.slots, b->wanted[i].point)) b->wanted[left++] = b->wanted[i];
  b->count = left;
  strut_points_count(&b->points);
}

strut_status strut_search_batch_run(strut_search_batch *b) {
  const strut_flag *interrupt = b->options.interrupt;
  struct timespec pause = {.tv_nsec = SHORTEST_PAUSE};
  size_t workers = b->options.workers > 0 ? (size_t)b->options.workers : 1;
  if (b->count > 1) qsort(b->wanted, b->count, sizeof *b->wanted, by_point);
  while (b->count > 0 && !b->points.status && !(interrupt && *interrupt)) {
    b->first = (size_t)b->options.worker * ((b->count + workers - 1) / workers); /* its share */
    strut_points_run(&b->points, (int64_t)b->count);
    forget_done(b);
    if (b->count == 0) break;
    nanosleep(&pause, NULL); /* others compute the rest; the claims of those that are killed end */
    if (pause.tv_nsec < LONGEST_PAUSE) pause.tv_nsec += pause.tv_nsec / 4;
  }
  if (!b->points.status && interrupt && *interrupt)
    b->points.status = strut_fail(b->points.error, STRUT_INTERRUPTED, "interrupted");
  b->count = 0;
  return b->points.status;
}

typedef enum turn { TURN_OPTIMISER, TURN_CALLER, TURN_NONE } turn;

struct strut_dialogue {
  const strut_search_task *task;
  pthread_t thread;
  pthread_mutex_t lock; /* of all below */
  pthread_cond_t changed;
  turn turn; /* NONE: the optimiser has ended */
  bool stop, fine;
  strut_question question;
};

static void give_turn(strut_dialogue *d, turn next) {
  pthread_mutex_lock(&d->lock);
  d->turn = next;
  pthread_cond_broadcast(&d->changed);
  pthread_mutex_unlock(&d->lock);
}

/* In the optimiser's thread: waits for the answer. */
static bool ask(void *context, size_t count, const double *points, double *values, double *broken) {
  strut_dialogue *d = context;
  pthread_mutex_lock(&d->lock);
  d->question = (strut_question){count, points, values, broken};
  d->turn = TURN_CALLER;
  pthread_cond_broadcast(&d->changed);
  while (d->turn != TURN_OPTIMISER) pthread_cond_wait(&d->changed, &d->lock);
  bool go_on = !d->stop;
  pthread_mutex_unlock(&d->lock);
  return go_on;
}

static void *optimise(void *context) {
  strut_dialogue *d = context;
  const strut_search_asker asker = {d, ask};
  d->fine = strut_search_optimise(d->task, &asker);
  give_turn(d, TURN_NONE);
  return NULL;
}

strut_dialogue *strut_dialogue_begin(const strut_search_task *task) {
  strut_dialogue *d = strut_allocate(1, sizeof *d);
  if (!d) return NULL;
  d->task = task;
  d->turn = TURN_OPTIMISER;
  if (pthread_mutex_init(&d->lock, NULL) == 0) {
    if (pthread_cond_init(&d->changed, NULL) == 0) {
      if (pthread_create(&d->thread, NULL, optimise, d) == 0) return d;
      pthread_cond_destroy(&d->changed);
    }
    pthread_mutex_destroy(&d->lock);
  }
  strut_release(d);
  return NULL;
}

bool strut_dialogue_question(strut_dialogue *d, strut_question *question) {
  pthread_mutex_lock(&d->lock);
  while (d->turn == TURN_OPTIMISER) pthread_cond_wait(&d->changed, &d->lock);
  bool asked = d->turn == TURN_CALLER;
  *question = d->question;
  pthread_mutex_unlock(&d->lock);
  return asked;
}

void strut_dialogue_answer(strut_dialogue *d) { give_turn(d, TURN_OPTIMISER); }

bool strut_dialogue_end(strut_dialogue *d) {
  strut_question question;
  if (!d) return true;
  while (strut_dialogue_question(d, &question)) {
    d->stop = true; /* it waits for the lock */
    strut_dialogue_answer(d);
  }
  pthread_join(d->thread, NULL);
  bool fine = d->fine;
  pthread_cond_destroy(&d->changed);
  pthread_mutex_destroy(&d->lock);
  strut_release(d);
  return fine;
}
