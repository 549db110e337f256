/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Methods with located events against closed forms: bounce, belt, Coulomb's oscillator. */
#include "tests/support/motion.h"

static const double PI = 3.14159265358979323846, GRAVITY = 9.81;
static const char *const LOCATED[] = {"rk4-events", "adaptive"};
enum { LOCATED_COUNT = sizeof LOCATED / sizeof LOCATED[0] };

/* The damper of (8) acts on the way in only: x'' + 2 zeta w x' + w^2 x = 0, then without damping. */
static double restitution(double zeta) {
  if (zeta < 1) return exp(-zeta * acos(zeta) / sqrt(1 - zeta * zeta));
  return zeta == 1 ? exp(-1.0) : exp(-zeta * acosh(zeta) / sqrt(zeta * zeta - 1));
}

/* The fastest rate of the contact over w: how much shorter a step must be to resolve it. */
static double hurry(double zeta) { return zeta > 1 ? zeta + sqrt(zeta * zeta - 1) : 1; }

/*
 * Speed after the bounce over speed before it; z is the step times the contact's fastest rate. The
 * node arrives and leaves inside a step.
 */
static double bounce(const char *method, double zeta, double z) {
  const double k = 2500, mass = 0.04, omega = sqrt(k / mass) * hurry(zeta), speed = 3;
  OWN(strut_setup) setup = build_setup();
  build_mass(&setup.scene, 0, 1.37 * speed * 0.01 / omega, mass);
  setup.scene.nodes[0].velocity[1] = -speed;
  build_contact(&setup.scene, 0, k, 2 * zeta * sqrt(k * mass));
  setup.experiment.tolerance = 1e-11;
  OWN(motion) m = motion_begin_by(&setup, method, z / omega);
  double touching = (zeta < 1 ? PI : PI + 4 * zeta) * hurry(zeta);
  motion_steps(&m, (int64_t)ceil((touching + 0.1) / z) + 2);
  assert_true(m.state->q[1] > 0);
  return m.state->v[1] / speed;
}

TEST(restitution_of_the_one_sided_damper) {
  static const double zeta[] = {0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1, 1.5, 3};
  for (int k = 0; k < LOCATED_COUNT; k++) {
    double worst = 0;
    for (size_t i = 0; i < sizeof zeta / sizeof zeta[0]; i++) {
      double expected = restitution(zeta[i]), e = bounce(LOCATED[k], zeta[i], 0.01);
      worst = fmax(worst, fabs(e - expected));
      assert_near(e, expected, 1e-9);
    }
    print_message("%s: restitution off by %.1e at most, w dt = 0.01\n", LOCATED[k], worst);
  }
}

TEST(order_through_a_bounce) {
  static const double zeta[] = {0.05, 0.2, 0.4, 0.6, 0.8, 1.5};
  for (size_t i = 0; i < sizeof zeta / sizeof zeta[0]; i++) {
    double error[4];
    for (int k = 0; k < 4; k++)
      error[k] = fabs(bounce("rk4-events", zeta[i], ldexp(0.05, -k)) - restitution(zeta[i]));
    double order = observed_order(error, 4);
    print_message("zeta %g: order %.2f, errors %.1e %.1e %.1e %.1e\n", zeta[i], order, error[0],
                  error[1], error[2], error[3]);
    assert_true(order >= 3.5);
  }
}

/* One block of 1 kg on level ground that carries it already, on a spring to a wall. */
static strut_setup spring_block(double stiffness, double mu_static, double mu_kinetic,
                                double stretch) {
  const double ground = 1e5, y = -GRAVITY / ground;
  strut_setup setup = build_falling();
  int32_t block = build_mass(&setup.scene, 0, y, 1), wall = build_support(&setup.scene, -1, y);
  build_member(&setup.scene, STRUT_SPRING, block, wall, stiffness, 0, 0);
  setup.scene.nodes[0].start[0] = stretch;
  build_rough_contact(&setup.scene, 0, ground, 0, mu_static, mu_kinetic, 1e-4);
  setup.scene.contacts[0].friction.law = STRUT_FRICTION_COULOMB;
  return setup;
}

/* Time within the latest step at which the velocity fell through 0, by Newton on its expansion. */
static double turned(const motion *m, double v_before, double a_before, double rate_before) {
  double t = -v_before / a_before;
  for (int k = 0; k < 20; k++) {
    double v = v_before + t * (a_before + t * (rate_before / 2)), a = a_before + t * rate_before;
    t -= v / a;
  }
  assert_within(t, -1e-9 * m->step, m->step);
  return t;
}

/* Mean time between turning points of a slipping block, from the first to the last of `count`. */
static double turning_period(motion *m, double stiffness, double friction, int count) {
  double first = 0, last = 0;
  int found = 0;
  for (int64_t n = 0; found < count; n++) {
    assert_true(n < 100000000);
    double x = m->state->q[0], v = m->state->v[0], at = (double)m->state->step * m->step;
    motion_steps(m, 1);
    if (!(v > 0 && m->state->v[0] <= 0)) continue;
    double a = friction - stiffness * x;
    last = at + turned(m, v, a, -stiffness * v);
    if (found++ == 0) first = last;
  }
  return (last - first) / (count - 1);
}

/* Static friction above the kinetic one makes it stick and slip. With equal coefficients the block is carried along
 * until it slips, and then swings by itself: it meets the belt's speed, no longer. */
static void check_belt(double most, int turns) {
  const double k = 100, belt = 0.1, weight = 9.81, kinetic = 1, omega = 10;
  const double gap = (most - kinetic) / k;
  const double stick =
      gap > 0 ? 2 * gap / belt + 2 * atan(belt / (omega * gap)) / omega : PI / omega;
  for (int i = 0; i < LOCATED_COUNT; i++) {
    OWN(strut_setup) setup = spring_block(k, most / weight, kinetic / weight, 0);
    setup.scene.ground.belt_speed = setup.scene.nodes[0].velocity[0] = belt;
    setup.experiment.tolerance = 1e-10;
    OWN(motion) m = motion_begin_by(&setup, LOCATED[i], 3e-4);
    assert_relative(turning_period(&m, k, kinetic, turns), PI / omega + stick, 1e-6);
    double way = hypot(m.state->q[0] - kinetic / k, m.state->v[0] / omega);
    if (gap == 0) assert_relative(way, belt / omega, 1e-6);
  }
}

TEST(block_on_a_belt) {
  check_belt(2, 6);
  check_belt(1, 30);
}

/* Amplitude about the centre of the present half-cycle, which friction shifts by mu N / k. */
static double amplitude(const motion *m, double shift, double omega) {
  double centre = m->state->v[0] > 0 ? -shift : shift;
  return hypot(m->state->q[0] - centre, m->state->v[0] / omega);
}

TEST(coulomb_oscillator) {
  const double k = 100, omega = 10, weight = 9.81, start = 0.1;
  static const double mus[] = {0.05, 0.0813, 0.2};
  for (int i = 0; i < LOCATED_COUNT * 3; i++) {
    double mu = mus[i / LOCATED_COUNT], shift = mu * weight / k, step = 2e-4;
    OWN(strut_setup) setup = spring_block(k, mu, mu, start);
    setup.experiment.tolerance = 1e-12;
    OWN(motion) m = motion_begin_by(&setup, LOCATED[i % LOCATED_COUNT], step);
    int halves = (int)ceil((start - shift) / (2 * shift));
    double last = start + shift, worst = 0;
    for (int half = 0; half < halves; half++) {
      int64_t middle = (int64_t)llround((half + 0.5) * PI / omega / step);
      motion_steps(&m, middle - m.state->step);
      double now = amplitude(&m, shift, omega);
      worst = fmax(worst, fabs(last - now - 2 * shift));
      assert_near(last - now, 2 * shift, 1e-8);
      last = now;
    }
    motion_steps(&m, 20000);
    double rest = (start - 2 * shift * halves) * (halves % 2 ? -1 : 1);
    double stood = m.state->q[0];
    assert_near(stood, rest, 1e-9);
    motion_steps(&m, 20000);
    assert_true(m.state->q[0] == stood && m.state->v[0] == 0);
    print_message("%s, mu %g: drop of a half-cycle off by %.1e m, stopping place by %.1e m\n",
                  LOCATED[i % LOCATED_COUNT], mu, worst, fabs(stood - rest));
  }
}

/* A block of 1 kg on ground, at height y above it, under a load along the ground. */
static strut_setup loaded_block(double ground, double y, double mu, double load, double frequency) {
  strut_setup setup = build_falling();
  int32_t block = build_mass(&setup.scene, 0, y, 1);
  int32_t signal = frequency > 0 ? build_sine(&setup.scene, 1, frequency) : -1;
  build_load(&setup.scene, block, load, 0, signal);
  build_rough_contact(&setup.scene, 0, ground, 0, mu, mu, 1e-2);
  setup.experiment.tolerance = 1e-11;
  return setup;
}

/* Pulled by more than friction from rest: uniformly accelerated, and no part of a step is lost at the edge. */
TEST(the_band_is_left_where_its_edge_is) {
  const double ground = 1e5, mu = 0.1, load = 2;
  for (int i = 0; i < LOCATED_COUNT; i++) {
    for (double step = 1e-3; step < 6e-3; step += 1.3e-3) {
      OWN(strut_setup) setup = loaded_block(ground, -GRAVITY / ground, mu, load, 0);
      OWN(motion) m = motion_begin_by(&setup, LOCATED[i], step);
      motion_steps(&m, 20);
      double expected = 20 * step * (load - mu * GRAVITY);
      print_message("%s, step %g: speed off by %.1e m/s\n", LOCATED[i], step,
                    m.state->v[0] - expected);
      assert_near(m.state->v[0], expected, 1e-12 * expected);
    }
  }
}

/*
 * Slowed down to the edge of the band, where forces balance, the block keeps that speed until the load, which grows
 * as a sine, exceeds what friction can balance.
 */
TEST(the_edge_of_the_band_is_left_where_balance_ends) {
  const double ground = 1e5, mu = 0.1, load = 4, frequency = 0.05, edge = 1e-2, most = mu * GRAVITY;
  const double omega = 2 * PI * frequency, leaves = asin(most / load) / omega, end = 1.5;
  for (int i = 0; i < LOCATED_COUNT; i++) {
    OWN(strut_setup) setup = loaded_block(ground, -GRAVITY / ground, mu, load, frequency);
    setup.scene.nodes[0].velocity[0] = 0.05;
    OWN(motion) m = motion_begin_by(&setup, LOCATED[i], 5e-3);
    motion_steps(&m, 120);
    assert_near(m.state->v[0], edge, 1e-9 * edge);
    motion_steps(&m, 180);
    double expected =
        edge + load / omega * (cos(omega * leaves) - cos(omega * end)) - most * (end - leaves);
    print_message("%s: speed off by %.1e m/s, %lld events\n", LOCATED[i], m.state->v[0] - expected,
                  (long long)m.state->events);
    assert_near(m.state->v[0], expected, 1e-8 * edge); /* speeds at the edge are known to that */
  }
}

/*
 * Pushed backwards by a load that begins at 0, as the normal force does: friction is against the push from the start,
 * and the block never within what it could balance.
 */
TEST(friction_is_against_a_push_that_begins) {
  const double ground = 1000, omega = sqrt(ground), mu = 0.3, load = -400, frequency = 0.5;
  const double drive = 2 * PI * frequency, step = 1e-3, t = 50 * step;
  for (int i = 0; i < LOCATED_COUNT; i++) {
    OWN(strut_setup) setup = loaded_block(ground, 0, mu, load, frequency);
    setup.scene.contacts[0].friction.mu_static = 1.2 * mu;
    OWN(motion) m = motion_begin_by(&setup, LOCATED[i], step);
    motion_steps(&m, 50);
    double expected =
        load / drive * (1 - cos(drive * t)) + mu * GRAVITY * (t - sin(omega * t) / omega);
    print_message("%s: speed %.9g m/s, off by %.1e m/s\n", LOCATED[i], expected,
                  m.state->v[0] - expected);
    assert_near(m.state->v[0], expected, 1e-7);
  }
}

/*
 * Drawn on the ground, which does not carry it yet, a block slips under the smallest load, until it is carried: here
 * within the first step.
 */
TEST(a_slip_may_end_in_the_step_in_which_it_begins) {
  const double ground = 1000, omega = sqrt(ground), mu = 0.3, load = 0.01, most = mu * GRAVITY;
  double t = sqrt(6 * load / most) / omega;
  for (int k = 0; k < 50; k++)
    t -= (load * t - most * (t - sin(omega * t) / omega)) / (load - most * (1 - cos(omega * t)));
  double expected = load * t * t / 2 - most * (t * t / 2 + (cos(omega * t) - 1) / (omega * omega));
  for (int i = 0; i < LOCATED_COUNT; i++) {
    OWN(strut_setup) setup = loaded_block(ground, 0, mu, load, 0);
    setup.scene.contacts[0].friction.law = STRUT_FRICTION_COULOMB;
    OWN(motion) m = motion_begin_by(&setup, LOCATED[i], 0.5 / omega);
    motion_steps(&m, 6);
    print_message("%s: slipped %.9g m, closed form %.9g m\n", LOCATED[i], m.state->q[0], expected);
    assert_near(m.state->q[0], expected, 1e-3 * expected);
    assert_true(m.state->v[0] == 0);
  }
}
