/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy balance judged: open where energy comes from nowhere, with the cause; else not a word. */
#include "engine/run/measure/measure.h"
#include "tests/support/motion.h"

static const char *said(const strut_summary *s) {
  for (size_t i = 0; i < s->warning_count; i++)
    if (!strcmp(s->warnings[i].code, "energy_balance")) return s->warnings[i].text;
  return NULL;
}

static void assert_says(const strut_summary *s, const char *words) {
  const char *text = said(s);
  if (!text)
    fail_msg("no word of the balance, residual %g of %g", s->energy.residual, s->energy.moved);
  if (!strstr(text, words)) fail_msg("'%s' is not in: %s", words, text);
}

/* A mass that bounces on hard ground: 1 J comes down. */
static strut_summary bounce(const char *method, double step) {
  OWN(strut_setup) setup = build_setup();
  setup.scene.gravity[1] = -10;
  build_mass(&setup.scene, 0, 0.1, 1);
  build_contact(&setup.scene, 0, 1e5, 0);
  motion_experiment_by(&setup, step, 1, method);
  return motion_simulate(&setup);
}

/* Without losses its energy at the end is that at the start: known without the energy balance. */
TEST(steps_over_touchdowns) {
  strut_summary s = bounce("rk4", 2e-3);
  double end = s.energy.kinetic + s.energy.gravity + s.energy.contact;
  assert_true(fabs(end - 1) > 0.02);
  assert_near(s.energy.residual, end - 1, 1e-12);
  assert_int_equal(s.balance, STRUT_BALANCE_OPEN);
  assert_says(&s, "touchdowns");
  assert_says(&s, "rk4-events");
  strut_summary_free(&s);
  s = bounce("rk4-events", 5e-4);
  assert_int_equal(s.balance, STRUT_BALANCE_CLOSED);
  assert_null(said(&s));
  strut_summary_free(&s);
}

/* A cable that lets go at 0.2 s: within one step, or in 0.1 s. */
static strut_summary let_go(double takes) {
  OWN(strut_setup) setup = build_tethered(0.2, 0, 0.1);
  double time[] = {0, 0.2, 0.2 + takes}, value[] = {0, 0, 0.3};
  strut_signal signal = strut_signal_default(STRUT_TABLE);
  build_sized(&setup.scene, STRUT_SPRING, 0, 1, 200, 0.01, 0, 0.4);
  build_sized(&setup.scene, STRUT_CABLE, 0, 1, 1e4, 5, 0, 0.196);
  signal.point_count = 3;
  signal.time = build_numbers(&setup.scene, time, 3),
  signal.value = build_numbers(&setup.scene, value, 3);
  build_actuator(&setup.scene, 1, build_signal(&setup.scene, signal));
  motion_experiment(&setup, 1e-4, 1);
  return motion_simulate(&setup);
}

TEST(a_drive_that_jumps) {
  strut_summary s = let_go(1e-5);
  assert_int_equal(s.balance, STRUT_BALANCE_OPEN);
  assert_says(&s, "the drive of member 'm2'");
  assert_says(&s, "0.3 m within one step at t = 0.2 s");
  assert_says(&s, "by t = 0.20");
  strut_summary_free(&s);
  s = let_go(0.3);
  assert_int_equal(s.balance, STRUT_BALANCE_CLOSED);
  assert_null(said(&s));
  strut_summary_free(&s);
}

/* A run that ends where its drive jumps: methods with events have accumulated that jump, whatever rounding says. */
TEST(a_run_that_ends_at_a_jump) {
  static const char *const methods[] = {"rk4-events", "adaptive"};
  for (size_t i = 0; i < 2; i++)
    for (int periods = 1; periods < 12; periods++) {
      OWN(strut_setup) setup = build_tethered(1, 0, 1);
      strut_signal signal = strut_signal_default(STRUT_SQUARE);
      build_member(&setup.scene, STRUT_SPRING, 0, 1, 1000, 3, 0);
      signal.amplitude = 0.01152;
      signal.frequency = 6.99;
      build_actuator(&setup.scene, 0, build_signal(&setup.scene, signal));
      motion_experiment_by(&setup, 1e-3, periods / signal.frequency, methods[i]);
      setup.experiment.tolerance = 1e-9;
      OWN(strut_summary) s = motion_simulate(&setup);
      assert_near(s.energy.residual, 0, 1e-7);
    }
}

/* A free swing that ends where it began: nothing seems to have moved, and the error is small. */
TEST(a_swing_that_ends_as_it_began) {
  OWN(strut_setup) setup = build_tethered(1.1, 0, 1);
  build_sized(&setup.scene, STRUT_SPRING, 0, 1, 100, 0, 0, 1);
  double period = 2 * acos(-1) / 10;
  motion_experiment(&setup, period / 40, 10 * period);
  OWN(strut_summary) s = motion_simulate(&setup);
  assert_within(fabs(s.energy.residual), 1e-5 * 0.5, 1e-3 * 0.5);
  assert_within(s.energy.moved, 0.45, 0.51); /* half of 100 N/m times 0.1 m squared */
  assert_all_equal(s.balance, STRUT_BALANCE_CLOSED, s.warning_count, 0);
}

/* What stands still loses or gains what rounding does, which is all that moves. */
TEST(rest_is_no_open_balance) {
  strut_energy e = {.elastic = 0.45, .initial = 0.45, .residual = -6e-16, .moved = 6e-16};
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_CLOSED);
  e.residual = -6e-9, e.moved = 6e-9;
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_OPEN);
  e = (strut_energy){.residual = 0.0101, .moved = 1, .kinetic = 1};
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_OPEN);
  e.residual = -0.0099;
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_CLOSED);
}

TEST(without_a_balance_nothing_is_said) {
  OWN(strut_setup) setup = build_setup();
  setup.scene.gravity[1] = -10;
  build_mass(&setup.scene, 0, 0.1, 1);
  build_contact(&setup.scene, 0, 1e5, 0);
  motion_experiment(&setup, 2e-3, 1);
  OWN(strut_summary) s;
  assert_ok(motion_try(&setup, (strut_run_options){.without_balance = true}, &s, NULL));
  assert_all_equal(s.balance, STRUT_BALANCE_NOT_KEPT, s.warning_count, 0);
}

/* ---- losses ---- */

/* A mass on a one-sided spring whose damper drives it. */
static void build_driving_damper(strut_scene *scene) {
  build_support(scene, 0, 0);
  build_mass(scene, 1, 0, 1);
  int32_t j = build_sized(scene, STRUT_SPRING, 0, 1, 100, -1, 0, 0.9);
  scene->members[j].law = (strut_law){.kind = STRUT_LAW_PLAY, .gap = 0.01};
}

/* A ball on ground whose damper throws it. */
static void build_driving_ground(strut_scene *scene) {
  scene->gravity[1] = -10;
  build_mass(scene, 0, 0.1, 1);
  build_contact(scene, 0, 1e4, 0);
  scene->contacts[0].damping = -5;
}

/* A block that slides on ground that pushes it. */
static void build_driving_friction(strut_scene *scene) {
  scene->gravity[1] = -10;
  build_mass(scene, 0, -1e-3, 1);
  build_rough_contact(scene, 0, 1e4, 10, 0.5, 0.5, 1e-3);
  scene->contacts[0].friction.mu_kinetic = -0.5;
  scene->nodes[0].velocity[0] = 1;
}

/* No valid scene has these; methods that go wrong do. Scenes are not checked here. */
TEST(a_loss_that_gives_ends_the_run) {
  static const char *const methods[] = {"rk4",        "euler",    "verlet",
                                        "rk4-events", "adaptive", "verlet-events"};
  static void (*const builders[])(strut_scene *) = {build_driving_damper, build_driving_ground,
                                                    build_driving_friction};
  static const char *const words[] = {"the dampers of members gave", "the ground's dampers gave",
                                      "friction gave"};
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
      OWN(strut_setup) setup = build_setup();
      strut_model *model;
      strut_summary s;
      strut_error error = {0};
      builders[k](&setup.scene);
      motion_experiment_by(&setup, 5e-4, 1, methods[i]);
      for (int forced = 0; forced < 2; forced++) {
        const strut_run_options options = {.force = forced};
        assert_ok(strut_model_compile(&setup.scene, &model, NULL));
        strut_status status = strut_simulate(model, &setup.experiment, &options, &s, &error);
        assert_int_equal(status, forced ? STRUT_OK : STRUT_DIVERGED);
        if (!forced && !strstr(error.message, words[k]))
          fail_msg("%s said: %s", methods[i], error.message);
        assert_int_equal(s.status, status);
        assert_true(forced ? s.spent.steps == 2000 : s.spent.steps > 0 && s.spent.steps < 2000);
        strut_summary_free(&s);
        strut_model_free(model);
      }
    }
}

/* A ball on a spring that bounces on ground of any roughness: sliding ends as it touches. */
TEST(friction_of_any_size_only_takes) {
  static const char *const methods[] = {"rk4-events", "adaptive", "verlet-events"};
  static const double mu[] = {1e6, 2e8, 1e9};
  double right = 0;
  for (size_t i = 0; i < 3; i++)
    for (size_t k = 0; k < 3; k++) {
      OWN(strut_setup) setup = build_setup();
      strut_scene *scene = &setup.scene;
      scene->gravity[1] = -9.81;
      build_support(scene, 0, 0);
      build_mass(scene, 1, 0.01, 1);
      build_member(scene, STRUT_SPRING, 0, 1, 100, 0.1, 0);
      scene->nodes[1].velocity[0] = 0.1;
      build_rough_contact(scene, 1, 1e5, 10, mu[k], mu[k], 0);
      scene->contacts[0].friction.law = STRUT_FRICTION_COULOMB;
      motion_experiment_by(&setup, 1e-4, 1, methods[i]);
      OWN(strut_summary) s = motion_simulate(&setup);
      if (right == 0) right = s.energy.dissipated_friction;
      assert_within(s.energy.dissipated_friction, 0, 0.5 * 0.1 * 0.1);
      assert_relative(s.energy.dissipated_friction, right, 1e-4);
      assert_near(s.energy.residual, 0, 1e-6);
    }
}
