/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Implicit midpoint: steps a hundred times the explicit limit on stiff members, the work that closes
 * the energy balance to rounding, and what it refuses.
 */
#include "engine/forces/forces.h"
#include "engine/integrate/limit/step_limit.h"
#include "tests/physics/random_scene.h"
#include "tests/support/structures.h"

static double explicit_limit(const strut_setup *setup) {
  strut_step_limit limit;
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  assert_ok(strut_step_limit_estimate(model, &limit, NULL));
  return limit.of[STRUT_REGION_RK4];
}

static strut_summary run_by(strut_setup *setup, const char *method, double step, double duration) {
  setup->experiment.integrator = method;
  motion_experiment(setup, step, duration);
  return motion_simulate(setup);
}

static double farthest(const strut_summary *a, const strut_summary *b) {
  double most = 0.0;
  for (size_t i = 0; i < 2 * a->end.node_count; i++)
    most = fmax(most, fabs(a->end.positions[i] - b->end.positions[i]));
  return most;
}

/* A uniform rod let go horizontally, T = 4 sqrt(2 L / 3 g) K(sin 45 deg) where it is rigid. */
static strut_setup pendulum(double stiffness) {
  strut_setup setup = build_falling();
  int32_t pin = build_support(&setup.scene, 0, 0), tip = build_node(&setup.scene, 1, 0);
  build_member(&setup.scene, STRUT_BAR, pin, tip, stiffness, 0, 1);
  return setup;
}

TEST(stiff_pendulum_is_the_rigid_one) {
  const double period = 4.0 * sqrt(2.0 / (3.0 * 9.81)) * 1.8540746773013719;
  for (double stiffness = 1e8; stiffness < 2e12; stiffness *= 100) {
    double error[3];
    for (int k = 0; k < 3; k++) {
      OWN(strut_setup) setup = pendulum(stiffness);
      OWN(strut_summary) s = run_by(&setup, "midpoint", period / (100 << k), 10.25 * period);
      error[k] = hypot(s.end.positions[2], s.end.positions[3] + 1.0);
      assert_near(s.energy.residual, 0.0, 1e-9 * s.energy.moved + 1e-9);
    }
    assert_within(observed_order(error, 3), 1.9, 2.1);
  }
}

/* A closed frame, spinning and vibrating, at 100 times the largest step of RK4. */
TEST(energy_of_a_stiff_frame) {
  OWN(strut_setup) setup;
  const x_frame frame = {1, 200, .cable = {1e7, 0, 0.1}, .bar = {1e9, 0, 1}};
  strut_setup_init(&setup);
  structure_x_frame(&setup.scene, &frame);
  structure_throw(&setup.scene, 1.0, -2.0, 0.5);
  setup.scene.nodes[0].velocity[0] += 0.1;
  double step = 100.0 * explicit_limit(&setup), most = 0.0;
  OWN(motion) m = motion_begin_by(&setup, "midpoint", step);
  strut_energies start = strut_energy_evaluate(m.model, m.state, 0.0);
  double whole = start.kinetic + start.elastic;
  for (int k = 0; k < 1000; k++) {
    motion_steps(&m, 100);
    assert_int_equal(m.state->trouble, 0);
    strut_energies now = strut_energy_evaluate(m.model, m.state, (double)m.state->step * step);
    most = fmax(most, fabs(now.kinetic + now.elastic - whole));
  }
  /* rounding of the bars' forces, c L eps, times the way of a step, at random over all steps */
  double rounding = 1e9 * 1.4 * 0x1p-52 * step * 2.3 * sqrt(1e5);
  assert_near(most, 0.0, rounding);
}

/* Masses in a row on soft springs and, every other one, on bars a million times as stiff. */
static strut_setup chain(double ratio) {
  strut_setup setup = build_falling();
  int32_t last = build_support(&setup.scene, 0, 0);
  for (int i = 1; i <= 20; i++) {
    int32_t next = build_mass(&setup.scene, 0.1 * i, 0.02 * (i % 2), 0.1);
    build_member(&setup.scene, i % 2 ? STRUT_SPRING : STRUT_BAR, last, next,
                 i % 2 ? 100.0 : 100.0 * ratio, 0, 0);
    last = next;
  }
  return setup;
}

TEST(stiff_chain_against_rk4) {
  const double duration = 0.5;
  OWN(strut_setup) setup = chain(1e6);
  double limit = explicit_limit(&setup), error[3];
  OWN(strut_summary) exact = run_by(&setup, "rk4", 0.25 * limit, duration);
  OWN(strut_summary) usual = run_by(&setup, "rk4", 0.95 * limit, duration);
  for (int k = 0; k < 3; k++) {
    OWN(strut_summary) s = run_by(&setup, "midpoint", ldexp(100.0 * limit, -k), duration);
    error[k] = farthest(&s, &exact);
    double saving = (double)usual.spent.evaluations / (double)s.spent.evaluations;
    if (k == 0) assert_true(saving > 20.0);
  }
  assert_true(error[0] < 0.04 && error[1] < 0.6 * error[0] && error[2] < 0.6 * error[1]);
}

/*
 * Everything that scenes without ground have: cables that go slack, dampers, drives and loads of all
 * kinds, rest lengths of zero. What is left of the error is compared with RK4 at a fine step; the
 * balance closes whatever the step.
 */
TEST(random_scenes) {
  enum { SCENES = 30 };
  const double duration = 0.25;
  double balance = 0.0;
  int better = 0;
  for (uint64_t seed = 1; seed <= SCENES; seed++) {
    OWN(strut_setup) setup = build_setup();
    random_scene(&setup.scene, seed);
    setup.scene.contact_count = 0;
    setup.scene.ground.present = false;
    for (size_t i = 0; i < setup.scene.member_count;
         i++) /* a damper turns round where it has no length */
      if (setup.scene.members[i].stiffness > 0.0 && setup.scene.members[i].rest_value == 0.0)
        setup.scene.members[i].damping = 0.0;
    double fine = fmin(5e-6, 0.2 * explicit_limit(&setup));
    OWN(strut_summary) exact = run_by(&setup, "rk4", fine, duration);
    OWN(strut_summary) coarse = run_by(&setup, "midpoint", 1.6e-3, duration);
    OWN(strut_summary) s = run_by(&setup, "midpoint", 1e-4, duration);
    double before = farthest(&coarse, &exact), error = farthest(&s, &exact);
    balance = fmax(balance, fabs(coarse.energy.residual) / (coarse.energy.moved + 1.0));
    balance = fmax(balance, fabs(s.energy.residual) / (s.energy.moved + 1.0));
    better += error < 0.25 * before;
  }
  /* with 0.1 ms than with 1.6 ms; where forces jump it is 16, with chaos nothing */
  assert_within(better, SCENES - 3, SCENES);
  assert_within(balance, 0, 1e-9);
}

/* The same without jumps: what a cable loses with its tension, and signals that begin, end or turn. */
static void take_jumps_out(strut_setup *setup) {
  setup->scene.contact_count = 0;
  setup->scene.ground.present = false;
  for (size_t i = 0; i < setup->scene.member_count; i++) {
    strut_member *m = &setup->scene.members[i];
    if (m->stiffness > 0.0 && (m->rest_value == 0.0 || m->kind == STRUT_CABLE)) m->damping = 0.0;
    if (m->kind == STRUT_CABLE && !(m->stiffness > 0.0)) m->kind = STRUT_SPRING;
  }
  for (size_t i = 0; i < setup->scene.signal_count; i++) {
    strut_signal *s = &setup->scene.signals[i];
    s->start = 0.0, s->stop = HUGE_VAL;
    if (s->kind == STRUT_CONSTANT || s->kind == STRUT_SUM) continue;
    s->kind = STRUT_SINE;
    if (!(s->frequency > 0.0)) s->frequency = 3.0;
  }
}

/* Of each scene, not of most: the error against RK4 falls by 4 when the step is halved. */
TEST(order_on_random_scenes) {
  enum { SCENES = 40 };
  const double duration = 0.016;
  double least = HUGE_VAL, most = 0.0;
  for (uint64_t seed = 1; seed <= SCENES; seed++) {
    OWN(strut_setup) setup = build_setup();
    random_scene(&setup.scene, seed);
    take_jumps_out(&setup);
    OWN(strut_summary) exact = run_by(&setup, "rk4", 1e-6, duration);
    double error[3];
    for (int k = 0; k < 3; k++) {
      OWN(strut_summary) s = run_by(&setup, "midpoint", ldexp(8e-5, -k), duration);
      error[k] = farthest(&s, &exact);
    }
    for (int k = 0; k < 2; k++) {
      double factor = error[k] / error[k + 1];
      least = fmin(least, factor), most = fmax(most, factor);
    }
  }
  assert_within(least, 3.9, 4.0);
  assert_within(most, 4.0, 4.1);
}

/* A mass on a cable with a damper, thrown through its slack length again and again: 1000 steps. */
TEST(cable_in_large_steps) {
  OWN(strut_setup) setup = build_falling();
  int32_t hook = build_support(&setup.scene, 0, 0), mass = build_mass(&setup.scene, 0.4, -0.2, 1);
  build_sized(&setup.scene, STRUT_CABLE, hook, mass, 1e8, 100, 0, 1.0);
  OWN(strut_summary) s = run_by(&setup, "midpoint", 100 * sqrt(8.0 / 1e8), 30.0);
  assert_near(s.energy.residual, 0.0, 1e-9 * s.energy.moved);
  assert_true(hypot(s.end.positions[2], s.end.positions[3]) < 1.01);
  assert_true(s.energy.dissipated_members > 0.0);
}

/* A swing of small amplitude: midpoint turns by 2 atan(omega h / 2) in a step. */
TEST(frequency_is_that_of_midpoint) {
  OWN(strut_setup) setup = build_setup();
  int32_t wall = build_support(&setup.scene, 0, 0), mass = build_mass(&setup.scene, 1, 0, 2);
  build_sized(&setup.scene, STRUT_SPRING, wall, mass, 50, 0, 0, 0.9);
  setup.scene.nodes[mass].fixed[1] = true;
  double turn = 2.0 * atan(0.5 * 5.0 * 0.3);
  OWN(motion) m = motion_begin_by(&setup, "midpoint", 0.3);
  for (int n = 1; n <= 1000; n++) {
    motion_steps(&m, 1);
    assert_near(m.state->q[2 * mass], 0.9 + 0.1 * cos(n * turn), 1e-12);
    assert_near(m.state->v[2 * mass], -0.5 * sin(n * turn), 1e-11);
  }
}

static void expect_refusal(strut_setup *setup, const char *word) {
  strut_error error = {0};
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  setup->experiment.integrator = "midpoint";
  assert_fails(strut_integrator_check(model, &setup->experiment, &error), STRUT_USAGE, error, word);
}

TEST(refusals) {
  OWN(strut_setup) setup = pendulum(1e6);
  setup.scene.bar_model = STRUT_BARS_RIGID;
  expect_refusal(&setup, "rigid");
  setup.scene.bar_model = STRUT_BARS_ELASTIC;
  build_contact(&setup.scene, 1, 1e4, 0);
  expect_refusal(&setup, "'n2' may touch the ground");
}

/* A force that no number of metres a second goes with. */
TEST(no_solution_is_named) {
  OWN(strut_summary) s;
  strut_error error = {0};
  OWN(strut_setup) setup = pendulum(1e6);
  strut_signal late = strut_signal_default(STRUT_CONSTANT);
  late.amplitude = 1e300, late.start = 0.5;
  build_load(&setup.scene, 1, 1e9, 0, build_signal(&setup.scene, late));
  setup.experiment.integrator = "midpoint";
  motion_experiment(&setup, 0.01, 1.0);
  assert_fails(motion_try(&setup, (strut_run_options){0}, &s, &error), STRUT_DIVERGED, error,
               "no solution of its step at t = 0.5 s", "node 'n2'", "smaller step");
  assert_int_equal(s.spent.steps, 50);
}
