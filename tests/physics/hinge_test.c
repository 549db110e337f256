/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hinges in motion: torsion over several turns, a pendulum with a hinge, works of a driven hinge. */
#include "tests/models/run_model.h"
#include "tests/support/check.h"

static const double PI = 3.14159265358979323846, G = 9.81;

/* An arm that a hinge turns back from three turns and a half: it oscillates as a linear oscillator. */
static const char rotor[] =
    "parameters: {k: 1e6, start: 22 rad}\n"
    "nodes: {ground: {position: [1, 0], fixed: both}, pivot: {position: [0, 0], fixed: both},\n"
    "        tip: {position: [0.5, 0], mass: 2}}\n"
    "members: {arm: {kind: bar, nodes: [pivot, tip], stiffness: k}}\n"
    "hinges: {h: {nodes: [ground, pivot, tip], stiffness: 0.3, rest_angle: 0}}\n"
    "initial: {velocities: {tip: [0, 4]}}\n"
    "solver: {step: 0.05 ms}\n"
    "run: {duration: 1 s}\n"
    "output: {channels: [position]}\n";

/* Amplitude = speed / (arm omega), omega^2 = kappa / (m arm^2): ten radians. */
TEST(an_arm_turns_several_times_against_its_hinge) {
  static const char *const methods[] = {"rk4", "rk4-events", "adaptive", "verlet-events",
                                        "midpoint"};
  const double omega = sqrt(0.3 / (2 * 0.25)), amplitude = 4 / 0.5 / omega;
  assert_true(amplitude > 10);
  for (int i = 0; i < 5; i++) {
    OWN(model_run) run = model_read_text("rotor", rotor, set_none);
    run.setup.experiment.integrator = methods[i];
    run.setup.experiment.duration =
        1.5 * PI / omega; /* all the way back, and on to the other side */
    run.setup.experiment.step = run.setup.experiment.duration / 1e5;
    model_simulate(&run);
    double angle = -amplitude; /* the bar gives way by m v^2 / (r k): 3e-5 of its length at most */
    assert_near(model_position(&run, "tip")[0], 0.5 * cos(angle), 1e-3);
    assert_near(model_position(&run, "tip")[1], 0.5 * sin(angle), 1e-3);
    assert_relative(run.summary.energy.elastic, 0.5 * 0.3 * angle * angle, 1e-3);
    assert_near(run.summary.energy.residual, 0, 1e-5 * run.summary.energy.moved);
  }
}

/* A pendulum with a hinge at its pivot, swinging little: omega^2 = kappa / (m l^2) + g / l. */
static const char pendulum[] =
    "nodes: {top: {position: [0, 1], fixed: both}, pivot: {position: [0, 0], fixed: both},\n"
    "        bob: {position: [0, -0.5], mass: 2}}\n"
    "members: {rod: {kind: bar, nodes: [pivot, bob], stiffness: 1e7}}\n"
    "hinges: {h: {nodes: [top, pivot, bob], stiffness: 3, rest_angle: 180 deg}}\n"
    "gravity: [0, -9.81]\n"
    "initial: {positions: {bob: [0.5 * sin(1e-4), -0.5 * cos(1e-4)]}}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 1 s}\n";

TEST(a_pendulum_with_a_hinge) {
  const double omega = sqrt(3 / (2 * 0.25) + G / 0.5);
  OWN(model_run) run = model_read_text("pendulum", pendulum, set_none);
  run.setup.experiment.duration = 2.25 * 2 * PI / omega;
  run.setup.experiment.step = run.setup.experiment.duration / 1e5;
  model_simulate(&run);
  assert_near(model_position(&run, "bob")[0], 0, 5e-5 * 1e-4);
}

/* Both arms held: the drive works against the hinge alone, and in a whole period not at all. */
static const char held[] =
    "parameters: {c: 0}\n"
    "nodes: {a: {position: [1, 0], fixed: both}, b: {position: [0, 0], fixed: both},\n"
    "        c: {position: [0, 1], fixed: both}, free: {position: [2, 0], mass: 1}}\n"
    "members: {m: {kind: spring, nodes: [a, free], stiffness: 1}}\n"
    "hinges: {h: {nodes: [a, b, c], stiffness: 3, damping: c, rest_angle: 70 deg}}\n"
    "actuators: {motor: {hinge: h, signal: {sine: {amplitude: 0.4 rad, frequency: 2 Hz}}}}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 0.5 s}\n";

TEST(a_driven_hinge_between_held_arms) {
  for (int damped = 0; damped < 2; damped++)
    for (int quarter = 1; quarter <= 4; quarter++) {
      const double c = damped ? 0.02 : 0, w = 4 * PI, t = quarter * 0.125;
      OWN(model_run) run = model_read_text("held", held, set_to(damped ? "c=0.02" : "c=0"));
      run.setup.experiment.duration = t;
      model_simulate(&run);
      const strut_energy *e = &run.summary.energy;
      double rest0 = 70 * PI / 180, rest = rest0 + 0.4 * sin(w * t);
      double before = PI / 2 - rest0, after = PI / 2 - rest;
      double lost = c * 0.16 * w * w * t / 2; /* of whole quarters */
      assert_near(e->elastic, 1.5 * after * after, 1e-12);
      assert_all_near(1e-11, e->dissipated_members, lost, e->drive_work,
                      1.5 * (after * after - before * before) + lost, e->residual, 0);
    }
}

/* A driven leg between masses: whatever it does, drive work = energy gained + dissipated. */
static const char leg[] =
    "nodes: {hip: {position: [0, 0], mass: 1}, knee: {position: [0.3, -0.4], mass: 0.2},\n"
    "        foot: {position: [0, -0.8], mass: 0.1}, pin: {position: [-1, 0], fixed: both}}\n"
    "members: {thigh: {kind: bar, nodes: [hip, knee], stiffness: 1e4, damping: 1, mass: 0.1},\n"
    "          shank: {kind: bar, nodes: [knee, foot], stiffness: 1e4, damping: 1},\n"
    "          tie: {kind: spring, nodes: [pin, hip], stiffness: 100, damping: 2}}\n"
    "hinges:\n"
    "  knee: {nodes: [hip, knee, foot], stiffness: 2, damping: 0.01}\n"
    "  hip: {nodes: [pin, hip, knee], stiffness: 3, damping: 0.02, law: {kind: play, gap: 5 deg}}\n"
    "actuators:\n"
    "  motor: {hinge: knee, signal: {sine: {amplitude: 40 deg, frequency: 3 Hz}}}\n"
    "  lift: {hinge: hip, signal: {sine: {amplitude: 20 deg, frequency: 2 Hz, phase: 50 deg}}}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 1 s}\n";

TEST(the_balance_of_a_driven_leg_closes) {
  static const struct {
    const char *method;
    double tolerance;
  } known[] = {{"rk4", 1e-7},
               {"rk4-events", 1e-9},
               {"adaptive", 1e-5},
               {"verlet-events", 1e-4},
               {"midpoint", 1e-9}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    OWN(model_run) run = model_read_text("leg", leg, set_none);
    model_simulate_by(&run, known[i].method);
    const strut_energy *e = &run.summary.energy;
    assert_true(e->drive_work > 0.01 && e->dissipated_members > 0.01);
    assert_near(e->residual, 0, known[i].tolerance * e->moved);
  }
}
