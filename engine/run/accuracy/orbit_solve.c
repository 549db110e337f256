/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/accuracy/orbit_solve.h"

#include <math.h>
#include <string.h>

double strut_accuracy_scale(const strut_accuracy *a, double velocity) {
  return fmax(fabs(velocity), a->scale);
}

void strut_orbit_solve_count(strut_orbit_solve *w) {
  int64_t made = w->cheap.evaluations + w->fine.evaluations;
  w->a->used += made > w->counted ? made - w->counted : 0;
  w->counted = made;
}

void strut_summary_append(strut_summary *whole, strut_summary *part) {
  int64_t steps = whole->steps + part->steps, events = whole->events + part->events;
  int64_t evaluations = whole->force_evaluations + part->force_evaluations;
  int64_t periods = whole->steady.periods + part->steady.periods;
  double duration = whole->duration + part->duration, wall = whole->wall_time + part->wall_time;
  double settle = whole->settle_time;
  strut_summary_free(whole);
  *whole = *part;
  *part = (strut_summary){0};
  whole->steps = steps, whole->events = events, whole->force_evaluations = evaluations;
  whole->duration = duration, whole->wall_time = wall, whole->settle_time = settle;
  whole->steady.periods = periods;
}

strut_status strut_orbit_solve_run(strut_orbit_solve *w, strut_experiment e, double tolerance,
                                   int32_t successive, double periods, bool from_end,
                                   strut_summary *summary) {
  strut_accuracy *a = w->a;
  strut_snapshot from = w->end;
  e.steady.wanted = true;
  e.steady.tolerance = tolerance;
  e.steady.floor = tolerance * a->scale;
  e.steady.successive = successive;
  e.periods = fmin(e.periods, periods);
  e.measure_last = fmin(e.measure_last, e.periods);
  e.output_last = 0.0;
  strut_run_options options = {.without_ledger = true,
                               .interrupt = a->options->interrupt,
                               .progress = a->options->progress,
                               .progress_context = a->options->progress_context,
                               .from = from_end ? &from : a->options->from,
                               .to = &w->end};
  return strut_accuracy_run(a, &e, &options, summary);
}

void strut_orbit_solve_keep_end(strut_orbit_solve *w) {
  size_t length = (size_t)w->cheap.model->length;
  memcpy(w->orbit.y, w->end.q, length * sizeof(double));
  memcpy(w->orbit.y + length, w->end.v, length * sizeof(double));
  w->orbit.y[2 * length] = w->end.refined;
}

/* ---- the accurate method until it is steady itself, and whether its tolerance was small enough ---- */

/* Periods in which a finer tolerance should be steady, from the orbit of a coarser one. */
static const double TRIAL = 40.0;
enum { MOST_CHECKS = 4 };

strut_status strut_orbit_solve_map_status(strut_orbit_solve *w, strut_status status) {
  if (status) return strut_fail(w->a->error, status, "out of memory");
  strut_orbit_solve_count(w);
  if (strut_period_map_spent(&w->cheap) || strut_period_map_spent(&w->fine))
    return strut_fail(w->a->error, STRUT_WORK_LIMIT,
                      "the work allowed was used up while the orbit was corrected");
  if (!strut_period_map_interrupted(&w->cheap)) return STRUT_OK;
  return strut_fail(w->a->error, STRUT_INTERRUPTED,
                    "interrupted at t = %.9g s, while the orbit was corrected", w->cheap.time);
}

double strut_orbit_solve_tolerance_share(const strut_orbit_solve *w) {
  double size = strut_accuracy_scale(w->a, w->orbit.velocity);
  return w->error / (w->a->wanted * size);
}

void strut_orbit_solve_start_later_runs(strut_orbit_solve *w) {
  size_t length = (size_t)w->cheap.model->length;
  memcpy(w->end.q, w->orbit.y, length * sizeof(double));
  memcpy(w->end.v, w->orbit.y + length, length * sizeof(double));
  w->end.refined = w->orbit.y[2 * length];
}

/* The accurate method's run has the orbit. */
static void take_last(strut_orbit_solve *w) {
  strut_orbit_solve_keep_end(w);
  w->orbit.velocity = w->last.velocity;
  w->error = w->last.steady.interval;
  w->found = STRUT_WAY_ACCURATE;
}

strut_status strut_orbit_solve_accurate(strut_orbit_solve *w, bool from_orbit, double periods) {
  strut_accuracy *a = w->a;
  strut_summary more = {0};
  strut_accuracy_begin_phase(a, "until steady by adaptive");
  strut_orbit_solve_start_later_runs(w);
  /* where corrections fail the orbit is sensitive, and errors of a step matter more than usual */
  if (!w->tightened && !(strut_orbit_solve_tolerance_share(w) <= 0.8)) {
    w->accurate.tolerance = fmax(1e-12, w->accurate.tolerance / 25.0);
    w->tightened = true;
  }
  strut_status status = strut_orbit_solve_run(w, w->accurate, fmin(0.001, 0.2 * a->wanted), 4,
                                              periods, from_orbit, &more);
  if (!status) strut_summary_append(&w->last, &more);
  strut_summary_free(&more);
  if (!status && w->last.steady.kind == STRUT_MOTION_PERIODIC) take_last(w);
  return status;
}

/*
 * A sensitive orbit once more, with a tenth of the tolerance: it stands if that agrees to half of what
 * is wanted; else the finer one has the word, and is asked the same.
 */
static strut_status check_sensitive(strut_orbit_solve *w) {
  strut_accuracy *a = w->a;
  for (int k = 0; k < MOST_CHECKS; k++) {
    strut_summary finer = {0};
    strut_orbit_solve_start_later_runs(w);
    w->accurate.tolerance = fmax(1e-12, 0.1 * w->accurate.tolerance);
    strut_status status =
        strut_orbit_solve_run(w, w->accurate, fmin(0.001, 0.2 * a->wanted), 4, TRIAL, true, &finer);
    bool periodic = !status && finer.steady.kind == STRUT_MOTION_PERIODIC;
    double apart = periodic ? fabs(finer.velocity - w->orbit.velocity) : HUGE_VAL;
    bool stands = apart <= 0.5 * a->wanted * strut_accuracy_scale(a, w->orbit.velocity);
    if (stands || !periodic) {
      a->spent += finer.force_evaluations;
      w->error = fmax(w->error, stands ? apart : 0.0);
      w->accurate.tolerance *= 10.0;
    } else {
      strut_summary_append(&w->last, &finer);
      take_last(w);
      w->error = fmax(w->error, 0.5 * apart);
    }
    strut_summary_free(&finer);
    if (status || stands || !periodic) return status;
  }
  return STRUT_OK;
}

/*
 * What a tenth of the tolerance would change, by one period of it and its effect on the orbit; and, where
 * that is not little, by running on with it.
 */
static strut_status check_tolerance(strut_orbit_solve *w) {
  strut_accuracy *a = w->a;
  size_t both = 2 * (size_t)w->cheap.model->length + 1;
  strut_experiment finer = w->accurate;
  strut_period_map map = {.model = NULL};
  strut_orbit there = {.y = strut_arena_allocate(&w->arena, both, sizeof(double))};
  if (!there.y) return strut_fail(a->error, STRUT_NO_MEMORY, "out of memory");
  memcpy(there.y, w->orbit.y, both * sizeof(double));
  finer.tolerance = fmax(1e-12, 0.1 * finer.tolerance);
  double size = strut_accuracy_scale(a, w->orbit.velocity), half = 0.5 * a->wanted * size;
  const strut_orbit_solve_cost before = {w->cheap.evaluations, w->cheap.events, w->cheap.applied};
  strut_status status = strut_period_map_create(a->model, &finer, w->cheap.repeats, &map, a->error);
  if (status) return status;
  map.interrupt = w->cheap.interrupt, map.time = w->cheap.time;
  map.most_evaluations = strut_accuracy_left(a);
  status = strut_orbit_correct(&w->cheap, &map, w->base, w->travel, 0.1 * half * w->cheap.period,
                               &there);
  a->spent += w->cheap.evaluations - before.evaluations + map.evaluations;
  a->used += w->cheap.evaluations - before.evaluations + map.evaluations;
  w->cheap.evaluations = before.evaluations;
  w->cheap.events = before.events, w->cheap.applied = before.applied;
  strut_period_map_free(&map);
  status = strut_orbit_solve_map_status(w, status);
  double apart = there.converged ? fabs(there.velocity - w->orbit.velocity) : HUGE_VAL;
  if (status || apart > half) return status ? status : check_sensitive(w);
  w->error = fmax(w->error, apart);
  return STRUT_OK;
}

strut_status strut_orbit_solve_check(strut_orbit_solve *w) {
  return w->tightened ? check_sensitive(w) : check_tolerance(w);
}

/* ---- motions without an orbit to correct: irregular ones, and those that stick all the time ---- */

/* Periods of each run in which an irregular motion's mean is looked for, and when those show no end. */
static const double PERIODS = 136.0, MORE_PERIODS = 544.0;
/* Of that with half the step, as many as the former's latter half has. */
static const double HALF_PERIODS = 68.0;
/* Two velocities that agree to this part of what is wanted. */
static const double AGREE = 0.4;

static strut_experiment with_half_the_step(const strut_orbit_solve *w) {
  strut_experiment half = w->a->cheap;
  half.step *= 0.5;
  return half;
}

/* The run `last` is the answer; `error` is what it may be off by [m/s]. */
static void answer(strut_orbit_solve *w, strut_orbit_solve_end end, double error) {
  strut_orbit_solve_keep_end(w);
  w->orbit.velocity = w->last.velocity;
  w->error = error;
  w->found = end;
}

/*
 * The mean over a run's window scatters more than that over all of its periods: by as much as there
 * are fewer of them.
 */
static double scatter(const strut_orbit_solve *w, double interval, double periods) {
  const strut_experiment *e = &w->a->experiment;
  if (e->steady.wanted || !(e->measure_last < periods)) return interval;
  return interval * (1.0 + sqrt(periods / fmax(1.0, e->measure_last)));
}

/* The cheap method by more periods; what came out is added to way->run. */
static strut_status go_on(strut_orbit_solve *w, double periods) {
  strut_summary more = {0};
  strut_status status =
      strut_orbit_solve_run(w, w->a->cheap, w->a->wanted, 5, periods, true, &more);
  if (!status) strut_summary_append(&w->run, &more);
  strut_summary_free(&more);
  return status;
}

strut_status strut_orbit_solve_irregular(strut_orbit_solve *w, bool *periodic) {
  strut_accuracy *a = w->a;
  strut_summary half = {0};
  strut_status status = STRUT_OK;
  w->found = STRUT_WAY_NONE;
  if (w->run.steady.kind != STRUT_MOTION_IRREGULAR) status = go_on(w, PERIODS);
  if (!status && w->run.steady.kind == STRUT_MOTION_TRANSIENT) status = go_on(w, MORE_PERIODS);
  *periodic = !status && w->run.steady.kind == STRUT_MOTION_PERIODIC;
  if (status || w->run.steady.kind != STRUT_MOTION_IRREGULAR) return status;
  status = strut_orbit_solve_run(w, with_half_the_step(w), a->wanted, 5, HALF_PERIODS, true, &half);
  if (!status) {
    strut_summary_append(&w->last, &half);
    double apart = fabs(w->last.velocity - w->run.velocity);
    if (w->last.steady.kind == STRUT_MOTION_TRANSIENT)
      w->last.steady.kind = STRUT_MOTION_IRREGULAR; /* too short a run to see that itself */
    answer(w, STRUT_WAY_IRREGULAR, apart + scatter(w, w->run.steady.interval, HALF_PERIODS));
  }
  strut_summary_free(&half);
  return status;
}

bool strut_orbit_solve_is_stuck(const strut_orbit_solve *w) {
  const strut_contact_table *c = &w->cheap.model->contacts;
  double band = 0.0;
  for (int32_t i = 0; i < c->count; i++) band = fmax(band, c->entry[i].friction.stick_velocity);
  return w->cheap.applied > 0 && w->cheap.events == 0 && fabs(w->run.velocity) <= 1.01 * band;
}

strut_status strut_orbit_solve_stuck(strut_orbit_solve *w) {
  strut_accuracy *a = w->a;
  strut_summary half = {0};
  w->found = STRUT_WAY_NONE;
  strut_status status =
      strut_orbit_solve_run(w, with_half_the_step(w), fmin(0.001, 0.2 * a->wanted), 4,
                            fmax(20.0, strut_accuracy_periods(a)), false, &half);
  if (status) {
    strut_summary_free(&half);
    return status;
  }
  bool periodic = half.steady.kind == STRUT_MOTION_PERIODIC;
  strut_summary_append(&w->last, &half);
  double apart = fabs(w->last.velocity - w->run.velocity);
  if (periodic && apart <= AGREE * a->wanted * strut_accuracy_scale(a, w->last.velocity))
    answer(w, STRUT_WAY_STUCK, apart + w->last.steady.interval);
  return STRUT_OK;
}

strut_status strut_orbit_solve_disputed(strut_orbit_solve *w) {
  strut_summary half = {0};
  double accurate = w->last.velocity;
  strut_status status =
      strut_orbit_solve_run(w, with_half_the_step(w), w->a->wanted, 5, HALF_PERIODS, true, &half);
  if (!status) {
    strut_summary_append(&w->last, &half);
    double apart = fabs(accurate - w->run.velocity);
    answer(w, STRUT_WAY_DISPUTED, apart + fabs(w->last.velocity - w->run.velocity));
  }
  strut_summary_free(&half);
  return status;
}
