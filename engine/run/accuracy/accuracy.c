/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/accuracy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/model/pose.h"
#include "engine/run/settle.h"
#include "engine/scene/signal_program.h"

/* Least steps per period. */
static const double LEAST_STEPS = 100.0;
/* The longest step as a part of the shortest turn. */
static const double STEP_OF_TURN = 0.1;
/* Velocities below this part of size over time are not measured relative to themselves. */
static const double STANDSTILL = 1e-3;

/*
 * A fine run with fixed steps has four steps for each step of the coarse method, of four
 * evaluations each. The budget counts in such runs.
 */
static const double FINE_STEPS = 4.0, FINE_EVALUATIONS = 4.0;
/* Work that is always allowed, in evaluations times nodes and members [1]. */
static const double LEAST_WORK = 4e7;

void strut_accuracy_begin_phase(const strut_accuracy *a, const char *name) {
  if (a->options->phase) a->options->phase(a->options->progress_context, name);
}

int64_t strut_accuracy_evaluations_left(const strut_accuracy *a) {
  return a->allowed > a->used ? a->allowed - a->used : 1;
}

strut_status strut_accuracy_run(strut_accuracy *a, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary) {
  strut_experiment plain = *experiment;
  strut_run_options bounded = *options;
  plain.accuracy = a->target; /* to which extremes are resolved */
  bounded.chosen = true;
  bounded.most_evaluations = strut_accuracy_evaluations_left(a);
  strut_status status = strut_simulate(a->model, &plain, &bounded, summary, a->error);
  a->used += summary->spent.evaluations;
  for (size_t i = 0; i < summary->warning_count; i++)
    a->creeps = a->creeps || strcmp(summary->warnings[i].code, "wide_band") == 0;
  return status;
}

strut_status strut_accuracy_deliver(strut_accuracy *a, const strut_experiment *experiment,
                                    strut_summary *run) {
  a->check_evaluations -= run->spent.evaluations;
  if (!a->options->sink_count && !a->options->to && run->status == STRUT_OK) {
    *a->summary = *run;
    *run = (strut_summary){0};
    return STRUT_OK;
  }
  strut_experiment e = *experiment; /* the same run again, whose cost is counted once */
  strut_accuracy_begin_phase(a, "recording the answer");
  a->allowed = INT64_MAX; /* the same run was within the budget before */
  e.output_every = a->experiment.output_every;
  e.output_last = a->experiment.output_last;
  return strut_accuracy_run(a, &e, a->options, a->summary);
}

/* No method supports both rigid bars and exact friction. */
static strut_status refuse_exact_friction(const strut_accuracy *a) {
  const strut_model *model = a->model;
  int32_t exact = strut_first_exact_contact(model);
  if (exact >= 0)
    return strut_fail(a->error, STRUT_USAGE,
                      "no method supports both rigid bars and the friction law %s of node '%s'; "
                      "use bars: elastic, or the law karnopp",
                      strut_friction_law_at(model->contacts.entry[exact].friction.law)->word,
                      a->scene->nodes[model->contacts.entry[exact].node].name);
  return STRUT_OK;
}

double strut_accuracy_least_budget(const strut_accuracy *a) {
  double part = a->experiment.budget / STRUT_USUAL_BUDGET;
  return part * LEAST_WORK / (double)(a->scene->node_count + a->scene->member_count);
}

/* Chooses verlet-events, or the method for rigid bars, with nearly its largest stable step. */
static strut_status choose_coarse_method(strut_accuracy *a) {
  const strut_model *model = a->model;
  double limit = 0.0;
  strut_span span = strut_experiment_span(&a->experiment, a->scene);
  double unit = span.period > 0.0 ? span.period : span.duration;
  strut_status status = STRUT_OK;
  if (!model->mass) return strut_fail(a->error, STRUT_SINGULAR, "a free node has no mass");
  a->single_method = model->terms & STRUT_TERM_RIGID; /* supported by one method only */
  if (a->single_method) status = refuse_exact_friction(a);
  if (status) return status;
  strut_experiment *e = &a->coarse;
  *e = a->experiment;
  e->accuracy = 0.0;
  e->integrator =
      strut_integrator_for(a->single_method ? STRUT_ROLE_PLAIN : STRUT_ROLE_COARSE)->name;
  status =
      strut_step_limit_for_method(model, strut_integrator_find(e->integrator), &limit, a->error);
  e->step = fmin(STRUT_COARSE_STEP * limit, unit / LEAST_STEPS);
  double turns = strut_scene_fastest_turn(a->scene, span.duration, true).rate;
  e->step = fmin(e->step, STEP_OF_TURN / turns);
  a->stiff = e->step < unit / LEAST_STEPS;
  e->refine = e->refine_time = 0.0;
  double fine = FINE_EVALUATIONS * FINE_STEPS * span.duration / e->step;
  a->budget = (int64_t)fmin(fmax(e->budget * fine, strut_accuracy_least_budget(a)), 1e18);
  if (a->options->most_evaluations > 0 && a->options->most_evaluations < a->budget)
    a->budget = a->options->most_evaluations;
  a->allowed = a->budget;
  a->scale = STANDSTILL * model->size / unit;
  return status;
}

double strut_accuracy_transient_periods(const strut_accuracy *a) {
  const strut_experiment *e = &a->experiment;
  strut_span span = strut_experiment_span(e, a->scene);
  return e->steady.wanted ? e->periods : 0.5 * span.window_start / span.period;
}

bool strut_accuracy_orbit_covers_window(const strut_accuracy *a,
                                        const strut_steady_summary *steady) {
  const strut_experiment *e = &a->experiment;
  if (e->steady.wanted) return true;
  double repetitions = e->measure_last / steady->repeats;
  return (double)steady->periods <= strut_accuracy_transient_periods(a) &&
         fabs(repetitions - round(repetitions)) < 1e-9;
}

/* The answer is not certified, whatever finer runs say, which agree on its fault. */
static void withhold(strut_summary *s) {
  s->accuracy.kept = false, s->accuracy.expected = (double)NAN;
  for (size_t m = 0; m < s->measured_count; m++) s->measured[m].kept = false;
}

/* Bands that are too wide, and friction that gave more of the exchanged energy than the wanted accuracy. */
static void refuse_wide_bands(const strut_accuracy *a) {
  strut_summary *s = a->summary;
  bool gives = s->energy.rubbed > s->accuracy.wanted * s->energy.moved;
  if (!(a->creeps || gives) || !s->accuracy.kept) return;
  withhold(s);
  snprintf(s->accuracy.why, sizeof s->accuracy.why,
           "feet that should stick creep within their stick bands; use 'law: coulomb', or a far "
           "smaller stick_velocity");
}

bool strut_accuracy_balance_is_open(const strut_accuracy *a, const strut_summary *s) {
  return s->balance == STRUT_BALANCE_OPEN &&
         !(fabs(s->energy.residual) <= a->target * s->energy.moved);
}

/* Energy from nothing is no answer to rely on. */
static void refuse_open_balance(const strut_accuracy *a) {
  strut_summary *s = a->summary;
  if (s->status != STRUT_OK || !strut_accuracy_balance_is_open(a, s)) return;
  withhold(s);
  snprintf(s->accuracy.why, sizeof s->accuracy.why,
           "%s with a step of %.3g s: the energy balance does not close: %.3g J, %.2g %% of the "
           "exchanged energy",
           s->method, s->step, s->energy.residual,
           100.0 * fabs(s->energy.residual) / s->energy.moved);
}

strut_status strut_simulate_accurately(const strut_model *model, const strut_experiment *experiment,
                                       const strut_run_options *options, strut_summary *summary,
                                       strut_error *error) {
  strut_error own = {0};
  strut_settled_start start; /* settled once, so that all runs start from the same bits */
  *summary = (strut_summary){.velocity = (double)NAN, .velocity_spread = (double)NAN};
  strut_accuracy a = {.experiment = *experiment,
                      .options = options,
                      .target = experiment->accuracy,
                      .summary = summary,
                      .error = error ? error : &own};
  bool done = false;
  double begin = strut_run_clock();
  strut_status status = strut_settle_model(model, experiment, options->interrupt, &start, a.error);
  a.model = start.model;
  a.scene = model->scene;
  a.experiment.settle.wanted = false;
  if (!status) status = choose_coarse_method(&a);
  bool velocity =
      experiment->quantity_count == 0; /* the only quantity that these two strategies check */
  /* states that they know nothing of */
  if (model->terms & STRUT_TERM_MEMORY || model->contacts.grips) velocity = false;
  if (strut_feedback_remembers(&model->feedback)) velocity = false;
  if (!status && velocity) status = strut_accuracy_try_midpoint(&a, &done);
  bool orbit =
      false; /* whose balance is that of the coarse way to it, and which another method confirms */
  if (!status && !done && velocity && experiment->periods > 0.0 && !a.single_method)
    status = strut_accuracy_try_orbit(&a, &orbit);
  done = done || orbit;
  if (!status && !done) status = strut_accuracy_climb_ladder(&a);
  summary->spent.wall_time = strut_run_clock() - begin;
  summary->status = status;
  if (!orbit) refuse_open_balance(&a);
  summary->settle_time = start.how.time, summary->settle = start.how;
  strut_summary_warn_of_start(summary);
  refuse_wide_bands(&a);
  strut_summary_warn_of_accuracy(summary);
  strut_settled_start_free(&start);
  return status;
}

/* Moments of two runs closer than this, relative to their spacing, are the same. */
static const double SAME_MOMENT = 1e-3;
/* Smallest motion that distances are relative to, over the size of the structure. */
static const double LEAST_MOTION = 1e-4;

static strut_status begin_track(void *context, const strut_record_layout *layout,
                                strut_error *error) {
  (void)layout, (void)error;
  ((strut_track *)context)->count = 0;
  return STRUT_OK;
}

static strut_status record_track_rows(void *context, const double *rows, size_t count,
                                      strut_error *error) {
  strut_track *t = context;
  size_t both = 2 * (size_t)t->model->node_count;
  (void)error;
  for (size_t k = 0; k < count && t->count < t->capacity; k++, t->count++) {
    const double *row = rows + k * (both + 1);
    t->time[t->count] = row[0];
    memcpy(t->position + t->count * both, row + 1, both * sizeof(double));
  }
  return STRUT_OK;
}

strut_status strut_track_create(const strut_model *model, size_t capacity, strut_arena *arena,
                                strut_track *t) {
  size_t both = 2 * (size_t)model->node_count;
  *t = (strut_track){.model = model, .capacity = capacity};
  t->sink = (strut_sink){t, begin_track, record_track_rows, NULL, STRUT_CHANNEL_POSITION};
  t->time = strut_arena_allocate(arena, capacity, sizeof(double));
  t->position = strut_arena_allocate(arena, capacity * both, sizeof(double));
  return t->time && t->position ? STRUT_OK : STRUT_NO_MEMORY;
}

/* Mean position along the ground at moment k; 0 where a support holds it or there is no ground. */
static double mean_along_ground(const strut_track *t, size_t k) {
  const strut_model *model = t->model;
  const double *q = t->position + 2 * k * (size_t)model->node_count;
  double sum = 0.0;
  if (!strut_contacts_allow_travel(&model->contacts)) return 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    if (model->fixed[2 * i] || model->fixed[2 * i + 1]) return 0.0;
    sum += q[2 * i] * model->contacts.tangent[0] + q[2 * i + 1] * model->contacts.tangent[1];
  }
  return sum / model->node_count;
}

double strut_track_distance(const strut_track *a, const strut_track *b, double period) {
  const strut_model *model = a->model;
  size_t both = 2 * (size_t)model->node_count, count = a->count;
  double away = 0.0, motion = LEAST_MOTION * model->size;
  if (count != b->count || count < 2) return HUGE_VAL;
  double apart = (a->time[count - 1] - a->time[0]) / (double)(count - 1);
  double first = mean_along_ground(a, 0);
  for (size_t k = 0; k < count; k++) {
    double here = mean_along_ground(a, k), there = mean_along_ground(b, k);
    double later = a->time[k] - b->time[k];
    if (period > 0.0) later = remainder(later, period);
    if (fabs(later) > SAME_MOMENT * apart) return HUGE_VAL;
    for (size_t i = 0; i < both; i++) {
      double t =
          strut_contacts_allow_travel(&model->contacts) ? model->contacts.tangent[i % 2] : 0.0;
      double x = a->position[k * both + i] - here * t, y = b->position[k * both + i] - there * t;
      double x0 = a->position[i] - first * t;
      away = fmax(away, fabs(x - y));
      motion = fmax(motion, fabs(x - x0));
    }
  }
  return away / motion;
}

strut_status strut_simulate_as_asked(const strut_model *model, const strut_experiment *experiment,
                                     const strut_run_options *options, strut_summary *summary,
                                     strut_error *error) {
  return experiment->accuracy > 0.0
             ? strut_simulate_accurately(model, experiment, options, summary, error)
             : strut_simulate(model, experiment, options, summary, error);
}
