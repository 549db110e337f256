/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/rivals.h"

#include <stdlib.h>
#include <time.h>

#include "tests/bench/hand_kernel.h"
#include "tests/bench/scenes.h"

static const double frequency = 10.0, amplitude = 1e-4, friction = 0.1, step = 1e-4;

double bench_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* strut */

static void engine_free(void *crawler) {
  bench_free(crawler);
  free(crawler);
}

static void *engine_make(bool balance) {
  bench_motion *it = malloc(sizeof *it);
  if (it && bench_crawler(it, "rk4", step)) {
    it->state->balance = balance;
    return it;
  }
  free(it);
  return NULL;
}

static void *engine_create(void) { return engine_make(false); }
static void *engine_create_balance(void) { return engine_make(true); }

static double engine_run(void *crawler, long long steps) {
  bench_motion *it = crawler;
  double start = bench_seconds();
  it->method->advance(it->model, it->state, it->workspace, step, steps);
  return bench_seconds() - start;
}

static double engine_position(void *crawler) {
  const bench_motion *it = crawler;
  return it->state->q[0];
}

/* by hand */

static void *hand_create(void) {
  hand_crawler_state *it = malloc(sizeof *it);
  if (it) hand_crawler_place(it, 0);
  return it;
}

static double hand_run_scalar(void *crawler, long long steps) {
  double start = bench_seconds();
  hand_crawler_run_scalar(crawler, step, frequency, amplitude, friction, steps);
  return bench_seconds() - start;
}

static double hand_position(void *crawler) {
  const hand_crawler_state *it = crawler;
  return it->x[0];
}

static const rival rivals[] = {
    {"strut", 20000, engine_create, engine_run, engine_position, engine_free},
    {"strut, with the energy balance", 20000, engine_create_balance, engine_run, engine_position,
     engine_free},
    {BENCH_SCALAR, 20000, hand_create, hand_run_scalar, hand_position, free}};

const rival *rival_at(size_t i) { return i < sizeof rivals / sizeof rivals[0] ? &rivals[i] : NULL; }
