/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/drives/support_motion.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/forces/energy.h"
#include "engine/scene/signal.h"

void strut_support_motion_place(const strut_model *model, const strut_state *state, double t,
                                double *q, double *velocity) {
  const strut_support_motion_table *table = &model->support_motion;
  for (int32_t i = 0; i < table->count; i++) {
    const strut_moved_coordinate *coordinate = &table->item[i];
    double value;
    strut_signal_evaluate(model->scene->signals, coordinate->signal, t + state->time_offset, &value,
                          &velocity[coordinate->at]);
    q[coordinate->at] = coordinate->base + value;
  }
}

static void add_reaction_power(const strut_model *model, const strut_state *state, double power,
                               const double *velocity) {
  const strut_support_motion_table *table = &model->support_motion;
  for (int32_t i = 0; i < table->count; i++)
    power -= state->latest->force[table->item[i].at] * velocity[table->item[i].at];
  state->latest->power[STRUT_POWER_SUPPORT] += power;
  state->latest->power[STRUT_POWER_EXCHANGED] += fabs(power);
}

void strut_support_motion_apply(const strut_model *model, const strut_state *state, double t,
                                const double *velocity) {
  const strut_support_motion_table *table = &model->support_motion;
  const strut_signal *signals = model->scene->signals;
  double power = 0.0, *acceleration = state->buffers->support_rates;
  for (int32_t i = 0; i < table->count && table->coupling_count; i++)
    acceleration[i] =
        strut_signal_acceleration(signals, table->item[i].signal, t + state->time_offset);
  for (int32_t k = 0; k < table->coupling_count; k++) {
    const strut_support_coupling *coupling = &table->coupling[k];
    double push = -coupling->mass * acceleration[coupling->item];
    state->latest->force[coupling->at] += push;
    power += push * velocity[coupling->at];
  }
  if (state->balance) add_reaction_power(model, state, power, velocity);
}

void strut_support_motion_apply_mean(const strut_model *model, const strut_state *state, double h,
                                     const double *before, const double *after, const double *u) {
  const strut_support_motion_table *table = &model->support_motion;
  double power = 0.0;
  for (int32_t k = 0; k < table->coupling_count; k++) {
    const strut_support_coupling *coupling = &table->coupling[k];
    double push = -coupling->mass * (after[coupling->item] - before[coupling->item]) / h;
    state->latest->force[coupling->at] += push;
    power += push * u[coupling->at];
  }
  if (state->balance) add_reaction_power(model, state, power, u);
}

/* Sum of the jumps of a signal's rate after `from` and up to `to`. */
static double jump_of_rate(const strut_signal *signals, int32_t signal, double from, double to) {
  double sum = 0.0, at = strut_signal_next_break(signals, signal, from);
  for (; at <= to; at = strut_signal_next_break(signals, signal, at)) {
    double value, before, after, moment = 8.0 * DBL_EPSILON * fmax(fabs(at), to - from);
    strut_signal_evaluate(signals, signal, at - moment, &value, &before);
    strut_signal_evaluate(signals, signal, at + moment, &value, &after);
    sum += after - before;
  }
  return sum;
}

/* Impulses of the jumps into state->latest->force. True if there are any. */
static bool find_impulses(const strut_model *model, const strut_state *state, double from,
                          double to) {
  const strut_support_motion_table *table = &model->support_motion;
  bool any = false;
  for (int32_t i = 0; i < table->count; i++) {
    state->buffers->support_rates[i] =
        jump_of_rate(model->scene->signals, table->item[i].signal, from + state->time_offset,
                     to + state->time_offset);
    any = any || state->buffers->support_rates[i] != 0.0;
  }
  if (!any) return false;
  memset(state->latest->force, 0, (size_t)model->length * sizeof *state->latest->force);
  for (int32_t k = 0; k < table->coupling_count; k++) {
    const strut_support_coupling *coupling = &table->coupling[k];
    state->latest->force[coupling->at] -=
        coupling->mass * state->buffers->support_rates[coupling->item];
  }
  return true;
}

bool strut_support_motion_kick(const strut_model *model, strut_state *state, double from,
                               double to) {
  const strut_support_motion_table *table = &model->support_motion;
  if (!table->corners || !find_impulses(model, state, from, to)) return false;
  strut_impulse_apply(model, state, STRUT_POWER_SUPPORT);
  return true;
}

/* The part of the kinetic energy to which moved velocities contribute. */
static double moved_energy(const strut_model *model, const strut_state *state) {
  const strut_support_motion_table *table = &model->support_motion;
  double whole = strut_energy_kinetic(model, state->v);
  memcpy(state->buffers->support_answer, state->v, (size_t)model->length * sizeof *state->v);
  for (int32_t i = 0; i < table->count; i++)
    state->buffers->support_answer[table->item[i].at] = 0.0;
  double rest = strut_energy_kinetic(model, state->buffers->support_answer);
  memset(state->buffers->support_answer, 0, (size_t)model->length * sizeof *state->v);
  return whole - rest;
}

double strut_support_motion_work(const strut_model *model, const strut_state *state) {
  if (!(model->terms & STRUT_TERM_SUPPORT_MOTION)) return 0.0;
  return state->work[STRUT_POWER_SUPPORT] + moved_energy(model, state) - state->support_work_origin;
}

void strut_support_motion_reset_work(const strut_model *model, strut_state *state) {
  if (model->terms & STRUT_TERM_SUPPORT_MOTION)
    state->support_work_origin = moved_energy(model, state) + state->work[STRUT_POWER_SUPPORT];
}
