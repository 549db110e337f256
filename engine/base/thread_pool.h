/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Threads that work on one thing together, again and again: within a step of a large structure they meet many
 * times, so they wait for each other awake for some microseconds, and asleep from then on.
 */
#ifndef STRUT_ENGINE_BASE_THREAD_POOL_H
#define STRUT_ENGINE_BASE_THREAD_POOL_H

typedef struct strut_thread_pool strut_thread_pool;

/** A pool of up to `threads`, the caller's one of them; NULL: out of memory, or fewer than two. */
strut_thread_pool *strut_thread_pool_create(int threads);
/** NULL is allowed. */
void strut_thread_pool_free(strut_thread_pool *pool);
/** How many there are; 1 for NULL. */
int strut_thread_pool_size(const strut_thread_pool *pool);
/** Every thread calls work(context, its number); the caller is number 0. Returns when all have. */
void strut_thread_pool_run(strut_thread_pool *pool, void (*work)(void *context, int thread),
                           void *context);
/** Within the work: returns when all have come so far. Nothing for NULL. */
void strut_thread_pool_meet(strut_thread_pool *pool);

#endif
