/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run to an accuracy by the steady orbit says of itself. */
#include <math.h>
#include <stdio.h>

#include "engine/run/accuracy/orbit_solve.h"

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

void strut_orbit_solve_report(strut_orbit_solve *w, const strut_summary *orbit) {
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
