/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a fit has found, as people and programs read it, and its files. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/file.h"
#include "engine/output/result_values.h"
#include "engine/study/fit/fit.h"
#include "engine/study/fit/fit_parts.h"

/* What the residuals and the derivatives at the best fit say of it, and the verdicts. */

/* A sum of squares that a right model exceeds this rarely is not explained. */
static const double RARE = 1e-4;

/* Nor are successive residuals that are correlated by so many standard errors. */
static const double CORRELATED = 5.0;

/* But where the squares of all sum up to so little, they put no parameter off by more than a tenth of its error. */
static const double NEGLIGIBLE = 0.01;

/* Numbers that differ so many times from the model's may have another unit. */
static const double MUCH = 5.0;

/* Starts agree whose sums differ by this part of what an end of an interval takes. */
static const double SAME = 0.05;

/* Another fit that is about as good, but so many half intervals away, is another answer. */
static const double AWAY = 2.0;

/* There may be many such fits: one is left out only if its sum excludes it more surely than an interval has to. */
static const double ELSEWHERE = 0.995;

/*
 * A motion whose times are so coarse, as those of a vibration measured 2.3 times a period, is not determined; nor, where
 * no second start has ended at the same fit, one of 3.4 times a period, which may be the alias of a faster one.
 */
static const double COARSE = 0.15, ALIAS = 0.05;

/* Residuals too large show a wrong model only where so many starts, and this part of them, end at the best fit. */
enum { SEVERAL = 2 };
static const double MANY = 0.25;

/* Along a direction with this standard deviation, in parts of ranges, nothing is determined. */
static const double WIDE = 0.25;

/*
 * A parameter takes part in a direction from this part on, if a move along it over the ranges changes the parameter by
 * this many of the errors that it would have without the direction.
 */
static const double PART = 0.02, ERRORS = 2.0;

/* A power this near to 1 is 1. */
static const double WHOLE = 0.02;

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
    const double *residual = result->residual + match->series[s].first;
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

/* "; the model's numbers are 100 times those of 'x [cm]': check this unit", where a match has such numbers, or "". */
static const char *doubt_unit(strut_fit_result *result, const strut_fit_match *match) {
  const strut_data_column *column = match->series[0].column;
  double sums[2][3] = {{0.0}};
  for (size_t i = 0; column && i < match->count; i++) {
    const double pair[] = {column->values[i], result->predicted[match->series[0].first + i]};
    for (int k = 0; k < 2 && !isnan(pair[0]); k++)
      sums[k][0] += 1.0, sums[k][1] += pair[k], sums[k][2] += pair[k] * pair[k];
  }
  for (int k = 0; k < 2 && match->align.shift; k++)
    sums[k][2] -= sums[k][1] * sums[k][1] / fmax(sums[k][0], 1.0);
  double times = sqrt(sums[1][2] / sums[0][2]);
  if (!column || !(fabs(log(times)) > log(MUCH))) return "";
  return strut_arena_format(&result->arena,
                            "; the model's numbers are %.2g times those of '%.40s [%.20s]': check "
                            "this unit",
                            times, column->name, column->unit);
}

bool strut_fit_find_flaw(const strut_fit_layout *layout, strut_fit_result *result) {
  size_t matches = layout->fit->match_count;
  bool known = layout->noise_known;
  double sum = result->starts[result->best].sum;
  const char *flaw = "";
  result->residuals = strut_arena_allocate(&result->arena, matches, sizeof *result->residuals);
  if (!result->residuals) return false;
  for (size_t m = 0; m < matches; m++) describe_residuals(layout, m, result);
  result->chi_square = known ? sum : (double)NAN;
  result->probability =
      known && result->freedom > 0.0 ? gsl_cdf_chisq_Q(sum, result->freedom) : (double)NAN;
  for (size_t m = 0; m <= matches && known && flaw && !*flaw; m++) {
    const strut_fit_residuals *of = m ? &result->residuals[m - 1] : NULL;
    double square = of ? of->chi_square : sum, freedom = of ? (double)of->used : result->freedom;
    if (gsl_cdf_chisq_Q(square, fmax(freedom, 1.0)) < RARE)
      flaw = strut_arena_format(&result->arena,
                                "the residuals%s%.40s%s are %.3g times the noise: chi square %.4g "
                                "with %.0f degrees of freedom",
                                of ? " of '" : "", of ? of->match->name : "", of ? "'" : "",
                                sqrt(square / freedom), square, freedom);
  }
  for (size_t m = 0; m < matches && flaw && !*flaw; m++)
    if (fabs(result->residuals[m].lag) > CORRELATED &&
        (known ? sum > NEGLIGIBLE : result->scale > STRUT_FIT_EXACT))
      flaw = strut_arena_format(&result->arena,
                                "successive residuals of '%.40s' are correlated, by %.3g standard "
                                "errors",
                                result->residuals[m].match->name, result->residuals[m].lag);
  const char *doubt = "";
  for (size_t m = 0; m < matches && flaw && *flaw && doubt && !*doubt; m++)
    doubt = doubt_unit(result, &layout->fit->matches[m]);
  result->reason = flaw && doubt ? strut_arena_format(&result->arena, "%s%s", flaw, doubt) : NULL;
  return result->reason != NULL;
}

/* By how much the noise of a match is larger than its residuals, where it is too large for them; else 0. */
static double find_excess(const strut_fit_result *result, const strut_fit_residuals *of) {
  double freedom = (double)of->used - (double)result->parameters;
  bool large = freedom > 0.0 && gsl_cdf_chisq_P(of->chi_square, freedom) < RARE;
  return large ? sqrt(freedom / of->chi_square) : 0.0;
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
static const char *name_determined(const strut_fit_unknown *first, const strut_fit_unknown *second,
                                   double other, strut_fit_result *result) {
  const strut_search_variable *one = first->variable, *two = second->variable;
  if (!one || !two || !one->logarithmic || !two->logarithmic)
    return strut_arena_format(&result->arena, "%.40s %c %.3g %.40s", first->name,
                              other < 0.0 ? '-' : '+', fabs(other), second->name);
  double power = other * log(one->to / one->from) / log(two->to / two->from);
  char text[40] = "";
  if (fabs(fabs(power) - 1.0) > WHOLE) snprintf(text, sizeof text, "^%.3g", fabs(power));
  return strut_arena_format(&result->arena, "%.40s%c%.40s%s", first->name, power < 0.0 ? '/' : '*',
                            second->name, text);
}

/*
 * "friction and damping together", and what of two is determined: the fitted ones that take part, then the
 * alignments. False: memory is out.
 */
static bool describe_direction(const strut_fit_layout *layout, const bool *takes,
                               const double *part, strut_fit_result *result,
                               strut_fit_direction *direction) {
  strut_buffer text = {0};
  size_t taken = 0, pair[2] = {0, 0};
  for (size_t k = 0; k < result->parameters; k++) {
    size_t i = (k + result->aligned_count) % result->parameters;
    if (!takes[i]) continue;
    strut_buffer_add(&text, "%s%s", taken ? " and " : "", result->estimates[i].name);
    if (taken < 2) pair[taken] = i;
    taken++;
  }
  if (taken > 1) strut_buffer_add(&text, " together");
  char *words = strut_buffer_take(&text);
  direction->words = words ? strut_arena_text(&result->arena, words, strlen(words)) : NULL;
  strut_release(words);
  if (taken == 2)
    direction->determined = name_determined(&layout->unknowns[pair[0]], &layout->unknowns[pair[1]],
                                            -part[pair[0]] / part[pair[1]], result);
  return direction->words && (taken != 2 || direction->determined);
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
    for (size_t i = 0; i < n; i++) {
      part[i] = spectrum->direction[k * n + i] / size;
      takes[i] = takes_part(spectrum, result->scale, k, i, size);
      if (takes[i]) result->estimates[i].verdict = STRUT_FIT_UNDETERMINED;
    }
    strut_fit_direction *direction = &result->directions[result->direction_count++];
    *direction = (strut_fit_direction){.error = error, .part = part + first};
    if (!describe_direction(layout, takes, part, result, direction)) return false;
  }
  return result->directions != NULL;
}

/* ---- starts ---- */

/* Is estimate i of a row surely another than that of the best fit? What is not determined may be anywhere. */
static bool differs(const strut_fit_result *result, const strut_fit_row *row, size_t i) {
  const strut_fit_estimate *estimate = &result->estimates[i];
  double half = 0.5 * (estimate->high - estimate->low);
  return estimate->verdict == STRUT_FIT_IDENTIFIED &&
         fabs(row->values[i] - estimate->value) > AWAY * half;
}

/* Is a fit that is about as good as the best one another answer? If only its delays are others, the nearest are kept. */
static bool is_another(const strut_fit_layout *layout, strut_fit_result *result,
                       const strut_fit_row *row) {
  for (size_t i = layout->aligned_count; i < layout->parameters; i++)
    if (differs(result, row, i)) return true;
  for (size_t i = 0; i < layout->aligned_count; i++) {
    strut_fit_estimate *estimate = &result->estimates[i];
    double far = fabs(row->values[i] - estimate->value);
    if (layout->unknowns[i].what == STRUT_FIT_DELAY && differs(result, row, i) &&
        !(far >= fabs(estimate->also - estimate->value)))
      estimate->also = row->values[i];
  }
  return false;
}

/*
 * Why starts disagree; "": they agree. Sums of fits that do not explain the data, by `flaw`, are as uncertain as they
 * are large.
 */
static const char *compare_starts(const strut_fit_layout *layout, const char *flaw,
                                  strut_fit_result *result) {
  double least = result->starts[result->best].sum, freedom = fmax(result->freedom, 1.0);
  double unit = result->scale * result->scale;
  if (*flaw) unit = fmax(unit, least / freedom);
  double rise = gsl_cdf_chisq_Pinv(0.95, 1.0) * unit;
  double elsewhere = gsl_cdf_chisq_Pinv(ELSEWHERE, 1.0) * unit;
  bool better = !result->settled, known = !isnan(result->chi_square);
  const char *why = "";
  for (size_t i = 0; i < result->start_count + result->beside_count; i++) {
    bool start = i < result->start_count;
    strut_fit_row *row = &result->starts[i];
    if (row->sum < least - SAME * rise) better = true;
    double more = row->end == STRUT_FIT_CONVERGED ? elsewhere : rise;
    if (row->end == STRUT_FIT_FAILED || !(row->sum <= least + more)) continue;
    bool another = is_another(layout, result, row);
    row->agrees = !another && row->sum <= least + SAME * rise;
    result->agreeing += start && row->agrees;
    if (another) why = "a fit with residuals about as small ends elsewhere";
  }
  for (size_t i = 0; i < 2 * result->variable_count; i++)
    better = better || result->ends[i].sum < least - SAME * rise;
  if (better)
    why = "beside the best fit there is a better one, which no start has found: give more starts";
  if (!*why && !(known && result->freedom > 0.0) && result->start_count > 1 && result->agreeing < 2)
    why =
        "only one start ends at the best fit, and residuals cannot say that it is right: give "
        "'noise', or more numbers than parameters";
  return why;
}

/*
 * What the starts say of a flaw of the best fit: it may not be the model's where few of them, or none, end there, the
 * best fit has not converged, or lies where the parameters hardly matter. NULL: memory is out.
 */
static const char *qualify_flaw(const char *flaw, strut_fit_result *result, bool *far) {
  size_t starts = result->start_count, least = starts < SEVERAL ? starts : SEVERAL;
  bool few = result->agreeing < least || (double)result->agreeing < MANY * (double)starts;
  bool ended = result->starts[result->best].end == STRUT_FIT_CONVERGED && result->settled;
  bool flat = true;
  for (size_t i = result->aligned_count; i < result->parameters; i++)
    flat = flat && !isfinite(result->estimates[i].error);
  *far = few || flat || !ended;
  if (*far)
    return strut_arena_format(&result->arena,
                              "%s; %sstarts that end there: %zu of %zu: give more starts or "
                              "narrower ranges",
                              flaw,
                              !ended ? "the method has not converged; "
                              : flat ? "the parameters hardly matter there; "
                                     : "",
                              result->agreeing, starts);
  return starts > 1
             ? flaw
             : strut_arena_format(&result->arena,
                                  "%s; a single start does not show that none fits better", flaw);
}

/* ---- verdicts ---- */

bool strut_fit_judge(const strut_fit_layout *layout, const strut_fit_spectrum *spectrum,
                     strut_fit_result *result) {
  size_t first = layout->aligned_count;
  const char *flaw = result->reason;
  bool far = false;
  if (!find_directions(layout, spectrum, result)) return false;
  result->reason = compare_starts(layout, flaw, result);
  if (*flaw) result->reason = qualify_flaw(flaw, result, &far);
  bool lone = result->agreeing < 2;
  bool coarse = !*flaw && result->coarseness > (lone ? ALIAS : COARSE);
  if (coarse)
    result->reason = strut_arena_format(&result->arena,
                                        "the motion changes much between the times of '%.40s', so "
                                        "that others would do as well: measure it more often%s",
                                        result->coarse->name, lone ? ", and give more starts" : "");
  if (!result->reason) return false;
  strut_fit_verdict verdict = coarse          ? STRUT_FIT_UNDETERMINED
                              : *flaw && !far ? STRUT_FIT_UNEXPLAINED
                                              : STRUT_FIT_DISAGREE;
  for (size_t i = first; i < layout->parameters; i++) {
    strut_fit_estimate *estimate = &result->estimates[i];
    bool bound = estimate->at_bound && verdict == STRUT_FIT_UNEXPLAINED;
    if (*result->reason && !bound) estimate->verdict = verdict;
    bool none = *result->reason || !isfinite(estimate->error); /* is known: nor is it given */
    if (none) estimate->low = estimate->high = (double)NAN;
  }
  return true;
}

bool strut_fit_is_identified(const strut_fit_result *result) {
  bool all = result->found;
  for (size_t i = result->aligned_count; i < result->parameters && all; i++)
    all = result->estimates[i].verdict == STRUT_FIT_IDENTIFIED;
  return all;
}

static const char *const verdicts[] = {
#define STRUT_FIT_VERDICT_WORDS(NAME, words) words,
    STRUT_FIT_VERDICTS(STRUT_FIT_VERDICT_WORDS)};

/* A number in the unit of an estimate. */
#define STRUT_VALUE_AS_IN(UNIT, NUMBER) STRUT_VALUE_AS_CALLED(NULL, UNIT, NUMBER)

static const strut_fit_result *result_of(const strut_result_object *of) {
  return strut_result_whole(of);
}

/* Do both intervals differ by more than a fifth of their size? */
static bool is_skewed(const strut_fit_estimate *e) {
  double fifth = 0.2 * (e->linear_high - e->linear_low);
  return e->verdict == STRUT_FIT_IDENTIFIED &&
         (fabs(e->low - e->linear_low) > fifth || fabs(e->high - e->linear_high) > fifth);
}

#define ESTIMATE(X)                                                                                \
  X("parameter", "", TEXT(e->name), "its name", .column = {"parameter"}, .label = {""})            \
  X("unit", "", TEXT(e->unit), "of its numbers")                                                   \
  X("value", "", IN(e->unit, e->value), "of the best fit", .column = {"value"}, .label = {""})     \
  X("standard_error", "", IN(e->unit, isfinite(e->error) ? e->error : (double)NAN),                \
    "from the derivatives; null if unknown", .column = {"standard_error"},                         \
    .label = {"standard error"})                                                                   \
  X("low", "", IN(e->unit, e->low), "95 % interval, by the profile; null: not given",              \
    .column = {"low"}, .label = {"95 %, from"})                                                    \
  X("high", "", IN(e->unit, e->high), "likewise", .column = {"high"}, .label = {"to"})             \
  X("verdict", "", TEXT(verdicts[e->verdict]), "whether it is identified, or why not",             \
    .column = {"verdict"}, .label = {""})                                                          \
  X("linear_low", "", IF(is_skewed(e), NUMBER(e->linear_low)),                                     \
    "95 % interval by the standard error, where it differs by more than a fifth")                  \
  X("linear_high", "", IF(is_skewed(e), NUMBER(e->linear_high)), "likewise")
STRUT_VALUES_HERE(estimate_values, ESTIMATE, const strut_fit_estimate *e = of->at)

#define ALIGNMENT(X)                                                                               \
  X("name", "", TEXT(e->name), "match and number", .label = {"alignment"})                         \
  X("unit", "", TEXT(e->unit), "of its numbers")                                                   \
  X("value", "", IN(e->unit, e->value), "of the best fit", .label = {""})                          \
  X("standard_error", "", IN(e->unit, e->error), "by the derivatives",                             \
    .label = {"standard error"})                                                                   \
  X("also", "", IF(!isnan(e->also), IN(e->unit, e->also)),                                         \
    "another delay that fits as well, such as one a period later", .label = {"also fits"})
STRUT_VALUES_HERE(alignment_values, ALIGNMENT, const strut_fit_estimate *e = of->at)

static const char *unit_of_match(const strut_fit_match *match) {
  for (size_t s = 1; s < match->series_count; s++)
    if (match->series[s].unit != match->series[0].unit) return "1";
  return match->series[0].unit;
}

#define RESIDUALS(X)                                                                               \
  X("match", "", TEXT(r->match->name), "its name", .label = {""})                                  \
  X("numbers", "", COUNT(r->used), "that count", .label = {""})                                    \
  X("rms", "", IN(unit_of_match(r->match), r->rms), "root mean square of the residuals, SI",       \
    .label = {"residuals"})                                                                        \
  X("noise", "", IF(r->match->noise > 0.0, IN(r->match->noise_unit, r->match->noise)),             \
    "standard deviation of the numbers, as given", .label = {""})                                  \
  X("excess", "1", IF(find_excess(result_of(of), r) > 0.0, NUMBER(find_excess(result_of(of), r))), \
    "factor by which the noise given exceeds the residuals", .label = {"noise too large by"})      \
  X("chi_square", "1", IF(!isnan(r->chi_square), NUMBER(r->chi_square)),                           \
    "sum of squared residuals in units of the noise", .label = {"chi square"})                     \
  X("lag", "1", IF(!isnan(r->lag), NUMBER(r->lag)),                                                \
    "correlation of successive residuals, in its standard errors",                                 \
    .label = {"autocorrelation in standard errors"})
STRUT_VALUES_HERE(residual_values, RESIDUALS, const strut_fit_residuals *r = of->at)

static const char *variable_name(const strut_result_object *of, size_t i) {
  return result_of(of)->fit->variables[i].name;
}

static strut_value value_of_row(const strut_result_object *of, size_t i) {
  const strut_fit_row *row = of->at;
  return STRUT_VALUE_AS_CALLED(NULL, result_of(of)->fit->variables[i].unit,
                               row->values[result_of(of)->aligned_count + i]);
}

#define ROW(X)                                                                                     \
  X("end", "", TEXT(strut_fit_ends[r->end]), "how it ended", .label = {""})                        \
  X("sum", "1", NUMBER(r->sum), "of squared residuals", .label = {"sum of squares"})               \
  X("evaluations", "", COUNT(r->evaluations), "of the residuals", .label = {""})                   \
  X("values", "", MAP(result_of(of)->variable_count, variable_name, value_of_row),                 \
    "of the parameters, SI", .label = {""})
STRUT_VALUES_HERE(row_values, ROW, const strut_fit_row *r = of->at)

#define START(X)                                                                                   \
  X("start", "", COUNT(of->index + 1), "its number", .label = {""})                                \
  X(NULL, "", SAME, "", .rows = &row_values, .label = {" "})                                       \
  X("agrees", "", FLAG(r->agrees), "with the best", .label = {""})
STRUT_VALUES_HERE(start_values, START, const strut_fit_row *r = of->at)

#define OMISSION(X)                                                                                \
  X("without", "", TEXT(result_of(of)->fit->matches[of->index].name), "this match", .label = {""}) \
  X(NULL, "", SAME, "", .rows = &row_values, .label = {" "})
STRUT_VALUES_HERE(omission_values, OMISSION, )

#define DIRECTION(X)                                                                               \
  X("words", "", TEXT(d->words), "what is not determined", .label = {"not determined"})            \
  X("determined", "", IF(d->determined, TEXT(d->determined)),                                      \
    "of two parameters, each over its range; of logarithmic ones a product or ratio",              \
    .label = {"but, over the ranges"})                                                             \
  X("error", "1", NUMBER(d->error), "standard deviation along it, in parts of the ranges",         \
    .label = {"error, of the ranges"})                                                             \
  X("part", "1", NUMBERS(d->part, result_of(of)->variable_count), "of each parameter in it")
STRUT_VALUES_HERE(direction_values, DIRECTION, const strut_fit_direction *d = of->at)

static strut_value correlations_of(const strut_result_object *of, size_t i) {
  const strut_fit_result *r = of->at;
  return STRUT_VALUE_AS_NUMBERS(r->correlation + i * r->variable_count, r->variable_count);
}

#define FIT(X)                                                                                     \
  X("identified", "", FLAG(strut_fit_is_identified(r)), "whether all parameters are",              \
    .label = {""})                                                                                 \
  X("reason", "", IF(r->reason && * r->reason, TEXT(r->reason)), "why not", .label = {"because"})  \
  X("parameters", "", IF(r->found, LIST(r->estimates + r->aligned_count, r->variable_count)),      \
    "what is fitted", .rows = &estimate_values, .label = {""})                                     \
  X("alignments", "", IF(r->found && r->aligned_count, LIST(r->estimates, r->aligned_count)),      \
    "of the matches", .rows = &alignment_values, .label = {""})                                    \
  X("undetermined", "", IF(r->direction_count, LIST(r->directions, r->direction_count)),           \
    "directions that the numbers do not determine", .rows = &direction_values, .label = {""})      \
  X("correlation", "1", IF(r->found, MAP(r->variable_count, variable_name, correlations_of)),      \
    "of the parameters' errors, in their order")                                                   \
  X("matches", "", IF(r->found, LIST(r->residuals, r->fit->match_count)), "their residuals",       \
    .rows = &residual_values, .label = {""})                                                       \
  X("degrees_of_freedom", "", IF(r->found, COUNT(r->freedom)), "numbers less parameters",          \
    .label = {"degrees of freedom"})                                                               \
  X("probability", "1", IF(r->found && !isnan(r->probability), NUMBER(r->probability)),            \
    "of residuals at least so large, if the model is right", .label = {"probability"})             \
  X("agreeing", "", COUNT(r->agreeing), "starts that end at the best fit",                         \
    .label = {"starts that agree"})                                                                \
  X("starts", "", LIST(r->starts, r->start_count), "one by one", .rows = &start_values,            \
    .label = {""})                                                                                 \
  X("omissions", "",                                                                               \
    IF(r->found && r->fit->omission_count, LIST(r->omissions, r->fit->omission_count)),            \
    "fits without one match", .rows = &omission_values, .label = {""})
STRUT_VALUES(strut_fit_values, FIT, const strut_fit_result *r = of->at)

static const char *planned_name(const strut_result_object *of, size_t i) {
  return ((const strut_fit_plan *)strut_result_whole(of))->fit->variables[i].name;
}

static strut_value planned_error(const strut_result_object *of, size_t i) {
  const strut_fit_plan *plan = strut_result_whole(of);
  return STRUT_VALUE_AS_CALLED(NULL, plan->fit->variables[i].unit,
                               ((const strut_fit_candidate *)of->at)->errors[i]);
}

#define CANDIDATE(X)                                                                               \
  X("name", "", TEXT(c->name), "a place of a match, a match, or all", .label = {"measured"})       \
  X("numbers", "", COUNT(c->numbers), "of it", .label = {""})                                      \
  X("determinant", "1", NUMBER(c->determinant),                                                    \
    "log10 of that of the information, in units of the ranges", .label = {"log10 determinant"})    \
  X("least", "1", NUMBER(c->least), "singular value of the derivatives, likewise",                 \
    .label = {"least singular value"})                                                             \
  X("standard_errors", "", MAP(p->variable_count, planned_name, planned_error),                    \
    "of the parameters, SI; null: not determined", .label = {"error of"})
STRUT_VALUES_HERE(candidate_values, CANDIDATE, const strut_fit_candidate *c = of->at;
                  const strut_fit_plan *p = strut_result_whole(of))

#define PLAN(X)                                                                                    \
  X("candidates", "", LIST(p->candidates, p->count), "the best first", .rows = &candidate_values,  \
    .label = {""})
STRUT_VALUES(strut_fit_plan_values, PLAN, const strut_fit_plan *p = of->at)

/* ---- files ---- */

/* A number with its unit, such as "3000 N/m". */
static void add_quantity(strut_buffer *text, double value, const char *unit) {
  bool plain = !*unit || strcmp(unit, "1") == 0;
  strut_csv_add_number(text, value);
  strut_buffer_add(text, "%s%s", plain ? "" : " ", plain ? "" : unit);
}

/* Numbers, each behind a comma; empty for NAN. */
static void add_cells(strut_buffer *csv, const double *numbers, size_t count) {
  for (size_t i = 0; i < count; i++) {
    strut_buffer_add(csv, ",");
    strut_csv_add_number(csv, numbers[i]);
  }
}

/* Of the errors of the parameters, SI. */
static char *covariance_csv(const strut_fit_result *result) {
  strut_buffer csv = {0};
  const strut_fit_estimate *estimates = result->estimates + result->aligned_count;
  size_t n = result->variable_count;
  strut_buffer_add(&csv, "parameter");
  for (size_t j = 0; j < n; j++) strut_buffer_add(&csv, ",%s", estimates[j].name);
  for (size_t i = 0; i < n; i++) {
    strut_buffer_add(&csv, "\n%s", estimates[i].name);
    for (size_t j = 0; j < n; j++) {
      double common = result->correlation[i * n + j] * estimates[i].error * estimates[j].error;
      add_cells(&csv, &common, 1);
    }
  }
  strut_buffer_add(&csv, "\n");
  return strut_buffer_take(&csv);
}

static char *residuals_csv(const strut_fit_result *result) {
  strut_buffer csv = {0};
  strut_buffer_add(&csv, "match,of,at,measured,predicted,residual\n");
  for (size_t m = 0; m < result->fit->match_count; m++)
    for (size_t s = 0; s < result->fit->matches[m].series_count; s++) {
      const strut_fit_match *match = &result->fit->matches[m];
      size_t first = match->series[s].first;
      for (size_t i = 0; i < match->count; i++) {
        const double numbers[] = {match->at ? match->at[i] : (double)NAN,
                                  match->series[s].measured[i], result->predicted[first + i],
                                  result->residual[first + i]};
        if (isnan(numbers[1])) continue;
        strut_buffer_add(&csv, "%s,", match->name);
        strut_csv_add_text(&csv, "%s", match->series[s].of);
        add_cells(&csv, numbers, 4);
        strut_buffer_add(&csv, "\n");
      }
    }
  return strut_buffer_take(&csv);
}

static char *fitted_yaml(const strut_fit_result *result, const char *model) {
  strut_buffer text = {0};
  const strut_fit_estimate *estimates = result->estimates + result->aligned_count;
  strut_buffer_add(&text, "strut: 1\nbase: %s\nparameters:\n", model);
  for (size_t i = 0; i < result->variable_count; i++) {
    strut_buffer_add(&text, "  %s: ", estimates[i].name);
    add_quantity(&text, estimates[i].value, estimates[i].unit);
    strut_buffer_add(&text, " # %s\n", verdicts[estimates[i].verdict]);
  }
  return strut_buffer_take(&text);
}

/* A study of the fitted model whose parameters are as uncertain as they are, together. */
static char *uncertain_yaml(const strut_fit_result *result) {
  strut_buffer text = {0};
  size_t n = result->variable_count;
  const strut_fit_estimate *estimates = result->estimates + result->aligned_count;
  strut_buffer_add(&text,
                   "strut: 1\nstudy: Uncertain parameters\nmodel: fitted.yaml\naxes:\n"
                   "  - sample:\n      count: 100\n      over:\n");
  for (size_t i = 0; i < n; i++) {
    strut_buffer_add(&text, "        %s: {normal: [", estimates[i].name);
    add_quantity(&text, estimates[i].value, estimates[i].unit);
    strut_buffer_add(&text, ", ");
    add_quantity(&text, estimates[i].error, estimates[i].unit);
    strut_buffer_add(&text, "]}\n");
  }
  strut_buffer_add(&text, "      correlation:\n");
  for (size_t i = 0; i < n; i++) {
    strut_buffer_add(&text, "        - [");
    for (size_t j = 0; j < n; j++) {
      if (j) strut_buffer_add(&text, ", ");
      strut_csv_add_number(&text, i == j ? 1.0 : result->correlation[i * n + j]);
    }
    strut_buffer_add(&text, "]\n");
  }
  return strut_buffer_take(&text);
}

strut_status strut_fit_write(const strut_fit_result *result, const char *directory,
                             const char *model, strut_error *error) {
  if (!result->found) return STRUT_OK;
  strut_status status = strut_file_write_block(
      directory, "fit.csv", strut_values_csv(&strut_fit_values, "parameters", NULL, result, NULL),
      error);
  if (!status)
    status = strut_file_write_block(directory, "covariance.csv", covariance_csv(result), error);
  if (!status)
    status = strut_file_write_block(directory, "residuals.csv", residuals_csv(result), error);
  if (!status)
    status = strut_file_write_block(directory, "fitted.yaml", fitted_yaml(result, model), error);
  if (!status && strut_fit_is_identified(result))
    status = strut_file_write_block(directory, "uncertain.yaml", uncertain_yaml(result), error);
  return status;
}
