/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot: what changes with time alone: driven rest lengths (6) and loads on a signal. */
#include "engine/forces/forces.h"

#include <math.h>

void strut_drive_apply(const strut_model *model, strut_state *state, double t) {
  const strut_drive_table *d = &model->drives;
  state->drive_time = t;
  for (int32_t i = 0; i < d->count; i++) {
    state->rest[d->member[i]] = model->members.rest[d->member[i]];
    state->rest_rate[d->member[i]] = 0.0;
  }
  for (int32_t i = 0; i < d->count; i++) {
    double value, rate;
    strut_signal_evaluate(model->scene->signals, d->signal[i], t, &value, &rate);
    state->rest[d->member[i]] += value;
    state->rest_rate[d->member[i]] += rate;
  }
}

void strut_loads_apply(const strut_model *model, strut_state *state, double t,
                       const double *restrict v) {
  const strut_load_table *loads = &model->loads;
  for (int32_t i = 0; i < loads->count; i++) {
    double factor, rate;
    strut_signal_evaluate(model->scene->signals, loads->signal[i], t, &factor, &rate);
    int32_t at = 2 * loads->node[i];
    double px = factor * loads->x[i], py = factor * loads->y[i];
    state->force[at] += px;
    state->force[at + 1] += py;
    if (!state->ledger) continue;
    double power = px * v[at] + py * v[at + 1];
    state->power[STRUT_POWER_LOAD] += power;
    state->power[STRUT_POWER_MOVED] += fabs(power);
  }
}
