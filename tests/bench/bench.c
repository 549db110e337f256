/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * strut_bench: how long a step takes.
 *
 *   strut_bench [--repeats N] [--members N]  the crawler in strut and elsewhere, then chains of
 *                                            X-frames of 10, 100, ... and N (default 1000000) members
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
#include <sys/resource.h>

#include "tests/bench/methods.h"
#include "tests/bench/precision.h"
#include "tests/bench/rivals.h"
#include "tests/bench/scenes.h"

enum { MOST_RIVALS = 16, MOST_REPEATS = 1001 };

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values, int count) {
  qsort(values, (size_t)count, sizeof *values, ascending);
  return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

static double least(const double *values, int count) {
  double low = values[0];
  for (int i = 1; i < count; i++) low = fmin(low, values[i]);
  return low;
}

/* The median of values / other, turn by turn, and the quartiles. */
static void print_ratio(const double *values, const double *other, int count) {
  static double ratio[MOST_REPEATS];
  for (int i = 0; i < count; i++) ratio[i] = values[i] / other[i];
  double middle = median(ratio, count);
  printf(" %7.3f (%.3f to %.3f)", middle, ratio[count / 4], ratio[(3 * count) / 4]);
}

static double peak_megabytes(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (double)usage.ru_maxrss / 1024.0;
}

/* The crawler. Node 1 after a fifth of a second tells whether all compute the same thing. */
static void compare_crawlers(int repeats) {
  static double times[MOST_RIVALS][MOST_REPEATS];
  void *crawlers[MOST_RIVALS] = {NULL};
  double position[MOST_RIVALS] = {0};
  const long long warm = 2000;
  int count = 0;
  for (; count < MOST_RIVALS && rival_at((size_t)count); count++) {
    const rival *it = rival_at((size_t)count);
    crawlers[count] = it->create();
    if (!crawlers[count]) continue;
    it->run(crawlers[count], warm);
    position[count] = it->position(crawlers[count]);
  }
  for (int r = 0; r < repeats; r++)
    for (int i = 0; i < count; i++) {
      const rival *it = rival_at((size_t)i);
      if (crawlers[i]) times[i][r] = 1e9 * it->run(crawlers[i], it->steps) / (double)it->steps;
    }
  int scalar = 0;
  for (int i = 0; i < count; i++)
    if (strcmp(rival_at((size_t)i)->name, BENCH_SCALAR) == 0) scalar = i;
  printf("crawler, RK4, 0.1 ms\n  %-32s %10s %25s %16s\n", "", "ns/step", "of scalar, by hand",
         "x_1(0.2 s) [mm]");
  for (int i = 0; i < count; i++) {
    const rival *it = rival_at((size_t)i);
    if (!crawlers[i]) {
      printf("  %-32s %10s\n", it->name, "not here");
      continue;
    }
    printf("  %-32s %10.1f", it->name, least(times[i], repeats));
    print_ratio(times[i], times[scalar], repeats);
    printf(" %14.9f\n", 1e3 * position[i]);
    it->free(crawlers[i]);
  }
}

static double chain_run(bench_motion *it, long long steps) {
  double start = bench_seconds();
  it->method->advance(it->model, it->state, it->workspace, 1e-4, steps);
  return bench_seconds() - start;
}

static void time_chain(size_t members, int repeats) {
  static double times[2][MOST_REPEATS];
  bench_motion chains[2];
  bool made[2];
  long long steps = members < 200000 ? (long long)(1000000 / members) : 5;
  double farthest = 0;
  for (int m = 0; m < 2; m++) {
    made[m] = bench_chain(&chains[m], members, m ? STRUT_MASS_CONSISTENT : STRUT_MASS_LUMPED);
    if (made[m]) chain_run(&chains[m], steps);
  }
  for (int r = 0; r < repeats; r++)
    for (int m = 0; m < 2; m++)
      if (made[m])
        times[m][r] = chain_run(&chains[m], steps) / (double)(steps * (long long)members);
  printf("  %10zu", members);
  for (int m = 0; m < 2; m++) {
    if (!made[m]) {
      printf(" %12s", "failed");
      continue;
    }
    printf(" %12.2f", 1e9 * median(times[m], repeats));
    for (int32_t i = 0; i < 2 * chains[m].model->node_count; i++)
      farthest = fmax(farthest, fabs(chains[m].state->v[i]));
    bench_free(&chains[m]);
  }
  printf("   %s\n", farthest > 0 && farthest < 100 ? "" : "(not a sound motion)");
}

static void compare_chains(size_t largest, int repeats) {
  printf("\nchains of X-frames, RK4, 0.1 ms: ns per member and step\n  %10s %12s %12s\n", "members",
         "lumped", "consistent");
  for (size_t members = 10; members < largest; members *= 10)
    time_chain(members, members >= 100000 && repeats > 5 ? 5 : repeats);
  time_chain(largest, repeats > 5 ? 5 : repeats);
  printf("  peak memory %.0f MB\n", peak_megabytes());
}

static int usage(void) {
  fprintf(stderr,
          "usage: strut_bench [--repeats N] [--members N]\n"
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
  if (argc >= 2 && strcmp(argv[1], "rivals") == 0) return compare_rivals(argc, argv);
  if (argc >= 2 && strcmp(argv[1], "methods") == 0) {
    bench_methods(31, argc > 2 ? argv[2] : NULL, argc > 3 ? atof(argv[3]) : 1.0);
    return 0;
  }
  int repeats = 15;
  size_t members = 1000000;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 < argc && strcmp(argv[i], "--repeats") == 0)
      repeats = atoi(argv[i + 1]);
    else if (i + 1 < argc && strcmp(argv[i], "--members") == 0)
      members = strtoul(argv[i + 1], NULL, 10);
    else
      return usage();
  }
  if (repeats < 1 || repeats > MOST_REPEATS) return usage();
  compare_crawlers(repeats);
  bench_methods(repeats, NULL, 1.0);
  compare_chains(members, repeats);
  return 0;
}
