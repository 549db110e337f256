/* SPDX-License-Identifier: GPL-3.0-or-later */
/* To an accuracy by way of the steady orbit: cheap to come near it, accurate where it counts. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/accuracy/orbit_solve.h"

/* From this accuracy on the cheap method's own orbit may do, if the correction confirms it. */
static const double COARSE = 0.0099;
/* Below this one the accurate method has the last word. */
static const double FINE = 0.0019;
/* Periods in which the motion must become steady, for the search of an orbit to be worth it: of a run that ends
   when it is, and of one whose window is asked for, which repeated runs answer more surely. */
static const double LEAST = 20.0, LEAST_OF_RUN = 60.0;
/* A first correction is believed without a second one if it is this part of what is enough. */
static const double SMALL = 0.15;
/* Of the work allowed, what may be spent before runs are repeated instead. */
static const double PART_OF_BUDGET = 0.6;
/* Work that the whole run by the cheap method may take, over that done so far. */
static const double WHOLE_RUN = 2.0;
enum { MOST_CORRECTIONS = 4 };
/* Periods in which a motion should have become steady, and those in which a method that did not at
   first is given another chance, before it is taken to be irregular. */
static const double FIRST = 150.0, CHANCE = 12.0;
/*
 * An irregular motion's mean is taken if known to so many times what is wanted, and what it is known to
 * is said: finer steps do not help there, and to average over longer is for whoever needs it.
 */
static const double MEAN = 20.0;
/* Periods in which the accurate method should be steady from where corrections failed, and where it is
   to have the last word. */
static const double TRIAL = 24.0, LONG_TRIAL = 60.0;

static strut_status allocate(strut_orbit_solve *w, const strut_model *model) {
  size_t length = (size_t)model->length;
  w->end.q = strut_arena_allocate(&w->arena, length, sizeof(double));
  w->end.v = strut_arena_allocate(&w->arena, length, sizeof(double));
  w->base = strut_arena_allocate(&w->arena, 2 * length + 1, sizeof(double));
  w->orbit.y = strut_arena_allocate(&w->arena, 2 * length + 1, sizeof(double));
  if (w->end.q && w->end.v && w->base && w->orbit.y) return STRUT_OK;
  return strut_fail(w->a->error, STRUT_NO_MEMORY, "out of memory");
}

/*
 * The cheap method until the motion repeats itself. Its steps meet the grid here and there in
 * another way each period, which may keep it from repeating itself very closely: then less must do.
 * *steady is false where even that is not reached.
 */
static strut_status run_cheap(strut_orbit_solve *w, bool *steady) {
  strut_accuracy *a = w->a;
  double periods = strut_accuracy_periods(a), first = fmin(FIRST, periods);
  strut_status status = allocate(w, a->model);
  /* without ground transients may well be slow, with it motions may be irregular */
  bool may_be_slow = a->model->contacts.count == 0;
  if (status) return status;
  strut_accuracy_begin_phase(a, "waiting for steady motion");
  status =
      strut_orbit_solve_run(w, a->cheap, fmax(0.1, 16.0 * a->wanted), 3, first, false, &w->run);
  if (!status && w->run.steady.kind != STRUT_MOTION_PERIODIC && may_be_slow && periods > first) {
    strut_summary more = {0};
    status = strut_orbit_solve_run(w, a->cheap, fmin(0.005, 0.5 * a->wanted), 5, periods - first,
                                   true, &more);
    if (!status) strut_summary_append(&w->run, &more);
    strut_summary_free(&more);
  }
  *steady = !status && w->run.steady.kind == STRUT_MOTION_PERIODIC &&
            strut_accuracy_orbit_answers(a, &w->run.steady);
  return status == STRUT_DIVERGED ? STRUT_OK : status;
}

/* The end of the run so far as fixed point of the cheap map. */
static void take_end(strut_orbit_solve *w) {
  strut_orbit_solve_keep_end(w);
  memcpy(w->base, w->orbit.y, (2 * (size_t)w->cheap.model->length + 1) * sizeof(double));
  w->travel = w->run.velocity * w->cheap.period * w->cheap.repeats;
}

static strut_status make_maps(strut_orbit_solve *w, int32_t repeats) {
  strut_accuracy *a = w->a;
  a->spent += w->cheap.evaluations + w->fine.evaluations;
  strut_orbit_solve_count(w);
  w->counted = 0;
  strut_period_map_free(&w->cheap);
  strut_period_map_free(&w->fine);
  w->accurate = a->cheap;
  w->accurate.integrator = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
  w->accurate.tolerance = fmin(2.5e-6, fmax(1e-12, a->wanted * STRUT_TOLERANCE_PER_ERROR));
  w->accurate.step = strut_experiment_span(&a->experiment, a->scene).period / 50.0;
  strut_status status = strut_period_map_create(a->model, &a->cheap, repeats, &w->cheap, a->error);
  if (!status)
    status = strut_period_map_create(a->model, &w->accurate, repeats, &w->fine, a->error);
  if (status) return status;
  w->cheap.interrupt = w->fine.interrupt = a->options->interrupt;
  w->cheap.most_evaluations = w->fine.most_evaluations = strut_accuracy_left(a);
  w->cheap.time = w->fine.time = w->end.time;
  take_end(w);
  return STRUT_OK;
}

/*
 * Corrects until the next correction is expected to be small enough: each defect should be much
 * smaller than the one before, and the velocity follows it in proportion.
 */
static strut_status correct(strut_orbit_solve *w, double enough, int least) {
  double defect = HUGE_VAL;
  w->error = HUGE_VAL;
  for (int k = 0; k < MOST_CORRECTIONS; k++) {
    strut_status status = strut_orbit_correct(&w->cheap, &w->fine, w->base, w->travel,
                                              0.1 * enough * w->cheap.period, &w->orbit);
    status = strut_orbit_solve_map_status(w, status);
    if (status) return status;
    if (!w->orbit.converged || w->orbit.defect > 0.7 * defect) return STRUT_OK;
    /* the first correction is taken to be right to a half, later ones by what they achieved */
    double better = k == 0 ? 0.5 : fmax(0.1, w->orbit.defect / defect);
    defect = w->orbit.defect;
    w->error = better * fabs(w->orbit.correction);
    bool small = fabs(w->orbit.correction) <= SMALL * enough;
    if ((k + 1 >= least || small) && w->error <= enough) return STRUT_OK;
  }
  return STRUT_OK;
}

/* The motion on the orbit, by the accurate method: for what is recorded and told of contacts. */
static strut_status run_orbit(strut_orbit_solve *w, strut_summary *summary) {
  strut_accuracy *a = w->a;
  strut_experiment e = w->accurate;
  double last = e.output_last;
  e.measure_last = 0.0;
  strut_orbit_solve_start_later_runs(w);
  e.steady.wanted = false;
  bool ran_on = w->found > STRUT_WAY_CORRECTED && w->last.steady.repeats > 0;
  e.periods = ran_on ? w->last.steady.repeats : w->cheap.repeats;
  if (a->options->sink_count && last > e.periods) e.periods = last;
  e.output_last = 0.0;
  strut_run_options options = *a->options;
  strut_accuracy_begin_phase(a, "running the orbit");
  options.from = &w->end;
  options.progress = NULL;
  return strut_accuracy_run(a, &e, &options, summary);
}

/* What this way has cost goes to the account of the next one. */
static void give_up(strut_orbit_solve *w, strut_summary *orbit) {
  w->a->spent += w->run.force_evaluations + w->cheap.evaluations + w->fine.evaluations +
                 w->last.force_evaluations + orbit->force_evaluations;
  strut_summary_free(orbit);
}

static void release(strut_orbit_solve *w) {
  strut_period_map_free(&w->cheap);
  strut_period_map_free(&w->fine);
  strut_summary_free(&w->run);
  strut_summary_free(&w->last);
  strut_arena_free(&w->arena);
}

/*
 * From nearly steady to the fixed point of the cheap map: by extrapolation, or, where that fails, by
 * running on. *steady is false where there is none.
 */
static strut_status settle_cheap(strut_orbit_solve *w, bool *steady) {
  strut_accuracy *a = w->a;
  bool found = false;
  double enough = 0.1 * a->wanted * strut_accuracy_scale(a, w->run.velocity) * w->cheap.period;
  strut_status status =
      strut_orbit_limit(&w->cheap, enough * w->cheap.repeats, w->base, &w->travel, &found);
  status = strut_orbit_solve_map_status(w, status);
  if (status) return status;
  *steady = true;
  if (!found) {
    strut_summary more = {0};
    status =
        strut_orbit_solve_run(w, a->cheap, fmin(0.002, 0.1 * a->wanted), 5, CHANCE, true, &more);
    *steady = !status && more.steady.kind == STRUT_MOTION_PERIODIC &&
              more.steady.repeats == w->cheap.repeats;
    if (!status) strut_summary_append(&w->run, &more);
    strut_summary_free(&more);
    take_end(w);
  }
  w->run.velocity = w->travel / (w->cheap.period * w->cheap.repeats);
  memcpy(w->orbit.y, w->base, (2 * (size_t)w->cheap.model->length + 1) * sizeof(double));
  w->settled = (strut_orbit_solve_cost){w->cheap.evaluations, w->cheap.events, w->cheap.applied};
  return status;
}

/* The cheap method's orbit corrected, or what else has the answer near it. */
static strut_status finish(strut_orbit_solve *w) {
  strut_accuracy *a = w->a;
  double size = strut_accuracy_scale(a, w->run.velocity),
         all = fmax(20.0, strut_accuracy_periods(a));
  strut_status status = STRUT_OK;
  w->error = HUGE_VAL;
  if (strut_orbit_solve_is_stuck(w)) {
    status = strut_orbit_solve_stuck(w);
    return status || w->found ? status : strut_orbit_solve_accurate(w, false, all);
  }
  strut_accuracy_begin_phase(a, "correcting the orbit");
  bool last_word = a->wanted < FINE; /* the accurate method goes on itself: come near enough */
  double enough = (last_word ? 3.0 : 0.3) * a->wanted * size;
  status = correct(w, enough, a->wanted >= COARSE || last_word ? 1 : 2);
  if (status) return status;
  double moved = fabs(w->orbit.velocity - w->run.velocity) + w->error;
  if (a->wanted >= COARSE && moved <= 0.8 * a->wanted * size)
    w->found = STRUT_WAY_CHEAP;
  else if (!last_word && strut_orbit_solve_tolerance_share(w) <= 0.8)
    w->found = STRUT_WAY_CORRECTED;
  if (w->found) return STRUT_OK;
  status = strut_orbit_solve_accurate(w, true, fmin(all, last_word ? LONG_TRIAL : TRIAL));
  if (status) return status;
  if (!w->found) return strut_orbit_solve_disputed(w);
  return strut_orbit_solve_check(w);
}

/*
 * The motion may be irregular; or it becomes periodic after all. Else the accurate method is left to
 * go on.
 */
static strut_status find_without_orbit(strut_orbit_solve *w) {
  bool periodic = false;
  strut_status status = strut_orbit_solve_irregular(w, &periodic);
  if (status || w->found) return status;
  if (!periodic || !strut_accuracy_orbit_answers(w->a, &w->run.steady))
    return strut_orbit_solve_accurate(w, true, fmax(20.0, strut_accuracy_periods(w->a)));
  status = make_maps(w, w->run.steady.repeats);
  return status ? status : finish(w);
}

/*
 * Where the cheap method nearly repeats itself, but not quite, the accurate one may: its steps meet no
 * grid.
 */
static strut_status find_without_cheap(strut_orbit_solve *w) {
  strut_status status = strut_orbit_solve_accurate(w, true, CHANCE);
  return status || w->found ? status : find_without_orbit(w);
}

/* The orbit, as accurately as is wanted. */
static strut_status find_orbit(strut_orbit_solve *w, bool steady) {
  strut_status status = make_maps(w, steady ? w->run.steady.repeats : 1);
  w->error = HUGE_VAL;
  if (status) return status;
  if (!steady) return find_without_orbit(w);
  status = settle_cheap(w, &steady);
  if (status) return status;
  if (!steady && w->cheap.repeats > 1) {
    status = make_maps(w, 1);
    w->settled = (strut_orbit_solve_cost){0};
  }
  if (status) return status;
  return steady ? finish(w) : find_without_cheap(w);
}

/*
 * Does the run that the way ended with speak for the scene's window? It has to have become steady before
 * that begins, counted from the scene's start.
 */
static bool answers(const strut_orbit_solve *w) {
  const strut_accuracy *a = w->a;
  strut_steady_summary steady = w->last.steady;
  if (a->experiment.steady.wanted) return true;
  double periods = (double)(w->run.steady.periods + steady.periods);
  if (periods > 2.0 * strut_accuracy_periods(a)) return false;
  steady.periods = 0;
  return steady.kind != STRUT_MOTION_PERIODIC || strut_accuracy_orbit_answers(a, &steady);
}

/*
 * Orbits need not be isolated: a structure that creeps within its stick bands may drift along a family of
 * them, more slowly than the watch for steady motion sees. Where the whole run costs the cheap method not
 * much more than what has been done, it is made, and must be as fast in its window as on the orbit.
 */
static strut_status check_window(strut_orbit_solve *w) {
  strut_accuracy *a = w->a;
  bool of_orbit = w->found >= STRUT_WAY_CHEAP && w->found <= STRUT_WAY_STUCK;
  double periods = a->experiment.periods, before = (double)w->run.steady.periods;
  double work = (double)w->run.force_evaluations / fmax(1.0, before) * periods;
  if (!of_orbit || a->experiment.steady.wanted || work > WHOLE_RUN * (double)a->used)
    return STRUT_OK;
  strut_experiment whole = a->cheap;
  strut_summary run = {0};
  strut_run_options options = {.without_ledger = true,
                               .interrupt = a->options->interrupt,
                               .progress = a->options->progress,
                               .progress_context = a->options->progress_context,
                               .from = a->options->from};
  whole.step = w->cheap.dt;
  strut_accuracy_begin_phase(a, "the whole run by the cheapest method");
  strut_status status = strut_accuracy_run(a, &whole, &options, &run);
  a->spent += run.force_evaluations;
  double away = fabs(run.velocity - w->run.velocity);
  if (!status && !(away <= 0.3 * a->wanted * strut_accuracy_scale(a, run.velocity)))
    w->found = STRUT_WAY_NONE;
  strut_summary_free(&run);
  return status;
}

/* The motion on the orbit found, which should go as fast as that was found to. */
static strut_status confirm(strut_orbit_solve *w, strut_summary *orbit) {
  strut_accuracy *a = w->a;
  if (w->found > STRUT_WAY_CORRECTED && !answers(w)) w->found = STRUT_WAY_NONE;
  strut_status status = check_window(w);
  if (status || !w->found) return status;
  status = run_orbit(w, orbit);
  double away = fabs(orbit->velocity - w->orbit.velocity);
  if (status || w->found > STRUT_WAY_CORRECTED ||
      away <= 0.6 * a->wanted * strut_accuracy_scale(a, w->run.velocity))
    return status;
  w->found = STRUT_WAY_NONE;
  a->spent += orbit->force_evaluations; /* its own velocity does not confirm the orbit */
  strut_summary_free(orbit);
  *orbit = (strut_summary){0};
  status = strut_orbit_solve_accurate(w, true, a->wanted < FINE ? LONG_TRIAL : TRIAL);
  if (!status && !w->found) status = strut_orbit_solve_disputed(w);
  return status ? status : run_orbit(w, orbit);
}

/* ---- the report ---- */

static void say_why(const strut_orbit_solve *w, strut_accuracy_summary *told) {
  double step = w->cheap.dt, tolerance = w->accurate.tolerance;
  double moved = fabs(w->orbit.velocity - w->run.velocity);
  size_t size = sizeof told->why;
  switch (w->found) {
    case STRUT_WAY_CHEAP:
      snprintf(
          told->why, size,
          "verlet-events with a step of %.3g s is the cheapest method that keeps it: one period "
          "by adaptive (tolerance %.1g) and its effect on the orbit change the velocity by %.2g "
          "m/s",
          step, tolerance, moved);
      return;
    case STRUT_WAY_STUCK:
      snprintf(
          told->why, size,
          "verlet-events with a step of %.3g s: all contacts stick through the period, and twice "
          "the step changes the velocity by %.2g m/s",
          0.5 * step, moved);
      return;
    case STRUT_WAY_IRREGULAR:
      snprintf(told->why, size,
               "no period repeats another: means over many of them, by verlet-events with steps of "
               "%.3g s and %.3g s, differ by %.2g m/s with what they scatter",
               step, 0.5 * step, w->error);
      return;
    case STRUT_WAY_DISPUTED:
      snprintf(told->why, size,
               "verlet-events with a step of %.3g s finds a periodic motion, adaptive (tolerance "
               "%.1g) none: their means and that with half the step differ by %.2g m/s",
               step, tolerance, w->error);
      return;
    default:
      snprintf(
          told->why, size,
          "verlet-events with a step of %.3g s until the motion was steady; its orbit was then "
          "corrected by periods of adaptive (tolerance %.1g), which changed the velocity by %.2g "
          "m/s%s",
          step, tolerance, moved,
          w->found == STRUT_WAY_ACCURATE ? "; adaptive went on until it was steady itself" : "");
  }
}

/* The error to expect [m/s]. */
static double expect(const strut_orbit_solve *w, const strut_summary *orbit) {
  double size = strut_accuracy_scale(w->a, w->orbit.velocity);
  double apart = fabs(orbit->velocity - w->orbit.velocity);
  double method = w->accurate.tolerance / STRUT_TOLERANCE_PER_ERROR / 3.0 * size;
  if (w->found >= STRUT_WAY_IRREGULAR) return w->error;
  double error = fmax(w->error, apart) + method;
  return w->found == STRUT_WAY_CHEAP ? error + fabs(w->orbit.velocity - w->run.velocity) : error;
}

/* Steps, forces and time of what the answer rests on. */
static void add_costs(const strut_orbit_solve *w, strut_summary *s) {
  const strut_orbit_solve_cost *settled = &w->settled;
  int64_t later = w->cheap.applied - settled->applied, fine = w->fine.applied;
  s->steps = w->run.steps + settled->applied * w->cheap.steps;
  s->events = w->run.events + settled->events;
  s->force_evaluations = w->run.force_evaluations + settled->evaluations;
  s->duration = w->run.duration + (double)settled->applied * w->cheap.period;
  if (w->found == STRUT_WAY_CHEAP) return;
  s->steps += later * w->cheap.steps + fine * w->fine.steps + w->last.steps;
  s->events += w->cheap.events - settled->events + w->fine.events + w->last.events;
  s->force_evaluations +=
      w->cheap.evaluations - settled->evaluations + w->fine.evaluations + w->last.force_evaluations;
  s->duration += (double)(later + fine) * w->cheap.period + w->last.duration;
}

static void report_orbit(strut_orbit_solve *w, const strut_summary *orbit) {
  strut_accuracy *a = w->a;
  strut_summary *s = a->summary;
  bool cheap_does = w->found == STRUT_WAY_CHEAP;
  bool ran_on = w->found > STRUT_WAY_CORRECTED;
  double error = expect(w, orbit);
  int64_t corrections = w->cheap.evaluations - w->settled.evaluations + w->fine.evaluations;
  *s = *orbit;
  s->velocity = cheap_does ? w->run.velocity : w->orbit.velocity;
  s->velocity_spread = ran_on ? w->last.velocity_spread : w->run.velocity_spread;
  s->settle_time = w->run.settle_time;
  s->steady = ran_on ? w->last.steady : w->run.steady;
  if (ran_on) s->steady.periods += w->run.steady.periods;
  s->steady.periods += w->settled.applied;
  s->steady.interval = error;
  add_costs(w, s);
  s->step = w->cheap.dt;
  s->step_limit = w->run.step_limit;
  s->wall_time = w->run.wall_time;
  bool adaptive = w->found == STRUT_WAY_CORRECTED || w->found == STRUT_WAY_ACCURATE;
  snprintf(s->method, sizeof s->method, "%s%s%s", strut_integrator_for(STRUT_ROLE_COARSE)->name,
           adaptive ? "+" : "", adaptive ? strut_integrator_for(STRUT_ROLE_REFERENCE)->name : "");
  s->accuracy = (strut_accuracy_summary){
      .wanted = a->wanted,
      .expected = error / strut_accuracy_scale(a, s->velocity),
      .scale = a->scale,
      .check_evaluations = a->spent + orbit->force_evaluations + (cheap_does ? corrections : 0)};
  s->accuracy.kept = s->accuracy.expected <= a->wanted;
  say_why(w, &s->accuracy);
}

strut_status strut_accuracy_by_orbit(strut_accuracy *a, bool *done) {
  strut_orbit_solve w = {.a = a};
  *done = false;
  bool steady_wanted = a->experiment.steady.wanted;
  if (strut_accuracy_periods(a) < (steady_wanted ? LEAST : LEAST_OF_RUN)) return STRUT_OK;
  bool steady = false;
  strut_summary orbit = {0};
  const strut_experiment given = a->cheap;
  a->allowed = (int64_t)(PART_OF_BUDGET * (double)a->budget);
  a->cheap.refine_rate = 0.5; /* its orbit will be corrected: a short refinement is enough */
  a->cheap.refine_memory = 3.0;
  a->cheap.steady.mean_tolerance = MEAN * a->wanted;
  strut_status status = run_cheap(&w, &steady);
  bool ran = !status && w.run.status == STRUT_OK;
  if (ran) status = find_orbit(&w, steady);
  if (ran && !status) status = confirm(&w, &orbit);
  *done = !status && w.found;
  if (*done)
    report_orbit(&w, &orbit);
  else
    give_up(&w, &orbit);
  a->cheap = given;
  a->allowed = a->budget;
  release(&w);
  return status == STRUT_DIVERGED || status == STRUT_WORK_LIMIT ? STRUT_OK : status;
}
