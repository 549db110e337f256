/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A structure that becomes stiffer than it was at its start, and a step that then no longer suits. */
#include "engine/integrate/limit/step_limit.h"
#include "tests/support/motion.h"

static const double STIFFNESS = 1000, MASS = 2, REST = 0.6, STROKE = 0.3, FREQUENCY = 0.002;
static const double PI = 3.14159265358979323846;

/*
 * A mass between two springs of length 1 that can move across them only: w^2 = 2 t / (L m) with the
 * tension t. Actuators shorten the springs' rest lengths slowly, so that w grows from 20 to 26.5
 * rad/s within a quarter of their period.
 */
static strut_setup tightening(const char *method, double step) {
  strut_setup setup = build_setup();
  build_support(&setup.scene, -1, 0);
  build_support(&setup.scene, 1, 0);
  build_mass(&setup.scene, 0, 0, MASS);
  setup.scene.nodes[2].fixed[0] = true;
  setup.scene.nodes[2].velocity[1] = 1e-30; /* small until it is seen */
  int32_t signal = build_sine(&setup.scene, -STROKE, FREQUENCY);
  for (int32_t i = 0; i < 2; i++)
    build_actuator(&setup.scene,
                   build_sized(&setup.scene, STRUT_SPRING, i, 2, STIFFNESS, 0, 0, REST), signal);
  setup.experiment.integrator = method;
  motion_experiment(&setup, step, 0.5 / FREQUENCY);
  return setup;
}

/* When w has reached so much [s]. */
static double when(double omega) {
  double tension = omega * omega * MASS / 2, stroke = tension / STIFFNESS - (1 - REST);
  return asin(stroke / STROKE) / (2 * PI * FREQUENCY);
}

static strut_status run(const strut_setup *setup, bool force, strut_summary *s, strut_error *e) {
  *e = (strut_error){0};
  return motion_try(setup, (strut_run_options){.force = force}, s, e);
}

static const char *const METHODS[] = {"rk4",        "verlet",        "euler",
                                      "rk4-events", "verlet-events", "euler-events"};

static void check(const char *name) {
  const strut_integrator *method = strut_integrator_find(name);
  double reach = method->region == STRUT_REGION_RK4 ? 2 * sqrt(2) : 2, step = reach / 23.5;
  double looks = 2 * 256 / method->evaluations * step, crossing = when(23.5);
  strut_summary s;
  strut_error error;
  OWN(strut_setup) setup = tightening(name, step);
  assert_fails(run(&setup, false, &s, &error), STRUT_DIVERGED, error, "t = ");
  assert_relative(s.step_limit, reach / 20, 1e-6);
  if (s.limit_fell.limit > 0) {
    assert_non_null(strstr(error.message, "use solver.step <= "));
    assert_within(s.limit_fell.since, crossing, crossing + looks);
    assert_within(s.limit_fell.limit, reach / 26.5, step);
  } else { /* all happened between two looks; the last one saw it coming */
    const char *last = strstr(error.message, ", at t = ");
    double time = last ? strtod(last + 9, NULL) : 0;
    assert_non_null(strstr(error.message, "use a smaller step"));
    assert_within(time, crossing - looks, crossing);
  }
  assert_true(s.duration < 0.5 / FREQUENCY);
  double stopped = s.duration;
  strut_summary_free(&s);
  strut_status status = run(&setup, true, &s, &error); /* --force: to the end, or out of bounds */
  assert_all(status == STRUT_OK || strstr(error.message, "node 'n3'"), s.duration >= stopped);
  strut_summary_free(&s);
  setup.experiment.step = 0.99 * reach / 26.46;
  assert_ok(run(&setup, false, &s, &error));
  assert_true(s.limit_fell.limit == 0);
  strut_summary_free(&s);
}

TEST(a_structure_that_tightens) {
  for (size_t i = 0; i < sizeof METHODS / sizeof METHODS[0]; i++) check(METHODS[i]);
}
