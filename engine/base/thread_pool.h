/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Threads that work on one thing together, again and again: within a step of a large structure they meet many
 * times, so they wait for each other awake for some microseconds, and asleep from then on.
 */
#ifndef STRUT_ENGINE_BASE_THREAD_POOL_H
#define STRUT_ENGINE_BASE_THREAD_POOL_H

typedef struct strut_team strut_team;

/** A team of up to `threads`, the caller's one of them; NULL: out of memory, or fewer than two. */
strut_team *strut_team_create(int threads);
/** NULL is allowed. */
void strut_team_free(strut_team *team);
/** How many there are; 1 for NULL. */
int strut_team_size(const strut_team *team);
/** Every thread calls work(context, its number); the caller is number 0. Returns when all have. */
void strut_team_run(strut_team *team, void (*work)(void *context, int thread), void *context);
/** Within the work: returns when all have come so far. Nothing for NULL. */
void strut_team_meet(strut_team *team);

#endif
