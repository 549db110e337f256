/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/thread_pool.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "engine/base/memory.h"

/* Looks at whether the others have come before a thread sleeps: about 20 microseconds. */
enum { LOOKS = 1000, MOST = 64 };

struct strut_team {
  int size;
  pthread_mutex_t lock;
  pthread_cond_t changed;
  atomic_int missing;  /* threads that have not come to the present meeting */
  atomic_uint meeting; /* its number */
  void (*work)(void *, int);
  void *context;
  bool over;
  struct member {
    strut_team *team;
    pthread_t thread;
    int number;
  } member[MOST];
};

static void pause_shortly(void) {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

void strut_team_meet(strut_team *team) {
  if (!team) return;
  unsigned meeting = atomic_load(&team->meeting);
  if (atomic_fetch_sub(&team->missing, 1) == 1) {
    atomic_store(&team->missing, team->size);
    pthread_mutex_lock(&team->lock);
    atomic_fetch_add(&team->meeting, 1);
    pthread_cond_broadcast(&team->changed);
    pthread_mutex_unlock(&team->lock);
    return;
  }
  for (int i = 0; i < LOOKS; i++) {
    if (atomic_load_explicit(&team->meeting, memory_order_acquire) != meeting) return;
    pause_shortly();
  }
  pthread_mutex_lock(&team->lock);
  while (atomic_load(&team->meeting) == meeting) pthread_cond_wait(&team->changed, &team->lock);
  pthread_mutex_unlock(&team->lock);
}

static void *follow(void *context) {
  struct member *m = context;
  strut_team *team = m->team;
  for (;;) {
    strut_team_meet(team); /* there is work */
    if (team->over) return NULL;
    team->work(team->context, m->number);
    strut_team_meet(team); /* it is done */
  }
}

strut_team *strut_team_create(int threads) {
  if (threads > MOST) threads = MOST;
  strut_team *team = threads > 1 ? strut_allocate(1, sizeof *team) : NULL;
  if (!team) return NULL;
  team->size = threads;
  atomic_store(&team->missing, threads);
  pthread_mutex_init(&team->lock, NULL);
  pthread_cond_init(&team->changed, NULL);
  for (int i = 1; i < threads; i++) {
    team->member[i] = (struct member){.team = team, .number = i};
    if (pthread_create(&team->member[i].thread, NULL, follow, &team->member[i]) == 0) continue;
    /* Those that have started wait for so many: stand in for the others, once. */
    for (int k = i; k < threads; k++) atomic_fetch_sub(&team->missing, 1);
    team->over = true;
    strut_team_meet(team);
    for (int k = 1; k < i; k++) pthread_join(team->member[k].thread, NULL);
    team->size = 1;
    strut_team_free(team);
    return NULL;
  }
  return team;
}

void strut_team_free(strut_team *team) {
  if (!team) return;
  if (team->size > 1) {
    team->over = true;
    strut_team_meet(team);
    for (int i = 1; i < team->size; i++) pthread_join(team->member[i].thread, NULL);
  }
  pthread_cond_destroy(&team->changed);
  pthread_mutex_destroy(&team->lock);
  strut_release(team);
}

int strut_team_size(const strut_team *team) { return team ? team->size : 1; }

void strut_team_run(strut_team *team, void (*work)(void *, int), void *context) {
  if (!team) {
    work(context, 0);
    return;
  }
  team->work = work, team->context = context;
  strut_team_meet(team);
  work(context, 0);
  strut_team_meet(team);
}
