/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/balance.h"

#include <float.h>
#include <math.h>

/* Force evaluations between two looks: what one takes is lost among them. */
enum { EVALUATIONS = 256 };
/* Of the energy moved; rounding errors of so many units in the last place for each step. */
static const double OPEN = 0.01, ROUNDING = 16.0 * DBL_EPSILON;

static double change(double a, double b) { return fabs(a - b); }

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
  e->dissipated_members = w[STRUT_POWER_MEMBERS];
  e->dissipated_contact = w[STRUT_POWER_CONTACT];
  e->dissipated_friction = w[STRUT_POWER_FRICTION];
  e->initial = begin->kinetic + begin->elastic + begin->gravity + begin->contact;
  e->residual = end.kinetic + end.elastic + end.gravity + end.contact - e->initial - e->drive_work -
                e->load_work - e->belt_work + e->dissipated_members + e->dissipated_contact +
                e->dissipated_friction;
  e->moved = change(end.kinetic, begin->kinetic) + change(end.elastic, begin->elastic) +
             change(end.gravity, begin->gravity) + change(end.contact, begin->contact) +
             fabs(loads) + w[STRUT_POWER_EXCHANGED];
}

void strut_balance_begin(const strut_state *state, const strut_energies *begin, double t,
                         int evaluations, strut_balance_monitor *watch) {
  int64_t every = EVALUATIONS / evaluations;
  *watch =
      (strut_balance_monitor){.every = every > 0 ? every : 1, .swing = begin->kinetic, .time = t};
  watch->next = state->ledger ? state->step + watch->every : INT64_MAX;
}

void strut_balance_sample(const strut_model *model, strut_state *state, const strut_energies *begin,
                          double t, strut_balance_monitor *watch, strut_energy *e) {
  strut_balance_fill(model, state, begin, t, e);
  watch->swing = fmax(watch->swing, e->kinetic);
  e->moved = fmax(e->moved, watch->swing); /* what swings may end as it began */
  double change = e->residual - watch->residual;
  if (fabs(change) > fabs(watch->worst)) {
    watch->worst = change;
    watch->from = watch->time, watch->to = t;
  }
  watch->residual = e->residual, watch->time = t;
  while (watch->next <= state->step) watch->next += watch->every;
}

strut_balance strut_balance_judge(const strut_energy *e, int64_t steps) {
  double there = fabs(e->initial) + e->kinetic + e->elastic + fabs(e->gravity) + e->contact;
  double rounding = ROUNDING * ((double)steps + 100.0) * (there + e->moved);
  bool open = fabs(e->residual) > OPEN * e->moved && fabs(e->residual) > rounding;
  return open ? STRUT_BALANCE_OPEN : STRUT_BALANCE_CLOSED;
}
