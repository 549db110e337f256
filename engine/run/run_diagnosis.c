/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run reports: errors that end it, and warnings about its result with cause and remedy. */
#include <math.h>
#include <stdio.h>
#include <string.h>

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

/* ---- warnings ---- */

/* Contacts that stuck by accident, if at all. */
static void warn_of_bands(const strut_run *r) {
  strut_summary *s = r->summary;
  const char *first = NULL;
  size_t count = 0;
  double needed = 0.0, times = 0.0;
  for (size_t i = 0; i < s->contact_count; i++) {
    if (!(s->contacts[i].band_needed > 0.0)) continue;
    if (!count++) first = s->contacts[i].node;
    needed = fmax(needed, s->contacts[i].band_needed);
    double band = r->model->contacts.entry[i].friction.stick_velocity;
    times = fmax(times, s->contacts[i].band_needed / band);
  }
  char more[40] = "";
  if (count > 1) snprintf(more, sizeof more, " and %zu more", count - 1);
  if (count)
    strut_summary_warn(s, "stick_band",
                       "node '%s'%s stuck to the ground by accident, if at all: a step changes its "
                       "slip by %.2g m/s, %.3g times its band; use stick_velocity >= %.2g m/s, a "
                       "smaller step, or a method with events",
                       first, more, needed, times, needed);
}

/* Feet that creep, each at its own speed, until one lets go. */
static void warn_of_creep(const strut_run *r) {
  const strut_band_tie *tie = strut_stick_band_strained(&r->band);
  if (!tie) return;
  const strut_scene *scene = r->model->scene;
  const strut_contact_entry *e = r->model->contacts.entry;
  strut_summary_warn(
      r->summary, "stick_creep",
      "nodes '%s' and '%s' stick, but creep in their stick bands, each at a speed of "
      "its own: that strained member '%s' by up to %.2g of the static friction of one "
      "of them, which may let go too soon; use a method with events, such as "
      "rk4-events, or a narrower band with a smaller step",
      scene->nodes[e[tie->contact[0]].node].name, scene->nodes[e[tie->contact[1]].node].name,
      scene->members[tie->member].name, tie->worst);
}

static void warn_of_limit(const strut_run *r) {
  const strut_step_limit_violation *fell = &r->summary->limit_fell;
  if (r->summary->status != STRUT_OK || !(fell->limit > 0.0)) return;
  strut_summary_warn(r->summary, "step_limit",
                     "the largest stable step fell to %.4g s at t = %.9g s, below the step %g s; "
                     "use solver.step <= %.2g s",
                     fell->limit, fell->time, r->summary->step, 0.9 * fell->limit);
}

/* A drive that changes by this part of its member within a step jumps. */
static const double JUMP = 1e-3;

typedef struct jump {
  const char *member;
  double change, time; /* [m], [s] */
} jump;

/* The largest jump of a drive between two times, relative to its member. */
static jump find_jump(const strut_run *r, double from, double to) {
  const strut_scene *scene = r->model->scene;
  jump found = {.member = NULL};
  double worst = JUMP;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *a = &scene->actuators[i];
    double when = 0.0, length = r->model->members.rest[a->member];
    double change = strut_signal_jump(scene->signals, a->signal, r->dt, from, to, &when);
    if (!(change > worst * length)) continue;
    worst = change / length;
    found = (jump){scene->members[a->member].name, change, when};
  }
  return found;
}

static bool opens_and_closes(const strut_run *r) {
  for (size_t i = 0; i < r->summary->contact_count; i++)
    if (r->summary->contacts[i].max_height > 0.0) return true;
  return false;
}

/* What fixed steps pass over, or NULL. */
static const char *passed_over(const strut_run *r) {
  if (r->method->events || r->method->region == STRUT_REGION_ALL) return NULL;
  bool friction = r->model->plan & STRUT_TERM_FRICTION, cables = r->model->plan & STRUT_TERM_SLACK;
  bool bounces = opens_and_closes(r);
  if (bounces && friction) return "touchdowns and changes between sticking and slipping";
  if (bounces) return "touchdowns";
  if (friction) return "changes between sticking and slipping";
  return cables ? "cables that become taut" : NULL;
}

/* Likely cause and remedy. */
static void explain(const strut_run *r, char *text, size_t size) {
  const strut_balance_monitor *b = &r->balance;
  bool sudden = fabs(b->worst) > 0.5 * fabs(r->summary->energy.residual);
  double offset = r->grid.offset, from = b->from + offset, to = b->to + offset;
  double begin = (double)r->first * r->dt + offset, now = strut_run_time(r);
  jump j = sudden ? find_jump(r, from - r->dt, to) : find_jump(r, begin + 1e-3 * r->dt, now);
  const char *over = passed_over(r);
  if (r->options->chosen) {
    snprintf(text, size,
             "; the accuracy wanted is that of what is measured, which the energy need not share: "
             "measure energy.total too, or ask for more");
    return;
  }
  int used = sudden ? snprintf(text, size, ", most of it by t = %.6g s", to) : 0;
  text += used, size -= (size_t)used;
  if (j.member)
    snprintf(text, size,
             "; likely because the drive of member '%s' changes its length by %.3g m within one "
             "step at t = %.6g s; let that take many steps, use a smaller step, or --accuracy 1%%",
             j.member, j.change, j.time);
  else if (over)
    snprintf(text, size,
             "; likely because fixed steps pass over %s; use rk4-events, a smaller step, or "
             "--accuracy 1%%",
             over);
  else
    snprintf(text, size,
             "; likely because the step of %g s is too large for the fastest motion; use a smaller "
             "step, or --accuracy 1%%",
             r->dt);
}

static void warn_of_balance(const strut_run *r) {
  strut_summary *s = r->summary;
  char why[400] = "";
  if (s->balance != STRUT_BALANCE_OPEN || s->status != STRUT_OK) return;
  explain(r, why, sizeof why);
  strut_summary_warn(s, "energy_balance",
                     "the energy balance does not close: %.3g J, %.2g %% of the energy moved, %s%s",
                     fabs(s->energy.residual), 100.0 * fabs(s->energy.residual) / s->energy.moved,
                     s->energy.residual > 0.0 ? "came from nowhere" : "went nowhere", why);
}

void strut_run_warn(const strut_run *r) {
  strut_summary_warn_of_start(r->summary);
  warn_of_balance(r);
  warn_of_bands(r);
  warn_of_creep(r);
  warn_of_limit(r);
}
