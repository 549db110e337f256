/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One thread's points of a sweep: alone, or side by side in the batch of a batch. */
#include "engine/study/sweep/sweep.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/integrate/batch/batch.h"
#include "engine/run/simulate.h"
#include "engine/study/sweep/sweep_parts.h"

/* ---- points in lockstep ---- */

/* A new batch starts after this many consecutive points that do not fit the current one. */
enum { MOST_UNLIKE = 4 };
/* Steps below which setting up a batch costs more than its batch save. */
static const double FEWEST_STEPS = 200.0;

typedef struct desk {
  const strut_sweep_worker *worker;
  const strut_sweep_queue *queue;
  strut_sweep_job *jobs; /* (batch) */
  int32_t batch;
  strut_setup setup; /* of the example */
  strut_model *example;
  int unlike;
} desk;

/* A waiting job, started with the next point of the queue if necessary; NULL: none is left. */
static strut_sweep_job *next_job(desk *d) {
  strut_sweep_job *idle = NULL;
  int64_t point;
  for (int32_t i = 0; i < d->batch; i++) {
    if (d->jobs[i].stage == STRUT_SWEEP_WAITING) return &d->jobs[i];
    if (d->jobs[i].stage == STRUT_SWEEP_IDLE) idle = &d->jobs[i];
  }
  while (idle && d->queue->next(d->queue->context, &point)) {
    if (strut_sweep_job_begin(d->worker, point, idle)) return idle;
    d->queue->over(d->queue->context, idle);
  }
  return NULL;
}

static void finish_alone(desk *d, strut_sweep_job *job) {
  strut_sweep_job_finish(d->worker, job);
  d->queue->over(d->queue->context, job);
}

/* Should its run be in batch, or can it be where they were asked for? Leaves it with a model then. */
static bool suits_batch(strut_sweep_job *job) {
  const strut_experiment *e = &job->setup.experiment;
  const strut_integrator *method = strut_integrator_find(e->integrator);
  if (e->accuracy > 0.0 || !method || !strut_batch_knows(method)) return false;
  if (strut_experiment_span(e, &job->setup.scene).duration < FEWEST_STEPS * e->step) return false;
  return !strut_sweep_job_compile(job) && strut_batch_possible(job->model, method);
}

/* The next run for the batch. Points that the batch cannot take are run on the way. */
static bool next_run(void *context, strut_batch_point *run) {
  desk *d = context;
  for (strut_sweep_job *job; (job = next_job(d));) {
    if (!suits_batch(job)) {
      finish_alone(d, job);
      continue;
    }
    bool alike = strut_batch_takes_both(d->example, job->model);
    d->unlike = alike ? 0 : d->unlike + 1;
    if (d->unlike > MOST_UNLIKE) return false; /* it waits for the next batch */
    job->stage = STRUT_SWEEP_RUNNING;
    *run = (strut_batch_point){job->model, &job->setup.experiment, &job->options, job};
    return true;
  }
  return false;
}

static void take_result(void *context, const strut_batch_point *run, strut_status status,
                        strut_summary *summary, const strut_error *error) {
  desk *d = context;
  strut_sweep_job *job = run->context;
  if (!strut_sweep_job_take(d->worker, job, status, summary, error))
    d->queue->over(d->queue->context, job);
}

/* A model like the job's that stays. False: no memory for it. */
static bool make_example(desk *d, const strut_sweep_job *job) {
  const strut_sweep_scenes *scenes = &d->worker->plan->scenes;
  d->unlike = 0;
  if (scenes->setup(scenes->context, job->cells.values, &d->setup, NULL)) return false;
  if (!strut_model_compile(&d->setup.scene, &d->example, NULL)) return true;
  strut_setup_free(&d->setup);
  return false;
}

static void run_batch(desk *d) {
  strut_simulate_batch(&(strut_batch_source){.context = d,
                                             .next = next_run,
                                             .result = take_result,
                                             .example = d->example,
                                             .integrator = d->setup.experiment.integrator,
                                             .width = d->batch});
  strut_model_free(d->example);
  strut_setup_free(&d->setup);
  d->example = NULL;
}

void strut_sweep_work(const strut_sweep_worker *worker, const strut_sweep_queue *queue,
                      strut_sweep_job *jobs, int32_t batch) {
  desk d = {.worker = worker, .queue = queue, .jobs = jobs, .batch = batch};
  for (strut_sweep_job *job; (job = next_job(&d));) {
    if (batch > 1 && suits_batch(job) && make_example(&d, job))
      run_batch(&d);
    else
      finish_alone(&d, job);
  }
}

/* ---- threads ---- */

#ifdef _OPENMP
#include <omp.h>
#endif

/* Time between two reports [s]. */
static const double OFTEN = 0.1;

/* State shared by the threads of a sweep. */
typedef struct sweep {
  strut_sweep_worker worker;
  strut_slots *slots;
  strut_sweep_state *state;
  double began, reported; /* [s] */
  int64_t next;           /* of the file's points; read and written atomically, as the next one */
  bool stopped;
  strut_status status; /* of what stopped it, and why */
  strut_error *error;
} sweep;

int strut_sweep_threads(void) {
#ifdef _OPENMP
  const char *own = getenv("OMP_NUM_THREADS"), *slurm = getenv("SLURM_CPUS_PER_TASK");
  int threads = omp_get_num_procs(); /* those of the affinity mask */
  if (own && *own) return omp_get_max_threads();
  int given = slurm ? atoi(slurm) : 0;
  return given > 0 && given < threads ? given : threads;
#else
  return 1;
#endif
}

static bool allocate_cells(const strut_sweep_plan *plan, strut_arena *arena,
                           strut_row_buffer *cells) {
  cells->values = strut_arena_allocate(arena, plan->axis_columns + 1, sizeof *cells->values);
  cells->numbers = strut_arena_allocate(arena, plan->column_count + 1, sizeof *cells->numbers);
  cells->words = strut_arena_allocate(arena, plan->column_count + 1, sizeof *cells->words);
  return cells->values && cells->numbers && cells->words;
}

static bool is_running(sweep *s) {
  bool stopped;
#ifdef _OPENMP
#pragma omp atomic read
#endif
  stopped = s->stopped;
  const strut_flag *interrupt = s->worker.options->interrupt;
  return !stopped && !(interrupt && *interrupt);
}

/* Records the first error only. */
static void stop_sweep(sweep *s, strut_status status, const strut_error *error) {
#ifdef _OPENMP
#pragma omp critical(strut_sweep_report_progress)
#endif
  if (!s->stopped) {
    strut_fail(s->error, status, "%s", error->message);
    s->status = status;
#ifdef _OPENMP
#pragma omp atomic write
#endif
    s->stopped = true;
  }
}

void strut_sweep_count_warnings(strut_sweep_state *state, const strut_sweep_job *job) {
  for (size_t i = 0; i < job->warning_count; i++) {
    const strut_warning *warning = &job->warnings[i];
    size_t at = 0;
    while (at < state->warning_count && strcmp(state->warnings[at].code, warning->code) < 0) at++;
    bool known = at < state->warning_count && strcmp(state->warnings[at].code, warning->code) == 0;
    if (!known && state->warning_count == STRUT_SWEEP_MOST_WARNINGS) continue;
    strut_sweep_warning *to = &state->warnings[at];
    if (!known) {
      memmove(to + 1, to, (state->warning_count++ - at) * sizeof *to);
      *to = (strut_sweep_warning){.code = warning->code, .point = INT64_MAX};
    }
    to->runs++;
    if (job->point >= to->point) continue;
    to->point = job->point;
    snprintf(to->text, sizeof to->text, "%s", warning->text);
  }
}

static void count_point(sweep *s, const strut_sweep_job *job) {
  const strut_result_slot *row = &job->cells.row;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_report_progress)
#endif
  {
    strut_sweep_state *state = s->state;
    double now = strut_run_clock();
    state->done++;
    state->computed++;
    assert(state->done <= state->points);
    state->failed += row->status != STRUT_OK;
    state->last = job->point;
    strut_sweep_count_warnings(state, job);
    state->row = row;
    state->seconds = now - s->began;
    if (s->worker.options->progress && now - s->reported > OFTEN) {
      s->worker.options->progress(s->worker.options->progress_context, state);
      s->reported = now;
    }
  }
}

/* The next point without a result; false: none is left, or the sweep is being stopped. */
static bool next_point(void *context, int64_t *point) {
  sweep *s = context;
  int64_t count = strut_slots_description_of(s->slots)->count, i = 0;
  while (is_running(s)) {
#ifdef _OPENMP
#pragma omp atomic capture
#endif
    i = s->next++;
    if (i >= count) return false;
    *point = strut_slots_point(s->slots, i);
    const strut_sweep_options *options = s->worker.options;
    if (options->wants && !options->wants(options->wants_context, *point)) continue;
    if (!strut_slots_done(s->slots, *point)) return true;
  }
  return false;
}

static void store_point(void *context, const strut_sweep_job *job) {
  sweep *s = context;
  strut_error error = {0};
  strut_status status = job->status;
  if (!status) status = strut_slots_put(s->slots, job->point, &job->cells.row, &error);
  if (status)
    stop_sweep(s, status, job->status ? &job->error : &error);
  else
    count_point(s, job);
}

static void run_threads(sweep *s, int threads, int32_t batch, strut_sweep_job *jobs) {
  const strut_sweep_queue queue = {s, next_point, store_point};
  (void)threads;
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(threads)
#endif
  for (int i = 0; i < threads; i++) {
#ifdef _OPENMP
    omp_set_num_threads(1); /* of searches within a point: the points are what goes side by side */
#endif
    strut_sweep_work(&s->worker, &queue, jobs + i * batch, batch);
  }
}

int32_t strut_sweep_batch_size(int wanted, int threads, int64_t points) {
  int32_t widest = strut_batch_widest(), batch = 1;
  if (wanted > 0 && wanted < widest) widest = wanted;
  while (2 * batch <= widest && (int64_t)batch * threads < points) batch *= 2;
  return batch < 4 ? 1 : batch; /* two runs take as long one after the other */
}

strut_sweep_job *strut_sweep_make_jobs(const strut_sweep_plan *plan, strut_arena *arena,
                                       size_t count) {
  strut_sweep_job *jobs = strut_arena_allocate(arena, count, sizeof *jobs);
  for (size_t i = 0; i < count && jobs; i++)
    if (!allocate_cells(plan, arena, &jobs[i].cells)) return NULL;
  return jobs;
}

strut_status strut_sweep_run(const strut_sweep_plan *plan, strut_slots *slots,
                             const strut_sweep_options *options, strut_sweep_state *state,
                             strut_error *error) {
  int threads = options->threads > 0 ? options->threads : strut_sweep_threads();
  strut_arena arena = {0};
  strut_error own = {0};
  sweep s = {
      .worker = {.plan = plan, .options = options, .standing = strut_equilibrium_cache_create()},
      .slots = slots,
      .state = state,
      .began = strut_run_clock(),
      .error = error ? error : &own};
  int64_t missing =
      options->wants ? options->wanted - options->wanted_done : strut_slots_missing(slots);
  int32_t batch = strut_sweep_batch_size(options->batch, threads, missing);
  strut_sweep_job *jobs = strut_sweep_make_jobs(plan, &arena, (size_t)threads * (size_t)batch);
  int64_t count = strut_slots_description_of(slots)->count;
  *state = (strut_sweep_state){.points = count,
                               .done = count - strut_slots_missing(slots),
                               .failed = strut_slots_failed(slots),
                               .last = -1};
  if (options->wants) {
    count = state->points = options->wanted;
    state->done = options->wanted_done;
  }
  if (options->directory) strut_sweep_records_clear(options->directory);
  double seconds = plan->study->limit.time;
  if (jobs && seconds > 0.0)
    s.worker.watch = strut_sweep_watch_create(seconds, jobs, (size_t)threads * (size_t)batch,
                                              options->interrupt);
  if (jobs && s.worker.standing && (s.worker.watch || seconds <= 0.0))
    run_threads(&s, threads, batch, jobs);
  else
    s.status = strut_fail(s.error, STRUT_NO_MEMORY, "out of memory");
  if (!s.status && options->interrupt && *options->interrupt && state->done < count)
    s.status = strut_fail(s.error, STRUT_INTERRUPTED, "interrupted");
  strut_sweep_watch_free(s.worker.watch);
  state->seconds = strut_run_clock() - s.began;
  state->row = NULL;
  strut_equilibrium_cache_free(s.worker.standing);
  strut_arena_free(&arena);
  return s.status;
}
