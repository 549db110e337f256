/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The summary of a periodic orbit to a wanted accuracy: what it cost, how it was found, its error. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "engine/run/accuracy/orbit_solve.h"

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
      snprintf(
          to->why, size,
          "the motion does not repeat itself: mean velocities over many periods, by verlet-events "
          "with steps of %.3g s and %.3g s, agree to %.2g m/s including their scatter",
          step, 0.5 * step, solve->error);
      return;
    case STRUT_ORBIT_DISPUTED:
      snprintf(
          to->why, size,
          "verlet-events with a step of %.3g s finds a periodic motion and adaptive (tolerance "
          "%.1g) does not: their mean velocities and that with half the step agree to %.2g m/s",
          step, tolerance, solve->error);
      return;
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

/*
 * Estimated error of the velocity [m/s]. A first correction is not known better than the fixed point it starts from
 * was sought.
 */
static double estimate_error(const strut_orbit_solve *solve) {
  double size = strut_accuracy_velocity_scale(solve->a, solve->orbit.velocity);
  double method = solve->reference.tolerance / STRUT_TOLERANCE_PER_ERROR / 3.0 * size;
  if (solve->answer >= STRUT_ORBIT_IRREGULAR) return solve->error;
  double error = fmax(solve->error, solve->apart) + method;
  if (solve->answer == STRUT_ORBIT_CORRECTED)
    error += STRUT_FIXED_POINT_PART * solve->a->target * size;
  return solve->answer == STRUT_ORBIT_COARSE
             ? error + fabs(solve->orbit.velocity - solve->coarse_run.velocity)
             : error;
}

/* The force evaluations of all parts of the answer. */
static int64_t sum_evaluations(const strut_orbit_solve *solve) {
  int64_t coarse = solve->coarse_run.force_evaluations;
  if (solve->answer == STRUT_ORBIT_COARSE) return coarse + solve->until_steady;
  return coarse + solve->coarse_map.evaluations + solve->reference_map.evaluations +
         solve->last_run.force_evaluations;
}

/*
 * Makes the summary that of the whole motion from t = 0: up to the orbit, then along it, as `orbit` is, whose works
 * and losses are over all of it already.
 */
static void tell_whole_motion(const strut_orbit_solve *solve, const strut_summary *orbit,
                              strut_summary *s) {
  const strut_snapshot *from = solve->a->options->from;
  double before = solve->orbit_time - (from ? from->time : 0.0);
  s->duration = before + orbit->duration;
  s->steps = solve->orbit_history.steps + orbit->steps;
  s->events = solve->orbit_history.events + orbit->events;
  s->steady.periods = llround(before / solve->coarse_map.period);
}

void strut_orbit_solve_report(strut_orbit_solve *solve, const strut_summary *orbit) {
  strut_accuracy *a = solve->a;
  strut_summary *s = a->summary;
  assert(solve->answer != STRUT_ORBIT_NONE);
  bool coarse_suffices = solve->answer == STRUT_ORBIT_COARSE;
  bool ran_on = solve->answer > STRUT_ORBIT_CORRECTED;
  double error = estimate_error(solve);
  int64_t corrections =
      solve->coarse_map.evaluations - solve->until_steady + solve->reference_map.evaluations;
  *s = *orbit;
  s->velocity = coarse_suffices ? solve->coarse_run.velocity : solve->orbit.velocity;
  s->velocity_spread = ran_on ? solve->last_run.velocity_spread : solve->coarse_run.velocity_spread;
  s->settle_time = solve->coarse_run.settle_time;
  s->steady = ran_on ? solve->last_run.steady : solve->coarse_run.steady;
  s->steady.interval = error;
  tell_whole_motion(solve, orbit, s);
  s->force_evaluations = sum_evaluations(solve);
  s->step = solve->coarse_map.dt;
  s->step_limit = solve->coarse_run.step_limit;
  s->wall_time = solve->coarse_run.wall_time;
  bool adaptive = solve->answer == STRUT_ORBIT_CORRECTED || solve->answer == STRUT_ORBIT_REFERENCE;
  snprintf(s->method, sizeof s->method, "%s%s%s", strut_integrator_for(STRUT_ROLE_COARSE)->name,
           adaptive ? "+" : "", adaptive ? strut_integrator_for(STRUT_ROLE_REFERENCE)->name : "");
  s->accuracy = (strut_accuracy_summary){
      .wanted = a->target,
      .expected = error / strut_accuracy_velocity_scale(a, s->velocity),
      .scale = a->scale,
      .check_evaluations =
          a->check_evaluations + orbit->force_evaluations + (coarse_suffices ? corrections : 0)};
  /* of what creeps only that is promised */
  double known = solve->answer == STRUT_ORBIT_CREEPING ? 0.0 : s->accuracy.expected;
  s->accuracy.kept = strut_accuracy_is_kept(true, known, a->target);
  explain_orbit(solve, &s->accuracy);
}
