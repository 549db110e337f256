/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction at its extremes: none, a million, and slopes beside the angle of friction. */
#include "tests/support/structures.h"

static const double G = 9.81;
static const x_frame FRAME = {0.2, 60, .cable = {800, 0.3, 0.01}, .bar = {2e4, 2, 0.1}};
static double times = 1; /* how much longer the runs are in the long version */

/* The frame above ground on which all its nodes may land. */
static strut_setup frame_on_ground(double above, double mu, strut_friction_law law) {
  strut_setup setup = build_falling();
  structure_x_frame(&setup.scene, &FRAME);
  setup.scene.ground.height = -0.5 * FRAME.side - above;
  for (int32_t i = 0; i < 4; i++) {
    if (law == STRUT_FRICTION_NONE)
      build_contact(&setup.scene, i, 1e4, 20);
    else
      build_rough_contact(&setup.scene, i, 1e4, 20, mu, mu, 1e-4);
    setup.scene.contacts[i].friction.law = law;
  }
  return setup;
}

static double momentum(const motion *m) {
  double sum = 0;
  for (int32_t i = 0; i < m->model->node_count; i++)
    sum += m->model->weight[i] * m->state->v[2 * i];
  return sum;
}

BEFORE_ALL { times = test_number(1, times); }

TEST(without_friction_horizontal_momentum_stays) {
  static const char *const methods[] = {"rk4", "rk4-events", "verlet-events"};
  for (int k = 0; k < 3; k++) {
    OWN(strut_setup) setup = frame_on_ground(0.1, 0, STRUT_FRICTION_NONE);
    for (int c = 0; c < 4; c++) setup.scene.members[c].damping = 0;
    structure_throw(&setup.scene, 0.7, 0, 3);
    OWN(motion) m = motion_begin_by(&setup, methods[k], 1e-4);
    double before = momentum(&m), worst = 0, low = HUGE_VAL;
    for (int part = 0; part < 100; part++) {
      motion_steps(&m, (int64_t)(times * 1000));
      worst = fmax(worst, fabs(momentum(&m) / before - 1));
      for (int i = 0; i < 4; i++) low = fmin(low, m.state->q[2 * i + 1]);
    }
    assert_true(low < setup.scene.ground.height); /* it did land */
    print_message("%s: momentum changed by %.1e of itself in %lld steps\n", methods[k], worst,
                  (long long)m.state->step);
    assert_true(worst <= 1e-13);
  }
}

/* Way along x of the standing nodes from 1 s, when all has calmed down, to the end. */
static double creep(const char *method, strut_friction_law law, double mu, double seconds) {
  /* the ground carries it already */
  OWN(strut_setup) setup = frame_on_ground(-0.5 * 0.24 * G / 1e4, mu, law);
  OWN(motion) m = motion_begin_by(&setup, method, 5e-5);
  motion_steps(&m, 20000);
  double x[2] = {m.state->q[0], m.state->q[2]}, way = 0;
  motion_steps(&m, (int64_t)((seconds - 1) / 5e-5));
  for (int i = 0; i < 2; i++) way = fmax(way, fabs(m.state->q[2 * i] - x[i]));
  assert_true(m.state->q[1] < setup.scene.ground.height &&
              m.state->q[3] < setup.scene.ground.height);
  return way;
}

TEST(friction_of_a_million_holds_a_frame) {
  double seconds = 10 * times;
  static const char *const methods[] = {"rk4-events", "verlet-events", "euler-events"};
  for (int k = 0; k < 3; k++) {
    double way = creep(methods[k], STRUT_FRICTION_COULOMB, 1e6, seconds);
    print_message("%s, coulomb: creep %.1e m in %g s\n", methods[k], way, seconds);
    assert_true(way == 0);
  }
}

/*
 * Karnopp's band does not hold: it keeps the speed with which a node came into it. Methods without
 * events are not here: mu N changes the slip by millions of bands in a step, and they blow up.
 */
TEST(karnopps_band_creeps_at_most_at_its_edge) {
  double seconds = 10 * times;
  static const char *const methods[] = {"rk4-events", "verlet-events"};
  for (int k = 0; k < 2; k++) {
    double way = creep(methods[k], STRUT_FRICTION_KARNOPP, 1e6, seconds);
    print_message("%s, karnopp: creep %.1e m in %g s\n", methods[k], way, seconds);
    assert_true(way <= 1e-4 * seconds); /* stick_velocity */
  }
}

/* One block that the slope already carries; the weight stays upright. */
static strut_setup block(double slope, double mu) {
  const double stiffness = 1e5, depth = G * cos(slope) / stiffness;
  strut_setup setup = build_falling();
  build_mass(&setup.scene, depth * sin(slope), -depth * cos(slope), 1);
  build_rough_contact(&setup.scene, 0, stiffness, 100, mu, mu, 1e-4);
  setup.scene.contacts[0].friction.law = STRUT_FRICTION_COULOMB;
  setup.scene.ground.slope = slope;
  return setup;
}

static double way_down(const char *method, double slope, double mu, double seconds) {
  OWN(strut_setup) setup = block(slope, mu);
  OWN(motion) m = motion_begin_by(&setup, method, 1e-3);
  double x = m.state->q[0], y = m.state->q[1];
  motion_steps(&m, (int64_t)llround(seconds / 1e-3));
  return (x - m.state->q[0]) * cos(slope) + (y - m.state->q[1]) * sin(slope);
}

/* tan(slope) = mu (1 -+ 1e-6): one holds, the other slides as the closed form says. */
TEST(slopes_beside_the_angle_of_friction) {
  static const char *const methods[] = {"rk4-events", "verlet-events", "euler-events", "adaptive"};
  static const double mus[] = {0.01, 0.4, 3};
  for (int k = 0; k < 12; k++) {
    double mu = mus[k / 4], below = atan(mu * (1 - 1e-6)), above = atan(mu * (1 + 1e-6));
    double seconds = 10, hold = k % 4 < 3 ? 60 : 6 * times; /* adaptive takes its time */
    double expected = 0.5 * G * cos(above) * mu * 1e-6 * seconds * seconds;
    assert_near(way_down(methods[k % 4], below, mu, hold), 0, 1e-18); /* its depth is 1e-4 m */
    assert_near(way_down(methods[k % 4], -below, mu, hold), 0, 1e-18);
    double way = way_down(methods[k % 4], above, mu, seconds);
    print_message("%s, mu %g: slid %.6e m, closed form %.6e m\n", methods[k % 4], mu, way,
                  expected);
    assert_relative(way, expected, 2e-4); /* Euler's is first order: 1e-4 */
  }
}
