/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rigid bars: pendulums with closed forms, lengths over long runs, energy, stick, and refusals. */
#include <gsl/gsl_sf_ellint.h>

#include "engine/forces/rigid.h"
#include "tests/support/motion.h"

static const double G = 9.81, L = 0.7;

static strut_setup begin(void) {
  strut_setup setup = build_falling();
  setup.scene.bar_model = STRUT_BARS_RIGID;
  return setup;
}

/* From the horizontal, after a quarter of the elliptic integral's period it hangs straight down. */
TEST(pendulum_has_the_period_of_the_elliptic_integral) {
  double error[3], period = 4 * gsl_sf_ellint_Kcomp(sqrt(0.5), 0) * sqrt(L / G);
  for (int k = 0; k < 3; k++) {
    int steps = 60 << k;
    OWN(strut_setup) setup = begin();
    int32_t hook = build_support(&setup.scene, 0, 0), bob = build_mass(&setup.scene, L, 0, 2);
    build_member(&setup.scene, STRUT_BAR, hook, bob, 1e5, 1, 0);
    OWN(motion) m = motion_begin(&setup.scene, period / 4 / steps);
    motion_steps(&m, steps);
    error[k] = fabs(m.state->q[2]) / L;
    double length[1], force[1];
    strut_forces_evaluate(m.model, m.state, 0, m.state->q, m.state->v);
    motion_members(m.model, m.state, length, force);
    assert_relative(length[0], L, 1e-12);
    assert_relative(force[0], 3 * 2 * G, 1e-6); /* weight and centrifugal force */
  }
  assert_true(error[0] < 1e-6);
  assert_within(observed_order(error, 3), 3.7, 4.6);
}

/* Two uniform rods in a row: omega^2 = (3 -+ 6/sqrt 7) g/L; a quarter period ends in a straight line. */
TEST(double_pendulum_of_rods_has_its_two_frequencies) {
  for (int mode = -1; mode <= 1; mode += 2) {
    const double small = 1e-4, x = 3 + mode * 6 / sqrt(7), other = (1.5 - 4 * x / 3) / (x / 2);
    double swing[2] = {small, small * other}, omega = sqrt(x * G / L);
    OWN(strut_setup) setup = begin();
    int32_t top = build_support(&setup.scene, 0, 0);
    double x1 = L * sin(swing[0]), y1 = -L * cos(swing[0]);
    int32_t knee = build_node(&setup.scene, x1, y1);
    int32_t end = build_node(&setup.scene, x1 + L * sin(swing[1]), y1 - L * cos(swing[1]));
    build_member(&setup.scene, STRUT_BAR, top, knee, 1e5, 0, 3);
    build_member(&setup.scene, STRUT_BAR, knee, end, 1e5, 0, 3);
    OWN(motion) m = motion_begin(&setup.scene, acos(-1) / 2 / omega / 200);
    motion_steps(&m, 200);
    assert_all_near(1e-6 * small, m.state->q[2] / L, 0, (m.state->q[4] - m.state->q[2]) / L, 0);
    assert_relative(m.state->v[2], -omega * L * small, 1e-6);
  }
}

/* Thrown up so that it tumbles; the supported end of the first bar drags on it. */
static strut_setup chain(void) {
  strut_setup setup = begin();
  int32_t last = build_support(&setup.scene, 0, 0);
  for (int i = 1; i <= 4; i++) {
    int32_t next = build_node(&setup.scene, i * 0.3, i % 2 * 0.1);
    build_member(&setup.scene, STRUT_BAR, last, next, 1e5, 2, 0.5);
    last = next;
  }
  setup.scene.nodes[last].mass = 0.2;
  return setup;
}

TEST(lengths_hold_over_a_long_tumble) {
  double kept[4];
  OWN(strut_setup) setup = chain();
  OWN(motion) m = motion_begin(&setup.scene, 5e-4);
  memcpy(kept, m.state->rigid->length, sizeof kept);
  for (int i = 0; i < 200; i++) {
    motion_steps(&m, 500);
    assert_int_equal(m.state->trouble, STRUT_FAILURE_NONE);
    for (int b = 0; b < 4; b++) {
      const double *p = m.state->q + 2 * b, *v = m.state->v + 2 * b;
      double d[2] = {p[2] - p[0], p[3] - p[1]};
      assert_relative(hypot(d[0], d[1]), kept[b], 1e-12);
      assert_near((d[0] * (v[2] - v[0]) + d[1] * (v[3] - v[1])) / kept[b], 0, 1e-11);
    }
  }
}

TEST(energy_is_kept_at_fourth_order) {
  double error[3];
  for (int k = 0; k < 3; k++) {
    OWN(strut_setup) setup = chain();
    motion_experiment(&setup, ldexp(2e-3, -k), 0.4);
    OWN(strut_summary) s = motion_simulate(&setup);
    error[k] = fabs(s.energy.residual) / s.energy.moved;
    assert_all(s.energy.elastic == 0, s.energy.dissipated_members < 1e-4 * s.energy.moved);
  }
  assert_true(error[2] < 1e-6);
  assert_true(observed_order(error, 3) > 3.5);
}

/* A sled of two feet and a bar, pushed at one foot: it holds as one body, and slides as one. */
static double pushed_sled(double share) {
  const double mass = 0.4, mu_static = 0.5, mu_kinetic = 0.3, stiffness = 1e5;
  double depth = mass * G / stiffness;
  OWN(strut_setup) setup = begin();
  int32_t a = build_mass(&setup.scene, 0, -depth, mass),
          b = build_mass(&setup.scene, 1, -depth, mass);
  build_member(&setup.scene, STRUT_BAR, a, b, 1e4, 0, 0);
  build_rough_contact(&setup.scene, a, stiffness, 0, mu_static, mu_kinetic, 1e-4);
  build_rough_contact(&setup.scene, b, stiffness, 0, mu_static, mu_kinetic, 1e-4);
  build_load(&setup.scene, a, share * mu_static * 2 * mass * G, 0, -1);
  OWN(motion) m = motion_begin(&setup.scene, 1e-4);
  motion_steps(&m, 2000);
  return m.state->v[2];
}

TEST(bars_and_stick_are_solved_together) {
  assert_near(pushed_sled(0.95), 0, 1e-7); /* more than one foot alone could hold */
  assert_relative(pushed_sled(1.2), 0.2 * (1.2 * 0.5 - 0.3) * G, 1e-2);
}

/* What strut_simulate says of a scene that it must refuse. */
static strut_status refusal(const strut_setup *setup, strut_error *error) {
  OWN(strut_summary) summary;
  return motion_try(setup, (strut_run_options){0}, &summary, error);
}

TEST(what_cannot_be_rigid_is_refused_by_name) {
  strut_error error = {0};
  OWN(strut_setup) setup = begin();
  int32_t n[4] = {build_support(&setup.scene, 0, 0), build_support(&setup.scene, 1, 0),
                  build_mass(&setup.scene, 0, 1, 1), build_mass(&setup.scene, 1, 1, 1)};
  build_member(&setup.scene, STRUT_BAR, n[0], n[2], 1e4, 0, 0);
  build_member(&setup.scene, STRUT_BAR, n[1], n[3], 1e4, 0, 0);
  build_member(&setup.scene, STRUT_BAR, n[2], n[3], 1e4, 0, 0);
  build_member(&setup.scene, STRUT_BAR, n[0], n[3], 1e4, 0, 0);
  int32_t extra = build_member(&setup.scene, STRUT_BAR, n[1], n[2], 1e4, 0, 0);
  motion_experiment(&setup, 1e-3, 0.1);
  assert_fails(refusal(&setup, &error), STRUT_SINGULAR, error, setup.scene.members[extra].name);
  setup.scene.members[extra].kind = STRUT_SPRING;
  strut_summary s = motion_simulate(&setup);
  assert_ok(s.status);
  strut_summary_free(&s);
  setup.experiment.integrator = "verlet-events";
  assert_fails(refusal(&setup, &error), STRUT_USAGE, error, "rk4");
}

/* Stiff bars no longer limit the step: what is left is a mass on a spring between rigid walls. */
TEST(step_limit_is_that_of_the_motions_left) {
  OWN(strut_setup) setup = begin();
  setup.scene.gravity[1] = 0;
  int32_t wall = build_support(&setup.scene, -1, 0), a = build_mass(&setup.scene, 0, 0, 1.5);
  int32_t b = build_mass(&setup.scene, 1, 0, 0.5);
  build_member(&setup.scene, STRUT_SPRING, wall, a, 800, 0, 0);
  build_member(&setup.scene, STRUT_BAR, a, b, 1e9, 0, 0);
  motion_experiment(&setup, 1e-3, 0.1);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_relative(s.step_limit, 2 * sqrt(2) / sqrt(800 / 2.0), 1e-6);
}

/* A rod that only swings has no limit, also where it lies along an axis, in which nothing moves. */
TEST(a_rod_that_only_swings_has_no_step_limit) {
  const double way[][2] = {{1, 0}, {0, -1}, {0.6, -0.8}, {-0.28, 0.96}};
  for (size_t i = 0; i < sizeof way / sizeof way[0]; i++) {
    OWN(strut_setup) setup = begin();
    setup.scene.gravity[1] = 0;
    int32_t pin = build_support(&setup.scene, 0, 0),
            tip = build_node(&setup.scene, way[i][0], way[i][1]);
    build_member(&setup.scene, STRUT_BAR, pin, tip, 1e6, 0, 1.0);
    motion_experiment(&setup, 1e-3, 0.1);
    OWN(strut_summary) s = motion_simulate(&setup);
    assert_true(s.step_limit > 1.0);
  }
}
