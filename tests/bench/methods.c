/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/methods.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "tests/bench/rivals.h"
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

/* ns of a force evaluation. */
static double run(const method_row *row, double step, bool balance) {
  bench_motion m;
  if (!bench_crawler(&m, row->method, step)) return (double)NAN;
  m.state->balance = balance;
  if (m.method->restart) m.method->restart(m.model, m.state, m.workspace, step);
  int64_t steps = (int64_t)(STEPS * 5e-5 / step);
  double begin = bench_seconds();
  m.method->advance(m.model, m.state, m.workspace, step, steps);
  double time = 1e9 * (bench_seconds() - begin) / (double)m.state->latest->evaluations;
  bench_free(&m);
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
