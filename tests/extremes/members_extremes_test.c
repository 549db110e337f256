/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members through no length at all, structures turned inside out, throws a million sizes far. */
#include "tests/support/random.h"
#include "tests/support/structures.h"

static const double PI = 3.14159265358979323846;
static const double K = 200, MASS = 0.5; /* w = 20 rad/s */
static const char *const METHODS[] = {"rk4", "rk4-events", "verlet-events", "adaptive"};
enum { METHOD_COUNT = sizeof METHODS / sizeof METHODS[0] };

/* A mass that swings through a support, missing it by `miss`. */
static strut_setup through(double rest, double miss) {
  strut_setup setup = build_tethered(1, 0, MASS);
  build_sized(&setup.scene, STRUT_SPRING, 0, 1, K, 0, 0, rest);
  setup.scene.nodes[1].velocity[1] = miss * sqrt(K / MASS);
  return setup;
}

/* Without a rest length the orbit is an ellipse: cos w t, miss sin w t. */
TEST(orbits_of_zero_rest_length_close) {
  static const double misses[] = {0, 1e-300, 1e-12, 1e-6, 0.5};
  const double omega = sqrt(K / MASS), step = 2 * PI / omega / 2000;
  for (int k = 0; k < METHOD_COUNT * 5; k++) {
    const char *method = METHODS[k % METHOD_COUNT];
    double miss = misses[k / METHOD_COUNT], late = method[0] == 'v' ? 5e-7 : 1e-11;
    OWN(strut_setup) setup = through(0, miss);
    setup.experiment.tolerance = 1e-13;
    OWN(motion) m = motion_begin_by(&setup, method, step);
    motion_steps(&m, 500); /* a quarter: nearest to the support */
    assert_int_equal(m.state->trouble, STRUT_FAILURE_NONE);
    assert_near(m.state->q[2], 0, 2 * PI * late + 1e-15);
    assert_near(m.state->q[3], miss, miss * 1e-5);
    motion_steps(&m, 19500); /* ten periods in all */
    assert_near(m.state->q[2], 1, 20 * PI * late);
    assert_near(m.state->q[3], 0, miss * 20 * PI * late + 1e-300);
  }
}

/*
 * With a rest length the force turns round on the way through: a method that meets this inside a
 * step is wrong by up to the jump times the way of a step, and its balance must say so.
 */
TEST(bars_through_no_length_keep_their_balance) {
  static const double misses[] = {0, 1e-300, 1e-12, 1e-9};
  const double rest = 0.4, speed = 20;
  for (int k = 0; k < METHOD_COUNT * 4; k++) {
    strut_setup setup;
    double step = 1e-4, worst = 0;
    for (int half = 0; half < 4; half++, step /= 2) {
      setup = through(rest, misses[k / METHOD_COUNT]);
      motion_experiment_by(&setup, step, 1.05, METHODS[k % METHOD_COUNT]);
      OWN(strut_summary) s;
      strut_error error = {0};
      strut_status status = motion_try(&setup, (strut_run_options){0}, &s, &error);
      if (status) { /* a named stop */
        assert_fails(status, STRUT_DIVERGED, error, "n2");
      } else {
        double kept = s.energy.kinetic + s.energy.elastic - s.energy.initial;
        double allowed = 7 * 2 * K * rest * speed * step; /* seven times through in 1.05 s */
        for (int i = 0; i < 4; i++) assert_true(isfinite(s.end.positions[i]));
        assert_near(s.energy.residual, kept, 1e-12 * s.energy.initial);
        assert_true(fabs(kept) <= allowed);
        worst = fmax(worst, fabs(kept) / s.energy.initial / step);
      }
      strut_setup_free(&setup);
    }
    print_message("%s, missed by %g: energy off by %.2g of itself times the step\n",
                  METHODS[k % METHOD_COUNT], misses[k / METHOD_COUNT], worst);
  }
}

/* A frame of springs, so that nothing is discontinuous. */
static strut_setup springs(double damping) {
  const x_frame frame = {0.2, 60, .cable = {800, damping, 0.05}, .bar = {2000, damping, 0.1}};
  strut_setup setup = build_setup();
  structure_x_frame(&setup.scene, &frame);
  for (size_t j = 0; j < setup.scene.member_count; j++) setup.scene.members[j].kind = STRUT_SPRING;
  return setup;
}

/* Twice the area, with its sign: negative once the frame is inside out. */
static double area(const double *q) {
  return (q[4] - q[0]) * (q[7] - q[3]) - (q[6] - q[2]) * (q[5] - q[1]);
}

/* The least area on the way, over that of the square, and what the balance leaves open [J]. */
static double shaken(uint64_t seed, double step, int steps, double *residual) {
  uint64_t r = seed;
  double least = 1;
  OWN(strut_setup) setup = springs(0.3);
  for (int i = 0; i < 8; i++)
    setup.scene.nodes[i / 2].velocity[i % 2] = random_between(&r, -120, 120);
  motion_experiment(&setup, step, steps * step);
  motion m = motion_begin(&setup.scene, step);
  for (int n = 0; n < steps; n++) {
    motion_steps(&m, 1);
    least = fmin(least, area(m.state->q) / 0.08);
  }
  motion_free(&m);
  OWN(strut_summary) s = motion_simulate(&setup);
  *residual = fabs(s.energy.residual) / s.energy.moved;
  return least;
}

/*
 * Passing no length closely, single runs come late to their order, or meet a residual that happens
 * to be small; their sum falls as it must.
 */
TEST(frames_turned_inside_out_keep_their_balance) {
  double sum[4] = {0}, deepest = 1;
  int inverted = 0;
  for (uint64_t seed = 1; seed <= 12; seed++) {
    double least = 1, residual;
    for (int k = 0; k < 4; k++) {
      least = shaken(seed, ldexp(4e-5, -k), 500 << k, &residual);
      sum[k] += residual / 12;
    }
    deepest = fmin(deepest, least);
    inverted += least < 0;
  }
  double order = observed_order(sum, 4);
  print_message(
      "%d of 12 inside out, to %.1f of the area: residual %.1e %.1e %.1e %.1e of what "
      "moved, order %.2f\n",
      inverted, deepest, sum[0], sum[1], sum[2], sum[3], order);
  assert_all(inverted >= 8 && deepest < -2, order >= 3.9);
}

/* Up to a million times its size and down again: the centre of mass on its parabola. */
TEST(a_throw_of_a_million_sizes) {
  const double g = 9.81, way = 2e5, speed = sqrt(2 * g * way), seconds = 2 * speed / g;
  OWN(strut_setup) setup = springs(0.3);
  setup.scene.gravity[1] = -g;
  structure_throw(&setup.scene, 3, speed, 40);
  double step = seconds / 1e6;
  motion_experiment(&setup, step, seconds);
  setup.scene.nodes[0].velocity[0] += 5; /* and shaken */
  OWN(strut_summary) s = motion_simulate(&setup);
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  double mass = 0, x = 0, y = 0, start = 0, drift = 0, rise = 0;
  for (int32_t i = 0; i < 4; i++) {
    double weight = model->weight[i];
    mass += weight, x += weight * s.end.positions[2 * i], y += weight * s.end.positions[2 * i + 1];
    start += weight * setup.scene.nodes[i].start[1];
    drift += weight * setup.scene.nodes[i].velocity[0],
        rise += weight * setup.scene.nodes[i].velocity[1];
  }
  double expected = start / mass + seconds * (rise / mass - 0.5 * g * seconds);
  print_message(
      "thrown %g m high: centre off its parabola by %.1e and %.1e m, residual %.1e J of "
      "%.1e J\n",
      way, x / mass - drift / mass * seconds, y / mass - expected, s.energy.residual,
      s.energy.initial);
  assert_all_near(1e-11 * way, x / mass, drift / mass * seconds, y / mass, expected);
  assert_true(fabs(s.energy.residual) <= 1e-10 * s.energy.initial);
}
