/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Motions that do not repeat themselves: their mean velocity over the latter half of a long run, with the confidence
 * interval of its batches (steady_detector.c). Two runs by different steps must agree within both intervals.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/integrate/integrator.h"
#include "engine/run/accuracy/orbit_solve.h"

/* Periods of the first runs for a mean, and the least factor from runs to longer ones. */
static const double PERIODS = 136.0, LONGER = 3.0;
/* Periods added while the motion is transient. */
static const double MORE_PERIODS = 544.0;
/* Part of the evaluations left that runs for a mean may take, the last and longest of them. */
static const double PART = 0.4;
/* An interval is enough that is this part of the wanted error, or smaller. */
static const double ENOUGH = 0.6;
/* Tolerance to which such a run must repeat itself to count as periodic. */
static const double PERIODIC = 1e-4;
/* Eight batches of half a run are not quite independent: their interval is widened by this. */
static const double WIDER = 1.25;

static void continue_coarse_run(strut_orbit_solve *solve, double periods) {
  strut_orbit_solve_run_on(solve, solve->a->coarse, solve->a->target, 5, periods, true,
                           &solve->coarse_run);
}

/* Runs from solve->end, which becomes the run's end. What the run was counts as a check. */
static strut_orbit_mean run_for_mean(strut_orbit_solve *solve, strut_experiment e, double periods,
                                     strut_summary *run) {
  solve->a->check_evaluations += run->spent.evaluations;
  strut_summary_free(run);
  *run = (strut_summary){0};
  e.steady.creep = 0.0;
  e.measure_last = ceil(0.5 * fmin(periods, e.periods));
  strut_orbit_solve_run_until_steady(solve, e, PERIODIC, 8, periods, true, run);
  bool repeats = run->steady.kind == STRUT_MOTION_PERIODIC;
  return (strut_orbit_mean){
      .velocity = repeats ? run->velocity : run->steady.mean,
      .interval = repeats ? run->steady.interval : WIDER * run->steady.scatter,
      .periods = run->steady.periods};
}

/* Do two means differ by no more than their scatter? Neither is known of runs that were too short. */
static bool agree(const strut_orbit_mean *one, const strut_orbit_mean *other) {
  return fabs(one->velocity - other->velocity) <= hypot(one->interval, other->interval);
}

/* Most periods of a run for a mean of which one takes `cost` evaluations. */
static double most_periods(const strut_orbit_solve *solve, double cost) {
  double left = PART * (double)strut_accuracy_evaluations_left(solve->a);
  return fmin(solve->a->experiment.periods, left / fmax(1.0, cost));
}

/* Evaluations of a drive period in a run. */
static double cost_of_period(const strut_summary *run) {
  return (double)run->spent.evaluations / fmax(1.0, (double)run->steady.periods);
}

/* The answer is the latest run with its mean, unless it was too short to know that. */
static void accept_mean(strut_orbit_solve *solve, strut_orbit_answer answer, strut_summary *run,
                        strut_orbit_mean mean) {
  strut_summary_append(&solve->last_run, run);
  if (!isfinite(mean.interval)) return;
  solve->mean = mean;
  solve->last_run.velocity = mean.velocity;
  if (solve->last_run.steady.kind == STRUT_MOTION_TRANSIENT)
    solve->last_run.steady.kind = STRUT_MOTION_IRREGULAR;
  strut_orbit_solve_accept_last_run(solve, answer, mean.interval);
}

/* Ever longer runs from solve->orbit by the coarse step and by half of it, until the mean of the latter, whose end is
   solve->end, is known well enough. */
static void run_by_two_steps(strut_orbit_solve *solve, strut_orbit_place *end, strut_summary run[2],
                             strut_orbit_mean mean[2]) {
  strut_accuracy *accuracy = solve->a;
  const strut_experiment by[2] = {accuracy->coarse, strut_orbit_solve_halve_step(solve)};
  double most = most_periods(solve, 3.0 * cost_of_period(&solve->coarse_run));
  for (double periods = fmin(PERIODS, most);;) {
    for (int k = 0; k < 2; k++) {
      strut_orbit_place_copy(solve, &solve->known, &solve->end);
      mean[k] = run_for_mean(solve, by[k], periods, &run[k]);
      if (solve->status) return;
      if (k == 0) strut_orbit_place_copy(solve, &solve->end, end);
    }
    double size = strut_accuracy_velocity_scale(accuracy, mean[1].velocity);
    double wanted = ENOUGH * accuracy->target * size;
    mean[1].apart = fabs(mean[1].velocity - mean[0].velocity);
    bool enough = mean[1].interval <= wanted && mean[1].apart <= wanted;
    if (!(periods < most) || !agree(&mean[0], &mean[1]) || enough) return;
    double missing =
        fmax(mean[1].interval, mean[1].apart) / wanted; /* it falls with the square root */
    periods = fmin(periods * fmax(LONGER, missing * missing), most);
  }
}

/*
 * Mean velocity of the motion from solve->end by the coarse method with half its step, checked by that with its
 * whole step: over as many periods as the wanted accuracy takes, the scene has and the budget allows. Where both
 * differ by more than their scatter, a third run from where the second has ended decides. Sets solve->answer.
 */
static void average(strut_orbit_solve *solve) {
  strut_orbit_place end = {.y = strut_orbit_solve_array(solve)};
  strut_summary run[2] = {{0}, {0}};
  strut_orbit_mean mean[2] = {{.periods = 0}, {.periods = 0}};
  if (solve->status) return;
  strut_accuracy_begin_phase(solve->a, "averaging over many periods");
  strut_orbit_place_copy(solve, &solve->end, &solve->known);
  run_by_two_steps(solve, &end, run, mean);
  solve->a->check_evaluations += run[0].spent.evaluations;
  if (!solve->status &&
      !agree(&mean[0], &mean[1])) { /* does the half step leave the other motion? */
    strut_orbit_mean before = mean[1];
    strut_orbit_place_copy(solve, &end, &solve->end);
    mean[1] =
        run_for_mean(solve, strut_orbit_solve_halve_step(solve), (double)before.periods, &run[1]);
    mean[1].apart = fmax(before.apart, fabs(mean[1].velocity - before.velocity));
    mean[1].disputed = !agree(&mean[1], &before);
    mean[1].interval += mean[1].apart; /* the step may change more than the mean scatters */
  }
  if (!solve->status) accept_mean(solve, STRUT_ORBIT_IRREGULAR, &run[1], mean[1]);
  for (int k = 0; k < 2; k++) strut_summary_free(&run[k]);
}

bool strut_orbit_solve_average_irregular(strut_orbit_solve *solve) {
  const strut_steady_summary *found = &solve->coarse_run.steady;
  solve->answer = STRUT_ORBIT_NONE;
  if (found->kind != STRUT_MOTION_IRREGULAR) continue_coarse_run(solve, PERIODS);
  if (!solve->status && found->kind == STRUT_MOTION_CREEPING) {
    strut_orbit_solve_confirm_creep(solve);
    if (solve->answer) return false;
    solve->a->coarse.steady.creep = 0.0;
    continue_coarse_run(solve, PERIODS);
  }
  if (found->kind == STRUT_MOTION_TRANSIENT) continue_coarse_run(solve, MORE_PERIODS);
  if (!solve->status && found->kind == STRUT_MOTION_IRREGULAR) average(solve);
  return !solve->status && found->kind == STRUT_MOTION_PERIODIC;
}

void strut_orbit_solve_average_disputed(strut_orbit_solve *solve) {
  strut_summary run = {0};
  strut_orbit_mean orbit = {.velocity = solve->coarse_run.velocity};
  if (solve->status) return;
  double most = most_periods(solve, cost_of_period(&solve->last_run));
  strut_orbit_mean mean = run_for_mean(solve, solve->reference, fmax(PERIODS, most), &run);
  if (!solve->status) {
    mean.apart = fabs(mean.velocity - orbit.velocity);
    bool left =
        run.steady.kind == STRUT_MOTION_PERIODIC; /* an orbit of its own, from the coarse one */
    mean.disputed = !left && !agree(&mean, &orbit);
    if (left || mean.disputed) mean.interval += mean.apart;
    accept_mean(solve, STRUT_ORBIT_DISPUTED, &run, mean);
  }
  strut_summary_free(&run);
}

void strut_orbit_solve_explain_mean(const strut_orbit_solve *solve, char *text, size_t size) {
  const strut_orbit_mean *mean = &solve->mean;
  double step = solve->coarse_map.dt;
  char how[160];
  if (solve->answer == STRUT_ORBIT_DISPUTED)
    snprintf(how, sizeof how,
             "verlet-events with a step of %.3g s finds a periodic motion and adaptive (tolerance "
             "%.1g) does not",
             step, solve->reference.tolerance);
  else
    snprintf(how, sizeof how,
             "the motion does not repeat itself, by verlet-events with steps of %.3g s and %.3g s",
             step, 0.5 * step);
  snprintf(
      text, size,
      "%s: the mean velocity over the latter half of the last %lld periods is known to %.2g m/s, "
      "and "
      "that of other runs differs by %.2g m/s%s; more periods or a larger budget narrow it",
      how, (long long)mean->periods, solve->error, mean->apart,
      mean->disputed ? ", more than they scatter: there are two motions, or a long transient" : "");
}
