/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs that stop when they are steady: what they call so, and what they must not. */
#include "tests/physics/driven_scenes.h"
#include "tests/support/motion.h"

static const double PI = 3.14159265358979323846;

/*
 * The transient is as large as the motion, at w = sqrt(1.5) 2 pi: its beat with the drive is not
 * commensurable. When a run calls it steady the transient must have died to what the tolerance says.
 */
static void slow(double zeta, double tolerance, double periods) {
  OWN(strut_setup) setup;
  double w = 2 * PI * sqrt(1.5);
  driven_oscillator(&setup, w, zeta);
  driven_watch(&setup, 0.005, periods, tolerance);
  OWN(strut_summary) s = motion_simulate(&setup);
  double left = exp(-zeta * w * s.duration);
  if (s.steady.kind == STRUT_MOTION_PERIODIC)
    assert_within(left, 0, 10 * tolerance);
  else
    assert_int_equal(s.steady.kind, STRUT_MOTION_TRANSIENT);
}

TEST(slow_transients_are_not_steady) {
  const double zeta[] = {1e-4, 1e-3, 1e-2, 0.1, 0.9};
  for (int i = 0; i < 5; i++) {
    slow(zeta[i], 0.005, 300);
    slow(zeta[i], 0.05, 300);
    slow(zeta[i], 0.005, 2000);
  }
}

TEST(a_damped_oscillator_becomes_steady) {
  OWN(strut_setup) setup;
  driven_oscillator(&setup, 2 * PI * sqrt(1.5), 0.05);
  driven_watch(&setup, 0.005, 400, 0.005);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_all_equal(s.steady.kind, STRUT_MOTION_PERIODIC, s.steady.repeats, 1);
  assert_true(s.steady.periods < 60);
}

/*
 * A mass that is dragged along the ground comes to its speed as exp(-t / tau): smooth friction is a
 * damper of mu N / w at speeds far below w. It is steady once what is still to come is within the
 * tolerance of the speed; the speed reported is that of the latest five periods, so older by half of them.
 */
static void creeping(double tolerance) {
  OWN(strut_setup) setup = build_falling();
  const double mu = 0.5, width = 100, damper = mu * 9.81 / width, speed = 1;
  build_mass(&setup.scene, 0, -9.81 / 1e4, 1); /* where the ground carries it */
  build_contact(&setup.scene, 0, 1e4, 0);
  setup.scene.contacts[0].friction =
      (strut_friction){.law = STRUT_FRICTION_SMOOTH, .mu_kinetic = mu, .width = width};
  build_load(&setup.scene, 0, 1, 0, build_sine(&setup.scene, 1, 1));
  build_load(&setup.scene, 0, damper * speed, 0, -1);
  driven_watch(&setup, 0.005, 400, tolerance);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_int_equal(s.steady.kind, STRUT_MOTION_PERIODIC);
  double left = exp(-damper * s.duration); /* of the speed, after the latest period */
  assert_within(left, 0.25 * tolerance, 1.05 * tolerance);
  /* the sine's first push leaves a speed of its own, 1 / (2 pi), that dies alike */
  double reported = speed - (speed - 1 / (2 * PI)) * exp(-damper * (s.duration - 2.5));
  assert_near(s.velocity, reported, 0.1 * tolerance);
}

TEST(what_is_steady_is_so_within_the_tolerance) {
  creeping(0.02);
  creeping(0.005);
  creeping(0.001);
}

/* The drive\'s phase matters only every other period: forced at 1 Hz and 0.5 Hz. */
TEST(a_motion_that_repeats_every_second_period) {
  OWN(strut_setup) setup;
  driven_oscillator(&setup, 2 * PI * sqrt(1.5), 0.1);
  build_load(&setup.scene, 1, 1, 0, build_sine(&setup.scene, 1, 0.5));
  driven_watch(&setup, 0.005, 400, 0.001);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_all_equal(s.steady.kind, STRUT_MOTION_PERIODIC, s.steady.repeats, 2);
}

/* A shallow truss pushed through its flat shape, regularly or not: what is claimed holds later. */
static void claim_holds(double amplitude, double frequency) {
  OWN(strut_setup) setup;
  driven_snap(&setup, 0.4, amplitude, frequency);
  driven_watch(&setup, 0.002 / frequency, 1500, 0.005);
  OWN(strut_summary) s = motion_simulate(&setup);
  if (s.steady.kind == STRUT_MOTION_PERIODIC) { /* 480 is a multiple of all n */
    setup.experiment.steady.wanted = false;
    double y[2], at = s.duration * frequency;
    for (int k = 0; k < 2; k++) {
      setup.experiment.periods = round(at) + 480.0 * k;
      OWN(strut_summary) later = motion_simulate(&setup);
      y[k] = later.end.positions[5];
    }
    assert_near(y[1], y[0], 0.02);
  }
}

TEST(what_a_snapping_truss_is_said_to_do_it_does) {
  const double amplitude[] = {2, 12.5, 14, 15.5}; /* at 14 it comes near where it was by chance */
  for (int k = 0; k < 4; k++) claim_holds(amplitude[k], 1.1);
}

/* A second load begins at t = 100 s, or has a period that never meets the drive's. */
TEST(late_loads_and_beats_are_not_steady) {
  for (int k = 0; k < 3; k++) {
    OWN(strut_setup) setup;
    driven_oscillator(&setup, 2 * PI * sqrt(1.5), 0.1);
    int32_t signal = build_sine(&setup.scene, 0.3, k == 0 ? 1 : k == 1 ? 1.001 : 1.37);
    if (k == 0) setup.scene.signals[signal].start = 100;
    build_load(&setup.scene, 1, 1, 0, signal);
    driven_watch(&setup, 0.005, 250, 0.005);
    OWN(strut_summary) s = motion_simulate(&setup);
    if (k == 0) {
      assert_int_equal(s.steady.kind, STRUT_MOTION_PERIODIC);
      assert_true(s.steady.periods > 105 && s.steady.periods < 200);
    } else {
      assert_int_equal(s.steady.kind, STRUT_MOTION_TRANSIENT);
    }
  }
}

/* A driven block that friction holds: it stands still, and the run stops. */
TEST(standing_still_is_steady) {
  OWN(strut_setup) setup = build_falling();
  build_mass(&setup.scene, 0, 0, 1);
  build_rough_contact(&setup.scene, 0, 1e5, 300, 0.5, 0.5, 1e-3);
  build_load(&setup.scene, 0, 1, 0, build_sine(&setup.scene, 1, 5));
  driven_watch(&setup, 1e-4, 1000, 0.005);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_all_equal(s.steady.kind, STRUT_MOTION_PERIODIC, s.steady.repeats, 1);
  assert_true(s.steady.periods <= 60);
  assert_within(s.velocity, 0, 1e-4);
}
