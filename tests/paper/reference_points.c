/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The independent crawler at many points of the paper's figures 8 and 10:
 *
 *   reference_points STEP <POINTS
 *
 * reads lines "8|10 frequency mu I|II amplitude" (Hz, m), takes steps of STEP seconds or a little
 * less, so that they divide a half-wave, and prints for each line the outcome, whether the motion
 * repeats itself (figure 8), and the steady velocity [m/s]. Steps are fixed and nothing is located:
 * the errors are of first order in STEP.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/paper/reference_crawler.h"

enum { MOST_PERIODS = 400, BLOCKS = 3, LEAST = 8 };
static const double SETTLE_STEP = 5e-5, SWITCH_SECONDS = 1.5;
/* Motions repeat, and their means stay, within so much [m/s] or such a part. */
static const double REPEATS = 5e-5, REPEATS_PART = 0.01, STAYS = 1e-5, STAYS_PART = 0.002;

typedef struct point {
  reference_crawler it;
  int figure;
  bool mirrored;
} point;

/* In state III bars 2 and 3 have folded onto each other, so that nodes 3 and 4 meet; standing, the
   body lies on node 1 and its tail is up in state I, on node 2 in state II. */
static const char *outcome_of(const double *z) {
  if (!isfinite(z[0])) return "diverged";
  if (hypot(z[4] - z[6], z[5] - z[7]) < 0.01) return "III";
  return z[1] < z[3] ? "I" : "II";
}

static double mean(const double *v, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) sum += v[i];
  return sum / count;
}

/* Do the last of n velocities of a period repeat after `lag` periods, in blocks of equal means? */
static bool steady(const double *v, int n, int lag, double *velocity) {
  int block = lag * ((LEAST + lag - 1) / lag);
  if (n < BLOCKS * block) return false;
  *velocity = mean(v + n - block, block);
  double repeats = fmax(REPEATS, REPEATS_PART * fabs(*velocity));
  double stays = fmax(STAYS, STAYS_PART * fabs(*velocity));
  for (int i = n - block; i < n; i++)
    if (fabs(v[i] - v[i - lag]) > repeats) return false;
  for (int k = 1; k < BLOCKS; k++)
    if (fabs(mean(v + n - (k + 1) * block, block) - *velocity) > stays) return false;
  return true;
}

static bool steady_at_all(const double *v, int n, double *velocity) {
  static const int lags[] = {1, 2, 3, 4, 6, 8};
  for (size_t i = 0; i < sizeof lags / sizeof lags[0]; i++)
    if (steady(v, n, lags[i], velocity)) return true;
  return false;
}

/* Figure 8: until the motion repeats itself, or so many periods. */
static void crawl(const point *p, double step, double *z) {
  static double v[MOST_PERIODS];
  long half = lround(ceil(0.5 / p->it.frequency / step)), n = 0;
  double dt = 0.5 / p->it.frequency / (double)half, velocity = 0;
  bool repeats = false;
  int periods = 0;
  while (periods < MOST_PERIODS && !repeats && isfinite(z[0])) {
    double before = reference_centre(z);
    for (long i = 0; i < 2 * half; i++) reference_step(&p->it, n++, dt, z);
    v[periods++] = (reference_centre(z) - before) * p->it.frequency;
    repeats = steady_at_all(v, periods, &velocity);
  }
  if (!repeats) velocity = mean(v + periods / 2, periods - periods / 2);
  printf("%s %s %.9g %d\n", outcome_of(z), repeats ? "periodic" : "irregular", velocity, periods);
}

/* Figure 10: half a wave, and then until it lies still or nearly so. */
static void switch_state(const point *p, double step, double *z) {
  long half = lround(ceil(0.5 / p->it.frequency / step));
  double dt = 0.5 / p->it.frequency / (double)half;
  for (long n = 0; (double)n * dt < SWITCH_SECONDS && isfinite(z[0]); n++)
    reference_step(&p->it, n, dt, z);
  printf("%s switched 0 0\n", outcome_of(z));
}

static bool read_point(const char *line, point *p) {
  char start[8];
  *p = (point){.figure = 0};
  if (sscanf(line, "%d %lf %lf %7s %lf", &p->figure, &p->it.frequency, &p->it.mu, start,
             &p->it.amplitude) != 5)
    return false;
  p->mirrored = strcmp(start, "II") == 0;
  p->it.half_wave = p->figure == 10;
  return p->it.frequency > 0;
}

int main(int argc, char **argv) {
  double rest[2][REFERENCE_STATE], z[REFERENCE_STATE], step = argc > 1 ? atof(argv[1]) : 4e-6;
  char line[256];
  for (int two = 0; two < 2; two++) {
    reference_crawler it = {.frequency = 1};
    reference_prepare(&it, two, rest[two]);
    if (!reference_settle(&it, SETTLE_STEP, rest[two])) {
      fprintf(stderr, "reference_points: did not settle\n");
      return 1;
    }
  }
  while (fgets(line, sizeof line, stdin)) {
    point p;
    if (!read_point(line, &p)) {
      fprintf(stderr, "reference_points: not a point: %s", line);
      return 1;
    }
    reference_prepare(&p.it, p.mirrored, z);
    memcpy(z, rest[p.mirrored], sizeof z);
    if (p.figure == 10)
      switch_state(&p, step, z);
    else
      crawl(&p, step, z);
    fflush(stdout);
  }
  return 0;
}
