/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/search/optimisers.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/statics/algebra.h"

/* Width next to each bound where the map into the box is a parabola. */
static const double MARGIN = 0.05;
/* Widest standard deviation: beyond it mirrored points fill the box evenly. */
static const double WIDEST = 1.0;
static const double MOST_CONDITION = 1e14; /* of the covariance matrix */

typedef struct ranked {
  double value;
  size_t index;
} ranked;

struct strut_cma {
  strut_arena arena;
  gsl_rng *rng;
  size_t n, population, parents;
  int64_t evaluations, most_evaluations, generation;
  /* constants of the strategy */
  double *weight; /* (population) of the best first; those of the worse half are negative */
  double mass;    /* variance effective parents */
  double sigma_rate, sigma_damping, path_rate, one_rate, mu_rate, weight_sum, expected;
  int64_t refresh; /* generations between two eigendecompositions */
  /* the search distribution: mean + sigma * N(0, covariance) */
  double sigma, *mean, *covariance; /* (n); (n, n) */
  double *axes, *length;     /* (n, n) unit eigenvectors, one per row; (n) their deviations */
  double *sigma_path, *path; /* (n) */
  /* the generation */
  double *steps, *points; /* (population, n): in the strategy's space by sigma; in the box */
  ranked *order;          /* (population) */
  double *mean_step, *scratch, *work; /* (n); (n); (n) */
  bool asked;
  /* what is known */
  double best_value, *best;
  double point_tolerance, value_tolerance, target;
  bool has_target;
  size_t history_count, history_capacity; /* best values of generations, the latest last */
  double *history;
  strut_cma_stop stop;
  bool *wraps; /* (n) */
};

/* Maps a number of the strategy's space into [0, 1]; even about both ends, with a slope everywhere
 * continuous. Inside the margins it is the identity. */
static double into_box(double y) {
  double low = -MARGIN, period = 2.0 * (1.0 + 2.0 * MARGIN);
  double along = fmod(y - low, period);
  if (along < 0.0) along += period;
  if (along > 0.5 * period) along = period - along;
  double from_low = along, from_high = 0.5 * period - along;
  if (from_low < 2.0 * MARGIN) return from_low * from_low / (4.0 * MARGIN);
  if (from_high < 2.0 * MARGIN) return 1.0 - from_high * from_high / (4.0 * MARGIN);
  return along + low;
}

/* The number whose image is x. */
static double from_box(double x) {
  if (x < MARGIN) return -MARGIN + 2.0 * sqrt(MARGIN * fmax(x, 0.0));
  if (x > 1.0 - MARGIN) return 1.0 + MARGIN - 2.0 * sqrt(MARGIN * fmax(1.0 - x, 0.0));
  return x;
}

/* Weights and rates: table 1 of the tutorial. */
static void choose_constants(strut_cma *c) {
  double n = (double)c->n, lambda = (double)c->population;
  double sum[2] = {0}, squares[2] = {0};
  for (size_t i = 0; i < c->population; i++) {
    double w = log((lambda + 1.0) / 2.0) - log((double)(i + 1));
    int side = i >= c->parents;
    c->weight[i] = w;
    sum[side] += fabs(w);
    squares[side] += w * w;
  }
  double mass = sum[0] * sum[0] / squares[0], negative_mass = sum[1] * sum[1] / squares[1];
  c->mass = mass;
  c->sigma_rate = (mass + 2.0) / (n + mass + 5.0);
  c->sigma_damping = 1.0 + 2.0 * fmax(0.0, sqrt((mass - 1.0) / (n + 1.0)) - 1.0) + c->sigma_rate;
  c->path_rate = (4.0 + mass / n) / (n + 4.0 + 2.0 * mass / n);
  c->one_rate = 2.0 / ((n + 1.3) * (n + 1.3) + mass);
  c->mu_rate = fmin(1.0 - c->one_rate,
                    2.0 * (0.25 + mass + 1.0 / mass - 2.0) / ((n + 2.0) * (n + 2.0) + mass));
  c->expected = sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
  double limit = fmin(1.0 + c->one_rate / c->mu_rate, 1.0 + 2.0 * negative_mass / (mass + 2.0));
  limit = fmin(limit, (1.0 - c->one_rate - c->mu_rate) / (n * c->mu_rate));
  c->weight_sum = 0.0;
  for (size_t i = 0; i < c->population; i++) {
    int side = i >= c->parents;
    c->weight[i] *= (side ? fmax(limit, 0.0) : 1.0) / sum[side];
    c->weight_sum += c->weight[i];
  }
  c->refresh = (int64_t)fmax(1.0, floor(1.0 / (10.0 * n * (c->one_rate + c->mu_rate))));
}

static bool allocate(strut_cma *c) {
  size_t n = c->n, m = c->population;
  double **vectors[] = {&c->mean,      &c->length,  &c->sigma_path, &c->path,
                        &c->mean_step, &c->scratch, &c->work,       &c->best};
  bool fine = true;
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
    *vectors[i] = strut_arena_allocate(&c->arena, n, sizeof(double));
    fine = fine && *vectors[i];
  }
  c->weight = strut_arena_allocate(&c->arena, m, sizeof *c->weight);
  c->order = strut_arena_allocate(&c->arena, m, sizeof *c->order);
  c->steps = strut_arena_allocate(&c->arena, m, n * sizeof(double));
  c->points = strut_arena_allocate(&c->arena, m, n * sizeof(double));
  c->covariance = strut_arena_allocate(&c->arena, n, n * sizeof(double));
  c->axes = strut_arena_allocate(&c->arena, n, n * sizeof(double));
  /* As many generations as stagnation is judged by, and half as many again. */
  c->history_capacity = 120 + 30 * n / m + 20;
  c->history = strut_arena_allocate(&c->arena, c->history_capacity, sizeof *c->history);
  c->wraps = strut_arena_allocate(&c->arena, n, sizeof *c->wraps);
  c->rng = gsl_rng_alloc(gsl_rng_mt19937);
  return fine && c->wraps && c->weight && c->order && c->steps && c->points && c->covariance &&
         c->axes && c->history && c->rng;
}

static strut_status check_options(const strut_cma_options *o, strut_error *error) {
  if (o->dimension < 1 || o->dimension > STRUT_CMA_MOST_NUMBERS)
    return strut_fail(error, STRUT_USAGE, "CMA-ES searches over 1 to %d numbers, not %zu",
                      STRUT_CMA_MOST_NUMBERS, o->dimension);
  if (o->population == 1 || o->population == 2 || o->population == 3 ||
      o->population > STRUT_CMA_MOST_POPULATION || o->multiple > STRUT_CMA_MOST_POPULATION)
    return strut_fail(error, STRUT_USAGE, "the population of CMA-ES must be 4 to %d, not %zu",
                      STRUT_CMA_MOST_POPULATION, o->population);
  for (size_t i = 0; i < o->dimension && o->start; i++)
    if (!(o->start[i] >= 0.0 && o->start[i] <= 1.0))
      return strut_fail(error, STRUT_USAGE, "the start of CMA-ES must lie in the box");
  if (o->spread < 0.0 || !isfinite(o->spread))
    return strut_fail(error, STRUT_USAGE, "the spread of CMA-ES must be positive");
  return STRUT_OK;
}

strut_status strut_cma_create(const strut_cma_options *options, strut_cma **cma,
                              strut_error *error) {
  *cma = NULL;
  strut_status status = check_options(options, error);
  if (status) return status;
  strut_cma *c = strut_allocate(1, sizeof *c);
  if (!c) return strut_no_memory(error, "");
  size_t n = c->n = options->dimension, multiple = options->multiple ? options->multiple : 1;
  size_t usual = 4 + (size_t)floor(3.0 * log((double)n));
  c->population = options->population ? options->population : usual;
  c->population = (c->population + multiple - 1) / multiple * multiple;
  c->parents = c->population / 2;
  c->most_evaluations = options->evaluations > 0 ? options->evaluations : INT64_MAX;
  c->point_tolerance = options->point_tolerance > 0.0 ? options->point_tolerance : 1e-9;
  c->value_tolerance = options->value_tolerance;
  c->target = options->target;
  c->has_target = options->has_target;
  c->best_value = (double)NAN;
  if (!allocate(c)) {
    strut_cma_free(c);
    return strut_no_memory(error, "");
  }
  choose_constants(c);
  gsl_rng_set(c->rng, options->seed ? options->seed : UINT32_MAX); /* 0 is the default of GSL */
  c->sigma = options->spread > 0.0 ? fmin(options->spread, WIDEST) : 0.3;
  for (size_t i = 0; i < n; i++) {
    double start = options->start ? options->start[i] : 0.5;
    c->wraps[i] = options->wraps && options->wraps[i];
    c->mean[i] = c->wraps[i] ? start : from_box(start);
    c->covariance[i * n + i] = c->axes[i * n + i] = c->length[i] = 1.0;
  }
  *cma = c;
  return STRUT_OK;
}

void strut_cma_free(strut_cma *c) {
  if (!c) return;
  gsl_rng_free(c->rng);
  strut_arena_free(&c->arena);
  strut_release(c);
}

size_t strut_cma_population(const strut_cma *c) { return c->population; }
strut_cma_stop strut_cma_stopped(const strut_cma *c) { return c->stop; }
int64_t strut_cma_evaluations(const strut_cma *c) { return c->evaluations; }

double strut_cma_deviation(const strut_cma *c, size_t k) {
  return c->sigma * sqrt(fmax(c->covariance[k * c->n + k], 0.0));
}

const double *strut_cma_best(const strut_cma *c, double *value) {
  *value = c->best_value;
  return isfinite(c->best_value) ? c->best : NULL;
}

const double *strut_cma_ask(strut_cma *c) {
  size_t n = c->n;
  for (size_t p = 0; p < c->population && !c->asked; p++) {
    double *step = &c->steps[p * n];
    memset(step, 0, n * sizeof *step);
    for (size_t k = 0; k < n; k++) {
      double along = c->length[k] * gsl_ran_gaussian(c->rng, 1.0);
      for (size_t i = 0; i < n; i++) step[i] += along * c->axes[k * n + i];
    }
    for (size_t i = 0; i < n; i++) {
      double y = c->mean[i] + c->sigma * step[i];
      c->points[p * n + i] = c->wraps[i] ? y - floor(y) : into_box(y);
    }
  }
  c->asked = true;
  return c->points;
}

/* Equal values in the order of the points. */
static int by_value(const void *a, const void *b) {
  const ranked *first = a, *second = b;
  if (first->value != second->value) return first->value < second->value ? -1 : 1;
  return (first->index > second->index) - (first->index < second->index);
}

static void rank_points(strut_cma *c, const double *values) {
  for (size_t p = 0; p < c->population; p++)
    c->order[p] = (ranked){isfinite(values[p]) ? values[p] : (double)INFINITY, p};
  qsort(c->order, c->population, sizeof *c->order, by_value);
  const ranked *first = &c->order[0];
  if (isfinite(first->value) && !(c->best_value <= first->value)) {
    c->best_value = first->value;
    memcpy(c->best, &c->points[first->index * c->n], c->n * sizeof *c->best);
  }
}

/* to = C^(-1/2) from. */
static void whiten(const strut_cma *c, const double *from, double *to) {
  size_t n = c->n;
  memset(to, 0, n * sizeof *to);
  for (size_t k = 0; k < n; k++) {
    const double *axis = &c->axes[k * n];
    double along = 0.0;
    for (size_t i = 0; i < n; i++) along += axis[i] * from[i];
    along /= c->length[k];
    for (size_t i = 0; i < n; i++) to[i] += along * axis[i];
  }
}

static double squared_length(const double *v, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++) sum += v[i] * v[i];
  return sum;
}

/* Moves the mean, then both evolution paths. Returns 1, or 0 where the latter's update is stalled since
 * sigma grows fast. */
static double move_mean(strut_cma *c) {
  size_t n = c->n;
  memset(c->mean_step, 0, n * sizeof *c->mean_step);
  for (size_t p = 0; p < c->parents; p++)
    for (size_t i = 0; i < n; i++)
      c->mean_step[i] += c->weight[p] * c->steps[c->order[p].index * n + i];
  whiten(c, c->mean_step, c->scratch);
  double rate = c->sigma_rate, gain = sqrt(rate * (2.0 - rate) * c->mass);
  for (size_t i = 0; i < n; i++) {
    c->mean[i] += c->sigma * c->mean_step[i];
    c->sigma_path[i] = (1.0 - rate) * c->sigma_path[i] + gain * c->scratch[i];
  }
  double length = sqrt(squared_length(c->sigma_path, n));
  double settled = sqrt(1.0 - pow(1.0 - rate, 2.0 * (double)(c->generation + 1)));
  double open = length / settled < (1.4 + 2.0 / ((double)n + 1.0)) * c->expected ? 1.0 : 0.0;
  gain = open * sqrt(c->path_rate * (2.0 - c->path_rate) * c->mass);
  for (size_t i = 0; i < n; i++)
    c->path[i] = (1.0 - c->path_rate) * c->path[i] + gain * c->mean_step[i];
  c->sigma *= exp(fmin(1.0, rate / c->sigma_damping * (length / c->expected - 1.0)));
  return open;
}

static void adapt_covariance(strut_cma *c, double open) {
  size_t n = c->n;
  double stalled = (1.0 - open) * c->path_rate * (2.0 - c->path_rate);
  double keep = 1.0 + c->one_rate * stalled - c->one_rate - c->mu_rate * c->weight_sum;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++)
      c->covariance[i * n + k] =
          keep * c->covariance[i * n + k] + c->one_rate * c->path[i] * c->path[k];
  for (size_t p = 0; p < c->population; p++) {
    const double *step = &c->steps[c->order[p].index * n];
    double weight = c->weight[p];
    if (weight < 0.0) { /* as long as the mean one, so that the matrix stays positive definite */
      whiten(c, step, c->scratch);
      weight *= (double)n / fmax(squared_length(c->scratch, n), 1e-300);
    }
    for (size_t i = 0; i < n; i++)
      for (size_t k = 0; k <= i; k++)
        c->covariance[i * n + k] += c->mu_rate * weight * step[i] * step[k];
  }
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < i; k++) c->covariance[k * n + i] = c->covariance[i * n + k];
}

/* Decomposes the covariance matrix. False: its condition is too large, or it is no covariance. */
static bool decompose(strut_cma *c) {
  size_t n = c->n;
  double least = (double)INFINITY, most = 0.0;
  memcpy(c->axes, c->covariance, n * n * sizeof *c->axes);
  if (!strut_eigen(c->axes, (int32_t)n, c->length, c->work)) return false;
  for (size_t k = 0; k < n; k++) {
    least = fmin(least, c->length[k]);
    most = fmax(most, c->length[k]);
    c->length[k] = sqrt(fmax(c->length[k], 0.0));
  }
  return least > 0.0 && most < MOST_CONDITION * least;
}

/* Bounds what mirrored points cannot show: a distribution wider than the box. */
static void limit_width(strut_cma *c) {
  double widest = 0.0;
  for (size_t i = 0; i < c->n; i++) widest = fmax(widest, strut_cma_deviation(c, i));
  if (widest > WIDEST) c->sigma *= WIDEST / widest;
}

static double median(const double *values, size_t count, double *sorted) {
  memcpy(sorted, values, count * sizeof *sorted);
  for (size_t i = 1; i < count; i++) {
    double value = sorted[i];
    size_t k = i;
    for (; k > 0 && sorted[k - 1] > value; k--) sorted[k] = sorted[k - 1];
    sorted[k] = value;
  }
  return sorted[count / 2];
}

static bool is_narrow(const strut_cma *c) {
  for (size_t i = 0; i < c->n; i++)
    if (strut_cma_deviation(c, i) > c->point_tolerance) return false;
  return true;
}

/* Do the best values of the latest generations and all values of this one agree? */
static bool is_flat(const strut_cma *c) {
  size_t wanted = 10 + (30 * c->n + c->population - 1) / c->population;
  if (c->history_count < wanted) return false;
  double low = c->order[0].value, high = c->order[c->population - 1].value;
  for (size_t i = c->history_count - wanted; i < c->history_count; i++) {
    low = fmin(low, c->history[i]);
    high = fmax(high, c->history[i]);
  }
  return low == high || high - low <= c->value_tolerance; /* also where all are infinite */
}

/* Have the medians of the first and the last twenty generations of a long stretch come no closer to a
 * minimum? */
static bool is_stagnant(const strut_cma *c) {
  double sorted[20];
  if (c->history_count < c->history_capacity) return false;
  double before = median(c->history, 20, sorted);
  return median(&c->history[c->history_count - 20], 20, sorted) >= before;
}

static void remember(strut_cma *c) {
  if (c->history_count == c->history_capacity) {
    c->history_count--;
    memmove(c->history, c->history + 1, c->history_count * sizeof *c->history);
  }
  c->history[c->history_count++] = c->order[0].value;
}

static strut_cma_stop find_stop(const strut_cma *c, bool decomposed) {
  if (c->has_target && c->best_value <= c->target) return STRUT_CMA_TARGET;
  if (c->evaluations >= c->most_evaluations) return STRUT_CMA_EVALUATIONS;
  if (!decomposed) return STRUT_CMA_CONDITION;
  if (is_narrow(c)) return STRUT_CMA_POINT;
  if (is_flat(c)) return STRUT_CMA_FLAT;
  return is_stagnant(c) ? STRUT_CMA_STAGNANT : STRUT_CMA_GOES_ON;
}

void strut_cma_tell(strut_cma *c, const double *values) {
  bool decomposed = true;
  strut_cma_ask(c);
  rank_points(c, values);
  c->evaluations += (int64_t)c->population;
  remember(c);
  if (isfinite(c->order[0].value)) { /* else nothing is known of this generation */
    double open = move_mean(c);
    adapt_covariance(c, open);
    if ((c->generation + 1) % c->refresh == 0) decomposed = decompose(c);
    limit_width(c);
  }
  c->generation++;
  c->asked = false;
  c->stop = find_stop(c, decomposed);
}
