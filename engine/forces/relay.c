/* SPDX-License-Identifier: GPL-3.0-or-later */
/* See relay.h. */
#include "engine/forces/relay.h"

#include "engine/forces/drive.h"
#include "engine/scene/signal_program.h"

static double input_of(const strut_model *model, const strut_state *state, int32_t signal,
                       double now, const double *v) {
  strut_signal_inputs in = strut_drive_inputs(model, state, v);
  double input, unused;
  in.values_only = true;
  strut_program_evaluate(&model->scene->signals[signal].program, model->scene->signals, &in, now,
                         &input, &unused);
  return input;
}

void strut_relay_start(const strut_model *model, strut_state *state, int32_t signal, double now,
                       const double *v) {
  const strut_relay *r = &model->scene->signals[signal].relay;
  double input = input_of(model, state, signal, now, v);
  bool above = input > r->upper || (!(input < r->lower) && r->on_at_start == r->on_above);
  state->relay_side[signal] = above ? 1 : -1;
}

double strut_relay_margin(const strut_model *model, const strut_state *state, int32_t signal,
                          double now, const double *v) {
  const strut_relay *r = &model->scene->signals[signal].relay;
  double input = input_of(model, state, signal, now, v);
  return state->relay_side[signal] > 0 ? input - r->lower : r->upper - input;
}

bool strut_relay_sample(const strut_model *model, strut_state *state, int32_t signal, double now,
                        const double *v) {
  if (!(strut_relay_margin(model, state, signal, now, v) < 0.0)) return false;
  state->relay_side[signal] = (int8_t)-state->relay_side[signal];
  return true;
}

void strut_relay_switch(const strut_model *model, strut_state *state, int32_t signal, double t) {
  state->relay_side[signal] = (int8_t)-state->relay_side[signal];
  strut_drive_apply(model, state, t);
  if (!(strut_relay_margin(model, state, signal, t + state->time_offset, state->v) < 0.0)) return;
  state->trouble = STRUT_FAILURE_RELAY;
  state->trouble_node = signal;
}

bool strut_relays_follow(const strut_model *model, strut_state *state, double t) {
  const strut_feedback_table *f = &model->feedback;
  bool any = false;
  strut_drive_apply(model, state, t);
  for (int32_t i = 0; i < f->relay_count && !state->trouble; i++) {
    double margin = strut_relay_margin(model, state, f->relay[i], t + state->time_offset, state->v);
    if (!(margin < 0.0)) continue;
    strut_relay_switch(model, state, f->relay[i], t);
    any = true;
  }
  return any;
}
