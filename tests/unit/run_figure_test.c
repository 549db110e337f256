/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a run without memory, without frames, and of frames that are no shapes. */
#include "engine/output/figures/run_figure.h"
#include "tests/support/structures.h"
#include "tests/unit/scratch.h"

static strut_setup setup;
static strut_model *model;
static strut_summary summary;
static strut_trajectory taken;
static const strut_trajectory *beside; /* another motion, dashed over it */

BEFORE_ALL {
  scratch_make();
  strut_setup_init(&setup);
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  motion_experiment(&setup, 1e-4, 0.2);
  setup.experiment.output_every = 5e-3;
  setup.scene.name = "crawler";
  model = motion_compile(&setup.scene);
  strut_sink *sink = strut_trajectory_sink(&taken, &setup.scene, 63, STRUT_TRAJECTORY_ROOM);
  strut_run_options options = {.sinks = &sink, .sink_count = 1};
  assert_ok(strut_simulate(model, &setup.experiment, &options, &summary, NULL));
  strut_trajectory_sink_free(sink);
  assert_int_equal(taken.frames, 41);
}

AFTER_ALL {
  strut_trajectory_free(&taken);
  strut_summary_free(&summary);
  strut_model_free(model);
  strut_setup_free(&setup);
}

static strut_status draw(strut_run_view view, const strut_trajectory *frames, strut_error *error) {
  const strut_run_figure figure = {.experiment = &setup.experiment,
                                   .view = view,
                                   .plot = {.path = scratch_path("a.svg"), .width = 250},
                                   .scale = {3, 2},
                                   .other = beside,
                                   .other_name = "another"};
  if (error) *error = (strut_error){0};
  return strut_run_figure_draw(&figure, model, frames, &summary, error);
}

/* Every so many-th allocation fails: nothing but the message, and no file, is left; nor is a picture
   made that lacks something. */
TEST(no_memory) {
  beside = &taken;
  for (int view = STRUT_RUN_OVERVIEW; view <= STRUT_RUN_CURVES; view++) {
    strut_status status = STRUT_NO_MEMORY;
    strut_error error;
    for (int64_t n = 0; status != STRUT_OK; n += 1 + n / 4) {
      assert_int_equal(scratch_count(scratch_path("")), 0);
      status = refused(n, draw((strut_run_view)view, &taken, &error));
      if (status != STRUT_OK) assert_true(error.message[0]);
      assert_true(n < 100000);
    }
    assert_int_equal(scratch_count(scratch_path("")), 1);
    size_t length;
    FREED char *picture = scratch_read(scratch_path("a.svg"), &length);
    assert_ok(draw((strut_run_view)view, &taken, &error));
    scratch_expect(scratch_path("a.svg"), picture, length);
    assert_int_equal(remove(scratch_path("a.svg")), 0);
  }
  beside = NULL;
}

TEST(nothing_to_draw) {
  strut_error error;
  strut_trajectory none = {0}, no_positions = taken, empty = taken;
  no_positions.position = NULL;
  empty.frames = 0;
  assert_int_equal(draw(STRUT_RUN_OVERVIEW, &none, &error), STRUT_USAGE);
  assert_int_equal(draw(STRUT_RUN_OVERVIEW, &no_positions, &error), STRUT_USAGE);
  assert_fails(draw(STRUT_RUN_CURVES, &empty, &error), STRUT_USAGE, error, "nothing to draw");
  assert_int_equal(scratch_count(scratch_path("")), 0);
}

/* Few frames, and channels that are not there. */
TEST(whatever_there_is_is_drawn) {
  for (size_t frames = 1; frames <= 3; frames++)
    for (int view = STRUT_RUN_OVERVIEW; view <= STRUT_RUN_CURVES; view++) {
      strut_trajectory few = taken;
      few.frames = frames;
      assert_ok(draw((strut_run_view)view, &few, NULL));
      few.force = few.contact = few.energy = few.length = few.velocity = NULL;
      assert_ok(draw((strut_run_view)view, &few, NULL));
    }
  assert_int_equal(remove(scratch_path("a.svg")), 0);
}

/* Frames after a divergence are left out: the picture is that of the frames before. */
TEST(frames_that_are_no_shapes) {
  size_t length;
  strut_trajectory few = taken, wild = taken;
  few.frames = 20;
  RELEASED double *positions =
      strut_allocate(2 * taken.frames * taken.node_count, sizeof *positions);
  assert_non_null(positions);
  memcpy(positions, taken.position, 2 * taken.frames * taken.node_count * sizeof *positions);
  wild.position = positions;
  positions[2 * 20 * taken.node_count + 3] = 1e30;
  positions[2 * 25 * taken.node_count] = (double)NAN;
  summary.status = STRUT_DIVERGED;
  assert_ok(draw(STRUT_RUN_PERIOD, &few, NULL));
  FREED char *one = scratch_read(scratch_path("a.svg"), &length);
  assert_ok(draw(STRUT_RUN_PERIOD, &wild, NULL));
  summary.status = STRUT_OK;
  scratch_expect(scratch_path("a.svg"), one, length);
  assert_int_equal(remove(scratch_path("a.svg")), 0);
}
