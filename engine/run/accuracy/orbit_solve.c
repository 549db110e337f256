/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/orbit_solve.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

double strut_accuracy_velocity_scale(const strut_accuracy *accuracy, double velocity) {
  return fmax(fabs(velocity), accuracy->scale);
}

void strut_orbit_solve_count_evaluations(strut_orbit_solve *solve) {
  int64_t made = solve->coarse_map.evaluations + solve->reference_map.evaluations;
  solve->a->used += made > solve->counted ? made - solve->counted : 0;
  solve->counted = made;
}

void strut_summary_append(strut_summary *whole, strut_summary *part) {
  int64_t steps = whole->spent.steps + part->spent.steps,
          events = whole->spent.events + part->spent.events;
  int64_t evaluations = whole->spent.evaluations + part->spent.evaluations,
          forced = whole->spent.forced + part->spent.forced;
  int64_t periods = whole->steady.periods + part->steady.periods;
  double duration = whole->duration + part->duration,
         wall = whole->spent.wall_time + part->spent.wall_time;
  double settle = whole->settle_time;
  strut_summary_free(whole);
  *whole = *part;
  *part = (strut_summary){0};
  whole->spent.steps = steps, whole->spent.events = events, whole->spent.evaluations = evaluations;
  whole->spent.forced = forced;
  whole->duration = duration, whole->spent.wall_time = wall, whole->settle_time = settle;
  whole->steady.periods = periods;
}

/* Periods within which a slow motion may yet repeat itself. */
enum { CREEP_AFTER = 48 };

void strut_orbit_solve_run_until_steady(strut_orbit_solve *solve, strut_experiment e,
                                        double tolerance, int32_t successive, double periods,
                                        bool from_end, strut_summary *summary) {
  strut_accuracy *accuracy = solve->a;
  if (solve->status) return;
  strut_orbit_place *end = &solve->end;
  const strut_snapshot from = strut_orbit_place_snapshot(solve, end);
  strut_snapshot to = from;
  e.steady.wanted = true;
  e.steady.tolerance = tolerance;
  e.steady.floor = tolerance * accuracy->scale;
  e.steady.creep_after = from_end ? 0 : CREEP_AFTER;
  e.steady.successive = successive;
  e.periods = fmin(e.periods, periods);
  e.measure_last = fmin(e.measure_last, e.periods);
  e.output_last = 0.0;
  /* the energy of the first run tells whether its step is too large: what it leads to would look periodic, too */
  strut_run_options options = {.without_balance = from_end && accuracy->options->without_balance,
                               .interrupt = accuracy->options->interrupt,
                               .progress = accuracy->options->progress,
                               .progress_context = accuracy->options->progress_context,
                               .from = from_end ? &from : accuracy->options->from,
                               .to = &to};
  if (!from_end) end->energy = (strut_energy){0}, end->steps = end->events = 0;
  solve->status = strut_accuracy_run(accuracy, &e, &options, summary);
  end->time = to.time, end->y[solve->both - 1] = to.refined;
  end->energy = summary->energy; /* it continues that of the runs before */
  end->steps += summary->spent.steps;
  end->events += summary->spent.events;
}

void strut_orbit_solve_run_on(strut_orbit_solve *solve, strut_experiment experiment,
                              double tolerance, int32_t successive, double periods, bool from_end,
                              strut_summary *run) {
  strut_summary more = {0};
  strut_orbit_solve_run_until_steady(solve, experiment, tolerance, successive, periods, from_end,
                                     &more);
  if (!solve->status) strut_summary_append(run, &more);
  strut_summary_free(&more);
}

double *strut_orbit_solve_array(strut_orbit_solve *solve) {
  double *array = strut_arena_allocate(&solve->arena, solve->both, sizeof *array);
  if (!array) solve->status = strut_no_memory(solve->a->error, "");
  return array;
}

void strut_orbit_place_copy(const strut_orbit_solve *solve, const strut_orbit_place *from,
                            strut_orbit_place *to) {
  double *y = to->y;
  memcpy(y, from->y, solve->both * sizeof *y);
  *to = *from;
  to->y = y;
}

strut_snapshot strut_orbit_place_snapshot(const strut_orbit_solve *solve,
                                          const strut_orbit_place *place) {
  return (strut_snapshot){.q = place->y,
                          .v = place->y + (solve->both - 1) / 2,
                          .time = place->time,
                          .refined = place->y[solve->both - 1],
                          .balance = &place->energy};
}

/* ---- the reference method and the check of its tolerance ---- */

/* Periods in which a finer tolerance should become steady from the orbit of a coarser one. */
static const double TRIAL = 40.0;
enum { MOST_CHECKS = 4 };

bool strut_orbit_solve_check_maps(strut_orbit_solve *solve, strut_status status) {
  strut_error *error = solve->a->error;
  if (status) solve->status = strut_fail(error, status, "out of memory");
  if (status) return false;
  strut_orbit_solve_count_evaluations(solve);
  if (strut_period_map_spent(&solve->coarse_map) || strut_period_map_spent(&solve->reference_map))
    solve->status = strut_fail(error, STRUT_WORK_LIMIT,
                               "the work budget was used up while the orbit was corrected");
  else if (strut_period_map_interrupted(&solve->coarse_map))
    solve->status = strut_fail(error, STRUT_INTERRUPTED,
                               "interrupted at t = %.9g s, while the orbit was corrected",
                               solve->coarse_map.time);
  return !solve->status;
}

/* Corrections of orbits to which a transient returns slowly were too small by up to a fifth of the estimate. */
static const double SLOW_RETURN = 1.3;
/* Of the square of the relative change by corrections, what they may leave. */
static const double SECOND_ORDER = 0.05;

double strut_orbit_solve_error_share(const strut_orbit_solve *solve, strut_orbit_answer answer) {
  double velocity =
      answer == STRUT_ORBIT_COARSE ? solve->coarse_run.velocity : solve->orbit.velocity;
  double wanted = solve->a->target * strut_accuracy_velocity_scale(solve->a, velocity);
  if (answer >= STRUT_ORBIT_IRREGULAR) return solve->error / wanted;
  double share = fmax(solve->error, solve->apart) / wanted +
                 solve->reference.tolerance / STRUT_TOLERANCE_PER_ERROR / 3.0 / solve->a->target;
  double moved = fabs(solve->orbit.velocity - solve->coarse_run.velocity) / wanted;
  /* a correction is not known better than the fixed point it starts from was sought, nor than its second order */
  if (answer == STRUT_ORBIT_CORRECTED)
    share += STRUT_FIXED_POINT_PART + SECOND_ORDER * moved * moved * solve->a->target;
  if (answer == STRUT_ORBIT_COARSE) share += moved;
  return SLOW_RETURN * share;
}

static void accept_reference_run(strut_orbit_solve *solve) {
  strut_orbit_place_copy(solve, &solve->end, &solve->known);
  solve->orbit.velocity = solve->last_run.velocity;
  solve->error = solve->last_run.steady.interval;
  solve->answer = STRUT_ORBIT_REFERENCE;
}

void strut_orbit_solve_run_reference(strut_orbit_solve *solve, bool from_orbit, double periods) {
  if (solve->status) return;
  strut_accuracy_begin_phase(solve->a, "until steady by adaptive");
  strut_orbit_place_copy(solve, &solve->known, &solve->end);
  double wanted = solve->a->target * strut_accuracy_velocity_scale(solve->a, solve->orbit.velocity);
  solve->apart = 0.0;
  /* a failed correction means a sensitive orbit, for which local errors matter more than usual */
  if (!solve->tightened && !(solve->error <= 0.8 * wanted)) {
    solve->reference.tolerance = fmax(1e-12, solve->reference.tolerance / STRUT_TIGHTENED);
    solve->tightened = true;
  }
  strut_orbit_solve_run_on(solve, solve->reference, fmin(0.001, 0.2 * solve->a->target), 4, periods,
                           from_orbit, &solve->last_run);
  if (!solve->status && solve->last_run.steady.kind == STRUT_MOTION_PERIODIC)
    accept_reference_run(solve);
}

/* The error is no less than the difference from a finer result, unless it is too large then. */
static bool admits_difference(strut_orbit_solve *solve, double apart) {
  double error = solve->error;
  solve->error = fmax(error, apart);
  if (strut_orbit_solve_error_share(solve, STRUT_ORBIT_REFERENCE) <= 1.0) return true;
  solve->error = error;
  return false;
}

/*
 * Repeats a sensitive orbit with a tenth of the tolerance. It is accepted if the difference is part of the error;
 * otherwise the finer result replaces it and is checked likewise.
 */
static void repeat_with_finer_tolerance(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  bool stands = false, periodic = true;
  for (int k = 0; k < MOST_CHECKS && !solve->status && !stands && periodic; k++) {
    strut_summary finer = {0};
    strut_experiment e = solve->reference;
    strut_orbit_place_copy(solve, &solve->known, &solve->end);
    e.tolerance = fmax(1e-12, 0.1 * e.tolerance);
    strut_orbit_solve_run_until_steady(solve, e, fmin(0.001, 0.2 * accuracy->target), 4, TRIAL,
                                       true, &finer);
    periodic = !solve->status && finer.steady.kind == STRUT_MOTION_PERIODIC;
    double apart = fabs(finer.velocity - solve->orbit.velocity);
    stands = periodic && admits_difference(solve, apart);
    if (stands || !periodic) {
      accuracy->check_evaluations += finer.spent.evaluations;
    } else {
      strut_summary_append(&solve->last_run, &finer);
      solve->reference.tolerance = e.tolerance;
      accept_reference_run(solve);
      solve->error = fmax(solve->error, 0.5 * apart);
    }
    strut_summary_free(&finer);
  }
}

/* Corrects the orbit by a period with a tenth of the tolerance; where that changes it too much, runs on with that. */
static void correct_with_finer_tolerance(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  strut_period_map *coarse = &solve->coarse_map, map = {.model = NULL};
  strut_experiment finer = solve->reference;
  strut_orbit there = {.y = strut_orbit_solve_array(solve)};
  if (solve->status) return;
  memcpy(there.y, solve->orbit.y, solve->both * sizeof(double));
  finer.tolerance = fmax(1e-12, 0.1 * finer.tolerance);
  double half =
      0.5 * accuracy->target * strut_accuracy_velocity_scale(accuracy, solve->orbit.velocity);
  int64_t before = coarse->evaluations;
  solve->status =
      strut_period_map_create(accuracy->model, &finer, coarse->repeats, &map, accuracy->error);
  if (solve->status) return;
  map.interrupt = coarse->interrupt, map.time = coarse->time;
  map.most_evaluations = strut_accuracy_evaluations_left(accuracy);
  strut_status status = strut_orbit_correct(coarse, &map, solve->fixed_point, solve->travel,
                                            0.1 * half * coarse->period, &there);
  int64_t made = coarse->evaluations - before + map.evaluations;
  accuracy->check_evaluations += made;
  accuracy->used += made;
  coarse->evaluations = before;
  strut_period_map_free(&map);
  if (!strut_orbit_solve_check_maps(solve, status)) return;
  double apart = there.converged ? fabs(there.velocity - solve->orbit.velocity) : HUGE_VAL;
  if (!admits_difference(solve, apart)) repeat_with_finer_tolerance(solve);
}

void strut_orbit_solve_check_tolerance(strut_orbit_solve *solve) {
  if (solve->tightened)
    repeat_with_finer_tolerance(solve);
  else
    correct_with_finer_tolerance(solve);
}

/* ---- motions without an orbit to correct: stuck or creeping; irregular ones are in orbit_means.c ---- */

/* Periods in which a run with half the step must prove to creep, too. */
static const double CREEPING = 30.0;
/* A slow creep may end, double or turn round later: by at most this part of the scale, if it is no faster. */
static const double CREEP_CHANGES = 0.02;

strut_experiment strut_orbit_solve_halve_step(const strut_orbit_solve *solve) {
  strut_experiment half = solve->a->coarse;
  half.step *= 0.5, half.refine_rate *= 0.5; /* steps after a touchdown are halved, too */
  half.steady.creep = 0.0;
  return half;
}

void strut_orbit_solve_accept_last_run(strut_orbit_solve *solve, strut_orbit_answer end,
                                       double error) {
  strut_orbit_place_copy(solve, &solve->end, &solve->known);
  solve->orbit.velocity = solve->last_run.velocity;
  solve->error = error;
  solve->answer = end;
}

bool strut_orbit_solve_is_stuck(const strut_orbit_solve *solve) {
  const strut_contact_table *contacts = &solve->coarse_map.model->contacts;
  double band = 0.0;
  for (int32_t i = 0; i < contacts->count; i++)
    band = fmax(band, contacts->entry[i].friction.stick_velocity);
  return solve->coarse_map.applied > 0 && solve->coarse_map.events == 0 &&
         fabs(solve->coarse_run.velocity) <= 1.01 * band;
}

void strut_orbit_solve_confirm_stuck(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  strut_summary *run = &solve->last_run;
  solve->answer = STRUT_ORBIT_NONE;
  strut_orbit_solve_run_on(solve, strut_orbit_solve_halve_step(solve),
                           fmin(0.001, 0.2 * accuracy->target), 4,
                           fmax(20.0, strut_accuracy_transient_periods(accuracy)), false, run);
  if (solve->status || run->steady.kind != STRUT_MOTION_PERIODIC) return;
  double apart = fabs(run->velocity - solve->coarse_run.velocity);
  strut_orbit_solve_accept_last_run(solve, STRUT_ORBIT_STUCK, apart + run->steady.interval);
  if (strut_orbit_solve_error_share(solve, solve->answer) <= 1.0) return;
  solve->answer = STRUT_ORBIT_NONE;
  solve->error = HUGE_VAL;
}

void strut_orbit_solve_confirm_creep(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  strut_summary *run = &solve->last_run;
  strut_experiment finer = strut_orbit_solve_halve_step(solve);
  finer.steady.creep = accuracy->coarse.steady.creep;
  strut_orbit_solve_run_on(solve, finer, accuracy->target, 5, CREEPING, true, run);
  if (solve->status) return;
  const strut_steady_summary found = run->steady;
  double apart = fabs(run->velocity - solve->coarse_run.velocity);
  bool steady = found.kind == STRUT_MOTION_CREEPING || found.kind == STRUT_MOTION_PERIODIC;
  run->steady.kind = STRUT_MOTION_CREEPING;
  run->steady.repeats = 0;
  double changes = fmin(2.0 * fabs(run->velocity), CREEP_CHANGES * accuracy->scale);
  if (steady && fabs(run->velocity) <= finer.steady.creep)
    strut_orbit_solve_accept_last_run(
        solve, STRUT_ORBIT_CREEPING,
        apart + changes + fmax(found.interval, solve->coarse_run.steady.interval));
}

/* The summary of a periodic orbit to a wanted accuracy: what it cost, how it was found, its error. */

static void explain_orbit(const strut_orbit_solve *solve, strut_accuracy_summary *to) {
  double step = solve->coarse_map.dt, tolerance = solve->reference.tolerance;
  double moved = fabs(solve->orbit.velocity - solve->coarse_run.velocity);
  size_t size = sizeof to->why;
  switch (solve->answer) {
    case STRUT_ORBIT_COARSE:
      snprintf(to->why, size,
               "verlet-events with a step of %.3g s is accurate enough: correcting its orbit by a "
               "period of adaptive (tolerance %.1g) changes the velocity by %.2g m/s",
               step, tolerance, moved);
      return;
    case STRUT_ORBIT_STUCK:
      snprintf(to->why, size,
               "verlet-events with a step of %.3g s: all contacts stick for the whole period, and "
               "twice the step changes the velocity by %.2g m/s",
               0.5 * step, moved);
      return;
    case STRUT_ORBIT_IRREGULAR:
    case STRUT_ORBIT_DISPUTED: strut_orbit_solve_explain_mean(solve, to->why, size); return;
    case STRUT_ORBIT_CREEPING:
      snprintf(to->why, size,
               "it creeps: over 24 periods its mean velocity was below %.2g m/s, and it did not "
               "repeat itself; by "
               "verlet-events with steps of %.3g s and %.3g s it is known to %.2g m/s",
               solve->a->coarse.steady.creep, step, 0.5 * step, solve->error);
      return;
    case STRUT_ORBIT_NONE:
    case STRUT_ORBIT_CORRECTED:
    case STRUT_ORBIT_REFERENCE:
      snprintf(
          to->why, size,
          "verlet-events with a step of %.3g s until the motion was steady; its orbit was then "
          "corrected by periods of adaptive (tolerance %.1g), which changed the velocity by %.2g "
          "m/s%s",
          step, tolerance, moved,
          solve->answer == STRUT_ORBIT_REFERENCE ? "; adaptive then ran until it was steady itself"
                                                 : "");
  }
}

/* The force evaluations of all parts of the answer. */
static int64_t sum_evaluations(const strut_orbit_solve *solve) {
  int64_t coarse = solve->coarse_run.spent.evaluations;
  if (solve->answer == STRUT_ORBIT_COARSE) return coarse + solve->until_steady;
  return coarse + solve->coarse_map.evaluations + solve->reference_map.evaluations +
         solve->last_run.spent.evaluations;
}

/* Makes the summary that of the whole motion from t = 0: up to the orbit, then along it. */
static void tell_whole_motion(const strut_orbit_solve *solve, const strut_summary *orbit,
                              strut_summary *summary) {
  const strut_snapshot *from = solve->a->options->from;
  double before = solve->known.time - (from ? from->time : 0.0);
  summary->duration = before + orbit->duration;
  summary->spent.steps = solve->known.steps + orbit->spent.steps;
  summary->spent.events = solve->known.events + orbit->spent.events;
  summary->steady.periods = llround(before / solve->coarse_map.period);
}

void strut_orbit_solve_report(strut_orbit_solve *solve, const strut_summary *orbit) {
  strut_accuracy *accuracy = solve->a;
  strut_summary *summary = accuracy->summary;
  assert(solve->answer != STRUT_ORBIT_NONE);
  bool coarse_suffices = solve->answer == STRUT_ORBIT_COARSE;
  bool ran_on = solve->answer > STRUT_ORBIT_CORRECTED;
  int64_t corrections =
      solve->coarse_map.evaluations - solve->until_steady + solve->reference_map.evaluations;
  *summary = *orbit;
  summary->velocity = coarse_suffices ? solve->coarse_run.velocity : solve->orbit.velocity;
  summary->velocity_spread =
      ran_on ? solve->last_run.velocity_spread : solve->coarse_run.velocity_spread;
  summary->settle_time = solve->coarse_run.settle_time;
  summary->steady = ran_on ? solve->last_run.steady : solve->coarse_run.steady;
  double error = accuracy->target * strut_orbit_solve_error_share(solve, solve->answer);
  summary->steady.interval = error * strut_accuracy_velocity_scale(accuracy, summary->velocity);
  tell_whole_motion(solve, orbit, summary);
  if (solve->mean.periods > 0) summary->window = solve->last_run.window; /* that of the mean */
  summary->spent.evaluations = sum_evaluations(solve);
  summary->step = solve->coarse_map.dt;
  summary->step_limit = solve->coarse_run.step_limit;
  summary->spent.wall_time = solve->coarse_run.spent.wall_time;
  bool adaptive = solve->answer == STRUT_ORBIT_CORRECTED || solve->answer == STRUT_ORBIT_REFERENCE;
  snprintf(summary->method, sizeof summary->method, "%s%s%s",
           strut_integrator_for(STRUT_ROLE_COARSE)->name, adaptive ? "+" : "",
           adaptive ? strut_integrator_for(STRUT_ROLE_REFERENCE)->name : "");
  summary->accuracy = (strut_accuracy_summary){
      .wanted = accuracy->target,
      .expected = error,
      .scale = accuracy->scale,
      .check_evaluations = accuracy->check_evaluations + orbit->spent.evaluations +
                           (coarse_suffices ? corrections : 0)};
  /* of what creeps only that is promised */
  double known = solve->answer == STRUT_ORBIT_CREEPING ? 0.0 : summary->accuracy.expected;
  summary->accuracy.kept = strut_accuracy_is_kept(!solve->mean.disputed, known, accuracy->target);
  explain_orbit(solve, &summary->accuracy);
  char *why = summary->accuracy.why;
  size_t length = strlen(why);
  if (solve->followed)
    snprintf(why + length, sizeof summary->accuracy.why - length,
             "; adaptive followed the fast start");
}
