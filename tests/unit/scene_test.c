/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defaults; the four ways to give a rest length; what an experiment amounts to. */
#include "engine/scene/experiment.h"
#include "tests/support/check.h"

/* One member of drawn length 5. */
static strut_node nodes[2] = {{.name = "a", .position = {1, 1}}, {.name = "b", .position = {4, 5}}};

static bool resolve(strut_member member, strut_rest *rest) {
  strut_setup setup;
  strut_setup_init(&setup);
  member.node[0] = 0, member.node[1] = 1;
  setup.scene.nodes = nodes, setup.scene.node_count = 2;
  setup.scene.members = &member, setup.scene.member_count = 1;
  return strut_member_rest(&setup.scene, 0, rest);
}

TEST(defaults) {
  strut_setup setup;
  memset(&setup, 0x55, sizeof setup);
  strut_setup_init(&setup);
  assert_all_texts(setup.scene.name, "", setup.experiment.integrator, "rk4");
  assert_int_equal(setup.experiment.channels,
                   STRUT_CHANNEL_POSITION | STRUT_CHANNEL_LENGTH | STRUT_CHANNEL_FORCE);
  assert_all_equal(setup.experiment.period_signal, -1, setup.experiment.measure_node, -1);
  assert_true(!setup.experiment.settle.wanted && setup.experiment.settle.speed == 1e-8 &&
              setup.experiment.settle.acceleration == 1e-8 && setup.experiment.settle.limit == 100);
  assert_int_equal(setup.scene.node_count + setup.scene.member_count + setup.scene.contact_count,
                   0);
  strut_member member = strut_member_default();
  assert_true(member.node[0] == -1 && member.node[1] == -1);
  assert_true(member.rest_kind == STRUT_REST_RATIO && member.rest_value == 1);
  assert_int_equal(strut_contact_default().node, -1);
  assert_true(strut_node_default().mass == 0);
  strut_setup_free(&setup);
  assert_null(setup.scene.nodes);
}

/* Each of the four ways leads to the other three, for a stiffness and for EA. */
TEST(the_four_ways_agree) {
  for (int by_ea = 0; by_ea < 2; by_ea++)
    for (double ratio = 0.5; ratio < 2; ratio += 0.19) {
      strut_member m = strut_member_default();
      m.kind = STRUT_SPRING;
      if (by_ea)
        m.axial_stiffness = 70;
      else
        m.stiffness = 20;
      double length = 5 * ratio, stiffness = by_ea ? 70 / length : 20;
      double force = stiffness * (5 - length);
      const double values[] = {ratio, length, force, force / 5};
      for (int kind = 0; kind < 4; kind++) {
        strut_rest r;
        m.rest_kind = (strut_rest_kind)kind, m.rest_value = values[kind];
        assert_true(resolve(m, &r));
        assert_near(r.drawn_length, 5, 0);
        assert_near(r.length, length, 1e-14 * 50);
        assert_near(r.ratio, ratio, 1e-14 * 50);
        assert_near(r.stiffness, stiffness, 1e-12);
        assert_near(r.pretension, force, 1e-12);
        assert_near(r.force_density, force / 5, 1e-12);
      }
    }
}

TEST(what_was_given_is_kept) {
  strut_member m = strut_member_default();
  strut_rest r;
  m.stiffness = 3;
  m.rest_kind = STRUT_REST_PRETENSION, m.rest_value = 0.1;
  assert_true(resolve(m, &r));
  assert_true(r.pretension == 0.1);
  m.rest_kind = STRUT_REST_LENGTH, m.rest_value = 0.7;
  assert_true(resolve(m, &r));
  assert_true(r.length == 0.7);
}

TEST(a_slack_cable_has_no_pretension) {
  strut_member m = strut_member_default();
  strut_rest r;
  m.kind = STRUT_CABLE, m.stiffness = 10;
  m.rest_kind = STRUT_REST_LENGTH, m.rest_value = 6;
  assert_true(resolve(m, &r));
  assert_true(r.pretension == 0 && r.force_density == 0 && r.length == 6);
  m.kind = STRUT_BAR;
  assert_true(resolve(m, &r));
  assert_true(r.pretension == -10);
}

TEST(impossible_rests_are_refused) {
  strut_rest r;
  strut_member m = strut_member_default();
  m.damping = 1;
  m.rest_kind = STRUT_REST_PRETENSION, m.rest_value = 1;
  assert_false(resolve(m, &r)); /* no stiffness */
  m.rest_value = 0;
  assert_true(resolve(m, &r));
  assert_true(r.length == 5 && r.stiffness == 0);
  m.stiffness = 10, m.rest_value = 51;
  assert_false(resolve(m, &r)); /* below zero */
  m.rest_value = 50;
  assert_true(resolve(m, &r));
  assert_true(r.length == 0);
  m.stiffness = 0, m.axial_stiffness = 10, m.rest_value = -10;
  assert_false(resolve(m, &r));
  m.rest_kind = STRUT_REST_LENGTH, m.rest_value = 0;
  assert_false(resolve(m, &r)); /* infinite stiffness */
  m.axial_stiffness = 0, m.stiffness = 1;
  assert_true(resolve(m, &r));
  m.rest_value = -1;
  assert_false(resolve(m, &r));
  m.rest_value = (double)NAN;
  assert_false(resolve(m, &r));
}

TEST(a_span_in_seconds) {
  strut_setup setup;
  strut_setup_init(&setup);
  setup.experiment.duration = 8;
  strut_span span = strut_experiment_span(&setup.experiment, &setup.scene);
  assert_true(span.duration == 8 && span.period == 0 && span.window_start == 0);
  assert_true(span.record_start == 0 && span.record_every == 0.008);
  setup.experiment.measure_last = 2, setup.experiment.output_last = 3;
  setup.experiment.output_every = 0.25;
  span = strut_experiment_span(&setup.experiment, &setup.scene);
  assert_true(span.window_start == 6 && span.record_start == 5 && span.record_every == 0.25);
}

TEST(a_span_in_periods) {
  strut_signal signal = strut_signal_default(STRUT_SINE);
  strut_setup setup;
  strut_setup_init(&setup);
  signal.frequency = 4;
  setup.scene.signals = &signal, setup.scene.signal_count = 1;
  setup.experiment.periods = 100, setup.experiment.period_signal = 0;
  setup.experiment.measure_last = 20, setup.experiment.output_last = 40;
  strut_span span = strut_experiment_span(&setup.experiment, &setup.scene);
  assert_true(span.duration == 25 && span.period == 0.25);
  assert_true(span.window_start == 20 && span.record_start == 15 && span.record_every == 0.01);
}
