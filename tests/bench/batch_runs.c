/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/batch_runs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "engine/integrate/batch/batch.h"
#include "engine/run/simulate.h"
#include "tests/bench/scenes.h"

enum { WIDTHS = 4, METHODS = 1, MOST = 1001 };
/* The last one in registers of four, as on processors that have no wider ones. */
static const int32_t widths[WIDTHS] = {1, 4, 8, 8};
static const char *const kinds[WIDTHS] = {"", "", "", "2 x 4"};
static const char *const methods[METHODS] = {"rk4"};
static const double step_of[METHODS] = {1e-4}; /* of the crawler's model [s] */

typedef struct lane {
  strut_setup setup;
  strut_model *model;
  strut_state *state;
  void *workspace;
} lane;

/* A batch and states of its own for it. */
typedef struct together {
  lane lanes[STRUT_BATCH_MOST];
  strut_batch *batch;
} together;

/* Of this process on its core, whoever else runs meanwhile. */
static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Two hinges, and stops on the four soft springs. */
static bool add_elements(strut_scene *scene) {
  enum { HINGES = 2 };
  static const int32_t nodes[HINGES][3] = {{2, 4, 3}, {0, 4, 1}};
  scene->hinges = strut_arena_allocate(&scene->arena, HINGES, sizeof *scene->hinges);
  for (int i = 0; i < HINGES && scene->hinges; i++) {
    scene->hinges[i] = strut_hinge_default();
    for (int k = 0; k < 3; k++) scene->hinges[i].node[k] = nodes[i][k];
    scene->hinges[i].stiffness = 0.01, scene->hinges[i].damping = 1e-5;
  }
  scene->hinge_count = scene->hinges ? HINGES : 0;
  for (int j = 3; j < 7; j++) scene->members[j].longest = 0.062;
  return scene->hinges != NULL;
}

static bool elements; /* the crawler with hinges and stops */

static bool batch_make(lane *it, int i, const strut_integrator *method, double step, bool balance) {
  *it = (lane){0};
  strut_experiment experiment = strut_experiment_default();
  experiment.step = step;
  const strut_integrator_settings settings = strut_integrator_settings_of(&experiment);
  if (bench_crawler_scene(&it->setup, 10.0 + 0.1 * i, 1e-4, 0.1) != STRUT_OK ||
      (elements && !add_elements(&it->setup.scene)) ||
      strut_model_compile(&it->setup.scene, &it->model, NULL) != STRUT_OK ||
      strut_state_create(it->model, &it->state, NULL) != STRUT_OK ||
      !(it->workspace = method->create(it->model, it->state, &settings)))
    return false;
  it->state->balance = balance;
  if (method->restart) method->restart(it->model, it->state, it->workspace, step);
  return true;
}

static void batch_free(lane *it) {
  strut_state_free(it->state);
  strut_model_free(it->model);
  strut_setup_free(&it->setup);
}

static bool together_make(together *it, int w, const strut_integrator *method, double step,
                          bool balance) {
  bool good = true;
  for (int i = 0; i < STRUT_BATCH_MOST; i++)
    good &= batch_make(&it->lanes[i], i, method, step, balance);
  it->batch = good && w && widths[w] <= strut_batch_widest()
                  ? strut_batch_create(it->lanes[0].model, method, widths[w], balance)
                  : NULL;
  for (int32_t l = 0; l < widths[w] && it->batch; l++) {
    strut_batch_fill(it->batch, l, it->lanes[l].model, step);
    strut_batch_put(it->batch, l, it->lanes[l].state);
  }
  if (w == WIDTHS - 1 && it->batch) strut_batch_halve(it->batch);
  return good;
}

/* So many steps of the first lane, and about as many of the others. */
static void together_step(together *it, int32_t width, const strut_integrator *method, double step,
                          int64_t count) {
  strut_state *first = it->lanes[0].state;
  if (!it->batch) {
    method->advance(it->lanes[0].model, first, it->lanes[0].workspace, step, count);
    return;
  }
  for (int64_t end = first->step + count; first->step < end;) {
    int64_t left[STRUT_BATCH_MOST];
    for (int32_t l = 0; l < width; l++) left[l] = l ? INT64_MAX : end - first->step;
    strut_batch_advance(it->batch, left);
    strut_batch_count(it->batch, 0, first);
  }
}

/* One method: a run alone, and batches of each width. */
static void compare(int m, bool balance, int repeats) {
  static double times[WIDTHS][MOST];
  static together all[WIDTHS];
  const strut_integrator *method = strut_integrator_find(methods[m]);
  bool good = true;
  const int64_t steps = 5000;
  for (int w = 0; w < WIDTHS; w++) good &= together_make(&all[w], w, method, step_of[m], balance);
  for (int r = -1; r < repeats && good; r++) /* the first round is for warming up */
    for (int w = 0; w < WIDTHS; w++) {
      if (w && !all[w].batch) continue;
      double start = seconds();
      together_step(&all[w], widths[w], method, step_of[m], steps);
      if (r >= 0) times[w][r] = 1e9 * (seconds() - start) / (double)(steps * widths[w]);
    }
  for (int w = 0; w < WIDTHS && good; w++) {
    if (w && !all[w].batch) continue;
    qsort(times[w], (size_t)repeats, sizeof times[w][0], ascending);
    double typical = times[w][repeats / 2];
    printf("  %-14s %-8s %5d %-6s %10.1f %10.2f\n", methods[m], balance ? "balance" : "", widths[w],
           kinds[w], typical, times[0][repeats / 2] / typical);
  }
  for (int w = 0; w < WIDTHS; w++) {
    strut_batch_free(all[w].batch);
    for (int i = 0; i < STRUT_BATCH_MOST; i++) batch_free(&all[w].lanes[i]);
  }
}

/* Whole runs: the crawler at so many frequencies, a second of each measured over its last tenth. */
enum { POINTS = 48 };
typedef struct points {
  lane at[POINTS];
  strut_run_options options;
  int next, failed;
} points;

static bool next_point(void *context, strut_batch_point *point) {
  points *all = context;
  if (all->next == POINTS) return false;
  const lane *it = &all->at[all->next++];
  *point = (strut_batch_point){it->model, &it->setup.experiment, &all->options, NULL};
  return true;
}

static void take_result(void *context, const strut_batch_point *point, strut_status status,
                        strut_summary *summary, const strut_error *error) {
  points *all = context;
  (void)point, (void)error;
  all->failed += status != STRUT_OK;
  strut_summary_free(summary);
}

static double time_points(points *all, int32_t width, bool halves) {
  double start = seconds();
  all->next = 0;
  strut_simulate_batch(&(strut_batch_source){.context = all,
                                             .next = next_point,
                                             .result = take_result,
                                             .example = all->at[0].model,
                                             .integrator = all->at[0].setup.experiment.integrator,
                                             .without_balance = all->options.without_balance,
                                             .width = width,
                                             .halves = halves});
  return POINTS / (seconds() - start);
}

static void compare_points(int m, bool balance, int repeats) {
  static points all;
  static double rates[WIDTHS][MOST];
  bool good = true;
  all = (points){.options = {.without_balance = !balance}};
  for (int i = 0; i < POINTS; i++) {
    good &= batch_make(&all.at[i], 2 * i, strut_integrator_find(methods[m]), step_of[m], balance);
    all.at[i].setup.experiment.integrator = methods[m];
    all.at[i].setup.experiment.step = step_of[m];
    all.at[i].setup.experiment.measure_last = 0.1;
  }
  for (int r = 0; r < repeats && good; r++)
    for (int w = 0; w < WIDTHS; w++)
      if (widths[w] <= strut_batch_widest())
        rates[w][r] = time_points(&all, widths[w], w == WIDTHS - 1);
  for (int w = 0; w < WIDTHS && good && widths[w] <= strut_batch_widest(); w++) {
    qsort(rates[w], (size_t)repeats, sizeof rates[w][0], ascending);
    double typical = rates[w][repeats / 2];
    printf("  %-14s %-8s %5d %-6s %10.1f %10.2f\n", all.failed ? "FAILED" : methods[m],
           balance ? "balance" : "", widths[w], kinds[w], typical, typical / rates[0][repeats / 2]);
  }
  for (int i = 0; i < POINTS; i++) batch_free(&all.at[i]);
}

static void compare_all(int repeats) {
  printf("\nlanes: the crawler%s, steps of 0.1 ms\n  %-14s %-8s %-12s %10s %10s\n",
         elements ? " with hinges and stops" : "", "", "", "runs", "ns/step", "times");
  for (int m = 0; m < METHODS; m++)
    for (int balance = 0; balance < 2; balance++) compare(m, balance, repeats);
  printf("  whole runs of 1 s%23s\n", "points/s");
  for (int m = 0; m < METHODS; m++)
    for (int balance = 0; balance < 2; balance++)
      compare_points(m, balance, repeats > 5 ? 5 : repeats);
}

void bench_batch(int repeats) {
  for (int with = 0; with < 2; with++) {
    elements = with;
    compare_all(repeats);
  }
}
