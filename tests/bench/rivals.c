/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/rivals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "engine/integrate/integrator.h"
#include "tests/bench/hand_kernel.h"
#include "tests/bench/scenes.h"

static const double frequency = 10.0, amplitude = 1e-4, friction = 0.1, step = 1e-4;

double bench_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* strut */

typedef struct engine_crawler {
  strut_setup setup;
  strut_model *model;
  strut_state *state;
  void *workspace;
} engine_crawler;

static void engine_free(void *crawler) {
  engine_crawler *it = crawler;
  strut_state_free(it->state);
  strut_model_free(it->model);
  strut_setup_free(&it->setup);
  free(it);
}

static void *engine_make(bool balance) {
  engine_crawler *it = calloc(1, sizeof *it);
  if (!it) return NULL;
  const strut_integrator_settings settings = {.step = 1e-4};
  if (bench_crawler_scene(&it->setup, frequency, amplitude, friction) == STRUT_OK &&
      strut_model_compile(&it->setup.scene, &it->model, NULL) == STRUT_OK &&
      strut_state_create(it->model, &it->state, NULL) == STRUT_OK)
    it->workspace = strut_integrator_find("rk4")->create(it->model, it->state, &settings);
  if (!it->workspace) {
    engine_free(it);
    return NULL;
  }
  strut_state_reset(it->model, it->state);
  it->state->balance = balance;
  return it;
}

static void *engine_create(void) { return engine_make(false); }
static void *engine_create_balance(void) { return engine_make(true); }

static double engine_run(void *crawler, long long steps) {
  engine_crawler *it = crawler;
  double start = bench_seconds();
  strut_integrator_find("rk4")->advance(it->model, it->state, it->workspace, step, steps);
  return bench_seconds() - start;
}

static double engine_position(void *crawler) {
  const engine_crawler *it = crawler;
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
    {BENCH_SCALAR, 20000, hand_create, hand_run_scalar, hand_position, free},
};

const rival *rival_at(size_t i) { return i < sizeof rivals / sizeof rivals[0] ? &rivals[i] : NULL; }
