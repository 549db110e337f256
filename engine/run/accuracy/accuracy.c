/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/accuracy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/model/pose.h"
#include "engine/run/orbit/orbit.h"
#include "engine/run/settle.h"
#include "engine/scene/signal_program.h"

/* Least steps per period. */
static const double LEAST_STEPS = 100.0;
/* The longest step as a part of the shortest turn. */
static const double STEP_OF_TURN = 0.1;
/* Velocities below this part of size over time are not measured relative to themselves. */
static const double STANDSTILL = 1e-3;

/* The budget counts in fine runs: four steps for each step of the coarse method, of four evaluations each. */
static const double FINE_STEPS = 4.0, FINE_EVALUATIONS = 4.0;
/* Work that is always allowed, in evaluations times nodes and members [1]. */
static const double LEAST_WORK = 4e7;

void strut_accuracy_begin_phase(const strut_accuracy *accuracy, const char *name) {
  if (accuracy->options->phase) accuracy->options->phase(accuracy->options->progress_context, name);
}

int64_t strut_accuracy_evaluations_left(const strut_accuracy *accuracy) {
  return accuracy->allowed > accuracy->used ? accuracy->allowed - accuracy->used : 1;
}

strut_status strut_accuracy_run(strut_accuracy *accuracy, const strut_experiment *experiment,
                                const strut_run_options *options, strut_summary *summary) {
  strut_experiment plain = *experiment;
  strut_run_options bounded = *options;
  plain.accuracy = accuracy->target; /* to which extremes are resolved */
  bounded.chosen = true;
  bounded.most_evaluations = strut_accuracy_evaluations_left(accuracy);
  strut_status status = strut_simulate(accuracy->model, &plain, &bounded, summary, accuracy->error);
  accuracy->used += summary->spent.evaluations;
  for (size_t i = 0; i < summary->warning_count; i++)
    accuracy->creeps = accuracy->creeps || strcmp(summary->warnings[i].code, "wide_band") == 0;
  return status;
}

strut_status strut_accuracy_deliver(strut_accuracy *accuracy, const strut_experiment *experiment,
                                    strut_summary *run) {
  accuracy->check_evaluations -= run->spent.evaluations;
  if (!accuracy->options->sink_count && !accuracy->options->to && run->status == STRUT_OK) {
    *accuracy->summary = *run;
    *run = (strut_summary){0};
    return STRUT_OK;
  }
  strut_experiment e = *experiment; /* the same run again, whose cost is counted once */
  strut_accuracy_begin_phase(accuracy, "recording the answer");
  accuracy->allowed = INT64_MAX; /* the same run was within the budget before */
  e.output_every = accuracy->experiment.output_every;
  e.output_last = accuracy->experiment.output_last;
  return strut_accuracy_run(accuracy, &e, accuracy->options, accuracy->summary);
}

/* No method supports both rigid bars and exact friction. */
static strut_status refuse_exact_friction(const strut_accuracy *accuracy) {
  const strut_model *model = accuracy->model;
  int32_t exact = strut_first_exact_contact(model);
  if (exact >= 0)
    return strut_fail(accuracy->error, STRUT_USAGE,
                      "no method supports both rigid bars and the friction law %s of node '%s'; "
                      "use bars: elastic, or the law karnopp",
                      strut_friction_law_at(model->contacts.entry[exact].friction.law)->word,
                      accuracy->scene->nodes[model->contacts.entry[exact].node].name);
  return STRUT_OK;
}

double strut_accuracy_least_budget(const strut_accuracy *accuracy) {
  double part = accuracy->experiment.budget / STRUT_USUAL_BUDGET;
  return part * LEAST_WORK / (double)(accuracy->scene->node_count + accuracy->scene->member_count);
}

/* Chooses verlet-events, or the method for rigid bars, with nearly its largest stable step. */
static strut_status choose_coarse_method(strut_accuracy *accuracy) {
  const strut_model *model = accuracy->model;
  double limit = 0.0;
  strut_span span = strut_experiment_span(&accuracy->experiment, accuracy->scene);
  double unit = span.period > 0.0 ? span.period : span.duration;
  strut_status status = STRUT_OK;
  if (!model->mass) return strut_fail(accuracy->error, STRUT_SINGULAR, "a free node has no mass");
  accuracy->single_method = model->terms & STRUT_TERM_RIGID; /* supported by one method only */
  if (accuracy->single_method) status = refuse_exact_friction(accuracy);
  if (status) return status;
  strut_experiment *experiment = &accuracy->coarse;
  *experiment = accuracy->experiment;
  experiment->accuracy = 0.0;
  experiment->integrator =
      strut_integrator_for(accuracy->single_method ? STRUT_ROLE_PLAIN : STRUT_ROLE_COARSE)->name;
  status = strut_step_limit_for_method(model, strut_integrator_find(experiment->integrator), &limit,
                                       accuracy->error);
  experiment->step = fmin(STRUT_COARSE_STEP * limit, unit / LEAST_STEPS);
  double turns = strut_scene_fastest_turn(accuracy->scene, span.duration, true).rate;
  experiment->step = fmin(experiment->step, STEP_OF_TURN / turns);
  accuracy->stiff = experiment->step < unit / LEAST_STEPS;
  experiment->refine = experiment->refine_time = 0.0;
  double fine = FINE_EVALUATIONS * FINE_STEPS * span.duration / experiment->step;
  accuracy->budget =
      (int64_t)fmin(fmax(experiment->budget * fine, strut_accuracy_least_budget(accuracy)), 1e18);
  if (accuracy->options->most_evaluations > 0 &&
      accuracy->options->most_evaluations < accuracy->budget)
    accuracy->budget = accuracy->options->most_evaluations;
  accuracy->allowed = accuracy->budget;
  accuracy->scale = STANDSTILL * model->size / unit;
  return status;
}

double strut_accuracy_transient_periods(const strut_accuracy *accuracy) {
  const strut_experiment *experiment = &accuracy->experiment;
  strut_span span = strut_experiment_span(experiment, accuracy->scene);
  return experiment->steady.wanted ? experiment->periods : 0.5 * span.window_start / span.period;
}

bool strut_accuracy_orbit_covers_window(const strut_accuracy *accuracy,
                                        const strut_steady_summary *steady) {
  const strut_experiment *experiment = &accuracy->experiment;
  if (experiment->steady.wanted) return true;
  double repetitions = experiment->measure_last / steady->repeats;
  return (double)steady->periods <= strut_accuracy_transient_periods(accuracy) &&
         fabs(repetitions - round(repetitions)) < 1e-9;
}

/* The answer is not certified, whatever finer runs say, which agree on its fault. */
static void withhold(strut_summary *summary) {
  summary->accuracy.kept = false, summary->accuracy.expected = (double)NAN;
  for (size_t m = 0; m < summary->measured_count; m++)
    summary->measured[m].kept = false, summary->measured[m].expected = (double)NAN;
}

/* Bands that are too wide, and friction that gave more of the exchanged energy than the wanted accuracy. */
static void refuse_wide_bands(const strut_accuracy *accuracy) {
  strut_summary *summary = accuracy->summary;
  bool gives = summary->energy.rubbed > summary->accuracy.wanted * summary->energy.moved;
  if (!accuracy->creeps && !(gives && summary->accuracy.kept)) return;
  withhold(summary);
  snprintf(summary->accuracy.why, sizeof summary->accuracy.why,
           "feet that should stick creep within their stick bands; use 'law: coulomb', or a far "
           "smaller stick_velocity");
}

bool strut_accuracy_balance_is_open(const strut_accuracy *accuracy, const strut_summary *summary) {
  return summary->balance == STRUT_BALANCE_OPEN &&
         !(fabs(summary->energy.residual) <= accuracy->target * summary->energy.moved);
}

/* Energy from nothing is no answer to rely on. */
static void refuse_open_balance(const strut_accuracy *accuracy) {
  strut_summary *summary = accuracy->summary;
  if (summary->status != STRUT_OK || !strut_accuracy_balance_is_open(accuracy, summary)) return;
  withhold(summary);
  snprintf(summary->accuracy.why, sizeof summary->accuracy.why,
           "%s with a step of %.3g s: the energy balance does not close: %.3g J, %.2g %% of the "
           "exchanged energy",
           summary->method, summary->step, summary->energy.residual,
           100.0 * fabs(summary->energy.residual) / summary->energy.moved);
}

/* Of a motion that has not become steady nothing is known but what it was within the window. */
static void refuse_transient(const strut_accuracy *accuracy) {
  strut_summary *summary = accuracy->summary;
  if (summary->status != STRUT_OK || summary->steady.kind != STRUT_MOTION_TRANSIENT) return;
  withhold(summary);
  snprintf(summary->accuracy.why, sizeof summary->accuracy.why,
           "the motion is not steady within %lld periods; more run.periods show whether it becomes "
           "so, and 'steady: no' measures its mean over the window",
           (long long)summary->steady.periods);
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
  if (!status && !done && velocity && experiment->periods > 0.0 && !a.single_method)
    status = strut_accuracy_try_orbit(&a, &done);
  if (!status && !done) status = strut_accuracy_climb_ladder(&a);
  summary->spent.wall_time = strut_run_clock() - begin;
  summary->status = status;
  if (summary->spent.forced) withhold(summary); /* as the strategy explains */
  refuse_transient(&a);
  refuse_open_balance(&a);
  summary->settle_time = start.how.time, summary->settle = start.how;
  strut_summary_warn_of_start(summary);
  refuse_wide_bands(&a);
  summary->accuracy.assumed = experiment->accuracy_assumed;
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
  strut_track *track = context;
  size_t both = 2 * (size_t)track->model->node_count;
  (void)error;
  for (size_t k = 0; k < count && track->count < track->capacity; k++, track->count++) {
    const double *row = rows + k * (both + 1);
    track->time[track->count] = row[0];
    memcpy(track->position + track->count * both, row + 1, both * sizeof(double));
  }
  return STRUT_OK;
}

strut_status strut_track_create(const strut_model *model, size_t capacity, strut_arena *arena,
                                strut_track *track) {
  size_t both = 2 * (size_t)model->node_count;
  *track = (strut_track){.model = model, .capacity = capacity};
  track->sink = (strut_sink){track, begin_track, record_track_rows, NULL, STRUT_CHANNEL_POSITION};
  bool ready = STRUT_ALLOCATE(arena, STRUT_NEW(track->time, capacity),
                              STRUT_NEW(track->position, capacity * both));
  return ready ? STRUT_OK : STRUT_NO_MEMORY;
}

/* Mean position along the ground at moment k; 0 where the structure cannot travel. */
static double mean_along_ground(const strut_track *track, size_t k) {
  const double *positions = track->position + 2 * k * (size_t)track->model->node_count;
  return strut_model_travels(track->model) ? strut_mean_along_ground(track->model, positions) : 0.0;
}

double strut_track_distance(const strut_track *track, const strut_track *second, double period) {
  const strut_model *model = track->model;
  size_t both = 2 * (size_t)model->node_count, count = track->count;
  double away = 0.0, motion = LEAST_MOTION * model->size;
  if (count != second->count || count < 2) return HUGE_VAL;
  double apart = (track->time[count - 1] - track->time[0]) / (double)(count - 1);
  double first = mean_along_ground(track, 0);
  for (size_t k = 0; k < count; k++) {
    double here = mean_along_ground(track, k), there = mean_along_ground(second, k);
    double later = track->time[k] - second->time[k];
    if (period > 0.0) later = remainder(later, period);
    if (fabs(later) > SAME_MOMENT * apart) return HUGE_VAL;
    for (size_t i = 0; i < both; i++) {
      double t =
          strut_contacts_allow_travel(&model->contacts) ? model->contacts.tangent[i % 2] : 0.0;
      double x = track->position[k * both + i] - here * t,
             y = second->position[k * both + i] - there * t;
      double x0 = track->position[i] - first * t;
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
