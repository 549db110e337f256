/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which of the matches and of the places in them would determine the parameters best, from the model alone. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/study/fit/fit_parts.h"

/* Derivatives of everything, of which candidates take their part. */
typedef struct planning {
  const strut_fit_layout *layout;
  strut_fit_plan *plan;
  double *jacobian; /* (count, parameters); rows of gaps are 0 */
  double *part;     /* (count, parameters) of a candidate, the other rows 0 */
} planning;

/* Values the numbers of two series, or all of a match, or all (NULL): with those alignments that they depend on. */
static bool add_candidate(planning *self, const char *name, const strut_fit_match *match,
                          const strut_fit_series *one, const strut_fit_series *other) {
  const strut_fit_layout *layout = self->layout;
  strut_fit_plan *plan = self->plan;
  size_t n = layout->parameters, first = layout->aligned_count, kept = n - first;
  strut_fit_spectrum spectrum;
  strut_fit_candidate *candidate = &plan->candidates[plan->count++];
  *candidate = (strut_fit_candidate){.name = name, .determinant = -HUGE_VAL};
  candidate->errors = strut_arena_allocate(&plan->arena, plan->variable_count, sizeof(double));
  if (!candidate->errors || !name) return false;
  memset(self->part, 0, layout->count * n * sizeof *self->part);
  for (size_t k = 0; k < layout->count; k++) {
    const strut_fit_number *number = &layout->numbers[k];
    if (one ? number->series != one && number->series != other : match && number->match != match)
      continue;
    memcpy(self->part + k * n, self->jacobian + k * n, n * sizeof *self->part);
    if (!isnan(number->measured)) candidate->numbers++;
  }
  for (size_t i = 0; i < first; i++) {
    bool moves = false;
    for (size_t k = 0; k < layout->count; k++) moves = moves || self->part[k * n + i] != 0.0;
    kept += moves;
  }
  if (!strut_fit_spectrum_find(self->part, layout->count, n, &plan->arena, &spectrum)) return false;
  bool enough = candidate->numbers >= kept;
  for (size_t k = first; k < n; k++)
    candidate->errors[k - first] = enough ? sqrt(spectrum.covariance[k * n + k]) *
                                                fabs(strut_fit_slope(layout, k, plan->at[k]))
                                          : HUGE_VAL;
  if (!enough) return true;
  candidate->least = spectrum.singular[kept - 1];
  candidate->determinant = 0.0;
  for (size_t i = 0; i < kept; i++) candidate->determinant += 2.0 * log10(spectrum.singular[i]);
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
    fine = add_candidate(
        self, strut_arena_format(&self->plan->arena, "%s: %.*s", match->name, length, of), match,
        &match->series[s], partner < 0 ? NULL : &match->series[partner]);
  }
  return fine &&
         (self->plan->count - before < 2 || add_candidate(self, match->name, match, NULL, NULL));
}

/* The most certain first. */
static int by_worth(const void *a, const void *b) {
  const strut_fit_candidate *first = a, *second = b;
  if (first->determinant != second->determinant)
    return first->determinant > second->determinant ? -1 : 1;
  return strcmp(first->name, second->name);
}

/* The derivatives at the first place in the ranges where the model can be computed. */
static strut_status differentiate(const planning *self, strut_fit_case *one, strut_error *error) {
  strut_least_squares problem = strut_fit_problem(one);
  for (int k = 0; k < STRUT_FIT_MOST_PLACES && !one->status; k++) {
    strut_fit_choose_start(one->layout, k, self->plan->at);
    if (strut_least_squares_jacobian(&problem, self->plan->at, self->part, self->jacobian))
      return STRUT_OK;
  }
  return one->status ? strut_fail(error, one->status, "%s", one->error.message)
                     : strut_fail(error, STRUT_DIVERGED,
                                  "the model cannot be computed at any of %d places in the ranges",
                                  STRUT_FIT_MOST_PLACES);
}

strut_status strut_fit_plan_find(const strut_sweep_plan *of, const strut_flag *interrupt,
                                 strut_fit_plan *plan, strut_error *error) {
  const strut_study_fit *fit = of->study->fit;
  strut_fit_layout layout = {0};
  strut_fit_case one = {0};
  planning self = {.layout = &layout, .plan = plan};
  *plan = (strut_fit_plan){.fit = fit, .variable_count = fit->variable_count};
  strut_status status = strut_fit_layout_make(of, interrupt, &layout, error);
  size_t n = layout.parameters, most = 1 + fit->match_count;
  for (size_t m = 0; m < fit->match_count; m++) most += fit->matches[m].series_count;
  bool fine =
      !status && STRUT_NUMBERS(&layout.arena, layout.count * n, &self.jacobian, &self.part) &&
      STRUT_ALLOCATE(&plan->arena, STRUT_NEW(plan->candidates, most), STRUT_NEW(plan->at, n)) &&
      strut_fit_case_create(&layout, &one);
  if (fine) status = differentiate(&self, &one, error);
  for (size_t m = 0; m < fit->match_count && !status && fine; m++) fine = add_match(&self, m);
  if (!status && fine && fit->match_count > 1) fine = add_candidate(&self, "all", NULL, NULL, NULL);
  if (!status && !fine) status = strut_no_memory(error, "");
  if (!status) qsort(plan->candidates, plan->count, sizeof *plan->candidates, by_worth);
  strut_arena_free(&one.arena);
  strut_fit_layout_free(&layout);
  return status;
}
