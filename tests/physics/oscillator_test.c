/* SPDX-License-Identifier: GPL-3.0-or-later */
/* RK4 is RK4: what it does to an oscillator, and its order on smooth scenes. */
#include <math.h>
#include <stdlib.h>

#include "engine/forces/energy.h"
#include "tests/physics/smooth_scenes.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/oscillation.h"

static void keep_energy(double z, int64_t steps, double stretch) {
  const double k = 300, mass = 0.7, omega = sqrt(k / mass);
  strut_scene scene;
  motion m;
  strut_scene_init(&scene);
  build_support(&scene, 0, 0);
  build_mass(&scene, 1, 0, mass);
  build_member(&scene, STRUT_SPRING, 0, 1, k, 0, 0);
  scene.nodes[1].start[0] = 1 + stretch, scene.nodes[1].velocity[0] = 6 * stretch;
  motion_begin(&m, &scene, z / omega);
  strut_energies before = strut_energy_evaluate(m.model, m.state, 0);
  motion_steps(&m, steps);
  strut_energies after = strut_energy_evaluate(m.model, m.state, 0);
  double ratio = (after.kinetic + after.elastic) / (before.kinetic + before.elastic);
  double per_step = -pow(z, 6) / 72 + pow(z, 8) / 576;
  assert_relative(ratio, exp((double)steps * log1p(per_step)), 1e-9);
  motion_end(&m);
  strut_scene_free(&scene);
}

TEST(energy_after_a_million_steps) {
  keep_energy(0.01, 1000000, 0.25);
  keep_energy(0.1, 1000000, 0.25);
  keep_energy(0.2, 1000000, 0.25);
  keep_energy(2.8, 100, 0.25);
}

/* On both sides of the stability limit 2 sqrt(2). */
TEST(growth_about_the_stability_limit) {
  keep_energy(0.99 * sqrt(8), 60, 1e-4);
  keep_energy(1.01 * sqrt(8), 60, 1e-4);
}

/* Largest difference to a motion whose step is so much smaller that it counts as exact. */
static double error_of(const smooth_scene *smooth, double step, const double *exact,
                       double *reached) {
  strut_scene scene;
  motion m;
  double error = 0;
  smooth->make(&scene);
  motion_begin(&m, &scene, step);
  motion_steps(&m, llround(smooth->duration / step));
  for (size_t i = 0; i < 2 * scene.node_count; i++) {
    if (reached) reached[i] = m.state->q[i];
    if (exact) error = fmax(error, fabs(m.state->q[i] - exact[i]));
  }
  motion_end(&m);
  strut_scene_free(&scene);
  return error;
}

TEST(smooth_scenes_converge_at_order_four) {
  for (int s = 0; s < SMOOTH_SCENES; s++) {
    const smooth_scene *smooth = &smooth_scenes[s];
    double error[5], exact[100];
    error_of(smooth, ldexp(smooth->step, -8), NULL, exact);
    for (int k = 0; k < 5; k++) error[k] = error_of(smooth, ldexp(smooth->step, -k), exact, NULL);
    double order = observed_order(error, 5);
    print_message("%s: order %.3f, errors %.2g to %.2g m\n", smooth->name, order, error[0],
                  error[4]);
    assert_within(order, 3.9, 4.1);
  }
}
