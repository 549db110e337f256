/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The points of a sweep, shared out to threads. */
#include "engine/study/sweep/sweep.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/run/simulate.h"
#include "engine/study/sweep/sweep_parts.h"

void strut_sweep_work(const strut_sweep_worker *worker, const strut_sweep_queue *queue,
                      strut_sweep_job *job) {
  for (int64_t point; queue->next(queue->context, &point);) {
    strut_sweep_compute(worker, point, job);
    queue->over(queue->context, job);
  }
}

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

static void run_threads(sweep *s, int threads, strut_sweep_job *jobs) {
  const strut_sweep_queue queue = {s, next_point, store_point};
  (void)threads;
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(threads)
#endif
  for (int i = 0; i < threads; i++) {
#ifdef _OPENMP
    omp_set_num_threads(1); /* of searches within a point: the points are what goes side by side */
#endif
    strut_sweep_work(&s->worker, &queue, &jobs[i]);
  }
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
  strut_sweep_job *jobs = strut_sweep_make_jobs(plan, &arena, (size_t)threads);
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
    s.worker.watch = strut_sweep_watch_create(seconds, jobs, (size_t)threads, options->interrupt);
  if (jobs && s.worker.standing && (s.worker.watch || seconds <= 0.0))
    run_threads(&s, threads, jobs);
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
