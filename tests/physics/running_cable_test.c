/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Running cables: one tension over all segments, in rest and in motion, against closed forms. */
#include "tests/models/run_model.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"

static const double G = 9.81;

/* Two weights over a guide; the string's stretch is at rest, or starts with half of that. */
static const char atwood[] =
    "parameters: {k: 1e6, m1: 3, m2: 2, stretch: 0}\n"
    "nodes: {left: {position: [0, -1], mass: m1}, guide: {position: [0, 0], fixed: both},\n"
    "        right: {position: [0, -2], mass: m2}}\n"
    "members:\n"
    "  string: {kind: cable, nodes: [left, guide, right], stiffness: k, rest_length: 3 - stretch}\n"
    "gravity: [0, -9.81]\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 0.4 s}\n";

/* m1 y1 - m2 y2 falls freely with m1 - m2 whatever the string does, and its stretch oscillates. */
TEST(two_weights_over_a_guide) {
  static const char *const methods[] = {"rk4", "rk4-events", "adaptive", "verlet-events"};
  static const double tolerance[] = {1e-10, 1e-10, 1e-6, 1e-6};
  const double m1 = 3, m2 = 2, k = 1e4, t = 0.4;
  const double rest = 2 * G * m1 * m2 / (m1 + m2) / k, w = sqrt(k * (1 / m1 + 1 / m2));
  for (int start = 0; start < 2; start++)
    for (int i = 0; i < 4; i++) {
      OWN(model_run) run = model_read_text(
          "atwood", atwood,
          set_to("k=1e4", start ? "stretch=9.81*2*6/5/1e4" : "stretch=9.81*6/5/1e4"));
      model_simulate_by(&run, methods[i]);
      double stretch = rest - (start ? 0 : rest / 2 * cos(w * t)),
             natural = 3 - (start ? rest : rest / 2);
      double free = m1 * 1 - m2 * 2 + (m1 - m2) * G * t * t / 2, sum = natural + stretch;
      double left = (free + m2 * sum) / (m1 + m2);
      assert_near(model_position(&run, "left")[1], -left, tolerance[i]);
      assert_near(model_position(&run, "right")[1], left - sum, tolerance[i]);
      assert_near(run.summary.energy.residual, 0, tolerance[i] * run.summary.energy.moved * 100);
    }
}

/* The lighter weight is at the guide after sqrt(2 h / a), where the run ends: it would be pulled through. */
TEST(a_weight_at_its_guide_ends_the_run) {
  static const char *const methods[] = {"rk4-events", "adaptive", "adaptive8", "verlet-events"};
  for (int i = 0; i < 8; i++) {
    OWN(model_run) run = model_read_text("atwood", atwood, set_to("k=1e4"));
    strut_error error = {0};
    run.setup.experiment.integrator = methods[i % 4], run.setup.experiment.duration = 2;
    run.setup.experiment.step = i < 4 ? 1e-4 : 1e-2;
    assert_fails(motion_try(&run.setup, (strut_run_options){0}, &run.summary, &error),
                 STRUT_DIVERGED, error, "'guide' and 'right' meet at (0, 0) m at t = 1.4");
  }
}

/* The acceleration (m1 - m2) g / (m1 + m2) is met as the string gets stiffer. */
TEST(stiffer_strings_fall_as_atwoods) {
  static const char *const k[] = {"k=1e3", "k=1e4", "k=1e5", "k=1e6"};
  for (int i = 0; i < 4; i++) {
    OWN(model_run) run = model_read_text("atwood", atwood, set_to(k[i]));
    model_simulate(&run);
    double fallen = -1 - model_position(&run, "left")[1], stiffness = pow(10, 3 + i);
    double stretch = 2 * G * 6 / 5 / stiffness; /* at rest; twice that at most */
    assert_within(fallen - 0.5 * G / 5 * 0.16, 0, 2 * stretch * 2 / 5 * 1.0000001);
  }
}

/* A weight swings on a string over two guides, tied to a second one; all stays taut. */
static const char swing[] =
    "nodes: {a: {position: [-1, -1], mass: 2}, p: {position: [-0.5, 0], fixed: both},\n"
    "        ring: {position: [0.1, -0.6], mass: 3}, q: {position: [0.7, 0], fixed: both},\n"
    "        b: {position: [1, -1.2], mass: 2}}\n"
    "members:\n"
    "  string: {kind: cable, nodes: [a, p, ring, q, b], stiffness: 2000, pretension: 20, mass: "
    "0.3}\n"
    "gravity: [0, -9.81]\n"
    "initial: {velocities: {a: [0.2, 0], ring: [0.3, 0.1]}}\n"
    "solver: {step: 2 ms}\n"
    "run: {duration: 1 s}\n";

static double residual_of(const char *method, double step) {
  OWN(model_run) run = model_read_text("swing", swing, set_none);
  run.setup.experiment.integrator = method;
  run.setup.experiment.step = step;
  model_simulate(&run);
  double residual = fabs(run.summary.energy.residual);
  assert_true(run.summary.energy.dissipated_members == 0);
  assert_true(run.summary.spent.events == 0); /* so that no method has a kink to step over */
  return residual;
}

TEST(energy_is_kept_at_the_methods_order) {
  static const struct {
    const char *method;
    double low, high;
  } known[] = {
      {"rk4", 3.7, 5.5}, {"rk4-events", 3.7, 5.5}, {"verlet", 1.8, 3}, {"verlet-events", 1.8, 3}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    double error[4];
    for (int k = 0; k < 4; k++) error[k] = residual_of(known[i].method, ldexp(2e-3, -k));
    assert_within(observed_order(error, 4), known[i].low, known[i].high);
  }
  assert_true(residual_of("midpoint", 2e-3) < 1e-10); /* keeps it at any step */
  assert_true(residual_of("adaptive", 2e-3) < 1e-3);
}

/* A ring on a string between level ends swings to rest at the bottom of an ellipse. */
static const char ring[] =
    "nodes: {a: {position: [0, 0], fixed: both}, ring: {position: [0.3, -0.4], mass: 1},\n"
    "        b: {position: [1, 0], fixed: both}}\n"
    "members:\n"
    "  string: {kind: cable, nodes: [a, ring, b], stiffness: 1e4, damping: 50, rest_length: 1.4}\n"
    "  drag: {kind: spring, nodes: [a, ring], damping: 5}\n"
    "gravity: [0, -9.81]\n"
    "initial: {settle: yes}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 1 ms}\n"
    "output: {channels: [force, length]}\n";

TEST(a_ring_rests_at_the_bottom_of_its_ellipse) {
  OWN(model_run) run = model_read_text("ring", ring, set_none);
  model_simulate(&run);
  double force = model_value(&run, 0, STRUT_CHANNEL_FORCE, "string", 0);
  double length = model_value(&run, 0, STRUT_CHANNEL_LENGTH, "string", 0);
  assert_relative(length, 1.4 + force / 1e4, 1e-9);
  assert_relative(force, G / (2 * sqrt(1 - 1 / (length * length))), 1e-7);
  assert_near(model_position(&run, "ring")[0], 0.5, 1e-6);
  assert_near(model_position(&run, "ring")[1], -0.5 * sqrt(length * length - 1), 1e-6);
}
