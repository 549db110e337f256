/* SPDX-License-Identifier: GPL-3.0-or-later */
/* To an accuracy by implicit midpoint: where stiff members hold explicit steps far below the motion. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/accuracy.h"

/* Steps at first: in the whole run, in a period of the drive, and in any time that a signal has. */
static const double IN_RUN = 100.0, IN_PERIOD = 40.0, IN_SIGNAL = 20.0;
/* Evaluations of a step. */
static const double PER_STEP = 5.0;
/* Periods in which a driven motion mostly becomes steady: the other way needs no more. */
static const double MOST_PERIODS = 60.0;
/* Two runs that agree to this part of what is wanted, and a part that hides nothing more. */
static const double AGREE = 0.4;
/* Half the step should leave a fourth of the change of all positions. */
static const double CONVERGES = 2.5;

/*
 * Motions too fast for the step stay as large as they are, and their velocity changes its sign from
 * step to step. They would push the slow ones: how large they are is seen by what is left of the
 * velocities when neighbours are averaged.
 */
typedef struct watch {
  const strut_model *model;
  double *before[2]; /* (2 nodes) velocities of the last two steps, latest first [m/s] */
  int known;
  double fast, slow; /* twice the kinetic energy, summed over steps [J] */
} watch;

static strut_status begin_watch(void *context, const strut_record_layout *layout,
                                strut_error *error) {
  (void)context, (void)layout, (void)error;
  return STRUT_OK;
}

static strut_status end_watch(void *context, strut_status status, strut_error *error) {
  (void)context, (void)status, (void)error;
  return STRUT_OK;
}

/* Three velocities in a row: their second difference is fast, their mean, all moving as one, slow. */
static void watch_step(watch *w, const double *v) {
  double mean[2] = {0.0, 0.0}, fast = 0.0, slow = 0.0, whole = 0.0;
  for (int32_t i = 0; i < 2 * w->model->node_count; i++) {
    double ends = w->before[1][i] + v[i], middle = 2.0 * w->before[0][i];
    double mass = w->model->weight[i / 2], smooth = 0.25 * (ends + middle);
    fast += mass * 0.0625 * (ends - middle) * (ends - middle);
    slow += mass * smooth * smooth;
    mean[i % 2] += mass * smooth;
    whole += 0.5 * mass;
  }
  w->fast += fast;
  w->slow += fmax(0.0, slow - (mean[0] * mean[0] + mean[1] * mean[1]) / whole);
}

static strut_status watch_rows(void *context, const double *rows, size_t count,
                               strut_error *error) {
  watch *w = context;
  size_t both = 2 * (size_t)w->model->node_count;
  (void)error;
  for (size_t k = 0; k < count; k++) {
    const double *v = rows + k * (both + 1) + 1;
    double *oldest = w->before[1];
    if (w->known == 2) watch_step(w, v);
    memcpy(oldest, v, both * sizeof *v);
    w->before[1] = w->before[0], w->before[0] = oldest;
    if (w->known < 2) w->known++;
  }
  return STRUT_OK;
}

/* Does a signal jump? Then errors do not fall as the order says, and two runs may agree by chance. */
static bool jumps(const strut_scene *scene) {
  bool any = false;
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *s = &scene->signals[i];
    bool begins = s->kind == STRUT_CONSTANT || s->kind == STRUT_SINE;
    any = any || s->kind == STRUT_SQUARE || (begins && (s->start > 0.0 || isfinite(s->stop)));
  }
  return any;
}

double strut_accuracy_signal_time(const strut_scene *scene) {
  double shortest = HUGE_VAL;
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *s = &scene->signals[i];
    if (s->kind == STRUT_SINE || s->kind == STRUT_HALF_SINE || s->kind == STRUT_SQUARE)
      shortest = fmin(shortest, 1.0 / s->frequency);
    if (s->kind != STRUT_CONSTANT && s->stop > s->start)
      shortest = fmin(shortest, s->stop - s->start);
    for (size_t k = 1; s->kind == STRUT_TABLE && k < s->point_count; k++)
      shortest = fmin(shortest, s->time[k] - s->time[k - 1]);
  }
  return shortest;
}

/* The first step: with the window's begin on the grid where that can be, else between two points. */
static double first_step(const strut_accuracy *a) {
  strut_span span = strut_experiment_span(&a->experiment, a->scene);
  double unit = span.period > 0.0 ? span.period : span.duration;
  double signals = IN_SIGNAL * unit / strut_accuracy_signal_time(a->scene);
  double least = fmax(span.period > 0.0 ? IN_PERIOD : IN_RUN, ceil(signals));
  if (!(unit / least > a->cheap.step)) return 0.0;
  for (double n = least; n <= 4.0 * least; n++) {
    double at = span.window_start / unit * n;
    if (fabs(at - round(at)) < 1e-9 * n) return unit / n;
  }
  return unit / (2.0 * least);
}

/* The runs so far. */
typedef struct halving {
  strut_accuracy *a;
  watch watch;
  strut_experiment e;
  strut_summary now, before;
  double change, moved; /* of the velocity [m/s], of all positions at the end [m] */
  double earlier;       /* `moved` of the run before */
  double share;         /* of energy in motions too fast for the step, as an error [m/s] */
  strut_arena arena;
} halving;

static double enough(const halving *h) {
  return h->a->wanted * fmax(fabs(h->now.velocity), h->a->scale);
}

/* How far the ends of the last two runs are apart [m]. */
static double apart(const halving *h) {
  double most = 0.0;
  for (size_t i = 0; i + 1 < 2 * h->now.node_count; i += 2)
    most = fmax(most, hypot(h->now.positions[i] - h->before.positions[i],
                            h->now.positions[i + 1] - h->before.positions[i + 1]));
  return most;
}

/* One more run, with half the step if it is not the first. *kept: the two last agree. */
static strut_status run_finer(halving *h, bool *kept) {
  strut_accuracy *a = h->a;
  strut_span span = strut_experiment_span(&a->experiment, a->scene);
  strut_sink sink = {&h->watch, begin_watch, watch_rows, end_watch, STRUT_CHANNEL_VELOCITY};
  strut_sink *sinks[] = {&sink};
  strut_run_options quiet = *a->options;
  quiet.sinks = sinks, quiet.sink_count = 1, quiet.to = NULL;
  h->watch.known = 0, h->watch.fast = h->watch.slow = 0.0;
  strut_summary_free(&h->before);
  h->before = h->now;
  h->now = (strut_summary){0};
  h->e.output_every = h->e.step, h->e.output_last = 0.0; /* all of them are looked at */
  strut_status status = strut_accuracy_run(a, &h->e, &quiet, &h->now);
  a->spent += h->now.force_evaluations;
  h->earlier = h->moved;
  h->moved = h->change = HUGE_VAL;
  if (status || h->before.steps == 0) return status;
  double window = span.duration - span.window_start, size = a->scale * 1e3 * span.duration;
  if (span.period > 0.0) size = a->scale * 1e3 * span.period;
  h->change = fabs(h->now.velocity - h->before.velocity);
  h->moved = apart(h);
  h->share = h->watch.slow > 0.0 ? h->watch.fast / h->watch.slow * size / window : 0.0;
  bool converges = h->earlier >= CONVERGES * h->moved && isfinite(h->earlier);
  *kept = h->change <= AGREE * enough(h) && h->share <= AGREE * enough(h) &&
          (converges || h->moved <= AGREE * enough(h) * window);
  return status;
}

static void tell(halving *h, double explicit_evaluations) {
  strut_accuracy *a = h->a;
  strut_summary *s = a->summary;
  double error = 0.5 * h->change + h->share, size = fmax(fabs(s->velocity), a->scale);
  s->accuracy = (strut_accuracy_summary){.wanted = a->wanted,
                                         .expected = error / size,
                                         .scale = a->scale,
                                         .kept = error <= a->wanted * size,
                                         .check_evaluations = a->spent};
  snprintf(
      s->accuracy.why, sizeof s->accuracy.why,
      "midpoint with a step of %.3g s, %.3g times that of verlet-events, which would take %.2g "
      "evaluations: twice the step changes the velocity by %.2g m/s, and motions too fast for "
      "the step amount to %.2g m/s at most",
      s->step, s->step / a->cheap.step, explicit_evaluations, h->change, h->share);
}

/* The finest run is the answer; with whoever records it. */
static strut_status answer(halving *h) {
  strut_accuracy *a = h->a;
  if (!a->options->sink_count && !a->options->to) {
    a->spent -= h->now.force_evaluations;
    *a->summary = h->now;
    h->now = (strut_summary){0};
    return STRUT_OK;
  }
  h->e.output_every = a->experiment.output_every;
  h->e.output_last = a->experiment.output_last;
  return strut_accuracy_run(a, &h->e, a->options, a->summary);
}

/*
 * The time of an evaluation with its share of the factor over that of an explicit method, by
 * measurement of trees and nets, halved: the other way takes longer to check than to run.
 */
static double dearer(const strut_model *model) {
  double free = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) free += model->fixed[i] ? 0.0 : 1.0;
  return 2.0 + sqrt(free) / 8.0;
}

static strut_status halve_until_kept(halving *h, bool *done) {
  strut_status status = STRUT_OK;
  strut_span span = strut_experiment_span(&h->a->experiment, h->a->scene);
  double mostly =
      span.period > 0.0 ? fmin(span.duration, MOST_PERIODS * span.period) : span.duration;
  double explicit_evaluations = mostly / h->a->cheap.step;
  double next = PER_STEP * span.duration / h->e.step, time = dearer(h->watch.model);
  strut_accuracy_begin_phase(h->a, "midpoint with ever smaller steps");
  for (; !status && !*done && time * next < explicit_evaluations; h->e.step *= 0.5) {
    status = run_finer(h, done);
    next = 2.0 * (double)h->now.force_evaluations;
    if (*done) break;
  }
  if (!status && *done) status = answer(h);
  if (!status && *done) tell(h, explicit_evaluations);
  return status;
}

strut_status strut_accuracy_by_midpoint(strut_accuracy *a, bool *done) {
  const strut_scene *scene = a->scene;
  halving h = {.a = a, .e = a->cheap, .change = HUGE_VAL, .moved = HUGE_VAL};
  *done = false;
  h.e.integrator = strut_integrator_for(STRUT_ROLE_STIFF)->name;
  h.e.step = first_step(a);
  bool fits = scene->contact_count == 0 && !a->halving && !a->experiment.steady.wanted &&
              !jumps(scene) && h.e.step > 0.0;
  if (!fits) return STRUT_OK;
  strut_status status = STRUT_OK;
  size_t both = 2 * scene->node_count;
  h.watch.model = a->model;
  for (int k = 0; k < 2 && !status; k++)
    if (!(h.watch.before[k] = strut_arena_allocate(&h.arena, both, sizeof(double))))
      status = strut_fail(a->error, STRUT_NO_MEMORY, "out of memory");
  if (!status) status = halve_until_kept(&h, done);
  strut_summary_free(&h.now);
  strut_summary_free(&h.before);
  strut_arena_free(&h.arena);
  return status == STRUT_DIVERGED ? STRUT_OK : status;
}
