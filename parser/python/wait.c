/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Long calls. Python runs the handlers of signals between two of its own instructions only, and only in the
 * thread that began the program. A call therefore computes in a thread of its own, and the thread that made it
 * looks for signals: Ctrl-C ends everything within a moment, also what reports no progress.
 */
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>

#include "parser/python/module.h"

#define LOOK_EVERY 50000000L /* ns */

typedef struct {
  void (*compute)(void *context);
  void *context;
  pthread_mutex_t mutex;
  pthread_cond_t changed;
  int done;
  double fraction;
} call;

static void *compute(void *argument) {
  call *c = argument;
  c->compute(c->context);
  pthread_mutex_lock(&c->mutex);
  c->done = 1;
  pthread_cond_signal(&c->changed);
  pthread_mutex_unlock(&c->mutex);
  return NULL;
}

static int note_progress(void *context, double fraction) {
  call *c = context;
  pthread_mutex_lock(&c->mutex);
  c->fraction = fraction;
  pthread_mutex_unlock(&c->mutex);
  return 0;
}

/* Starts the thread, which receives no signals: 0, or what pthread_create returns. */
static int start(call *c, pthread_t *thread) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  int refused = pthread_create(thread, NULL, compute, c);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return refused;
}

/* Waits until the call is done, or a moment: 1 if it is done. */
static int is_done(call *c, int patient) {
  struct timespec until;
  clock_gettime(CLOCK_MONOTONIC, &until);
  until.tv_nsec += LOOK_EVERY;
  if (until.tv_nsec >= 1000000000L) {
    until.tv_nsec -= 1000000000L;
    until.tv_sec++;
  }
  int late = 0;
  pthread_mutex_lock(&c->mutex);
  while (!c->done && !late) {
    late = patient ? pthread_cond_wait(&c->changed, &c->mutex)
                   : pthread_cond_timedwait(&c->changed, &c->mutex, &until);
  }
  int done = c->done;
  pthread_mutex_unlock(&c->mutex);
  return done;
}

/* Handlers of signals and progress(fraction), with the interpreter's lock: 0, or -1 if one raises. */
static int look(call *c, PyObject *progress) {
  if (PyErr_CheckSignals() != 0) {
    return -1;
  }
  if (progress == Py_None) {
    return 0;
  }
  pthread_mutex_lock(&c->mutex);
  double fraction = c->fraction;
  pthread_mutex_unlock(&c->mutex);
  PyObject *answer = PyObject_CallFunction(progress, "d", fraction);
  Py_XDECREF(answer);
  return answer == NULL ? -1 : 0;
}

int strut_py_wait(void (*function)(void *), void *context, strutlib_control *control,
                  PyObject *progress) {
  call c = {.compute = function, .context = context};
  pthread_condattr_t attributes;
  pthread_condattr_init(&attributes);
  pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
  pthread_mutex_init(&c.mutex, NULL);
  pthread_cond_init(&c.changed, &attributes);
  pthread_condattr_destroy(&attributes);
  if (control != NULL && progress != Py_None) {
    strutlib_control_on_progress(control, note_progress, &c);
  }
  int raised = 0;
  pthread_t thread;
  PyThreadState *unlocked = PyEval_SaveThread();
  if (start(&c, &thread) != 0) { /* no threads left: then without Ctrl-C */
    compute(&c);
  } else {
    while (!is_done(&c, raised)) {
      PyEval_RestoreThread(unlocked);
      raised = look(&c, progress) != 0;
      if (raised && control != NULL) {
        strutlib_interrupt(control);
      }
      unlocked = PyEval_SaveThread();
    }
    pthread_join(thread, NULL);
  }
  PyEval_RestoreThread(unlocked);
  if (control != NULL) {
    strutlib_control_on_progress(control, NULL, NULL);
  }
  pthread_cond_destroy(&c.changed);
  pthread_mutex_destroy(&c.mutex);
  return raised ? -1 : 0;
}
