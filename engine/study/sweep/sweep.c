/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sweep/sweep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "engine/integrate/lanes/batch.h"
#include "engine/run/simulate.h"
#include "engine/study/sweep/sweep_parts.h"

/* Time between two reports [s]. */
static const double OFTEN = 0.1;

/* All that the threads of one sweep share. */
typedef struct sweep {
  strut_sweep_worker worker;
  strut_slots *slots;
  strut_sweep_state *state;
  double began, told;
  int64_t next; /* of the file's points; read and written atomically, as the next one */
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

static bool make_room(const strut_sweep_plan *plan, strut_arena *arena, strut_row_buffer *room) {
  room->values = strut_arena_allocate(arena, plan->axis_columns + 1, sizeof *room->values);
  room->numbers = strut_arena_allocate(arena, plan->column_count + 1, sizeof *room->numbers);
  room->words = strut_arena_allocate(arena, plan->column_count + 1, sizeof *room->words);
  return room->values && room->numbers && room->words;
}

static bool going(sweep *s) {
  bool stopped;
#ifdef _OPENMP
#pragma omp atomic read
#endif
  stopped = s->stopped;
  const volatile sig_atomic_t *interrupt = s->worker.options->interrupt;
  return !stopped && !(interrupt && *interrupt);
}

/* The first one says why. */
static void stop(sweep *s, strut_status status, const strut_error *error) {
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

static void count_point(sweep *s, const strut_sweep_job *job) {
  const strut_slot *row = &job->room.row;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_report_progress)
#endif
  {
    strut_sweep_state *state = s->state;
    double now = strut_run_clock();
    state->done++;
    state->computed++;
    state->failed += row->status != STRUT_OK;
    state->last = job->point;
    count_warnings(state, job);
    state->row = row;
    state->seconds = now - s->began;
    if (s->worker.options->progress && now - s->told > OFTEN) {
      s->worker.options->progress(s->worker.options->progress_context, state);
      s->told = now;
    }
  }
}

/* The next point without a result; false: there is none, or none is wanted. */
static bool next_point(void *context, int64_t *point) {
  sweep *s = context;
  int64_t count = strut_slots_plan_of(s->slots)->count, i = 0;
  while (going(s)) {
#ifdef _OPENMP
#pragma omp atomic capture
#endif
    i = s->next++;
    if (i >= count) return false;
    *point = strut_slots_point(s->slots, i);
    if (!strut_slots_done(s->slots, *point)) return true;
  }
  return false;
}

static void take_point(void *context, const strut_sweep_job *job) {
  sweep *s = context;
  strut_error error = {0};
  strut_status status = job->status;
  if (!status) status = strut_slots_put(s->slots, job->point, &job->room.row, &error);
  if (status)
    stop(s, status, job->status ? &job->error : &error);
  else
    count_point(s, job);
}

static void work(sweep *s, int threads, int32_t lanes, strut_sweep_job *jobs) {
  const strut_sweep_queue queue = {s, next_point, take_point};
  (void)threads;
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(threads)
#endif
  for (int i = 0; i < threads; i++) strut_sweep_work(&s->worker, &queue, jobs + i * lanes, lanes);
}

/* No more lanes on each processor than there are points for it. */
static int32_t lanes_for(int wanted, int threads, int64_t points) {
  int32_t widest = strut_batch_widest(), lanes = 1;
  if (wanted > 0 && wanted < widest) widest = wanted;
  while (2 * lanes <= widest && (int64_t)lanes * threads < points) lanes *= 2;
  return lanes;
}

static strut_sweep_job *make_jobs(const strut_sweep_plan *plan, strut_arena *arena, size_t count) {
  strut_sweep_job *jobs = strut_arena_allocate(arena, count, sizeof *jobs);
  for (size_t i = 0; i < count && jobs; i++)
    if (!make_room(plan, arena, &jobs[i].room)) return NULL;
  return jobs;
}

strut_status strut_sweep_run(const strut_sweep_plan *plan, strut_slots *slots,
                             const strut_sweep_options *options, strut_sweep_state *state,
                             strut_error *error) {
  int threads = options->threads > 0 ? options->threads : strut_sweep_threads();
  strut_arena arena = {0};
  strut_error own = {0};
  sweep s = {.worker = {plan, options, strut_equilibrium_cache_create()},
             .slots = slots,
             .state = state,
             .began = strut_run_clock(),
             .error = error ? error : &own};
  int32_t lanes = lanes_for(options->lanes, threads, strut_slots_missing(slots));
  strut_sweep_job *jobs = make_jobs(plan, &arena, (size_t)threads * (size_t)lanes);
  int64_t count = strut_slots_plan_of(slots)->count;
  *state = (strut_sweep_state){.points = count,
                               .done = count - strut_slots_missing(slots),
                               .failed = strut_slots_failed(slots),
                               .last = -1};
  if (options->directory) strut_sweep_records_clear(options->directory);
  if (jobs && s.worker.standing)
    work(&s, threads, lanes, jobs);
  else
    s.status = strut_fail(s.error, STRUT_NO_MEMORY, "out of memory");
  if (!s.status && options->interrupt && *options->interrupt && state->done < count)
    s.status = strut_fail(s.error, STRUT_INTERRUPTED, "interrupted");
  state->seconds = strut_run_clock() - s.began;
  state->row = NULL;
  strut_equilibrium_cache_free(s.worker.standing);
  strut_arena_free(&arena);
  return s.status;
}
