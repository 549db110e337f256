/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/unbalance.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/energy.h"
#include "engine/scene/signal_motion.h"

/* Direction of the mass, and the first and second derivatives of its angle. */
typedef struct rotation {
  double cosine, sine, rate, acceleration;
} rotation;

static rotation rotate_by_signal(const strut_signal *signals, const strut_unbalance *u, double t) {
  rotation r;
  double angle;
  strut_signal_evaluate(signals, u->signal, t, &angle, &r.rate);
  strut_sincos_turns((u->phase + angle) / STRUT_TAU, &r.sine, &r.cosine);
  r.acceleration = strut_signal_acceleration(signals, u->signal, t);
  return r;
}

static rotation rotate(const strut_signal *signals, const strut_unbalance *u, double t) {
  if (u->signal >= 0) return rotate_by_signal(signals, u, t);
  rotation r = {.rate = u->speed};
  strut_sincos_turns(u->phase / STRUT_TAU + u->speed / STRUT_TAU * t, &r.sine, &r.cosine);
  return r;
}

static void push(strut_state *state, const strut_unbalance *u, double fx, double fy,
                 const double *v) {
  int32_t at = 2 * u->node;
  state->latest.force[at] += fx;
  state->latest.force[at + 1] += fy;
  if (!state->balance) return;
  double power = fx * v[at] + fy * v[at + 1];
  state->latest.power[STRUT_POWER_DRIVE] += power;
  state->latest.power[STRUT_POWER_EXCHANGED] += fabs(power);
}

void strut_unbalance_apply(const strut_model *model, strut_state *state, double t,
                           const double *v) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *u = &scene->unbalances[i];
    rotation r = rotate(scene->signals, u, t + state->time_offset);
    double arm = u->mass * u->radius, square = r.rate * r.rate;
    push(state, u, arm * (square * r.cosine + r.acceleration * r.sine),
         arm * (square * r.sine - r.acceleration * r.cosine), v);
  }
}

void strut_unbalance_apply_mean(const strut_model *model, strut_state *state, double t, double h,
                                const double *v) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *u = &scene->unbalances[i];
    rotation a = rotate(scene->signals, u, t + state->time_offset);
    rotation b = rotate(scene->signals, u, t + h + state->time_offset);
    double arm = u->mass * u->radius / h;
    push(state, u, arm * (b.rate * b.sine - a.rate * a.sine),
         -arm * (b.rate * b.cosine - a.rate * a.cosine), v);
  }
}

/* Adds to state->latest.force the impulses of one mass. True if there are any. */
static bool add_impulses(const strut_model *model, strut_state *state, const strut_unbalance *u,
                         double from, double to) {
  const strut_signal *signals = model->scene->signals;
  bool any = false;
  double at = u->signal >= 0 ? strut_signal_next_break(signals, u->signal, from) : HUGE_VAL;
  for (; at <= to; at = strut_signal_next_break(signals, u->signal, at)) {
    double moment = 8.0 * DBL_EPSILON * fmax(fabs(at), to - from);
    rotation before = rotate(signals, u, at - moment), after = rotate(signals, u, at + moment);
    double jump = u->mass * u->radius * (after.rate - before.rate);
    state->latest.force[2 * u->node] += jump * after.sine;
    state->latest.force[2 * u->node + 1] -= jump * after.cosine;
    any = any || jump != 0.0;
  }
  return any;
}

bool strut_unbalance_kick(const strut_model *model, strut_state *state, double from, double to) {
  const strut_scene *scene = model->scene;
  bool any = false;
  if (!model->unbalance_corners) return false;
  memset(state->latest.force, 0, (size_t)model->length * sizeof *state->latest.force);
  for (size_t i = 0; i < scene->unbalance_count; i++)
    any = add_impulses(model, state, &scene->unbalances[i], from + state->time_offset,
                       to + state->time_offset) ||
          any;
  if (!any) return false;
  strut_impulse_apply(model, state, STRUT_POWER_DRIVE);
  return true;
}
