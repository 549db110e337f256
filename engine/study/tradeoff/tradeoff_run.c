/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs of a setting and their costs; the settings of a method from coarse to fine. */
#include <math.h>
#include <string.h>
#include <time.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/run/simulate.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

/* CPU time of steps from which that of an evaluation is known [s]. */
static const double LEAST_KNOWN = 0.1;

void *strut_tradeoff_allocate(tradeoff_study *study, size_t count, size_t size) {
  void *array = strut_arena_allocate(&study->result->arena, count, size);
  if (!array) study->status = strut_no_memory(study->error, "");
  return array;
}

double strut_tradeoff_cpu_clock(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double strut_tradeoff_work_left(const tradeoff_study *study, double share) {
  return share * STRUT_TRADEOFF_MOST_WORK * study->result->work_unit - study->result->work;
}

bool strut_tradeoff_has_time(tradeoff_study *study, double evaluations) {
  bool is_known = study->stepping > LEAST_KNOWN;
  double needed = is_known ? evaluations * study->stepping / study->result->work : 0;
  if (strut_tradeoff_cpu_clock() - study->began + needed > study->budget) study->result->cut = true;
  return !study->result->cut;
}

bool strut_tradeoff_is_adaptive(const strut_integrator *method) {
  return strut_experiment_is_adaptive(method->name);
}

double strut_tradeoff_fit_step(const tradeoff_study *study, size_t point, double step) {
  strut_span span = study->points[point].span;
  double turns = span.period > 0 ? span.duration / span.period : 0;
  bool whole = turns > 0.5 && fabs(turns - round(turns)) < 1e-9 * turns;
  double unit = whole ? span.period : span.duration;
  return unit / ceil(unit / step * (1 - 1e-9));
}

double strut_tradeoff_planned(const tradeoff_study *study, size_t point, tradeoff_setting setting) {
  double steps =
      study->points[point].span.duration / strut_tradeoff_fit_step(study, point, setting.step);
  return round(steps) * setting.method->evaluations;
}

double strut_tradeoff_planned_at_all(const tradeoff_study *study, tradeoff_setting setting) {
  double planned = 0;
  for (size_t p = 0; p < study->result->point_count; p++)
    planned += strut_tradeoff_planned(study, p, setting);
  return planned;
}

/* A sink that measures the CPU time of the stepping alone. */
static strut_status begin_clock(void *context, const strut_record_layout *layout,
                                strut_error *error) {
  (void)layout, (void)error;
  *(double *)context = strut_tradeoff_cpu_clock();
  return STRUT_OK;
}

static strut_status end_clock(void *context, strut_status status, strut_error *error) {
  (void)status, (void)error;
  *(double *)context = strut_tradeoff_cpu_clock() - *(double *)context;
  return STRUT_OK;
}

static void take_values(const tradeoff_study *study, const strut_summary *summary, double *value) {
  switch (study->result->measure) {
    case STRUT_TRADEOFF_POSITION:
      memcpy(value, summary->end.positions, 2 * summary->end.node_count * sizeof *value);
      break;
    case STRUT_TRADEOFF_ENERGY:
      value[0] = summary->energy.moved > 0 ? summary->energy.residual / summary->energy.moved : 0;
      break;
    case STRUT_TRADEOFF_AUTOMATIC:
    case STRUT_TRADEOFF_VELOCITY: value[0] = summary->velocity; break;
  }
}

/*
 * Where nothing vibrates, as for rigid bars swinging under gravity, the stability limit may exceed
 * the duration: then a part of the duration counts.
 */
bool strut_tradeoff_limit(tradeoff_study *study, int variant, const strut_integrator *method,
                          double *limit) {
  const strut_model *model = NULL;
  strut_experiment e = study->points[0].experiment;
  e.integrator = method->name;
  *limit = HUGE_VAL;
  strut_status status = strut_tradeoff_compile(study, 0, variant, &model);
  if (!status) status = strut_integrator_check(model, &e, study->error);
  if (!status) status = strut_step_limit_for_method(model, method, limit, study->error);
  if (isfinite(*limit)) *limit = fmin(*limit, study->points[0].longest);
  if (status == STRUT_NO_MEMORY) study->status = status;
  return !status;
}

tradeoff_outcome strut_tradeoff_run(tradeoff_study *study, size_t point, int variant,
                                    tradeoff_setting setting, double *value) {
  tradeoff_outcome outcome = {.seconds = (double)NAN};
  const strut_model *model = NULL;
  strut_summary summary = {0};
  strut_sink clock = {&outcome.seconds, begin_clock, NULL, end_clock, STRUT_CHANNEL_POSITION};
  strut_sink *sinks[] = {&clock};
  const strut_run_options options = {.force = true,
                                     .interrupt = study->options->interrupt,
                                     .sinks = sinks,
                                     .sink_count = 1,
                                     .most_evaluations = (int64_t)study->allowed};
  strut_experiment e = study->points[point].experiment;
  e.integrator = setting.method->name;
  e.step = strut_tradeoff_fit_step(study, point, setting.step);
  if (isfinite(setting.tolerance)) e.tolerance = setting.tolerance;
  e.refine = isfinite(setting.refine) ? setting.refine : 1;
  e.output_every = study->points[point].span.duration;
  for (size_t i = 0; i < study->result->value_count; i++) value[i] = (double)NAN;
  if (study->status) return outcome;
  strut_status status = strut_tradeoff_compile(study, point, variant, &model);
  if (!status) status = strut_simulate(model, &e, &options, &summary, study->error);
  outcome.evaluations = (double)summary.spent.evaluations;
  study->result->work += outcome.evaluations;
  if (isfinite(outcome.seconds)) study->stepping += outcome.seconds;
  outcome.cannot = status == STRUT_USAGE || status == STRUT_BAD_SCENE || status == STRUT_SINGULAR;
  outcome.cut = status == STRUT_WORK_LIMIT;
  outcome.good = !status;
  if (!status) take_values(study, &summary, value);
  strut_summary_free(&summary);
  if (status == STRUT_INTERRUPTED || status == STRUT_NO_MEMORY) study->status = status;
  return outcome;
}

double strut_tradeoff_distance(const tradeoff_study *study, size_t point, const double *value,
                               const double *reference) {
  double most = 0;
  size_t count = study->result->value_count;
  if (study->result->measure == STRUT_TRADEOFF_POSITION) {
    for (size_t i = 0; i + 1 < count; i += 2) {
      double d = hypot(value[i] - reference[i], value[i + 1] - reference[i + 1]) /
                 study->points[point].size;
      if (!(d <= most)) most = d;
    }
  } else if (study->result->measure == STRUT_TRADEOFF_ENERGY) {
    most = fabs(value[0] - reference[0]);
  } else {
    most = fabs(value[0] - reference[0]) / fmax(fabs(reference[0]), study->points[point].scale);
  }
  return isfinite(most) ? most : HUGE_VAL;
}

/* ---- rows: the settings of a method from coarse to fine ---- */

enum { ABOVE = 3, LOOKED_AT = 5, MOST_TOLERANCES = 13, CONFIRMED = 3 };
static const double BELOW = 0.95, IN_DECADE = 5;
/* Cost of a tenth of the tolerance, of order 5. */
static const double TENTH = 1.6;
/*
 * Series without a stability limit start at this multiple of the explicit limit, or of the base's
 * step.
 */
static const double FREE = 100, FREE_OF_BASE = 10;
static const double above[ABOVE] = {2.5, 1.5, 1.1};

static int step_count(const tradeoff_study *study) {
  if (study->options->steps > 0) return study->options->steps;
  return study->options->accuracy > 0 ? STRUT_TRADEOFF_MOST_STEPS : STRUT_TRADEOFF_USUAL_STEPS;
}

/* ---- rows ---- */

static strut_tradeoff_row *new_row(tradeoff_study *study, const step_series *from,
                                   tradeoff_setting setting) {
  strut_tradeoff *tradeoff = study->result;
  const size_t points = tradeoff->point_count;
  if (!strut_grow(&tradeoff->rows, &study->row_capacity, tradeoff->row_count,
                  sizeof *tradeoff->rows)) {
    study->status = strut_no_memory(study->error, "");
    return NULL;
  }
  strut_tradeoff_row *row = &tradeoff->rows[tradeoff->row_count];
  setting.step = strut_tradeoff_fit_step(study, 0, setting.step);
  *row = (strut_tradeoff_row){.variant = from->variant,
                              .group = from->group,
                              .setting = setting,
                              .cpu = (double)NAN,
                              .seconds = (double)NAN};
  row->value =
      strut_tradeoff_allocate(study, points * (tradeoff->value_count + 3), sizeof *row->value);
  if (!row->value) return NULL;
  row->forces = row->value + points * tradeoff->value_count;
  row->error = row->forces + points;
  row->total = row->error + points;
  tradeoff->row_count++;
  return row;
}

/*
 * Runs a setting at every point as a new row; NULL: its method cannot run it, or the bound on
 * work ends the run, and with it the series.
 */
static strut_tradeoff_row *run_row(tradeoff_study *study, step_series *from,
                                   tradeoff_setting setting, double most) {
  strut_tradeoff *tradeoff = study->result;
  double began = tradeoff->work;
  tradeoff_outcome outcome = {.good = false};
  strut_tradeoff_row *row = new_row(study, from, setting);
  size_t finished = 0;
  for (size_t p = 0; p < tradeoff->point_count && !study->status && !outcome.cannot && !outcome.cut;
       p++) {
    study->allowed = fmax(1, most - (tradeoff->work - began));
    outcome =
        strut_tradeoff_run(study, p, row->variant, setting, row->value + p * tradeoff->value_count);
    row->forces[p] = outcome.good ? outcome.evaluations : (double)NAN;
    row->diverged += !outcome.good;
    if (outcome.good) study->spare[finished++] = outcome.seconds;
  }
  study->allowed = 0;
  if (study->status) return NULL;
  row->seconds = strut_spread_of(study->spare, finished, study->scratch).median;
  row->above = from->limited && setting.step > from->first.step;
  from->last_cost = tradeoff->work - began;
  if (outcome.cut) from->over = true, tradeoff->left_out++;
  if (!outcome.cannot && !outcome.cut) return row;
  tradeoff->row_count--;
  return NULL;
}

/* ---- series of steps ---- */

/* The k-th setting of a series, the coarsest first. False after the last. */
static bool setting_at(const tradeoff_study *study, const step_series *self, int k,
                       tradeoff_setting *setting) {
  bool adaptive = strut_tradeoff_is_adaptive(self->first.method);
  int extra = self->limited && !(study->options->accuracy > 0) ? ABOVE : 0;
  if (k >= step_count(study) + (adaptive ? 0 : ABOVE) || (adaptive && k >= MOST_TOLERANCES))
    return false;
  *setting = self->first;
  if (adaptive)
    setting->tolerance = 1.0 / pow(10.0, k + 2); /* as its decimal text */
  else if (k < extra)
    setting->step *= above[k];
  else
    setting->step *= BELOW * pow(10, -(k - extra) / IN_DECADE);
  return true;
}

static step_series *add_series(tradeoff_study *study, step_series_list *all, int variant,
                               tradeoff_setting first, bool limited) {
  if (all->count == MOST_STEP_SERIES) return NULL;
  step_series *self = &all->at[all->count++];
  *self = (step_series){.variant = variant,
                        .group = (int)study->result->group_count++,
                        .first = first,
                        .limited = limited};
  return self;
}

/* Do two refinements differ at one of the first points? They do not without touchdowns. */
static bool differ(tradeoff_study *study, int variant, tradeoff_setting a, tradeoff_setting b) {
  for (size_t p = 0; p < study->result->point_count && p < LOOKED_AT && !study->status; p++) {
    tradeoff_outcome one = strut_tradeoff_run(study, p, variant, a, study->scratch);
    tradeoff_outcome other = strut_tradeoff_run(study, p, variant, b, study->scratch);
    if (one.good != other.good || (one.good && one.evaluations != other.evaluations)) return true;
  }
  return false;
}

/* Adds series with refined steps of an event method; `first` is the one without refinement. */
static void add_refined(tradeoff_study *study, step_series_list *all, int variant,
                        tradeoff_setting first, bool limited) {
  static const double ways[] = {(double)NAN, 0, 8};
  tradeoff_setting setting[3];
  for (int i = 0; i < 3; i++) {
    setting[i] = first;
    setting[i].step *= 0.8;
    setting[i].refine = ways[i];
  }
  for (int i = 1; i < 3; i++) {
    bool new = true;
    for (int k = 0; k < i && new; k++) new = differ(study, variant, setting[k], setting[i]);
    first.refine = ways[i];
    if (new && !study->status) add_series(study, all, variant, first, limited);
  }
}

void strut_tradeoff_add_method(tradeoff_study *study, step_series_list *all, int variant,
                               const strut_integrator *method) {
  tradeoff_setting first = {method, study->base.step, (double)NAN, (double)NAN};
  bool adaptive = strut_tradeoff_is_adaptive(method);
  double limit = 0;
  if (study->status || !strut_tradeoff_limit(study, variant, method, &limit)) return;
  if (adaptive) first.step = fmax(10 * first.step, study->limit), first.tolerance = 1e-2;
  bool limited = !adaptive && isfinite(limit) && limit > 0;
  if (limited) first.step = limit;
  if (!limited && !adaptive) {
    double most = study->limit > 0 ? FREE * study->limit : FREE_OF_BASE * first.step;
    first.step = fmin(most, study->points[0].longest);
  }
  if (add_series(study, all, variant, first, limited) && method->events && !adaptive)
    add_refined(study, all, variant, first, limited);
}

/* Was this setting run already? With few steps per period several settings may coincide. */
static bool is_known(const strut_tradeoff *tradeoff, const step_series *self,
                     const tradeoff_setting *setting, double step) {
  for (size_t i = 0; i < tradeoff->row_count; i++) {
    const strut_tradeoff_row *row = &tradeoff->rows[i];
    if (row->group != self->group || fabs(row->setting.step / step - 1) > 1e-9) continue;
    if (!isfinite(setting->tolerance) || row->setting.tolerance == setting->tolerance) return true;
  }
  return false;
}

/*
 * Force evaluations to expect of a series' next row. An adaptive method begins near the explicit
 * limit.
 */
static double predict(const tradeoff_study *study, const step_series *self,
                      tradeoff_setting setting) {
  bool adaptive = strut_tradeoff_is_adaptive(setting.method);
  if (adaptive && self->last_cost > 0) return TENTH * self->last_cost;
  if (adaptive) setting.step = study->limit > 0 ? study->limit : study->base.step;
  return strut_tradeoff_planned_at_all(study, setting);
}

/* The series whose next row is the cheapest; NULL: all are over. */
static step_series *find_next(const tradeoff_study *study, step_series_list *all,
                              tradeoff_setting *setting, double *cost) {
  step_series *next = NULL;
  for (size_t i = 0; i < all->count; i++) {
    step_series *self = &all->at[i];
    tradeoff_setting own;
    bool left = !self->over && setting_at(study, self, self->next, &own);
    while (left && is_known(study->result, self, &own, strut_tradeoff_fit_step(study, 0, own.step)))
      left = setting_at(study, self, ++self->next, &own);
    double expected = left ? predict(study, self, own) : HUGE_VAL;
    if (!left || (next && expected >= *cost)) continue;
    next = self;
    *setting = own;
    *cost = expected;
  }
  if (next) next->next++;
  return next;
}

/*
 * Of an accuracy, a series ends when three settings in a row keep half of it, and sooner where the
 * next costs more than that by which another series got there.
 */
static void judge_series(tradeoff_study *study, step_series_list *all, step_series *self,
                         strut_tradeoff_row *row) {
  if (!(study->options->accuracy > 0)) return;
  strut_tradeoff_judge_row(study, row);
  self->kept = row->total_spread.worst <= 0.5 * study->options->accuracy ? self->kept + 1 : 0;
  if (self->kept < CONFIRMED) return;
  self->over = true;
  all->cheapest = fmin(all->cheapest > 0 ? all->cheapest : HUGE_VAL, self->last_cost);
}

void strut_tradeoff_run_series(tradeoff_study *study, step_series_list *all, double share,
                               double from, double to) {
  double most = strut_tradeoff_work_left(study, share), cost = 0;
  tradeoff_setting setting;
  step_series *self = NULL;
  while (!study->status && (self = find_next(study, all, &setting, &cost))) {
    double left = strut_tradeoff_work_left(study, share);
    if (study->options->progress)
      study->options->progress(study->options->progress_context,
                               to - (to - from) * fmax(0, left) / most);
    bool useless = self->kept == 0 && all->cheapest > 0 && cost > all->cheapest;
    bool possible = useless || (cost <= left && strut_tradeoff_has_time(study, cost));
    self->over = useless || !possible;
    study->result->left_out += !possible;
    strut_tradeoff_row *row = self->over ? NULL : run_row(study, self, setting, left);
    if (row) judge_series(study, all, self, row);
  }
}

void strut_tradeoff_run_base(tradeoff_study *study, step_series_list *own, double share) {
  step_series alone = {.group = -1, .first = study->base}, *in = &alone;
  strut_tradeoff_row *row = NULL;
  double most = strut_tradeoff_work_left(study, share);
  for (size_t i = own->count; i-- > 0;)
    if (own->at[i].first.method == study->base.method && !isfinite(own->at[i].first.refine))
      in = &own->at[i];
  if (in == &alone) alone.group = (int)study->result->group_count++;
  double cost = strut_tradeoff_planned_at_all(study, study->base);
  if (!study->status && cost <= most && strut_tradeoff_has_time(study, cost))
    row = run_row(study, in, study->base, most);
  if (row) row->base = true;
}
