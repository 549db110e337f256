/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One settling for whoever starts from it: the same bits, bounded, and judged for stability. */
#include "engine/run/settle.h"
#include "engine/output/trajectory.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/statics/equilibria/equilibria.h"
#include "tests/support/motion.h"

static const double G = 9.81;

/* A mass of 1 kg on a rod of 1 m, its pin in the origin, `angle` from upright. */
static strut_setup rod(double stiffness, double angle) {
  strut_setup setup = build_tethered(sin(angle), cos(angle), 1);
  build_sized(&setup.scene, STRUT_BAR, 0, 1, stiffness, 10, 0, 1);
  setup.scene.gravity[1] = -G;
  setup.experiment.settle.wanted = true;
  motion_experiment(&setup, 1e-3, 0.1);
  return setup;
}

typedef struct settled {
  double q[64];
  strut_settle_summary how;
  strut_error error;
  strut_status status;
} settled;

static settled settle(const strut_setup *setup) {
  settled s = {.how.time = 0};
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  assert_true(model->length <= 64);
  s.status = strut_settle_experiment(model, &setup->experiment, NULL, s.q, &s.how, &s.error);
  return s;
}

static settled settle_well(const strut_setup *setup) {
  settled s = settle(setup);
  assert_ok(s.status);
  return s;
}

TEST(an_upright_rod_is_unstable) {
  OWN(strut_setup) setup = rod(1e5, 0);
  settled s = settle_well(&setup);
  double length = 1 - G / 1e5;
  assert_near(s.q[3], length, 1e-12);
  assert_true(s.how.unstable);
  assert_string_equal(s.how.node, setup.scene.nodes[1].name);
  assert_all_relative(1e-9, s.how.stiffness, -G / length, s.how.growth_rate, sqrt(G / length));
  char text[300];
  assert_true(strut_settle_warning(&s.how, text, sizeof text));
  assert_non_null(strstr(text, setup.scene.nodes[1].name));
}

/* A rod 1e6 times as stiff: the same instability beside a stiffness that is 1e10 times larger. */
TEST(a_stiff_rod_is_as_unstable) {
  OWN(strut_setup) setup = rod(1e11, 0);
  setup.experiment.step = 1e-7;
  settled s = settle_well(&setup);
  assert_true(s.how.unstable);
  assert_relative(s.how.growth_rate, sqrt(G), 1e-6);
}

TEST(a_perturbed_rod_hangs) {
  OWN(strut_setup) setup = rod(1e5, 0);
  setup.experiment.settle.perturb = true;
  settled s = settle_well(&setup);
  assert_false(s.how.unstable);
  assert_int_equal(s.how.perturbations, 1);
  assert_near(s.q[2], 0, 1e-7);
  assert_near(s.q[3], -1 - G / 1e5, 1e-9);
  settled again = settle(&setup);
  assert_memory_equal(s.q, again.q, sizeof s.q);
  char text[300];
  assert_false(strut_settle_warning(&s.how, text, sizeof text));
}

/* Nothing is perturbed that is stable: the bits are those without the key. */
TEST(a_stable_rest_is_left_alone) {
  OWN(strut_setup) setup = rod(1e5, 3.0);
  settled s = settle(&setup);
  setup.experiment.settle.perturb = true;
  settled perturbed = settle(&setup);
  assert_false(s.how.unstable);
  assert_int_equal(perturbed.how.perturbations, 0);
  assert_memory_equal(s.q, perturbed.q, sizeof s.q);
}

/* Motions without stiffness are none that grow: two masses that float, a block that slides. */
TEST(free_motions_are_not_unstable) {
  OWN(strut_setup) setup = build_setup();
  for (int i = 0; i < 3; i++) build_mass(&setup.scene, 0.3 * i, 0.4 * (i % 2), 1 + i);
  for (int32_t i = 0; i < 3; i++)
    build_sized(&setup.scene, STRUT_BAR, i, (i + 1) % 3, 1e4, 1, 0, 0.5);
  setup.experiment.settle.wanted = true;
  motion_experiment(&setup, 1e-3, 0.1);
  assert_false(settle_well(&setup).how.unstable);
  for (int32_t i = 0; i < 2; i++) build_contact(&setup.scene, 2 * i, 1e4, 10);
  setup.scene.gravity[1] = -G;
  assert_false(settle_well(&setup).how.unstable);
}

/* A block that friction keeps on a slope is held there. */
TEST(what_friction_holds_is_not_unstable) {
  OWN(strut_setup) setup = build_falling();
  build_rough_contact(&setup.scene, build_mass(&setup.scene, 0, 0, 1), 1e4, 10, 0.5, 0.5, 1e-3);
  setup.scene.ground.slope = 0.2;
  motion_experiment(&setup, 1e-4, 0.01);
  setup.experiment.settle.wanted = setup.experiment.settle.friction = true;
  setup.experiment.settle.acceleration = 1e-6;
  assert_false(settle_well(&setup).how.unstable);
}

/* A node that a spring above it presses on the ground: Karnopp's law keeps it there, a smooth one does not. */
TEST(smooth_friction_holds_nothing) {
  OWN(strut_setup) setup = build_setup();
  int32_t above = build_support(&setup.scene, 0, 1), node = build_mass(&setup.scene, 0, 0, 1);
  build_sized(&setup.scene, STRUT_SPRING, above, node, 100, 10, 0, 1.1);
  build_rough_contact(&setup.scene, node, 1e4, 10, 0.5, 0.5, 1e-3);
  motion_experiment(&setup, 1e-4, 0.01);
  setup.experiment.settle.wanted = setup.experiment.settle.friction = true;
  assert_false(settle(&setup).how.unstable);
  ((strut_contact *)setup.scene.contacts)[0].friction.law = STRUT_FRICTION_SMOOTH;
  ((strut_contact *)setup.scene.contacts)[0].friction.width = 1e-3;
  settled s = settle_well(&setup);
  double depth = 100 * 0.1 / (100 + 1e4), length = 1 + depth;
  assert_true(s.how.unstable);
  assert_relative(s.how.stiffness, -100 * (1.1 - length) / length, 1e-6);
}

/* What method, step or accuracy a run has: it starts from the same bits. */
TEST(every_method_starts_from_the_same_bits) {
  static const char *const method[] = {"verlet", "verlet-events", "adaptive", "midpoint", "euler"};
  OWN(strut_setup) setup = rod(1e5, 2.5);
  setup.experiment.settle.step = 1e-3; /* as the parser takes it from the file's solver.step */
  settled first = settle_well(&setup);
  for (size_t i = 0; i < sizeof method / sizeof method[0]; i++) {
    setup.experiment.integrator = method[i];
    setup.experiment.step = 1e-2 / (double)(1 << i);
    settled s = settle_well(&setup);
    assert_memory_equal(s.q, first.q, sizeof s.q);
    assert_int_equal(s.how.evaluations, first.how.evaluations);
  }
}

TEST(an_accurate_run_starts_where_the_plain_one_does) {
  OWN(strut_trajectory) plain = {0}, accurate = {0};
  OWN(strut_summary) s, t;
  OWN(strut_setup) setup = rod(1e5, 0);
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  strut_trajectory *const taken[] = {&plain, &accurate};
  for (int i = 0; i < 2; i++) {
    strut_sink *sink = strut_trajectory_sink(taken[i], &setup.scene, STRUT_CHANNEL_POSITION, 1000);
    const strut_run_options options = {.sinks = &sink, .sink_count = 1};
    setup.experiment.accuracy = 0.01 * i;
    assert_ok(i ? strut_simulate_accurately(model, &setup.experiment, &options, &t, NULL)
                : strut_simulate(model, &setup.experiment, &options, &s, NULL));
    strut_trajectory_sink_free(sink);
  }
  assert_true(plain.frames > 0 && accurate.frames > 0);
  assert_memory_equal(plain.position, accurate.position, 4 * sizeof *plain.position);
  assert_true(s.settle.unstable && t.settle.unstable);
  assert_int_equal(s.settle.evaluations, t.settle.evaluations); /* of one settling */
  assert_same_bits(s.settle_time, t.settle_time);
}

/* `start` of statics is that state too; its list of equilibria knows it as the saddle it is. */
TEST(statics_start_from_the_same_bits) {
  for (int perturb = 0; perturb < 2; perturb++) {
    OWN(strut_setup) setup = rod(1e5, 0);
    setup.experiment.settle.perturb = perturb;
    settled s = settle(&setup);
    OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
    OWN(strut_arena) arena = {0};
    strut_rest_state stand;
    assert_ok(strut_rest_state_find(model, &setup.experiment, NULL, &arena, &stand, NULL));
    assert_memory_equal(stand.q, s.q, (size_t)model->length * sizeof *s.q);
    assert_true(stand.at_rest);
    assert_int_equal(stand.settle.unstable, !perturb);
    strut_equilibria_options options = {0};
    OWN(strut_equilibria) all;
    assert_ok(strut_equilibria_find(model, &setup.experiment, &options, &all, NULL));
    assert_true(all.start >= 0);
    assert_int_equal(all.list[all.start].point.label, perturb ? STRUT_STABLE : STRUT_SADDLE);
  }
}

/* A mass that falls for ever: it ends after so many evaluations, and says who moves and how fast. */
TEST(settling_is_bounded_in_work) {
  OWN(strut_setup) setup = build_falling();
  build_mass(&setup.scene, 0, 0, 1);
  motion_experiment(&setup, 1e-3, 0.1);
  setup.experiment.settle.wanted = true;
  setup.experiment.settle.evaluations = 4000;
  settled s = settle(&setup); /* 9.81 m/s after 1000 steps of 1 ms */
  assert_fails(s.status, STRUT_NOT_SETTLED, s.error, "4000 evaluations", setup.scene.nodes[0].name,
               "9.81 m/s", "initial.settle.evaluations");
}

/* A step above the stability limit, and none at all: it is chosen. */
TEST(a_step_that_is_not_stable_is_replaced) {
  static const double step[] = {0.1, -1};
  for (size_t i = 0; i < 2; i++) {
    OWN(strut_setup) setup = rod(1e5, 2.5);
    setup.experiment.settle.step = step[i];
    settled s = settle_well(&setup);
    assert_within(s.how.step, 1e-3, 2.83 / sqrt(1e5));
    assert_near(s.q[3], -1 - G / 1e5, 1e-9);
  }
}
