/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drives that are computed for many evaluations at once have the bits of those computed one by one. */
#include "engine/forces/drives/drives.h"

#include "tests/support/structures.h"

static const double STEP = 1e-4;

/* The crawler; its sine acts from `start` to `stop`. */
typedef struct crawlers {
  strut_setup setup;
  motion together, alone;
} crawlers;

static void begin(crawlers *c, double start, double stop) {
  c->setup = (strut_setup){.experiment = strut_experiment_default()};
  strut_scene_init(&c->setup.scene);
  structure_crawler(&c->setup.scene, 10, 1e-4, 0.1, false);
  assert_int_equal(c->setup.scene.signal_count, 1);
  c->setup.scene.signals[0].start = start, c->setup.scene.signals[0].stop = stop;
  c->together = motion_begin_by(&c->setup, "rk4", STEP);
  c->alone = motion_begin_by(&c->setup, "rk4", STEP);
}

static void crawlers_free(crawlers *c) {
  motion_free(&c->together);
  motion_free(&c->alone);
  strut_scene_free(&c->setup.scene);
}

static void compare(crawlers *c, double t) {
  const strut_state *a = c->together.state, *b = c->alone.state;
  strut_drive_apply(c->alone.model, c->alone.state, t);
  assert_same_bits(a->latest->drive_time, b->latest->drive_time);
  for (int32_t j = 0; j < c->alone.model->members.slots; j++) {
    assert_same_bits(a->latest->rest[j], b->latest->rest[j]);
    assert_same_bits(a->latest->rest_rate[j], b->latest->rest_rate[j]);
  }
}

/* Halves of steps one after the other, begun anew now and then, as calls of a method begin. */
static void run_steps(double start, double stop, double offset) {
  OWN(crawlers) c;
  begin(&c, start, stop);
  const strut_model *model = c.together.model;
  strut_drives_ahead drives;
  c.together.state->time_offset = c.alone.state->time_offset = offset;
  for (int half = 0; half < 1000; half++) {
    if (half % 130 == 0) drives_ahead_begin(model, STRUT_TERMS_COMMON, &drives);
    assert_true(drives.used);
    double step = 0.5 * (double)half, t = step * STEP;
    drives_ahead_apply(model, c.together.state, &drives, t, step, 0.5, STEP, 130 - half % 130);
    compare(&c, t);
  }
}

TEST(steps) {
  run_steps(0.0, HUGE_VAL, 0.0);
  run_steps(0.0, HUGE_VAL, 1234.5);
  run_steps(0.01, 0.03, 0.0);
  run_steps(-1e17, HUGE_VAL, 0.0); /* so many turns that they are taken modulo 1 first */
}

TEST(stages_of_a_step) {
  static const double part[6] = {0.0, 0.2, 0.3, 0.8, 8.0 / 9, 1.0};
  OWN(crawlers) c;
  begin(&c, 0.0, 0.02);
  strut_drives_ahead drives;
  for (int n = 0; n < 300; n++) {
    double h = STEP * (1.0 + 0.01 * n), t = 1e-4 * n;
    drives_ahead_begin(c.together.model, STRUT_TERMS_COMMON, &drives);
    drives_ahead_stages(c.together.model, c.together.state, &drives, t, h, part, 5);
    for (int k = 1; k < 6; k++) {
      drives_ahead_meet(c.together.model, c.together.state, &drives, t + part[k] * h);
      compare(&c, t + part[k] * h);
    }
  }
}

/* Scenes with rare terms have drives that may follow what is not known beforehand. */
TEST(rare_terms_are_left_alone) {
  OWN(crawlers) c;
  begin(&c, 0.0, HUGE_VAL);
  strut_drives_ahead drives;
  drives_ahead_begin(c.together.model, STRUT_TERMS_ALL, &drives);
  assert_false(drives.used);
}
