/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the model predicts for the numbers of all matches, and by how much it misses them. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/integrate/integrator.h"
#include "engine/run/simulate.h"
#include "engine/study/fit/fit_parts.h"
#include "engine/study/sweep/sweep.h"

/* Runs are made by a method that controls its error, within this tolerance; derivatives need that. */
static const double TOLERANCE = STRUT_FIT_EXACT;

/* How often a case computes its model, at most, for each parameter and once more. */
enum { BUDGET = 400 };

/* Steps of differences, and where the method ends, in parts of a parameter's range. */
static const double STEP = 1e-4, NEAR = 1e-6;

/* Where a motion is looked at between two times, which no vibration hides from. */
static const double BETWEEN = 0.382;

/* Duration of a run that is only wanted where it starts [s]. */
static const double AT_ONCE = 1e-6;

/* The numbers of a match's alignment at the parameters. */
static void find_alignment(const strut_fit_layout *layout, size_t match, const double *parameters,
                           double align[STRUT_FIT_ALIGNS_COUNT]) {
  for (int what = 0; what < STRUT_FIT_ALIGNS_COUNT; what++) {
    int32_t i = layout->parts[match].aligned[what];
    align[what] = i < 0 ? 0.0 : strut_fit_value(layout, (size_t)i, parameters[i]);
  }
}

/* ---- predictions ---- */

/* Notes what must stop everything; else the point just has no residuals. */
static bool settle_status(strut_fit_case *one, strut_status status, const strut_error *error) {
  if (strut_sweep_stops(status)) one->status = status;
  if (status) one->error = *error;
  return status == STRUT_OK;
}

double strut_fit_span(const strut_fit_match *match) {
  return match->at ? match->at[match->count - 1] - match->at[0] : 0.0;
}

/* Is the number of a match at this time early enough to count? */
static bool is_early(const strut_fit_case *one, const strut_fit_match *match, double at) {
  return match->kind != STRUT_FIT_MOTION || at <= match->at[0] + one->share * strut_fit_span(match);
}

static size_t count_early(const strut_fit_case *one, const strut_fit_match *match) {
  size_t count = match->count;
  while (count > 1 && match->at && !is_early(one, match, match->at[count - 1])) count--;
  return count;
}

const strut_quantity_definition *strut_fit_quantity(const strut_experiment *experiment,
                                                    const char *name) {
  for (size_t i = 0; i < experiment->quantity_count; i++)
    if (strcmp(experiment->quantities[i].name, name) == 0) return &experiment->quantities[i];
  return NULL;
}

/* Only the quantities of the match, in its order; false: the model measures one of them no more. */
static bool choose_quantities(const strut_fit_match *match, strut_setup *setup) {
  strut_experiment *experiment = &setup->experiment;
  strut_quantity_definition *chosen =
      strut_arena_allocate(&setup->scene.arena, match->series_count, sizeof *chosen);
  for (size_t s = 0; s < match->series_count && chosen; s++) {
    const strut_quantity_definition *found = strut_fit_quantity(experiment, match->series[s].of);
    if (!found) return false;
    chosen[s] = *found;
  }
  experiment->quantities = chosen;
  experiment->quantity_count = match->series_count;
  return chosen != NULL;
}

/* A run of that duration by a method that controls its error, where one can run the model. */
static void prepare_run(const strut_model *model, double duration, strut_experiment *experiment) {
  strut_experiment own = *experiment;
  experiment->duration = duration;
  experiment->periods = experiment->measure_last = experiment->accuracy = 0.0;
  experiment->steady.wanted = false;
  if (!strut_experiment_is_adaptive(experiment->integrator)) {
    experiment->integrator = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
    experiment->tolerance = TOLERANCE;
    experiment->step = 0.0;
    if (strut_integrator_check(model, experiment, NULL))
      experiment->integrator = own.integrator, experiment->step = own.step;
  }
  experiment->tolerance = fmin(experiment->tolerance, TOLERANCE);
  if (experiment->step > duration) experiment->step = 0.0;
  strut_experiment_choose_method(experiment, model->scene);
}

/* Even times that cover all delays. */
static size_t spread_samples(strut_fit_case *one, double *time) {
  const strut_fit_match *match = one->match;
  size_t count = 3 * match->count + 3;
  one->from = fmax(0.0, match->at[0] - one->delay[1]);
  one->to = match->at[count_early(one, match) - 1] - one->delay[0];
  for (size_t i = 0; i < count; i++)
    time[i] = one->from + (one->to - one->from) * (double)i / (double)(count - 1);
  return count;
}

/* Times of the samples of a match, the last after some time, for a run needs some; returns how many. */
static size_t place_samples(const strut_fit_case *one, double *time) {
  const double *at = one->match->at; /* NULL: all are taken where the run starts */
  size_t count = count_early(one, one->match);
  for (size_t i = 0; i < count; i++) {
    double later = at && i + 1 < count ? at[i + 1] - at[i] : 0.0;
    time[i] = at ? fmax(at[i] + one->between * later - one->align[STRUT_FIT_DELAY], 0.0) : 0.0;
  }
  if (!at || count == 1) time[count] = time[count - 1], count++;
  time[count - 1] = fmax(time[count - 1], AT_ONCE);
  return count;
}

/* Takes the samples of a run, in the order: number, series. */
static void take_samples(const strut_fit_case *one, const double *sampled) {
  const strut_fit_match *match = one->match;
  size_t count = count_early(one, match);
  for (size_t i = 0; i < count; i++)
    for (size_t s = 0; s < match->series_count; s++)
      one->predicted[match->series[s].first + i] = sampled[i * match->series_count + s];
}

/* ---- placing ---- */

/* Of so many delays the best is sought; of longer series not every number counts for that. */
enum { MOST_DELAYS = 1000, COUNTED = 2000, RANKS = 40 };

/* Delays are no others if they leave this part of the largest sum. */
static const double ALIKE = 0.5;

/*
 * Finds shift and turn of a match for what is predicted of it; returns the sum of squares that they leave. The turn is
 * the best where both coordinates count alike.
 */
static double place(strut_fit_case *one) {
  const strut_fit_match *match = one->match;
  const strut_fit_source *sources = one->layout->parts[one->index].sources;
  const double *from = one->predicted;
  double *align = one->align;
  double sums[2][4][4] = {{{0.0}}}, q[3][3] = {{0.0}}, rest = 0.0;
  for (size_t s = 0; s < match->series_count; s++)
    for (size_t i = 0; i < match->count; i += 1 + match->count / COUNTED) {
      size_t at = match->series[s].first + i;
      double weight = one->weight[at], measured = one->layout->numbers[at].measured;
      if (!(weight > 0.0)) continue;
      double other =
          sources[s].partner < 0 ? 0.0 : from[match->series[sources[s].partner].first + i];
      const double row[] = {from[at], sources[s].axis ? other : -other, measured, 1.0};
      for (int j = 0; j < 4 && sources[s].axis >= 0; j++)
        for (int k = 0; k < 4; k++)
          sums[sources[s].axis][j][k] += weight * weight * row[j] * row[k];
      if (sources[s].axis < 0) rest += pow(weight * (from[at] - measured), 2.0);
    }
  bool shifts[2];
  for (int axis = 0; axis < 2; axis++) {
    double(*of)[4] = sums[axis];
    shifts[axis] = match->align.shift && of[3][3] > 0.0;
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        q[j][k] += of[j][k] - (shifts[axis] ? of[j][3] * of[k][3] / of[3][3] : 0.0);
  }
  bool turns = match->align.rotate && sums[0][3][3] > 0.0 && sums[1][3][3] > 0.0;
  double turn = turns ? atan2(q[1][2], q[0][2]) : align[STRUT_FIT_ROTATE], sum = rest;
  const double by[] = {cos(turn), sin(turn), -1.0};
  align[STRUT_FIT_ROTATE] = turn;
  for (int axis = 0; axis < 2; axis++) {
    double shift = 0.0;
    for (int j = 0; j < 3; j++) shift -= sums[axis][3][j] * by[j];
    align[axis] = shifts[axis] ? shift / sums[axis][3][3] : 0.0;
  }
  for (int j = 0; j < 3; j++)
    for (int k = 0; k < 3; k++) sum += by[j] * q[j][k] * by[k];
  return sum;
}

/* The numbers of a match delayed so far, of samples (count, series) at even times, and placed. */
static double place_delayed(strut_fit_case *one, double delay, const double *sampled,
                            size_t count) {
  const strut_fit_match *match = one->match;
  size_t n = match->series_count;
  for (size_t i = 0; i < match->count; i += 1 + match->count / COUNTED) {
    double part = (match->at[i] - delay - one->from) / (one->to - one->from);
    double at = (double)(count - 1) * fmin(fmax(part, 0.0), 1.0);
    size_t k = (size_t)fmin(at, (double)(count - 2));
    for (size_t s = 0; s < n; s++)
      one->predicted[match->series[s].first + i] =
          sampled[k * n + s] + (at - (double)k) * (sampled[(k + 1) * n + s] - sampled[k * n + s]);
  }
  one->align[STRUT_FIT_DELAY] = delay;
  return place(one);
}

/*
 * Finds the delay of a match, and what else places it: of those with a least sum nearby, which is not like the largest,
 * the best or a later one. False: there is none.
 */
static bool find_delay(strut_fit_case *one, const double *sampled, size_t count) {
  double low = one->delay[0], high = one->delay[1], most = 0.0;
  size_t delays = 3 * one->match->count < MOST_DELAYS ? 3 * one->match->count : MOST_DELAYS;
  double step = (high - low) / (double)delays, sum[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  double least[RANKS] = {HUGE_VAL}, at[RANKS] = {low};
  size_t ranks = 0, rank = one->elsewhere == (int32_t)one->index ? one->rank : 0;
  for (size_t j = 0; j <= delays + 1; j++) {
    sum[0] = sum[1], sum[1] = sum[2], sum[2] = HUGE_VAL;
    if (j <= delays) sum[2] = place_delayed(one, low + step * (double)j, sampled, count);
    if (isfinite(sum[2])) most = fmax(most, sum[2]);
    if (!(sum[1] < sum[0] && sum[1] <= sum[2])) continue;
    double bend = sum[0] - 2.0 * sum[1] + sum[2];
    double part = isfinite(bend) ? 0.5 * (sum[0] - sum[2]) / bend : 0.0;
    size_t r = ranks < RANKS ? ranks++ : RANKS - 1;
    if (r == RANKS - 1 && ranks == RANKS && least[r] > 0.0 && !(sum[1] < least[r])) continue;
    for (; r > 0 && sum[1] < least[r - 1]; r--) least[r] = least[r - 1], at[r] = at[r - 1];
    least[r] = sum[1], at[r] = low + step * ((double)j - 1.0 + part);
  }
  if (rank && (rank >= ranks || least[rank] > ALIKE * most)) return false;
  place_delayed(one, at[rank], sampled, count);
  return true;
}

/* Runs the model, and samples it. */
static strut_status predict_motion(strut_fit_case *one, strut_setup *setup,
                                   const strut_model *model, strut_error *error) {
  bool delays = one->delay[0] < one->delay[1];
  double *time = one->buffer, *value = time + 3 * one->match->count + 3;
  strut_run_samples samples = {delays ? spread_samples(one, time) : place_samples(one, time), time,
                               value};
  const strut_run_options options = {
      .interrupt = one->layout->interrupt,
      .most_evaluations = one->layout->plan->study->limit.evaluations,
      .samples = &samples,
      .without_balance = true};
  strut_summary summary = {0};
  double end = time[samples.count - 1];
  if (!choose_quantities(one->match, setup))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "the model measures a quantity of match '%.60s' no more", one->match->name);
  prepare_run(model, end, &setup->experiment);
  strut_status status = strut_simulate(model, &setup->experiment, &options, &summary, error);
  strut_summary_free(&summary);
  if (!status && delays && !find_delay(one, value, samples.count))
    return strut_fail(error, STRUT_DIVERGED, "there is no other delay");
  if (!status && !delays) take_samples(one, value);
  return status;
}

static strut_status predict_curve(strut_fit_case *one, strut_setup *setup, const strut_model *model,
                                  strut_error *error) {
  const strut_fit_layout *layout = one->layout;
  strut_path path = {0};
  setup->experiment.interrupt = layout->interrupt;
  strut_status status =
      strut_statics_path(&layout->parts[one->index].study, setup, model, &path, error);
  double end = path.point_count ? path.points[path.point_count - 1].at.factor : 0.0;
  for (size_t i = 0; i < one->match->count && !status; i++) {
    double at = one->match->at[i], force = strut_goals_force_at(&path, at);
    one->predicted[one->match->series[0].first + i] = force;
    if (isnan(force))
      status = strut_fail(error, STRUT_DIVERGED, "the path does not reach %g m; it ends at %g m",
                          at, end);
  }
  strut_path_free(&path);
  return status;
}

/* The scene at the values, compiled where it starts. */
static bool predict_scene(strut_fit_case *one) {
  const strut_fit_layout *layout = one->layout;
  const strut_sweep_scenes *scenes = &layout->plan->scenes;
  strut_setup setup;
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = scenes->setup(scenes->context, one->values, &setup, &error);
  if (status) return settle_status(one, status, &error);
  status = strut_equilibrium_cache_resolve(layout->standing, &setup, &error);
  if (!status) status = strut_model_compile(&setup.scene, &model, &error);
  if (!status)
    status = (one->match->kind == STRUT_FIT_CURVE ? predict_curve : predict_motion)(one, &setup,
                                                                                    model, &error);
  strut_model_free(model);
  strut_setup_free(&setup);
  return settle_status(one, status, &error);
}

static void give_values(const void *context, int64_t point, strut_study_value *values) {
  const strut_fit_case *one = context;
  (void)point;
  memcpy(values, one->values, one->layout->plan->axis_columns * sizeof *values);
}

/* What a study with the match's `compute` keeps. */
static bool predict_table(strut_fit_case *one) {
  const strut_fit_layout *layout = one->layout;
  const strut_fit_source *source = layout->parts[one->index].sources;
  const strut_sweep_options options = {
      .interrupt = layout->interrupt, .values = give_values, .point_context = one};
  strut_arena arena = {0};
  const strut_sweep_worker worker = {&layout->parts[one->index].table, &options, layout->standing,
                                     NULL};
  strut_sweep_job *job = strut_sweep_make_jobs(worker.plan, &arena, 1);
  if (job) strut_sweep_compute(&worker, 0, job);
  strut_status status = !job ? STRUT_NO_MEMORY : job->status ? job->status : job->cells.row.status;
  for (size_t s = 0; s < one->match->series_count && !status; s++)
    for (size_t i = 0; i < one->match->count; i++)
      one->predicted[one->match->series[s].first + i] = job->cells.numbers[source[s].column];
  bool fine = settle_status(one, status, job ? &job->error : &(strut_error){0});
  strut_arena_free(&arena);
  return fine;
}

/* The range of the delay, if it is to be found: all of it, or of a wide one what is about the present delay. */
static void choose_delays(strut_fit_case *one) {
  const strut_fit_layout *layout = one->layout;
  double now = one->align[STRUT_FIT_DELAY], span = strut_fit_span(one->match);
  int32_t i = layout->parts[one->index].aligned[STRUT_FIT_DELAY];
  one->delay[0] = one->delay[1] = 0.0;
  if (i < 0 || !one->placing || !one->delays) return;
  double low = strut_fit_value(layout, (size_t)i, layout->low[i]);
  double high = strut_fit_value(layout, (size_t)i, layout->high[i]);
  bool wide = high - low > (STRUT_FIT_OWN_CLOCK + 3.0) * span;
  one->delay[0] = wide ? fmax(low, now - span) : low;
  one->delay[1] = wide ? fmin(high, now + span) : high;
}

/* Places a match that has been predicted, with the delay that has been found by then. */
static void keep_placing(strut_fit_case *one) {
  const strut_fit_layout *layout = one->layout;
  one->placed_sum += place(one);
  for (int what = 0; what < STRUT_FIT_ALIGNS_COUNT; what++) {
    int32_t i = layout->parts[one->index].aligned[what];
    if (i >= 0) one->placing[i] = strut_fit_parameter(layout, (size_t)i, one->align[what]);
  }
}

/* Do both have the same runs? Shifts and turns need none. */
static bool has_same_runs(const strut_fit_layout *layout, const double *a, const double *b) {
  size_t i = 0;
  while (i < layout->parameters && (a[i] == b[i] || (i < layout->aligned_count &&
                                                     layout->unknowns[i].what != STRUT_FIT_DELAY)))
    i++;
  return i == layout->parameters;
}

/* Fills what the model predicts at the parameters, unless that is known. */
static bool predict(strut_fit_case *one, const double *parameters) {
  const strut_fit_layout *layout = one->layout;
  const strut_study_fit *fit = layout->fit;
  if (one->known && has_same_runs(layout, one->latest, parameters)) return true;
  if (one->evaluations >= one->budget * (int64_t)(layout->parameters + 1)) one->spent = true;
  if (one->spent) return one->known = false;
  one->evaluations++;
  one->known = true;
  for (size_t m = 0; m < fit->match_count && one->known; m++) {
    if ((int32_t)m == one->left_out) continue;
    one->match = &fit->matches[m], one->index = m;
    find_alignment(layout, m, parameters, one->align);
    choose_delays(one);
    strut_fit_fill_values(layout, 0, parameters, one->values);
    for (size_t k = 0; k < fit->set_count; k++)
      one->values[fit->column + fit->variable_count + k] = one->match->values[k];
    one->known = one->match->kind == STRUT_FIT_TABLE ? predict_table(one) : predict_scene(one);
    if (one->known && one->placing) keep_placing(one);
  }
  memcpy(one->latest, parameters, layout->parameters * sizeof *parameters);
  return one->known;
}

/* ---- residuals ---- */

void strut_fit_align_all(const strut_fit_case *one, const double *parameters, double *to) {
  for (size_t m = 0; m < one->layout->fit->match_count; m++) {
    const strut_fit_match *match = &one->layout->fit->matches[m];
    double align[STRUT_FIT_ALIGNS_COUNT];
    find_alignment(one->layout, m, parameters, align);
    double c = cos(align[STRUT_FIT_ROTATE]), s = sin(align[STRUT_FIT_ROTATE]);
    for (size_t k = 0; k < match->series_count; k++) {
      const strut_fit_source *source = &one->layout->parts[m].sources[k];
      bool turns = source->partner >= 0;
      size_t partner = turns ? (size_t)source->partner : k, first = match->series[k].first;
      const double *own = one->predicted + first,
                   *other = one->predicted + match->series[partner].first;
      double across = !turns ? 0.0 : source->axis ? s : -s, along = turns ? c : 1.0;
      double shift = source->axis < 0 ? 0.0 : align[source->axis];
      for (size_t i = 0; i < match->count; i++)
        to[first + i] = along * own[i] + across * other[i] + shift;
    }
  }
}

/* By how much a motion leaves the lines between its numbers; 0: by no more than the noise. */
static double coarseness_of(const strut_fit_match *match, const double *at, const double *between) {
  double missed = 0.0, steps = 0.0, noise = 0.0;
  for (size_t s = 0; s < match->series_count; s++) {
    const double *x = at + match->series[s].first, *y = between + match->series[s].first;
    for (size_t i = 0; i + 1 < match->count; i++) {
      missed += pow(x[i] + BETWEEN * (x[i + 1] - x[i]) - y[i], 2.0);
      steps += pow(x[i + 1] - x[i], 2.0);
      noise += match->noise * match->noise;
    }
  }
  return match->kind == STRUT_FIT_MOTION && missed > noise ? missed / steps : 0.0;
}

const strut_fit_match *strut_fit_find_coarse(strut_fit_case *one, const double *parameters,
                                             const double *at, double *coarseness) {
  const strut_study_fit *fit = one->layout->fit;
  const strut_fit_match *coarse = NULL;
  *coarseness = 0.0;
  one->between = BETWEEN, one->known = false;
  if (predict(one, parameters)) strut_fit_align_all(one, parameters, one->buffer);
  for (size_t m = 0; m < fit->match_count && one->known; m++) {
    double own = coarseness_of(&fit->matches[m], at, one->buffer);
    if (own > *coarseness) *coarseness = own, coarse = &fit->matches[m];
  }
  one->between = 0.0, one->known = false;
  return coarse;
}

void strut_fit_choose(strut_fit_case *one, double share, int32_t left_out) {
  const strut_fit_layout *layout = one->layout;
  one->share = share, one->left_out = left_out;
  one->known = false, one->used = 0;
  for (size_t k = 0; k < layout->count; k++) {
    const strut_fit_number *number = &layout->numbers[k];
    bool counts = (int32_t)(number->match - layout->fit->matches) != left_out &&
                  !isnan(number->measured) && is_early(one, number->match, number->at);
    one->weight[k] = counts ? number->factor : 0.0;
    one->used += one->weight[k] > 0.0;
  }
}

/* Notes the first series with a number that counts, but which the model does not have. */
static bool find_residuals(void *context, const double *parameters, double *residual) {
  strut_fit_case *one = context;
  if (one->status || !predict(one, parameters)) return false;
  strut_fit_align_all(one, parameters, residual);
  for (size_t k = 0; k < one->layout->count; k++) {
    const strut_fit_number *number = &one->layout->numbers[k];
    residual[k] = one->weight[k] > 0.0 ? one->weight[k] * (residual[k] - number->measured) : 0.0;
    if (isfinite(residual[k])) continue;
    one->missing = number->series;
    strut_fail(&one->error, STRUT_DIVERGED, "the model has no '%.60s'", one->missing->of);
    return false;
  }
  return true;
}

double strut_fit_place(strut_fit_case *one, bool delays, int32_t elsewhere, size_t rank,
                       double *parameters) {
  if (!one->layout->aligned_count) return HUGE_VAL;
  one->known = false, one->placing = parameters, one->placed_sum = 0.0;
  one->delays = delays, one->elsewhere = elsewhere, one->rank = rank;
  bool fine = predict(one, parameters);
  one->known = false, one->placing = NULL;
  return fine ? one->placed_sum : HUGE_VAL;
}

strut_least_squares strut_fit_problem(strut_fit_case *one) {
  const strut_fit_layout *layout = one->layout;
  return (strut_least_squares){.count = layout->count,
                               .parameters = layout->parameters,
                               .low = layout->low,
                               .high = layout->high,
                               .step = STEP,
                               .near = NEAR,
                               .held = -1,
                               .most_steps = 60,
                               .residuals = find_residuals,
                               .context = one};
}

bool strut_fit_case_create(const strut_fit_layout *layout, strut_fit_case *one) {
  size_t most = layout->count;
  *one = (strut_fit_case){.layout = layout, .budget = BUDGET};
  for (size_t m = 0; m < layout->fit->match_count; m++) {
    size_t count = layout->fit->matches[m].count;
    size_t room = 3 * (count + 1) * (1 + layout->fit->matches[m].series_count);
    if (room > most) most = room;
  }
  bool fine = STRUT_ALLOCATE(
      &one->arena, STRUT_NEW(one->buffer, most), STRUT_NEW(one->latest, layout->parameters),
      STRUT_NEW(one->values, layout->plan->axis_columns + 1), STRUT_NEW(one->weight, layout->count),
      STRUT_NEW(one->predicted, layout->count));
  if (fine) strut_fit_choose(one, 1.0, -1);
  return fine;
}
