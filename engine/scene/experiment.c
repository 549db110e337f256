/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scene/experiment.h"

#include <string.h>

strut_experiment strut_experiment_default(void) {
  return (strut_experiment){
      .integrator = "rk4",
      .tolerance = 1e-6,
      .budget = STRUT_USUAL_BUDGET,
      .refine_rate = 0.25,
      .refine_memory = 8.0,
      .steady = {.tolerance = 0.005, .successive = 5},
      .settle = {.speed = 1e-8, .acceleration = 1e-8, .limit = 100.0},
      .search = {.seed = 1},
      .period_signal = -1,
      .measure_node = -1,
      .channels = STRUT_CHANNEL_POSITION | STRUT_CHANNEL_LENGTH | STRUT_CHANNEL_FORCE};
}

void strut_setup_init(strut_setup *setup) {
  strut_scene_init(&setup->scene);
  setup->experiment = strut_experiment_default();
}

void strut_setup_free(strut_setup *setup) {
  strut_scene_free(&setup->scene);
  memset(&setup->experiment, 0, sizeof setup->experiment);
}

strut_span strut_experiment_span(const strut_experiment *e, const strut_scene *scene) {
  strut_span span = {.duration = e->duration};
  double unit = 1.0; /* of the windows: one period, or one second */
  if (e->periods > 0.0) {
    unit = span.period = strut_signal_period(scene->signals, e->period_signal);
    span.duration = e->periods * span.period;
  }
  if (e->measure_last > 0.0) span.window_start = span.duration - e->measure_last * unit;
  if (e->output_last > 0.0) span.record_start = span.duration - e->output_last * unit;
  if (span.window_start < 0.0) span.window_start = 0.0;
  if (span.record_start < 0.0) span.record_start = 0.0;
  span.record_every =
      e->output_every > 0.0 ? e->output_every : (span.duration - span.record_start) / 1000.0;
  return span;
}
