/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every fixed-step method of the table shows the order that its row claims, on smooth scenes. */
#include "engine/base/vec.h"
#include "engine/integrate/events/tableaus.h"
#include "tests/physics/smooth_scenes.h"
#include "tests/support/motion.h"

enum { HALVINGS = 4, MOST = 200, REFERENCE = 8 };

/* Ends a scene by a method with 2^-halvings of its step: places, then speeds times the duration. */
static size_t reach(const smooth_scene *smooth, const char *method, int halvings, double *q) {
  OWN(strut_setup) setup = build_setup();
  double step = ldexp(smooth->step, -halvings);
  smooth->make(&setup.scene);
  size_t count = 2 * setup.scene.node_count;
  assert_true(2 * count <= MOST);
  OWN(motion) m = motion_begin_by(&setup, method, step);
  if (m.method->restart) m.method->restart(m.model, m.state, m.workspace, step);
  motion_steps(&m, llround(smooth->duration / step));
  assert_int_equal(m.state->trouble, 0);
  for (size_t i = 0; i < count; i++) {
    q[i] = m.state->q[i];
    q[count + i] = smooth->duration * m.state->v[i];
  }
  return 2 * count;
}

/*
 * Methods of low order show it at smaller steps only. Semi-implicit Euler's places may converge at
 * order two by luck (an oscillator thrown from rest length), so its speeds count, too; RK4's speeds
 * would leave too little between steps that are too coarse and rounding.
 */
static double order_of(const smooth_scene *smooth, const strut_integrator *method,
                       const double *exact) {
  int first = method->order >= 4 ? 0 : method->order == 2 ? 2 : 4;
  double error[HALVINGS + 1] = {0}, q[MOST];
  for (int k = 0; k <= HALVINGS; k++) {
    size_t count = reach(smooth, method->name, first + k, q);
    if (method->order > 1) count /= 2;
    for (size_t i = 0; i < count; i++) error[k] = fmax(error[k], fabs(q[i] - exact[i]));
  }
  double order = observed_order(error, HALVINGS + 1);
  print_message("%s, %s: order %.3f, errors %.2g to %.2g m\n", method->name, smooth->name, order,
                error[0], error[HALVINGS]);
  return order;
}

TEST(every_method_has_its_order) {
  int failures = 0;
  for (int s = 0; s < SMOOTH_SCENES; s++) {
    double exact[MOST];
    reach(&smooth_scenes[s], "rk4", REFERENCE, exact);
    const strut_integrator *method;
    for (size_t i = 0; (method = strut_integrator_at(i)); i++) {
      if (strut_experiment_is_adaptive(method->name)) continue; /* see pairs_have_their_orders */
      double width = method->order == 2 ? 0.05 : 0.1;
      double order = order_of(&smooth_scenes[s], method, exact);
      failures += !(fabs(order - method->order) <= width);
    }
  }
  assert_int_equal(failures, 0);
}

/* A ball on a driven cable that catches it and lets it go again: where it is after half a second. */
static double caught_ball(const char *method, double step, double tolerance) {
  OWN(strut_setup) setup = build_tethered(0.8, 0, 0.5);
  int32_t cable = build_sized(&setup.scene, STRUT_CABLE, 0, 1, 400, 2, 0, 1);
  build_actuator(&setup.scene, cable, build_sine(&setup.scene, 0.05, 2));
  setup.scene.nodes[1].velocity[0] = 1;
  motion_experiment(&setup, step, 1);
  if (tolerance > 0) setup.experiment.tolerance = tolerance;
  OWN(motion) m = motion_begin_by(&setup, method, step);
  motion_steps(&m, llround(0.5 / step));
  assert_true(m.state->events == 2);
  return m.state->q[2];
}

/* Methods with events keep their order across them, drives that go on meanwhile included. */
TEST(events_keep_the_order) {
  static const char *const methods[] = {"rk4-events", "verlet-events", "euler-events"};
  double exact = caught_ball("rk4-events", 1.0 / 16384, 0);
  for (int i = 0; i < 3; i++) {
    double error[5], step = i == 0 ? 1.0 / 128 : 1.0 / 512;
    for (int k = 0; k < 5; k++)
      error[k] = fabs(caught_ball(methods[i], ldexp(step, -k), 0) - exact);
    double order = observed_order(error, 5);
    print_message("%s: order %.2f across events, errors %.2g to %.2g m\n", methods[i], order,
                  error[0], error[4]);
    assert_true(order > (i == 0 ? 3.7 : i == 1 ? 1.7 : 0.8));
  }
  assert_near(caught_ball("adaptive", 1.0 / 128, 1e-9), exact, 1e-8);
  assert_near(caught_ball("adaptive8", 1.0 / 16, 1e-9), exact, 1e-8);
}

/* Where a planet is a third of a period after its start, (4), by equal steps; returns the largest estimate of an error. */
static double follow_planet(const strut_tableau *t, int steps, double *y) {
  const double eccentricity = 0.3, h = STRUT_TAU / 3 / steps;
  const double start[4] = {1 - eccentricity, 0, 0, sqrt((1 + eccentricity) / (1 - eccentricity))};
  double k[STRUT_MOST_STAGES + 1][4], z[4] = {0}, estimate = 0;
  memcpy(y, start, sizeof start);
  for (int n = 0; n < steps; n++) {
    for (int s = 0; s <= t->stages; s++) {
      for (int i = 0; i < 4; i++) {
        double sum = 0;
        for (int j = 0; j < s; j++) sum += t->weight[s][j] * k[j][i];
        z[i] = y[i] + h * sum;
      }
      double cube = pow(z[0] * z[0] + z[1] * z[1], 1.5);
      k[s][0] = z[2], k[s][1] = z[3], k[s][2] = -z[0] / cube, k[s][3] = -z[1] / cube;
    }
    memcpy(y, z, sizeof z);
    double off[2] = {0};
    for (int j = 0; j <= t->stages; j++)
      for (int i = 0; i < 2; i++) off[i] += h * t->difference[j] * k[j][i];
    estimate = fmax(estimate, hypot(off[0], off[1]));
  }
  return estimate;
}

/* Stage times are sums of the weights; the error has the order of the method, and its estimate, of one step, too. */
TEST(pairs_have_their_orders) {
  static const strut_tableau *const pairs[] = {&strut_dormand_prince, &strut_verner};
  double exact[4], y[4];
  follow_planet(&strut_verner, 512, exact);
  for (int p = 0; p < 2; p++) {
    const strut_tableau *t = pairs[p];
    for (int s = 0; s <= t->stages; s++) {
      double sum = 0;
      for (int j = 0; j < s; j++) sum += t->weight[s][j];
      assert_near(sum, t->ahead[s], 1e-13);
    }
    double error[3], estimate[3];
    for (int n = 0; n < 3; n++) {
      estimate[n] = follow_planet(t, (p ? 6 : 60) << n, y);
      error[n] = hypot(y[0] - exact[0], y[1] - exact[1]) + hypot(y[2] - exact[2], y[3] - exact[3]);
    }
    double order = observed_order(error, 3), of_estimate = observed_order(estimate, 3);
    print_message("order %d: %.2f, errors %.2g to %.2g; of the estimate %.2f\n", t->order, order,
                  error[0], error[2], of_estimate);
    assert_true(order > t->order - 0.3 && of_estimate > t->order - 0.3);
  }
}

/* Fast, but small beside the structure: it is the error of the velocity that error control must see. */
TEST(error_control_sees_velocities) {
  const double size = 1e-6, omega = 1000, time = 0.1;
  OWN(strut_setup) setup = build_tethered(1, 0, 1);
  build_member(&setup.scene, STRUT_SPRING, 0, 1, omega * omega, 0, 0);
  setup.scene.nodes[1].velocity[0] = size * omega;
  motion_experiment(&setup, 0.01, time);
  setup.experiment.tolerance = 1e-6;
  OWN(motion) m = motion_begin_by(&setup, "adaptive", 0.01);
  motion_steps(&m, 10);
  assert_near(m.state->v[2], size * omega * cos(omega * time), 1e-3 * size * omega);
}
