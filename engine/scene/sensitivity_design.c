/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/sensitivity_design.h"

#include <assert.h>
#include <math.h>

#include "engine/base/memory.h"

/* Points of a parameter's derivative. */
enum { MOVED = 4 };
/* Accuracy of results whose error is rounding, and most of a step: half a deviation. */
static const double FINEST = 1e-9, WIDEST = 0.5, DEVIATION = 0.8413447460685429;

static int64_t derivative_points(const strut_study_sensitivity *s, size_t count) {
  return s->derivatives ? 1 + MOVED * (int64_t)count : 0;
}

int64_t strut_sensitivity_points(const strut_study_sensitivity *s, size_t count) {
  return derivative_points(s, count) + s->samples * ((int64_t)count + 2);
}

int64_t strut_sensitivity_sample(const strut_study_sensitivity *s, size_t count, int64_t j) {
  return derivative_points(s, count) + j * ((int64_t)count + 2);
}

int64_t strut_sensitivity_moved(size_t i, int k) { return 1 + MOVED * (int64_t)i + k; }

static void fill_derivatives(const strut_study_sensitivity *s, size_t count,
                             const strut_distribution *d, double *const *values) {
  static const double steps[MOVED] = {1.0, -1.0, 0.5, -0.5};
  double part = fmin(WIDEST, cbrt(fmax(s->accuracy, FINEST)));
  for (size_t k = 0; k < count; k++) {
    double middle = strut_distribution_value(&d[k], 0.5);
    double step = part * (strut_distribution_value(&d[k], DEVIATION) - middle);
    for (int64_t p = 0; p < derivative_points(s, count); p++) values[k][p] = middle;
    for (int m = 0; m < MOVED; m++)
      values[k][strut_sensitivity_moved(k, m)] = middle + steps[m] * step;
  }
}

static void fill_samples(const strut_study_sensitivity *s, size_t count, double *const *both,
                         double *const *values) {
  for (int64_t j = 0; j < s->samples; j++) {
    int64_t first = strut_sensitivity_sample(s, count, j);
    for (size_t k = 0; k < count; k++) {
      for (int64_t p = 0; p <= (int64_t)count; p++) values[k][first + p] = both[k][j];
      values[k][first + 1 + (int64_t)k] = both[count + k][j];
      values[k][first + 1 + (int64_t)count] = both[count + k][j];
    }
  }
}

bool strut_sensitivity_fill(const strut_study_sensitivity *s, size_t count,
                            const strut_distribution *distributions, double *const *values) {
  strut_distribution twice[2 * STRUT_SENSITIVITY_MOST];
  double *both[2 * STRUT_SENSITIVITY_MOST];
  strut_arena arena = {0};
  bool fine = true;
  assert(count > 0 && count <= STRUT_SENSITIVITY_MOST);
  if (s->derivatives) fill_derivatives(s, count, distributions, values);
  for (size_t k = 0; k < 2 * count && s->samples > 0; k++) {
    twice[k] = distributions[k % count];
    both[k] = strut_arena_allocate(&arena, (size_t)s->samples, sizeof *both[k]);
    fine = fine && both[k];
  }
  if (fine && s->samples > 0)
    fine = strut_sample_make((strut_sample_scheme)s->scheme, s->seed, s->samples, 2 * count, twice,
                             both);
  if (fine) fill_samples(s, count, both, values);
  strut_arena_free(&arena);
  return fine;
}
