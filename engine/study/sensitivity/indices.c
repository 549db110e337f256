/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sensitivity/indices.h"

#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"

enum { BOOTSTRAPS = 500 };
static const double NORMAL_95 = 1.959963984540054;
static const strut_estimate MISSING = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};

/* One base sample after the other, without missing ones, and less their mean. */
typedef struct samples {
  size_t used, count;
  double *result; /* (used, count + 2) */
} samples;

static bool is_whole(const double *row, size_t width) {
  for (size_t k = 0; k < width; k++)
    if (!isfinite(row[k])) return false;
  return true;
}

static bool take_whole(const double *result, size_t all, size_t count, strut_arena *arena,
                       samples *s) {
  size_t width = count + 2;
  double sum = 0.0;
  *s = (samples){.count = count};
  s->result = strut_arena_allocate(arena, all * width + 1, sizeof *s->result);
  if (!s->result) return false;
  for (size_t j = 0; j < all; j++) {
    const double *row = result + j * width;
    if (!is_whole(row, width)) continue;
    memcpy(s->result + s->used++ * width, row, width * sizeof *row);
    sum += row[0] + row[width - 1];
  }
  double mean = s->used ? sum / (2.0 * (double)s->used) : 0.0;
  for (size_t i = 0; i < s->used * width; i++) s->result[i] -= mean;
  return true;
}

/* Indices of the base samples that `pick` (used) lists; index (2, count). False: no variance. */
static bool estimate_indices(const samples *s, const size_t *pick, double *index) {
  size_t width = s->count + 2, n = s->used;
  double sum = 0.0, square = 0.0;
  memset(index, 0, 2 * s->count * sizeof *index);
  for (size_t j = 0; j < n; j++) {
    const double *row = s->result + pick[j] * width;
    double a = row[0], b = row[width - 1];
    sum += a + b;
    square += a * a + b * b;
    for (size_t k = 0; k < s->count; k++) {
      double mixed = row[1 + k];
      index[k] += b * (mixed - a);
      index[s->count + k] += 0.5 * (a - mixed) * (a - mixed);
    }
  }
  double mean = sum / (2.0 * (double)n), variance = square / (2.0 * (double)n) - mean * mean;
  for (size_t k = 0; k < 2 * s->count; k++) index[k] /= (double)n * variance;
  return variance > 1e-12 * square / (2.0 * (double)n) && variance > 0.0;
}

static int ascending(const void *a, const void *b) {
  double d = *(const double *)a - *(const double *)b;
  return (d > 0) - (d < 0);
}

static strut_estimate describe(double value, double *drawn, size_t count) {
  double sum = 0.0, square = 0.0;
  if (count < BOOTSTRAPS / 2) return (strut_estimate){value, (double)NAN, (double)NAN, (double)NAN};
  for (size_t i = 0; i < count; i++) sum += drawn[i];
  double mean = sum / (double)count;
  for (size_t i = 0; i < count; i++) square += (drawn[i] - mean) * (drawn[i] - mean);
  qsort(drawn, count, sizeof *drawn, ascending);
  return (strut_estimate){value, sqrt(square / (double)(count - 1)),
                          drawn[(size_t)(0.025 * (double)(count - 1))],
                          drawn[(size_t)(0.975 * (double)(count - 1))]};
}

/* Estimates again from base samples drawn with replacement; drawn (2 count, BOOTSTRAPS). */
static size_t bootstrap(const samples *s, uint32_t seed, size_t *pick, double *index,
                        double *drawn) {
  gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
  size_t count = 0;
  if (!rng) return 0;
  gsl_rng_set(rng, seed ? seed : 1);
  for (int b = 0; b < BOOTSTRAPS; b++) {
    for (size_t j = 0; j < s->used; j++)
      pick[j] = (size_t)gsl_rng_uniform_int(rng, (unsigned long)s->used);
    if (!estimate_indices(s, pick, index)) continue;
    for (size_t k = 0; k < 2 * s->count; k++) drawn[k * BOOTSTRAPS + count] = index[k];
    count++;
  }
  gsl_rng_free(rng);
  return count;
}

strut_status strut_sensitivity_indices(const double *result, size_t all, size_t count,
                                       uint32_t seed, strut_estimate *first, strut_estimate *total,
                                       size_t *used) {
  strut_arena arena = {0};
  samples s;
  double *value = strut_arena_allocate(&arena, 2 * count, sizeof *value);
  double *index = strut_arena_allocate(&arena, 2 * count, sizeof *index);
  double *drawn = strut_arena_allocate(&arena, 2 * count * BOOTSTRAPS, sizeof *drawn);
  size_t *pick = strut_arena_allocate(&arena, all + 1, sizeof *pick);
  bool ready = value && index && drawn && pick && take_whole(result, all, count, &arena, &s);
  for (size_t k = 0; k < count; k++) first[k] = total[k] = MISSING;
  *used = ready ? s.used : 0;
  for (size_t j = 0; j < *used; j++) pick[j] = j;
  if (*used > 1 && estimate_indices(&s, pick, value)) {
    size_t drawings = bootstrap(&s, seed, pick, index, drawn);
    for (size_t k = 0; k < count; k++) {
      first[k] = describe(value[k], drawn + k * BOOTSTRAPS, drawings);
      total[k] = describe(value[count + k], drawn + (count + k) * BOOTSTRAPS, drawings);
    }
  }
  strut_arena_free(&arena);
  return ready ? STRUT_OK : STRUT_NO_MEMORY;
}

strut_estimate strut_sensitivity_mean(const double *values, size_t count) {
  double sum = 0.0, deviation = strut_sensitivity_deviation(values, count);
  size_t known = 0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) sum += values[i], known++;
  if (!known) return MISSING;
  double mean = sum / (double)known, error = deviation / sqrt((double)known);
  return (strut_estimate){mean, error, mean - NORMAL_95 * error, mean + NORMAL_95 * error};
}

double strut_sensitivity_deviation(const double *values, size_t count) {
  double sum = 0.0, square = 0.0;
  size_t known = 0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) sum += values[i], known++;
  if (known < 2) return (double)NAN;
  double mean = sum / (double)known;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) square += (values[i] - mean) * (values[i] - mean);
  return sqrt(square / (double)(known - 1));
}

strut_estimate strut_sensitivity_share(const double *values, size_t count) {
  double n = 0.0, ones = 0.0, z = NORMAL_95;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) n += 1.0, ones += values[i] != 0.0;
  if (n == 0.0) return MISSING;
  double p = ones / n, scale = 1.0 + z * z / n, middle = (p + z * z / (2.0 * n)) / scale;
  double half = z * sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n)) / scale;
  return (strut_estimate){p, sqrt(p * (1.0 - p) / n), fmax(0.0, middle - half),
                          fmin(1.0, middle + half)};
}

strut_estimate strut_sensitivity_derivative(const double result[4], double width, double half_width,
                                            double noise) {
  double whole = (result[0] - result[1]) / width, half = (result[2] - result[3]) / half_width;
  double error = fmax(fabs(whole - half), sqrt(2.0) * noise / fabs(half_width));
  if (!isfinite(half)) return MISSING;
  if (!isfinite(error)) return (strut_estimate){half, (double)NAN, (double)NAN, (double)NAN};
  return (strut_estimate){half, error, half - error, half + error};
}
