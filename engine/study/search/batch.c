/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points that searches ask for at the same time, on all threads. See search_parts.h. */
#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>

#include "engine/study/search/search_parts.h"
#include "engine/study/sweep/sweep.h"

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

bool strut_search_batch_add(strut_search_batch *batch, int64_t outer, int64_t row,
                            const strut_study_value *values) {
  const strut_search_layout l = strut_search_layout_of(batch->plan);
  for (int64_t i = 0; i < l.scenarios; i++) {
    int64_t point = (outer * l.rows + row) * l.scenarios + i;
    if (strut_slots_done(batch->points.slots, point)) continue;
    if (!strut_grow(&batch->wanted, &batch->capacity, batch->count, sizeof *batch->wanted))
      return false;
    batch->wanted[batch->count++] = (strut_batch_point_wanted){point, values};
  }
  return true;
}

/* Leaves only the points that are still without a row, and begins with this worker's share of them. */
static int64_t forget_done(void *context) {
  strut_search_batch *batch = context;
  size_t workers = batch->options.workers > 0 ? (size_t)batch->options.workers : 1, left = 0;
  for (size_t i = 0; i < batch->count; i++)
    if (!strut_slots_done(batch->points.slots, batch->wanted[i].point))
      batch->wanted[left++] = batch->wanted[i];
  batch->count = left;
  batch->first = (size_t)batch->options.worker * ((left + workers - 1) / workers);
  strut_points_count(&batch->points);
  return (int64_t)left;
}

strut_status strut_search_batch_run(strut_search_batch *batch) {
  if (batch->count > 1) qsort(batch->wanted, batch->count, sizeof *batch->wanted, by_point);
  strut_status status = strut_points_complete(&batch->points, forget_done);
  batch->count = 0;
  return status;
}

struct strut_dialogue {
  const strut_search_task *task;
  pthread_t thread;
  sem_t asked, answered; /* a question, or the end; an answer */
  bool pending;          /* the caller has the question */
  bool ended, stop, fine;
  strut_question question;
};

static void await(sem_t *event) {
  while (sem_wait(event) != 0) continue; /* a signal came */
}

/* In the optimiser's thread: waits for the answer. */
static bool ask(void *context, size_t count, const double *points, double *values, double *broken) {
  strut_dialogue *dialogue = context;
  dialogue->question = (strut_question){count, points, values, broken};
  sem_post(&dialogue->asked);
  await(&dialogue->answered);
  return !dialogue->stop;
}

static void *optimise(void *context) {
  strut_dialogue *dialogue = context;
  const strut_search_asker asker = {dialogue, ask};
  dialogue->fine = strut_search_optimise(dialogue->task, &asker);
  dialogue->ended = true;
  sem_post(&dialogue->asked);
  return NULL;
}

strut_dialogue *strut_dialogue_begin(const strut_search_task *task) {
  strut_dialogue *dialogue = strut_allocate(1, sizeof *dialogue);
  if (!dialogue) return NULL;
  dialogue->task = task;
  sem_init(&dialogue->asked, 0, 0);
  sem_init(&dialogue->answered, 0, 0);
  if (pthread_create(&dialogue->thread, NULL, optimise, dialogue) == 0) return dialogue;
  strut_release(dialogue);
  return NULL;
}

bool strut_dialogue_question(strut_dialogue *dialogue, strut_question *question) {
  if (!dialogue->pending) await(&dialogue->asked);
  dialogue->pending = true;
  *question = dialogue->question;
  return !dialogue->ended;
}

void strut_dialogue_answer(strut_dialogue *dialogue) {
  dialogue->pending = false;
  sem_post(&dialogue->answered);
}

bool strut_dialogue_end(strut_dialogue *dialogue) {
  strut_question question;
  if (!dialogue) return true;
  while (strut_dialogue_question(dialogue, &question)) {
    dialogue->stop = true; /* it waits for the answer */
    strut_dialogue_answer(dialogue);
  }
  pthread_join(dialogue->thread, NULL);
  bool fine = dialogue->fine;
  sem_destroy(&dialogue->asked);
  sem_destroy(&dialogue->answered);
  strut_release(dialogue);
  return fine;
}
