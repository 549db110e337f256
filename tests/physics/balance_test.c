/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy balance judged: open where energy comes from nowhere, with the cause; else not a word. */
#include <math.h>
#include <string.h>

#include "engine/run/measure/balance.h"
#include "tests/support/build.h"
#include "tests/support/check.h"
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
  strut_setup setup;
  strut_setup_init(&setup);
  setup.scene.gravity[1] = -10;
  build_mass(&setup.scene, 0, 0.1, 1);
  build_contact(&setup.scene, 0, 1e5, 0);
  motion_experiment(&setup, step, 1);
  setup.experiment.integrator = method;
  strut_summary s = motion_simulate(&setup);
  strut_setup_free(&setup);
  return s;
}

/* Without losses its energy at the end is that at the start: known without the ledger. */
static void test_steps_over_touchdowns(void **unused) {
  (void)unused;
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
  strut_setup setup;
  double time[] = {0, 0.2, 0.2 + takes}, value[] = {0, 0, 0.3};
  strut_signal signal = strut_signal_default(STRUT_TABLE);
  strut_setup_init(&setup);
  build_support(&setup.scene, 0, 0);
  build_mass(&setup.scene, 0.2, 0, 0.1);
  build_sized(&setup.scene, STRUT_SPRING, 0, 1, 200, 0.01, 0, 0.4);
  build_sized(&setup.scene, STRUT_CABLE, 0, 1, 1e4, 5, 0, 0.196);
  signal.point_count = 3;
  signal.time = build_numbers(&setup.scene, time, 3),
  signal.value = build_numbers(&setup.scene, value, 3);
  build_actuator(&setup.scene, 1, build_signal(&setup.scene, signal));
  motion_experiment(&setup, 1e-4, 1);
  strut_summary s = motion_simulate(&setup);
  strut_setup_free(&setup);
  return s;
}

static void test_a_drive_that_jumps(void **unused) {
  (void)unused;
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

/* A free swing that ends where it began: nothing seems to have moved, and the error is small. */
static void test_a_swing_that_ends_as_it_began(void **unused) {
  (void)unused;
  strut_setup setup;
  strut_setup_init(&setup);
  build_support(&setup.scene, 0, 0);
  build_mass(&setup.scene, 1.1, 0, 1);
  build_sized(&setup.scene, STRUT_SPRING, 0, 1, 100, 0, 0, 1);
  double period = 2 * acos(-1) / 10;
  motion_experiment(&setup, period / 40, 10 * period);
  strut_summary s = motion_simulate(&setup);
  assert_within(fabs(s.energy.residual), 1e-5 * 0.5, 1e-3 * 0.5);
  assert_within(s.energy.moved, 0.45, 0.51); /* half of 100 N/m times 0.1 m squared */
  assert_int_equal(s.balance, STRUT_BALANCE_CLOSED);
  assert_int_equal(s.warning_count, 0);
  strut_summary_free(&s);
  strut_setup_free(&setup);
}

/* What stands still loses or gains what rounding does, which is all that moves. */
static void test_rest_is_no_open_balance(void **unused) {
  (void)unused;
  strut_energy e = {.elastic = 0.45, .initial = 0.45, .residual = -6e-16, .moved = 6e-16};
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_CLOSED);
  e.residual = -6e-9, e.moved = 6e-9;
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_OPEN);
  e = (strut_energy){.residual = 0.0101, .moved = 1, .kinetic = 1};
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_OPEN);
  e.residual = -0.0099;
  assert_int_equal(strut_balance_judge(&e, 200), STRUT_BALANCE_CLOSED);
}

static void test_without_a_ledger_nothing_is_said(void **unused) {
  (void)unused;
  strut_setup setup;
  strut_setup_init(&setup);
  setup.scene.gravity[1] = -10;
  build_mass(&setup.scene, 0, 0.1, 1);
  build_contact(&setup.scene, 0, 1e5, 0);
  motion_experiment(&setup, 2e-3, 1);
  strut_model *model = motion_compile(&setup.scene);
  const strut_run_options options = {.without_ledger = true};
  strut_summary s;
  assert_int_equal(strut_simulate(model, &setup.experiment, &options, &s, NULL), STRUT_OK);
  assert_int_equal(s.balance, STRUT_BALANCE_NOT_KEPT);
  assert_int_equal(s.warning_count, 0);
  strut_summary_free(&s);
  strut_model_free(model);
  strut_setup_free(&setup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_steps_over_touchdowns),
      cmocka_unit_test(test_a_drive_that_jumps),
      cmocka_unit_test(test_a_swing_that_ends_as_it_began),
      cmocka_unit_test(test_rest_is_no_open_balance),
      cmocka_unit_test(test_without_a_ledger_nothing_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
