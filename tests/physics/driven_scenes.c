/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/driven_scenes.h"

#include "tests/support/build.h"

void driven_watch(strut_setup *setup, double step, double periods, double tolerance) {
  strut_experiment *e = &setup->experiment;
  e->step = step;
  e->periods = periods;
  e->period_signal = 0;
  e->measure_last = 1;
  e->steady.wanted = true;
  e->steady.tolerance = tolerance;
}

void driven_oscillator(strut_setup *setup, double w, double zeta) {
  strut_setup_init(setup);
  build_support(&setup->scene, 0, 0);
  build_mass(&setup->scene, 1, 0, 1);
  build_member(&setup->scene, STRUT_SPRING, 0, 1, w * w, 2 * zeta * w, 0);
  build_load(&setup->scene, 1, 1, 0, build_sine(&setup->scene, 1, 1));
  setup->scene.nodes[1].fixed[1] = true;
}

void driven_snap(strut_setup *setup, double damping, double push, double frequency) {
  strut_setup_init(setup);
  build_support(&setup->scene, -1, 0);
  build_support(&setup->scene, 1, 0);
  build_mass(&setup->scene, 0, 0.3, 1);
  for (int32_t k = 0; k < 2; k++) build_member(&setup->scene, STRUT_SPRING, k, 2, 500, damping, 0);
  setup->scene.nodes[2].fixed[0] = true;
  build_load(&setup->scene, 2, 0, 1, build_sine(&setup->scene, push, frequency));
  setup->experiment.measure_node = 2;
}
