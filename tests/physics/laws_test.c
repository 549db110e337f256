/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of members and stops in motion, against closed forms. */
#include <gsl/gsl_sf_ellint.h>

#include "tests/models/run_model.h"
#include "tests/support/check.h"

static const double PI = 3.14159265358979323846;

static const char *const events[] = {"rk4-events", "adaptive", "verlet-events", "euler-events"};

/* A mass on a spring of a law, drawn at rest, let go at x = 1 + out. */
static const char oscillator[] =
    "nodes:\n"
    "  wall: {position: [0, 0], fixed: both}\n"
    "  block: {position: [1, 0], fixed: y, mass: 2}\n"
    "members:\n"
    "  m: {kind: spring, nodes: [wall, block], %s}\n"
    "initial: {positions: {block: [1 + %g, 0]}}\n"
    "solver: {step: 1 ms}\n"
    "run: {duration: 1 s}\n"
    "output: {channels: [position, velocity, force]}\n";

static const char BILINEAR[] =
    "stiffness: 50, law: {kind: bilinear, knee: 50 mm, second_stiffness: 300 N/m}";
static const char TABLE[] =
    "law: {kind: table, points: [[-1, -287.5], [-50 mm, -2.5], [50 mm, 2.5], [1, 287.5]]}";

/* k x + k3 x^3: T = 4 K(m) / omega_r with omega_r^2 = (k + k3 A^2) / M, m = k3 A^2 / 2 / (k + k3 A^2). */
TEST(duffings_oscillator_keeps_its_period) {
  static const char *const methods[] = {"rk4", "rk4-events", "adaptive", "verlet-events",
                                        "midpoint"};
  static const double tolerance[] = {1e-10, 1e-10, 1e-6, 1e-5, 1e-5};
  const double k = 50, k3 = 4000, out = 0.2, hard = k + k3 * out * out;
  const double period =
      4 * gsl_sf_ellint_Kcomp(sqrt(0.5 * k3 * out * out / hard), 0) / sqrt(hard / 2);
  for (int i = 0; i < 5; i++) {
    OWN(model_run) run = model_read_format(
        oscillator, "law: {kind: polynomial, coefficients: [50 N/m, 0, 4000 N/m^3]}", 0.2);
    run.setup.experiment.integrator = methods[i];
    run.setup.experiment.duration = 2.25 * period;
    run.setup.experiment.step = run.setup.experiment.duration / 9000;
    model_simulate(&run);
    assert_all_near(tolerance[i], model_position(&run, "block")[0], 1, run.summary.energy.kinetic,
                    0.5 * k * out * out + 0.25 * k3 * pow(out, 4));
  }
}

/* A quarter of a period of each law in closed form, met where pieces change by methods with events. */
TEST(bilinear_springs_and_free_play_keep_their_period) {
  static const double tolerance[] = {1e-9, 1e-5, 1e-5, 1e-2};
  const double mass = 2, k = 50, out = 0.2;
  /* soft to 0.05, then 300: from out to the knee by cosine, from there to 0 by sine */
  const double w2 = sqrt(300 / mass), w1 = sqrt(k / mass), knee = 0.05;
  double shift = knee - k * knee / 300; /* where the steep line meets zero */
  double time2 = acos((knee - shift) / (out - shift)) / w2;
  double speed2 = (out - shift) * w2 * sin(w2 * time2);
  double quarter_bilinear = time2 + atan(knee * w1 / speed2) / w1;
  double top_bilinear = sqrt(speed2 * speed2 + w1 * w1 * knee * knee);
  /* free play of 0.05 to either side */
  double top_play = (out - knee) * w1, quarter_play = PI / 2 / w1 + knee / top_play;
  for (int law = 0; law < 2; law++)
    for (int i = 0; i < 4; i++) {
      double quarter = law ? quarter_play : quarter_bilinear;
      OWN(model_run) run = model_read_format(
          oscillator, law ? "stiffness: 50, law: {kind: play, gap: 50 mm}" : BILINEAR, 0.2);
      run.setup.experiment.integrator = events[i];
      run.setup.experiment.duration = 9 * quarter;
      run.setup.experiment.step = run.setup.experiment.duration / 9000;
      model_simulate(&run);
      assert_near(model_position(&run, "block")[0], 1, tolerance[i]);
      assert_near(run.summary.energy.kinetic, pow(law ? top_play : top_bilinear, 2),
                  10 * tolerance[i]);
      assert_true(run.summary.spent.events >= 8);
    }
}

/* The same through a table with the bilinear spring's points, and a one-sided spring's by its word. */
TEST(a_table_is_the_spring_that_it_lists) {
  for (int i = 0; i < 4; i++) {
    double at[2];
    for (int table = 0; table < 2; table++) {
      OWN(model_run) run = model_read_format(oscillator, table ? TABLE : BILINEAR, 0.2);
      model_simulate_by(&run, events[i]);
      at[table] = model_position(&run, "block")[0];
    }
    assert_near(at[1], at[0], 1e-9);
  }
}

/* Elastic energy is the integral of the table, and force its value, at rest and beyond its ends. */
TEST(a_tables_energy_is_its_integral) {
  static const struct {
    double out, force, energy;
  } known[] = {
      {0.05, 1, 0.025}, {0.2, 5, 0.1 + 0.35}, {0.5, 14, 0.1 + 1.0 + 2.2}, {-0.5, -10, 2.5}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    OWN(model_run) run = model_read_format(
        oscillator, "law: {kind: table, points: [[-1, -20], [0, 0], [0.1, 2], [0.3, 8]]}",
        known[i].out);
    run.setup.experiment.duration = run.setup.experiment.step;
    model_simulate(&run);
    assert_relative(model_value(&run, 0, STRUT_CHANNEL_FORCE, "m", 0), known[i].force, 1e-13);
    assert_relative(run.summary.energy.initial, known[i].energy, 1e-13);
  }
}

/* ---- stops ---- */

/* A block flies at 3 m/s against the longest length of a spring without stiffness. */
static const char against_stop[] =
    "nodes:\n"
    "  wall: {position: [0, 0], fixed: both}\n"
    "  block: {position: [%g, 0], fixed: y, mass: 0.5}\n"
    "members:\n"
    "  m: {kind: spring, nodes: [wall, block], stiffness: 1e-9, shortest: 0.8, longest: 1.2, "
    "stop_stiffness: 800, stop_damping: %.17g}\n"
    "initial: {velocities: {block: [%g, 0]}}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 0.3 s}\n"
    "output: {channels: [velocity]}\n";

/*
 * Without adhesion the stop lets go where its force is zero: at the phase 2 acos(zeta) of the damped
 * oscillation, with exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)) of the speed.
 */
TEST(a_stop_gives_back_what_its_damper_leaves) {
  static const char *const methods[] = {"rk4",          "rk4-events", "adaptive", "verlet-events",
                                        "euler-events", "verlet",     "euler",    "midpoint"};
  static const double tolerance[] = {2e-2, 1e-8, 1e-5, 1e-4, 2e-2, 2e-2, 5e-2, 2e-2};
  for (int side = 0; side < 2; side++)
    for (int damped = 0; damped < 3; damped++)
      for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        double zeta = 0.3 * damped, limit = side ? -1 : 1;
        OWN(model_run) run =
            model_read_format(against_stop, 1 + 0.1 * limit, 2 * zeta * sqrt(800 * 0.5), 3 * limit);
        model_simulate_by(&run, methods[i]);
        double kept = exp(-2 * zeta * acos(zeta) / sqrt(1 - zeta * zeta));
        double held = 2 * acos(zeta) / sqrt(1 - zeta * zeta) / 40;
        size_t after = (size_t)((0.1 / 3 + held + 0.02) / 0.3 * (double)(run.row_count - 1));
        double exit = -limit * model_value(&run, after, STRUT_CHANNEL_VELOCITY, "block", 0);
        if (fabs(exit - 3 * kept) > tolerance[i] * 3 * kept)
          print_error("%s, zeta %g, side %d\n", methods[i], zeta, side);
        assert_relative(exit, 3 * kept, tolerance[i]);
        assert_true(run.summary.energy.dissipated_members >= 0);
      }
}

/* Two masses on a string that gets taut: they exchange speeds, and their momentum is kept. */
static const char two_masses[] =
    "nodes: {a: {position: [0, 0], mass: 2}, b: {position: [1, 0.3], mass: 0.5}}\n"
    "members:\n"
    "  m: {kind: spring, nodes: [a, b], stiffness: 10, damping: 0.1, longest: 1.2, shortest: 0.7,\n"
    "      stop_stiffness: 1e4, stop_damping: 3}\n"
    "initial: {velocities: {a: [0.4, -0.2], b: [3, 0.5]}}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 1 s}\n"
    "output: {channels: [position, velocity]}\n";

TEST(stops_keep_the_momentum_of_two_masses) {
  const double momentum[] = {2 * 0.4 + 0.5 * 3, 2 * -0.2 + 0.5 * 0.5};
  const double spin = 0.5 * (1 * 0.5 - 0.3 * 3);
  static const double tolerance[] = {1e-5, 1e-5, 1e-4, 0.05};
  for (int i = 0; i < 4; i++) {
    OWN(model_run) run = model_read_text("two_masses", two_masses, set_none);
    model_simulate_by(&run, events[i]);
    assert_true(run.summary.spent.events >= 4);
    size_t last = run.row_count - 1;
    double x[4], v[4];
    for (size_t c = 0; c < 4; c++) {
      const char *node = c / 2 ? "b" : "a";
      x[c] = model_value(&run, last, STRUT_CHANNEL_POSITION, node, c % 2);
      v[c] = model_value(&run, last, STRUT_CHANNEL_VELOCITY, node, c % 2);
    }
    assert_all_near(1e-12, 2 * v[0] + 0.5 * v[2], momentum[0], 2 * v[1] + 0.5 * v[3], momentum[1]);
    double turning = 2 * (x[0] * v[1] - x[1] * v[0]) + 0.5 * (x[2] * v[3] - x[3] * v[2]);
    assert_near(turning, spin, i == 3 ? 1e-3 : 1e-7);
    assert_near(run.summary.energy.residual, 0, tolerance[i] * run.summary.energy.moved);
  }
}

/*
 * A block flies outwards from where a cable begins to act, without a damper: it comes back with its own
 * speed whatever the law, also where the force begins without a slope, or with a jump.
 */
static const char thrown[] =
    "nodes:\n"
    "  wall: {position: [0, 0], fixed: both}\n"
    "  block: {position: [1, 0], fixed: y, mass: 0.5}\n"
    "members:\n"
    "  m: {kind: cable, nodes: [wall, block], rest_length: 1.1, %s}\n"
    "initial: {velocities: {block: [2, 0]}}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {duration: 1 s}\n";

TEST(a_cable_of_any_law_throws_its_block_back) {
  static const char *const laws[] = {
      "stiffness: 40",
      "law: {kind: polynomial, coefficients: [0, 0, 400]}",
      "law: {kind: polynomial, coefficients: [0, 100]}",
      "law: {kind: table, points: [[0, 3], [0.3, 9]]}",
      "law: {kind: table, points: [[0, 0], [0.1, 0], [0.2, 5], [0.4, 15]]}",
      "law: {kind: table, smooth: yes, points: [[-0.1, 0], [0.1, 0], [0.2, 5], [0.4, 15]]}",
      "stiffness: 40, law: {kind: play, gap: 100 mm}",
      "stiffness: 40, law: {kind: bilinear, knee: 100 mm, second_stiffness: 10}",
      "stiffness: 40, law: {kind: exponential, scale: 0.3}",
      "stiffness: 40, law: logarithmic"};
  static const double tolerance[] = {1e-6, 1e-5, 1e-4, 1e-2};
  for (size_t law = 0; law < sizeof laws / sizeof laws[0]; law++)
    for (int i = 0; i < 4; i++) {
      OWN(model_run) run = model_read_format(thrown, laws[law]);
      model_simulate_by(&run, events[i]);
      const strut_energy *e = &run.summary.energy;
      if (!(fabs(e->kinetic - 1) <= tolerance[i])) print_error("%s, %s\n", events[i], laws[law]);
      assert_near(e->kinetic, 1, tolerance[i]);
      assert_near(e->elastic, 0, 0);
      assert_near(e->dissipated_members, 0, tolerance[i]);
      assert_true(model_position(&run, "block")[0] < 1.1 && run.summary.spent.events >= 2);
    }
}

/* A spring of a law whose rest length is driven: what the drive does is stored or lost. */
static const char driven[] =
    "nodes:\n"
    "  wall: {position: [0, 0], fixed: both}\n"
    "  block: {position: [1, 0.2], mass: 0.5}\n"
    "members:\n"
    "  m: {kind: %s, nodes: [wall, block], damping: 0.2, %s}\n"
    "  n: {kind: spring, nodes: [wall, block], stiffness: 5}\n"
    "actuators:\n"
    "  motor: {member: m, signal: {sine: {amplitude: 0.3, frequency: 1.3 Hz}}}\n"
    "initial: {velocities: {block: [0.2, 0.5]}}\n"
    "solver: {step: 0.5 ms}\n"
    "run: {duration: 2 s}\n";

TEST(the_balance_of_driven_laws_closes) {
  static const char *const laws[] = {
      "stiffness: 40, law: compression_only",
      "stiffness: 40, law: {kind: bilinear, knee: 50 mm, second_stiffness: 90}",
      "stiffness: 40, law: {kind: play, gap: 50 mm}",
      "law: {kind: polynomial, coefficients: [20, 10, 200]}",
      "stiffness: 40, law: logarithmic",
      "stiffness: 40, law: {kind: exponential, scale: 0.2}",
      "law: {kind: table, points: [[-0.3, -9], [-0.1, -2], [0.1, 2], [0.2, 9]]}",
      "law: {kind: table, smooth: yes, points: [[-0.3, -9], [-0.1, -2], [0.1, 2], [0.2, 9]]}"};
  static const char *const kinds[] = {"spring", "cable"};
  static const char *const methods[] = {"rk4-events", "adaptive", "verlet-events", "midpoint"};
  /* what a cable's damper takes after it has let go is known to the kink at its end */
  static const double tolerance[] = {1e-6, 1e-5, 1e-4, 1e-9};
  for (int kind = 0; kind < 2; kind++)
    for (size_t law = 0; law < sizeof laws / sizeof laws[0]; law++)
      for (int i = 0; i < 4; i++) {
        if (kind && !law) continue;
        OWN(model_run) run = model_read_format(driven, kinds[kind], laws[law]);
        model_simulate_by(&run, methods[i]);
        const strut_energy *e = &run.summary.energy;
        if (!(fabs(e->residual) <= tolerance[i] * e->moved))
          print_error("%s, %s, %s\n", methods[i], kinds[kind], laws[law]);
        assert_near(e->residual / e->moved, 0, tolerance[i]);
        assert_true(e->dissipated_members > 0 && e->drive_work != 0);
      }
}
