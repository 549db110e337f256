/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run ends at the time that was asked for, whatever its step, and so does what is recorded. */
#include "engine/output/trajectory.h"
#include "tests/support/motion.h"

static const double PI = 3.14159265358979323846;
static const double SPEED = 0.3, PUSH = 5, MASS = 2, FREQUENCY = 7.3, STEP = 1e-3;

/* A mass that a load pushes to and fro, beside one on a driven spring. */
static strut_setup pushed(const char *method, double step, double duration) {
  strut_setup setup = build_setup();
  build_mass(&setup.scene, 0, 0, MASS);
  build_support(&setup.scene, 0, 1);
  build_mass(&setup.scene, 1, 1, 1);
  build_member(&setup.scene, STRUT_SPRING, 1, 2, 100, 1, 0);
  setup.scene.nodes[0].velocity[0] = SPEED;
  build_load(&setup.scene, 0, PUSH, 0, build_sine(&setup.scene, 1, FREQUENCY));
  build_actuator(&setup.scene, 0, build_sine(&setup.scene, 0.1, 1.3 * FREQUENCY));
  motion_experiment_by(&setup, step, duration, method);
  setup.experiment.tolerance = 1e-10;
  return setup;
}

static double place_at(double t) {
  double w = 2 * PI * FREQUENCY;
  return SPEED * t + PUSH / (MASS * w) * (t - sin(w * t) / w);
}

/* Runs and records positions, at times that increase. */
static strut_summary record(const strut_setup *setup, strut_run_options options,
                            strut_trajectory *t) {
  strut_summary s;
  strut_error error = {0};
  *t = (strut_trajectory){0};
  strut_sink *sink =
      strut_trajectory_sink(t, &setup->scene, STRUT_CHANNEL_POSITION, STRUT_TRAJECTORY_ROOM);
  options.sinks = &sink, options.sink_count = 1;
  if (motion_try(setup, options, &s, &error)) fail_msg("%s", error.message);
  strut_trajectory_sink_free(sink);
  assert_int_equal(t->status, STRUT_OK);
  for (size_t i = 1; i < t->frames; i++) assert_true(t->time[i] > t->time[i - 1]);
  return s;
}

/* Of the forced mass and of the driven one, whose motion no formula here says. */
typedef struct places {
  double forced, driven;
} places;

static places places_after(const char *method, double step, double duration) {
  OWN(strut_trajectory) t;
  OWN(strut_setup) setup = pushed(method, step, duration);
  setup.experiment.output_every = 7e-3; /* does not divide it */
  OWN(strut_summary) s = record(&setup, (strut_run_options){0}, &t);
  const double *last = t.position + (t.frames - 1) * 2 * t.node_count;
  places p = {s.end.positions[0], s.end.positions[4]};
  assert_same_bits(s.duration, duration);
  assert_same_bits(t.time[t.frames - 1], duration);
  assert_same_bits(last[0], p.forced);
  if (step == STEP) assert_int_equal(t.frames, (size_t)ceil(duration / 7e-3 - 1e-9) + 1);
  assert_int_equal(s.spent.steps, (int64_t)ceil(duration / step - 1e-6));
  return p;
}

TEST(every_method_ends_on_time) {
  const double durations[] = {0.049969, 0.0500004, 0.0513, 0.0506999};
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const char *method = strut_integrator_at(i)->name;
    for (size_t k = 0; k < sizeof durations / sizeof *durations; k++) {
      double duration = durations[k], steps = ceil(duration / STEP);
      places exact = places_after("adaptive", duration / steps, duration);
      places whole = places_after(method, duration / steps, duration);
      places cut = places_after(method, STEP, duration);
      /* no worse than steps that divide the time; a step too far would be off by 6e-4 m */
      assert_near(exact.forced, place_at(duration), 1e-9);
      assert_near(cut.forced, exact.forced, 2 * fabs(whole.forced - exact.forced) + 1e-9);
      assert_near(cut.driven, exact.driven, 2 * fabs(whole.driven - exact.driven) + 1e-9);
    }
  }
}

/* The mean velocity over a window that ends with the run. */
TEST(velocity_to_the_end) {
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    OWN(strut_setup) setup = build_setup();
    build_mass(&setup.scene, 0, 0, MASS);
    setup.scene.nodes[0].velocity[0] = SPEED;
    build_load(&setup.scene, 0, PUSH, 0, build_sine(&setup.scene, 1, FREQUENCY));
    motion_experiment_by(&setup, STEP, 0.049969, method->name);
    setup.experiment.tolerance = 1e-10;
    setup.experiment.measure_last = 0.0003; /* within the last step, which has 0.969 ms */
    OWN(strut_summary) s = motion_simulate(&setup);
    double from = 0.049969 - 0.0003;
    double mean = (place_at(0.049969) - place_at(from)) / 0.0003;
    assert_relative(s.velocity, mean, method->order > 2 ? 1e-6 : method->order > 1 ? 1e-4 : 0.02);
  }
}

/* A run of whole steps has the bits of its steps, and its last sample where it always was. */
TEST(whole_steps_are_not_cut) {
  OWN(strut_trajectory) t;
  OWN(strut_setup) setup = pushed("rk4", STEP, 0.05);
  OWN(motion) m = motion_begin_by(&setup, "rk4", STEP);
  motion_steps(&m, 50);
  OWN(strut_summary) s = record(&setup, (strut_run_options){0}, &t);
  assert_int_equal(s.spent.steps, 50);
  for (int i = 0; i < 6; i++) assert_same_bits(s.end.positions[i], m.state->q[i]);
  assert_int_equal(t.frames, 51); /* every step: a thousandth of it is less */
  assert_same_bits(t.time[50], 0.05);
}

/* What goes on from the end of a run does so at its time, and with the drives as they are then. */
TEST(going_on_between_steps) {
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    double q[8], v[8];
    strut_snapshot kept = {.q = q, .v = v};
    OWN(strut_trajectory) before, after;
    OWN(strut_setup) setup = pushed(method->name, STEP, 0.0256);
    OWN(strut_summary) first = record(&setup, (strut_run_options){.to = &kept}, &before);
    assert_same_bits(kept.time, 0.0256);
    motion_experiment(&setup, STEP, 0.0247);
    strut_snapshot then = kept;
    OWN(strut_summary) second =
        record(&setup, (strut_run_options){.from = &then, .to = &kept}, &after);
    assert_all_near(1e-15, kept.time, 0.0503, after.time[after.frames - 1], 0.0503);
    places exact = places_after("adaptive", 0.0503 / 51, 0.0503);
    places whole = places_after(method->name, 0.0503 / 51, 0.0503);
    assert_near(second.end.positions[0], exact.forced,
                2 * fabs(whole.forced - exact.forced) + 1e-9);
    assert_near(second.end.positions[4], exact.driven,
                2 * fabs(whole.driven - exact.driven) + 1e-9);
  }
}
