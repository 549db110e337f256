/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points from distributions. See sample.h. */
#include "engine/scene/sample.h"

#include <assert.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_rng.h>
#include <math.h>

#include "engine/base/memory.h"

const char *strut_distribution_flaw(const strut_distribution *distribution) {
  const double *n = distribution->number;
  switch (distribution->kind) {
    case STRUT_DISTRIBUTION_UNIFORM:
      return n[0] < n[1] ? NULL : "expects two ascending numbers, the least and the largest";
    case STRUT_DISTRIBUTION_LOG_UNIFORM:
      return n[0] < n[1] && n[0] * n[1] > 0.0
                 ? NULL
                 : "expects two ascending numbers on one side of 0, the least and the largest";
    case STRUT_DISTRIBUTION_NORMAL:
      return n[1] > 0.0 ? NULL : "expects a mean and a positive standard deviation";
    case STRUT_DISTRIBUTION_LOGNORMAL:
      return n[0] != 0.0 && n[1] > 0.0 ? NULL
                                       : "expects a median that is not 0 and a positive standard "
                                         "deviation of the natural "
                                         "logarithm";
    case STRUT_DISTRIBUTION_TRIANGULAR:
      return n[0] <= n[1] && n[1] <= n[2] && n[0] < n[2]
                 ? NULL
                 : "expects three ascending numbers: the least, the most likely, the largest";
    case STRUT_DISTRIBUTION_COUNT: break;
  }
  return NULL;
}

/* The inverse of the piecewise quadratic distribution function. */
static double triangular(const double n[3], double u) {
  double width = n[2] - n[0], left = n[1] - n[0], right = n[2] - n[1];
  if (u * width < left) return n[0] + sqrt(u * width * left);
  return n[2] - sqrt((1.0 - u) * width * right);
}

double strut_distribution_value(const strut_distribution *distribution, double u) {
  const double *n = distribution->number;
  switch (distribution->kind) {
    case STRUT_DISTRIBUTION_UNIFORM: return n[0] + (n[1] - n[0]) * u;
    case STRUT_DISTRIBUTION_LOG_UNIFORM: return n[0] * pow(n[1] / n[0], u);
    case STRUT_DISTRIBUTION_NORMAL: return n[0] + gsl_cdf_gaussian_Pinv(u, n[1]);
    case STRUT_DISTRIBUTION_LOGNORMAL: return n[0] * exp(gsl_cdf_gaussian_Pinv(u, n[1]));
    case STRUT_DISTRIBUTION_TRIANGULAR: return triangular(n, u);
    case STRUT_DISTRIBUTION_COUNT: break;
  }
  return (double)NAN;
}

/* A seed of its own for each number, so that one that is added changes no other (splitmix64). */
static unsigned long seed_of(uint32_t seed, size_t number) {
  uint64_t z = ((uint64_t)seed << 32 | (uint64_t)number) + 0x9E3779B97F4A7C15u;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
  z = (z ^ z >> 27) * 0x94D049BB133111EBu;
  z ^= z >> 31;
  uint32_t low = (uint32_t)z;
  return low ? low : 1; /* 0 is the generator's own default */
}

/* Uniform in (0, 1), 53 bits. */
static double draw(gsl_rng *rng) {
  double high = (double)(gsl_rng_get(rng) >> 5), low = (double)(gsl_rng_get(rng) >> 6);
  return (high * 67108864.0 + low + 0.5) / 9007199254740992.0;
}

/* Keeps a share within the open interval. */
static double within(double u) {
  static const double least = 0x1p-54, most = 1.0 - 0x1p-53;
  return u < least ? least : u > most ? most : u;
}

/* A random permutation of 0 ... count - 1 as numbers (Fisher and Yates). */
static void shuffle(gsl_rng *rng, double *values, int64_t count) {
  for (int64_t i = 0; i < count; i++) values[i] = (double)i;
  for (int64_t i = count - 1; i > 0; i--) {
    int64_t k = (int64_t)(draw(rng) * (double)(i + 1));
    double other = values[k];
    values[k] = values[i];
    values[i] = other;
  }
}

/* Shares of one number, by strata or at random. */
static void fill_alone(gsl_rng *rng, bool strata, double *values, int64_t count) {
  if (strata) shuffle(rng, values, count);
  for (int64_t i = 0; i < count; i++)
    values[i] = strata ? within((values[i] + draw(rng)) / (double)count) : draw(rng);
}

/* Shares of all numbers by Sobol's sequence. */
static bool fill_sobol(gsl_rng *rng, uint32_t seed, int64_t count, size_t numbers,
                       double *const *values) {
  double shift[STRUT_SAMPLE_MOST_NUMBERS], u[STRUT_SAMPLE_MOST_NUMBERS];
  gsl_qrng *sequence = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)numbers);
  if (!sequence) return false;
  for (size_t k = 0; k < numbers; k++) {
    gsl_rng_set(rng, seed_of(seed, k));
    shift[k] = draw(rng);
  }
  for (int64_t i = 0; i < count; i++) {
    gsl_qrng_get(sequence, u);
    for (size_t k = 0; k < numbers; k++) {
      double shifted = u[k] + shift[k];
      values[k][i] = within(shifted < 1.0 ? shifted : shifted - 1.0);
    }
  }
  gsl_qrng_free(sequence);
  return true;
}

bool strut_correlation_factor(size_t count, double *correlation) {
  gsl_matrix_view matrix = gsl_matrix_view_array(correlation, count, count);
  return gsl_linalg_cholesky_decomp1(&matrix.matrix) == GSL_SUCCESS;
}

/* Makes shares those of correlated normal numbers. */
static void correlate(const double *factor, size_t numbers, int64_t count, double *const *values) {
  double normal[STRUT_SAMPLE_MOST_NUMBERS];
  for (int64_t i = 0; i < count; i++) {
    for (size_t k = 0; k < numbers; k++) normal[k] = gsl_cdf_ugaussian_Pinv(values[k][i]);
    for (size_t k = 0; k < numbers; k++) {
      double sum = 0.0;
      for (size_t j = 0; j <= k; j++) sum += factor[k * numbers + j] * normal[j];
      values[k][i] = within(gsl_cdf_ugaussian_P(sum));
    }
  }
}

bool strut_sample_make(strut_sample_scheme scheme, uint32_t seed, int64_t count,
                       size_t number_count, const strut_distribution *distributions,
                       const double *factor, double *const *values) {
  assert(number_count > 0 && number_count <= STRUT_SAMPLE_MOST_NUMBERS);
  gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
  bool fine = rng != NULL;
  if (fine && scheme == STRUT_SAMPLE_SOBOL)
    fine = fill_sobol(rng, seed, count, number_count, values);
  for (size_t k = 0; k < number_count && fine; k++) {
    if (scheme == STRUT_SAMPLE_SOBOL) break;
    gsl_rng_set(rng, seed_of(seed, k));
    fill_alone(rng, scheme == STRUT_SAMPLE_LHS, values[k], count);
  }
  if (fine && factor) correlate(factor, number_count, count, values);
  for (size_t k = 0; k < number_count && fine; k++)
    for (int64_t i = 0; i < count; i++)
      values[k][i] = strut_distribution_value(&distributions[k], values[k][i]);
  if (rng) gsl_rng_free(rng);
  return fine;
}

/* ---- designs of sensitivity analyses ---- */

int64_t strut_sensitivity_sample(const strut_study_sensitivity *sensitivity, size_t count,
                                 int64_t j) {
  return sensitivity->derivatives + j * ((int64_t)count + 2);
}

int64_t strut_sensitivity_points(const strut_study_sensitivity *sensitivity, size_t count) {
  return strut_sensitivity_sample(sensitivity, count, sensitivity->samples);
}

static void fill_samples(const strut_study_sensitivity *sensitivity, size_t count,
                         double *const *both, double *const *values) {
  for (int64_t j = 0; j < sensitivity->samples; j++) {
    int64_t first = strut_sensitivity_sample(sensitivity, count, j);
    for (size_t k = 0; k < count; k++) {
      for (int64_t p = 0; p <= (int64_t)count; p++) values[k][first + p] = both[k][j];
      values[k][first + 1 + (int64_t)k] = both[count + k][j];
      values[k][first + 1 + (int64_t)count] = both[count + k][j];
    }
  }
}

bool strut_sensitivity_fill(const strut_study_sensitivity *sensitivity, size_t count,
                            const strut_distribution *distributions, double *const *values) {
  strut_distribution twice[2 * STRUT_SENSITIVITY_MOST];
  double *both[2 * STRUT_SENSITIVITY_MOST];
  strut_arena arena = {0};
  bool fine = true;
  assert(count > 0 && count <= STRUT_SENSITIVITY_MOST);
  for (size_t k = 0; k < count && sensitivity->derivatives; k++)
    values[k][0] = strut_distribution_value(&distributions[k], 0.5);
  for (size_t k = 0; k < 2 * count && sensitivity->samples > 0; k++) {
    twice[k] = distributions[k % count];
    both[k] = strut_arena_allocate(&arena, (size_t)sensitivity->samples, sizeof *both[k]);
    fine = fine && both[k];
  }
  if (fine && sensitivity->samples > 0)
    fine = strut_sample_make((strut_sample_scheme)sensitivity->scheme, sensitivity->seed,
                             sensitivity->samples, 2 * count, twice, NULL, both);
  if (fine) fill_samples(sensitivity, count, both, values);
  strut_arena_free(&arena);
  return fine;
}
