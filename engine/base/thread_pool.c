/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/thread_pool.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "engine/base/memory.h"

/* Looks at whether the others have come before a thread sleeps: about 20 microseconds. */
enum { LOOKS = 1000, MOST = 64 };

struct strut_thread_pool {
  int size;
  pthread_mutex_t lock;
  pthread_cond_t changed;
  atomic_int missing;  /* threads that have not come to the present meeting */
  atomic_uint meeting; /* its number */
  void (*work)(void *, int);
  void *context;
  bool over;
  struct member {
    strut_thread_pool *pool;
    pthread_t thread;
    int number;
  } member[MOST];
};

static void pause_shortly(void) {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

void strut_thread_pool_meet(strut_thread_pool *pool) {
  if (!pool) return;
  unsigned meeting = atomic_load(&pool->meeting);
  if (atomic_fetch_sub(&pool->missing, 1) == 1) {
    atomic_store(&pool->missing, pool->size);
    pthread_mutex_lock(&pool->lock);
    atomic_fetch_add(&pool->meeting, 1);
    pthread_cond_broadcast(&pool->changed);
    pthread_mutex_unlock(&pool->lock);
    return;
  }
  for (int i = 0; i < LOOKS; i++) {
    if (atomic_load_explicit(&pool->meeting, memory_order_acquire) != meeting) return;
    pause_shortly();
  }
  pthread_mutex_lock(&pool->lock);
  while (atomic_load(&pool->meeting) == meeting) pthread_cond_wait(&pool->changed, &pool->lock);
  pthread_mutex_unlock(&pool->lock);
}

static void *follow(void *context) {
  struct member *m = context;
  strut_thread_pool *pool = m->pool;
  for (;;) {
    strut_thread_pool_meet(pool); /* there is work */
    if (pool->over) return NULL;
    pool->work(pool->context, m->number);
    strut_thread_pool_meet(pool); /* it is done */
  }
}

strut_thread_pool *strut_thread_pool_create(int threads) {
  if (threads > MOST) threads = MOST;
  strut_thread_pool *pool = threads > 1 ? strut_allocate(1, sizeof *pool) : NULL;
  if (!pool) return NULL;
  pool->size = threads;
  atomic_store(&pool->missing, threads);
  pthread_mutex_init(&pool->lock, NULL);
  pthread_cond_init(&pool->changed, NULL);
  for (int i = 1; i < threads; i++) {
    pool->member[i] = (struct member){.pool = pool, .number = i};
    if (pthread_create(&pool->member[i].thread, NULL, follow, &pool->member[i]) == 0) continue;
    /* Those that have started wait for so many: stand in for the others, once. */
    for (int k = i; k < threads; k++) atomic_fetch_sub(&pool->missing, 1);
    pool->over = true;
    strut_thread_pool_meet(pool);
    for (int k = 1; k < i; k++) pthread_join(pool->member[k].thread, NULL);
    pool->size = 1;
    strut_thread_pool_free(pool);
    return NULL;
  }
  return pool;
}

void strut_thread_pool_free(strut_thread_pool *pool) {
  if (!pool) return;
  if (pool->size > 1) {
    pool->over = true;
    strut_thread_pool_meet(pool);
    for (int i = 1; i < pool->size; i++) pthread_join(pool->member[i].thread, NULL);
  }
  pthread_cond_destroy(&pool->changed);
  pthread_mutex_destroy(&pool->lock);
  strut_release(pool);
}

int strut_thread_pool_size(const strut_thread_pool *pool) { return pool ? pool->size : 1; }

void strut_thread_pool_run(strut_thread_pool *pool, void (*work)(void *, int), void *context) {
  if (!pool) {
    work(context, 0);
    return;
  }
  pool->work = work, pool->context = context;
  strut_thread_pool_meet(pool);
  work(context, 0);
  strut_thread_pool_meet(pool);
}
