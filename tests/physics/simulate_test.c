/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The run: what it measures, how it refuses, stops and comes to rest. */
#include <time.h>

#include "tests/support/structures.h"

static const double PI = 3.14159265358979323846;

/* A free mass of 2 kg that drifts at 0.3 m/s and is pushed by 5 N at 7.3 Hz, and by `steady` N. */
static strut_setup drifting(double steady) {
  strut_setup setup = build_setup();
  build_mass(&setup.scene, 0, 0, 2);
  setup.scene.nodes[0].velocity[0] = 0.3;
  build_load(&setup.scene, 0, 5, 0, build_sine(&setup.scene, 1, 7.3));
  if (steady != 0) build_load(&setup.scene, 0, steady, 0, -1);
  setup.experiment.step = 1e-3; /* 136.986 steps in a period */
  setup.experiment.periods = 50;
  setup.experiment.period_signal = 0;
  setup.experiment.measure_last = 8;
  return setup;
}

TEST(velocity_over_periods_that_the_step_does_not_divide) {
  OWN(strut_setup) setup = drifting(0);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_near(s.velocity, 0.3 + 5 / (2 * 2 * PI * 7.3), 1e-9);
  assert_within(s.velocity_spread, 0, 1e-8);
  assert_relative(s.window.start, 42 / 7.3, 1e-15);
  assert_int_equal(s.spent.steps, (int64_t)ceil(50 / 7.3 / 1e-3));
  assert_same_bits(s.duration, 50 / 7.3);
}

TEST(spread_of_an_accelerated_mass) {
  const double steady = 0.4, period = 1 / 7.3, a = steady / 2;
  OWN(strut_setup) setup = drifting(steady);
  OWN(strut_summary) s = motion_simulate(&setup);
  double middle = 46 * period; /* of the window */
  assert_near(s.velocity, 0.3 + 5 / (2 * 2 * PI * 7.3) + a * middle, 1e-9);
  assert_near(s.velocity_spread, a * period * sqrt(8 * 9 / 12.0), 1e-8);
}

/* Two masses that fly apart: of one node, or of their centre. */
TEST(velocity_of_a_node_or_of_the_centre_of_mass) {
  for (int32_t node = -1; node < 2; node++) {
    OWN(strut_setup) setup = build_setup();
    build_mass(&setup.scene, 0, 0, 1);
    build_mass(&setup.scene, 1, 0, 3);
    setup.scene.nodes[0].velocity[0] = -2, setup.scene.nodes[1].velocity[0] = 1;
    motion_experiment(&setup, 0.01, 1);
    setup.experiment.measure_node = node;
    setup.experiment.measure_last = 0.333;
    OWN(strut_summary) s = motion_simulate(&setup);
    assert_near(s.velocity, node < 0 ? 0.25 : node ? 1 : -2, 1e-12);
    assert_true(isnan(s.velocity_spread));
    assert_near(s.window.start, 0.667, 1e-15);
    assert_int_equal(s.end.node_count, 2);
    assert_string_equal(s.end.node_names[1], "n2");
    assert_near(s.end.positions[2], 2, 1e-13);
  }
}

/* A mass that swings by 0.1 m about a ground too soft to be felt, 0.04 m above its middle. */
TEST(duty_and_height_of_a_contact) {
  OWN(strut_setup) setup = build_setup();
  build_support(&setup.scene, 0, -1);
  build_mass(&setup.scene, 0, 0, 1);
  build_member(&setup.scene, STRUT_SPRING, 0, 1, 4 * PI * PI, 0, 0); /* 1 Hz */
  setup.scene.nodes[1].start[1] = 0.1;
  build_contact(&setup.scene, 1, 1e-9, 0);
  setup.scene.ground.height = 0.04;
  motion_experiment(&setup, 1e-4, 5);
  setup.experiment.measure_last = 3;
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_int_equal(s.end.contact_count, 1);
  assert_string_equal(s.end.contacts[0].node, "n2");
  assert_near(s.end.contacts[0].duty, 1 - acos(0.4) / PI, 3e-4);
  assert_near(s.end.contacts[0].max_height, 0.06, 1e-7);
}

/* A mass that flies off sloping ground: its height is measured across the ground. */
TEST(height_above_sloping_ground) {
  static const double slopes[] = {0.4, -0.7, 0};
  for (int i = 0; i < 3; i++) {
    const double x = 0.3, y = 1.5, vx = 3, vy = 2.5, height = 0.25;
    OWN(strut_setup) setup = build_setup();
    build_mass(&setup.scene, x, y, 1);
    setup.scene.nodes[0].velocity[0] = vx, setup.scene.nodes[0].velocity[1] = vy;
    build_contact(&setup.scene, 0, 1e4, 0);
    setup.scene.ground.height = height, setup.scene.ground.slope = slopes[i];
    motion_experiment(&setup, 1e-3, 1);
    OWN(strut_summary) s = motion_simulate(&setup);
    double up = (y + vy - height) * cos(slopes[i]) - (x + vx) * sin(slopes[i]);
    assert_near(s.end.contacts[0].max_height, up, 1e-12);
    assert_near(s.end.contacts[0].duty, 0, 0);
  }
}

/* w = 20 rad/s: RK4 bears a step of 0.1414 s. */
static strut_setup stiff(double step, double duration) {
  strut_setup setup = build_tethered(1, 0, 0.5);
  build_member(&setup.scene, STRUT_SPRING, 0, 1, 200, 0, 0);
  setup.scene.nodes[1].start[0] = 1.1;
  motion_experiment(&setup, step, duration);
  return setup;
}

/* Of the latest simulate(). */
static strut_error error;
static strut_summary latest;

static strut_status simulate(const strut_setup *setup, strut_run_options options) {
  error = (strut_error){0};
  strut_summary_free(&latest);
  strut_status status = motion_try(setup, options, &latest, &error);
  assert_int_equal(latest.status, status);
  assert_string_equal(latest.reason, status ? error.message : "");
  return status;
}

AFTER_ALL { strut_summary_free(&latest); }

static const strut_run_options plainly = {0};

TEST(a_step_above_the_limit_is_refused) {
  OWN(strut_setup) setup = stiff(0.142, 1);
  assert_fails(simulate(&setup, plainly), STRUT_STEP_TOO_LARGE, error, "0.142 s", "0.1414 s");
  assert_relative(latest.step_limit, sqrt(8) / 20, 1e-6);
  assert_int_equal(latest.spent.steps, 0);
  setup.experiment.step = 0.141;
  assert_ok(simulate(&setup, plainly));
}

TEST(force_runs_above_the_limit_until_it_diverges) {
  strut_run_options options = {.force = true};
  OWN(strut_setup) setup = stiff(0.142, 0.142 * 20);
  assert_ok(simulate(&setup, options)); /* a short run survives */
  assert_int_equal(latest.spent.steps, 20);
  setup.experiment.step = 0.2, setup.experiment.duration = 1000;
  assert_fails(simulate(&setup, options), STRUT_DIVERGED, error, "node 'n2'", "t = ", "dt = 0.2 s",
               "0.1414 s", "smaller step");
  assert_true(latest.spent.steps > 0 && latest.spent.steps < 5000);
  assert_near(latest.duration, 0.2 * (double)latest.spent.steps, 1e-9);
  assert_int_equal(latest.end.node_count, 2);
  assert_string_equal(latest.end.node_names[1], "n2");
}

/* A mass that is blown away without any instability: beyond 1e10 sizes it is lost. */
TEST(a_mass_that_flies_beyond_all_bounds_is_lost) {
  OWN(strut_setup) setup = stiff(0.01, 100);
  build_mass(&setup.scene, 0, 1, 1);
  setup.scene.nodes[2].velocity[1] = 1e9;
  assert_fails(simulate(&setup, plainly), STRUT_DIVERGED, error, "node 'n3'");
  assert_null(strstr(error.message, "use a smaller step"));
  assert_within(latest.duration, 10, 10 + 64 * 0.01 + 1e-9);
  assert_true(isfinite(latest.end.positions[2]));
}

static strut_flag stop;
static int reported;

static void stop_at_once(void *context, double fraction) {
  assert_ptr_equal(context, &reported);
  assert_within(fraction, 0, 1);
  reported++;
  stop = 1;
}

TEST(an_interrupt_stops_within_a_second) {
  strut_run_options options = {
      .interrupt = &stop, .progress = stop_at_once, .progress_context = &reported};
  stop = 0;
  reported = 0;
  OWN(strut_setup) setup = stiff(1e-3, 1e9);
  assert_int_equal(simulate(&setup, options), STRUT_INTERRUPTED);
  assert_int_equal(reported, 1);
  assert_within(latest.spent.wall_time, 0, 1);
  assert_true(latest.spent.steps > 0);
  assert_near(latest.duration, 1e-3 * (double)latest.spent.steps, 1e-9 * latest.duration);
  assert_true(isfinite(latest.end.positions[2]) && isfinite(latest.energy.residual));
}

/* A weight on a spring, with everything on that settling must leave aside. */
static strut_setup hanging(void) {
  strut_setup setup = build_tethered(0.1, -1, 2);
  int32_t spring = build_sized(&setup.scene, STRUT_SPRING, 0, 1, 300, 1, 0, 1);
  setup.scene.gravity[1] = -9.81;
  build_actuator(&setup.scene, spring, build_sine(&setup.scene, 0.1, 3));
  build_load(&setup.scene, 1, 100, 0, build_sine(&setup.scene, 1, 2));
  build_load(&setup.scene, 1, 0, -4, -1);
  build_rough_contact(&setup.scene, 1, 1e3, 0, 0.5, 0.5, 1e-3);
  setup.scene.ground.height = -5;
  setup.scene.nodes[1].velocity[1] = 1;
  setup.experiment.settle.wanted = true;
  motion_experiment(&setup, 1e-3, 1e-3);
  return setup;
}

TEST(settling_finds_the_static_equilibrium) {
  OWN(strut_setup) setup = hanging();
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_true(s.settle_time > 0);
  assert_int_equal(s.spent.steps, 1);
  assert_near(s.duration, 1e-3, 1e-18);
  /* after one step of 1 ms at 1 m/s: 100 N at 2 Hz moved it by less than 1e-6 m */
  assert_near(s.end.positions[2], 0, 1e-6);
  assert_near(s.end.positions[3], 1e-3 - 1 - (2 * 9.81 + 4) / 300, 1e-5);
  double stored = 150 * pow((2 * 9.81 + 4) / 300, 2) - 2 * 9.81 * (1 + (2 * 9.81 + 4) / 300);
  assert_relative(s.energy.initial, stored + 0.5 * 2, 1e-8);
}

TEST(settling_gives_up_at_its_limit) {
  OWN(strut_setup) setup = hanging();
  setup.experiment.settle.limit = 0.05;
  assert_fails(simulate(&setup, plainly), STRUT_NOT_SETTLED, error, "0.05 s");
}

/* On a slope of 0.2 rad a block rests with mu 0.5 if friction is kept, and without it never. */
TEST(settling_on_a_slope_needs_friction) {
  for (int kept = 0; kept < 2; kept++) {
    OWN(strut_setup) setup = build_falling();
    build_rough_contact(&setup.scene, build_mass(&setup.scene, 0, 0, 1), 1e4, 10, 0.5, 0.5, 1e-3);
    setup.scene.ground.slope = 0.2;
    setup.experiment.step = 1e-4, setup.experiment.duration = 0.01;
    setup.experiment.settle = (strut_settle){
        .wanted = true, .friction = kept, .speed = 1e-8, .acceleration = 1e-6, .limit = 3};
    assert_int_equal(simulate(&setup, plainly), kept ? STRUT_OK : STRUT_NOT_SETTLED);
    if (kept) /* the weight's share across the slope, over the ground's stiffness */
      assert_near(latest.end.positions[0] * sin(0.2) - latest.end.positions[1] * cos(0.2),
                  9.81 * cos(0.2) / 1e4, 1e-9);
    else
      assert_non_null(strstr(error.message, "initial.settle.friction"));
  }
}

TEST(settling_can_be_interrupted) {
  strut_run_options options = {.interrupt = &stop};
  OWN(strut_setup) setup = hanging();
  setup.experiment.settle.limit = 1e9,
  setup.experiment.settle.speed = setup.experiment.settle.acceleration = 1e-30;
  stop = 1;
  assert_int_equal(simulate(&setup, options), STRUT_INTERRUPTED);
  setup.scene.contact_count = 0, setup.scene.ground.present = false;
  setup.scene.members[0].kind = STRUT_CABLE;
  setup.scene.members[0].rest_value = 1e30; /* a free fall, in which nothing ever slows down */
  assert_int_equal(simulate(&setup, options), STRUT_INTERRUPTED);
}

TEST(a_scene_without_mass_or_method_does_not_run) {
  OWN(strut_setup) setup = stiff(1e-3, 1);
  setup.experiment.integrator = "leapfrog";
  assert_fails(simulate(&setup, plainly), STRUT_USAGE, error, "leapfrog");
  setup.experiment.integrator = "rk4";
  setup.scene.nodes[1].mass = 0;
  assert_int_equal(simulate(&setup, plainly), STRUT_SINGULAR);
}
