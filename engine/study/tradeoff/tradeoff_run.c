/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One run: the scene changed to a setting, what it gave, and the CPU time of its steps. */
#include <math.h>
#include <string.h>
#include <time.h>

#include "engine/run/simulate.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

enum { USUAL_PERIODS = 120 };

double strut_study_clock(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double strut_study_left(const study *s, double share) {
  return share * s->budget - (strut_study_clock() - s->began);
}

bool strut_study_adaptive(const strut_integrator *method) {
  return strcmp(method->name, "adaptive") == 0;
}

strut_experiment strut_study_experiment(const study *s, size_t point) {
  strut_experiment e = s->setups[point]->experiment;
  e.quantity_count = 0; /* velocity and positions are compared, and what they cost */
  double most = s->options->periods > 0 ? s->options->periods : USUAL_PERIODS;
  e.accuracy = 0;
  e.steady = (strut_steady){.wanted = false};
  if (e.periods > most) {
    double window = e.measure_last > 0 ? e.measure_last : e.periods;
    e.periods = most;
    e.measure_last = fmin(window, fmax(1, floor(most / 3)));
  }
  e.output_last = 0;
  e.channels = STRUT_CHANNEL_POSITION;
  return e;
}

strut_span strut_study_span(const study *s, size_t point) {
  const strut_experiment e = strut_study_experiment(s, point);
  return strut_experiment_span(&e, &s->setups[point]->scene);
}

double strut_study_fit(const study *s, size_t point, double step) {
  strut_span span = strut_study_span(s, point);
  double turns = span.period > 0 ? span.duration / span.period : 0;
  bool whole = turns > 0.5 && fabs(turns - round(turns)) < 1e-9 * turns;
  double unit = whole ? span.period : span.duration;
  return unit / ceil(unit / step * (1 - 1e-9));
}

/* A sink that only looks at the clock, between preparing a run and its end. */
static strut_status begin_clock(void *context, const strut_record_layout *layout,
                                strut_error *error) {
  (void)layout, (void)error;
  *(double *)context = strut_study_clock();
  return STRUT_OK;
}

static strut_status ignore_rows(void *context, const double *rows, size_t count,
                                strut_error *error) {
  (void)context, (void)rows, (void)count, (void)error;
  return STRUT_OK;
}

static strut_status end_clock(void *context, strut_status status, strut_error *error) {
  (void)status, (void)error;
  *(double *)context = strut_study_clock() - *(double *)context;
  return STRUT_OK;
}

static void take_values(const study *s, const strut_summary *summary, double *value) {
  switch (s->result->measure) {
    case STRUT_TRADEOFF_POSITION:
      memcpy(value, summary->positions, 2 * summary->node_count * sizeof *value);
      break;
    case STRUT_TRADEOFF_ENERGY:
      value[0] = summary->energy.moved > 0 ? summary->energy.residual / summary->energy.moved : 0;
      break;
    default: value[0] = summary->velocity;
  }
}

double strut_study_longest(const study *s, size_t point) {
  const strut_setup *setup = s->setups[point];
  strut_span span = strut_experiment_span(&setup->experiment, &setup->scene);
  return (span.period > 0 ? span.period : span.duration) / 20;
}

/*
 * The largest step worth trying. Where nothing vibrates, as where rigid bars swing under gravity, the
 * limit of stability may be far longer than the motion lasts: then a part of that counts.
 */
static double useful_limit(const study *s, size_t point, double limit) {
  return isfinite(limit) ? fmin(limit, strut_study_longest(s, point)) : limit;
}

static bool hopeless(strut_status status) {
  return status == STRUT_USAGE || status == STRUT_BAD_SCENE || status == STRUT_SINGULAR;
}

static strut_status simulate(const study *s, size_t point, int fidelity,
                             const strut_experiment *experiment, double *value,
                             study_outcome *outcome) {
  const strut_model *model = NULL;
  strut_summary summary = {0};
  strut_sink clock = {&outcome->seconds, begin_clock, ignore_rows, end_clock,
                      STRUT_CHANNEL_POSITION};
  strut_sink *sinks[] = {&clock};
  const strut_run_options options = {
      .force = true, .interrupt = s->options->interrupt, .sinks = sinks, .sink_count = 1};
  strut_status status = strut_study_model(s, point, fidelity, &model);
  if (status == STRUT_OK) status = strut_simulate(model, experiment, &options, &summary, s->error);
  outcome->evaluations = summary.force_evaluations;
  outcome->step_limit = useful_limit(s, point, summary.step_limit);
  outcome->cannot = hopeless(status);
  bool ours = status == STRUT_INTERRUPTED || status == STRUT_NO_MEMORY;
  outcome->status = status == STRUT_OK ? STRUT_OK : STRUT_DIVERGED;
  if (status == STRUT_OK) take_values(s, &summary, value);
  strut_summary_free(&summary);
  return ours ? status : STRUT_OK;
}

strut_status strut_study_run(const study *s, size_t point, int fidelity, study_setting setting,
                             double *value, study_outcome *outcome) {
  *outcome = (study_outcome){.seconds = (double)NAN};
  for (size_t i = 0; i < s->result->value_count; i++) value[i] = (double)NAN;
  strut_experiment e = strut_study_experiment(s, point);
  e.integrator = setting.method->name;
  e.step = strut_study_fit(s, point, setting.step);
  if (isfinite(setting.tolerance)) e.tolerance = setting.tolerance;
  e.refine = isfinite(setting.refine) ? setting.refine : 1;
  e.output_every = strut_study_span(s, point).duration;
  return simulate(s, point, fidelity, &e, value, outcome);
}

double strut_study_distance(const study *s, size_t point, const double *value,
                            const double *reference) {
  double most = 0;
  size_t count = s->result->value_count;
  if (s->result->measure == STRUT_TRADEOFF_POSITION) {
    for (size_t i = 0; i + 1 < count; i += 2) {
      double d = hypot(value[i] - reference[i], value[i + 1] - reference[i + 1]) / s->size[point];
      if (!(d <= most)) most = d;
    }
  } else if (s->result->measure == STRUT_TRADEOFF_ENERGY) {
    most = fabs(value[0] - reference[0]);
  } else {
    most = fabs(value[0] - reference[0]) / fmax(fabs(reference[0]), s->scale[point]);
  }
  return isfinite(most) ? most : HUGE_VAL;
}
