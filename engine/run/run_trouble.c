/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a run that cannot go on says so. */
#include <math.h>

#include "engine/run/simulate_parts.h"

/* Beyond this many times the scene's size a run counts as diverged. */
static const double BEYOND = 1e10;
int32_t strut_run_lost_node(const strut_model *model, const strut_state *state) {
  double bound = BEYOND * (model->size > 0 ? model->size : 1.0);
  for (int32_t i = 0; i < model->node_count; i++) {
    double x = state->q[2 * i], y = state->q[2 * i + 1];
    double vx = state->v[2 * i], vy = state->v[2 * i + 1];
    if (!(fabs(x) <= bound && fabs(y) <= bound) || isnan(vx + vy)) return i;
  }
  return -1;
}

strut_status strut_run_diverged(const strut_run *r, int32_t node) {
  double limit = strut_step_limit_monitor_last_limit(r->model, &r->guard),
         least = r->summary->step_limit;
  double seen = (double)r->guard.last * r->dt;
  const char *remedy = r->dt > 0.5 * fmin(limit, least)
                           ? "use a smaller step"
                           : "look for a member or contact that is far too stiff or a load that "
                             "grows without bound; a smaller step may help too";
  if (r->guard.lowest > 0.0 && !r->options->force)
    return strut_step_limit_monitor_fail(&r->guard, r->state, least, r->error);
  if (limit < 0.99 * least)
    return strut_fail(r->error, STRUT_DIVERGED,
                      "node '%s' left all bounds at t = %.9g s with dt = %g s (largest stable step "
                      "at the start: %.4g s, at t = %.9g s: %.4g s); %s",
                      r->summary->node_names[node], strut_run_time(r), r->dt, least, seen, limit,
                      remedy);
  return strut_fail(r->error, STRUT_DIVERGED,
                    "node '%s' left all bounds at t = %.9g s with dt = %g s (largest stable step "
                    "at the start: %.4g s); %s",
                    r->summary->node_names[node], strut_run_time(r), r->dt, least, remedy);
}

strut_status strut_run_stuck(const strut_run *r) {
  static const char *const why[] = {
      [STRUT_FAILURE_STEP] =
          "the step needed for the tolerance became too small to matter; give a "
          "larger solver.tolerance, or look for a member of zero length",
      [STRUT_FAILURE_NEWTON] = "the implicit step has no solution nearby; use a smaller step",
      [STRUT_FAILURE_RIGID] =
          "rigid bars cannot keep their lengths; use a smaller step, or look for "
          "bars that hold each other",
      [STRUT_FAILURE_INTERRUPT] = "it was interrupted"};
  if (r->state->trouble == STRUT_FAILURE_IMPLICIT)
    return strut_fail(
        r->error, STRUT_DIVERGED,
        "%s found no solution of its step at t = %.9g s, near node '%s', with dt = %g "
        "s; use a smaller step, or look there for a member that passes through no length",
        r->method->name, strut_run_time(r), r->summary->node_names[r->state->trouble_node], r->dt);
  return strut_fail(r->error, STRUT_DIVERGED, "%s could not go on at t = %.9g s: %s",
                    r->method->name, strut_run_time(r), why[r->state->trouble]);
}

/* Has most of the energy that was exchanged come from nowhere? So it does where motions grow by
   themselves, also those that slack cables and open contacts bound. */
static bool energy_from_nowhere(const strut_run *r) {
  strut_energy e;
  if (!r->state->ledger) return false;
  if (!(r->dt > 0.5 * r->summary->step_limit)) return false; /* then it is not the step's limit */
  strut_balance_fill(r->model, r->state, &r->initial, strut_time_grid_at(&r->grid, r->state->step),
                     &e);
  double there = e.kinetic + e.elastic + fabs(e.gravity) + e.contact;
  return e.residual > 0.5 * (e.moved + fabs(e.initial) + there);
}

strut_status strut_run_watch_step(strut_run *r) {
  if (r->state->step < r->guard.next) return STRUT_OK;
  strut_stick_band_sample(r->model, r->state, &r->band);
  bool garbage = !r->options->force && energy_from_nowhere(r);
  if (garbage && !(r->guard.lowest > 0.0))
    strut_step_limit_monitor_check(r->model, r->state, &r->guard);
  if (!garbage) strut_step_limit_monitor_sample(r->model, r->state, &r->guard);
  if (r->options->force) return STRUT_OK;
  if (!r->guard.hopeless && !garbage) return STRUT_OK;
  return strut_step_limit_monitor_fail(&r->guard, r->state, r->summary->step_limit, r->error);
}
