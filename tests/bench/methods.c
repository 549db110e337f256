/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/methods.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "engine/integrate/integrator.h"
#include "tests/bench/scenes.h"

enum { STEPS = 4000, BALANCES = 2 };

typedef struct method_row {
  const char *method;
  double step; /* of the grid [s] */
} method_row;

static const method_row rows[] = {
    {"rk4", 5e-5},      {"verlet", 5e-5}, {"verlet-events", 5e-5}, {"rk4-events", 1e-4},
    {"adaptive", 1e-3}, {"euler", 5e-5},  {"euler-events", 5e-5}};
enum { ROWS = sizeof rows / sizeof rows[0] };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ns of a force evaluation. */
static double run(const method_row *row, double step, bool balance) {
  strut_setup setup = {0};
  strut_model *model = NULL;
  strut_state *state = NULL;
  double time = (double)NAN;
  strut_experiment experiment = strut_experiment_default();
  experiment.integrator = row->method;
  experiment.step = step;
  const strut_integrator_settings settings = strut_integrator_settings_of(&experiment);
  const strut_integrator *method = strut_integrator_find(row->method);
  void *work = NULL;
  if (bench_crawler_scene(&setup, 10.0, 1e-4, 0.1) == STRUT_OK &&
      strut_model_compile(&setup.scene, &model, NULL) == STRUT_OK &&
      strut_state_create(model, &state, NULL) == STRUT_OK)
    work = method->create(model, state, &settings);
  if (work) {
    state->balance = balance;
    if (method->restart) method->restart(model, state, work, step);
    int64_t steps = (int64_t)(STEPS * 5e-5 / step);
    double begin = now();
    method->advance(model, state, work, step, steps);
    time = 1e9 * (now() - begin) / (double)state->latest->evaluations;
  }
  strut_state_free(state);
  strut_model_free(model);
  strut_setup_free(&setup);
  return time;
}

static bool is_wanted(const method_row *row, const char *only) {
  return !only || strcmp(row->method, only) == 0 || strcmp(row->method, "rk4") == 0;
}

void bench_methods(int repeats, const char *only, double finer) {
  static double best[ROWS][BALANCES];
  for (int r = 0; r < repeats; r++)
    for (int i = 0; i < ROWS; i++)
      for (int b = 0; b < BALANCES && is_wanted(&rows[i], only); b++) {
        double time = run(&rows[i], rows[i].step / (i ? finer : 1.0), b == 1);
        best[i][b] = r ? fmin(best[i][b], time) : time;
      }
  printf(
      "crawler, 10 Hz, friction 0.1: ns of a force evaluation, and times rk4; without the energy "
      "balance, and with it\n");
  for (int i = 0; i < ROWS; i++) {
    if (!is_wanted(&rows[i], only)) continue;
    const double *time = best[i], *rk4 = best[0];
    printf("  %-16s   %5.1f %4.2f  %5.1f %4.2f\n", rows[i].method, time[0], time[0] / rk4[0],
           time[1], time[1] / rk4[1]);
  }
}
