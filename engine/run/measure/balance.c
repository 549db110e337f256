/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/balance.h"

#include <float.h>
#include <math.h>

#include "engine/forces/support_motion.h"
#include "engine/forces/surfaces.h"

/* Force evaluations between two samples, which make the cost of a sample negligible. */
enum { EVALUATIONS_PER_SAMPLE = 256 };
/* Part of the exchanged energy; rounding errors of this many units in the last place per step. */
static const double OPEN = 0.01, ROUNDING = 16.0 * DBL_EPSILON;

/*
 * Part of the exchanged energy that a loss may give between two samples. Weights of Runge-Kutta's stages below 0 do:
 * 4e-11 of it at most in all models, by each method and with steps far too long.
 */
static const double GIVEN = 1e-6;

static double absolute_change(double a, double b) { return fabs(a - b); }

/* What rounding may have changed in so many steps. */
static double rounding_of(const strut_energy *e, int64_t steps) {
  double stored = fabs(e->initial) + e->kinetic + e->elastic + fabs(e->gravity) + e->contact;
  return ROUNDING * ((double)steps + 100.0) * (stored + e->moved);
}

void strut_balance_fill(const strut_model *model, strut_state *state, const strut_energies *begin,
                        double t, strut_energy *e) {
  const double *w = state->work;
  strut_energies end = strut_energy_evaluate(model, state, t);
  double loads = strut_energy_load_work(model, state);
  e->kinetic = end.kinetic, e->elastic = end.elastic, e->gravity = end.gravity;
  e->contact = end.contact;
  e->drive_work = w[STRUT_POWER_DRIVE];
  e->load_work = w[STRUT_POWER_LOAD] + loads;
  e->belt_work = w[STRUT_POWER_BELT];
  e->support_work = strut_support_motion_work(model, state);
  e->dissipated_members = w[STRUT_POWER_MEMBERS];
  e->dissipated_contact = w[STRUT_POWER_CONTACT];
  e->dissipated_friction = w[STRUT_POWER_FRICTION];
  e->initial = begin->kinetic + begin->elastic + begin->gravity + begin->contact;
  e->residual = end.kinetic + end.elastic + end.gravity + end.contact - e->initial - e->drive_work -
                e->load_work - e->belt_work - e->support_work + e->dissipated_members +
                e->dissipated_contact + e->dissipated_friction;
  e->moved = absolute_change(end.kinetic, begin->kinetic) +
             absolute_change(end.elastic, begin->elastic) +
             absolute_change(end.gravity, begin->gravity) +
             absolute_change(end.contact, begin->contact) + fabs(loads) + w[STRUT_POWER_EXCHANGED];
}

void strut_balance_begin(const strut_state *state, const strut_energies *begin, double t,
                         int evaluations, strut_balance_monitor *monitor) {
  int64_t every = EVALUATIONS_PER_SAMPLE / evaluations;
  *monitor =
      (strut_balance_monitor){.every = every > 0 ? every : 1, .swing = begin->kinetic, .time = t};
  monitor->next = state->ledger ? state->step + monitor->every : INT64_MAX;
}

static double lost_in(const strut_energy *e, strut_loss loss) {
  return loss == STRUT_LOSS_MEMBERS   ? e->dissipated_members
         : loss == STRUT_LOSS_CONTACT ? e->dissipated_contact
                                      : e->dissipated_friction;
}

/*
 * Within its band Karnopp's friction balances the other forces whatever the speed, so that it may give energy, at
 * most with the speed at the edge. Normal forces between samples are taken to be a few times those at them.
 */
static double creeping_power(const strut_model *model, const strut_state *state) {
  const strut_contact_table *c = &model->contacts;
  const double *g = model->scene->gravity;
  double weight = 0.0, power = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) weight += model->weight[i] * hypot(g[0], g[1]);
  for (int32_t i = 0; i < c->count; i++) {
    const strut_contact_entry *e = &c->entry[i];
    double gap, slip;
    if (!strut_friction_has_band(e->friction.law)) continue;
    strut_contact_observe(c, i, state, &gap, &slip);
    power += e->friction.stick_velocity * strut_friction_largest(&e->friction) *
             (4.0 * fmax(0.0, -gap * e->stiffness) + weight);
  }
  return power;
}

/* May what members lose be below 0? Where a law pushes that carries tension only, or breaks with less than no energy. */
static bool members_may_give(const strut_model *model) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    if (strut_law_at(e->law)->own && (e->carries || e->remembers)) return true;
  }
  return false;
}

/* Notes the first loss that has given energy since the latest sample, or since the start. */
static void watch_losses(const strut_model *model, const strut_energy *e, int64_t steps,
                         double creep, strut_balance_monitor *monitor) {
  double allowed = GIVEN * e->moved + rounding_of(e, steps);
  monitor->creep += creep;
  for (int k = 0; k < STRUT_LOSS_COUNT; k++) {
    bool rubs = k == STRUT_LOSS_FRICTION;
    double now = lost_in(e, (strut_loss)k), since = monitor->lost[k] - now;
    double over = fmax(since - (rubs ? creep : 0.0), -now - (rubs ? monitor->creep : 0.0));
    monitor->lost[k] = now;
    if (!(over > allowed) || monitor->given > 0.0) continue;
    if (k == STRUT_LOSS_MEMBERS && members_may_give(model)) continue;
    monitor->giver = (strut_loss)k, monitor->given = fmax(since, -now);
  }
}

void strut_balance_sample(const strut_model *model, strut_state *state, const strut_energies *begin,
                          double t, strut_balance_monitor *monitor, strut_energy *e) {
  strut_balance_fill(model, state, begin, t, e);
  monitor->swing = fmax(monitor->swing, e->kinetic);
  e->moved = fmax(e->moved, monitor->swing); /* an oscillation may end as it began */
  double change = e->residual - monitor->residual;
  if (fabs(change) > fabs(monitor->worst)) {
    monitor->worst = change;
    monitor->from = monitor->time, monitor->to = t;
  }
  double creep = creeping_power(model, state) * (t - monitor->time);
  watch_losses(model, e, state->step, creep, monitor);
  monitor->residual = e->residual, monitor->time = t;
  while (monitor->next <= state->step) monitor->next += monitor->every;
}

void strut_balance_continue(const strut_energy *before, strut_state *state, strut_energies *begin) {
  double *w = state->work;
  w[STRUT_POWER_DRIVE] = before->drive_work;
  w[STRUT_POWER_LOAD] = before->load_work;
  w[STRUT_POWER_BELT] = before->belt_work;
  w[STRUT_POWER_MEMBERS] = before->dissipated_members;
  w[STRUT_POWER_CONTACT] = before->dissipated_contact;
  w[STRUT_POWER_FRICTION] = before->dissipated_friction;
  w[STRUT_POWER_EXCHANGED] = before->moved;
  state->support_work_origin -= before->support_work;
  double end = before->kinetic + before->elastic + before->gravity + before->contact;
  begin->elastic += before->initial - end;
}

void strut_balance_warn(strut_summary *s, const char *why) {
  const char *code = "energy_balance";
  double residual = s->energy.residual;
  strut_summary_withdraw(s, code);
  if (s->balance != STRUT_BALANCE_OPEN || s->status != STRUT_OK) return;
  strut_summary_warn(
      s, code, "the energy balance does not close: %.3g J, %.2g %% of the exchanged energy, %s%s",
      fabs(residual), 100.0 * fabs(residual) / s->energy.moved,
      residual > 0.0 ? "appeared without a source" : "disappeared without a sink", why);
}

strut_balance strut_balance_judge(const strut_energy *e, int64_t steps) {
  bool open = fabs(e->residual) > OPEN * e->moved && fabs(e->residual) > rounding_of(e, steps);
  return open ? STRUT_BALANCE_OPEN : STRUT_BALANCE_CLOSED;
}
