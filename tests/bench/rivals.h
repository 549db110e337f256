/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Everything that steps the crawler, behind one face, so that it can be timed in turns. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/** The row that others are compared with: C for this structure, as one would write it down. */
#define BENCH_SCALAR "by hand, scalar"

/** One way to step the crawler at f = 10 Hz, a = 0.1 mm, mu = 0.1 and dt = 1e-4 s. */
typedef struct rival {
  const char *name;
  long long steps; /* how many to time at once */
  /** A fresh crawler at state I, or NULL where this machine has not what it takes. */
  void *(*create)(void);
  /** Advances by so many steps; returns the seconds it took. */
  double (*run)(void *crawler, long long steps);
  /** x of node 1 [m]. */
  double (*position)(void *crawler);
  void (*free)(void *crawler);
} rival;

/** The i-th, or NULL after the last. The first is strut itself. */
const rival *rival_at(size_t i);

/** CPU time of this thread [s]. */
double bench_seconds(void);
