/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run says of its result: likely cause and remedy, once per cause. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/simulate_parts.h"

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

/* The residual of the energy balance over the net work done on the structure, in words. */
static void describe_residual(const strut_energy *e, char *text, size_t size) {
  double work = fabs(e->drive_work + e->load_work + e->belt_work);
  double part = fabs(e->residual) / work;
  if (!(work > 0.0) || !isfinite(part)) return;
  const char *verdict = part < 1e-3 ? "small" : part < 1e-2 ? "moderate" : "large";
  snprintf(text, size, "; the energy residual is %s: %.2g %% of the net work done", verdict,
           100.0 * part);
}

/* A fixed step that passes over switches says nothing of its own error. */
static void note_unknown_error(const strut_run *r) {
  strut_summary *s = r->summary;
  const char *over = passed_over(r);
  char residual[160] = "";
  s->caveat[0] = '\0';
  if (!over || r->options->chosen || s->status != STRUT_OK) return;
  if (s->balance != STRUT_BALANCE_NOT_KEPT)
    describe_residual(&s->energy, residual, sizeof residual);
  snprintf(
      s->caveat, sizeof s->caveat,
      "not known: fixed steps of %s pass over %s%s; --accuracy 1%% chooses the method and step "
      "and states the error",
      s->method, over, residual);
}

void strut_run_warn(const strut_run *r) {
  note_unknown_error(r);
  strut_summary_warn_of_start(r->summary);
  warn_of_balance(r);
  warn_of_bands(r);
  warn_of_creep(r);
  warn_of_limit(r);
}
