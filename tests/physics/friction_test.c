/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Coulomb friction with Karnopp's band, as the paper prints it (9).
 *
 * What the printed law does inside its band: friction is the opposite of the other forces, so the
 * node is not stopped, it keeps the speed with which it came into the band. "At rest" below means
 * slower than the band for good.
 */
#include "tests/support/motion.h"

static const double G = 9.81, K = 1e5, MASS = 1;

/* One block that the ground already carries; the slope is in the ground, the weight stays upright. */
static strut_scene block(double slope, double mu_static, double mu_kinetic, double band) {
  double depth = MASS * G * cos(slope) / K;
  strut_scene scene = build_scene();
  scene.gravity[1] = -G;
  build_mass(&scene, depth * sin(slope), -depth * cos(slope), MASS);
  build_rough_contact(&scene, 0, K, 100, mu_static, mu_kinetic, band);
  scene.ground.slope = slope;
  return scene;
}

/* The band follows the step, as it must: four times the change of speed in one step. */
TEST(a_block_slides_to_rest) {
  const double mu = 0.2, speed = 0.3, way = speed * speed / (2 * mu * G), time = speed / (mu * G);
  double last_bound = 1;
  for (int k = 0; k < 5; k++) {
    double step = ldexp(1e-4, -k), band = 4 * mu * G * step;
    OWN(strut_scene) scene = block(0, mu, mu, band);
    scene.nodes[0].velocity[0] = k % 2 ? -speed : speed;
    OWN(motion) m = motion_begin(&scene, step);
    motion_steps(&m, (int64_t)ceil(2 * time / step));
    double creep = m.state->v[0];
    assert_true(fabs(creep) < band);
    assert_near(fabs(m.state->q[0]), way, band * 2 * time);
    assert_near(m.state->q[1], -MASS * G / K, 1e-15);
    motion_steps(&m, 100);
    assert_all(m.state->v[0] == creep, band * 2 * time < 0.6 * last_bound);
    last_bound = band * 2 * time;
  }
}

/* Before it comes near the band the block is uniformly decelerated, which RK4 follows exactly. */
TEST(sliding_is_uniformly_decelerated) {
  OWN(strut_scene) scene = block(0, 0.9, 0.25, 1e-4);
  scene.nodes[0].velocity[0] = 2;
  OWN(motion) m = motion_begin(&scene, 1e-4);
  motion_steps(&m, 5000);
  double t = 0.5;
  assert_near(m.state->q[0], 2 * t - 0.5 * 0.25 * G * t * t, 1e-12);
  assert_near(m.state->v[0], 2 - 0.25 * G * t, 1e-12);
}

/* Way along the slope after 1 s from rest. */
static double way_down(double slope, double mu_static, double mu_kinetic) {
  OWN(strut_scene) scene = block(slope, mu_static, mu_kinetic, 1e-4);
  OWN(motion) m = motion_begin(&scene, 1e-4);
  double x = m.state->q[0], y = m.state->q[1];
  motion_steps(&m, 10000);
  return -((m.state->q[0] - x) * cos(slope) + (m.state->q[1] - y) * sin(slope));
}

TEST(a_slope_below_the_friction_angle_holds) {
  assert_near(way_down(atan(0.4 * 0.999), 0.4, 0.4), 0, 1e-12);
  assert_near(way_down(-atan(0.4 * 0.999), 0.4, 0.1), 0, 1e-12);
  assert_near(way_down(atan(0.4 * 0.9999999), 0.4, 0.3), 0, 1e-12);
}

TEST(a_slope_above_the_friction_angle_lets_go) {
  static const double mu_kinetic[] = {0.4, 0.1};
  for (int i = 0; i < 4; i++) {
    double slope = atan(0.4 * 1.001) * (i % 2 ? -1 : 1), mu = mu_kinetic[i / 2];
    double expected = 0.5 * G * (sin(fabs(slope)) - mu * cos(slope));
    double way = way_down(slope, 0.4, mu) * (i % 2 ? -1 : 1);
    assert_relative(way, expected, 1e-9);
  }
}

/* Between the two coefficients a block at rest stays and a moving one slides on. */
TEST(a_moving_block_meets_kinetic_friction_only) {
  double slope = atan(0.3), a = G * (sin(slope) - 0.2 * cos(slope));
  assert_near(way_down(slope, 0.4, 0.2), 0, 1e-12);
  OWN(strut_scene) scene = block(slope, 0.4, 0.2, 1e-4);
  scene.nodes[0].velocity[0] = -0.1 * cos(slope), scene.nodes[0].velocity[1] = -0.1 * sin(slope);
  OWN(motion) m = motion_begin(&scene, 1e-4);
  double x = m.state->q[0];
  motion_steps(&m, 10000);
  assert_relative((x - m.state->q[0]) / cos(slope), 0.1 + 0.5 * a, 1e-9);
}

/*
 * The mass on a belt: k = 100 N/m, m = 1 kg, V = 0.1 m/s, static 2 N, kinetic 1 N. It sticks for
 * 2 D/V and slips for (pi + 2 atan(V / (w D)))/w, D = (Fs - Fk)/k.
 */
typedef struct belt_cycle {
  double period, low, high;
} belt_cycle;

static belt_cycle ride(double step, double band, double mu_static, double speed) {
  OWN(strut_scene) scene = block(0, mu_static / G, 1 / G, band);
  build_support(&scene, -1, scene.nodes[0].start[1]);
  build_sized(&scene, STRUT_SPRING, 1, 0, 100, 0, 0, 1);
  scene.ground.belt_speed = speed;
  scene.nodes[0].velocity[0] = speed;
  OWN(motion) m = motion_begin(&scene, step);
  belt_cycle cycle = {0, 1, -1};
  double before = 0, crossed[4] = {0}, level = 0.01 * (speed < 0 ? -1 : 1);
  for (int passes = 0; passes < 4 && (double)m.state->step * step < 10;) {
    before = m.state->q[0];
    motion_steps(&m, 1);
    double x = m.state->q[0], side = speed < 0 ? -1 : 1;
    if (passes) cycle.low = fmin(cycle.low, side * x), cycle.high = fmax(cycle.high, side * x);
    if (side * before < side * level && side * x >= side * level)
      crossed[passes++] = ((double)m.state->step - (x - level) / (x - before)) * step;
  }
  cycle.period = (crossed[3] - crossed[1]) / 2;
  return cycle;
}

TEST(a_mass_on_a_belt_sticks_and_slips) {
  const double v = 0.1, omega = 10, d = 0.01;
  double expected = 2 * d / v + (acos(-1) + 2 * atan(v / (omega * d))) / omega, error[5];
  assert_near(expected, 0.671238898, 1e-9);
  for (int k = 0; k < 5; k++) {
    double step = ldexp(2e-4, -k), band = 1.5 * step; /* 1 m/s^2 at most while it sticks */
    belt_cycle cycle = ride(step, band, 2, k % 2 ? -v : v);
    error[k] = fabs(cycle.period - expected) / expected;
    assert_true(error[k] < 50 * step);
    assert_all_near(5 * step, cycle.high, 0.01 + sqrt(2e-4), cycle.low, 0.01 - sqrt(2e-4));
  }
  assert_within(observed_order(error, 5), 0.7, 1.3);
}

/* A band narrower than one step's change of speed cannot catch the mass: known, and to be seen. */
TEST(a_band_that_is_too_narrow_loses_sticking) {
  belt_cycle cycle = ride(1e-3, 1e-8, 2, 0.1);
  assert_true(fabs(cycle.period - 0.671238898) > 0.02);
}

/* With one coefficient there is no stick-slip: the mass ends in a pure oscillation. */
TEST(one_coefficient_gives_no_stick_slip) {
  belt_cycle cycle = ride(1e-4, 1.5e-4, 1, 0.1);
  assert_relative(cycle.period, 2 * acos(-1) / 10, 2e-3);
}
