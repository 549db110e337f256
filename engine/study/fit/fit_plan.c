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
  const double *jacobian; /* (count, parameters) */
  double *part;           /* (count, parameters) */
} planning;

/* Puts the rows of a series into the part; returns how many. */
static size_t take_series(const planning *self, size_t m, size_t s, size_t used) {
  const strut_fit_match *match = &self->layout->fit->matches[m];
  size_t n = self->layout->parameters, first = self->layout->parts[m].sources[s].first;
  for (size_t i = 0; i < match->count; i++) {
    if (isnan(match->series[s].measured[i])) continue;
    memcpy(self->part + used * n, self->jacobian + (first + i) * n, n * sizeof(double));
    used++;
  }
  return used;
}

/* Values a candidate by the rows in the part: of all alignments those that it moves. */
static bool add_candidate(planning *self, const char *name, size_t used) {
  const strut_fit_layout *layout = self->layout;
  strut_fit_plan *plan = self->plan;
  size_t n = layout->parameters, first = layout->aligned_count, kept = 0,
         of[STRUT_LEAST_SQUARES_MOST];
  strut_fit_spectrum spectrum;
  for (size_t i = 0; i < n; i++) {
    bool moves = i >= first;
    for (size_t k = 0; k < used && !moves; k++) moves = self->part[k * n + i] != 0.0;
    if (moves) of[kept++] = i;
  }
  strut_fit_candidate *candidate = &plan->candidates[plan->count];
  *candidate = (strut_fit_candidate){.name = name, .numbers = used, .determinant = -HUGE_VAL};
  candidate->errors = strut_arena_allocate(&plan->arena, plan->variable_count, sizeof(double));
  if (!candidate->errors || !name) return false;
  plan->count++;
  for (size_t k = 0; k < plan->variable_count; k++) candidate->errors[k] = HUGE_VAL;
  if (used < kept) return true;
  for (size_t k = 0; k < used; k++)
    for (size_t i = 0; i < kept; i++) self->part[k * kept + i] = self->part[k * n + of[i]];
  if (!strut_fit_spectrum_find(self->part, used, kept, &plan->arena, &spectrum)) return false;
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

/* "n1" of "n1.x": the place of a series whose coordinates are taken together. */
static const char *name_place(planning *self, size_t m, size_t s) {
  const strut_fit_match *match = &self->layout->fit->matches[m];
  const char *of = match->series[s].of, *dot = strrchr(of, '.');
  bool whole = self->layout->parts[m].sources[s].partner < 0 || !dot;
  return strut_arena_format(&self->plan->arena, "%s: %.*s", match->name,
                            whole ? (int)strlen(of) : (int)(dot - of), of);
}

static bool add_all(planning *self) {
  const strut_study_fit *fit = self->layout->fit;
  size_t all = 0;
  bool fine = true;
  for (size_t m = 0; m < fit->match_count && fine; m++) {
    size_t used = 0, parts = 0;
    for (size_t s = 0; s < fit->matches[m].series_count && fine; s++) {
      int32_t partner = self->layout->parts[m].sources[s].partner;
      if (partner >= 0 && partner < (int32_t)s) continue;
      size_t own = take_series(self, m, s, 0);
      if (partner >= 0) own = take_series(self, m, (size_t)partner, own);
      fine = add_candidate(self, name_place(self, m, s), own);
      parts++;
    }
    for (size_t s = 0; s < fit->matches[m].series_count; s++) used = take_series(self, m, s, used);
    if (parts > 1) fine = fine && add_candidate(self, fit->matches[m].name, used);
  }
  for (size_t m = 0; m < fit->match_count; m++)
    for (size_t s = 0; s < fit->matches[m].series_count; s++) all = take_series(self, m, s, all);
  return fine && (fit->match_count == 1 || add_candidate(self, "all", all));
}

/* The most certain first. */
static int by_worth(const void *a, const void *b) {
  const strut_fit_candidate *first = a, *second = b;
  if (first->determinant != second->determinant)
    return first->determinant > second->determinant ? -1 : 1;
  return strcmp(first->name, second->name);
}

strut_status strut_fit_plan_find(const strut_sweep_plan *of, const strut_flag *interrupt,
                                 strut_fit_plan *plan, strut_error *error) {
  strut_fit_layout layout = {0};
  strut_fit_case one = {0};
  strut_arena *arena = &layout.arena;
  *plan = (strut_fit_plan){.fit = of->study->fit, .variable_count = of->study->fit->variable_count};
  strut_status status = strut_fit_layout_make(of, interrupt, &layout, error);
  size_t n = layout.parameters, most = 2;
  for (size_t m = 0; m < plan->fit->match_count; m++)
    most += 1 + plan->fit->matches[m].series_count;
  double *jacobian = strut_arena_allocate(arena, layout.count * n + 1, sizeof *jacobian);
  double *residual = strut_arena_allocate(arena, layout.count + 1, sizeof *residual);
  planning self = {&layout, plan, jacobian,
                   strut_arena_allocate(arena, layout.count * n + 1, sizeof(double))};
  plan->candidates = strut_arena_allocate(&plan->arena, most, sizeof *plan->candidates);
  plan->at = strut_arena_allocate(&plan->arena, n + 1, sizeof *plan->at);
  bool fine = jacobian && residual && self.part && plan->candidates && plan->at &&
              (status || strut_fit_case_create(&layout, &one));
  if (!status && !fine) status = strut_no_memory(error, "");
  if (!status) {
    strut_least_squares problem = strut_fit_problem(&one);
    fine = false;
    for (int k = 0; k < STRUT_FIT_MOST_PLACES && !fine && !one.status; k++) {
      strut_fit_choose_start(&layout, k, plan->at);
      fine = strut_least_squares_jacobian(&problem, plan->at, residual, jacobian);
    }
    if (!fine && one.status)
      status = strut_fail(error, one.status, "%s", one.error.message);
    else if (!fine)
      status = strut_fail(error, STRUT_DIVERGED,
                          "the model cannot be computed at any of %d places in the ranges",
                          STRUT_FIT_MOST_PLACES);
    else if (!add_all(&self))
      status = strut_no_memory(error, "");
  }
  if (!status) qsort(plan->candidates, plan->count, sizeof *plan->candidates, by_worth);
  strut_fit_case_free(&one);
  strut_fit_layout_free(&layout);
  return status;
}
