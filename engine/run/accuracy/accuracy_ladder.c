/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A wanted accuracy by repetition: ever finer runs, which differ in all settings, until two agree. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/accuracy.h"

/* Factor from one run with error control to the next. */
static const double FINER_TOLERANCE = 1.0 / 30.0;
/*
 * Tolerance of the first such run: at most, and over the wanted error. Looser ones cost hardly less, since
 * the cost is in the events and the longest step, and may agree with verlet-events on a motion that neither
 * leads to.
 */
static const double FIRST_TOLERANCE = 1e-5, FIRST_TOLERANCE_PER_ERROR = 1e-3;
/*
 * The method of higher order costs less for smaller errors wanted, and where tolerances set the steps, not events. Two
 * runs show that by their costs: one of order 5 needs twice the steps for a tolerance finer by FINER_TOLERANCE. Where the
 * cost grows faster, events have come up that the coarser run did not see.
 */
static const double PRECISE = 2e-6, GROWTH_BY_TOLERANCE = 1.6, GROWTH_BY_EVENTS = 3.0;
/* Smallest tolerance: below it rounding dominates. */
static const double LEAST_TOLERANCE = 3e-14;
/* Moments of a track: per period or run, and the most. */
enum { MOMENTS_OF_PERIOD = 10, MOST_MOMENTS = 61 };
/* Moments are at most this part of the shortest signal time apart; breaks of signals are stops, and none of it. */
static const double SIGNAL_FRACTION = 0.1;
/* Largest size of a track in doubles. */
static const double MOST_TRACK_NUMBERS = 4e6;
/*
 * Longest steps per moment of the runs with error control. They grow slowly, since the tolerance bounds the error and
 * the longest step the cost. Successive ones have no common divisor: two runs so meet at moments only, and a peak that
 * both miss in between is not missed alike.
 */
static const double STEPS_OF_MOMENT[STRUT_LADDER_RUNS] = {3,  4,  5,  7,  9,  11,
                                                          13, 17, 19, 23, 29, 31};

/*
 * Finds the time that the longest step divides, so that both ends of the window fall on the grid: a
 * period, or the largest fraction of the run that divides the start of the window; `*meets` is
 * false where there is none.
 */
static double find_grid_unit(const strut_accuracy *accuracy, bool *meets) {
  strut_span span = strut_experiment_span(&accuracy->experiment, accuracy->scene);
  *meets = true;
  if (span.period > 0.0) {
    double phase = span.window_start / span.period;
    *meets = fabs(phase - round(phase)) < 1e-9;
    return span.period;
  }
  for (int n = 1; n <= 20; n++) {
    double at = span.window_start / span.duration * n;
    if (fabs(at - round(at)) < 1e-9 * n) return span.duration / n;
  }
  *meets = false;
  return span.duration;
}

static double divide_evenly(double unit, double step) {
  return unit / ceil(unit / step * (1.0 - 1e-9));
}

/* Fixed steps between moments in the k-th run: twice as many from run to run, without a common divisor. */
static double count_steps_of_moment(double first, int k) {
  double count = first;
  for (int i = 0; i < k; i++) count = 2.0 * count + (i % 2 ? -1.0 : 1.0);
  return count;
}

/*
 * Settings of the k-th run: ever smaller steps where only one method suits the scene, otherwise first Verlet, with
 * half the step too where the run is short, and then error control.
 */
static strut_experiment refine_experiment(const strut_ladder *ladder, int k) {
  const strut_accuracy *accuracy = ladder->a;
  strut_experiment e = accuracy->coarse;
  e.steady.tolerance = fmin(e.steady.tolerance, 0.2 * accuracy->target);
  double coarse = ceil(ladder->moment / e.step * (1.0 - 1e-9));
  if (accuracy->single_method || k < ladder->coarse_runs) {
    e.step = ladder->moment / count_steps_of_moment(coarse, k);
    if (k > 0) e.refine_rate *= 0.5; /* steps after a touchdown are finer, too */
  } else {
    int further = k - ladder->coarse_runs;
    e.integrator = strut_integrator_for(ladder->implicit  ? STRUT_ROLE_IMPLICIT
                                        : ladder->precise ? STRUT_ROLE_PRECISE
                                                          : STRUT_ROLE_REFERENCE)
                       ->name;
    e.step = ladder->moment / STEPS_OF_MOMENT[further];
    e.tolerance = fmin(FIRST_TOLERANCE, FIRST_TOLERANCE_PER_ERROR * accuracy->target);
    e.tolerance = fmax(LEAST_TOLERANCE, e.tolerance * pow(FINER_TOLERANCE, further));
  }
  strut_span span = strut_experiment_span(&accuracy->experiment, accuracy->scene);
  double kept = (MOST_MOMENTS - 1) * ladder->moment;
  e.output_every = ladder->moment;
  e.output_last = kept < span.duration ? kept / (span.period > 0.0 ? span.period : 1.0) : 0.0;
  e.steady.run_on =
      (int64_t)ceil(e.output_last - 1e-9); /* of the answer too, whatever is recorded */
  return e;
}

/*
 * Difference of two runs, relative to the velocity; or, where the scene names quantities, the
 * largest over its allowed error, times the wanted accuracy, so that both are comparable. Fills
 * `difference` (quantities), SI.
 */
static double compare_results(strut_ladder *ladder, const strut_summary *one,
                              const strut_summary *other, double *difference) {
  double worst = 0.0;
  if (one->measured_count == 0)
    return fabs(one->velocity - other->velocity) /
           strut_ladder_velocity_size(ladder, one->velocity);
  for (size_t i = 0; i < one->measured_count; i++) {
    const strut_measured *measured = &one->measured[i];
    double apart = fabs(measured->value - other->measured[i].value) + measured->left,
           allowed = strut_ladder_tolerated_error(ladder, measured, i), doubt = 0.0;
    if (measured->arrival) {
      doubt = strut_ladder_arrival_doubt(measured, &other->measured[i]);
      if (isnan(measured->value) && doubt < HUGE_VAL)
        apart = 0.0; /* neither run reaches the target */
    }
    if (measured->zero && other->measured[i].zero) apart = 0.0;
    difference[i] = doubt > STRUT_LADDER_UNDECIDED ? (double)NAN : apart;
    if (apart == 0.0 && doubt == 0.0) continue;
    double part = ladder->a->target * fmax(doubt, apart > 0.0 ? apart / allowed : 0.0);
    if (!(part <= worst)) worst = isnan(part) ? HUGE_VAL : part;
    if (worst == (isnan(part) ? HUGE_VAL : part)) ladder->worst = i;
  }
  return worst;
}

/* The one before the latest run becomes the latest; of both there is one. */
static void step_back(strut_ladder *ladder) {
  strut_rung *unfinished = ladder->now;
  ladder->now = ladder->before;
  ladder->before = unfinished;
  ladder->runs--;
}

/* Runs that may fail: their tolerance or step is left out. */
enum { MOST_FAILURES = 2 };

/* The latest run has failed after one that has not. The method of higher order gives way to the usual one. */
static void discard_failed_run(strut_ladder *ladder) {
  bool coarse = ladder->runs <= ladder->coarse_runs;
  step_back(ladder);
  if (coarse)
    ladder->coarse_runs--, ladder->tried--;
  else if (ladder->precise)
    ladder->precise = false, ladder->imprecise = true, ladder->tried--;
  else
    ladder->failed = ++ladder->failures == MOST_FAILURES;
}

/* Keeps the results of the latest run, for their range. */
static void keep_results(const strut_ladder *ladder, const strut_summary *summary) {
  double *value =
      ladder->results + (size_t)(ladder->runs - 1) * (ladder->a->experiment.quantity_count + 1);
  for (size_t i = 0; i < summary->measured_count; i++) value[i] = summary->measured[i].value;
  value[summary->measured_count] = summary->velocity;
}

/* Makes one more run without output and compares it with the one before. */
static strut_status run_next_rung(strut_ladder *ladder) {
  strut_rung *next = ladder->runs == 0                 ? ladder->rung
                     : ladder->now == &ladder->rung[1] ? &ladder->rung[2]
                                                       : &ladder->rung[1];
  strut_run_options quiet = *ladder->a->options;
  strut_sink *sinks[] = {&next->track.sink};
  assert(next != ladder->now && ladder->tried < STRUT_LADDER_RUNS);
  ladder->before = ladder->now;
  ladder->now = next;
  strut_summary_free(&next->s);
  next->e = refine_experiment(ladder, ladder->tried++);
  ladder->runs++;
  strut_accuracy_begin_phase(ladder->a,
                             ladder->runs == 1 ? "first run" : "checking by a finer run");
  quiet.sinks = sinks, quiet.sink_count = 1, quiet.to = NULL;
  strut_status status = strut_accuracy_run(ladder->a, &next->e, &quiet, &next->s);
  next->cost = next->s.spent.evaluations;
  ladder->a->check_evaluations += next->cost;
  if (status == STRUT_WORK_LIMIT) { /* the run before becomes the answer, if there is one */
    ladder->budget_spent = true;
    if (ladder->runs < 2) return STRUT_WORK_LIMIT;
    step_back(ladder);
    return STRUT_OK;
  }
  if (status == STRUT_DIVERGED && ladder->before && ladder->before->s.status == STRUT_OK) {
    discard_failed_run(ladder);
    return STRUT_OK;
  }
  if (strut_ladder_runs_with_error_control(ladder) > 1) { /* do tolerances set the steps? */
    double growth = (double)ladder->now->cost / (double)ladder->before->cost;
    if (growth > GROWTH_BY_TOLERANCE && growth < GROWTH_BY_EVENTS)
      ladder->precise = !ladder->imprecise && !ladder->implicit;
  }
  ladder->earliest_change = ladder->earlier_change;
  ladder->earlier_change = ladder->change;
  ladder->earlier_distance = ladder->distance;
  ladder->change = ladder->distance = HUGE_VAL;
  if (status && status != STRUT_DIVERGED) return status;
  keep_results(ladder, &next->s);
  if (status || ladder->runs == 1 || ladder->before->s.status) return STRUT_OK;
  double period = next->e.steady.wanted
                      ? strut_experiment_span(&ladder->a->experiment, ladder->a->scene).period
                      : 0.0;
  ladder->change = compare_results(ladder, &next->s, &ladder->before->s, ladder->difference);
  ladder->distance = strut_track_distance(&next->track, &ladder->before->track, period);
  return STRUT_OK;
}

/*
 * Of scenes whose fixed steps are so many, the first run with error control is tried before, for at most a part of the
 * evaluations that fixed steps take: what sets their step may never touch, or move far less than the rest.
 */
static const double PROBED = 2e5, PROBE = 0.125, PROBE_IMPLICIT = 0.05;
/* All runs may take so many times the evaluations of one that replaces fixed steps, for the usual budget. */
static const double RUNS_OF_PROBE = 64.0;
/* Free coordinates of an implicit step at most, and least damping over the critical one of what it does not follow. */
enum { MOST_IMPLICIT = 128 };
static const double DAMPED = 0.1;

static bool is_damped(double stiffness, double damping, double per_mass) {
  return damping * per_mass >= 2.0 * DAMPED * sqrt(stiffness * per_mass);
}

/* May steps be longer than vibrations? They must die out by themselves, not by the method. */
static bool suits_implicit_steps(const strut_model *model) {
  const strut_member_table *members = &model->members;
  bool suits = 2 * model->node_count <= MOST_IMPLICIT && !model->elements.count &&
               !(model->terms & STRUT_TERM_MEMORY);
  for (int32_t j = 0; j < members->count && suits; j++)
    suits = is_damped(
        members->stiffness[j], members->damping[j],
        1.0 / model->weight[members->from[j] / 2] + 1.0 / model->weight[members->to[j] / 2]);
  for (int32_t i = 0; i < model->contacts.count && suits; i++) {
    const strut_contact_entry *contact = &model->contacts.entry[i];
    suits = is_damped(contact->stiffness, contact->damping, 1.0 / model->weight[contact->node]);
  }
  return suits;
}

/* Tries whether runs with error control alone are cheaper; then the budget follows from their cost. */
static strut_status probe(strut_ladder *ladder, bool implicit) {
  strut_accuracy *accuracy = ladder->a;
  double steps = strut_experiment_span(&accuracy->experiment, accuracy->scene).duration /
                 accuracy->coarse.step;
  double part = implicit ? PROBE_IMPLICIT : PROBE;
  if (accuracy->single_method || ladder->runs || !(steps > PROBED)) return STRUT_OK;
  if (implicit && !suits_implicit_steps(ladder->model)) return STRUT_OK;
  int64_t allowed = accuracy->allowed;
  int coarse_runs = ladder->coarse_runs;
  accuracy->allowed = (int64_t)fmin((double)accuracy->used + part * steps, (double)allowed);
  ladder->coarse_runs = 0;
  ladder->implicit = implicit;
  strut_status status = run_next_rung(ladder);
  accuracy->allowed = allowed;
  if (status && status != STRUT_WORK_LIMIT) return status;
  if (!status && ladder->now->s.status == STRUT_OK) {
    double budget = accuracy->experiment.budget / STRUT_USUAL_BUDGET * RUNS_OF_PROBE *
                    (double)ladder->now->cost;
    accuracy->budget = (int64_t)fmin((double)accuracy->budget,
                                     fmax(budget, strut_accuracy_least_budget(accuracy)));
    accuracy->allowed = accuracy->budget;
    return STRUT_OK;
  }
  ladder->coarse_runs = coarse_runs, ladder->runs = ladder->tried = 0;
  ladder->now = ladder->before = NULL;
  ladder->budget_spent = ladder->implicit = false;
  return STRUT_OK;
}

static bool may_refine(const strut_ladder *ladder) {
  if (ladder->kept || ladder->failed || ladder->creeps || ladder->budget_spent ||
      ladder->tried >= STRUT_LADDER_RUNS)
    return false;
  if (ladder->sensitivity > ladder->a->target && !ladder->model->feedback.sampled_count)
    return false;
  if (strut_ladder_runs_with_error_control(ladder) < 1 || ladder->a->single_method) return true;
  return ladder->now->e.tolerance > LEAST_TOLERANCE;
}

static strut_status create_ladder(strut_accuracy *accuracy, strut_ladder *ladder) {
  bool meets = true;
  strut_status status = STRUT_OK;
  ladder->model = accuracy->model;
  ladder->unit = find_grid_unit(accuracy, &meets);
  ladder->moment = ladder->unit / MOMENTS_OF_PERIOD;
  double signals = strut_accuracy_signal_time(accuracy, !accuracy->single_method);
  if (ladder->moment > SIGNAL_FRACTION * signals)
    ladder->moment = divide_evenly(ladder->moment, SIGNAL_FRACTION * signals);
  /* where the signals set steps within moments, two runs of one method share them, and their error */
  bool shares = strut_drive_is_looked_at(accuracy->model) ||
                SIGNAL_FRACTION * strut_accuracy_signal_time(accuracy, false) < ladder->moment;
  if (!meets)
    ladder->moment =
        divide_evenly(ladder->moment, fmin(ladder->unit / 40.0, 5.0 * accuracy->coarse.step));
  double capacity = MOST_TRACK_NUMBERS / (2.0 * ladder->model->node_count);
  size_t moments = capacity < 2.0 ? 2 : capacity < MOST_MOMENTS ? (size_t)capacity : MOST_MOMENTS;
  /* Two steps of one method may lead to the same wrong motion: they must agree from the start on. */
  double duration = strut_experiment_span(&accuracy->experiment, accuracy->scene).duration;
  ladder->coarse_runs = !shares && duration <= (double)(moments - 1) * ladder->moment ? 2 : 1;
  if (accuracy->single_method) ladder->coarse_runs = 0;
  for (int k = 0; k < 3 && !status; k++)
    status = strut_track_create(ladder->model, moments, &ladder->arena, &ladder->rung[k].track);
  size_t quantities = accuracy->experiment.quantity_count;
  bool ready = !status && STRUT_NUMBERS(&ladder->arena, STRUT_LADDER_RUNS * (quantities + 1),
                                        &ladder->difference, &ladder->shifted, &ladder->results);
  return ready ? STRUT_OK : strut_no_memory(accuracy->error, "");
}

/* ---- sensitivity to the start ---- */

/*
 * Only two runs with tolerances below this are checked: coarser ones differ from each other by more than the
 * shift, so that their difference contains its effect. Where signals are sampled, two runs may agree on one side of a
 * threshold, and the answer hangs on it: the shift is then that of positions that the tolerance allows.
 */
static const double CHECKED_BELOW = 1e-8;

/* The start with every free coordinate shifted, up or down. */
static strut_status shift_start(strut_ladder *ladder, double shift, strut_snapshot *start) {
  const strut_model *model = ladder->model;
  size_t bytes = (size_t)model->length * sizeof(double);
  strut_state *state = NULL;
  if (!STRUT_NUMBERS(&ladder->arena, model->length, &start->q, &start->v))
    return strut_no_memory(ladder->a->error, "");
  strut_status status = strut_state_create(model, &state, ladder->a->error);
  if (status) return status;
  memcpy(start->q, state->q, bytes);
  memcpy(start->v, state->v, bytes);
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    if (!model->fixed[i]) start->q[i] += (i % 3 ? -shift : shift) * model->size;
  strut_state_free(state);
  return STRUT_OK;
}

/* Repeats the run before the latest from the shifted start, which may change the answer by the wanted error. */
static strut_status check_sensitivity(strut_ladder *ladder) {
  strut_accuracy *accuracy = ladder->a;
  strut_run_options quiet = *accuracy->options;
  strut_snapshot start = {.q = NULL};
  strut_summary shifted = {0};
  const strut_rung *rung =
      ladder->before && !ladder->before->s.status ? ladder->before : ladder->now;
  int64_t allowed = accuracy->allowed;
  bool lost = strut_ladder_is_lost(ladder);
  if (!(ladder->same_motion || lost) || accuracy->single_method ||
      strut_ladder_runs_with_error_control(ladder) < 2)
    return STRUT_OK;
  if (!(rung->e.tolerance < CHECKED_BELOW || lost) && !ladder->model->feedback.sampled_count)
    return STRUT_OK;
  ladder->shift = STRUT_LADDER_SHIFT; /* over the size of the structure */
  if (ladder->model->feedback.sampled_count)
    ladder->shift = fmax(ladder->shift, 0.01 * rung->e.tolerance);
  strut_status status = shift_start(ladder, ladder->shift, &start);
  if (status) return status;
  quiet.sink_count = 0, quiet.to = NULL, quiet.from = &start;
  strut_accuracy_begin_phase(accuracy, "checking with a shifted start");
  accuracy->allowed = INT64_MAX; /* the same run was within the budget before */
  status = strut_accuracy_run(accuracy, &rung->e, &quiet, &shifted);
  accuracy->allowed = allowed;
  accuracy->check_evaluations += shifted.spent.evaluations;
  size_t worst = ladder->worst;
  ladder->sensitivity =
      status ? HUGE_VAL : compare_results(ladder, &rung->s, &shifted, ladder->shifted);
  ladder->worst = worst;
  ladder->kept = ladder->kept && ladder->sensitivity <= accuracy->target;
  strut_summary_free(&shifted);
  return status == STRUT_DIVERGED ? STRUT_OK : status;
}

strut_status strut_accuracy_climb_ladder(strut_accuracy *accuracy) {
  strut_ladder l = {.a = accuracy,
                    .change = HUGE_VAL,
                    .earlier_change = HUGE_VAL,
                    .earliest_change = HUGE_VAL,
                    .distance = HUGE_VAL,
                    .expected = HUGE_VAL,
                    .precise = accuracy->target < PRECISE};
  strut_status status = create_ladder(accuracy, &l);
  if (!status) status = probe(&l, true);
  if (!status) status = probe(&l, false);
  while (!status && may_refine(&l)) {
    status = run_next_rung(&l);
    if (status || l.budget_spent || l.failed) break;
    if (l.runs > 1) strut_ladder_judge(&l);
    strut_ladder_extend_coarse(&l);
    if (l.kept || strut_ladder_is_lost(&l)) status = check_sensitivity(&l);
  }
  if (!status && !l.kept && !(l.sensitivity > accuracy->target)) {
    strut_ladder_judge_last(&l);
    status = check_sensitivity(&l);
  }
  if (!status) status = strut_accuracy_deliver(accuracy, &l.now->e, &l.now->s);
  if (!status) strut_ladder_report(&l);
  for (int k = 0; k < 3; k++) strut_summary_free(&l.rung[k].s);
  strut_arena_free(&l.arena);
  return status;
}
