/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A wanted accuracy by the periodic orbit: the coarse method comes near it, the reference method corrects it. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/run/accuracy/orbit_solve.h"

/* Wanted errors from which on the coarse orbit may be the answer, if the correction confirms it. */
static const double COARSE = 0.0099;
/* Wanted errors below which the reference method itself must become steady. */
static const double FINE = 0.0019;
/* Motions without a period creep below this part of the velocity that errors are relative to. */
static const double CREEP = 0.2;
/*
 * Periods that the transient must leave room for before an orbit is worth searching: of a run that
 * ends when it is steady, and of one with a given window, where repeated runs are more reliable.
 */
static const double LEAST = 20.0, LEAST_OF_RUN = 60.0;
/* A first correction below this part of the tolerated one needs no second; likewise if a finer run confirms it. */
static const double SMALL = 0.15, SMALL_CONFIRMED = 0.6;
/* Part of the budget for the orbit; the rest is kept for repeated runs. */
static const double PART_OF_BUDGET = 0.6;
/* The whole run is made as a check where it costs at most this many times the work so far. */
static const double WHOLE_RUN = 2.0;
enum { MOST_CORRECTIONS = 4 };
/* Steps tried for the coarse method where the structure becomes stiffer. */
enum { MOST_STEPS = 3 };
/* Periods in which a motion normally becomes steady, and those of a second chance before it is called irregular. */
static const double FIRST = 150.0, CHANCE = 12.0;
/* An irregular motion's mean may have an interval of so many wanted errors, which smaller steps do not narrow. */
static const double MEAN = 20.0;
/* Periods for the reference method to become steady: after a failed correction; where only that counts. */
static const double TRIAL = 24.0, LONG_TRIAL = 60.0;
/*
 * A start is fast that changes the shape within a period by so many times its range there once it is steady: of those
 * from an equilibrium it is one, of those that fall or are thrown fifty.
 */
static const double FAST = 10.0;
/* Two runs end on the same orbit whose ends differ by this part of its range, and their velocities of themselves. */
static const double SAME_ORBIT = 0.1;
/* Runs by the reference method from a fast start, and the tolerance of one over that before. */
enum { MOST_STARTS = 6 };
static const double FINER_START = 0.2;
/* Steps of the finer coarse method in one of the first coarse method. */
static const double FINER = 4.0;
/* Cycles of extrapolation towards a fixed point of either method; of a finer step where the motion may only creep. */
enum { MOST_CYCLES = 8, FINER_CYCLES = 3, CREEPING_CYCLES = 2 };
/* Where the answer hardly depends on extrapolation, differences must fall to this part in a cycle before the next. */
static const double FALL = 0.7;
/*
 * A run of the orbit with the finer step confirms it to this part of the wanted error; that of the reference
 * method.
 */
static const double CONFIRMED_BY_FINER = 0.3, CONFIRMED = 0.6;
/* An orbit moved by more than this part is confirmed by a later repetition, too: the first may hide a slow return. */
static const double MOVED = 0.3;
enum { LATER = 3 };

/* Where stability bounds the coarse step, finer ones cost less than the reference method. */
static bool uses_finer_steps(const strut_accuracy *accuracy) {
  return accuracy->stiff && accuracy->target >= FINE;
}

/* Is there an answer, or what stops the search? */
static bool is_over(const strut_orbit_solve *solve) { return solve->status || solve->answer; }

static bool is_periodic(const strut_summary *run) {
  return run->steady.kind == STRUT_MOTION_PERIODIC;
}

/* Fixed steps meet the events differently in each period: nothing is steadier than that. */
static double coarse_tolerance(const strut_accuracy *accuracy) {
  return fmax(0.1, 16.0 * accuracy->target);
}

/* The step is for the start; where the structure becomes stiffer, the run is repeated with a step for that. */
static void run_coarse_from_start(strut_orbit_solve *solve, double periods) {
  strut_accuracy *accuracy = solve->a;
  strut_summary *run = &solve->coarse_run;
  for (int k = 0; k < MOST_STEPS; k++) {
    strut_orbit_solve_run_until_steady(solve, accuracy->coarse, coarse_tolerance(accuracy), 3,
                                       periods, false, run);
    double limit = run->limit_fell.limit;
    bool fell = limit > 0.0 && limit < accuracy->coarse.step;
    if (solve->status ? solve->status != STRUT_DIVERGED : !fell) return;
    solve->status = STRUT_OK;
    accuracy->check_evaluations += run->spent.evaluations;
    strut_summary_free(run);
    *run = (strut_summary){0};
    accuracy->coarse.step = fell ? STRUT_COARSE_STEP * limit : 0.5 * accuracy->coarse.step;
  }
  solve->coarse_run.status = solve->status = STRUT_DIVERGED;
}

/* Takes the end of the coarse run as fixed point of the coarse map. */
static void take_end_as_fixed_point(strut_orbit_solve *solve) {
  strut_orbit_place_copy(solve, &solve->end, &solve->known);
  memcpy(solve->fixed_point, solve->orbit.y, solve->both * sizeof(double));
  solve->travel = solve->coarse_run.velocity * solve->coarse_map.period * solve->coarse_map.repeats;
}

/* Steps longer than stability allows would be refused one by one, and open and close contacts until then. */
static double longest_reference_step(const strut_orbit_solve *solve) {
  const strut_accuracy *accuracy = solve->a;
  double longest = strut_experiment_span(&accuracy->experiment, accuracy->scene).period / 50.0;
  return accuracy->stiff ? fmin(longest, solve->finer * accuracy->coarse.step) : longest;
}

static void create_maps(strut_orbit_solve *solve, int32_t repeats) {
  strut_accuracy *accuracy = solve->a;
  if (solve->status) return;
  accuracy->check_evaluations += solve->coarse_map.evaluations + solve->reference_map.evaluations;
  strut_orbit_solve_count_evaluations(solve);
  assert(repeats >= 1);
  solve->counted = 0;
  strut_period_map_free(&solve->coarse_map);
  strut_period_map_free(&solve->reference_map);
  solve->reference = accuracy->coarse;
  solve->reference.steady.creep = 0.0;
  solve->reference.integrator = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
  solve->reference.tolerance =
      fmin(2.5e-6, fmax(1e-12, accuracy->target * STRUT_TOLERANCE_PER_ERROR));
  solve->tightened = solve->finer > 1.0; /* an orbit that needs finer steps is sensitive */
  if (solve->tightened) solve->reference.tolerance /= STRUT_TIGHTENED;
  solve->reference.step = longest_reference_step(solve);
  solve->status = strut_period_map_create(accuracy->model, &accuracy->coarse, repeats,
                                          &solve->coarse_map, accuracy->error);
  if (!solve->status)
    solve->status = strut_period_map_create(accuracy->model, &solve->reference, repeats,
                                            &solve->reference_map, accuracy->error);
  if (solve->status) return;
  solve->coarse_map.interrupt = solve->reference_map.interrupt = accuracy->options->interrupt;
  solve->coarse_map.most_evaluations = solve->reference_map.most_evaluations =
      strut_accuracy_evaluations_left(accuracy);
  solve->coarse_map.time = solve->reference_map.time = solve->end.time;
  take_end_as_fixed_point(solve);
}

/* A run that does not agree counts as a check. */
static void discard_run(strut_orbit_solve *solve, strut_summary *orbit) {
  solve->a->check_evaluations += orbit->spent.evaluations;
  strut_summary_free(orbit);
  *orbit = (strut_summary){0};
}

/* Are the ends of two runs, in solve->known and solve->end, on the same steady motion? */
static bool ends_agree(strut_orbit_solve *solve, const strut_summary *one,
                       const strut_summary *other) {
  double size = strut_accuracy_velocity_scale(solve->a, other->velocity);
  strut_period_map_subtract(&solve->coarse_map, solve->known.y, solve->end.y, solve->fixed_point);
  double apart = strut_period_map_size(&solve->coarse_map, solve->fixed_point);
  return one->steady.kind == other->steady.kind && one->steady.periods == other->steady.periods &&
         one->steady.repeats == other->steady.repeats &&
         apart <= SAME_ORBIT * other->steady.motion &&
         fabs(one->velocity - other->velocity) <= SAME_ORBIT * size;
}

/*
 * A start whose shape changes by far more than the steady motion's, or whose energy the coarse method does not keep, may
 * lead to another steady motion. The reference method then runs from it, until two runs end on the same one.
 */
static void follow_start(strut_orbit_solve *solve, double periods) {
  strut_accuracy *accuracy = solve->a;
  strut_summary *run = &solve->coarse_run;
  bool open = strut_accuracy_balance_is_open(accuracy, run), agree = false;
  bool fast = run->steady.fastest > FAST * run->steady.motion;
  if (accuracy->creeps) fast = false; /* nothing will be promised */
  if (solve->status || !(open || fast)) return;
  create_maps(solve, 1);
  strut_experiment e = solve->reference;
  e.steady.creep = accuracy->coarse.steady.creep;
  strut_accuracy_begin_phase(accuracy, "following the start by adaptive");
  for (int k = 0; k < MOST_STARTS && !solve->status && !agree; k++) {
    strut_summary finer = {0};
    strut_orbit_solve_run_until_steady(solve, e, coarse_tolerance(accuracy), 3, periods, false,
                                       &finer);
    agree = !solve->status && !open && ends_agree(solve, run, &finer);
    discard_run(solve, run);
    *run = finer;
    open = strut_accuracy_balance_is_open(accuracy, run);
    strut_orbit_place_copy(solve, &solve->end, &solve->known);
    e.tolerance = fmax(1e-12, FINER_START * e.tolerance);
  }
  solve->followed = agree && !open;
  solve->lost = !solve->followed;
}

/*
 * Runs the coarse method until the motion repeats itself. Its fixed steps meet the events
 * differently in each period, which limits how closely the motion repeats: the first tolerance is
 * therefore loose. False where even that is not reached.
 */
static bool run_coarse(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  strut_summary *run = &solve->coarse_run;
  double periods = strut_accuracy_transient_periods(accuracy), first = fmin(FIRST, periods);
  /* without ground transients may be slow; with it motions may be irregular */
  bool may_be_slow = accuracy->model->contacts.count == 0;
  if (solve->status) return false;
  strut_accuracy_begin_phase(accuracy, "waiting for steady motion");
  run_coarse_from_start(solve, first);
  follow_start(solve, first);
  if (!solve->status && !is_periodic(run) && may_be_slow && periods > first)
    strut_orbit_solve_run_on(solve, accuracy->coarse, fmin(0.005, 0.5 * accuracy->target), 5,
                             periods - first, true, run);
  bool steady = !solve->status && is_periodic(run) &&
                strut_accuracy_orbit_covers_window(accuracy, &run->steady);
  if (solve->status == STRUT_DIVERGED) solve->status = STRUT_OK;
  return steady;
}

/* Corrects until the next correction should be small enough; each defect must be much smaller than that before. */
static void correct_orbit(strut_orbit_solve *solve, double enough, int least) {
  double little = (uses_finer_steps(solve->a) ? SMALL_CONFIRMED : SMALL) * enough;
  double defect = HUGE_VAL;
  const strut_orbit *orbit = &solve->orbit;
  solve->error = HUGE_VAL;
  for (int k = 0; k < MOST_CORRECTIONS; k++) {
    strut_status status =
        strut_orbit_correct(&solve->coarse_map, &solve->reference_map, solve->fixed_point,
                            solve->travel, 0.1 * enough * solve->coarse_map.period, &solve->orbit);
    if (!strut_orbit_solve_check_maps(solve, status)) return;
    if (!orbit->converged || orbit->defect > 0.7 * defect) return;
    /* assume that the first correction is right to a half; later ones by their own reduction */
    double better = k == 0 ? 0.5 : fmax(0.1, orbit->defect / defect);
    defect = orbit->defect;
    solve->error = better * fabs(orbit->correction);
    bool small = fabs(orbit->correction) <= little;
    if ((k + 1 >= least || small) && solve->error <= enough) return;
  }
}

/*
 * Runs the orbit by the method of `e` over one repetition, or, to record it, over as many periods as `output`
 * names.
 */
static void run_orbit(strut_orbit_solve *solve, strut_experiment e, bool record,
                      strut_summary *summary) {
  strut_accuracy *accuracy = solve->a;
  double period = solve->coarse_map.period;
  e.measure_last = 0.0;
  e.steady.wanted = false;
  e.step = period / ceil(period / e.step * (1.0 - 1e-9)); /* as the maps have it */
  bool ran_on = solve->answer > STRUT_ORBIT_CORRECTED && solve->last_run.steady.repeats > 0;
  e.periods = ran_on ? solve->last_run.steady.repeats : solve->coarse_map.repeats;
  if (record) e.periods = fmax(e.periods, e.output_last);
  e.output_last = 0.0;
  strut_run_options options = *accuracy->options;
  strut_accuracy_begin_phase(accuracy, "running the orbit");
  if (record)
    options.to = NULL;
  else
    options.sink_count = 0;
  strut_orbit_place_copy(solve, &solve->known, &solve->end);
  const strut_snapshot from = strut_orbit_place_snapshot(solve, &solve->end);
  options.from = &from;
  options.progress = NULL;
  solve->status = strut_accuracy_run(accuracy, &e, &options, summary);
}

static void accept_fixed_point(strut_orbit_solve *solve) {
  solve->coarse_run.velocity =
      solve->travel / (solve->coarse_map.period * solve->coarse_map.repeats);
  memcpy(solve->orbit.y, solve->fixed_point, solve->both * sizeof(double));
  solve->until_steady = solve->coarse_map.evaluations;
}

/* Did the coarse run become as steady as its fixed point is sought? */
static bool is_as_steady_as_sought(const strut_orbit_solve *solve) {
  double size = strut_accuracy_velocity_scale(solve->a, solve->coarse_run.velocity);
  return solve->finer == 1.0 &&
         solve->coarse_run.steady.interval <= STRUT_FIXED_POINT_PART * solve->a->target * size;
}

/* Extrapolates to the fixed point of the coarse map; fills `to`. */
static void extrapolate_to_fixed_point(strut_orbit_solve *solve, strut_extrapolation *to) {
  const strut_accuracy *accuracy = solve->a;
  double size = strut_accuracy_velocity_scale(accuracy, solve->coarse_run.velocity);
  double enough = STRUT_FIXED_POINT_PART * accuracy->target * size * solve->coarse_map.period;
  bool slow = fabs(solve->coarse_run.velocity) <= accuracy->coarse.steady.creep,
       finer = solve->finer > 1.0;
  *to = (strut_extrapolation){
      .enough = enough * solve->coarse_map.repeats,
      .fall = is_as_steady_as_sought(solve) || (finer && slow) ? FALL : HUGE_VAL,
      .cycles = finer ? slow ? CREEPING_CYCLES : FINER_CYCLES : MOST_CYCLES};
  if (solve->status) return;
  strut_status status =
      strut_orbit_limit(&solve->coarse_map, to, solve->fixed_point, &solve->travel);
  if (!strut_orbit_solve_check_maps(solve, status) || !to->found) return;
  accept_fixed_point(solve);
  solve->coarse_run.steady.kind = STRUT_MOTION_PERIODIC;
  solve->coarse_run.steady.repeats = solve->coarse_map.repeats;
}

/*
 * A finer step may be what an orbit needs: finds the fixed point of its map, from the one of the coarse map
 * or where the coarse run ended. Where there is none the maps are the coarse ones again.
 */
static bool find_finer_fixed_point(strut_orbit_solve *solve, bool from_orbit) {
  strut_accuracy *accuracy = solve->a;
  int32_t repeats = solve->coarse_map.repeats;
  double step = accuracy->coarse.step;
  strut_extrapolation to;
  if (solve->status || !uses_finer_steps(accuracy) || solve->finer > 1.0) return false;
  if (from_orbit) {
    memcpy(solve->orbit.y, solve->fixed_point, solve->both * sizeof(double));
    strut_orbit_place_copy(solve, &solve->known, &solve->end);
  }
  strut_accuracy_begin_phase(accuracy, "finding the orbit by finer steps");
  accuracy->coarse.step = step / FINER, solve->finer = FINER;
  create_maps(solve, repeats);
  extrapolate_to_fixed_point(solve, &to);
  if (solve->status || to.found) return to.found;
  accuracy->coarse.step = step, solve->finer = 1.0;
  create_maps(solve, repeats);
  return false;
}

/* Corrects the coarse orbit; sets solve->answer if it is accurate enough then. */
static void correct_to_answer(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  double size = strut_accuracy_velocity_scale(accuracy, solve->coarse_run.velocity);
  strut_accuracy_begin_phase(accuracy, "correcting the orbit");
  /* the reference method runs on from the orbit, so that a rough one suffices */
  bool last_word = accuracy->target < FINE;
  double enough = (last_word ? 3.0 : 0.3) * accuracy->target * size;
  correct_orbit(solve, enough, accuracy->target >= COARSE || last_word ? 1 : 2);
  if (solve->status) return;
  solve->apart = 0.0;
  if (accuracy->target >= COARSE && strut_orbit_solve_error_share(solve, STRUT_ORBIT_COARSE) <= 1.0)
    solve->answer = STRUT_ORBIT_COARSE;
  else if (!last_word && strut_orbit_solve_error_share(solve, STRUT_ORBIT_CORRECTED) <= 1.0)
    solve->answer = STRUT_ORBIT_CORRECTED;
}

/*
 * Fixed steps may keep the differences of periods from falling, though the run is as steady as its fixed point is
 * sought. Its end serves then, if a correction leads to the answer.
 */
static void correct_end_of_run(strut_orbit_solve *solve) {
  take_end_as_fixed_point(solve);
  accept_fixed_point(solve);
  correct_to_answer(solve);
  if (!solve->answer) solve->error = HUGE_VAL;
}

/*
 * Finds the fixed point of the coarse map from a nearly steady state, by extrapolation or, where that fails
 * for a single period, by running on, too briefly for several. False where there is none. May set
 * solve->answer.
 */
static bool find_coarse_fixed_point(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  const strut_summary *run = &solve->coarse_run;
  strut_extrapolation to;
  extrapolate_to_fixed_point(solve, &to);
  bool end_serves = is_as_steady_as_sought(solve) && !strut_orbit_solve_is_stuck(solve);
  if (!solve->status && !to.found && !to.unsteady && end_serves) correct_end_of_run(solve);
  if (is_over(solve) || to.found || solve->coarse_map.repeats > 1) return to.found;
  strut_orbit_solve_run_on(solve, accuracy->coarse,
                           fmin(0.002, STRUT_FIXED_POINT_PART * accuracy->target), 5, CHANCE, true,
                           &solve->coarse_run);
  bool steady = !solve->status && is_periodic(run) && run->steady.repeats == 1;
  take_end_as_fixed_point(solve);
  accept_fixed_point(solve);
  return steady;
}

/* Corrects the coarse orbit; where that is not enough, runs the reference method from it. */
static void correct_or_rerun(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  double all = fmax(20.0, strut_accuracy_transient_periods(accuracy));
  solve->error = HUGE_VAL;
  if (solve->status) return;
  if (strut_orbit_solve_is_stuck(solve)) {
    strut_orbit_solve_confirm_stuck(solve);
    if (!is_over(solve)) strut_orbit_solve_run_reference(solve, false, all);
    return;
  }
  bool last_word = accuracy->target < FINE;
  correct_to_answer(solve);
  if (!is_over(solve) && find_finer_fixed_point(solve, true)) correct_to_answer(solve);
  if (is_over(solve)) return;
  strut_orbit_solve_run_reference(solve, true, fmin(all, last_word ? LONG_TRIAL : TRIAL));
  if (solve->answer)
    strut_orbit_solve_check_tolerance(solve);
  else
    strut_orbit_solve_average_disputed(solve);
}

/* The coarse run found no period: averages, corrects an orbit that appears after all, or runs on by the reference. */
static void find_without_fixed_point(strut_orbit_solve *solve) {
  const strut_steady_summary *found = &solve->coarse_run.steady;
  bool periodic = strut_orbit_solve_average_irregular(solve);
  if (is_over(solve)) return;
  if (!periodic || !strut_accuracy_orbit_covers_window(solve->a, found)) {
    strut_orbit_solve_run_reference(solve, true,
                                    fmax(20.0, strut_accuracy_transient_periods(solve->a)));
    return;
  }
  create_maps(solve, found->repeats);
  correct_or_rerun(solve);
}

/* Confirms a creeping motion, or runs on as if it did not matter, which may be steady. */
static bool find_creep(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  create_maps(solve, 1);
  strut_orbit_solve_confirm_creep(solve);
  if (is_over(solve)) return false;
  accuracy->coarse.steady.creep = 0.0;
  accuracy->check_evaluations +=
      solve->coarse_run.spent.evaluations + solve->last_run.spent.evaluations;
  strut_summary_free(&solve->coarse_run);
  strut_summary_free(&solve->last_run);
  solve->coarse_run = solve->last_run = (strut_summary){0};
  return run_coarse(solve);
}

/* Finds the orbit to the wanted accuracy. */
static void find_orbit(strut_orbit_solve *solve, bool steady) {
  create_maps(solve, steady ? solve->coarse_run.steady.repeats : 1);
  solve->error = HUGE_VAL;
  if (solve->status) return;
  bool several = steady && solve->coarse_map.repeats > 1;
  if (!steady) {
    find_without_fixed_point(solve);
    return;
  }
  steady = find_coarse_fixed_point(solve);
  if (is_over(solve)) return;
  if (!steady && several) {
    create_maps(solve, 1);
    solve->until_steady = 0;
  }
  bool finer = uses_finer_steps(solve->a);
  /* for several periods, running on costs less than finer steps */
  if (!steady && finer && !several) steady = find_finer_fixed_point(solve, false);
  /* the coarse method nearly repeats itself: fixed steps may be what prevents it, and the reference method has none */
  if (!steady && !finer) strut_orbit_solve_run_reference(solve, true, CHANCE);
  if (is_over(solve)) return;
  if (steady)
    correct_or_rerun(solve);
  else
    find_without_fixed_point(solve);
}

/* Has the last run become steady before the window of the scene begins, counted from its start? */
static bool window_is_steady(const strut_orbit_solve *solve) {
  const strut_accuracy *accuracy = solve->a;
  strut_steady_summary steady = solve->last_run.steady;
  if (accuracy->experiment.steady.wanted) return true;
  double periods = (double)(solve->coarse_run.steady.periods + steady.periods);
  if (periods > 2.0 * strut_accuracy_transient_periods(accuracy)) return false;
  steady.periods = 0;
  return steady.kind != STRUT_MOTION_PERIODIC ||
         strut_accuracy_orbit_covers_window(accuracy, &steady);
}

/*
 * Orbits need not be isolated: a structure that creeps within its stick bands may drift along a
 * family of them, more slowly than the steady detector notices. Where the whole run is affordable
 * it is made, and its velocity must agree with that of the orbit.
 */
static void check_window(strut_orbit_solve *solve) {
  strut_accuracy *accuracy = solve->a;
  bool of_orbit = solve->answer >= STRUT_ORBIT_COARSE && solve->answer <= STRUT_ORBIT_STUCK;
  double periods = accuracy->experiment.periods, before = (double)solve->coarse_run.steady.periods;
  double work = (double)solve->coarse_run.spent.evaluations / fmax(1.0, before) * periods;
  if (!of_orbit || accuracy->experiment.steady.wanted || work > WHOLE_RUN * (double)accuracy->used)
    return;
  strut_experiment whole = accuracy->coarse;
  strut_summary run = {0};
  strut_run_options options = {.without_balance = true,
                               .interrupt = accuracy->options->interrupt,
                               .progress = accuracy->options->progress,
                               .progress_context = accuracy->options->progress_context,
                               .from = accuracy->options->from};
  whole.step = solve->coarse_map.dt;
  strut_accuracy_begin_phase(accuracy, "checking by the whole run");
  solve->status = strut_accuracy_run(accuracy, &whole, &options, &run);
  accuracy->check_evaluations += run.spent.evaluations;
  double away = fabs(run.velocity - solve->coarse_run.velocity);
  if (!solve->status &&
      !(away <= 0.3 * accuracy->target * strut_accuracy_velocity_scale(accuracy, run.velocity)))
    solve->answer = STRUT_ORBIT_NONE;
  strut_summary_free(&run);
}

/* By how much a later repetition is faster or slower than a corrected orbit that was moved by more than that [m/s]. */
static double compare_later(strut_orbit_solve *solve, double most) {
  strut_period_map *map = &solve->reference_map;
  double *y = strut_orbit_solve_array(solve), travel = 0.0;
  double moved = fabs(solve->coarse_run.velocity - solve->orbit.velocity);
  if (!y || solve->answer != STRUT_ORBIT_CORRECTED || moved <= most) return 0.0;
  memcpy(y, solve->orbit.y, solve->both * sizeof *y);
  for (int k = 0; k < LATER; k++) travel = strut_period_map_apply(map, y);
  (void)strut_orbit_solve_check_maps(solve, STRUT_OK);
  return fabs(travel / (map->period * map->repeats) - solve->orbit.velocity);
}

/*
 * Runs the orbit once: does its velocity agree within `part` of the wanted error? Where it is
 * recorded it is then run again, of which nothing is reported, so that the answer does not depend on
 * recordings.
 */
static bool confirm_by(strut_orbit_solve *solve, strut_experiment e, double part,
                       strut_summary *orbit) {
  strut_accuracy *accuracy = solve->a;
  discard_run(solve, orbit);
  run_orbit(solve, e, false, orbit);
  double wanted =
      accuracy->target * strut_accuracy_velocity_scale(accuracy, solve->coarse_run.velocity);
  double later = solve->status ? 0.0 : compare_later(solve, MOVED * wanted);
  solve->apart = fmax(fabs(orbit->velocity - solve->orbit.velocity), later);
  bool ran_on = solve->answer > STRUT_ORBIT_CORRECTED;
  bool agrees = solve->apart <= part * wanted && later <= part * wanted &&
                strut_orbit_solve_error_share(solve, solve->answer) <= 1.0;
  if (solve->status || !(ran_on || agrees)) return false;
  if (!accuracy->options->sink_count) return true;
  strut_summary recorded = {0};
  int64_t allowed = accuracy->allowed;
  accuracy->allowed = INT64_MAX; /* what is recorded does not decide whether the work suffices */
  run_orbit(solve, e, true, &recorded);
  accuracy->allowed = allowed;
  strut_summary_free(&recorded);
  return true;
}

/* A corrected orbit that a finer step does not confirm is corrected again; then the reference method decides. */
static bool confirm_by_finer(strut_orbit_solve *solve, strut_summary *orbit) {
  bool corrected = solve->answer == STRUT_ORBIT_CORRECTED;
  if (!uses_finer_steps(solve->a)) return false;
  strut_experiment e = solve->a->coarse;
  e.steady.creep = 0.0;
  e.step *= solve->finer / FINER; /* finer than the first */
  if (confirm_by(solve, e, CONFIRMED_BY_FINER, orbit)) return true;
  if (solve->status || !corrected) return false;
  solve->answer = STRUT_ORBIT_NONE;
  correct_to_answer(solve);
  return false;
}

/* Runs the orbit once more; its velocity must agree with that of the orbit. */
static void confirm_orbit(strut_orbit_solve *solve, strut_summary *orbit) {
  if (solve->answer > STRUT_ORBIT_CORRECTED && !window_is_steady(solve))
    solve->answer = STRUT_ORBIT_NONE;
  check_window(solve);
  if (solve->status || !solve->answer || confirm_by_finer(solve, orbit) || solve->status) return;
  if (solve->answer && confirm_by(solve, solve->reference, CONFIRMED, orbit)) return;
  if (solve->status) return;
  solve->answer = STRUT_ORBIT_NONE;
  discard_run(solve, orbit);
  strut_orbit_solve_run_reference(solve, true, solve->a->target < FINE ? LONG_TRIAL : TRIAL);
  if (!is_over(solve)) strut_orbit_solve_average_disputed(solve);
  if (!solve->status) confirm_by(solve, solve->reference, CONFIRMED, orbit);
}

strut_status strut_accuracy_try_orbit(strut_accuracy *accuracy, bool *done) {
  strut_orbit_solve solve = {.a = accuracy, .finer = 1.0};
  *done = false;
  bool steady_wanted = accuracy->experiment.steady.wanted;
  if (strut_accuracy_transient_periods(accuracy) < (steady_wanted ? LEAST : LEAST_OF_RUN))
    return STRUT_OK;
  strut_summary orbit = {0};
  strut_experiment given = accuracy->coarse;
  accuracy->allowed = (int64_t)(PART_OF_BUDGET * (double)accuracy->budget);
  accuracy->coarse.refine_rate =
      0.5; /* the orbit will be corrected, so that a short refinement suffices */
  accuracy->coarse.refine_memory = 3.0;
  accuracy->coarse.steady.mean_tolerance = MEAN * accuracy->target;
  if (accuracy->target >= FINE) accuracy->coarse.steady.creep = CREEP * accuracy->scale;
  solve.both = 2 * (size_t)accuracy->model->length + 1;
  solve.end.y = strut_orbit_solve_array(&solve);
  solve.orbit.y = solve.known.y = strut_orbit_solve_array(&solve);
  solve.fixed_point = strut_orbit_solve_array(&solve);
  bool steady = run_coarse(&solve);
  if (!solve.status && solve.coarse_run.status == STRUT_OK && !solve.lost) {
    if (solve.coarse_run.steady.kind == STRUT_MOTION_CREEPING) steady = find_creep(&solve);
    if (!is_over(&solve)) find_orbit(&solve, steady);
    if (!solve.status) confirm_orbit(&solve, &orbit);
  }
  bool followed =
      orbit.spent.forced + solve.last_run.spent.forced + solve.reference_map.forced == 0;
  *done = !solve.status && solve.answer && followed && !solve.lost;
  if (*done) {
    strut_orbit_solve_report(&solve, &orbit);
  } else { /* the next strategy is charged with the cost */
    accuracy->check_evaluations += solve.coarse_run.spent.evaluations +
                                   solve.coarse_map.evaluations + solve.reference_map.evaluations +
                                   solve.last_run.spent.evaluations + orbit.spent.evaluations;
    strut_summary_free(&orbit);
  }
  given.step = solve.finer * accuracy->coarse.step;
  accuracy->coarse = given;
  accuracy->allowed = accuracy->budget;
  strut_period_map_free(&solve.coarse_map);
  strut_period_map_free(&solve.reference_map);
  strut_summary_free(&solve.coarse_run);
  strut_summary_free(&solve.last_run);
  strut_arena_free(&solve.arena);
  bool failed = solve.status == STRUT_DIVERGED || solve.status == STRUT_WORK_LIMIT;
  return failed ? STRUT_OK : solve.status;
}
