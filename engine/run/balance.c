/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/balance.h"

#include <math.h>

static double change(double a, double b) { return fabs(a - b); }

void strut_balance_fill(const strut_model *model, strut_state *state, const strut_stored *begin,
                        double t, strut_energy *e) {
  const double *w = state->work;
  strut_stored end = strut_energy_stored(model, state, t);
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
  e->residual = end.kinetic + end.elastic + end.gravity + end.contact - e->initial -
                e->drive_work - e->load_work - e->belt_work + e->dissipated_members +
                e->dissipated_contact + e->dissipated_friction;
  e->moved = change(end.kinetic, begin->kinetic) + change(end.elastic, begin->elastic) +
             change(end.gravity, begin->gravity) + change(end.contact, begin->contact) +
             fabs(loads) + w[STRUT_POWER_MOVED];
}
