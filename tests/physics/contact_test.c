/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ground's reaction (8): restitution, contact time, rest. The damper works on approach only. */
#include "tests/support/motion.h"

static const double K = 1e4, MASS = 0.5, SPEED = 1.5;

typedef struct bounce {
  double restitution, deepest, time; /* [1], [m], [s] of contact */
} bounce;

/* A node without weight hits the ground a fraction of a step after one of its steps. */
static bounce hit(double zeta, double step, double fraction) {
  OWN(strut_scene) scene = build_scene();
  bounce seen = {0, 0, 0};
  int32_t node = build_mass(&scene, 0, SPEED * step * (2 + fraction), MASS);
  scene.nodes[node].velocity[1] = -SPEED;
  build_contact(&scene, node, K, 2 * zeta * sqrt(K * MASS));
  OWN(motion) m = motion_begin(&scene, step);
  do {
    motion_steps(&m, 1);
    seen.deepest = fmax(seen.deepest, -m.state->q[1]);
    seen.time += m.state->q[1] < 0 ? step : 0;
  } while (m.state->q[1] < 0 || m.state->v[1] < 0);
  motion_steps(&m, 1); /* away, freely */
  seen.restitution = m.state->v[1] / SPEED;
  return seen;
}

/* Mean error of the restitution over 32 moments of impact: a single one may be right by luck. */
static double mean_error(double zeta, double expected, double step) {
  double sum = 0;
  for (int i = 0; i < 32; i++)
    sum += fabs(hit(zeta, step, (i + 0.5) / 32).restitution - expected) / 32;
  return sum;
}

TEST(restitution_converges_to_its_closed_form) {
  static const double zetas[] = {0.05, 0.2, 0.8};
  for (int z = 0; z < 3; z++) {
    double zeta = zetas[z], omega = sqrt(K / MASS), error[5];
    double expected = exp(-zeta * acos(zeta) / sqrt(1 - zeta * zeta));
    for (int k = 0; k < 5; k++) {
      double step = ldexp(0.02 / omega, -k);
      error[k] = mean_error(zeta, expected, step);
      assert_true(error[k] < 2 * zeta * omega * step); /* the damper's jump, for one step */
    }
    assert_within(observed_order(error, 5), 0.9, 1.1);
  }
}

TEST(without_damping_nothing_is_lost) {
  double omega = sqrt(K / MASS), step = 1e-3 / omega;
  bounce seen = hit(0, step, 0.3);
  assert_near(seen.restitution, 1, 1e-5);
  assert_near(seen.deepest, SPEED / omega, 1e-6 * SPEED / omega);
  assert_near(seen.time, acos(-1) / omega, 2 * step);
}

/* Left alone a node comes to rest where the spring carries its weight, on flat and sloping ground. */
static void rest(double slope) {
  OWN(strut_scene) scene = build_scene();
  scene.ground.slope = slope, scene.ground.height = 0.1;
  int32_t node = build_mass(&scene, 0.2, 0.1 + 0.2 * tan(slope) + 0.001, MASS);
  build_contact(&scene, node, K, 2 * 0.5 * sqrt(K * MASS));
  scene.gravity[0] = 9.81 * sin(slope), scene.gravity[1] = -9.81 * cos(slope);
  OWN(motion) m = motion_begin(&scene, 1e-4);
  motion_steps(&m, 20000);
  double depth = -(m.state->q[1] - 0.1) * cos(slope) + m.state->q[0] * sin(slope);
  strut_forces_evaluate(m.model, m.state, 2, m.state->q, m.state->v);
  assert_all_relative(1e-12, depth, MASS * 9.81 / K, m.state->latest->normal[0], MASS * 9.81);
  assert_true(m.state->latest->friction[0] == 0);
}

TEST(rest_is_where_the_ground_carries_the_weight) {
  rest(0);
  rest(0.3); /* gravity turned with the ground, so that nothing slides */
  rest(-0.7);
}

/* A rod that falls on a smooth ground turns, but its middle does not move sideways. */
TEST(a_falling_rod_does_not_move_sideways) {
  OWN(strut_scene) scene = build_scene();
  scene.gravity[1] = -9.81;
  build_node(&scene, 0, 0.05);
  build_node(&scene, 0.3, 0.35);
  build_member(&scene, STRUT_BAR, 0, 1, 1e4, 1, 0.5);
  build_contact(&scene, 0, K, 10);
  build_contact(&scene, 1, K, 10);
  OWN(motion) m = motion_begin(&scene, 1e-4);
  bool fell = false;
  for (int i = 0; i < 1000; i++) {
    motion_steps(&m, 10);
    fell |= m.state->q[3] < 0;
    assert_near(m.state->q[0] + m.state->q[2], 0.3, 1e-13);
  }
  assert_true(fell && fabs(m.state->q[2] - m.state->q[0]) > 0.35); /* it has fallen over */
}
