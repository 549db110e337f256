/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The points of a sweep, shared out to threads. */
#include "engine/study/sweep/sweep.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "engine/study/sweep/sweep_parts.h"

#ifdef _OPENMP
#include <omp.h>
#endif

/* Time between two reports [s]. */
static const double OFTEN = 0.1;
/* Times between two looks at what other workers have done, which grow [ns]. */
enum { SHORTEST_PAUSE = 2000000, LONGEST_PAUSE = 500000000 };

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

static bool allocate_cells(const strut_sweep_plan *plan, strut_arena *arena, strut_sweep_job *job) {
  strut_row_buffer *cells = &job->cells;
  return STRUT_ALLOCATE(arena, STRUT_NEW(cells->values, plan->axis_columns + 1),
                        STRUT_NEW(cells->numbers, plan->column_count + 1),
                        STRUT_NEW(cells->words, plan->column_count + 1),
                        STRUT_NEW(job->derivatives, plan->derived_count * plan->by_count + 1));
}

static bool is_running(strut_points *points) {
  strut_status status;
#ifdef _OPENMP
#pragma omp atomic read
#endif
  status = points->status;
  return !status && !(points->interrupt && *points->interrupt);
}

/* Counts the warnings of a run by their code, and keeps the text of the first point. */
static void count_warnings(strut_sweep_state *state, const strut_sweep_job *job) {
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

static void count_point(strut_points *points, const strut_sweep_job *job) {
  strut_sweep_state *state = points->state;
  double now = strut_run_clock();
  state->done++;
  state->failed += job->cells.row.status != STRUT_OK;
  if (points->shared) strut_points_count(points); /* others write rows, too */
  state->computed++;
  assert(state->done <= state->points);
  state->last = job->point;
  count_warnings(state, job);
  state->row = &job->cells.row;
  state->seconds = now - points->began;
  if (!points->progress || now - points->reported <= OFTEN) return;
  points->progress(points->progress_context, state);
  points->reported = now;
}

void strut_points_count(strut_points *points) {
  int64_t count = strut_slots_description_of(points->slots)->count;
  points->state->done = count - strut_slots_missing(points->slots);
  points->state->failed = strut_slots_failed(points->slots);
}

/* Computes a point and stores its row, or stops everything; the first error counts. */
static void run_point(strut_points *points, strut_sweep_job *job, int64_t point) {
  points->compute(points->context, job, point);
  strut_error error = job->error;
  strut_status status = job->status;
  if (!status) status = strut_slots_put(points->slots, point, &job->cells.row, &error);
#ifdef _OPENMP
#pragma omp critical(strut_points_report)
#endif
  {
    if (status && !points->status) {
      strut_fail(points->error, status, "%s", error.message);
#ifdef _OPENMP
#pragma omp atomic write
#endif
      points->status = status;
    }
    if (!status) count_point(points, job);
  }
}

/* A point of the file without a result that is wanted. */
static bool choose_point(const strut_points *points, int64_t i, int64_t *point) {
  const strut_sweep_options *options = points->worker.options;
  *point = strut_slots_point(points->slots, i);
  return !(options->wants && !options->wants(options->wants_context, *point)) &&
         !strut_slots_done(points->slots, *point);
}

/* False: none is left, or all is being stopped. */
static bool next_point(strut_points *points, int64_t *point) {
  int64_t i = 0;
  while (is_running(points)) {
#ifdef _OPENMP
#pragma omp atomic capture
#endif
    i = points->next++;
    if (i >= points->count) return false;
    if (points->choose ? points->choose(points->context, i, point) : choose_point(points, i, point))
      return true;
  }
  return false;
}

/* Looks at `count` points. */
static strut_status run_points(strut_points *points, int64_t count) {
  int threads = count < points->threads ? (int)count : points->threads;
  points->next = 0, points->count = count;
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(threads > 0 ? threads : 1)
#endif
  for (int t = 0; t < threads; t++) {
#ifdef _OPENMP
    if (!points->nested) omp_set_num_threads(1); /* the points are what goes side by side */
#endif
    for (int64_t point; next_point(points, &point);) run_point(points, &points->jobs[t], point);
  }
  return points->status;
}

strut_status strut_points_complete(strut_points *points, int64_t (*left)(void *context)) {
  struct timespec pause = {.tv_nsec = SHORTEST_PAUSE};
  while (!points->status) {
    if (points->interrupt && *points->interrupt)
      return points->status = strut_fail(points->error, STRUT_INTERRUPTED, "interrupted");
    int64_t count = left(points->context);
    if (count == 0 || run_points(points, count) || left(points->context) == 0) break;
    nanosleep(&pause, NULL); /* others compute the rest; the claims of those that are killed end */
    if (pause.tv_nsec < LONGEST_PAUSE) pause.tv_nsec += pause.tv_nsec / 4;
  }
  return points->status;
}

void strut_points_begin(strut_points *points) {
  points->began = strut_run_clock();
  *points->state =
      (strut_sweep_state){.points = strut_slots_description_of(points->slots)->count, .last = -1};
  strut_points_count(points);
}

strut_status strut_points_end(strut_points *points) {
  strut_sweep_state *state = points->state;
  bool interrupted = points->interrupt && *points->interrupt;
  if (!points->status && interrupted && state->done < state->points)
    points->status = strut_fail(points->error, STRUT_INTERRUPTED, "interrupted");
  state->seconds = strut_run_clock() - points->began;
  state->row = NULL;
  return points->status;
}

strut_sweep_job *strut_sweep_make_jobs(const strut_sweep_plan *plan, strut_arena *arena,
                                       size_t count) {
  strut_sweep_job *jobs = strut_arena_allocate(arena, count, sizeof *jobs);
  for (size_t i = 0; i < count && jobs; i++)
    if (!allocate_cells(plan, arena, &jobs[i])) return NULL;
  return jobs;
}

static void compute_point(void *context, strut_sweep_job *job, int64_t point) {
  strut_sweep_compute(&((const strut_points *)context)->worker, point, job);
}

strut_status strut_points_open(strut_points *points, const strut_sweep_plan *plan,
                               const strut_sweep_options *options, strut_arena *arena) {
  double seconds = plan->study->limit.time;
  points->threads = options->threads > 0 ? options->threads : strut_sweep_threads();
  points->jobs = strut_sweep_make_jobs(plan, arena, (size_t)points->threads);
  points->worker = (strut_sweep_worker){
      .plan = plan, .options = options, .standing = strut_equilibrium_cache_create()};
  if (points->jobs && seconds > 0.0)
    points->worker.watch = strut_sweep_watch_create(seconds, points->jobs, (size_t)points->threads,
                                                    options->interrupt);
  points->interrupt = options->interrupt;
  points->progress = options->progress, points->progress_context = options->progress_context;
  bool ready = points->jobs && points->worker.standing && (points->worker.watch || seconds <= 0.0);
  return ready ? STRUT_OK : strut_no_memory(points->error, "");
}

void strut_points_close(strut_points *points) {
  strut_sweep_watch_free(points->worker.watch);
  strut_equilibrium_cache_free(points->worker.standing);
}

strut_status strut_sweep_run(const strut_sweep_plan *plan, strut_slots *slots,
                             const strut_sweep_options *options, strut_sweep_state *state,
                             strut_error *error) {
  strut_arena arena = {0};
  strut_error own = {0};
  strut_points points = {.slots = slots,
                         .state = state,
                         .error = error ? error : &own,
                         .context = options->compute ? options->compute_context : &points,
                         .compute = options->compute ? options->compute : compute_point,
                         .nested = options->nested};
  strut_points_begin(&points);
  if (options->wants) state->points = options->wanted, state->done = options->wanted_done;
  if (options->directory) strut_sweep_records_clear(options->directory);
  points.status = strut_points_open(&points, plan, options, &arena);
  if (!points.status) run_points(&points, strut_slots_description_of(slots)->count);
  strut_points_close(&points);
  strut_arena_free(&arena);
  return strut_points_end(&points);
}
