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

/* Nor are successive residuals, if there are more than the fewest, that are correlated by so many standard errors. */
static const double CORRELATED = 5.0, FEWEST = 10.0;

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

/* A text of the result, which remembers that memory is out, in printf's style; never NULL. */
#define SAY(result, ...) keep_text(result, strut_arena_format(&(result)->arena, __VA_ARGS__))

static const char *keep_text(strut_fit_result *result, const char *text) {
  if (!text) result->out_of_memory = true;
  return text ? text : "";
}

/* ---- residuals ---- */

/* Sums of a match's residuals, and how successive ones of each series are correlated, where there are enough. */
static void describe_residuals(const strut_fit_layout *layout, size_t m, strut_fit_result *result) {
  const strut_fit_match *match = &layout->fit->matches[m];
  strut_fit_residuals *of = &result->residuals[m];
  double square = 0.0, lags = 0.0, series = 0.0;
  *of = (strut_fit_residuals){.match = match, .lag = (double)NAN};
  for (size_t s = 0; s < match->series_count; s++) {
    const strut_fit_number *number = &result->numbers[match->series[s].first];
    double products = 0.0, own = 0.0, last = 0.0, used = 0.0;
    for (size_t i = 0; i < match->count; i++) {
      double residual = number[i].residual;
      if (residual == 0.0) continue; /* a gap */
      products += last * residual;
      own += residual * residual, square += residual * residual;
      last = residual;
      used += 1.0;
    }
    of->used += (int64_t)used;
    if (match->kind != STRUT_FIT_MOTION || used <= FEWEST) continue;
    lags += products / own * sqrt(used), series += 1.0;
  }
  if (series > 0.0) of->lag = lags / sqrt(series);
  of->rms = layout->parts[m].noise * sqrt(square / fmax(1.0, (double)of->used));
  of->chi_square = layout->noise_known ? square : (double)NAN;
}

/* The flaw with "; the model's numbers are 100 times those of 'x [cm]': check this unit", where a match has such numbers. */
static const char *doubt_unit(strut_fit_result *result, const strut_fit_match *match,
                              const char *flaw) {
  const strut_data_column *column = match->series[0].column;
  double sums[2][3] = {{0.0}};
  for (size_t i = 0; column->name && i < match->count; i++) {
    const strut_fit_number *number = &result->numbers[match->series[0].first + i];
    const double pair[] = {number->measured, number->predicted};
    for (int k = 0; k < 2 && !isnan(pair[0]); k++)
      sums[k][0] += 1.0, sums[k][1] += pair[k], sums[k][2] += pair[k] * pair[k];
  }
  for (int k = 0; k < 2 && match->align.shift; k++)
    sums[k][2] -= sums[k][1] * sums[k][1] / fmax(sums[k][0], 1.0);
  double times = sqrt(sums[1][2] / sums[0][2]);
  if (!column->name || !(fabs(log(times)) > log(MUCH))) return flaw;
  return SAY(result,
             "%s; the model's numbers are %.2g times those of '%.40s [%.20s]': check this unit",
             flaw, times, column->name, column->unit);
}

void strut_fit_find_flaw(const strut_fit_layout *layout, strut_fit_result *result) {
  size_t matches = layout->fit->match_count;
  bool known = layout->noise_known;
  double sum = result->starts[result->best].sum;
  const char *flaw = "";
  result->residuals = strut_arena_allocate(&result->arena, matches, sizeof *result->residuals);
  if (!result->residuals) result->out_of_memory = true;
  if (!result->residuals) return;
  for (size_t m = 0; m < matches; m++) describe_residuals(layout, m, result);
  result->chi_square = known ? sum : (double)NAN;
  result->probability =
      known && result->freedom > 0.0 ? gsl_cdf_chisq_Q(sum, result->freedom) : (double)NAN;
  for (size_t m = 0; m <= matches && known && !*flaw; m++) {
    const strut_fit_residuals *of = m ? &result->residuals[m - 1] : NULL;
    double square = of ? of->chi_square : sum, freedom = of ? (double)of->used : result->freedom;
    if (gsl_cdf_chisq_Q(square, fmax(freedom, 1.0)) < RARE)
      flaw = SAY(result,
                 "the residuals%s%.40s%s are %.3g times the noise: chi square %.4g with %.0f "
                 "degrees of freedom",
                 of ? " of '" : "", of ? of->match->name : "", of ? "'" : "",
                 sqrt(square / freedom), square, freedom);
  }
  for (size_t m = 0; m < matches && !*flaw; m++)
    if (fabs(result->residuals[m].lag) > CORRELATED &&
        (known ? sum > NEGLIGIBLE : result->scale > STRUT_FIT_EXACT))
      flaw = SAY(result, "successive residuals of '%.40s' are correlated, by %.3g standard errors",
                 result->residuals[m].match->name, result->residuals[m].lag);
  result->reason = flaw;
  for (size_t m = 0; m < matches && *flaw && result->reason == flaw; m++)
    result->reason = doubt_unit(result, &layout->fit->matches[m], flaw);
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
    return SAY(result, "%.40s %c %.3g %.40s", first->name, other < 0.0 ? '-' : '+', fabs(other),
               second->name);
  double power = other * log(one->to / one->from) / log(two->to / two->from);
  char text[40] = "";
  if (fabs(fabs(power) - 1.0) > WHOLE) snprintf(text, sizeof text, "^%.3g", fabs(power));
  return SAY(result, "%.40s%c%.40s%s", first->name, power < 0.0 ? '/' : '*', second->name, text);
}

/*
 * A direction in which the numbers determine nothing: "friction and damping together", and what of two is determined.
 * The fitted ones that take part come first, then the alignments.
 */
static void describe_direction(const strut_fit_layout *layout, const strut_fit_spectrum *spectrum,
                               size_t k, double size, strut_fit_result *result) {
  size_t n = spectrum->parameters, first = layout->aligned_count, taken = 0, pair[2] = {0, 0};
  strut_fit_direction *direction = &result->directions[result->direction_count++];
  double *part = strut_arena_allocate(&result->arena, n, sizeof *part);
  const char *words = "";
  if (!part) result->out_of_memory = true;
  for (size_t j = first; j < first + n && part; j++) {
    size_t i = j % n;
    part[i] = spectrum->direction[k * n + i] / size;
    if (!takes_part(spectrum, result->scale, k, i, size)) continue;
    result->estimates[i].verdict = STRUT_FIT_UNDETERMINED;
    words = SAY(result, "%s%s%s", words, taken ? " and " : "", layout->unknowns[i].name);
    if (taken < 2) pair[taken] = i;
    taken++;
  }
  *direction = (strut_fit_direction){.part = part + first, .words = words};
  direction->error = spectrum->singular[k] > 0.0 ? result->scale / spectrum->singular[k] : HUGE_VAL;
  if (taken > 1) direction->words = SAY(result, "%s together", words);
  if (taken == 2)
    direction->determined = name_determined(&layout->unknowns[pair[0]], &layout->unknowns[pair[1]],
                                            -part[pair[0]] / part[pair[1]], result);
}

static void find_directions(const strut_fit_layout *layout, const strut_fit_spectrum *spectrum,
                            strut_fit_result *result) {
  size_t n = spectrum->parameters;
  result->directions = strut_arena_allocate(&result->arena, n, sizeof *result->directions);
  if (!result->directions) result->out_of_memory = true;
  for (size_t k = 0; k < n && !result->out_of_memory; k++) {
    double size = 0.0;
    for (size_t i = layout->aligned_count; i < n; i++)
      size = hypot(size, spectrum->direction[k * n + i]);
    bool wide =
        !(spectrum->singular[k] > 0.0) || result->scale / spectrum->singular[k] * size > WIDE;
    if (wide && size > PART) describe_direction(layout, spectrum, k, size, result);
  }
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
 * best fit has not converged, or lies where the parameters hardly matter.
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
    return SAY(result,
               "%s; %sstarts that end there: %zu of %zu: give more starts or narrower ranges", flaw,
               !ended ? "the method has not converged; "
               : flat ? "the parameters hardly matter there; "
                      : "",
               result->agreeing, starts);
  return starts > 1 ? flaw
                    : SAY(result, "%s; a single start does not show that none fits better", flaw);
}

/* ---- verdicts ---- */

void strut_fit_judge(const strut_fit_layout *layout, const strut_fit_spectrum *spectrum,
                     strut_fit_result *result) {
  const char *flaw = result->reason;
  bool far = false;
  find_directions(layout, spectrum, result);
  result->reason = compare_starts(layout, flaw, result);
  if (*flaw) result->reason = qualify_flaw(flaw, result, &far);
  bool lone = result->agreeing < 2;
  bool coarse = !*flaw && result->coarseness > (lone ? ALIAS : COARSE);
  if (coarse)
    result->reason = SAY(result,
                         "the motion changes much between the times of '%.40s', so that others "
                         "would do as well: measure it more often%s",
                         result->coarse->name, lone ? ", and give more starts" : "");
  strut_fit_verdict verdict = coarse          ? STRUT_FIT_UNDETERMINED
                              : *flaw && !far ? STRUT_FIT_UNEXPLAINED
                                              : STRUT_FIT_DISAGREE;
  for (size_t i = layout->aligned_count; i < layout->parameters; i++) {
    strut_fit_estimate *estimate = &result->estimates[i];
    bool bound = estimate->at_bound && verdict == STRUT_FIT_UNEXPLAINED;
    if (*result->reason && !bound) estimate->verdict = verdict;
    bool none = *result->reason || !isfinite(estimate->error); /* is known: nor is it given */
    if (none) estimate->low = estimate->high = (double)NAN;
  }
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
typedef char quantity_text[STRUT_NUMBER_TEXT + 40];

static const char *write_quantity(double value, const char *unit, quantity_text text) {
  size_t length = strut_number_text(value, text);
  if (*unit && strcmp(unit, "1") != 0)
    snprintf(text + length, sizeof(quantity_text) - length, " %s", unit);
  return text;
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
      strut_buffer_add(&csv, ",");
      strut_csv_add_number(
          &csv, result->correlation[i * n + j] * estimates[i].error * estimates[j].error);
    }
  }
  strut_buffer_add(&csv, "\n");
  return strut_buffer_take(&csv);
}

/* Of the numbers that were measured. */
static char *residuals_csv(const strut_fit_result *result) {
  strut_buffer csv = {0};
  strut_buffer_add(&csv, "match,of,at,measured,predicted,residual\n");
  for (size_t k = 0; k < result->number_count; k++) {
    const strut_fit_number *number = &result->numbers[k];
    const double cells[] = {number->at, number->measured, number->predicted, number->residual};
    if (isnan(number->measured)) continue;
    strut_buffer_add(&csv, "%s,", number->match->name);
    strut_csv_add_text(&csv, "%s", number->series->of);
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
      strut_buffer_add(&csv, ",");
      strut_csv_add_number(&csv, cells[i]);
    }
    strut_buffer_add(&csv, "\n");
  }
  return strut_buffer_take(&csv);
}

static char *fitted_yaml(const strut_fit_result *result, const char *model) {
  strut_buffer text = {0};
  quantity_text value;
  strut_buffer_add(&text, "strut: 1\nbase: %s\nparameters:\n", model);
  for (size_t i = result->aligned_count; i < result->parameters; i++) {
    const strut_fit_estimate *e = &result->estimates[i];
    strut_buffer_add(&text, "  %s: %s # %s\n", e->name, write_quantity(e->value, e->unit, value),
                     verdicts[e->verdict]);
  }
  return strut_buffer_take(&text);
}

/* A study of the fitted model whose parameters are as uncertain as they are, together. */
static char *uncertain_yaml(const strut_fit_result *result) {
  strut_buffer text = {0};
  size_t n = result->variable_count;
  quantity_text value, error;
  strut_buffer_add(&text,
                   "strut: 1\nstudy: Uncertain parameters\nmodel: fitted.yaml\naxes:\n"
                   "  - sample:\n      count: 100\n      over:\n");
  for (size_t i = result->aligned_count; i < result->parameters; i++) {
    const strut_fit_estimate *e = &result->estimates[i];
    strut_buffer_add(&text, "        %s: {normal: [%s, %s]}\n", e->name,
                     write_quantity(e->value, e->unit, value),
                     write_quantity(e->error, e->unit, error));
  }
  strut_buffer_add(&text, "      correlation:\n");
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      strut_buffer_add(&text, j ? ", " : "        - [");
      strut_csv_add_number(&text, i == j ? 1.0 : result->correlation[i * n + j]);
      if (j + 1 == n) strut_buffer_add(&text, "]\n");
    }
  return strut_buffer_take(&text);
}

strut_status strut_fit_write(const strut_fit_result *result, const char *directory,
                             const char *model, strut_error *error) {
  if (!result->found) return STRUT_OK;
  bool certain = strut_fit_is_identified(result);
  const struct {
    const char *name;
    char *text;
  } files[] = {{"fit.csv", strut_values_csv(&strut_fit_values, "parameters", NULL, result, NULL)},
               {"covariance.csv", covariance_csv(result)},
               {"residuals.csv", residuals_csv(result)},
               {"fitted.yaml", fitted_yaml(result, model)},
               {"uncertain.yaml", certain ? uncertain_yaml(result) : NULL}};
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < sizeof files / sizeof *files - !certain; i++)
    if (status)
      strut_release(files[i].text);
    else
      status = strut_file_write_block(directory, files[i].name, files[i].text, error);
  return status;
}
