/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which of the matches and of the places in them would determine the parameters best, from the model alone. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/study/fit/fit_parts.h"
#include "engine/study/search/optimisers.h"

/* Derivatives of everything, of which candidates take their part. */
typedef struct planning {
  const strut_fit_layout *layout;
  strut_fit_plan *plan;
  const double *jacobian; /* (count, parameters); rows of gaps are 0 */
  double *part;           /* (count, parameters) of a candidate */
  size_t rows, numbers;   /* of it */
} planning;

/* Adds a series to the candidate. */
static void take_series(planning *self, size_t m, size_t s) {
  const strut_fit_match *match = &self->layout->fit->matches[m];
  size_t n = self->layout->parameters;
  memcpy(self->part + self->rows * n, self->jacobian + match->series[s].first * n,
         match->count * n * sizeof(double));
  self->rows += match->count;
  for (size_t i = 0; i < match->count; i++)
    if (!isnan(match->series[s].measured[i])) self->numbers++;
}

static void take_match(planning *self, size_t m) {
  for (size_t s = 0; s < self->layout->fit->matches[m].series_count; s++) take_series(self, m, s);
}

/* Values the candidate, which is empty then: of all alignments those that it moves. */
static bool add_candidate(planning *self, const char *name) {
  const strut_fit_layout *layout = self->layout;
  strut_fit_plan *plan = self->plan;
  size_t n = layout->parameters, first = layout->aligned_count, rows = self->rows, kept = 0,
         of[STRUT_LEAST_SQUARES_MOST];
  strut_fit_spectrum spectrum;
  for (size_t i = 0; i < n; i++) {
    bool moves = i >= first;
    for (size_t k = 0; k < rows && !moves; k++) moves = self->part[k * n + i] != 0.0;
    if (moves) of[kept++] = i;
  }
  strut_fit_candidate *candidate = &plan->candidates[plan->count];
  *candidate = (strut_fit_candidate){name, self->numbers, -HUGE_VAL, 0.0, NULL};
  candidate->errors = strut_arena_allocate(&plan->arena, plan->variable_count, sizeof(double));
  if (!candidate->errors || !name) return false;
  plan->count++;
  self->rows = self->numbers = 0;
  for (size_t k = 0; k < plan->variable_count; k++) candidate->errors[k] = HUGE_VAL;
  if (candidate->numbers < kept) return true;
  for (size_t k = 0; k < rows; k++)
    for (size_t i = 0; i < kept; i++) self->part[k * kept + i] = self->part[k * n + of[i]];
  if (!strut_fit_spectrum_find(self->part, rows, kept, &plan->arena, &spectrum)) return false;
  candidate->least = spectrum.singular[kept - 1];
  candidate->determinant = 0.0;
  for (size_t i = 0; i < kept; i++) candidate->determinant += 2.0 * log10(spectrum.singular[i]);
  for (size_t k = 0; k < plan->variable_count; k++) {
    size_t i = kept - plan->variable_count + k;
    candidate->errors[k] = sqrt(spectrum.covariance[i * kept + i]) *
                           fabs(strut_fit_slope(layout, first + k, plan->at[first + k]));
  }
  return true;
}

/* Candidates of a match: places, "n1" of "n1.x" and "n1.y", and the whole. */
static bool add_match(planning *self, size_t m) {
  const strut_fit_match *match = &self->layout->fit->matches[m];
  size_t before = self->plan->count;
  bool fine = true;
  for (size_t s = 0; s < match->series_count && fine; s++) {
    int32_t partner = self->layout->parts[m].sources[s].partner;
    const char *of = match->series[s].of, *dot = strrchr(of, '.');
    int length = (int)(partner >= 0 && dot ? dot - of : (int64_t)strlen(of));
    if (partner >= 0 && partner < (int32_t)s) continue;
    take_series(self, m, s);
    if (partner >= 0) take_series(self, m, (size_t)partner);
    fine = add_candidate(
        self, strut_arena_format(&self->plan->arena, "%s: %.*s", match->name, length, of));
  }
  if (self->plan->count - before < 2) return fine;
  take_match(self, m);
  return fine && add_candidate(self, match->name);
}

static bool add_all(planning *self) {
  size_t matches = self->layout->fit->match_count;
  bool fine = true;
  for (size_t m = 0; m < matches && fine; m++) fine = add_match(self, m);
  for (size_t m = 0; m < matches; m++) take_match(self, m);
  return fine && (matches == 1 || add_candidate(self, "all"));
}

/* The most certain first. */
static int by_worth(const void *a, const void *b) {
  const strut_fit_candidate *first = a, *second = b;
  if (first->determinant != second->determinant)
    return first->determinant > second->determinant ? -1 : 1;
  return strcmp(first->name, second->name);
}

/* The derivatives at the first place in the ranges where the model can be computed. */
static strut_status differentiate(const strut_fit_plan *plan, strut_fit_case *one, double *residual,
                                  double *jacobian, strut_error *error) {
  strut_least_squares problem = strut_fit_problem(one);
  for (int k = 0; k < STRUT_FIT_MOST_PLACES && !one->status; k++) {
    strut_fit_choose_start(one->layout, k, plan->at);
    if (strut_least_squares_jacobian(&problem, plan->at, residual, jacobian)) return STRUT_OK;
  }
  return one->status ? strut_fail(error, one->status, "%s", one->error.message)
                     : strut_fail(error, STRUT_DIVERGED,
                                  "the model cannot be computed at any of %d places in the ranges",
                                  STRUT_FIT_MOST_PLACES);
}

strut_status strut_fit_plan_find(const strut_sweep_plan *of, const strut_flag *interrupt,
                                 strut_fit_plan *plan, strut_error *error) {
  strut_fit_layout layout = {0};
  strut_fit_case one = {0};
  planning self = {.layout = &layout, .plan = plan};
  double *jacobian, *residual;
  *plan = (strut_fit_plan){.fit = of->study->fit, .variable_count = of->study->fit->variable_count};
  strut_status status = strut_fit_layout_make(of, interrupt, &layout, error);
  size_t n = layout.parameters, most = 2;
  for (size_t m = 0; m < plan->fit->match_count; m++)
    most += 1 + plan->fit->matches[m].series_count;
  if (!status &&
      !(STRUT_ALLOCATE(&layout.arena, STRUT_NEW(jacobian, layout.count * n),
                       STRUT_NEW(residual, layout.count), STRUT_NEW(self.part, layout.count * n)) &&
        STRUT_ALLOCATE(&plan->arena, STRUT_NEW(plan->candidates, most), STRUT_NEW(plan->at, n)) &&
        strut_fit_case_create(&layout, &one)))
    status = strut_no_memory(error, "");
  if (!status) status = differentiate(plan, &one, residual, jacobian, error);
  if (!status) self.jacobian = jacobian;
  if (!status && !add_all(&self)) status = strut_no_memory(error, "");
  if (!status) qsort(plan->candidates, plan->count, sizeof *plan->candidates, by_worth);
  strut_arena_free(&one.arena);
  strut_fit_layout_free(&layout);
  return status;
}
