/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The accurate method until it is steady itself, and whether its tolerance was small enough. */
#include <math.h>
#include <string.h>

#include "engine/run/accuracy/orbit_solve.h"

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
