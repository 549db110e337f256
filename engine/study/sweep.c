/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sweep.h"

#include <stdlib.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "engine/run/simulate.h"
#include "engine/study/grid.h"
#include "engine/study/sweep_parts.h"

/* Time between two reports [s]. */
static const double OFTEN = 0.1;

/* All that the threads of one sweep share. */
typedef struct sweep {
  strut_sweep_worker worker;
  strut_slots *slots;
  strut_sweep_state *state;
  double began, told;
  bool stopped;        /* read and written atomically */
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

static int thread_number(void) {
#ifdef _OPENMP
  return omp_get_thread_num();
#else
  return 0;
#endif
}

static bool make_room(const strut_sweep_plan *plan, strut_arena *arena, strut_sweep_room *room) {
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
#pragma omp critical(strut_sweep_tell)
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

static void count_point(sweep *s, int64_t point, const strut_slot *row) {
#ifdef _OPENMP
#pragma omp critical(strut_sweep_tell)
#endif
  {
    strut_sweep_state *state = s->state;
    double now = strut_run_clock();
    state->done++;
    state->computed++;
    state->failed += row->status != STRUT_OK;
    state->last = point;
    state->row = row;
    state->seconds = now - s->began;
    if (s->worker.options->progress && now - s->told > OFTEN) {
      s->worker.options->progress(s->worker.options->progress_context, state);
      s->told = now;
    }
  }
}

static void visit(sweep *s, int64_t i, strut_sweep_room *room) {
  strut_error error;
  int64_t point = strut_slots_point(s->slots, i);
  if (strut_slots_done(s->slots, point) || !going(s)) return;
  strut_status status = strut_sweep_point(&s->worker, point, room, &error);
  if (!status) status = strut_slots_put(s->slots, point, &room->row, &error);
  if (status)
    stop(s, status, &error);
  else
    count_point(s, point, &room->row);
}

static void visit_all(sweep *s, int threads, strut_sweep_room *rooms) {
  int64_t count = strut_slots_plan_of(s->slots)->count;
  (void)threads;
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
#endif
  for (int64_t i = 0; i < count; i++) visit(s, i, &rooms[thread_number()]);
}

strut_status strut_sweep_run(const strut_sweep_plan *plan, strut_slots *slots,
                             const strut_sweep_options *options, strut_sweep_state *state,
                             strut_error *error) {
  int threads = options->threads > 0 ? options->threads : strut_sweep_threads();
  strut_arena arena = {0};
  strut_error own = {0};
  sweep s = {.worker = {plan, options, strut_standing_create()},
             .slots = slots,
             .state = state,
             .began = strut_run_clock(),
             .error = error ? error : &own};
  strut_sweep_room *rooms = strut_arena_allocate(&arena, (size_t)threads, sizeof *rooms);
  bool fine = rooms && s.worker.standing;
  for (int i = 0; i < threads && fine; i++) fine = make_room(plan, &arena, &rooms[i]);
  int64_t count = strut_slots_plan_of(slots)->count;
  *state = (strut_sweep_state){.points = count,
                               .done = count - strut_slots_missing(slots),
                               .failed = strut_slots_failed(slots),
                               .last = -1};
  if (fine)
    visit_all(&s, threads, rooms);
  else
    s.status = strut_fail(s.error, STRUT_NO_MEMORY, "out of memory");
  if (!s.status && options->interrupt && *options->interrupt && state->done < count)
    s.status = strut_fail(s.error, STRUT_INTERRUPTED, "interrupted");
  state->seconds = strut_run_clock() - s.began;
  state->row = NULL;
  strut_standing_free(s.worker.standing);
  strut_arena_free(&arena);
  return s.status;
}
