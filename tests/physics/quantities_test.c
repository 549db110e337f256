/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured quantities against closed forms: each column, each reduction, and what they cost. */
#include "tests/models/run_model.h"
#include "tests/support/motion.h"

static const double PI = 3.14159265358979323846, GRAVITY = 9.81;

/* What was read, with the summary of its run. */
static model_run measured(model_run read) {
  read.summary = motion_simulate(&read.setup);
  assert_int_equal(read.summary.measured_count, read.setup.experiment.quantity_count);
  return read;
}

static model_run run_text(const char *text) {
  return measured(model_read_text("test", text, set_none));
}

static const strut_measured *get(const model_run *r, const char *name) {
  for (size_t i = 0; i < r->summary.measured_count; i++)
    if (strcmp(r->summary.measured[i].name, name) == 0) return &r->summary.measured[i];
  fail_msg("no quantity '%s'", name);
  return NULL;
}

static double value(const model_run *r, const char *name) { return get(r, name)->value; }

/* m g + sqrt((m g)^2 + 2 k m g h) where a mass falls by h before the cable pulls. */
TEST(a_mass_caught_by_a_cable) {
  static const char text[] =
      "parameters: {drop: 0.5 m, stiff: 2 kN/m}\n"
      "nodes: {top: {position: [0, 0], fixed: both}, bob: {position: [0, -1], mass: 2 kg}}\n"
      "members: {catch: {nodes: [top, bob], kind: cable, stiffness: stiff}}\n"
      "gravity: [0, -9.81]\n"
      "initial: {positions: {bob: [0, -1 + drop]}}\n"
      "solver: {integrator: rk4-events, step: 1 ms}\n"
      "run:\n"
      "  duration: 0.5 s\n"
      "  measure:\n"
      "    quantities: {peak: {of: catch.force, take: max, accuracy: 0.5 %},\n"
      "                 factor: {of: catch.force / (stiff * drop), take: max},\n"
      "                 deep: {of: bob.y + 1 m, take: min, accuracy: 0.1 mm},\n"
      "                 stretch: {of: catch.stretch, take: max}, side: com.vx}\n";
  model_run r = run_text(text);
  const double weight = 2 * GRAVITY, k = 2000;
  double peak = weight + sqrt(weight * weight + 2 * k * weight * 0.5);
  assert_all_relative(1e-6, value(&r, "peak"), peak, value(&r, "factor"), peak / (k * 0.5),
                      value(&r, "deep"), -peak / k, value(&r, "stretch"), peak / k);
  assert_all_texts(get(&r, "peak")->unit, "N", get(&r, "factor")->unit, "1");
  assert_relative(get(&r, "peak")->scale, peak, 1e-3);
  assert_true(get(&r, "side")->zero && r.summary.velocity_zero && !get(&r, "peak")->zero);
  const strut_quantity_definition *q = r.setup.experiment.quantities;
  assert_true(q[0].accuracy == 0.005 && !q[0].accuracy_unit);
  assert_true(q[2].accuracy == 1e-4 && q[2].accuracy_unit);
  model_run_free(&r);
  r = measured(model_read_text("test", text, set_to("drop=0.2 m", "stiff=500 N/m")));
  peak = weight + sqrt(weight * weight + 2 * 500 * weight * 0.2);
  assert_all_relative(1e-6, value(&r, "peak"), peak, value(&r, "factor"), peak / (500 * 0.2));
  model_run_free(&r);
}

/* An undamped oscillator of 50 rad/s about x = 1 m, amplitude 0.1 m, over ten whole periods. */
TEST(an_oscillator) {
  OWN(model_run) r = run_text(
      "nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: 2 kg, fixed: "
      "y}}\n"
      "members: {spring: {nodes: [wall, block], kind: spring, stiffness: 5 kN/m}}\n"
      "initial: {positions: {block: [1.1, 0]}}\n"
      "solver: {step: 2*pi/50/100}\n" /* 100 steps in a period */
      "run:\n"
      "  duration: 20*pi/50\n"
      "  measure:\n"
      "    quantities: {range: {of: block.x, take: range},\n"
      "                 high: {of: block.x - 1 m, take: max},\n"
      "                 low: {of: spring.force, take: min},\n"
      "                 speed: {of: abs(block.vx), take: max},\n"
      "                 effective: {of: block.x - 1, take: rms}, middle: block.x - 1,\n"
      "                 moving: energy.kinetic, stored: energy.elastic,\n"
      "                 kept: {of: energy.total, take: range}, end: {of: block.x, take: final},\n"
      "                 drift: block.vx, went: {of: block.x, take: change},\n"
      "                 clock: {of: time, take: change}, pace: {of: 3 * time, take: rate}}\n");
  const double energy = 0.5 * 5000 * 0.01;
  /* sampled ends of steps alone would miss amplitudes of this by up to 5e-4 */
  assert_all_relative(1e-6, value(&r, "range"), 0.2, value(&r, "high"), 0.1, value(&r, "low"), -500,
                      value(&r, "speed"), 5, value(&r, "effective"), 0.1 / sqrt(2));
  assert_near(value(&r, "middle"), 0, 1e-7);
  assert_all_relative(1e-6, value(&r, "moving"), energy / 2, value(&r, "stored"), energy / 2);
  assert_near(value(&r, "kept"), 0, 1e-6 * energy);
  assert_all_relative(1e-6, get(&r, "kept")->scale, energy, value(&r, "end"), 1.1);
  assert_near(value(&r, "drift"), 0, 1e-6);
  assert_same_bits(value(&r, "went"), r.summary.end.positions[2] - 1.1);
  assert_all_relative(1e-12, value(&r, "clock"), 20 * PI / 50, value(&r, "pace"), 3);
  assert_string_equal(get(&r, "pace")->unit, "1");
  assert_true(isnan(get(&r, "range")->spread)); /* a run in seconds has no periods */
}

/* Extremes between steps where the window has a peak at a fraction of a step. */
TEST(peaks_between_steps) {
  static const char text[] =
      "parameters: {late: 0}\n"
      "nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: 1 kg}}\n"
      "members: {spring: {nodes: [wall, block], kind: spring, stiffness: 1 N/m}}\n"
      "initial: {positions: {block: [1 + 0.1*cos(late * 1 rad), 0]},"
      " velocities: {block: [-0.1*sin(late * 1 rad), 0]}}\n"
      "solver: {step: 0.1 s}\n"
      "run: {duration: 12, measure: {quantities: {peak: {of: spring.force, take: max},"
      " dip: {of: -spring.force, take: min}}}}\n";
  for (int i = 0; i < 10; i++) {
    char late[20];
    snprintf(late, sizeof late, "late=%g", 3 + 0.013 * i);
    OWN(model_run) r = measured(model_read_text("test", text, set_to(late)));
    assert_all_relative(1e-5, value(&r, "peak"), 0.1, value(&r, "dip"), -0.1);
  }
}

/* A force that jumps has no vertex between its steps: nothing is larger than what was there. */
TEST(a_jump_is_no_peak) {
  OWN(model_run) r = run_text(
      "nodes: {ball: {position: [0, 0.3], mass: 1 kg}}\n"
      "gravity: [0, -9.81]\n"
      "ground: {stiffness: 100 kN/m, damping: 400 N s/m}\n"
      "solver: {integrator: rk4-events, step: 0.1 ms}\n"
      "run: {duration: 0.3, measure: {quantities: {top: {of: ball.normal, take: max}}}}\n");
  /* of this damping the force is largest at touchdown, and falls by 1.5 % in a step from there */
  double jump = 400 * sqrt(2 * GRAVITY * 0.3);
  assert_within(value(&r, "top"), 0.98 * jump, jump * (1 + 1e-6));
}

/* A rigid pendulum released at 60 degrees: tension m g (3 - 2 cos) at the bottom. */
TEST(a_pendulum) {
  OWN(model_run) r = run_text(
      "bars: rigid\n"
      "gravity: [0, -9.81]\n"
      "nodes: {top: {position: [0, 0], fixed: both},"
      " bob: {position: [2*sin(60 deg), -2*cos(60 deg)], mass: 3 kg}}\n"
      "members: {rod: {nodes: [top, bob], kind: bar, stiffness: 1 MN/m}}\n"
      "solver: {step: 1 ms}\n"
      "run:\n"
      "  duration: 4 s\n"
      "  measure:\n"
      "    quantities:\n"
      "      swing: {of: \"angle(top, bob)\", take: range}\n"
      "      lean: {of: rod.angle, take: max, accuracy: 0.1 deg}\n"
      "      pull: {of: rod.force, take: max}\n"
      "      least: {of: rod.force, take: min}\n"
      "      long: {of: \"distance(top, bob)\", take: range}\n"
      "      fall: {of: energy.gravity, take: range}\n"
      "      quick: {of: \"hypot(bob.vx, bob.vy)\", take: max}\n");
  assert_relative(value(&r, "swing"), 2 * PI / 3, 1e-6);
  assert_near(value(&r, "lean"), -PI / 2 + PI / 3, 1e-6);
  assert_relative(value(&r, "pull"), 3 * GRAVITY * (3 - 2 * 0.5), 1e-6);
  assert_relative(value(&r, "least"), 3 * GRAVITY * 0.5, 1e-6);
  assert_true(get(&r, "long")->zero);
  assert_relative(value(&r, "fall"), 3 * GRAVITY * 2 * 0.5, 1e-6);
  assert_relative(value(&r, "quick"), sqrt(2 * GRAVITY * 2 * 0.5), 1e-6);
  assert_string_equal(get(&r, "swing")->unit, "rad");
}

/* Angles go on beyond a turn: a spoke that spins at 7 rad/s for 10 s. */
TEST(an_angle_beyond_a_turn) {
  OWN(model_run) r = run_text(
      "bars: rigid\n"
      "nodes: {hub: {position: [0, 0], fixed: both}, rim: {position: [1, 0], mass: 1 kg}}\n"
      "members: {spoke: {nodes: [hub, rim], kind: bar, stiffness: 1}}\n"
      "initial: {velocities: {rim: [0, -7]}}\n"
      "solver: {step: 1 ms}\n"
      "run: {duration: 10 s, measure: {quantities: {turned: {of: spoke.angle, take: change},"
      " spin: {of: \"angle(rim, hub)\", take: rate}}}}\n");
  assert_all_relative(1e-8, value(&r, "turned"), -70, value(&r, "spin"), -7);
  assert_string_equal(get(&r, "spin")->unit, "rad/s");
}

/* What falls exponentially is not zero up to rounding, however large its exponent or denominator becomes. */
TEST(large_exponents) {
  OWN(model_run) r = run_text(
      "nodes: {a: {position: [0, 0], mass: 1 kg}}\n"
      "initial: {velocity: [1, 0]}\n"
      "solver: {integrator: rk4, step: 1 ms}\n"
      "run: {duration: 10 s, measure: {quantities: {decay: exp(-5*time/(1 s)), pole: (1 + a.x/(1 "
      "m))^-4,\n"
      "  bell: {of: \"exp(-((a.x - 5 m)/(10 mm))^2)\", take: max},\n"
      "  thin: \"exp(-((a.x - 5 m)/(100 um))^2)\", hair: \"exp(-((a.x - 5 m)/(1 um))^2)\"}}}\n");
  assert_all_near(1e-6, value(&r, "decay"), 0.02, value(&r, "bell"), 1);
  assert_all_relative(1e-3, value(&r, "pole"), 1 / 30.0, value(&r, "thin"), sqrt(PI) * 1e-5);
  assert_false(get(&r, "decay")->zero || get(&r, "bell")->zero || get(&r, "pole")->zero);
  assert_false(get(&r, "thin")->zero);
  assert_near(value(&r, "hair"), sqrt(PI) * 1e-7,
              get(&r, "hair")->left); /* samples are 31 um apart */
}

/* Free fall above a slope of 30 degrees, over the last second of two. */
TEST(a_falling_mass) {
  OWN(model_run) r = run_text(
      "nodes: {ball: {position: [1, 50], mass: 2 kg}, other: {position: [5, 60], mass: 1 kg}}\n"
      "gravity: [0, -9.81]\n"
      "ground: {stiffness: 1e5, slope: 30 deg, height: 1 m, nodes: [ball]}\n"
      "solver: {step: 1 ms}\n"
      "run:\n"
      "  duration: 2 s\n"
      "  measure:\n"
      "    last: 1 s\n"
      "    node: ball\n"
      "    quantities: {climb: com.vy, height: {of: ball.height, take: final},\n"
      "                 sink: {of: ball.height, take: change},\n"
      "                 apart: {of: ball.y - other.y, take: range}, square: ball.vy^2,\n"
      "                 push: {of: ball.normal, take: max}, side: ball.vx,\n"
      "                 centre: {of: com.x, take: final}}\n");
  double c = cos(PI / 6), s = sin(PI / 6), at2 = 50 - 0.5 * GRAVITY * 4;
  assert_all_relative(1e-9, value(&r, "climb"), -GRAVITY * 1.5, value(&r, "height"),
                      -s * 1 + c * (at2 - 1), value(&r, "sink"), -c * 0.5 * GRAVITY * 3);
  assert_true(get(&r, "apart")->zero);
  assert_relative(value(&r, "square"), GRAVITY * GRAVITY * 7 / 3, 1e-6);
  assert_true(value(&r, "push") == 0 && get(&r, "push")->zero);
  assert_same_bits(value(&r, "side"), r.summary.velocity);
  assert_relative(value(&r, "centre"), 7.0 / 3, 1e-12);
}

static void rest_on_slope(const char *method) {
  OWN(model_run) r = measured(model_read_format(
      "nodes: {foot: {position: [0, 1 mm], mass: 4 kg}}\n"
      "gravity: [0, -9.81]\n"
      "ground: {stiffness: 1e5, damping: 1e3, slope: 10 deg,"
      " friction: {mu: 0.5, stick_velocity: 1 mm/s}}\n"
      "solver: {integrator: %s, step: 0.1 ms}\n"
      "run: {duration: 1 s, measure: {last: 0.1 s, quantities: {up: foot.normal,"
      " along: {of: foot.friction, take: final}, deep: {of: -foot.height, take: max},"
      " spring: {of: energy.contact, take: final}}}}\n",
      method));
  double normal = 4 * GRAVITY * cos(PI / 18);
  assert_all_relative(1e-6, value(&r, "up"), normal, value(&r, "along"), 4 * GRAVITY * sin(PI / 18),
                      value(&r, "deep"), normal / 1e5, value(&r, "spring"), normal * normal / 2e5);
}

TEST(contact_forces_at_rest_carry_the_weight) {
  rest_on_slope("rk4");
  rest_on_slope("verlet-events");
}

/* x = A sin in the drive's own frame: works and losses of a damper that an actuator pulls. */
TEST(works_and_periods) {
  OWN(model_run) r = run_text(
      "nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: 1e9 kg}}\n"
      "members: {piston: {nodes: [wall, block], kind: spring, damping: 30 N s/m}}\n"
      "actuators: {drive: {member: piston,"
      " signal: {sine: {amplitude: 2 mm, frequency: 5 Hz}}}}\n"
      "solver: {step: 0.7 ms}\n" /* does not divide the period */
      "run:\n"
      "  periods: 12\n"
      "  of: drive\n"
      "  measure:\n"
      "    last: 4\n"
      "    quantities: {power: {of: work.drives, take: rate},\n"
      "                 lost: {of: losses.total, take: change},\n"
      "                 same: {of: losses.members - work.drives, take: range},\n"
      "                 pull: {of: piston.force, take: max}, clock: {of: time, take: final},\n"
      "                 mean: {of: time}}\n");
  double w = 2 * PI * 5, power = 0.5 * 30 * pow(0.002 * w, 2);
  assert_all_relative(1e-4, value(&r, "power"), power, value(&r, "lost"), power * 4 / 5.0);
  assert_near(value(&r, "same"), 0, 1e-9);
  assert_relative(value(&r, "pull"), 30 * 0.002 * w, 1e-5);
  assert_all_relative(1e-9, value(&r, "clock"), 12 / 5.0, value(&r, "mean"), 10 / 5.0);
  /* each period's own value: power alike, the clock one period later each time */
  assert_within(get(&r, "power")->spread, 0, 1e-4 * power);
  assert_relative(get(&r, "clock")->spread, sqrt(5.0 / 3) / 5, 1e-9);
  assert_relative(get(&r, "mean")->spread, sqrt(5.0 / 3) / 5, 1e-9);
  assert_string_equal(get(&r, "power")->unit, "W");
}

/* Nothing cancels in a short way: a block at 1 m/s slides v^2 / (2 mu g), and its steps may be too long for that. */
TEST(a_short_way_is_not_rounding) {
  static const char *const methods[] = {"rk4-events", "euler-events"};
  static const double mu[] = {1e9, 1e6};
  for (int k = 0; k < 2; k++) {
    OWN(model_run) r = measured(model_read_format(
        "nodes: {n: {position: [0, -9.81e-5], mass: 1}}\n"
        "gravity: [0, -9.81]\n"
        "ground: {stiffness: 1e5, damping: 100, friction: {law: coulomb, mu: %g}}\n"
        "initial: {velocity: [1, 0]}\n"
        "solver: {step: 0.1 ms, integrator: %s}\n"
        "run: {duration: 1 s, measure: {quantities: {way: {of: n.x, take: final}}}}\n",
        mu[k], methods[k]));
    if (k == 0) assert_relative(value(&r, "way"), 1 / (2 * mu[k] * GRAVITY), 1e-6);
    assert_false(get(&r, "way")->zero || r.summary.velocity_zero);
  }
}

/* Two masses that swing against each other: the centre stays, to rounding. */
TEST(zero_by_symmetry) {
  OWN(model_run) r = run_text(
      "nodes: {a: {position: [-1/3, 0.2], mass: 0.7}, b: {position: [1/3, 0.2], mass: 0.7}}\n"
      "members: {spring: {nodes: [a, b], kind: spring, stiffness: 777, damping: 0.1}}\n"
      "initial: {velocities: {a: [-0.3, 0], b: [0.3, 0]}}\n"
      "solver: {step: 1 ms}\n"
      "run: {duration: 1.0123, measure: {quantities: {all: com.vx, one: b.vx,"
      " sum: a.x + b.x, up: {of: com.y, take: change}, tilt: {of: spring.angle, take: range}}}}\n");
  assert_true(r.summary.velocity_zero);
  assert_true(get(&r, "all")->zero && get(&r, "sum")->zero && get(&r, "up")->zero);
  assert_true(get(&r, "tilt")->zero);
  assert_false(get(&r, "one")->zero);
  assert_true(get(&r, "all")->scale > 0.01);
}

static const char HOPPER[] =
    "nodes: {a: {position: [0, 0.02], mass: 1}, b: {position: [0.3, 0.05], mass: 1}}\n"
    "members: {leg: {nodes: [a, b], kind: spring, stiffness: 3000, damping: 2}}\n"
    "gravity: [0, -9.81]\n"
    "ground: {stiffness: 1e5, damping: 30, friction: {mu: 0.4, stick_velocity: 1 mm/s}}\n"
    "actuators: {drive: {member: leg, signal: {sine: {amplitude: 20 mm, frequency: 6 Hz}}}}\n"
    "solver: {integrator: %s, step: 0.05 ms}\n"
    "run: {periods: 6, of: drive, measure: {last: 3%s}}\n";
static const char ALL[] =
    ", quantities: {n: a.normal, f: {of: b.friction, take: max}, w: {of: work.drives, take: rate},"
    " l: {of: leg.force, take: min}, e: {of: energy.total, take: final}, v: com.vx}";

static strut_summary hop(const char *method, const char *quantities, strut_setup *setup) {
  *setup = model_read_format(HOPPER, method, quantities).setup;
  return motion_simulate(setup);
}

/* Looking on changes no bit of the motion, and a scene without quantities has none. */
TEST(measuring_changes_nothing) {
  static const char *const methods[] = {"rk4", "verlet", "verlet-events", "rk4-events", "adaptive"};
  for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
    OWN(strut_setup) plain, more;
    OWN(strut_summary) s = hop(methods[i], "", &plain), m = hop(methods[i], ALL, &more);
    assert_true(s.measured_count == 0 && !s.measured && m.measured_count == 6);
    assert_int_equal(s.spent.evaluations, m.spent.evaluations);
    assert_same_bits(s.velocity, m.velocity);
    assert_same_bits(m.measured[5].value, m.velocity);
    assert_same_bits(s.energy.residual, m.energy.residual);
    for (size_t k = 0; k < 4; k++) assert_same_bits(s.end.positions[k], m.end.positions[k]);
    for (size_t k = 0; k < 6; k++) assert_true(isfinite(m.measured[k].value));
  }
}

/* Works are there where the run keeps no balance for itself. */
TEST(works_without_the_balance) {
  OWN(strut_setup) setup;
  OWN(strut_summary) with = hop("rk4", ALL, &setup), without;
  assert_ok(motion_try(&setup, (strut_run_options){.without_balance = true}, &without, NULL));
  assert_same_bits(without.measured[2].value, with.measured[2].value);
  assert_true(with.measured[2].value > 0);
}

/* A stopped window gives no number, and no crash. */
TEST(a_run_that_is_interrupted) {
  OWN(strut_setup) setup = model_read_format(HOPPER, "rk4", ALL).setup;
  OWN(strut_summary) s;
  strut_flag stop = 1;
  strut_run_options options = {.interrupt = &stop};
  assert_int_equal(motion_try(&setup, options, &s, NULL), STRUT_INTERRUPTED);
  for (size_t k = 0; k < 6; k++) assert_true(isnan(s.measured[k].value) && !s.measured[k].zero);
}

/* Twice as many steps take as many allocations. */
TEST(steps_allocate_nothing) {
  uint64_t count[2];
  for (int i = 0; i < 2; i++) {
    OWN(strut_setup) setup = model_read_format(HOPPER, "rk4", ALL).setup;
    OWN(strut_summary) s;
    setup.experiment.step /= 1 + i;
    OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
    uint64_t before = strut_allocation_count();
    assert_ok(strut_simulate(model, &setup.experiment, &(strut_run_options){0}, &s, NULL));
    count[i] = strut_allocation_count() - before;
  }
  assert_int_equal(count[0], count[1]);
}

/* Every allocation of reading and running fails once: an error, no crash and no leak. */
TEST(memory_that_runs_out) {
  char text[1400] = "strut: 1\n";
  snprintf(text + strlen(text), sizeof text - 100, HOPPER, "rk4", ALL);
  REFUSE_EACH(n, status, 20) {
    OWN(strut_setup) setup;
    OWN(strut_diagnostics) diagnostics = {0};
    status = refused(n, strut_setup_read(&setup, "test", text, strlen(text), NULL, 0, STRUT_FOR_RUN,
                                         &diagnostics));
  }
  OWN(strut_setup) setup = model_read_format(HOPPER, "rk4", ALL).setup;
  setup.experiment.step = 1e-4;
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  REFUSE_EACH(n, status, 5) {
    strut_run_options options = {0};
    OWN(strut_summary) s;
    status = refused(n, strut_simulate(model, &setup.experiment, &options, &s, NULL));
  }
}

/* Driven at 1 Hz and 0.5 Hz, of which the first counts: a motion of two periods. */
TEST(a_steady_run_measures_its_whole_orbit) {
  OWN(model_run) r = run_text(
      "nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: 1 kg, fixed: "
      "y}}\n"
      "members: {spring: {nodes: [wall, block], kind: spring, stiffness: 100, damping: 4}}\n"
      "loads: {push: {node: block, force: [1 N, 0],"
      " signal: {sine: {amplitude: 1, frequency: 1 Hz}}},"
      " slow: {node: block, force: [1 N, 0], signal: {sine: {amplitude: 1, frequency: 0.5 Hz}}}}\n"
      "solver: {step: 1 ms}\n"
      "run: {periods: 400, of: push, measure: {steady: true, quantities:"
      " {clock: {of: time, take: change}, far: {of: block.x, take: change},"
      " mean: spring.stretch, high: {of: block.x, take: max}}}}\n");
  assert_int_equal(r.summary.steady.kind, STRUT_MOTION_PERIODIC);
  assert_int_equal(r.summary.steady.repeats, 2);
  assert_relative(value(&r, "clock"), 2, 1e-9);
  assert_all_near(1e-5, value(&r, "far"), 0, value(&r, "mean"), 0);
  assert_relative(get(&r, "clock")->spread + 1, 1, 1e-9);
  assert_true(get(&r, "high")->spread > 1e-3); /* the two periods differ */
}

/* A mass on an arm with a hinge: sqrt(kappa/(m l^2)) = 2 rad/s, 0.3 rad about the rest angle. */
TEST(a_hinge_swings) {
  OWN(model_run) r = run_text(
      "nodes: {a: {position: [-1, 0], fixed: both}, o: {position: [0, 0], fixed: both},"
      " c: {position: [1, 0], mass: 0.5 kg}}\n"
      "members: {arm: {nodes: [o, c], kind: bar, stiffness: 1e6}}\n"
      "hinges: {h: {nodes: [a, o, c], stiffness: 2 N m/rad, rest_angle: 180 deg}}\n"
      "initial: {positions: {c: [cos(0.3), sin(0.3)]}}\n"
      "solver: {step: pi/6000}\n"
      "run: {duration: pi, measure: {quantities: {angle: h.angle, far: {of: h.angle, take: range},"
      " rate: {of: h.rate, take: max}, mean: h.rate, moment: {of: h.moment, take: min}}}}\n");
  assert_near(value(&r, "angle"), PI, 1e-6);
  assert_relative(value(&r, "far"), 0.6, 1e-6);
  assert_relative(value(&r, "rate"), 0.6, 1e-5);
  assert_relative(value(&r, "moment"), -0.6, 1e-6);
  assert_near(value(&r, "mean"), 0, 1e-6);
  assert_all_texts(get(&r, "rate")->unit, "rad/s", get(&r, "moment")->unit, "N m");
}

/* A running cable's length is its path's; its stretch is the tension over the stiffness. */
TEST(a_running_cable) {
  OWN(model_run) r = run_text(
      "nodes: {low: {position: [0, -1], mass: 3 kg}, left: {position: [0, 0], fixed: both},"
      " right: {position: [1, 0], fixed: both}, high: {position: [1, -2], mass: 1 kg}}\n"
      "gravity: [0, -10]\n"
      "members: {rope: {nodes: [low, left, right, high], kind: cable, stiffness: 3 kN/m,"
      " pretension: 15 N}}\n" /* 2 m1 m2 g/(m1 + m2) */
      "solver: {step: 1 ms}\n"
      "run: {duration: 0.4 s, measure: {quantities: {force: rope.force, stretch: rope.stretch,"
      " length: {of: rope.length, take: final}, rate: {of: rope.rate, take: max},"
      " fall: {of: low.y, take: change}}}}\n");
  assert_relative(value(&r, "force"), 15, 1e-12);
  assert_relative(value(&r, "stretch"), 0.005, 1e-10);
  assert_relative(value(&r, "length"), 4, 1e-12);
  assert_near(value(&r, "rate"), 0, 1e-12);
  assert_relative(value(&r, "fall"), -0.4, 1e-12); /* 5 m/s^2 */
}

/*
 * A ball without weight meets the ground for half a period of sqrt(k/m): each way of taking its force, by
 * every method that steps over contacts, whose steps pass over the greatest force.
 */
TEST(a_blow_between_steps) {
  static const char text[] =
      "gravity: [0, 0]\n"
      "nodes: {ball: {position: [0, 0.5], mass: 0.1}}\n"
      "ground: {stiffness: 2e4}\n"
      "initial: {velocities: {ball: [0, -2]}}\n"
      "solver: {integrator: %s, step: %s}\n"
      "run:\n"
      "  duration: 0.4 s\n"
      "  measure:\n"
      "    quantities:\n"
      "      blow: {of: ball.normal, take: max}\n"
      "      span: {of: ball.normal, take: range}\n"
      "      mean: {of: ball.normal, take: mean}\n"
      "      rms: {of: ball.normal, take: rms}\n"
      "      rise: {of: ball.normal, take: rise}\n"
      "      deep: {of: ball.height, take: min}\n"
      "      stored: {of: energy.contact, take: max}\n"
      "      slow: {of: abs(ball.vy), take: min}\n"
      "      half: {of: ball.normal, take: arrival, target: 44.721359549995796 N}\n";
  const double m = 0.1, k = 2e4, v = 2.0, w = sqrt(k / m), peak = v * sqrt(k * m), time = 0.4;
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    const bool adaptive = strut_experiment_is_adaptive(method->name);
    const double close = adaptive ? 1e-5 : method->order < 2 ? 2e-2 : 1e-2;
    /* between the ends of steps positions are of fifth degree, whatever the order of the method */
    const char *step = !adaptive ? "0.31 ms" : method->order > 5 ? "1 ms" : "10 ms";
    if (method->no_ground) continue;
    OWN(model_run) r = measured(model_read_format(text, method->name, step));
    assert_all_relative(close, value(&r, "blow"), peak, value(&r, "span"), peak);
    assert_relative(value(&r, "mean") * time, 2 * m * v, close);
    assert_relative(value(&r, "rms") * value(&r, "rms") * time, peak * peak * PI / (2 * w), close);
    assert_all_relative(close, value(&r, "rise"), peak, value(&r, "deep"), -v / w);
    assert_relative(value(&r, "stored"), 0.5 * m * v * v, close);
    assert_true(fabs(value(&r, "slow")) < 0.01 * close * v);
    assert_relative(value(&r, "half"), 0.5 / v + asin(0.5) / w, 0.1 * close);
    assert_int_equal(r.summary.warning_count, 0);
  }
}

/* Fixed steps that are too coarse for a greatest force say so. */
TEST(a_step_too_coarse_for_a_peak) {
  static const char text[] =
      "parameters: {dt: 1 ms}\n"
      "nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: 2 kg, fixed: "
      "y}}\n"
      "members: {spring: {nodes: [wall, block], kind: spring, stiffness: 5 kN/m}}\n"
      "initial: {positions: {block: [1.1, 0]}}\n"
      "solver: {step: dt}\n"
      "run: {duration: 1 s, measure: {quantities: {p: {of: spring.force * block.vx, take: "
      "max}}}}\n";
  model_run r = run_text(text);
  assert_relative(value(&r, "p"), 0.5 * 5000 * 0.1 * 0.1 * 50, 1e-5);
  assert_int_equal(r.summary.warning_count, 0);
  model_run_free(&r);
  r = measured(model_read_text("test", text, set_to("dt=20 ms")));
  bool warned = false;
  for (size_t i = 0; i < r.summary.warning_count; i++)
    warned = warned || (strcmp(r.summary.warnings[i].code, "coarse_step") == 0 &&
                        strstr(r.summary.warnings[i].text, "'p'"));
  assert_true(warned);
  model_run_free(&r);
}
