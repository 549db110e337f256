/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The clock of points: a thread that interrupts those that take longer than their study allows. */
#include <pthread.h>
#include <time.h>

#include "engine/run/simulate.h"
#include "engine/study/sweep/sweep_parts.h"

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
