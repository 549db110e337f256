/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records one run of a sweep as `strut run -o` does. The HDF5 library is not thread-safe. */
#include <dirent.h>
#include <pthread.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/output/record_files.h"
#include "engine/output/results.h"
#include "engine/output/run_report.h"
#include "engine/run/simulate.h"
#include "engine/study/sweep/sweep_parts.h"

struct strut_sweep_record {
  strut_results results;
  char *scene_text;
  strut_sink *hdf5;
  strut_sink outer;
};

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  strut_sink *hdf5 = ((strut_sweep_record *)context)->hdf5;
  strut_status status;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  status = hdf5->begin(hdf5->context, layout, error);
  return status;
}

static strut_status take(void *context, const double *rows, size_t count, strut_error *error) {
  strut_sink *hdf5 = ((strut_sweep_record *)context)->hdf5;
  strut_status status;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  status = hdf5->rows(hdf5->context, rows, count, error);
  return status;
}

static strut_status end(void *context, strut_status run_status, strut_error *error) {
  strut_sink *hdf5 = ((strut_sweep_record *)context)->hdf5;
  strut_status status;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  status = hdf5->end(hdf5->context, run_status, error);
  return status;
}

static void discard(strut_sweep_record *record) {
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  strut_hdf5_free(record->hdf5);
  strut_results_abandon(&record->results); /* does nothing once it is complete */
  strut_release(record->scene_text);
  strut_release(record);
}

strut_sweep_record *strut_sweep_record_begin(const char *directory, int64_t point,
                                             const char *scene_text, strut_error *error) {
  strut_arena arena = {0};
  strut_sweep_record *record = strut_allocate(1, sizeof *record);
  char *path = strut_arena_format(&arena, "%s/runs/%09lld", directory, (long long)point);
  char *text = strut_arena_format(&arena, "%s", scene_text);
  if (!record || !path || !text) {
    strut_no_memory(error, "");
    strut_release(record);
    strut_arena_free(&arena);
    return NULL;
  }
  strut_status status = strut_results_begin(&record->results, path, error);
  if (!status) {
    record->hdf5 = strut_hdf5_create(record->results.stage, text);
    if (!record->hdf5) status = strut_no_memory(error, "");
  }
  if (!status) status = strut_file_write_text(record->results.stage, "scene.yaml", text, error);
  strut_arena_free(&arena);
  if (status) {
    discard(record);
    return NULL;
  }
  record->outer = (strut_sink){record, begin, take, end, record->hdf5->channels};
  return record;
}

void strut_sweep_records_clear(const char *directory) {
  strut_arena arena = {0};
  char *runs = strut_arena_format(&arena, "%s/runs", directory);
  DIR *entries = runs ? opendir(runs) : NULL;
  for (struct dirent *entry = entries ? readdir(entries) : NULL; entry; entry = readdir(entries)) {
    if (entry->d_name[0] == '.') continue;
    char *path = strut_arena_format(&arena, "%s/%s", runs, entry->d_name);
    if (path && strut_stage_sweep(path)) rmdir(path); /* fails unless it is empty */
  }
  if (entries) closedir(entries);
  strut_arena_free(&arena);
}

strut_sink *strut_sweep_record_sink(strut_sweep_record *record) { return &record->outer; }

strut_status strut_sweep_record_end(strut_sweep_record *record, const strut_scene *scene,
                                    const strut_summary *summary, bool keep, strut_error *error) {
  strut_status status = STRUT_OK;
  if (keep) {
    char *json = strut_summary_json(summary, scene, false);
    if (!json) status = strut_no_memory(error, "");
    if (!status) status = strut_file_write_text(record->results.stage, "summary.json", json, error);
    if (!status) status = strut_results_commit(&record->results, error);
    strut_release(json);
  }
  discard(record);
  return status;
}

/* The clock of points: a thread that interrupts those that take longer than their study allows. */

typedef struct strut_sweep_watch {
  pthread_t thread;
  pthread_mutex_t lock; /* of `over` and of the jobs' deadlines */
  bool over;
  double seconds;
  strut_sweep_job *jobs; /* (count) */
  size_t count;
  const volatile sig_atomic_t *interrupt; /* of the sweep, or NULL */
} strut_sweep_watch;

/* True when the sweep is over. */
static bool look_at_jobs(strut_sweep_watch *w) {
  pthread_mutex_lock(&w->lock);
  bool over = w->over, interrupted = w->interrupt && *w->interrupt;
  double now = strut_run_clock();
  for (size_t i = 0; i < w->count; i++)
    if (interrupted || (w->jobs[i].deadline > 0.0 && now > w->jobs[i].deadline))
      w->jobs[i].stop = 1;
  pthread_mutex_unlock(&w->lock);
  return over;
}

static void *watch_jobs(void *context) {
  const struct timespec pause = {.tv_nsec = 20000000};
  while (!look_at_jobs(context)) nanosleep(&pause, NULL);
  return NULL;
}

strut_sweep_watch *strut_sweep_watch_create(double seconds, strut_sweep_job *jobs, size_t count,
                                            const volatile sig_atomic_t *interrupt) {
  strut_sweep_watch *w = strut_allocate(1, sizeof *w);
  if (!w) return NULL;
  w->seconds = seconds, w->jobs = jobs, w->count = count, w->interrupt = interrupt;
  if (pthread_mutex_init(&w->lock, NULL) == 0) {
    if (pthread_create(&w->thread, NULL, watch_jobs, w) == 0) return w;
    pthread_mutex_destroy(&w->lock);
  }
  strut_release(w);
  return NULL;
}

void strut_sweep_watch_free(strut_sweep_watch *w) {
  if (!w) return;
  pthread_mutex_lock(&w->lock);
  w->over = true;
  pthread_mutex_unlock(&w->lock);
  pthread_join(w->thread, NULL);
  pthread_mutex_destroy(&w->lock);
  strut_release(w);
}

void strut_sweep_watch_begin(strut_sweep_watch *w, strut_sweep_job *job) {
  if (!w) return;
  pthread_mutex_lock(&w->lock);
  job->stop = 0;
  job->deadline = strut_run_clock() + w->seconds;
  pthread_mutex_unlock(&w->lock);
}

bool strut_sweep_watch_end(strut_sweep_watch *w, strut_sweep_job *job) {
  if (!w) return false;
  pthread_mutex_lock(&w->lock);
  bool passed = job->stop && !(w->interrupt && *w->interrupt);
  job->deadline = 0.0;
  pthread_mutex_unlock(&w->lock);
  return passed;
}
