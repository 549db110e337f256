/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members at the edges of their law: of no length, slack, driven slack. */
#include "tests/support/motion.h"
#include "tests/support/oscillation.h"

static const double STEP = 1e-3;

/* A mass on a spring of no rest length: an isotropic oscillator, each coordinate by itself. */
static void orbit(double x, double y, double vx, double vy) {
  const double k = 50, mass = 2, omega = sqrt(k / mass);
  const int64_t count = 10000;
  OWN(strut_setup) setup = build_setup();
  double re, im, size = hypot(x, y) + hypot(vx, vy) / omega;
  int32_t pivot = build_support(&setup.scene, 0.3, -0.2);
  int32_t body = build_mass(&setup.scene, 0.3 + x, -0.2 + y, mass);
  build_sized(&setup.scene, STRUT_SPRING, pivot, body, k, 0, 0, 0);
  setup.scene.nodes[body].velocity[0] = vx, setup.scene.nodes[body].velocity[1] = vy;
  OWN(motion) m = motion_begin(&setup.scene, STEP);
  motion_steps(&m, count);
  rk4_oscillation(omega * STEP, count, &re, &im);
  assert_near(m.state->q[2], 0.3 + re * x + im * vx / omega, 1e-12 * size);
  assert_near(m.state->q[3], -0.2 + re * y + im * vy / omega, 1e-12 * size);
  assert_near(m.state->v[2], re * vx - im * omega * x, 1e-12 * size * omega);
  assert_near(m.state->v[3], re * vy - im * omega * y, 1e-12 * size * omega);
}

TEST(a_spring_of_no_rest_length_makes_an_ellipse) {
  orbit(0.4, 0, 0, 1.5);
  orbit(0.3, 0.4, 2, -1);
}

TEST(the_ellipse_may_be_as_narrow_as_one_likes) {
  orbit(0.4, 0, 0, 1e-9);
  orbit(0.3, 0.4, 1e-14, 0);
  orbit(0.3, 0.4, 0, 0);
  orbit(0, 0, 1, 0.5); /* starts where the spring has no direction */
}

/* Forces on the free end at stretch [m] and speed of lengthening [m/s]. */
static double pull(strut_member_kind kind, double stretch, double rate) {
  OWN(strut_setup) setup = build_tethered(1, 0, 1);
  double length, tension;
  build_member(&setup.scene, kind, 0, 1, 100, 5, 0);
  setup.scene.nodes[1].start[0] = 1 + stretch;
  setup.scene.nodes[1].velocity[0] = rate;
  OWN(motion) m = motion_begin(&setup.scene, STEP);
  strut_forces_evaluate(m.model, m.state, 0, m.state->q, m.state->v);
  motion_members(m.model, m.state, &length, &tension);
  double force = -m.state->latest->force[2];
  assert_near(tension, force, 1e-14 * fabs(force)); /* so slack: exactly 0 */
  assert_true(length == 1 + stretch);
  return force;
}

TEST(a_slack_cable_carries_nothing) {
  assert_true(pull(STRUT_CABLE, -0.125, 0) == 0);
  assert_true(pull(STRUT_CABLE, -0.125, 4) == 0); /* lengthens, but is slack: no damper either */
  assert_true(pull(STRUT_CABLE, -0.125, -4) == 0);
  assert_true(pull(STRUT_CABLE, 0.125, -4) == 0); /* taut, but its damper would push */
  assert_all_relative(1e-14, pull(STRUT_CABLE, 0.125, -2), 2.5, pull(STRUT_CABLE, 0.125, 2), 22.5);
  assert_true(pull(STRUT_CABLE, 0, 2) == 0);
  for (int kind = STRUT_BAR; kind <= STRUT_SPRING; kind++) {
    assert_relative(pull((strut_member_kind)kind, -0.125, 4), 7.5, 1e-14);
    assert_relative(pull((strut_member_kind)kind, -0.125, -4), -32.5, 1e-14);
    assert_relative(pull((strut_member_kind)kind, 0.125, -4), -7.5, 1e-14);
  }
}

/* A ball thrown at the cable's anchor flies on freely, passes by and is caught on the other side. */
TEST(a_ball_flies_freely_until_its_cable_is_taut) {
  const double k = 400, mass = 0.5, speed = 2, omega = sqrt(k / mass);
  OWN(strut_setup) setup = build_tethered(1, 0, mass);
  double re, im;
  build_sized(&setup.scene, STRUT_CABLE, 0, 1, k, 0, 0, 1);
  setup.scene.nodes[1].velocity[0] = -speed;
  OWN(motion) m = motion_begin(&setup.scene, STEP);
  motion_steps(&m, 999);
  assert_true(m.state->v[2] == -speed);
  assert_near(m.state->q[2], 1 - speed * 0.999, 1e-13);
  motion_steps(&m, 1);
  double stretch = -1 - m.state->q[2]; /* a rounding's worth, taut or not */
  motion_steps(&m, 100);
  rk4_oscillation(omega * STEP, 100, &re, &im);
  assert_near(stretch, 0, 1e-13);
  assert_near(m.state->q[2], -1 - im * speed / omega, 1e-10);
}

/* Every method: a cable that lengthens but is slack lets a ball fly on, whatever its damper. */
TEST(a_slack_cable_holds_nothing_back_by_any_method) {
  const strut_integrator *method;
  for (size_t i = 0; (method = strut_integrator_at(i)); i++) {
    OWN(strut_setup) setup = build_tethered(0.5, 0.1, 0.5);
    build_sized(&setup.scene, STRUT_CABLE, 0, 1, 400, 30, 0, 1);
    setup.scene.nodes[1].velocity[0] = 2;
    motion_experiment(&setup, STEP, 1);
    OWN(motion) m = motion_begin_by(&setup, method->name, STEP);
    motion_steps(&m, 200);
    assert_all_near(1e-14, m.state->v[2], 2, m.state->v[3], 0);
    assert_near(m.state->q[2], 0.9, 1e-13);
  }
}

/*
 * A damped cable that was pulled out draws its ball in until damper and spring balance, at the phase
 * acos(zeta): from there on the ball keeps its speed, A omega exp(-zeta acos(zeta) / sqrt(1 - zeta^2)).
 */
TEST(a_cable_lets_go_where_its_damper_would_push) {
  static const struct {
    const char *method;
    double tolerance;
  } known[] = {
      {"rk4-events", 1e-9}, {"adaptive", 1e-6}, {"verlet-events", 1e-4}, {"euler-events", 1e-2}};
  const double k = 400, mass = 0.5, out = 0.1, omega = sqrt(k / mass), zeta = 0.2;
  double speed = out * omega * exp(-zeta * acos(zeta) / sqrt(1 - zeta * zeta));
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    OWN(strut_setup) setup = build_tethered(1, 0, mass);
    build_sized(&setup.scene, STRUT_CABLE, 0, 1, k, 2 * zeta * sqrt(k * mass), 0, 1);
    setup.scene.nodes[1].start[0] = 1 + out;
    motion_experiment(&setup, 1e-4, 1);
    OWN(motion) m = motion_begin_by(&setup, known[i].method, 1e-4);
    motion_steps(&m, 1000); /* a quarter of a period is 56 ms */
    double first = m.state->v[2];
    assert_relative(-first, speed, known[i].tolerance);
    motion_steps(&m, 1000);
    assert_near(m.state->v[2], first, 1e-14);
  }
}

/* An actuator that lengthens a cable lets it go slack; the rate of the drive pulls through k only
   while it is taut. */
TEST(a_driven_cable_goes_slack) {
  OWN(strut_setup) setup = build_tethered(1, 0, 1);
  OWN(motion) m;
  strut_signal ramp = strut_signal_default(STRUT_RAMP);
  ramp.amplitude = 0.5, ramp.start = -1, ramp.stop = 1; /* 0.25 m/s, 0.25 m at t = 0 */
  int32_t cable = build_sized(&setup.scene, STRUT_CABLE, 0, 1, 100, 8, 0, 0.5);
  build_actuator(&setup.scene, cable, build_signal(&setup.scene, ramp));
  m = motion_begin(&setup.scene, STEP);
  strut_forces_evaluate(m.model, m.state, 0, m.state->q, m.state->v);
  assert_true(m.state->latest->force[2] == -(100 * 0.25 - 8 * 0.25));
  strut_forces_evaluate(m.model, m.state, 1, m.state->q, m.state->v);
  assert_true(m.state->latest->force[2] == 0);
}
