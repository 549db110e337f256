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
  const strut_search_batch *batch = context;
  const strut_study_search *search = batch->plan->study->search;
  const strut_batch_point_wanted key = {.point = point};
  const strut_batch_point_wanted *found =
      bsearch(&key, batch->wanted, batch->count, sizeof key, by_point);
  for (size_t i = 0; found && i < search->variable_count; i++)
    values[search->column + i] = found->values[i];
}

/* The best point is computed with a tenth of the error, or half the step. */
static void make_exact(const void *context, int64_t point, strut_setup *setup) {
  const strut_search_batch *batch = context;
  const strut_study *study = batch->plan->study;
  const strut_search_layout layout = strut_search_layout_of(batch->plan);
  strut_experiment *experiment = &setup->experiment;
  if (point / layout.scenarios % layout.rows != batch->first_check) return;
  if (study->check_accuracy > 0.0)
    experiment->accuracy = study->check_accuracy;
  else if (experiment->accuracy > 0.0)
    experiment->accuracy /= study->half_step ? 2.0 : 10.0;
  else
    experiment->step /= 2.0, experiment->tolerance /= 10.0;
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
  const strut_search_batch *batch = context;
  *point = batch->wanted[(batch->first + (size_t)i) % batch->count].point;
  return strut_slots_claim(batch->points.slots, *point);
}

/* With the columns of the search. */
static void compute_point(void *context, strut_sweep_job *job, int64_t point) {
  const strut_search_batch *batch = context;
  const strut_study_search *search = batch->plan->study->search;
  double broken[STRUT_SEARCH_MOST_CONDITIONS], second;
  strut_sweep_compute(&batch->points.worker, point, job);
  if (job->status || job->cells.row.status) return;
  double goal =
      strut_search_score(batch->plan, job->cells.numbers, job->cells.row.words, &second, broken);
  strut_sweep_number(&job->cells, goal);
  if (search->second.text) strut_sweep_number(&job->cells, second);
  strut_sweep_number(&job->cells, strut_search_violation(search, broken));
}

strut_status strut_search_batch_begin(strut_search_batch *batch) {
  const strut_study_search *search = batch->plan->study->search;
  batch->options = *batch->given;
  batch->options.wants = NULL;
  batch->options.directory = NULL;
  batch->options.values = give_values;
  batch->options.adjust = make_exact;
  batch->options.point_context = batch;
  batch->first_check = search->starts * search->evaluations;
  batch->points.context = batch;
  batch->points.choose = choose_point, batch->points.compute = compute_point;
  batch->points.shared = true;
  strut_points_begin(&batch->points);
  return strut_points_open(&batch->points, batch->plan, &batch->options, &batch->arena);
}

void strut_search_batch_free(strut_search_batch *batch) {
  strut_points_close(&batch->points);
  strut_release(batch->wanted);
  strut_arena_free(&batch->arena);
}

static bool add_point(strut_search_batch *batch, int64_t point, const strut_study_value *values) {
  if (!strut_grow(&batch->wanted, &batch->capacity, batch->count, sizeof *batch->wanted))
    return false;
  batch->wanted[batch->count++] = (strut_batch_point_wanted){point, values};
  return true;
}

bool strut_search_batch_add(strut_search_batch *batch, int64_t outer, int64_t row,
                            const strut_study_value *values) {
  const strut_search_layout l = strut_search_layout_of(batch->plan);
  bool fine = true;
  for (int64_t i = 0; i < l.scenarios && fine; i++) {
    int64_t point = (outer * l.rows + row) * l.scenarios + i;
    if (!strut_slots_done(batch->points.slots, point)) fine = add_point(batch, point, values);
  }
  return fine;
}

/* Leaves only the points that are still without a row. */
static void forget_done(strut_search_batch *batch) {
  size_t left = 0;
  for (size_t i = 0; i < batch->count; i++)
    if (!strut_slots_done(batch->points.slots, batch->wanted[i].point))
      batch->wanted[left++] = batch->wanted[i];
  batch->count = left;
  strut_points_count(&batch->points);
}

strut_status strut_search_batch_run(strut_search_batch *batch) {
  const strut_flag *interrupt = batch->options.interrupt;
  struct timespec pause = {.tv_nsec = SHORTEST_PAUSE};
  size_t workers = batch->options.workers > 0 ? (size_t)batch->options.workers : 1;
  if (batch->count > 1) qsort(batch->wanted, batch->count, sizeof *batch->wanted, by_point);
  while (batch->count > 0 && !batch->points.status && !(interrupt && *interrupt)) {
    batch->first =
        (size_t)batch->options.worker * ((batch->count + workers - 1) / workers); /* its share */
    strut_points_run(&batch->points, (int64_t)batch->count);
    forget_done(batch);
    if (batch->count == 0) break;
    nanosleep(&pause, NULL); /* others compute the rest; the claims of those that are killed end */
    if (pause.tv_nsec < LONGEST_PAUSE) pause.tv_nsec += pause.tv_nsec / 4;
  }
  if (!batch->points.status && interrupt && *interrupt)
    batch->points.status = strut_fail(batch->points.error, STRUT_INTERRUPTED, "interrupted");
  batch->count = 0;
  return batch->points.status;
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

static void give_turn(strut_dialogue *dialogue, turn next) {
  pthread_mutex_lock(&dialogue->lock);
  dialogue->turn = next;
  pthread_cond_broadcast(&dialogue->changed);
  pthread_mutex_unlock(&dialogue->lock);
}

/* In the optimiser's thread: waits for the answer. */
static bool ask(void *context, size_t count, const double *points, double *values, double *broken) {
  strut_dialogue *dialogue = context;
  pthread_mutex_lock(&dialogue->lock);
  dialogue->question = (strut_question){count, points, values, broken};
  dialogue->turn = TURN_CALLER;
  pthread_cond_broadcast(&dialogue->changed);
  while (dialogue->turn != TURN_OPTIMISER) pthread_cond_wait(&dialogue->changed, &dialogue->lock);
  bool go_on = !dialogue->stop;
  pthread_mutex_unlock(&dialogue->lock);
  return go_on;
}

static void *optimise(void *context) {
  strut_dialogue *dialogue = context;
  const strut_search_asker asker = {dialogue, ask};
  dialogue->fine = strut_search_optimise(dialogue->task, &asker);
  give_turn(dialogue, TURN_NONE);
  return NULL;
}

strut_dialogue *strut_dialogue_begin(const strut_search_task *task) {
  strut_dialogue *dialogue = strut_allocate(1, sizeof *dialogue);
  if (!dialogue) return NULL;
  dialogue->task = task;
  dialogue->turn = TURN_OPTIMISER;
  if (pthread_mutex_init(&dialogue->lock, NULL) == 0) {
    if (pthread_cond_init(&dialogue->changed, NULL) == 0) {
      if (pthread_create(&dialogue->thread, NULL, optimise, dialogue) == 0) return dialogue;
      pthread_cond_destroy(&dialogue->changed);
    }
    pthread_mutex_destroy(&dialogue->lock);
  }
  strut_release(dialogue);
  return NULL;
}

bool strut_dialogue_question(strut_dialogue *dialogue, strut_question *question) {
  pthread_mutex_lock(&dialogue->lock);
  while (dialogue->turn == TURN_OPTIMISER) pthread_cond_wait(&dialogue->changed, &dialogue->lock);
  bool asked = dialogue->turn == TURN_CALLER;
  *question = dialogue->question;
  pthread_mutex_unlock(&dialogue->lock);
  return asked;
}

void strut_dialogue_answer(strut_dialogue *dialogue) { give_turn(dialogue, TURN_OPTIMISER); }

bool strut_dialogue_end(strut_dialogue *dialogue) {
  strut_question question;
  if (!dialogue) return true;
  while (strut_dialogue_question(dialogue, &question)) {
    dialogue->stop = true; /* it waits for the lock */
    strut_dialogue_answer(dialogue);
  }
  pthread_join(dialogue->thread, NULL);
  bool fine = dialogue->fine;
  pthread_cond_destroy(&dialogue->changed);
  pthread_mutex_destroy(&dialogue->lock);
  strut_release(dialogue);
  return fine;
}
