/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CMA-ES: evaluations that known functions take (python3-cmaes agrees within a fifth), bounds, the same bits,
   stops. */
#include <stdbool.h>

#include "engine/study/search/optimisers.h"
#include "tests/support/check.h"

FREED_BY(strut_cma_free, strut_cma)

enum { MOST = 10, SEEDS = 15 };

typedef double function(const double *x, size_t n);

static double sphere(const double *x, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++) sum += (x[i] - 1.0) * (x[i] - 1.0);
  return sum;
}

static double rosenbrock(const double *x, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i + 1 < n; i++)
    sum += 100.0 * pow(x[i + 1] - x[i] * x[i], 2.0) + pow(1.0 - x[i], 2.0);
  return sum;
}

/* Half axes from 1 to 1000, rotated by a reflection. */
static double ellipsoid(const double *x, size_t n) {
  double along = 0.0, norm = 0.0, sum = 0.0;
  for (size_t i = 0; i < n; i++) {
    along += (double)(i + 1) * x[i];
    norm += (double)((i + 1) * (i + 1));
  }
  for (size_t i = 0; i < n; i++) {
    double y = x[i] - 2.0 * along * (double)(i + 1) / norm;
    sum += pow(1e6, (double)i / (double)(n - 1)) * y * y;
  }
  return sum;
}

static double rastrigin(const double *x, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++) sum += x[i] * x[i] + 10.0 * (1.0 - cos(6.283185307179586 * x[i]));
  return sum;
}

/* Its least value in the box is at the corner -5: a slope through the bound. */
static double ramp(const double *x, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++) sum += x[i] + 5.0;
  return sum;
}

static double flat(const double *x, size_t n) {
  (void)x;
  (void)n;
  return 7.0;
}

static double nowhere(const double *x, size_t n) {
  (void)x;
  (void)n;
  return (double)NAN;
}

/* Half of the box fails. */
static double half(const double *x, size_t n) { return x[0] < 0.0 ? (double)NAN : sphere(x, n); }

/* Searches in [-5, 5]^n. */
static strut_cma *search(const strut_cma_options *options, function *f) {
  strut_cma *c;
  double x[MOST], values[200];
  assert_ok(strut_cma_create(options, &c, NULL));
  size_t n = options->dimension, population = strut_cma_population(c);
  assert_true(population <= 200);
  while (strut_cma_stopped(c) == STRUT_CMA_GOES_ON) {
    const double *points = strut_cma_ask(c);
    for (size_t p = 0; p < population; p++) {
      for (size_t i = 0; i < n; i++) {
        double u = points[p * n + i];
        assert_true(u >= 0.0 && u <= 1.0);
        x[i] = -5.0 + 10.0 * u;
      }
      values[p] = f(x, n);
    }
    strut_cma_tell(c, values);
  }
  return c;
}

static int ascending(const void *a, const void *b) {
  double d = *(const double *)a - *(const double *)b;
  return (d > 0) - (d < 0);
}

/* Median evaluations to the target; *failures: searches that did not reach it. */
static double measure(const char *name, function *f, size_t n, size_t population, int *failures) {
  double counts[SEEDS];
  double start[MOST];
  for (size_t i = 0; i < n; i++) start[i] = 0.3;
  *failures = 0;
  for (int seed = 1; seed <= SEEDS; seed++) {
    const strut_cma_options options = {.dimension = n,
                                       .start = start,
                                       .spread = 0.2,
                                       .population = population,
                                       .seed = (uint32_t)seed,
                                       .evaluations = 30000,
                                       .target = 1e-10,
                                       .has_target = 1};
    OWN_POINTER(strut_cma) c = search(&options, f);
    bool reached = strut_cma_stopped(c) == STRUT_CMA_TARGET;
    *failures += !reached;
    counts[seed - 1] = reached ? (double)strut_cma_evaluations(c) : 1e9;
  }
  qsort(counts, SEEDS, sizeof *counts, ascending);
  printf("%s, %zu numbers: %g evaluations, %d of %d failed\n", name, n, counts[SEEDS / 2],
         *failures, SEEDS);
  return counts[SEEDS / 2];
}

/* The bounds are python3-cmaes 0.9.1's medians and a fifth. */
TEST(evaluations_are_those_of_others) {
  int failures;
  assert_true(measure("sphere", sphere, 10, 0, &failures) < 1.2 * 1780.0);
  assert_int_equal(failures, 0);
  assert_true(measure("Rosenbrock", rosenbrock, 5, 0, &failures) < 1.2 * 2080.0);
  assert_true(failures <= 3); /* it has a local minimum */
  assert_true(measure("ellipsoid", ellipsoid, 10, 0, &failures) < 1.2 * 4350.0);
  assert_int_equal(failures, 0);
  assert_true(measure("Rastrigin", rastrigin, 3, 60, &failures) < 1.2 * 3180.0);
  assert_true(failures <= 8); /* 6 of 15 there: many local minima */
}

TEST(a_minimum_on_a_bound_is_found) {
  const strut_cma_options options = {.dimension = 4, .seed = 3, .evaluations = 20000};
  OWN_POINTER(strut_cma) c = search(&options, ramp);
  double value;
  const double *best = strut_cma_best(c, &value);
  for (size_t i = 0; i < 4; i++) assert_true(best[i] < 1e-8);
  assert_true(strut_cma_evaluations(c) < 3000);
  assert_int_equal(strut_cma_stopped(c), STRUT_CMA_POINT);
}

TEST(failed_points_are_worst) {
  const strut_cma_options options = {
      .dimension = 3, .seed = 4, .evaluations = 5000, .target = 1e-10, .has_target = 1};
  OWN_POINTER(strut_cma) c = search(&options, half);
  assert_int_equal(strut_cma_stopped(c), STRUT_CMA_TARGET);
}

TEST(nothing_to_find_ends) {
  double value;
  const strut_cma_options options = {.dimension = 2, .seed = 5};
  strut_cma *c = search(&options, flat);
  assert_int_equal(strut_cma_stopped(c), STRUT_CMA_FLAT);
  assert_non_null(strut_cma_best(c, &value));
  assert_true(value == 7.0);
  strut_cma_free(c);
  c = search(&options, nowhere);
  assert_int_equal(strut_cma_stopped(c), STRUT_CMA_FLAT);
  assert_null(strut_cma_best(c, &value));
  strut_cma_free(c);
}

TEST(one_number_is_searched) {
  const strut_cma_options options = {.dimension = 1, .seed = 1, .target = 1e-12, .has_target = 1};
  OWN_POINTER(strut_cma) c = search(&options, sphere);
  assert_int_equal(strut_cma_stopped(c), STRUT_CMA_TARGET);
  assert_true(strut_cma_evaluations(c) < 600);
}

TEST(seeds_decide_the_bits) {
  strut_cma_options options = {.dimension = 5, .seed = 8, .evaluations = 2000};
  double value[3];
  for (int i = 0; i < 3; i++) {
    options.seed = i < 2 ? 8 : 9;
    OWN_POINTER(strut_cma) c = search(&options, rosenbrock);
    strut_cma_best(c, &value[i]);
  }
  assert_all(value[0] == value[1], value[0] != value[2]);
}

TEST(populations_fill_lanes) {
  strut_cma *c;
  strut_cma_options options = {.dimension = 5, .multiple = 16};
  assert_ok(strut_cma_create(&options, &c, NULL));
  assert_int_equal(strut_cma_population(c), 16);
  const double *points = strut_cma_ask(c);
  double first = points[0];
  assert_true(strut_cma_ask(c)[0] == first); /* until values are reported */
  strut_cma_free(c);
  options.population = 17;
  assert_ok(strut_cma_create(&options, &c, NULL));
  assert_int_equal(strut_cma_population(c), 32);
  strut_cma_free(c);
}

/* A minimum at 0.95 is near to a start at 0.05, if that is an angle; else the bound is in between. */
TEST(an_angle_wraps) {
  const double start[] = {0.05, 0.05};
  const bool wraps[] = {true, true};
  for (uint32_t seed = 1; seed <= SEEDS; seed++) {
    const strut_cma_options options = {.dimension = 2,
                                       .start = start,
                                       .spread = 0.02,
                                       .seed = seed,
                                       .evaluations = 600,
                                       .wraps = wraps};
    OWN_POINTER(strut_cma) c;
    double values[100], value;
    assert_ok(strut_cma_create(&options, &c, NULL));
    while (!strut_cma_stopped(c)) {
      const double *x = strut_cma_ask(c);
      for (size_t p = 0; p < strut_cma_population(c); p++) {
        values[p] = 0.0;
        for (size_t i = 0; i < 2; i++) {
          double apart = fabs(x[2 * p + i] - 0.95);
          assert_true(x[2 * p + i] >= 0.0 && x[2 * p + i] <= 1.0);
          values[p] += pow(fmin(apart, 1.0 - apart), 2.0);
        }
      }
      strut_cma_tell(c, values);
    }
    assert_non_null(strut_cma_best(c, &value));
    assert_true(value < 1e-12);
  }
}

TEST(wrong_options_are_refused) {
  strut_cma *c;
  const double outside[] = {0.5, 1.5};
  const strut_cma_options wrong[] = {{.dimension = 0},
                                     {.dimension = STRUT_CMA_MOST_NUMBERS + 1},
                                     {.dimension = 2, .population = 3},
                                     {.dimension = 2, .start = outside},
                                     {.dimension = 2, .spread = -1.0}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    assert_int_equal(strut_cma_create(&wrong[i], &c, NULL), STRUT_USAGE);
    assert_null(c);
    strut_cma_free(c);
  }
}
