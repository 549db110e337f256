/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The models of models/basics against their closed forms, computed here from the equations. The
 * numbers repeated here (masses, lengths, ...) are the files' own.
 */
#include <math.h>
#include <stdio.h>

#include "tests/models/run_model.h"
#include "tests/support/check.h"

static const double PI = 3.14159265358979323846, G = 9.81;

TEST(oscillator) {
  const double w = sqrt(100.0 / 1.0), a = 0.01, steps = 10.25 * 200, z = 2 * PI / 200;
  model_run run;
  model_run_file(&run, "basics/oscillator", set_none);
  assert_int_equal(run.summary.spent.steps, 2050);
  /* RK4's phase is late by z^5/120 of a step's angle, its amplitude low by z^6/144. */
  double late = steps * pow(z, 5) / 120;
  assert_relative(run.summary.velocity, -2 * a * w / PI, 2 * late);
  assert_near(model_position(&run, "block")[0], 1, 2 * a * late);
  double kept = pow(1 - pow(z, 6) / 72 + pow(z, 8) / 576, steps);
  double energy = run.summary.energy.kinetic + run.summary.energy.elastic;
  assert_relative(energy, 0.5 * 100 * a * a * kept, 1e-11);
  model_run_free(&run);
}

/* Half the period of a complete swing's elliptic integral: pi / (2 agm(1, k')). */
static double complete_elliptic(double modulus) {
  double a = 1, b = sqrt(1 - modulus * modulus);
  for (int i = 0; i < 8; i++) {
    double mean = 0.5 * (a + b);
    b = sqrt(a * b), a = mean;
  }
  return PI / (2 * a);
}

TEST(pendulum) {
  double period = 4 * sqrt(2 * 1.0 / (3 * G)) * complete_elliptic(sin(PI / 4)), error[2];
  const char *stiffness[] = {"stiffness=1e6", "stiffness=1e7"};
  for (int i = 0; i < 2; i++) {
    model_run run;
    model_run_file(&run, "basics/pendulum", set_to(stiffness[i]));
    const double *tip = model_position(&run, "tip");
    error[i] = hypot(tip[0], tip[1] + 1);
    assert_relative(run.summary.velocity, -4 * 1.0 / period, 2e-4);
    assert_relative(run.summary.energy.kinetic, 0.5 * G, 1e-4);
    model_run_free(&run);
  }
  assert_true(error[0] < 2e-4); /* the rigid rod's answer, to the bar's own give, ... */
  assert_within(error[0] / error[1], 7, 13); /* ... which falls as 1 / stiffness */
}

TEST(spinning_bar) {
  const double spin = 2 * PI * 2, time = 10 / 2.0, speed = 1.5;
  double length = 1 / (1 - 1.2 * spin * spin / (12 * 1000));
  model_run run;
  model_run_file(&run, "basics/spinning-bar", set_none);
  const double *a = model_position(&run, "a"), *b = model_position(&run, "b");
  assert_near(0.5 * (a[0] + b[0]), speed * time, 1e-11);
  assert_near(0.5 * (a[1] + b[1]), -0.5 * G * time * time, 1e-10);
  assert_relative(hypot(b[0] - a[0], b[1] - a[1]), length, 1e-10);
  assert_near(atan2(b[1] - a[1], b[0] - a[0]), 0, 1e-8); /* whole turns */
  assert_relative(run.summary.velocity, speed, 1e-12);
  model_run_free(&run);
}

/* Height and speed of the first bounce: damped sine in, undamped sine out, gravity in both. */
static double bounce_height(double zeta, double *arrival, double *departure) {
  const double w = 100, rest = -G / (w * w), wd = w * sqrt(1 - zeta * zeta);
  *arrival = sqrt(2 * G * 0.1);
  double a = -rest, b = (-*arrival + zeta * w * a) / wd;
  double t = atan2(b * wd - zeta * w * a, a * wd + zeta * w * b) / wd; /* where it turns */
  if (t < 0) t += PI / wd;
  double deepest = rest + exp(-zeta * w * t) * (a * cos(wd * t) + b * sin(wd * t));
  *departure = w * sqrt((deepest - rest) * (deepest - rest) - rest * rest);
  return *departure * *departure / (2 * G);
}

TEST(bouncing_node) {
  static const struct {
    const char *set;
    double step;
  } cases[] = {{"step=1e-4", 1e-4}, {"step=1e-5", 1e-5}, {"step=1e-6", 1e-6}};
  double arrival, departure, height = bounce_height(0.1, &arrival, &departure);
  for (int i = 0; i < 3; i++) {
    model_run run;
    model_run_file(&run, "basics/bouncing-node", set_to(cases[i].set));
    /* The damper's jump, damping * arrival, is seen up to a step late. */
    double late = 2 * 0.1 * 100 * arrival * cases[i].step;
    assert_near(run.summary.end.contacts[0].max_height, height, departure / G * late);
    model_run_free(&run);
  }
}

TEST(sliding_block) {
  double way = 1 / (2 * 0.2 * G), time = 1 / (0.2 * G), step = 1e-4, band = 1e-4;
  model_run run;
  model_run_file(&run, "basics/sliding-block", set_none);
  double most = 1.0 * step + band * (1 - time); /* a step at full speed, then the band's drift */
  assert_near(model_position(&run, "block")[0], way, most);
  assert_near(run.summary.velocity, way, most);
  assert_near(run.summary.energy.dissipated_friction, 0.5, 0.2 * G * most);
  model_run_free(&run);
}

TEST(slope) {
  static const struct {
    const char *set;
    double mu, tolerance;
  } cases[] = {{"mu=0.37", 0.37, 0},
               {"mu=0.36398", 0.36398, 0},
               {"mu=0.36396", 0.36396, 1e-6},
               {"mu=0.36", 0.36, 1e-9},
               {"mu=0", 0, 1e-9}};
  const double angle = 20 * PI / 180;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    double a = G * (sin(angle) - cases[i].mu * cos(angle));
    double exact = a > 0 ? -0.5 * a * cos(angle) : 0;
    model_run run;
    model_run_file(&run, "basics/slope", set_to(cases[i].set));
    assert_near(run.summary.velocity, exact, 1e-14 - exact * cases[i].tolerance);
    model_run_free(&run);
  }
}

/* Least and largest x of the block from the first row on. */
static void swing(const model_run *run, double *low, double *high) {
  *low = HUGE_VAL, *high = -HUGE_VAL;
  for (size_t i = 0; i < run->row_count; i++) {
    double x = model_value(run, i, STRUT_CHANNEL_POSITION, "block", 0);
    *low = fmin(*low, x), *high = fmax(*high, x);
  }
}

TEST(belt) {
  const double belt_speed = 0.1, w = 10, offset = (2 - 1) / 100.0, middle = 1 / 100.0;
  double reach = hypot(offset, belt_speed / w), low, high, error[2];
  for (int i = 0; i < 2; i++) {
    model_run run;
    model_run_file(&run, "basics/belt",
                   i ? set_to("step=1e-5", "band=0.01 mm/s") : set_to("step=1e-4"));
    error[i] = model_position(&run, "block")[0] - offset;
    assert_near(run.summary.velocity, belt_speed, 1e-3 * belt_speed);
    swing(&run, &low, &high);
    assert_near(low, middle - reach, 0.02 * reach);
    assert_near(high, middle + reach, 0.02 * reach);
    model_run_free(&run);
  }
  assert_near(error[0], 0, 2e-4);
  assert_true(fabs(error[1]) < fabs(error[0]) / 4);
}

/* Put on at once, a smaller load is enough: the largest of k (L0 - L)^2 / (h - y) over y. */
TEST(von_mises_truss_at_once) {
  double most = 0;
  for (double y = -0.3; y < 0.2999; y += 1e-5) {
    double shorter = hypot(1, 0.3) - hypot(1, y);
    most = fmax(most, 1000 * shorter * shorter / (0.3 - y));
  }
  for (int i = 0; i < 2; i++) {
    model_run run;
    model_read(&run, "basics/von-mises-truss", set_none);
    run.setup.experiment.settle.wanted = false;
    run.setup.experiment.duration = 5;
    run.setup.scene.loads[0].force[1] = -most * (i ? 1.001 : 0.999);
    model_simulate(&run);
    double lowest = 1;
    for (size_t row = 0; row < run.row_count; row++)
      lowest = fmin(lowest, model_value(&run, row, STRUT_CHANNEL_POSITION, "apex", 1));
    assert_true(i ? lowest < -0.3 : lowest > 0);
    model_run_free(&run);
  }
}
