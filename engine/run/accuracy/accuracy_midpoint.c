/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A wanted accuracy by implicit midpoint, where stiff members keep explicit steps far below the motion. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/scene/signal_program.h"

/* Steps of the first run: in the whole run, in a drive period, and in the shortest time of a signal. */
static const double STEPS_IN_RUN = 100.0, STEPS_IN_PERIOD = 40.0, STEPS_IN_SIGNAL = 20.0;
/* Estimated force evaluations per step. */
static const double EVALUATIONS_PER_STEP = 5.0;
/* Periods in which a driven motion usually becomes steady: the orbit strategy needs no more. */
static const double MOST_PERIODS = 60.0;
/* Part of the wanted error to which two runs must agree, and that unresolved motions may reach. */
static const double AGREE = 0.4;
/* Halving the step should divide the change of the positions by 4; this is still accepted. */
static const double CONVERGES = 2.5;

/*
 * Implicit midpoint neither damps nor resolves motions too fast for its step: their velocity
 * changes sign from step to step. They would disturb the slow motion, so their energy is measured,
 * as what averaging of neighbouring steps removes.
 */
typedef struct fast_motion {
  const strut_model *model;
  double *before[2]; /* (2 nodes) velocities of the last two steps, latest first [m/s] */
  int known;
  double fast, slow; /* twice the kinetic energy, summed over steps [J] */
} fast_motion;

/* Adds three successive velocities: the second difference is fast, the mean without the rigid translation slow. */
static void add_step_energies(fast_motion *self, const double *velocity) {
  double mean[2] = {0.0, 0.0}, fast = 0.0, slow = 0.0, whole = 0.0;
  for (int32_t i = 0; i < 2 * self->model->node_count; i++) {
    double ends = self->before[1][i] + velocity[i], middle = 2.0 * self->before[0][i];
    double mass = self->model->weight[i / 2], smooth = 0.25 * (ends + middle);
    fast += mass * 0.0625 * (ends - middle) * (ends - middle);
    slow += mass * smooth * smooth;
    mean[i % 2] += mass * smooth;
    whole += 0.5 * mass;
  }
  self->fast += fast;
  self->slow += fmax(0.0, slow - (mean[0] * mean[0] + mean[1] * mean[1]) / whole);
}

static strut_status read_velocity_rows(void *context, const double *rows, size_t count,
                                       strut_error *error) {
  fast_motion *self = context;
  size_t both = 2 * (size_t)self->model->node_count;
  (void)error;
  for (size_t k = 0; k < count; k++) {
    const double *v = rows + k * (both + 1) + 1;
    double *oldest = self->before[1];
    if (self->known == 2) add_step_energies(self, v);
    memcpy(oldest, v, both * sizeof *v);
    self->before[1] = self->before[0], self->before[0] = oldest;
    if (self->known < 2) self->known++;
  }
  return STRUT_OK;
}

/* Does a signal jump? Then errors do not fall with the order of the method, and two runs may agree by chance. */
static bool has_jumping_signal(const strut_scene *scene) {
  bool any = false;
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *signal = &scene->signals[i];
    bool begins = signal->kind == STRUT_CONSTANT || signal->kind == STRUT_SINE;
    any = any || signal->kind == STRUT_SQUARE ||
          (begins && (signal->start > 0.0 || isfinite(signal->stop)));
  }
  return any;
}

/* Steps in which to look for what expressions and half-waves do; the part of their size that may be missed; and the
   shortest time to resolve, as a part of the run. */
enum { MOST_LOOKS = 20000 };
static const double FAINT = 1e-4, LEAST_PART = 1e-9;

/* The shortest time between breaks of expressions, or in which one of them or a half-wave does something. */
static double find_expression_time(const strut_accuracy *accuracy) {
  double duration = strut_experiment_span(&accuracy->experiment, accuracy->scene).duration,
         last = 0.0, t = 0.0;
  double shortest = HUGE_VAL, least = LEAST_PART * duration;
  strut_state *state = NULL;
  if (!strut_drive_is_looked_at(accuracy->model)) return shortest;
  if (strut_state_create(accuracy->model, &state, NULL)) return shortest;
  for (int k = 0; k < MOST_LOOKS && t < duration; k++) {
    double stop = strut_drive_next_break(accuracy->model, state, t + 1e-3 * least, duration),
           h = stop - t;
    double shown = strut_drive_longest_step(accuracy->model, state, t, h, FAINT, least);
    if (shown < h) shortest = fmin(shortest, shown);
    t = shown < h ? t + shown : stop;
    if (t == stop && stop < duration)
      shortest = fmin(shortest, fmax(stop - last, least)), last = stop;
  }
  strut_state_free(state);
  return shortest;
}

double strut_accuracy_signal_time(const strut_accuracy *accuracy, bool stops) {
  const strut_scene *scene = accuracy->scene;
  double shortest = 1.0 / strut_scene_fastest_turn(scene, 0.0, stops).rate;
  if (!stops) shortest = fmin(shortest, find_expression_time(accuracy));
  for (size_t i = 0; i < scene->signal_count && !stops; i++) {
    const strut_signal *signal = &scene->signals[i];
    if (signal->kind != STRUT_CONSTANT && signal->stop > signal->start)
      shortest = fmin(shortest, signal->stop - signal->start);
    for (size_t k = 1; strut_signal_has_points(signal) && k < signal->point_count; k++)
      if (signal->time[k] > signal->time[k - 1])
        shortest = fmin(shortest, signal->time[k] - signal->time[k - 1]);
  }
  return shortest;
}

/* First step: the start of the window is on the grid, or half-way. 0: the explicit method is at least as good. */
static double choose_first_step(const strut_accuracy *accuracy) {
  strut_span span = strut_experiment_span(&accuracy->experiment, accuracy->scene);
  double unit = span.period > 0.0 ? span.period : span.duration;
  double signals = STEPS_IN_SIGNAL * unit / strut_accuracy_signal_time(accuracy, false);
  double least = fmax(span.period > 0.0 ? STEPS_IN_PERIOD : STEPS_IN_RUN, ceil(signals));
  if (!(unit / least > accuracy->coarse.step)) return 0.0;
  for (double n = least; n <= 4.0 * least; n++) {
    double at = span.window_start / unit * n;
    if (fabs(at - round(at)) < 1e-9 * n) return unit / n;
  }
  return unit / (2.0 * least);
}

/* The latest two runs. */
typedef struct midpoint_runs {
  strut_accuracy *a;
  fast_motion fast_motion;
  strut_experiment e;
  strut_summary now, before;
  double change, moved; /* change of the velocity [m/s]; largest change of an end position [m] */
  double earlier;       /* `moved` one run earlier */
  double share;         /* velocity error that motions too fast for the step may cause [m/s] */
  strut_arena arena;
} midpoint_runs;

static double tolerated_error(const midpoint_runs *self) {
  return self->a->target * fmax(fabs(self->now.velocity), self->a->scale);
}

/* Largest distance of a node between the ends of the last two runs [m]. */
static double distance_of_ends(const midpoint_runs *self) {
  double most = 0.0;
  for (size_t i = 0; i + 1 < 2 * self->now.end.node_count; i += 2)
    most = fmax(most, hypot(self->now.end.positions[i] - self->before.end.positions[i],
                            self->now.end.positions[i + 1] - self->before.end.positions[i + 1]));
  return most;
}

/* Makes one more run with the present step. *kept: it agrees with the one before. */
static strut_status run_with_half_step(midpoint_runs *self, bool *kept) {
  strut_accuracy *accuracy = self->a;
  strut_span span = strut_experiment_span(&accuracy->experiment, accuracy->scene);
  strut_sink sink = {&self->fast_motion, NULL, read_velocity_rows, NULL, STRUT_CHANNEL_VELOCITY};
  strut_sink *sinks[] = {&sink};
  strut_run_options quiet = *accuracy->options;
  quiet.sinks = sinks, quiet.sink_count = 1, quiet.to = NULL;
  self->fast_motion.known = 0, self->fast_motion.fast = self->fast_motion.slow = 0.0;
  strut_summary_free(&self->before);
  self->before = self->now;
  self->now = (strut_summary){0};
  self->e.output_every = self->e.step, self->e.output_last = 0.0; /* velocities of every step */
  strut_status status = strut_accuracy_run(accuracy, &self->e, &quiet, &self->now);
  accuracy->check_evaluations += self->now.spent.evaluations;
  self->earlier = self->moved;
  self->moved = self->change = HUGE_VAL;
  if (status || self->before.spent.steps == 0) return status;
  double window = span.duration - span.window_start, size = accuracy->scale * 1e3 * span.duration;
  if (span.period > 0.0) size = accuracy->scale * 1e3 * span.period;
  self->change = fabs(self->now.velocity - self->before.velocity);
  self->moved = distance_of_ends(self);
  self->share = self->fast_motion.slow > 0.0
                    ? self->fast_motion.fast / self->fast_motion.slow * size / window
                    : 0.0;
  bool converges = self->earlier >= CONVERGES * self->moved && isfinite(self->earlier);
  *kept = strut_accuracy_is_kept(converges || self->moved <= AGREE * tolerated_error(self) * window,
                                 fmax(self->change, self->share), AGREE * tolerated_error(self));
  return status;
}

static void report_midpoint(midpoint_runs *self, double explicit_evaluations) {
  strut_accuracy *accuracy = self->a;
  strut_summary *summary = accuracy->summary;
  double error = 0.5 * self->change + self->share,
         size = fmax(fabs(summary->velocity), accuracy->scale);
  summary->accuracy =
      (strut_accuracy_summary){.wanted = accuracy->target,
                               .expected = error / size,
                               .scale = accuracy->scale,
                               .kept = strut_accuracy_is_kept(true, error, accuracy->target * size),
                               .check_evaluations = accuracy->check_evaluations};
  snprintf(summary->accuracy.why, sizeof summary->accuracy.why,
           "midpoint with a step of %.3g s, %.3g times that of verlet-events, which would take "
           "%.2g force evaluations: twice the step changes the velocity by %.2g m/s, and motions "
           "too fast for the step contribute at most %.2g m/s",
           summary->step, summary->step / accuracy->coarse.step, explicit_evaluations, self->change,
           self->share);
}

/*
 * Time of an evaluation with its share of the factorisation over that of an explicit method, as
 * measured on trees and nets, halved: the other strategies take longer to check than to run.
 */
static double relative_step_cost(const strut_model *model) {
  double free = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) free += model->fixed[i] ? 0.0 : 1.0;
  return 2.0 + sqrt(free) / 8.0;
}

static strut_status halve_until_kept(midpoint_runs *self, bool *done) {
  strut_status status = STRUT_OK;
  strut_span span = strut_experiment_span(&self->a->experiment, self->a->scene);
  double usual_duration =
      span.period > 0.0 ? fmin(span.duration, MOST_PERIODS * span.period) : span.duration;
  double explicit_evaluations = usual_duration / self->a->coarse.step;
  double next = EVALUATIONS_PER_STEP * span.duration / self->e.step,
         time = relative_step_cost(self->fast_motion.model);
  strut_accuracy_begin_phase(self->a, "midpoint with ever smaller steps");
  for (; !status && !*done && time * next < explicit_evaluations; self->e.step *= 0.5) {
    status = run_with_half_step(self, done);
    next = 2.0 * (double)self->now.spent.evaluations;
    if (*done) break;
  }
  if (!status && *done) status = strut_accuracy_deliver(self->a, &self->e, &self->now);
  if (!status && *done) report_midpoint(self, explicit_evaluations);
  return status;
}

strut_status strut_accuracy_try_midpoint(strut_accuracy *accuracy, bool *done) {
  const strut_scene *scene = accuracy->scene;
  midpoint_runs h = {.a = accuracy, .e = accuracy->coarse, .change = HUGE_VAL, .moved = HUGE_VAL};
  *done = false;
  h.e.integrator = strut_integrator_for(STRUT_ROLE_STIFF)->name;
  h.e.step = choose_first_step(accuracy);
  bool fits = scene->contact_count == 0 && !accuracy->single_method &&
              !accuracy->experiment.steady.wanted && !has_jumping_signal(scene) && h.e.step > 0.0;
  if (!fits) return STRUT_OK;
  strut_status status = STRUT_OK;
  h.fast_motion.model = accuracy->model;
  if (!STRUT_NUMBERS(&h.arena, 2 * scene->node_count, &h.fast_motion.before[0],
                     &h.fast_motion.before[1]))
    status = strut_no_memory(accuracy->error, "");
  if (!status) status = halve_until_kept(&h, done);
  strut_summary_free(&h.now);
  strut_summary_free(&h.before);
  strut_arena_free(&h.arena);
  return status == STRUT_DIVERGED ? STRUT_OK : status;
}
