/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Runs that stop when they are steady: what they call so and what they must not, against closed forms, and
 * equations of motion that are written out and stepped here, with their variation for Lyapunov exponents.
 */
#include "tests/physics/driven_scenes.h"
#include "tests/support/motion.h"

static const double PI = 3.14159265358979323846;

/* ---- a mass of 1 kg between two springs, pushed through their line ---- */

enum { STEPS = 400 }; /* of a drive period */
static const double K = 500, C = 6, RISE = 0.3;

/* y, v, and two tangent vectors beside them. */
static void snap_rate(double t, double push, double frequency, const double *z, double *d) {
  double y = z[0], v = z[1], length = sqrt(1 + y * y), rest = sqrt(1 + RISE * RISE);
  double lean = y / length, turn = 1 / (length * length * length), stretch = length - rest;
  double by_y = -2 * (K * lean * lean + K * stretch * turn + 2 * C * v * lean * turn);
  double by_v = -2 * C * lean * lean;
  d[0] = v;
  d[1] = push * sin(2 * PI * frequency * t) - 2 * (K * stretch + C * v * lean) * lean;
  for (int c = 2; c < 6; c += 2) d[c] = z[c + 1], d[c + 1] = by_y * z[c] + by_v * z[c + 1];
}

static void snap_period(double push, double frequency, int period, double *z) {
  double h = 1 / frequency / STEPS, k[4][6], x[6];
  for (int n = 0; n < STEPS; n++) {
    double t = period / frequency + n * h;
    snap_rate(t, push, frequency, z, k[0]);
    for (int s = 1; s < 4; s++) {
      double part = s < 3 ? 0.5 * h : h;
      for (int i = 0; i < 6; i++) x[i] = z[i] + part * k[s - 1][i];
      snap_rate(t + part, push, frequency, x, k[s]);
    }
    for (int i = 0; i < 6; i++) z[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
  }
}

/* The period of what it comes to, in drive periods, or 0; and how fast neighbours part, per period. */
static int snap_truth(double push, double frequency, double *lyapunov) {
  enum { PERIODS = 1200, SETTLED = 400, MOST = 16 };
  double z[6] = {RISE, 0, 1, 0, 0, 1}, at[PERIODS];
  *lyapunov = 0;
  for (int p = 0; p < PERIODS; p++) {
    snap_period(push, frequency, p, z);
    double size = hypot(z[2], z[3]);
    at[p] = z[0];
    if (p >= SETTLED) *lyapunov += log(size) / (PERIODS - SETTLED);
    z[2] /= size, z[3] /= size;
  }
  for (int n = 1; n <= MOST; n++) {
    bool alike = true;
    for (int p = PERIODS - 10 * MOST; p < PERIODS; p++)
      alike = alike && fabs(at[p] - at[p - n]) < 1e-7;
    if (alike) return n;
  }
  return 0;
}

static void snap_scene(strut_setup *setup, double push, double frequency) {
  driven_snap(setup, C, push, frequency);
  driven_watch(setup, 1 / frequency / STEPS, 1000, 0.005);
}

/*
 * From small pushes to large ones the motion doubles its period, is chaotic, has windows of period 3,
 * and is simple again. Which of them it is here is known; that is what the run must say, or nothing.
 */
TEST(doubling_and_chaos) {
  const struct {
    double frequency, push;
    int period;
  } cases[] = {{2.6, 6, 1},   {2.6, 7, 2},   {2.6, 8.5, 2},  {1.5, 4.5, 1},
               {1.5, 4.8, 2}, {2.6, 11, 3},  {1.5, 8.25, 3}, {1.1, 5, 1},
               {1.1, 2.6, 0}, {1.1, 3.1, 0}, {1.1, 4.1, 0},  {1.5, 6, 0},
               {2, 12, 0},    {2, 20, 0},    {2.6, 32, 0},   {2, 28, 1}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    double lyapunov;
    int period = snap_truth(cases[i].push, cases[i].frequency, &lyapunov);
    assert_int_equal(period, cases[i].period);
    assert_true(period ? lyapunov < -0.02 : lyapunov > 0.2);
    OWN(strut_setup) setup;
    snap_scene(&setup, cases[i].push, cases[i].frequency);
    OWN(strut_summary) s = motion_simulate(&setup);
    if (period) {
      assert_int_equal(s.steady.kind, STRUT_MOTION_PERIODIC);
      assert_int_equal(s.steady.repeats, period);
    } else {
      assert_int_not_equal(s.steady.kind, STRUT_MOTION_PERIODIC);
    }
  }
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

/* ---- an oscillator of 1 kg whose transient comes nearly or exactly back with the drive's periods ---- */

/* Parts of the steady motion that are left of the transient when it is called steady; else 0. */
static double left_over(double ratio, double zeta, double tolerance, double periods) {
  OWN(strut_setup) setup;
  double w = 2 * PI * ratio, drive = 2 * PI;
  driven_oscillator(&setup, w, zeta);
  driven_watch(&setup, 0.01, periods, tolerance);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_int_not_equal(s.steady.kind, STRUT_MOTION_IRREGULAR);
  double re = w * w - drive * drive, im = 2 * zeta * w * drive, size = hypot(re, im);
  double own = w * sqrt(1 - zeta * zeta), x = im / (size * size);
  double v = (-drive * re / (size * size) + zeta * w * x) / own;
  double left = exp(-zeta * w * s.duration) * hypot(x, v) * fmax(1, ratio) * size;
  bool steady = s.steady.kind == STRUT_MOTION_PERIODIC;
  return steady ? left : 0;
}

/*
 * At 1/3 of the drive's frequency a light damping lets the transient seem period-3 for hundreds of
 * periods; a little beside 2 and 3 times it, its slow beat seems to decay for a while. The shape is
 * held to four tolerances of its way in half a period: 8 to 10 of its amplitude.
 */
TEST(transients_in_tune_with_the_drive) {
  const double ratio[] = {1.0 / 3, 0.25, 0.75,   1.25,  4.0 / 3, 1.5,
                          2.0006,  3.0,  3.0009, 3.009, 1.0003,  0.3337};
  for (size_t i = 0; i < sizeof ratio / sizeof *ratio; i++) {
    assert_within(left_over(ratio[i], 1e-3, 0.005, 1500), 0, 13 * 0.005);
    assert_within(left_over(ratio[i], 1e-4, 0.005, 1500), 0, 13 * 0.005);
  }
  assert_within(left_over(0.125, 3e-3, 0.005, 1500), 0, 13 * 0.005);
}

TEST(slow_transients_are_not_steady) {
  const double zeta[] = {1e-4, 1e-3, 1e-2, 0.1, 0.9}, ratio = sqrt(1.5); /* not commensurable */
  for (int i = 0; i < 5; i++) {
    assert_within(left_over(ratio, zeta[i], 0.005, 300), 0, 10 * 0.005);
    assert_within(left_over(ratio, zeta[i], 0.05, 300), 0, 10 * 0.05);
    assert_within(left_over(ratio, zeta[i], 0.005, 2000), 0, 10 * 0.005);
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

/* ---- what changes late ---- */

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

/*
 * A hanging mass pushed up and down at twice its frequency as a pendulum: it begins to swing, from
 * as little as 1e-10 of its length. While nobody sees that yet the vertical motion has become steady.
 */
TEST(a_swing_that_grows_from_almost_nothing) {
  for (int power = 4; power <= 10; power += 2) {
    OWN(strut_setup) setup = build_tethered(pow(10, -power), -1, 1);
    build_member(&setup.scene, STRUT_SPRING, 0, 1, 400, 6, 0);
    setup.scene.gravity[1] = -9.81;
    build_load(&setup.scene, 1, 0, 1, build_sine(&setup.scene, 20, 0.985));
    driven_watch(&setup, 0.005 / 0.985, 300, 0.005);
    OWN(strut_summary) s = motion_simulate(&setup);
    assert_int_not_equal(s.steady.kind,
                         STRUT_MOTION_PERIODIC); /* it is so at the earliest at 500 */
  }
}

/*
 * A slider creeps along against a damper far too strong for its spring, 0.998 of the way left each
 * period; a cable goes taut when 5 % of it is left. Nothing is steady before, however quiet each period
 * is beside the one before it.
 */
TEST(a_drift_that_ends_in_a_jolt) {
  const double stiffness = 0.04, damping = 500 * stiffness, drift = 0.3, push = 0.2;
  OWN(strut_setup) setup = build_tethered(1 - drift, 0, 1);
  build_support(&setup.scene, -1, 0);
  build_sized(&setup.scene, STRUT_SPRING, 0, 1, stiffness, damping, 0, 1);
  build_sized(&setup.scene, STRUT_CABLE, 2, 1, 400, 1, 0, 2 - 0.05 * drift);
  setup.scene.nodes[1].fixed[1] = true;
  build_load(&setup.scene, 1, 1, 0, build_sine(&setup.scene, push, 1));
  driven_watch(&setup, 0.01, 4000, 0.005);
  OWN(strut_summary) s = motion_simulate(&setup);
  double sway = push / (2 * PI * hypot(damping, 2 * PI)),
         when = log(drift / (0.05 * drift + 2 * sway));
  assert_true((double)s.steady.periods > 500 * when);
  assert_int_equal(s.steady.kind, STRUT_MOTION_PERIODIC);
}

/* A frame at rest under its weight that nothing moves: it stands still, and the run ends at once. */
TEST(standing_still_under_its_weight) {
  OWN(strut_setup) setup = build_tethered(0, -1, 1);
  build_member(&setup.scene, STRUT_SPRING, 0, 1, 981, 20, 0);
  setup.scene.gravity[1] = -9.81;
  build_load(&setup.scene, 1, 1, 0, build_sine(&setup.scene, 0, 2));
  driven_watch(&setup, 1e-3, 1000, 0.005);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_all_equal(s.steady.kind, STRUT_MOTION_PERIODIC, s.steady.repeats, 1);
  assert_true(s.steady.periods < 60);
  assert_near(s.velocity, 0, 0);
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
