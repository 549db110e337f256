/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/fit/fit.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/fit/fit_parts.h"
#include "engine/study/sweep/sweep.h"

/* Of motions a fit takes so much of the time first; and steps of the method in all but the last of them. */
static const double shares[] = {0.125, 0.25, 0.5, 1.0};
enum { SHARES = sizeof shares / sizeof shares[0], STEPS_FIRST = 20, FEW = 2 };

/* Short motions need not be fitted closer than to this part of the ranges. */
static const double NEAR_FIRST = 1e-3;

/* Share of the time by which motions are placed; a placing is better than a fit if it leaves so much of its sum. */
static const double PLACED = 0.5, BETTER = 0.99;

/*
 * Another fit is within reach of the best if a few steps bring the sum to so many times the least, the first of them to
 * FAR times that; where VAIN are not in a row, no more are tried. A range is walked over in so many paces, unless the
 * sum should rise to FAR times what is within reach in the first.
 */
#define REACH 4.0
#define FAR 25.0
static const double FALL = 0.05; /* of a rise to an end of an interval: it falls */
enum { STEPS_BESIDE = 6, PACES = 16, VAIN = 8 };

/* Budgets of a start, and of what is sought beside where the least sum is so many times that of the noise. */
enum { OF_START = 200, OF_LOST = 30 };
static const double LOST = 1000.0;

/* A fit with the best one's values, but another delay, is kept where no other is this near to it, in parts of the rise. */
static const double HANDICAP = 2.0;

/* An end of a profile is found to this part of its distance; in so many fits, at most. */
static const double FOUND = 0.01;
enum { MOST_FITS = 12 };

/* A value this near to an end of its range, in parts of that, is at the end. */
static const double AT_BOUND = 1e-5;

/* Part of a distribution outside of an interval. */
static const double OUTSIDE = 0.05;

/* Columns of the table behind those of the axes, before the alignments. */
enum { KIND, OF, END, WORDS, SUM = 0, USED, EVALUATIONS, NUMBERS };
enum { START, BESIDE, LOW, HIGH, WITHOUT };
static const char *const kinds[] = {"start", "beside", "low", "high", "without"};
static const char *const columns[] = {"kind", "of", "end", "sum", "used", "evaluations"};

/* A place among the parameters, and the sum there. */
typedef struct place {
  strut_fit_solution is;
  double at[STRUT_LEAST_SQUARES_MOST];
} place;

/* A fit of a study while it is made. */
typedef struct fitting {
  const strut_fit_layout *layout;
  strut_points points;
  int64_t first, count; /* rows of the present stage */
  strut_fit_result *result;
  strut_fit_spectrum spectrum; /* at the best, once it is known */
  place best;
  double rise; /* of the sum to an end of an interval */
} fitting;

/* The match with the k-th free delay. */
static int32_t matches_delay(const strut_study_fit *fit, size_t k) {
  int32_t m = 0;
  for (; !fit->matches[m].align.delay || k; m++) k -= fit->matches[m].align.delay;
  return m;
}

/* ---- one fit ---- */

/* Fits all parameters but `held` (-1: none), in a few steps unless that is 0, which need not end near. */
static void solve(strut_fit_case *one, int32_t held, int32_t steps, place *to) {
  strut_least_squares problem = strut_fit_problem(one);
  problem.held = held;
  if (steps) problem.most_steps = steps, problem.near = NEAR_FIRST;
  problem.one_sided = steps == STEPS_FIRST;
  if (strut_least_squares_solve(&problem, to->at, &to->is))
    one->status = strut_no_memory(&one->error, "");
  if (one->spent) to->is.end = STRUT_FIT_SPENT;
}

/*
 * Fits short motions first, so that long ones begin near, and in the end once more where they are better placed
 * elsewhere.
 */
static void fit_from(strut_fit_case *one, bool delays, place *to) {
  strut_fit_choose(one, PLACED, -1);
  strut_fit_place(one, delays, -1, 0, to->at);
  for (int k = 0; k <= SHARES && !one->status; k++) {
    bool last = k + 1 >= SHARES;
    place placed = *to;
    strut_fit_choose(one, last ? 1.0 : shares[k], -1);
    if (!last && one->used < FEW * one->layout->parameters) continue;
    if (k == SHARES && !(strut_fit_place(one, true, -1, 0, placed.at) < BETTER * to->is.sum)) break;
    *to = placed;
    solve(one, -1, last ? 0 : STEPS_FIRST, to);
    if (one->spent && !last) to->is.sum = HUGE_VAL; /* of short motions alone */
    if (one->spent || to->is.end == STRUT_FIT_FAILED) break;
  }
}

/* The fit of a start, which begins elsewhere where the model cannot be computed there. */
static void fit_start(strut_fit_case *one, int64_t start, place *to) {
  for (int k = 0; k < STRUT_FIT_MOST_PLACES && !one->status; k++) {
    strut_fit_choose_start(one->layout, start + k * one->layout->fit->starts, to->at);
    fit_from(one, start % 4 != 1, to);
    if (one->spent || to->is.end != STRUT_FIT_FAILED) break;
  }
}

/* By how much parameter j changes with i along the least sums, if all are known to be within about their ranges. */
static double slope_of_least(const fitting *self, size_t j, size_t i) {
  const strut_fit_spectrum *spectrum = &self->spectrum;
  double scale = fmin(fmax(self->result->scale, 1e-12), 1e12), common = 0.0, own = 0.0;
  for (size_t k = 0; k < spectrum->parameters; k++) {
    const double *direction = spectrum->direction + k * spectrum->parameters;
    double variance = 1.0 / (spectrum->singular[k] * spectrum->singular[k] + scale * scale);
    common += direction[j] * direction[i] * variance;
    own += direction[i] * direction[i] * variance;
  }
  return common / own;
}

/* How far an end of the interval of parameter i is from the best, by the derivatives. */
static double half_of(const fitting *self, size_t i) {
  return sqrt(self->rise * self->spectrum.covariance[i * self->layout->parameters + i]);
}

/* Adds a step to each parameter, but stays in the box. */
static void step_by(const fitting *self, const double *step, place *to) {
  for (size_t j = 0; j < self->layout->parameters; j++)
    to->at[j] = fmin(fmax(to->at[j] + step[j], self->layout->low[j]), self->layout->high[j]);
}

/*
 * The least sum where one parameter is held at a value. The others begin on the line of least sums; where that does not
 * converge at the best fit, too, and again where the sum is least so far.
 */
static void fit_held(const fitting *self, strut_fit_case *one, size_t i, double value, place *to) {
  double step[STRUT_LEAST_SQUARES_MOST] = {0.0};
  for (int try = 0; try < 3 && !one->status && (!try || to->is.end != STRUT_FIT_CONVERGED); try++) {
    place next = try == 2 ? *to : self->best;
    for (size_t j = 0; j < self->layout->parameters; j++)
      step[j] = try ? 0.0 : (value - self->best.at[i]) * slope_of_least(self, j, i);
    step_by(self, step, &next);
    next.at[i] = value;
    solve(one, (int32_t)i, 0, &next);
    if (!try || next.is.sum <= to->is.sum) *to = next;
  }
}

/*
 * An end of the profile of a parameter, on side -1 or 1: where the least sum has risen enough. Where it has not, or is
 * not known to be the least, there is no end.
 */
static void find_profile_end(const fitting *self, strut_fit_case *one, size_t i, double side,
                             place *to) {
  double bound = side < 0.0 ? self->layout->low[i] : self->layout->high[i];
  double most = fabs(bound - self->best.at[i]), inside = 0.0, outside = HUGE_VAL,
         height_inside = 0.0, distance = half_of(self, i);
  for (int k = 0; k < MOST_FITS && !one->status; k++) {
    distance = fmin(distance, most);
    fit_held(self, one, i, self->best.at[i] + side * distance, to);
    double height = sqrt(fmax(0.0, (to->is.sum - self->best.is.sum) / self->rise)); /* 1: enough */
    if (fabs(height - 1.0) < FOUND || (distance >= most && height < 1.0)) break;
    if (height > 1.0)
      outside = distance;
    else
      inside = distance, height_inside = height;
    double next = inside + (distance - inside) * (1.0 - height_inside) / (height - height_inside);
    if (height <= 1.0) next = distance / fmax(height, 0.2);
    bool between = next > inside && next < outside;
    distance = between ? next : 0.5 * (inside + outside);
    if (!isfinite(distance)) distance = most;
  }
  if (to->is.sum - self->best.is.sum < self->rise * (1.0 - 3.0 * FOUND))
    to->is.end = one->spent ? STRUT_FIT_SPENT : STRUT_FIT_STUCK;
}

/* Fits again from a place beside the best fit, as long as a few steps bring the sum within reach. */
static void fit_again(const fitting *self, strut_fit_case *one, place *to) {
  static const int32_t steps[] = {FEW, STEPS_BESIDE, 0};
  for (int k = 0; k < 3 && !one->status; k++) {
    solve(one, -1, steps[k], to);
    if (!(to->is.sum < (k ? REACH : FAR * REACH) * self->best.is.sum)) break;
  }
}

/*
 * Walks over the range of parameter i, from the best fit to both sides and on from its other end, which of an angle is
 * the same, where the least sum over all others is within reach. Where it falls again another fit is near: the lowest
 * such place, or false.
 */
static bool walk(const fitting *self, strut_fit_case *one, size_t i, place *to) {
  const strut_fit_layout *layout = self->layout;
  double pace = (layout->high[i] - layout->low[i]) / PACES, lowest = HUGE_VAL;
  double reach = REACH * self->best.is.sum, step[STRUT_LEAST_SQUARES_MOST];
  double variance = self->spectrum.covariance[i * layout->parameters + i];
  if (pace * pace > FAR * reach * variance) return false;
  for (double side = -pace; side <= pace; side += 2.0 * pace) {
    place now = self->best;
    double peak = now.is.sum;
    for (size_t j = 0; j < layout->parameters; j++) step[j] = side * slope_of_least(self, j, i);
    for (int k = 1; k <= PACES; k++) {
      place next = now;
      step_by(self, step, &next);
      if (next.at[i] == now.at[i]) next.at[i] = side < 0.0 ? layout->high[i] : layout->low[i];
      solve(one, (int32_t)i, STEPS_BESIDE, &next);
      if (one->status || !(next.is.sum < reach)) break;
      for (size_t j = 0; j < layout->parameters; j++)
        step[j] = j == i ? side : next.at[j] - now.at[j];
      now = next;
      peak = fmax(peak, now.is.sum);
      if (peak - now.is.sum < FALL * self->rise || now.is.sum > lowest) continue;
      lowest = now.is.sum;
      *to = now;
    }
  }
  return lowest < HUGE_VAL;
}

/* Has a fit those of the best one's parameters from `first` on, up to their intervals? */
static bool is_best(const fitting *self, const place *found, size_t first) {
  bool same = true;
  for (size_t i = first; i < self->layout->parameters; i++)
    same = same && fabs(found->at[i] - self->best.at[i]) <= half_of(self, i);
  return same;
}

/* Another fit beside the best one: along a variable, or the least from the next best delays of a match. */
static void fit_beside(const fitting *self, strut_fit_case *one, size_t item, place *to) {
  const strut_study_fit *fit = self->layout->fit;
  size_t first = self->layout->aligned_count;
  bool delay = item >= fit->variable_count;
  int32_t match = delay ? matches_delay(fit, item - fit->variable_count) : -1;
  double least = HUGE_VAL;
  memcpy(to->at, self->best.at, sizeof to->at);
  for (int rank = 1, vain = 0; !one->status && vain < VAIN && (delay || rank == 1); rank++) {
    place next = self->best;
    if (delay ? !(strut_fit_place(one, true, match, (size_t)rank, next.at) < HUGE_VAL)
              : !walk(self, one, first + item, &next))
      break;
    fit_again(self, one, &next);
    vain = next.is.sum < REACH * self->best.is.sum ? 0 : vain + 1;
    double sum = next.is.sum + (is_best(self, &next, first) ? HANDICAP * self->rise : 0.0);
    if (!(sum < least) || is_best(self, &next, 0)) continue;
    least = sum;
    *to = next;
  }
}

/* ---- rows ---- */

/* What row is which fit. */
typedef struct row_kind {
  int kind;         /* of `kinds` */
  size_t item;      /* start, variable, match, or what is beside */
  const char *name; /* of the variable or match */
} row_kind;

static row_kind kind_of(const strut_study_fit *fit, int64_t row) {
  size_t variables = fit->variable_count, i = (size_t)row, stage = 0;
  const size_t counts[] = {(size_t)fit->starts, STRUT_FIT_ROUNDS * fit->beside_count, 2 * variables,
                           fit->omission_count};
  while (i >= counts[stage]) i -= counts[stage++];
  if (stage == 0) return (row_kind){START, i, ""};
  if (stage == 2) return (row_kind){i % 2 ? HIGH : LOW, i / 2, fit->variables[i / 2].name};
  if (stage == 3) return (row_kind){WITHOUT, i, fit->matches[i].name};
  i %= fit->beside_count;
  return (row_kind){BESIDE, i,
                    i < variables ? fit->variables[i].name
                                  : fit->matches[matches_delay(fit, i - variables)].name};
}

static bool is_lost(const fitting *self) {
  return self->layout->noise_known && self->best.is.sum > LOST * fmax(self->result->freedom, 1.0);
}

static void fit_row(const fitting *self, strut_fit_case *one, row_kind what, place *to) {
  if (what.kind == START) one->budget = OF_START;
  if (what.kind == BESIDE && is_lost(self)) one->budget = OF_LOST;
  if (what.kind == START) {
    fit_start(one, (int64_t)what.item, to);
  } else if (what.kind == BESIDE) {
    fit_beside(self, one, what.item, to);
  } else if (what.kind != WITHOUT) {
    find_profile_end(self, one, self->layout->aligned_count + what.item,
                     what.kind == LOW ? -1.0 : 1.0, to);
  } else {
    strut_fit_choose(one, 1.0, (int32_t)what.item);
    memcpy(to->at, self->best.at, sizeof to->at);
    if (one->used >= self->layout->parameters) solve(one, -1, 0, to);
  }
  if (one->spent && to->is.end == STRUT_FIT_NONE) to->is.end = STRUT_FIT_SPENT;
}

static void compute_row(void *context, strut_sweep_job *job, int64_t point) {
  const fitting *self = context;
  const strut_fit_layout *layout = self->layout;
  strut_row_buffer *cells = &job->cells;
  strut_fit_case one;
  place found = {.is = {STRUT_FIT_NONE, (double)NAN}};
  row_kind what = kind_of(layout->fit, point);
  job->point = point;
  cells->number_count = cells->word_count = 0;
  cells->message[0] = '\0';
  job->warning_count = 0;
  if (!strut_fit_case_create(layout, &one)) one.status = strut_no_memory(&one.error, "");
  if (!one.status) fit_row(self, &one, what, &found);
  job->status = one.status, job->error = one.error;
  if (!job->status) {
    strut_fit_fill_values(layout, point, found.at, cells->values);
    strut_sweep_axes(layout->plan, cells->values, cells);
    strut_sweep_word(cells, kinds[what.kind]);
    strut_sweep_word(cells, what.name);
    strut_sweep_word(cells, strut_fit_ends[found.is.end]);
    strut_sweep_number(cells, found.is.sum);
    strut_sweep_number(cells, (double)one.used);
    strut_sweep_number(cells, (double)one.evaluations);
    for (size_t i = 0; i < layout->aligned_count; i++)
      strut_sweep_number(cells, strut_fit_value(layout, i, found.at[i]));
    strut_sweep_end_row(cells, STRUT_OK, found.is.end == STRUT_FIT_FAILED ? &one.error : NULL);
  }
  strut_arena_free(&one.arena);
}

/* Reads a row back; one that was not needed is empty. */
static void read_row(const fitting *self, int64_t point, strut_fit_row *row) {
  const strut_fit_layout *layout = self->layout;
  const strut_sweep_plan *plan = layout->plan;
  strut_result_slot slot;
  *row = (strut_fit_row){.end = STRUT_FIT_NONE, .sum = (double)NAN};
  for (size_t i = 0; i < layout->parameters; i++) row->values[i] = (double)NAN;
  if (!strut_slots_get(self->points.slots, point, &slot)) return;
  size_t first = plan->axis_columns, own = strut_slot_place(plan->columns, layout->fit->column);
  const double *numbers = slot.numbers + strut_slot_place(plan->columns, first + WORDS);
  const char *end = slot.words[strut_slot_place(plan->columns, first + END)];
  for (int k = 0; k < STRUT_FIT_END_COUNT; k++)
    if (strcmp(end, strut_fit_ends[k]) == 0) row->end = (strut_fit_end)k;
  row->sum = numbers[SUM];
  row->used = (int64_t)numbers[USED], row->evaluations = (int64_t)numbers[EVALUATIONS];
  for (size_t i = 0; i < layout->parameters; i++)
    row->values[i] = i < layout->aligned_count ? numbers[NUMBERS + i]
                                               : slot.numbers[own + i - layout->aligned_count];
}

strut_status strut_fit_add_columns(strut_sweep_plan *plan, strut_fit_refusal *refusal,
                                   strut_error *error) {
  strut_fit_layout layout = {0};
  strut_status status = strut_fit_layout_make(plan, NULL, &layout, error);
  *refusal = layout.refused;
  bool fine = !status;
  if (fine) plan->column_count = plan->axis_columns;
  for (size_t i = 0; i < WORDS + NUMBERS && fine; i++)
    fine = strut_sweep_add_column(plan, "", columns[i], "1", i < WORDS);
  for (size_t i = 0; i < layout.aligned_count && fine; i++)
    fine =
        strut_sweep_add_column(plan, "", layout.unknowns[i].name, layout.unknowns[i].unit, false);
  if (!status && !fine) status = strut_no_memory(error, "");
  strut_fit_layout_free(&layout);
  return status;
}

/* ---- stages ---- */

static bool choose_row(void *context, int64_t i, int64_t *point) {
  const fitting *self = context;
  *point = self->first + i;
  return !strut_slots_done(self->points.slots, *point) &&
         strut_slots_claim(self->points.slots, *point);
}

/* Rows that are looked at: all of the stage until none is left. */
static int64_t count_rows(void *context) {
  const fitting *self = context;
  for (int64_t i = 0; i < self->count; i++)
    if (!strut_slots_done(self->points.slots, self->first + i)) return self->count;
  return 0;
}

/* Computes rows from `first` on, or waits until other workers have, unless they are not needed; and reads them. */
static strut_status run_stage(fitting *self, size_t first, size_t count, bool needed) {
  self->first = (int64_t)first, self->count = (int64_t)count;
  strut_status status = needed ? strut_points_complete(&self->points, count_rows) : STRUT_OK;
  for (size_t i = first; i < first + count && !status; i++)
    read_row(self, (int64_t)i, &self->result->starts[i]);
  return status;
}

/* ---- what the best fit says ---- */

/* Describes the best fit: derivatives, numbers, how coarse its times are. Or why the first start has no residuals. */
static strut_status describe(fitting *self, strut_fit_case *one) {
  const strut_fit_layout *layout = self->layout;
  strut_fit_result *result = self->result;
  strut_error *error = self->points.error;
  strut_least_squares problem = strut_fit_problem(one);
  double *residual, *predicted, *jacobian, *at = self->best.at;
  size_t count = result->number_count = layout->count;
  result->numbers =
      strut_arena_copy(&result->arena, layout->numbers, count, sizeof *result->numbers);
  if (!result->numbers ||
      !STRUT_ALLOCATE(&one->arena, STRUT_NEW(residual, count), STRUT_NEW(predicted, count),
                      STRUT_NEW(jacobian, count * layout->parameters + 1)))
    return strut_no_memory(error, "");
  if (!result->found) {
    strut_fit_choose_start(layout, 0, at);
    problem.residuals(one, at, residual);
    result->missing = one->missing;
    result->reason = strut_arena_format(&result->arena, "%s", one->error.message);
    return result->reason ? STRUT_OK : strut_no_memory(error, "");
  }
  bool fine = strut_least_squares_jacobian(&problem, at, residual, jacobian) &&
              strut_fit_spectrum_find(jacobian, count, layout->parameters, &result->arena,
                                      &self->spectrum) &&
              problem.residuals(one, at, residual);
  if (fine) strut_fit_align_all(one, at, predicted);
  if (fine) result->coarse = strut_fit_find_coarse(one, at, predicted, &result->coarseness);
  if (one->status) return strut_fail(error, one->status, "%s", one->error.message);
  for (size_t k = 0; k < count; k++)
    result->numbers[k].predicted = predicted[k], result->numbers[k].residual = residual[k];
  return fine ? STRUT_OK
              : strut_fail(error, STRUT_DIVERGED,
                           "the model cannot be computed beside the best fit");
}

/* The best of the first `count` fits, its scale of errors, and the rise of the sum at the ends of intervals. */
static strut_status find_best(fitting *self, size_t count) {
  const strut_fit_layout *layout = self->layout;
  strut_fit_result *result = self->result;
  size_t before = result->found ? result->best : SIZE_MAX;
  strut_fit_case one;
  for (size_t i = 0; i < count; i++) {
    double least = result->found ? self->best.is.sum : HUGE_VAL;
    if (i >= result->start_count) least -= FALL * self->rise;
    const strut_fit_row *row = &result->starts[i];
    if (row->end == STRUT_FIT_FAILED || !isfinite(row->sum) || !(row->sum < least)) continue;
    result->best = i, result->found = true, self->best.is.sum = row->sum;
  }
  const strut_fit_row *best = &result->starts[result->best];
  if (result->best == before || (!result->found && count > result->start_count)) return STRUT_OK;
  double freedom = (double)best->used - (double)result->parameters, variance = HUGE_VAL, t = 1.0;
  if (freedom > 0.0) {
    t = gsl_cdf_tdist_Pinv(1.0 - 0.5 * OUTSIDE, freedom);
    variance = fmax(best->sum / freedom, STRUT_FIT_EXACT * STRUT_FIT_EXACT);
  }
  for (size_t i = 0; i < layout->parameters; i++)
    self->best.at[i] = strut_fit_parameter(layout, i, best->values[i]);
  self->rise = layout->noise_known ? gsl_cdf_chisq_Pinv(1.0 - OUTSIDE, 1.0) : t * t * variance;
  result->freedom = freedom;
  result->scale = layout->noise_known ? 1.0 : sqrt(variance);
  strut_status status = strut_fit_case_create(layout, &one)
                            ? describe(self, &one)
                            : strut_no_memory(self->points.error, "");
  strut_arena_free(&one.arena);
  return status;
}

/* Value, error and interval of a parameter. */
static void fill_estimate(fitting *self, size_t i) {
  const strut_fit_layout *layout = self->layout;
  strut_fit_result *result = self->result;
  const strut_fit_unknown *of = &layout->unknowns[i];
  size_t n = layout->parameters, first = layout->aligned_count;
  const double *covariance = self->spectrum.covariance;
  double at = self->best.at[i], slope = fabs(strut_fit_slope(layout, i, at));
  double error = sqrt(covariance[i * n + i]), value = strut_fit_value(layout, i, at);
  double half = slope * error * sqrt(self->rise);
  double range =
      strut_fit_value(layout, i, layout->high[i]) - strut_fit_value(layout, i, layout->low[i]);
  strut_fit_estimate *estimate = &result->estimates[i];
  *estimate = (strut_fit_estimate){.name = strut_arena_format(&result->arena, "%s", of->name),
                                   .unit = strut_arena_format(&result->arena, "%s", of->unit),
                                   .value = value,
                                   .also = (double)NAN,
                                   .error = slope * error * result->scale,
                                   .low = value - half,
                                   .high = value + half,
                                   .linear_low = value - half,
                                   .linear_high = value + half,
                                   .verdict = STRUT_FIT_IDENTIFIED};
  if (!(estimate->error < range)) estimate->error = HUGE_VAL;
  for (size_t j = first; j < n && i >= first; j++)
    result->correlation[(i - first) * result->variable_count + j - first] =
        covariance[i * n + j] / (error * sqrt(covariance[j * n + j]));
  for (size_t side = 0; side < 2 && i >= first; side++) {
    const strut_fit_row *end = &result->ends[2 * (i - first) + side];
    *(side ? &estimate->high : &estimate->low) =
        end->end == STRUT_FIT_CONVERGED ? end->values[i] : (double)NAN;
  }
  if (!isfinite(estimate->low + estimate->high + estimate->error))
    estimate->verdict = STRUT_FIT_UNDETERMINED;
  estimate->at_bound = i >= first && fmin(at - layout->low[i], layout->high[i] - at) < AT_BOUND;
  if (estimate->at_bound) estimate->verdict = STRUT_FIT_BOUND;
  if (!estimate->name || !estimate->unit) result->out_of_memory = true;
}

static void fill_estimates(fitting *self) {
  strut_fit_result *result = self->result;
  size_t n = self->layout->parameters, variables = result->variable_count;
  result->out_of_memory = !STRUT_ALLOCATE(&result->arena, STRUT_NEW(result->estimates, n),
                                          STRUT_NEW(result->correlation, variables * variables));
  for (size_t i = 0; i < n && !result->out_of_memory; i++) fill_estimate(self, i);
  if (!result->out_of_memory) strut_fit_judge(self->layout, &self->spectrum, result);
}

/* ---- all of it ---- */

static strut_status run_stages(fitting *self) {
  const strut_study_fit *fit = self->layout->fit;
  strut_fit_result *result = self->result;
  size_t starts = result->start_count, beside = fit->beside_count;
  size_t profiles = 2 * fit->variable_count, ends = starts + STRUT_FIT_ROUNDS * beside;
  result->starts = strut_arena_allocate(&result->arena, ends + profiles + fit->omission_count,
                                        sizeof *result->starts);
  if (!result->starts) return strut_no_memory(self->points.error, "");
  result->ends = result->starts + ends;
  result->omissions = result->ends + profiles;
  strut_status status = run_stage(self, 0, starts, true);
  if (!status) status = find_best(self, starts);
  for (int round = 0; round < STRUT_FIT_ROUNDS && !status && !result->settled; round++) {
    if (round && is_lost(self)) break;
    size_t best = result->best, all = starts + result->beside_count;
    status = run_stage(self, all, beside, result->found);
    result->beside_count += beside;
    if (!status) status = find_best(self, all + beside);
    result->settled = result->best == best;
  }
  if (!status && result->found) strut_fit_find_flaw(self->layout, result);
  bool holds = !status && result->found && !result->out_of_memory && !*result->reason;
  if (!status) status = run_stage(self, ends, profiles, holds);
  if (!status) status = run_stage(self, ends + profiles, fit->omission_count, result->found);
  if (!status && result->found && !result->out_of_memory) fill_estimates(self);
  return result->out_of_memory ? strut_no_memory(self->points.error, "") : status;
}

strut_status strut_fit_run(const strut_sweep_plan *plan, strut_slots *slots,
                           const strut_sweep_options *options, strut_sweep_state *state,
                           strut_fit_result *result, strut_error *error) {
  strut_arena arena = {0};
  strut_fit_layout layout = {0};
  const strut_study_fit *fit = plan->study->fit;
  fitting self = {.layout = &layout,
                  .result = result,
                  .points = {.slots = slots,
                             .state = state,
                             .error = error,
                             .context = &self,
                             .choose = choose_row,
                             .compute = compute_row,
                             .shared = options->workers > 0}};
  *result = (strut_fit_result){.fit = fit, .plan = plan, .start_count = (size_t)fit->starts};
  strut_points_begin(&self.points);
  strut_status status = strut_fit_layout_make(plan, options->interrupt, &layout, error);
  result->parameters = layout.parameters, result->aligned_count = layout.aligned_count;
  result->variable_count = fit->variable_count;
  if (!status) status = strut_points_open(&self.points, plan, options, &arena);
  if (!status) status = run_stages(&self);
  strut_points_close(&self.points);
  strut_fit_layout_free(&layout);
  strut_arena_free(&arena);
  if (!self.points.status) self.points.status = status;
  return strut_points_end(&self.points);
}
