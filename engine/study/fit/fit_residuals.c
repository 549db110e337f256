/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the model predicts for the numbers of all matches, and by how much it misses them. */
#include <math.h>
#include <string.h>

#include "engine/integrate/integrator.h"
#include "engine/run/simulate.h"
#include "engine/study/fit/fit_parts.h"
#include "engine/study/sweep/sweep.h"

/* Runs are made by a method that controls its error, within this tolerance; derivatives need that. */
static const double TOLERANCE = 1e-8;

/* Steps of differences, and where the method ends, in parts of a parameter's range. */
static const double STEP = 1e-4, NEAR = 1e-6;

/* Part of the time between samples at which the rate of a motion is taken. */
static const double BESIDE = 0.01;

/* Duration of a run that is only wanted where it starts [s]. */
static const double AT_ONCE = 1e-6;

/* The alignments of a match at the parameters. */
typedef struct alignment {
  double number[STRUT_FIT_ALIGNS_COUNT];
  double others; /* factor of numbers that are no coordinates */
} alignment;

static alignment align(const strut_fit_layout *layout, size_t match, const double *parameters) {
  alignment a = {.others = 1.0};
  for (size_t i = 0; i < layout->aligned_count; i++)
    if (layout->aligned[i].match == match)
      a.number[layout->aligned[i].what] = strut_fit_value(layout, i, parameters[i]);
  return a;
}

/* ---- predictions ---- */

/* What one match needs of an evaluation. */
typedef struct prediction {
  strut_fit_case *one;
  const strut_fit_match *match;
  size_t index; /* of the match */
  alignment align;
  strut_study_value *values; /* of all columns of the axes */
} prediction;

/* Notes what must stop everything; else the point just has no residuals. */
static bool settle_status(strut_fit_case *one, strut_status status, const strut_error *error) {
  if (strut_sweep_stops(status)) one->status = status;
  if (status) one->error = *error;
  return status == STRUT_OK;
}

/* The time that the numbers of a match take [s]. */
static double span_of(const strut_fit_match *match) {
  return match->at ? match->at[match->count - 1] - match->at[0] : 0.0;
}

/* Is the number early enough to count? */
static bool is_early(const strut_fit_case *one, const strut_fit_match *match, size_t i) {
  return match->kind != STRUT_FIT_MOTION ||
         match->at[i] <= match->at[0] + one->share * span_of(match);
}

static size_t count_early(const strut_fit_case *one, const strut_fit_match *match) {
  size_t count = match->count;
  while (count > 1 && !is_early(one, match, count - 1)) count--;
  return count;
}

/* By how much samples are beside each other from which a rate is taken [s]. */
static double beside(const strut_fit_match *match) {
  return BESIDE * span_of(match) / (double)match->count;
}

static const strut_quantity_definition *find_quantity(const strut_experiment *experiment,
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
    const strut_quantity_definition *found = find_quantity(experiment, match->series[s].of);
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
  strut_experiment_choose_step(experiment, model->scene);
}

/* Times of the samples of a match, `each` of them for every number; returns how many. */
static size_t place_samples(const prediction *self, size_t each, double *time) {
  const strut_fit_match *match = self->match;
  size_t count = count_early(self->one, match);
  if (!match->at) {
    time[0] = 0.0, time[1] = AT_ONCE;
    return 2;
  }
  double delay = self->align.number[STRUT_FIT_DELAY];
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < each; k++) {
      double t = match->at[i] - delay + ((double)k - (each > 1 ? 1.0 : 0.0)) * beside(match);
      time[i * each + k] = fmax(t, 0.0);
    }
  size_t placed = count * each;
  if (placed == 1) time[placed++] = time[0];
  time[placed - 1] = fmax(time[placed - 1], AT_ONCE);
  return placed;
}

/* Takes the samples of a run, in the order: number, then each, then series. */
static void take_samples(const prediction *self, size_t each, const double *sampled) {
  static const int places[] = {1, 0, 2}; /* before, at, after */
  const strut_fit_match *match = self->match;
  const strut_fit_source *source = self->one->layout->parts[self->index].sources;
  size_t count = match->at ? count_early(self->one, match) : 1;
  for (size_t i = 0; i < count; i++)
    for (size_t s = 0; s < match->series_count; s++)
      for (size_t k = 0; k < each; k++) {
        double value = sampled[(i * each + k) * match->series_count + s];
        self->one->predicted[each > 1 ? places[k] : 0][source[s].first + i] = value;
      }
  for (size_t s = 0; s < match->series_count && !match->at; s++)
    for (size_t i = 1; i < match->count; i++)
      self->one->predicted[0][source[s].first + i] = self->one->predicted[0][source[s].first];
}

/* Runs the model, and samples it. */
static strut_status predict_motion(const prediction *self, strut_setup *setup,
                                   const strut_model *model, strut_error *error) {
  size_t each = self->match->align.delay ? 3 : 1;
  double *time = self->one->buffer, *value = time + 3 * self->match->count + 3;
  strut_run_samples samples = {place_samples(self, each, time), time, value};
  const strut_run_options options = {
      .interrupt = self->one->layout->interrupt,
      .most_evaluations = self->one->layout->plan->study->limit.evaluations,
      .samples = &samples,
      .without_balance = true};
  strut_summary summary = {0};
  double end = time[samples.count - 1];
  if (!choose_quantities(self->match, setup))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "the model measures a quantity of match '%.60s' no more", self->match->name);
  prepare_run(model, end, &setup->experiment);
  strut_status status = strut_simulate(model, &setup->experiment, &options, &summary, error);
  strut_summary_free(&summary);
  if (!status) take_samples(self, each, value);
  return status;
}

static strut_status predict_curve(const prediction *self, strut_setup *setup,
                                  const strut_model *model, strut_error *error) {
  const strut_fit_layout *layout = self->one->layout;
  const strut_fit_source *source = layout->parts[self->index].sources;
  strut_path path = {0};
  setup->experiment.interrupt = layout->interrupt;
  strut_status status =
      strut_statics_path(&layout->parts[self->index].study, setup, model, &path, error);
  for (size_t i = 0; i < self->match->count && !status; i++)
    self->one->predicted[0][source[0].first + i] = strut_goals_force_at(&path, self->match->at[i]);
  strut_path_free(&path);
  for (size_t i = 0; i < self->match->count && !status; i++)
    if (isnan(self->one->predicted[0][source[0].first + i]))
      status =
          strut_fail(error, STRUT_DIVERGED, "the path does not reach %g m", self->match->at[i]);
  return status;
}

/* The scene at the values, compiled where it starts. */
static bool predict_scene(const prediction *self) {
  const strut_fit_layout *layout = self->one->layout;
  const strut_sweep_scenes *scenes = &layout->plan->scenes;
  strut_setup setup;
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = scenes->setup(scenes->context, self->values, &setup, &error);
  if (status) return settle_status(self->one, status, &error);
  status = strut_equilibrium_cache_resolve(layout->standing, &setup, &error);
  if (!status) status = strut_model_compile(&setup.scene, &model, &error);
  if (!status)
    status = (self->match->kind == STRUT_FIT_CURVE ? predict_curve : predict_motion)(self, &setup,
                                                                                     model, &error);
  strut_model_free(model);
  strut_setup_free(&setup);
  return settle_status(self->one, status, &error);
}

static void give_values(const void *context, int64_t point, strut_study_value *values) {
  const prediction *self = context;
  (void)point;
  memcpy(values, self->values, self->one->layout->plan->axis_columns * sizeof *values);
}

/* What a study with the match's `compute` keeps. */
static bool predict_table(const prediction *self) {
  const strut_fit_layout *layout = self->one->layout;
  const strut_fit_source *source = layout->parts[self->index].sources;
  const strut_sweep_options options = {
      .interrupt = layout->interrupt, .values = give_values, .point_context = self};
  strut_arena arena = {0};
  const strut_sweep_worker worker = {&layout->parts[self->index].table, &options, layout->standing,
                                     NULL};
  strut_sweep_job *job = strut_sweep_make_jobs(worker.plan, &arena, 1);
  if (job) strut_sweep_compute(&worker, 0, job);
  strut_status status = !job ? STRUT_NO_MEMORY : job->status ? job->status : job->cells.row.status;
  for (size_t s = 0; s < self->match->series_count && !status; s++)
    for (size_t i = 0; i < self->match->count; i++)
      self->one->predicted[0][source[s].first + i] = job->cells.numbers[source[s].column];
  bool fine = settle_status(self->one, status, job ? &job->error : &(strut_error){0});
  strut_arena_free(&arena);
  return fine;
}

/* Fills what the model predicts at the parameters, unless that is known. */
static bool predict(strut_fit_case *one, const double *parameters) {
  const strut_fit_layout *layout = one->layout;
  const strut_study_fit *fit = layout->fit;
  size_t bytes = layout->parameters * sizeof *parameters;
  if (one->known && memcmp(one->latest, parameters, bytes) == 0) return true;
  strut_study_value *values = strut_allocate(layout->plan->axis_columns + 1, sizeof *values);
  one->known = values != NULL;
  if (!values) one->status = strut_no_memory(&one->error, "");
  for (size_t m = 0; m < fit->match_count && one->known; m++) {
    prediction p = {one, &fit->matches[m], m, align(layout, m, parameters), values};
    if ((int32_t)m == one->left_out) continue;
    strut_fit_fill_values(layout, 0, parameters, values);
    for (size_t k = 0; k < fit->set_count; k++)
      values[fit->column + fit->variable_count + k] = p.match->values[k];
    one->known = p.match->kind == STRUT_FIT_TABLE ? predict_table(&p) : predict_scene(&p);
  }
  strut_release(values);
  memcpy(one->latest, parameters, bytes);
  return one->known;
}

/* ---- residuals ---- */

/* A number of a series, turned and shifted as its match is. */
static double align_number(const strut_fit_source *sources, size_t s, const double *from, size_t i,
                           const alignment *a) {
  const strut_fit_source *source = &sources[s];
  double turn = a->number[STRUT_FIT_ROTATE], own = from[source->first + i];
  if (source->axis < 0) return a->others * own;
  double shift = a->number[source->axis ? STRUT_FIT_SHIFT_Y : STRUT_FIT_SHIFT_X];
  if (source->partner < 0) return own + shift;
  double other = from[sources[source->partner].first + i];
  return own * cos(turn) + (source->axis ? other : -other) * sin(turn) + shift;
}

static void align_match(const strut_fit_layout *layout, size_t m, const double *from,
                        const alignment *a, double *to) {
  const strut_fit_match *match = &layout->fit->matches[m];
  const strut_fit_source *sources = layout->parts[m].sources;
  for (size_t s = 0; s < match->series_count; s++)
    for (size_t i = 0; i < match->count; i++)
      to[sources[s].first + i] = align_number(sources, s, from, i, a);
}

void strut_fit_align_all(const strut_fit_case *one, const double *parameters, double *to) {
  for (size_t m = 0; m < one->layout->fit->match_count; m++) {
    alignment a = align(one->layout, m, parameters);
    align_match(one->layout, m, one->predicted[0], &a, to);
  }
}

void strut_fit_choose(strut_fit_case *one, double share, int32_t left_out) {
  const strut_fit_layout *layout = one->layout;
  double *weight = one->weight;
  one->share = share, one->left_out = left_out;
  one->known = false, one->used = 0;
  for (size_t m = 0; m < layout->fit->match_count; m++) {
    const strut_fit_match *match = &layout->fit->matches[m];
    for (size_t s = 0; s < match->series_count; s++)
      for (size_t i = 0; i < match->count; i++, weight++) {
        const double *of = match->series[s].weights;
        bool counts = (int32_t)m != left_out && !isnan(match->series[s].measured[i]);
        *weight = (of ? sqrt(of[i]) : 1.0) / layout->parts[m].noise;
        if (!counts || !is_early(one, match, i)) *weight = 0.0;
        one->used += *weight > 0.0;
      }
  }
}

static bool find_residuals(void *context, const double *parameters, double *residual) {
  strut_fit_case *one = context;
  one->evaluations++;
  if (one->status || !predict(one, parameters)) return false;
  strut_fit_align_all(one, parameters, residual);
  for (size_t k = 0; k < one->layout->count; k++)
    residual[k] =
        one->weight[k] > 0.0 ? one->weight[k] * (residual[k] - one->layout->measured[k]) : 0.0;
  return true;
}

/* How fast the numbers of a match change with its delay, not aligned. */
static void fill_rates(const strut_fit_case *one, size_t m, double *rate) {
  const strut_fit_match *match = &one->layout->fit->matches[m];
  size_t first = one->layout->parts[m].sources[0].first;
  for (size_t k = first; k < first + match->series_count * match->count; k++)
    rate[k] = (one->predicted[1][k] - one->predicted[2][k]) / (2.0 * beside(match));
}

/* Alignments need no further runs: a turn's derivative is the motion a quarter of a turn further. */
static bool find_derivative(void *context, const double *parameters, size_t i, double *derivative) {
  strut_fit_case *one = context;
  const strut_fit_layout *layout = one->layout;
  const strut_fit_aligned *by = &layout->aligned[i];
  if (i >= layout->aligned_count || one->status || !predict(one, parameters)) return false;
  bool turns = by->what == STRUT_FIT_ROTATE, delays = by->what == STRUT_FIT_DELAY;
  alignment a = align(layout, by->match, parameters);
  a.number[STRUT_FIT_SHIFT_X] = a.number[STRUT_FIT_SHIFT_Y] = 0.0;
  a.number[by->what] += turns ? 1.5707963267948966 : 1.0;
  a.others = delays;
  memset(derivative, 0, layout->count * sizeof *derivative);
  memset(one->buffer, 0, layout->count * sizeof *one->buffer);
  if (delays) fill_rates(one, by->match, one->buffer);
  align_match(layout, by->match, turns ? one->predicted[0] : one->buffer, &a, derivative);
  for (size_t k = 0; k < layout->count; k++)
    derivative[k] = one->weight[k] > 0.0 ? one->weight[k] * derivative[k] * by->scale : 0.0;
  return true;
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
                               .derivative = find_derivative,
                               .context = one};
}

bool strut_fit_case_create(const strut_fit_layout *layout, strut_fit_case *one) {
  strut_arena *arena = &one->arena;
  size_t most = layout->count;
  *one = (strut_fit_case){.layout = layout};
  for (size_t m = 0; m < layout->fit->match_count; m++) {
    size_t count = layout->fit->matches[m].count;
    size_t room = 3 * (count + 1) * (1 + layout->fit->matches[m].series_count);
    if (room > most) most = room;
  }
  one->buffer = strut_arena_allocate(arena, most, sizeof(double));
  one->latest = strut_arena_allocate(arena, layout->parameters, sizeof(double));
  one->weight = strut_arena_allocate(arena, layout->count, sizeof(double));
  for (int k = 0; k < 3; k++)
    one->predicted[k] = strut_arena_allocate(arena, layout->count, sizeof(double));
  bool fine = one->buffer && one->latest && one->weight && one->predicted[0] && one->predicted[1] &&
              one->predicted[2];
  if (fine) strut_fit_choose(one, 1.0, -1);
  return fine;
}

void strut_fit_case_free(strut_fit_case *one) { strut_arena_free(&one->arena); }

/* ---- layout ---- */

static const double MOST_TURN = 6.283185307179586;

/* The number of a column among those of numbers, or -1. */
static int64_t find_number(const strut_sweep_plan *plan, const char *name) {
  int64_t number = 0;
  for (size_t i = 0; i < plan->column_count; i++) {
    if (plan->columns[i].word) continue;
    if (i >= plan->axis_columns && strcmp(plan->columns[i].name, name) == 0) return number;
    number++;
  }
  return -1;
}

/* The place whose coordinate a quantity is, if it is one, and which. */
static int axis_of(const strut_quantity_definition *quantity, strut_column *place) {
  if (!quantity || quantity->length != 1 ||
      quantity->program[0].operation != STRUT_OPERATION_COLUMN)
    return -1;
  *place = quantity->program[0].column;
  switch ((int)place->kind) {
    case STRUT_COLUMN_NODE_X:
    case STRUT_COLUMN_CENTRE_X: return 0;
    case STRUT_COLUMN_NODE_Y:
    case STRUT_COLUMN_CENTRE_Y: place->kind--; return 1;
    default: return -1;
  }
}

static strut_status refuse(strut_fit_layout *layout, size_t m, size_t s, const char *why,
                           strut_error *error) {
  const strut_fit_match *match = &layout->fit->matches[m];
  layout->refused = &match->series[s];
  return strut_fail(error, STRUT_BAD_SCENE, "match '%.60s': '%.80s' %s", match->name,
                    layout->refused->of, why);
}

/* What the series of a match are in the model. */
static strut_status find_sources(strut_fit_layout *layout, size_t m, const strut_setup *setup,
                                 strut_error *error) {
  const strut_fit_match *match = &layout->fit->matches[m];
  strut_fit_source *sources = layout->parts[m].sources =
      strut_arena_allocate(&layout->arena, match->series_count, sizeof *sources);
  strut_column *places = strut_arena_allocate(&layout->arena, match->series_count, sizeof *places);
  if (!sources || !places) return strut_no_memory(error, "");
  for (size_t s = 0; s < match->series_count; s++) {
    const strut_quantity_definition *quantity =
        find_quantity(&setup->experiment, match->series[s].of);
    bool moves = match->kind == STRUT_FIT_MOTION || match->kind == STRUT_FIT_REST;
    int64_t column = match->kind == STRUT_FIT_TABLE
                         ? find_number(&layout->parts[m].table, match->series[s].of)
                         : 0;
    if (column < 0)
      return refuse(layout, m, s, "is no column of numbers of that computation", error);
    bool follows = match->kind != STRUT_FIT_CURVE || setup->experiment.stage_count ||
                   (layout->plan->study->path.over &&
                    strut_coordinate_find(&setup->scene, layout->plan->study->path.over) >= 0);
    if (!follows)
      return refuse(layout, m, s, "needs a 'path' over a coordinate, such as b.y", error);
    const char *unit = moves ? quantity->unit : match->kind == STRUT_FIT_CURVE ? "N" : NULL;
    if (unit && strcmp(unit, match->series[s].unit) != 0)
      return refuse(layout, m, s, "has another unit than its numbers", error);
    sources[s] =
        (strut_fit_source){.first = layout->count, .partner = -1, .column = (size_t)column};
    sources[s].axis = moves ? axis_of(quantity, &places[s]) : -1;
    for (size_t k = 0; k < s && sources[s].axis >= 0; k++)
      if (sources[k].axis == 1 - sources[s].axis && places[k].kind == places[s].kind &&
          places[k].item == places[s].item)
        sources[s].partner = (int32_t)k, sources[k].partner = (int32_t)s;
    memcpy(layout->measured + layout->count, match->series[s].measured,
           match->count * sizeof(double));
    layout->count += match->count;
  }
  for (size_t s = 0; s < match->series_count && match->align.rotate; s++)
    if (sources[s].axis >= 0 && sources[s].partner < 0)
      return refuse(layout, m, s, "cannot be rotated without the other coordinate of the same node",
                    error);
  return STRUT_OK;
}

/* The range of the numbers of a match, which the size of its motions is taken for. */
static double range_of(const strut_fit_match *match) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (size_t s = 0; s < match->series_count; s++)
    for (size_t i = 0; i < match->count; i++) { /* comparisons leave out NANs */
      least = fmin(least, match->series[s].measured[i]);
      most = fmax(most, match->series[s].measured[i]);
    }
  return most > least ? most - least : fmax(fabs(most), 1e-12);
}

/*
 * Turns and delays have a range, as parameters do: by a delay a motion begins no further from the run's start, or from
 * its own first time, than it lasts.
 */
static bool add_aligned(strut_fit_layout *layout, size_t m, strut_fit_aligns what, double start,
                        double scale) {
  static const char *const names[] = {"shift_x", "shift_y", "rotate", "delay"};
  static const char *const units[] = {"m", "m", "rad", "s"};
  const strut_fit_match *match = &layout->fit->matches[m];
  bool delay = what == STRUT_FIT_DELAY;
  const double range[] = {HUGE_VAL, HUGE_VAL, MOST_TURN, scale};
  double from = start - range[what], to = start + range[what];
  if (delay) from = fmin(from, -scale), to = fmax(to, match->at[0] + scale);
  const char *name =
      strut_arena_format(&layout->arena, "%s.%s", layout->fit->matches[m].name, names[what]);
  size_t i = layout->aligned_count++;
  layout->aligned[i] = (strut_fit_aligned){m, what, name, units[what], start, scale, {0.0, 0.0}};
  if (delay || what == STRUT_FIT_ROTATE)
    layout->aligned[i].spread[0] = 0.5 * from, layout->aligned[i].spread[1] = 0.5 * to;
  if (delay) layout->aligned[i].spread[0] = from, layout->aligned[i].spread[1] = to;
  layout->low[i] = 1.0 + from / scale;
  layout->high[i] = 1.0 + to / scale;
  return name != NULL;
}

/* Has a series numbers? A coordinate beside a measured one may have none. */
static bool is_measured(const strut_fit_match *match, size_t s) {
  size_t i = 0;
  while (i < match->count && isnan(match->series[s].measured[i])) i++;
  return i < match->count;
}

static bool add_alignments(strut_fit_layout *layout, size_t m) {
  const strut_fit_match *match = &layout->fit->matches[m];
  bool fine = true;
  double range = range_of(match);
  for (int axis = 0; axis < 2 && match->align.shift; axis++) {
    bool there = false;
    for (size_t s = 0; s < match->series_count; s++)
      there = there || (layout->parts[m].sources[s].axis == axis && is_measured(match, s));
    if (there) fine = add_aligned(layout, m, (strut_fit_aligns)axis, 0.0, range) && fine;
  }
  if (match->align.rotate) fine = add_aligned(layout, m, STRUT_FIT_ROTATE, 0.0, 1.0) && fine;
  if (match->align.delay)
    fine = add_aligned(layout, m, STRUT_FIT_DELAY,
                       match->at[0] >= 0.0 && match->at[0] <= span_of(match) ? 0.0 : match->at[0],
                       span_of(match)) &&
           fine;
  return fine;
}

/* Keeps all columns that the study can have. */
static void keep_all(strut_study *study) {
  const strut_study own = *study;
  study->keep = (strut_keep_set){{0}};
  for (unsigned k = 0; k < STRUT_KEEP_COUNT; k++) {
    bool there = strut_kept_word_at(k)->of >> own.compute & 1u;
    if (k == STRUT_KEEP_STIFFNESS) there = there && own.goal.stiffness_node;
    if (k == STRUT_KEEP_SHAPE) there = there && (own.goal.like || own.goal.shape_count);
    if (k == STRUT_KEEP_CURVE) there = there && own.goal.curve_count;
    if (there) strut_keep_add(&study->keep, k);
  }
}

/* The study that computes the columns of a match, or its path. */
static strut_status make_table(strut_fit_layout *layout, size_t m, strut_error *error) {
  const strut_fit_match *match = &layout->fit->matches[m];
  layout->parts[m].study = *layout->plan->study;
  layout->parts[m].study.compute =
      match->kind == STRUT_FIT_CURVE ? (uint32_t)STRUT_COMPUTE_PATH : match->compute;
  if (match->kind != STRUT_FIT_TABLE) return STRUT_OK;
  keep_all(&layout->parts[m].study);
  return strut_sweep_plan_make(&layout->parts[m].study, &layout->plan->scenes,
                               &layout->parts[m].table, error);
}

static strut_status find_all(strut_fit_layout *layout, strut_error *error) {
  const strut_sweep_plan *plan = layout->plan;
  strut_setup setup;
  strut_study_value *values = strut_allocate(plan->axis_columns + 1, sizeof *values);
  if (!values) return strut_no_memory(error, "");
  strut_grid_values(plan->study, 0, values);
  strut_status status = plan->scenes.setup(plan->scenes.context, values, &setup, error);
  strut_release(values);
  if (status) return status;
  for (size_t m = 0; m < layout->fit->match_count && !status; m++) {
    const strut_fit_match *match = &layout->fit->matches[m];
    status = make_table(layout, m, error);
    if (!status) status = find_sources(layout, m, &setup, error);
    if (!status && !add_alignments(layout, m)) status = strut_no_memory(error, "");
    layout->parts[m].noise = match->noise > 0.0 ? match->noise : range_of(match);
    layout->noise_known = layout->noise_known && match->noise > 0.0;
  }
  strut_setup_free(&setup);
  return status;
}

strut_status strut_fit_layout_make(const strut_sweep_plan *plan, const strut_flag *interrupt,
                                   strut_fit_layout *layout, strut_error *error) {
  const strut_study_fit *fit = plan->study->fit;
  strut_arena *arena = &layout->arena;
  size_t count = 0;
  *layout =
      (strut_fit_layout){.plan = plan, .fit = fit, .interrupt = interrupt, .noise_known = true};
  for (size_t m = 0; m < fit->match_count; m++)
    count += fit->matches[m].count * fit->matches[m].series_count;
  size_t most = STRUT_FIT_ALIGNS_COUNT * fit->match_count, all = most + fit->variable_count;
  layout->aligned = strut_arena_allocate(arena, most, sizeof *layout->aligned);
  layout->parts = strut_arena_allocate(arena, fit->match_count, sizeof *layout->parts);
  layout->measured = strut_arena_allocate(arena, count, sizeof *layout->measured);
  layout->low = strut_arena_allocate(arena, all, sizeof *layout->low);
  layout->high = strut_arena_allocate(arena, all, sizeof *layout->high);
  layout->standing = strut_equilibrium_cache_create();
  if (!layout->aligned || !layout->parts || !layout->measured || !layout->low || !layout->high ||
      !layout->standing)
    return strut_no_memory(error, "");
  strut_status status = find_all(layout, error);
  layout->parameters = layout->aligned_count + fit->variable_count;
  for (size_t k = count; k-- > 0;)
    if (isnan(layout->measured[k])) count--;
  if (!status && count < layout->parameters) {
    layout->refused = fit->matches[0].series;
    status = strut_fail(error, STRUT_BAD_SCENE,
                        "%zu parameters and alignments need as many numbers, found %zu",
                        layout->parameters, count);
  }
  for (size_t i = layout->aligned_count; i < layout->parameters; i++)
    layout->low[i] = 1.0, layout->high[i] = 2.0;
  return status;
}

void strut_fit_layout_free(strut_fit_layout *layout) {
  for (size_t m = 0; layout->fit && layout->parts && m < layout->fit->match_count; m++)
    strut_sweep_plan_free(&layout->parts[m].table);
  strut_equilibrium_cache_free(layout->standing);
  strut_arena_free(&layout->arena);
  *layout = (strut_fit_layout){0};
}
