/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/search/dialogue.h"

#include <pthread.h>

#include "engine/base/memory.h"

typedef enum turn { TURN_OPTIMISER, TURN_CALLER, TURN_NONE } turn;

struct strut_dialogue {
  const strut_search_task *task;
  pthread_t thread;
  pthread_mutex_t lock; /* of all below */
  pthread_cond_t changed;
  turn turn; /* NONE: the optimiser has ended */
  bool stop, fine;
  strut_question question;
};

static void give_turn(strut_dialogue *d, turn next) {
  pthread_mutex_lock(&d->lock);
  d->turn = next;
  pthread_cond_broadcast(&d->changed);
  pthread_mutex_unlock(&d->lock);
}

/* In the optimiser's thread: waits for the answer. */
static bool ask(void *context, size_t count, const double *points, double *values, double *broken) {
  strut_dialogue *d = context;
  pthread_mutex_lock(&d->lock);
  d->question = (strut_question){count, points, values, broken};
  d->turn = TURN_CALLER;
  pthread_cond_broadcast(&d->changed);
  while (d->turn != TURN_OPTIMISER) pthread_cond_wait(&d->changed, &d->lock);
  bool go_on = !d->stop;
  pthread_mutex_unlock(&d->lock);
  return go_on;
}

static void *optimise(void *context) {
  strut_dialogue *d = context;
  const strut_search_asker asker = {d, ask};
  d->fine = strut_search_optimise(d->task, &asker);
  give_turn(d, TURN_NONE);
  return NULL;
}

strut_dialogue *strut_dialogue_begin(const strut_search_task *task) {
  strut_dialogue *d = strut_allocate(1, sizeof *d);
  if (!d) return NULL;
  d->task = task;
  d->turn = TURN_OPTIMISER;
  if (pthread_mutex_init(&d->lock, NULL) == 0) {
    if (pthread_cond_init(&d->changed, NULL) == 0) {
      if (pthread_create(&d->thread, NULL, optimise, d) == 0) return d;
      pthread_cond_destroy(&d->changed);
    }
    pthread_mutex_destroy(&d->lock);
  }
  strut_release(d);
  return NULL;
}

bool strut_dialogue_question(strut_dialogue *d, strut_question *question) {
  pthread_mutex_lock(&d->lock);
  while (d->turn == TURN_OPTIMISER) pthread_cond_wait(&d->changed, &d->lock);
  bool asked = d->turn == TURN_CALLER;
  *question = d->question;
  pthread_mutex_unlock(&d->lock);
  return asked;
}

void strut_dialogue_answer(strut_dialogue *d) { give_turn(d, TURN_OPTIMISER); }

bool strut_dialogue_end(strut_dialogue *d) {
  strut_question question;
  if (!d) return true;
  while (strut_dialogue_question(d, &question)) {
    d->stop = true; /* it waits for the lock */
    strut_dialogue_answer(d);
  }
  pthread_join(d->thread, NULL);
  bool fine = d->fine;
  pthread_cond_destroy(&d->changed);
  pthread_mutex_destroy(&d->lock);
  strut_release(d);
  return fine;
}
