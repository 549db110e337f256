/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members with an axial_stiffness whose rest length is driven: EA over the present one, in closed forms. */
#include "tests/models/run_model.h"
#include "tests/support/motion.h"

static const char *const methods[] = {"rk4",        "euler",    "verlet",        "midpoint",
                                      "rk4-events", "adaptive", "verlet-events", "euler-events"};
enum { METHODS = sizeof methods / sizeof *methods };

/* A rope of 1 m between supports, straight or over a guide, is wound in to 0.5 m. */
static const char reel[] =
    "nodes: {a: {position: [0, 0], fixed: both}, g: {position: [0.6, 0], fixed: both},\n"
    "        b: {position: [1, 0], fixed: both}, c: {position: [0, 1], mass: 1}}\n"
    "members:\n"
    "  rope: {kind: %s, nodes: %s, axial_stiffness: 100 N%s}\n"
    "  tail: {kind: cable, nodes: [g, c], stiffness: 100, rest_length: 2}\n"
    "actuators: {reel: {member: rope, signal: {ramp: {amplitude: %s, stop: 0.5 s}}}}\n"
    "solver: {step: 1 ms, integrator: rk4-events}\n"
    "run: {duration: 1 s}\n"
    "output: {channels: [force], last: 0.01}\n";

static model_run read_reel(const char *kind, const char *nodes, const char *more,
                           const char *amplitude) {
  return model_read_format(reel, kind, nodes, more, amplitude);
}

static double last_force(const model_run *run) {
  return model_value(run, run->row_count - 1, STRUT_CHANNEL_FORCE, "rope", 0);
}

/* `force` and `work`: at the end, and what the drive has done, which is the energy stored. */
static void check_reel(const char *kind, const char *nodes, const char *more, double force,
                       double work) {
  bool remembers = strstr(more, "breaks_at") || strstr(more, "guide_friction");
  for (int i = 0; i < METHODS; i++) {
    if (remembers && !strcmp(methods[i], "midpoint")) continue; /* which refuses that */
    OWN(model_run) run = read_reel(kind, nodes, more, "-0.5");
    model_simulate_by(&run, methods[i]);
    assert_all_relative(1e-12, last_force(&run), force, run.summary.energy.elastic, work);
    /* others than these pass over the end of the ramp, or are of lower order */
    bool exact = !strcmp(methods[i], "rk4-events") || !strcmp(methods[i], "adaptive");
    assert_relative(run.summary.energy.drive_work, work, exact ? 1e-8 : 5e-3);
    assert_int_equal(run.summary.warning_count, 0);
  }
}

/* EA (l - L0) / L0, and EA (l - L0)^2 / (2 L0) in energy. */
TEST(the_force_is_ea_over_the_present_length) {
  check_reel("cable", "[a, b]", "", 100, 25);
  check_reel("cable", "[a, g, b]", "", 100, 25);
  check_reel("spring", "[a, b]", "", 100, 25);
  check_reel("cable", "[a, b]", ", breaks_at: 1 kN", 100, 25);
  check_reel("cable", "[a, g, b]", ", guide_friction: 1e-6", 100, 25);
}

/* The law of the material with k = EA / L0: what a scene with that rest length has. */
TEST(laws_follow_the_length_too) {
  check_reel("spring", "[a, b]", ", law: logarithmic", 100 * log(2), 100 * (log(2) - 0.5));
  check_reel("spring", "[a, b]", ", law: {kind: play, gap: 0.1}", 200 * 0.4, 100 * 0.16);
  check_reel("spring", "[a, b]", ", law: {kind: bilinear, knee: 0.2, second_stiffness: 50 N/m}",
             200 * 0.2 + 50 * 0.3, 100 * 0.04 + 200 * 0.2 * 0.3 + 25 * 0.09);
  double scale = 0.5, grown = expm1(1);
  check_reel("spring", "[a, b]", ", law: {kind: exponential, scale: 0.5}", 200 * scale * grown,
             200 * scale * scale * (grown - 1));
}

/* What is let out pulls less than k (l - L0) would, and a slack rope nothing. */
TEST(letting_out) {
  OWN(model_run) taut = read_reel("cable", "[a, b]", ", rest_length: 0.5", "0.3");
  OWN(model_run) slack = read_reel("cable", "[a, b]", ", rest_length: 0.5", "0.6");
  model_simulate(&taut), model_simulate(&slack);
  assert_relative(last_force(&taut), 100 * 0.2 / 0.8, 1e-12);
  assert_relative(taut.summary.energy.drive_work, 50 * 0.04 / 0.8 - 50 * 0.25 / 0.5, 1e-8);
  assert_near(last_force(&slack), 0, 0);
  assert_relative(slack.summary.energy.drive_work, -25, 1e-8);
}

/* A mass that swings on a rope that a sine winds in and out, with a damper: energy is accounted for. */
TEST(energy_in_motion) {
  static const double open[METHODS] = {1e-5, 2e-2, 1e-3, 1e-9, 1e-5, 1e-4, 1e-3, 2e-2};
  static const char swing[] =
      "nodes: {a: {position: [0, 0], fixed: both}, g: {position: [0.3, 0.1], fixed: both},\n"
      "        c: {position: [1, 0], mass: 1}}\n"
      "gravity: [0, -9.81]\n"
      "members:\n"
      "  rope: {kind: cable, nodes: [a, g, c], axial_stiffness: 500 N, damping: 1, rest_length: "
      "0.9}\n"
      "  line: {kind: spring, nodes: [a, c], axial_stiffness: 50 N, damping: 0.1}\n"
      "actuators:\n"
      "  winch: {member: rope, signal: {sine: {amplitude: 0.3, frequency: 1 Hz}}}\n"
      "  other: {member: line, signal: {sine: {amplitude: 0.5, frequency: 0.7 Hz}}}\n"
      "solver: {step: 0.5 ms}\n"
      "run: {duration: 3 s}\n"
      "output: {channels: [position], last: 0.01}\n";
  double x = NAN;
  for (int i = 0; i < METHODS; i++) {
    OWN(model_run) run = model_read_text("swing", swing, set_none);
    model_simulate_by(&run, methods[i]);
    const strut_energy *e = &run.summary.energy;
    assert_within(e->moved, 1, 1e4);
    assert_near(e->residual / e->moved, 0, open[i]);
    if (isnan(x)) x = model_position(&run, "c")[0];
    assert_near(model_position(&run, "c")[0], x, strstr(methods[i], "euler") ? 0.05 : 1e-3);
  }
}

/* EA over the length that is left: the step limit falls as it does. */
TEST(a_step_that_becomes_too_large_is_noticed) {
  static const char text[] =
      "nodes: {a: {position: [0, 0], fixed: both}, c: {position: [1, 0], mass: 1, fixed: y}}\n"
      "members: {rope: {kind: spring, nodes: [a, c], axial_stiffness: 100 N, damping: 0.1}}\n"
      "actuators: {reel: {member: rope, signal: {ramp: {amplitude: %s, stop: 10 s}}}}\n"
      "solver: {step: 50 ms}\n"
      "run: {duration: 40 s}\n";
  static const char *const amplitudes[] = {"-0.9", "-0.971", "-1.1"};
  static const char *const words[] = {NULL, "the structure has become stiffer",
                                      "the rest length of member 'rope' reached zero"};
  for (int i = 0; i < 3; i++) {
    strut_error error = {0};
    OWN(model_run) run = model_read_format(text, amplitudes[i]);
    if (i == 2) run.setup.experiment.integrator = "adaptive", run.setup.experiment.step = 1e-3;
    strut_status status = motion_try(&run.setup, (strut_run_options){0}, &run.summary, &error);
    assert_int_equal(status, words[i] ? STRUT_DIVERGED : STRUT_OK);
    if (words[i] && !strstr(error.message, words[i])) fail_msg("said: %s", error.message);
  }
}

/* Without a drive, or with stiffness, it stays a plain member, which every kernel steps. */
TEST(others_pay_nothing) {
  static const char *const members[] = {"axial_stiffness: 100", "stiffness: 100"};
  static const char *const driven[] = {"tail", "rope", "rope"};
  for (int i = 0; i < 3; i++) {
    OWN(model_run) run = model_read_format(
        "nodes: {a: {position: [0, 0], fixed: both}, c: {position: [1, 0], mass: 1}}\n"
        "members:\n"
        "  rope: {kind: cable, nodes: [a, c], %s}\n"
        "  tail: {kind: cable, nodes: [a, c], stiffness: 100}\n"
        "actuators: {reel: {member: %s, signal: {ramp: {amplitude: -0.1, stop: 1 s}}}}\n"
        "solver: {step: 1 ms}\nrun: {duration: 1 s}\n",
        members[i == 1], driven[i]);
    run.model = motion_compile(&run.setup.scene);
    assert_int_equal(run.model->elements.count, i == 2);
  }
}
