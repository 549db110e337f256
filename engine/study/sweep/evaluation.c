/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sweep/evaluation.h"

#include <string.h>

#include "engine/study/sweep/sweep_parts.h"

#ifdef _OPENMP
#include <omp.h>
#endif

struct strut_evaluator {
  const volatile sig_atomic_t *interrupt;
  int threads;
  strut_equilibrium_cache *equilibria;
  strut_sweep_plan plan; /* of the latest evaluation, which owns its results */
  strut_sweep_job job;
  strut_error error;
};

strut_evaluator *strut_evaluator_create(const volatile sig_atomic_t *interrupt, int threads) {
  strut_evaluator *e = strut_allocate(1, sizeof *e);
  if (!e) return NULL;
  e->interrupt = interrupt;
  e->threads = threads;
  e->equilibria = strut_equilibrium_cache_create();
  if (e->equilibria) return e;
  strut_release(e);
  return NULL;
}

void strut_evaluator_free(strut_evaluator *e) {
  if (!e) return;
  strut_sweep_plan_free(&e->plan);
  strut_equilibrium_cache_free(e->equilibria);
  strut_release(e);
}

/* The scene of the only point: the given one, which moves. */
static strut_status give_setup(void *context, const strut_study_value *values, strut_setup *setup,
                               strut_error *error) {
  strut_setup *given = context;
  (void)values;
  (void)error;
  *setup = *given;
  *given = (strut_setup){0};
  return STRUT_OK;
}

static bool allocate_cells(strut_sweep_plan *plan, strut_row_buffer *cells) {
  size_t count = plan->column_count + 1;
  cells->values = strut_arena_allocate(&plan->arena, 1, sizeof *cells->values);
  cells->numbers = strut_arena_allocate(&plan->arena, count, sizeof *cells->numbers);
  cells->words = strut_arena_allocate(&plan->arena, count, sizeof *cells->words);
  return cells->values && cells->numbers && cells->words;
}

/* Runs the point as a sweep would. False: memory is out. */
static bool compute(strut_evaluator *e, const strut_study *study) {
  const strut_sweep_options options = {.interrupt = e->interrupt};
  strut_sweep_worker worker = {.plan = &e->plan, .options = &options, .standing = e->equilibria};
  if (study->limit_time > 0.0) {
    worker.watch = strut_sweep_watch_create(study->limit_time, &e->job, 1, e->interrupt);
    if (!worker.watch) return false;
  }
#ifdef _OPENMP
  int before = omp_get_max_threads();
  omp_set_num_threads(e->threads);
#endif
  if (strut_sweep_job_begin(&worker, 0, &e->job)) strut_sweep_job_finish(&worker, &e->job);
#ifdef _OPENMP
  omp_set_num_threads(before);
#endif
  strut_sweep_watch_free(worker.watch);
  return true;
}

/* False: memory is out. */
static bool list_results(strut_evaluator *e, strut_evaluation *evaluation) {
  strut_arena *arena = &e->plan.arena;
  const strut_sweep_job *job = &e->job;
  size_t numbers = 0, words = 0;
  strut_evaluated *list = strut_arena_allocate(arena, e->plan.column_count + 1, sizeof *list);
  const char **warnings = strut_arena_allocate(arena, job->warning_count + 1, sizeof *warnings);
  if (!list || !warnings) return false;
  for (size_t i = 0; i < e->plan.column_count; i++) {
    const strut_slot_column *c = &e->plan.columns[i];
    list[i] = (strut_evaluated){.name = c->name, .unit = *c->unit ? c->unit : "1"};
    if (c->word)
      list[i].word = job->cells.words[words++];
    else
      list[i].number = job->cells.numbers[numbers++];
    if (!c->word && strcmp(c->name, STRUT_KEPT_COLUMN) == 0)
      evaluation->inaccurate = list[i].number == 0.0;
  }
  for (size_t i = 0; i < job->warning_count; i++) warnings[i] = job->warnings[i].text;
  evaluation->count = e->plan.column_count;
  evaluation->results = list;
  evaluation->warning_count = job->warning_count;
  evaluation->warnings = warnings;
  return true;
}

static strut_status no_memory(strut_evaluator *e, strut_evaluation *evaluation) {
  evaluation->status = strut_no_memory(&e->error, "");
  evaluation->message = e->error.message;
  return STRUT_OK;
}

strut_status strut_evaluate(strut_evaluator *e, const strut_study *study, strut_setup *setup,
                            strut_evaluation *evaluation) {
  const strut_sweep_scenes scenes = {.setup = give_setup, .context = setup};
  *evaluation = (strut_evaluation){0};
  e->error = (strut_error){0};
  e->job = (strut_sweep_job){0};
  strut_sweep_plan_free(&e->plan);
  strut_status status = strut_sweep_plan_of_setup(study, &scenes, setup, &e->plan, &e->error);
  if (!status && (!allocate_cells(&e->plan, &e->job.cells) || !compute(e, study)))
    status = strut_no_memory(&e->error, "");
  strut_setup_free(setup); /* nothing where the point had it */
  if (status) {
    evaluation->status = status;
    evaluation->message = e->error.message;
    return STRUT_OK;
  }
  if (e->job.status == STRUT_INTERRUPTED) return STRUT_INTERRUPTED;
  evaluation->status = e->job.status ? e->job.status : e->job.cells.row.status;
  evaluation->message =
      e->job.error.message[0] ? e->job.error.message : strut_status_text(evaluation->status);
  if (evaluation->status) return STRUT_OK;
  return list_results(e, evaluation) ? STRUT_OK : no_memory(e, evaluation);
}
