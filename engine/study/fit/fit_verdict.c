/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the residuals and the derivatives at the best fit say of it, and the verdicts. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/fit/fit_parts.h"

/* A sum of squares that a right model exceeds this rarely is not explained. */
static const double RARE = 1e-4;

/* Nor are successive residuals that are correlated by so many standard errors. */
static const double CORRELATED = 5.0;

/* Starts agree whose sums differ by this part of what an end of an interval takes. */
static const double SAME = 0.05;

/* Another fit that is as good, but so many half intervals away, is another answer. */
static const double AWAY = 2.0;

/* Along a direction with this standard deviation, in parts of ranges, nothing is determined. */
static const double WIDE = 0.25;

/*
 * A parameter takes part in a direction from this part on, if a move along it over the ranges changes the parameter by
 * this many of the errors that it would have without the direction.
 */
static const double PART = 0.02, ERRORS = 2.0;

/* A power this near to 1 is 1. */
static const double WHOLE = 0.02;

bool strut_fit_is_unexplained(double sum, double freedom) {
  return gsl_cdf_chisq_Q(sum, fmax(freedom, 1.0)) < RARE;
}

/* ---- residuals ---- */

/* Correlation of successive residuals of a series, in its standard errors; NAN: too few. */
static double find_lag(const double *residual, size_t count) {
  double sum = 0.0, square = 0.0, last = 0.0;
  size_t used = 0;
  for (size_t i = 0; i < count; i++) {
    if (residual[i] == 0.0) continue; /* a gap */
    sum += last * residual[i];
    square += residual[i] * residual[i];
    last = residual[i];
    used++;
  }
  return used > 10 ? sum / square * sqrt((double)used) : (double)NAN;
}

static void describe_residuals(const strut_fit_layout *layout, size_t m, strut_fit_result *result) {
  const strut_fit_match *match = &layout->fit->matches[m];
  strut_fit_residuals *of = &result->residuals[m];
  double square = 0.0, lags = 0.0, series = 0.0;
  *of = (strut_fit_residuals){.match = match, .lag = (double)NAN};
  for (size_t s = 0; s < match->series_count; s++) {
    const double *residual = result->residual + layout->parts[m].sources[s].first;
    double lag = match->kind == STRUT_FIT_MOTION ? find_lag(residual, match->count) : (double)NAN;
    if (!isnan(lag)) lags += lag, series += 1.0;
    for (size_t i = 0; i < match->count; i++) {
      square += residual[i] * residual[i];
      of->used += residual[i] != 0.0;
    }
  }
  if (series > 0.0) of->lag = lags / sqrt(series);
  of->rms = layout->parts[m].noise * sqrt(square / fmax(1.0, (double)of->used));
  of->chi_square = layout->noise_known ? square : (double)NAN;
}

/* Why the model does not explain the data; "" if it does, or NULL: memory is out. */
static const char *find_flaw(strut_fit_result *result) {
  const char *flaw = "";
  if (!isnan(result->probability) && strut_fit_is_unexplained(result->chi_square, result->freedom))
    flaw = strut_arena_format(&result->arena,
                              "the residuals are %.3g times the noise: chi square %.4g with %.0f "
                              "degrees of freedom",
                              sqrt(result->chi_square / result->freedom), result->chi_square,
                              result->freedom);
  for (size_t m = 0; m < result->fit->match_count && flaw && !*flaw; m++)
    if (fabs(result->residuals[m].lag) > CORRELATED && result->scale > STRUT_FIT_EXACT)
      flaw = strut_arena_format(&result->arena,
                                "successive residuals of '%.40s' are correlated, by %.3g standard "
                                "errors",
                                result->residuals[m].match->name, result->residuals[m].lag);
  return flaw;
}

/* ---- directions ---- */

/* Does parameter i take part in direction k, of which the fitted ones have the part `size`? */
static bool takes_part(const strut_fit_spectrum *spectrum, double scale, size_t k, size_t i,
                       double size) {
  size_t n = spectrum->parameters;
  double part = fabs(spectrum->direction[k * n + i]) / size, rest = 0.0;
  for (size_t other = 0; other < n; other++) {
    double error = fmin(1.0, scale / spectrum->singular[other]);
    if (other != k) rest = hypot(rest, spectrum->direction[other * n + i] * error);
  }
  return part > PART && part > ERRORS * rest;
}

/* What of two parameters is determined where a direction is not: "k/m", "k*m", or "a + 0.98 b" over the ranges. */
static const char *name_determined(strut_arena *arena, const strut_search_variable *first,
                                   const strut_search_variable *second, double other) {
  if (!first->logarithmic || !second->logarithmic)
    return strut_arena_format(arena, "%.40s %c %.3g %.40s", first->name, other < 0.0 ? '-' : '+',
                              fabs(other), second->name);
  double power = other * log(first->to / first->from) / log(second->to / second->from);
  char text[40] = "";
  if (fabs(fabs(power) - 1.0) > WHOLE) snprintf(text, sizeof text, "^%.3g", fabs(power));
  return strut_arena_format(arena, "%.40s%c%.40s%s", first->name, power < 0.0 ? '/' : '*',
                            second->name, text);
}

/* "friction and damping together", and what of two is determined. False: memory is out. */
static bool describe_direction(strut_fit_result *result, const bool *takes,
                               strut_fit_direction *direction) {
  char text[300] = "";
  size_t used = 0, taken = 0, pair[2] = {0, 0};
  const strut_search_variable *variables = result->fit->variables;
  for (size_t k = 0; k < result->variable_count; k++) {
    if (!takes[k]) continue;
    if (taken < 2) pair[taken] = k;
    taken++;
    if (used < sizeof text - 60)
      used += (size_t)snprintf(text + used, sizeof text - used, "%s%.40s", used ? " and " : "",
                               variables[k].name);
  }
  if (taken > 1) snprintf(text + used, sizeof text - used, " together");
  direction->words = strut_arena_text(&result->arena, text, strlen(text));
  if (taken != 2) return direction->words != NULL;
  direction->determined = name_determined(&result->arena, &variables[pair[0]], &variables[pair[1]],
                                          -direction->part[pair[0]] / direction->part[pair[1]]);
  return direction->words && direction->determined;
}

/* Directions in which the numbers determine nothing, and who takes part in them. */
static bool find_directions(const strut_fit_layout *layout, const strut_fit_spectrum *spectrum,
                            strut_fit_result *result) {
  size_t n = spectrum->parameters, first = layout->aligned_count;
  bool takes[STRUT_LEAST_SQUARES_MOST];
  result->directions = strut_arena_allocate(&result->arena, n, sizeof *result->directions);
  for (size_t k = 0; result->directions && k < n; k++) {
    double error = spectrum->singular[k] > 0.0 ? result->scale / spectrum->singular[k] : HUGE_VAL;
    double *part = strut_arena_allocate(&result->arena, n, sizeof *part), size = 0.0;
    if (!part) return false;
    for (size_t i = first; i < n; i++) size = hypot(size, spectrum->direction[k * n + i]);
    if (!(error * size > WIDE) || !(size > PART)) continue;
    for (size_t i = first; i < n; i++) {
      part[i - first] = spectrum->direction[k * n + i] / size;
      takes[i - first] = takes_part(spectrum, result->scale, k, i, size);
      if (takes[i - first]) result->estimates[i].verdict = STRUT_FIT_UNDETERMINED;
    }
    strut_fit_direction *direction = &result->directions[result->direction_count++];
    *direction = (strut_fit_direction){.error = error, .part = part};
    if (!describe_direction(result, takes, direction)) return false;
  }
  return result->directions != NULL;
}

/* ---- starts ---- */

/* Is a fit that is as good as the best one another answer? Where that is not determined it may be anywhere. */
static bool is_another(const strut_fit_layout *layout, const strut_fit_result *result,
                       const strut_fit_row *row, const double *best) {
  for (size_t i = layout->aligned_count; i < layout->parameters; i++) {
    const strut_fit_estimate *estimate = &result->estimates[i];
    double half = 0.5 * (estimate->high - estimate->low);
    if (estimate->verdict == STRUT_FIT_IDENTIFIED &&
        fabs(strut_fit_value(layout, i, row->parameters[i]) - strut_fit_value(layout, i, best[i])) >
            AWAY * half)
      return true;
  }
  return false;
}

/* Why starts disagree; "": they agree. `rise`: of the sum at an end of an interval. */
static const char *compare_starts(const strut_fit_layout *layout, const double *best, double rise,
                                  strut_fit_result *result) {
  double least = result->starts[result->best].sum;
  bool better = false;
  const char *why = "";
  for (size_t i = 0; i < result->start_count + result->elsewhere_count; i++) {
    bool start = i < result->start_count;
    strut_fit_row *row = start ? &result->starts[i] : &result->elsewhere[i - result->start_count];
    if (row->sum < least - SAME * rise) better = true;
    if (row->end == STRUT_FIT_FAILED || !(row->sum <= least + rise)) continue;
    bool another = is_another(layout, result, row, best);
    row->agrees = !another && row->sum <= least + SAME * rise;
    result->agreeing += start && row->agrees;
    if (another) why = "a fit with residuals as small ends elsewhere";
  }
  for (size_t i = 0; i < 2 * result->variable_count; i++)
    better = better || result->ends[i].sum < least - SAME * rise;
  if (better)
    why = "beside the best fit there is a better one, which no start has found: give more starts";
  if (!*why && !layout->noise_known && result->start_count > 1 && result->agreeing < 2)
    why =
        "only one start ends at the best fit, and without the noise nothing says that it is right";
  return why;
}

/* ---- verdicts ---- */

static strut_fit_verdict first_verdict(const strut_fit_estimate *estimate) {
  bool open = estimate->open_low || estimate->open_high || !isfinite(estimate->error);
  return estimate->at_bound ? STRUT_FIT_BOUND
         : open             ? STRUT_FIT_UNDETERMINED
                            : STRUT_FIT_IDENTIFIED;
}

/* What is not known is not given. */
static void withdraw(strut_fit_estimate *estimate) {
  bool none = estimate->verdict == STRUT_FIT_UNEXPLAINED ||
              estimate->verdict == STRUT_FIT_DISAGREE || !isfinite(estimate->error);
  if (none || estimate->open_low) estimate->low = (double)NAN;
  if (none || estimate->open_high) estimate->high = (double)NAN;
}

bool strut_fit_judge(const strut_fit_layout *layout, const strut_fit_spectrum *spectrum,
                     const double *best, strut_fit_result *result) {
  size_t first = layout->aligned_count;
  double sum = result->starts[result->best].sum;
  double rise = gsl_cdf_chisq_Pinv(0.95, 1.0) * result->scale * result->scale;
  result->residuals =
      strut_arena_allocate(&result->arena, layout->fit->match_count, sizeof *result->residuals);
  if (!result->residuals) return false;
  for (size_t m = 0; m < layout->fit->match_count; m++) describe_residuals(layout, m, result);
  result->chi_square = layout->noise_known ? sum : (double)NAN;
  result->probability = layout->noise_known && result->freedom > 0.0
                            ? gsl_cdf_chisq_Q(sum, result->freedom)
                            : (double)NAN;
  for (size_t i = 0; i < layout->parameters; i++)
    result->estimates[i].verdict = first_verdict(&result->estimates[i]);
  if (!find_directions(layout, spectrum, result)) return false;
  const char *flaw = find_flaw(result), *other = compare_starts(layout, best, rise, result);
  if (!flaw) return false;
  result->reason = *flaw ? flaw : other;
  for (size_t i = first; i < layout->parameters && *result->reason; i++)
    result->estimates[i].verdict = *flaw ? STRUT_FIT_UNEXPLAINED : STRUT_FIT_DISAGREE;
  for (size_t i = first; i < layout->parameters; i++) withdraw(&result->estimates[i]);
  return true;
}

bool strut_fit_is_identified(const strut_fit_result *result) {
  bool all = result->found;
  for (size_t i = result->aligned_count; i < result->parameters && all; i++)
    all = result->estimates[i].verdict == STRUT_FIT_IDENTIFIED;
  return all;
}
