/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * strut_bench: how long a step takes.
 *
 *   strut_bench [--repeats N]                the crawler in strut and by hand, and each method
 *   strut_bench methods [METHOD [FINER]]     what a force evaluation costs by each method, alone
 *   strut_bench rivals [--limit S] [-o DIR] [SCENE...]   error against cost, strut and other solvers; a table
 *                                            for each scene, CSV and figures into DIR, S of CPU time per cell
 *   strut_bench rivals --check               whether all of them converge to one answer
 *
 * Competitors take turns, so that a change of the machine's speed meets all of them. Times are the thread's CPU
 * times, the least of all turns; ratios are of each turn, the median with both quartiles.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/hand_kernel.h"
#include "tests/bench/precision.h"
#include "tests/bench/scenes.h"

enum { MOST_REPEATS = 1001 };

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* ---- the crawler: node 1 after two seconds tells whether all compute the same thing ---- */

enum { STRUT, STRUT_WITH_BALANCE, BY_HAND, COMPETITORS, STEPS = 20000 };

/* ns of a step. position: x of node 1 at the end [m]. */
static double time_crawler(int which, double *position) {
  bench_motion m;
  double begin;
  if (which == BY_HAND) {
    begin = bench_seconds();
    *position = hand_crawler_run(STEPS);
    return 1e9 * (bench_seconds() - begin) / STEPS;
  }
  if (!bench_crawler(&m, "rk4", 1e-4)) return (double)NAN;
  m.state->balance = which == STRUT_WITH_BALANCE;
  begin = bench_seconds();
  m.method->advance(m.model, m.state, m.workspace, 1e-4, STEPS);
  double time = 1e9 * (bench_seconds() - begin) / STEPS;
  *position = m.state->q[0];
  bench_free(&m);
  return time;
}

static void compare_crawlers(int repeats) {
  static const char *const name[] = {"strut", "strut, with the energy balance", "by hand, scalar"};
  static double times[COMPETITORS][MOST_REPEATS], ratio[MOST_REPEATS];
  double position[COMPETITORS];
  for (int r = 0; r < repeats; r++)
    for (int i = 0; i < COMPETITORS; i++) times[i][r] = time_crawler(i, &position[i]);
  printf("crawler, RK4, 0.1 ms\n  %-32s %10s %25s %14s\n", "", "ns/step", "of scalar, by hand",
         "x_1(2 s) [mm]");
  for (int i = 0; i < COMPETITORS; i++) {
    double least = HUGE_VAL;
    for (int r = 0; r < repeats; r++) {
      ratio[r] = times[i][r] / times[BY_HAND][r];
      least = fmin(least, times[i][r]);
    }
    qsort(ratio, (size_t)repeats, sizeof *ratio, ascending);
    printf("  %-32s %10.1f %7.3f (%.3f to %.3f) %14.9f\n", name[i], least, ratio[repeats / 2],
           ratio[repeats / 4], ratio[3 * repeats / 4], 1e3 * position[i]);
  }
}

/* ---- methods ---- */

static const struct method_row {
  const char *method;
  double step; /* of the grid [s] */
} rows[] = {{"rk4", 5e-5},      {"verlet", 5e-5}, {"verlet-events", 5e-5}, {"rk4-events", 1e-4},
            {"adaptive", 1e-3}, {"euler", 5e-5},  {"euler-events", 5e-5}};
enum { ROWS = sizeof rows / sizeof rows[0], BALANCES = 2 };

/* ns of a force evaluation. */
static double time_method(const struct method_row *row, double step, bool balance) {
  bench_motion m;
  if (!bench_crawler(&m, row->method, step)) return (double)NAN;
  m.state->balance = balance;
  if (m.method->restart) m.method->restart(m.model, m.state, m.workspace, step);
  double begin = bench_seconds();
  m.method->advance(m.model, m.state, m.workspace, step, (int64_t)(0.2 / step));
  double time = 1e9 * (bench_seconds() - begin) / (double)m.state->latest->evaluations;
  bench_free(&m);
  return time;
}

static bool is_wanted(const struct method_row *row, const char *only) {
  return !only || strcmp(row->method, only) == 0 || strcmp(row->method, "rk4") == 0;
}

/* A row for each method, or for `only`: time of an evaluation in the crawler, and how many times that of rk4; the best
   of all repeats. All but rk4 take steps that are so many times `finer`: at 16 hardly one of them meets an event. */
static void compare_methods(int repeats, const char *only, double finer) {
  static double best[ROWS][BALANCES];
  for (int r = 0; r < repeats; r++)
    for (int i = 0; i < ROWS; i++)
      for (int b = 0; b < BALANCES && is_wanted(&rows[i], only); b++) {
        double time = time_method(&rows[i], rows[i].step / (i ? finer : 1.0), b == 1);
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

/* ---- the command line ---- */

static int usage(void) {
  fprintf(stderr,
          "usage: strut_bench [--repeats N]\n"
          "       strut_bench methods [METHOD [FINER]]\n"
          "       strut_bench rivals [--limit S] [-o DIR] [SCENE...]\n"
          "       strut_bench rivals --check\n");
  return 1;
}

static int compare_rivals(int argc, char **argv) {
  const char *folder = NULL;
  double limit = 1.0;
  int i = 2;
  if (argc == 3 && strcmp(argv[2], "--check") == 0) return bench_precision_check();
  for (; i + 1 < argc && argv[i][0] == '-'; i += 2) {
    if (strcmp(argv[i], "--limit") == 0)
      limit = atof(argv[i + 1]);
    else if (strcmp(argv[i], "-o") == 0)
      folder = argv[i + 1];
    else
      return usage();
  }
  if (!(limit > 0)) return usage();
  return bench_precision(folder, limit, argv + i, argc - i);
}

int main(int argc, char **argv) {
  int repeats = argc == 3 && strcmp(argv[1], "--repeats") == 0 ? atoi(argv[2]) : 15;
  if (argc >= 2 && strcmp(argv[1], "rivals") == 0) return compare_rivals(argc, argv);
  if (argc >= 2 && strcmp(argv[1], "methods") == 0) {
    compare_methods(31, argc > 2 ? argv[2] : NULL, argc > 3 ? atof(argv[3]) : 1.0);
    return 0;
  }
  if ((argc != 1 && argc != 3) || repeats < 1 || repeats > MOST_REPEATS) return usage();
  compare_crawlers(repeats);
  compare_methods(repeats, NULL, 1.0);
  return 0;
}
