/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * CMA-ES, the evolution strategy with covariance matrix adaptation (N. Hansen, The CMA evolution strategy: a tutorial,
 * arXiv 1604.00772), with negative weights.
 *
 * Bounds: the strategy lives in all of space; a number beyond the box is mirrored into it, and next to each bound the
 * map is a parabola, so that a minimum on a bound is a smooth one for the strategy. Values only have to be comparable;
 * one that is not finite is worst.
 */
#include "engine/study/search/optimisers.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "engine/statics/algebra.h"

/* Width next to each bound where the map into the box is a parabola. */
static const double MARGIN = 0.05;
/* Widest standard deviation: beyond it mirrored points fill the box evenly. */
static const double WIDEST = 1.0;
static const double MOST_CONDITION = 1e14; /* of the covariance matrix */
/* A narrower distribution ends the search, in widths of the box. */
static const double NARROWEST = 1e-9;

typedef struct ranked {
  double value;
  size_t index;
} ranked;

typedef struct strut_cma {
  strut_arena arena;
  gsl_rng *rng;
  size_t n, population, parents;
  int64_t generation;
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
  double *mean_step, *scratch, *work;     /* (n); (n); (n) */
  size_t history_count, history_capacity; /* best values of generations, the latest last */
  double *history;
  const bool *wraps; /* (n) */
} strut_cma;

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
static void choose_constants(strut_cma *cma) {
  double n = (double)cma->n, lambda = (double)cma->population;
  double sum[2] = {0}, squares[2] = {0};
  for (size_t i = 0; i < cma->population; i++) {
    double w = log((lambda + 1.0) / 2.0) - log((double)(i + 1));
    int side = i >= cma->parents;
    cma->weight[i] = w;
    sum[side] += fabs(w);
    squares[side] += w * w;
  }
  double mass = sum[0] * sum[0] / squares[0], negative_mass = sum[1] * sum[1] / squares[1];
  cma->mass = mass;
  cma->sigma_rate = (mass + 2.0) / (n + mass + 5.0);
  cma->sigma_damping =
      1.0 + 2.0 * fmax(0.0, sqrt((mass - 1.0) / (n + 1.0)) - 1.0) + cma->sigma_rate;
  cma->path_rate = (4.0 + mass / n) / (n + 4.0 + 2.0 * mass / n);
  cma->one_rate = 2.0 / ((n + 1.3) * (n + 1.3) + mass);
  cma->mu_rate = fmin(1.0 - cma->one_rate,
                      2.0 * (0.25 + mass + 1.0 / mass - 2.0) / ((n + 2.0) * (n + 2.0) + mass));
  cma->expected = sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
  double limit = fmin(1.0 + cma->one_rate / cma->mu_rate, 1.0 + 2.0 * negative_mass / (mass + 2.0));
  limit = fmin(limit, (1.0 - cma->one_rate - cma->mu_rate) / (n * cma->mu_rate));
  cma->weight_sum = 0.0;
  for (size_t i = 0; i < cma->population; i++) {
    int side = i >= cma->parents;
    cma->weight[i] *= (side ? fmax(limit, 0.0) : 1.0) / sum[side];
    cma->weight_sum += cma->weight[i];
  }
  cma->refresh = (int64_t)fmax(1.0, floor(1.0 / (10.0 * n * (cma->one_rate + cma->mu_rate))));
}

static bool allocate(strut_cma *cma) {
  size_t n = cma->n, m = cma->population;
  strut_arena *arena = &cma->arena;
  /* As many generations as stagnation is judged by, and half as many again. */
  cma->history_capacity = 120 + 30 * n / m + 20;
  cma->rng = gsl_rng_alloc(gsl_rng_mt19937);
  return STRUT_NUMBERS(arena, n, &cma->mean, &cma->length, &cma->sigma_path, &cma->path,
                       &cma->mean_step, &cma->scratch, &cma->work) &&
         STRUT_NUMBERS(arena, m * n, &cma->steps, &cma->points) &&
         STRUT_NUMBERS(arena, n * n, &cma->covariance, &cma->axes) &&
         STRUT_NUMBERS(arena, cma->history_capacity, &cma->history) && cma->rng &&
         STRUT_ALLOCATE(arena, STRUT_NEW(cma->weight, m), STRUT_NEW(cma->order, m));
}

static double deviation(const strut_cma *cma, size_t k) {
  return cma->sigma * sqrt(fmax(cma->covariance[k * cma->n + k], 0.0));
}

static void draw_points(strut_cma *cma) {
  size_t n = cma->n;
  for (size_t p = 0; p < cma->population; p++) {
    double *step = &cma->steps[p * n];
    memset(step, 0, n * sizeof *step);
    for (size_t k = 0; k < n; k++) {
      double along = cma->length[k] * gsl_ran_gaussian(cma->rng, 1.0);
      for (size_t i = 0; i < n; i++) step[i] += along * cma->axes[k * n + i];
    }
    for (size_t i = 0; i < n; i++) {
      double y = cma->mean[i] + cma->sigma * step[i];
      cma->points[p * n + i] = cma->wraps[i] ? y - floor(y) : into_box(y);
    }
  }
}

/* Equal values in the order of the points. */
static int by_value(const void *a, const void *b) {
  const ranked *first = a, *second = b;
  if (first->value != second->value) return first->value < second->value ? -1 : 1;
  return (first->index > second->index) - (first->index < second->index);
}

/* to = C^(-1/2) from. */
static void whiten(const strut_cma *cma, const double *from, double *to) {
  size_t n = cma->n;
  memset(to, 0, n * sizeof *to);
  for (size_t k = 0; k < n; k++) {
    const double *axis = &cma->axes[k * n];
    double along = strut_dot(axis, from, (ptrdiff_t)n) / cma->length[k];
    for (size_t i = 0; i < n; i++) to[i] += along * axis[i];
  }
}

static double squared_length(const double *v, size_t n) { return strut_dot(v, v, (ptrdiff_t)n); }

/* Moves the mean, then both evolution paths. Returns 1, or 0 where the latter's update is stalled since
 * sigma grows fast. */
static double move_mean(strut_cma *cma) {
  size_t n = cma->n;
  memset(cma->mean_step, 0, n * sizeof *cma->mean_step);
  for (size_t p = 0; p < cma->parents; p++)
    for (size_t i = 0; i < n; i++)
      cma->mean_step[i] += cma->weight[p] * cma->steps[cma->order[p].index * n + i];
  whiten(cma, cma->mean_step, cma->scratch);
  double rate = cma->sigma_rate, gain = sqrt(rate * (2.0 - rate) * cma->mass);
  for (size_t i = 0; i < n; i++) {
    cma->mean[i] += cma->sigma * cma->mean_step[i];
    cma->sigma_path[i] = (1.0 - rate) * cma->sigma_path[i] + gain * cma->scratch[i];
  }
  double length = sqrt(squared_length(cma->sigma_path, n));
  double settled = sqrt(1.0 - pow(1.0 - rate, 2.0 * (double)(cma->generation + 1)));
  double open = length / settled < (1.4 + 2.0 / ((double)n + 1.0)) * cma->expected ? 1.0 : 0.0;
  gain = open * sqrt(cma->path_rate * (2.0 - cma->path_rate) * cma->mass);
  for (size_t i = 0; i < n; i++)
    cma->path[i] = (1.0 - cma->path_rate) * cma->path[i] + gain * cma->mean_step[i];
  cma->sigma *= exp(fmin(1.0, rate / cma->sigma_damping * (length / cma->expected - 1.0)));
  return open;
}

static void adapt_covariance(strut_cma *cma, double open) {
  size_t n = cma->n;
  double stalled = (1.0 - open) * cma->path_rate * (2.0 - cma->path_rate);
  double keep = 1.0 + cma->one_rate * stalled - cma->one_rate - cma->mu_rate * cma->weight_sum;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++)
      cma->covariance[i * n + k] =
          keep * cma->covariance[i * n + k] + cma->one_rate * cma->path[i] * cma->path[k];
  for (size_t p = 0; p < cma->population; p++) {
    const double *step = &cma->steps[cma->order[p].index * n];
    double weight = cma->weight[p];
    if (weight < 0.0) { /* as long as the mean one, so that the matrix stays positive definite */
      whiten(cma, step, cma->scratch);
      weight *= (double)n / fmax(squared_length(cma->scratch, n), 1e-300);
    }
    for (size_t i = 0; i < n; i++)
      for (size_t k = 0; k <= i; k++)
        cma->covariance[i * n + k] += cma->mu_rate * weight * step[i] * step[k];
  }
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < i; k++) cma->covariance[k * n + i] = cma->covariance[i * n + k];
}

/* Decomposes the covariance matrix. False: its condition is too large, or it is no covariance. */
static bool decompose(strut_cma *cma) {
  size_t n = cma->n;
  double least = (double)INFINITY, most = 0.0;
  memcpy(cma->axes, cma->covariance, n * n * sizeof *cma->axes);
  if (!strut_eigen(cma->axes, (int32_t)n, cma->length, cma->work)) return false;
  for (size_t k = 0; k < n; k++) {
    least = fmin(least, cma->length[k]);
    most = fmax(most, cma->length[k]);
    cma->length[k] = sqrt(fmax(cma->length[k], 0.0));
  }
  return least > 0.0 && most < MOST_CONDITION * least;
}

/* Bounds what mirrored points cannot show: a distribution wider than the box. */
static void limit_width(strut_cma *cma) {
  double widest = 0.0;
  for (size_t i = 0; i < cma->n; i++) widest = fmax(widest, deviation(cma, i));
  if (widest > WIDEST) cma->sigma *= WIDEST / widest;
}

static double median(const double *values, size_t count, double *sorted) {
  memcpy(sorted, values, count * sizeof *sorted);
  gsl_sort(sorted, 1, count);
  return sorted[count / 2];
}

static bool is_narrow(const strut_cma *cma) {
  for (size_t i = 0; i < cma->n; i++)
    if (deviation(cma, i) > NARROWEST) return false;
  return true;
}

/* Do the best values of the latest generations and all values of this one agree? */
static bool is_flat(const strut_cma *cma) {
  size_t wanted = 10 + (30 * cma->n + cma->population - 1) / cma->population;
  if (cma->history_count < wanted) return false;
  double low = cma->order[0].value, high = cma->order[cma->population - 1].value;
  for (size_t i = cma->history_count - wanted; i < cma->history_count; i++) {
    low = fmin(low, cma->history[i]);
    high = fmax(high, cma->history[i]);
  }
  return low == high; /* also where all are infinite */
}

/* Have the medians of the first and the last twenty generations of a long stretch come no closer to a
 * minimum? */
static bool is_stagnant(const strut_cma *cma) {
  double sorted[20];
  if (cma->history_count < cma->history_capacity) return false;
  double before = median(cma->history, 20, sorted);
  return median(&cma->history[cma->history_count - 20], 20, sorted) >= before;
}

static void remember(strut_cma *cma) {
  if (cma->history_count == cma->history_capacity) {
    cma->history_count--;
    memmove(cma->history, cma->history + 1, cma->history_count * sizeof *cma->history);
  }
  cma->history[cma->history_count++] = cma->order[0].value;
}

/* Adapts to the values of a generation. False: it cannot go on, or need not. */
static bool learn(strut_cma *cma, const double *values) {
  bool decomposed = true;
  for (size_t p = 0; p < cma->population; p++)
    cma->order[p] = (ranked){isfinite(values[p]) ? values[p] : (double)INFINITY, p};
  qsort(cma->order, cma->population, sizeof *cma->order, by_value);
  remember(cma);
  if (isfinite(cma->order[0].value)) { /* else nothing is known of this generation */
    double open = move_mean(cma);
    adapt_covariance(cma, open);
    if ((cma->generation + 1) % cma->refresh == 0) decomposed = decompose(cma);
    limit_width(cma);
  }
  cma->generation++;
  return decomposed && !is_narrow(cma) && !is_flat(cma) && !is_stagnant(cma);
}

bool strut_search_optimise_by_cma(const strut_search_task *task, const strut_search_asker *asker,
                                  size_t population, double spread) {
  size_t n = task->dimension;
  strut_cma cma = {.n = n,
                   .population = population,
                   .parents = population / 2,
                   .sigma = spread,
                   .wraps = task->wraps};
  double *values = strut_arena_allocate(&cma.arena, population, sizeof *values);
  bool fine = values && allocate(&cma), more = fine;
  if (fine) {
    choose_constants(&cma);
    gsl_rng_set(cma.rng, task->seed ? task->seed : UINT32_MAX); /* 0 is the default of GSL */
    for (size_t i = 0; i < n; i++) {
      cma.mean[i] = cma.wraps[i] ? task->start[i] : from_box(task->start[i]);
      cma.covariance[i * n + i] = cma.axes[i * n + i] = cma.length[i] = 1.0;
    }
  }
  while (more) {
    draw_points(&cma);
    more = asker->ask(asker->context, population, cma.points, values, NULL) && learn(&cma, values);
  }
  if (cma.rng) gsl_rng_free(cma.rng);
  strut_arena_free(&cma.arena);
  return fine;
}
