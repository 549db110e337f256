/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Motions without an orbit to correct: irregular ones, and those that stick all the time. */
#include <math.h>

#include "engine/run/accuracy/orbit_solve.h"

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
