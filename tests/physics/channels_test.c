/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recorded channels: angular momentum against its law and a closed form, and every channel out of a file again. */
#include "engine/output/record_files.h"
#include "engine/output/trajectory.h"
#include "tests/models/run_model.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

#define ALL (((strut_channels)1 << STRUT_CHANNEL_COUNT) - 1)

/* Runs a scene with all channels into memory and, where `directory` is one, into files. */
static void record(const char *text, const char *const *settings, const char *directory,
                   model_run *run, strut_trajectory *t) {
  strut_error error = {0};
  *run = model_read_text("a scene", text, settings);
  run->setup.experiment.channels = ALL;
  strut_sink *sinks[] = {strut_trajectory_sink(t, &run->setup.scene, ALL, STRUT_TRAJECTORY_ROOM),
                         directory ? strut_hdf5_create(directory, "strut: 1\n", &error) : NULL,
                         directory ? strut_csv_create(directory) : NULL};
  strut_run_options options = {.sinks = sinks, .sink_count = directory ? 3 : 1};
  assert_ok(strut_model_compile(&run->setup.scene, &run->model, &error));
  strut_status status =
      strut_simulate(run->model, &run->setup.experiment, &options, &run->summary, &error);
  if (status) fail_msg("%s", error.message);
  strut_trajectory_sink_free(sinks[0]);
  if (directory) strut_hdf5_free(sinks[1]);
  if (directory) strut_csv_free(sinks[2]);
}

static const double *row_of(const strut_trajectory *t, size_t frame) {
  return t->angular_momentum + frame * (t->node_count + 1);
}

/* ---- angular momentum ---- */

static const char FREE[] =
    "strut: 1\n"
    "mass_model: consistent\n"
    "nodes: {a: {position: [-0.5, 0], mass: 0.1}, b: {position: [0.5, 0], mass: 0.2},\n"
    "        c: {position: [0, 0.6], mass: 0.3}, d: {position: [0.1, -0.7], mass: 0.2}}\n"
    "members: {ab: {kind: bar, nodes: [a, b], stiffness: 200, mass: 0.5},\n"
    "          bc: {kind: spring, nodes: [b, c], stiffness: 100, mass: 0.2, damping: 0.5},\n"
    "          ca: {kind: cable, nodes: [c, a], stiffness: 150, mass: 0.1, damping: 0.1},\n"
    "          ad: {kind: spring, nodes: [a, d], stiffness: 120, mass: 0.1},\n"
    "          bd: {kind: spring, nodes: [b, d], stiffness: 120, mass: 0.1}}\n"
    "sliders:\n"
    "  lamp: {member: bc, mass: 0.2, position: 30 %}\n"
    "  child: {member: ab, mass: 0.3, position: 40 %,\n"
    "          moves: {sine: {amplitude: 0.1, frequency: 2 Hz}}}\n"
    "initial: {velocities: {a: [3, -1], b: [3, 2], c: [2, 0.3], d: [3.2, 0]}}\n"
    "solver: {step: 0.2 ms}\n"
    "run: {duration: 1 s}\n"
    "output: {every: 20 ms}\n";

static void assert_conserved(const char *text, const char *what) {
  OWN(model_run) run;
  OWN(strut_trajectory) t = {0};
  record(text, set_none, NULL, &run, &t);
  size_t n = t.node_count;
  double begin = row_of(&t, 0)[n], moved = 0.0;
  assert_int_equal(t.frames, 51);
  assert_true(fabs(begin) > 0.1);
  for (size_t f = 0; f < t.frames; f++) {
    const double *row = row_of(&t, f);
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) sum += row[i];
    assert_near(sum, row[n], 1e-14);
    if (fabs(row[n] / begin - 1.0) > 1e-10)
      fail_msg("%s: %.17g, not %.17g, in frame %zu", what, row[n], begin, f);
    moved = fmax(moved, fabs(row[0] - row_of(&t, 0)[0]));
  }
  assert_true(moved > 0.01); /* what a node has changes */
}

TEST(a_free_structure_keeps_its_angular_momentum) {
  char text[sizeof FREE + 40];
  assert_conserved(FREE, "consistent masses");
  const char *after = strstr(FREE, "nodes:");
  snprintf(text, sizeof text, "strut: 1\nmass_model: lumped\n%s", after);
  assert_conserved(text, "lumped masses");
  snprintf(text, sizeof text, "strut: 1\ngravity: [1, -9.81]\n%s", after);
  assert_conserved(text, "in a uniform field");
}

/* A rigid bar of mass m and length l turns at the rate w about its middle: m l^2 w / 12, half at either end,
   however fast it flies; with lumped masses m l^2 w / 4. */
static void assert_closed_form(const char *model, double part) {
  char text[600];
  OWN(model_run) run;
  OWN(strut_trajectory) t = {0};
  const double m = 1.2, l = 0.8, w = 3.0;
  snprintf(text, sizeof text,
           "strut: 1\nmass_model: %s\n"
           "nodes: {a: [0, 1], b: [0.8, 1]}\n"
           "members: {bar: {kind: bar, nodes: [a, b], stiffness: 1e5, mass: 1.2}}\n"
           "initial: {velocities: {a: [7, -2.2], b: [7, 0.2]}}\n"
           "solver: {step: 0.1 ms}\nrun: {duration: 0.2 s}\noutput: {every: 10 ms}\n",
           model);
  record(text, set_none, NULL, &run, &t);
  for (size_t f = 0; f < t.frames; f++) {
    assert_relative(row_of(&t, f)[2], part * m * l * l * w, f ? 1e-11 : 1e-15);
    for (int i = 0; i < 2; i++)
      assert_relative(row_of(&t, f)[i], 0.5 * part * m * l * l * w, f ? 1e-11 : 1e-15);
  }
}

TEST(a_bar_that_turns_has_the_closed_form) {
  assert_closed_form("consistent", 1.0 / 12.0);
  assert_closed_form("lumped", 1.0 / 4.0);
}

/* ---- all channels ---- */

static const char EVERYTHING[] =
    "strut: 1\n"
    "gravity: [0, -9.81]\n"
    "nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1},\n"
    "        c: {position: [1, 1], mass: 1}, d: {position: [0, 1], mass: 1},\n"
    "        e: {position: [0.5, 1.8], mass: 0.3}}\n"
    "members: {ab: {kind: bar, nodes: [a, b], stiffness: 1e4, damping: 10},\n"
    "          bc: {kind: bar, nodes: [b, c], stiffness: 1e4, damping: 10},\n"
    "          cd: {kind: bar, nodes: [c, d], stiffness: 1e4, damping: 10},\n"
    "          da: {kind: bar, nodes: [d, a], stiffness: 1e4, damping: 10},\n"
    "          ce: {kind: bar, nodes: [c, e], stiffness: 1e4, damping: 10}}\n"
    "hinges: {h: {nodes: [d, c, e], stiffness: 3}}\n"
    "cells: {q: {nodes: [a, b, c, d], pressure: 30}}\n"
    "collisions: {hit: {nodes: [a, e], thickness: 0.1, stiffness: 100}}\n"
    "distances: {wide: {nodes: [a, c], along: x, stiffness: 10}}\n"
    "sliders: {bead: {member: ab, mass: 0.1, position: 0.5, moves: to_and_fro}}\n"
    "sensors: {l: {length: bc}, up: {of: com.y}}\n"
    "states: {z: {start: 0, rate: l / (1 m s)}}\n"
    "signals: {to_and_fro: {sine: {amplitude: 0.4, frequency: 1 Hz}}}\n"
    "ground: {stiffness: 1e5, damping: 100, nodes: all}\n"
    "solver: {step: 50 us}\n"
    "run: {duration: 50 ms}\n"
    "output: {every: 1 ms}\n";

/* All of them at once, more than any one scene had before: every one comes back with the same bits. */
TEST(every_channel_comes_back_out_of_its_file) {
  OWN(model_run) run;
  OWN(strut_trajectory) t = {0}, read = {0};
  strut_error error = {0};
  scratch_make();
  record(EVERYTHING, set_none, scratch_path(""), &run, &t);
  strut_status status = strut_trajectory_read(scratch_path(""), &run.setup.scene,
                                              STRUT_TRAJECTORY_ROOM, &read, &error);
  if (status) fail_msg("%s", error.message);
  assert_all_equal(t.frames, 51, read.frames, t.frames);
  const strut_channel_row *row;
  size_t channels = 0;
  for (; (row = strut_channel_at(channels)) != NULL; channels++) {
    const double *was = strut_trajectory_channel(&t, row->id);
    const double *is = strut_trajectory_channel(&read, row->id);
    size_t size = strut_channel_items(row, &run.setup.scene) * row->components;
    if (!was || !is) fail_msg("%s is missing", row->name);
    assert_memory_equal(is, was, t.frames * size * sizeof *was);
    assert_ptr_equal(strut_channel_named(row->name), row);
    assert_ptr_equal(strut_channel_row_of(row->id), row);
    assert_true(scratch_exists(scratch_path(strut_owner_row_of(row->owner)->file)));
  }
  assert_int_equal(channels, STRUT_CHANNEL_COUNT);
  assert_true(t.hinge_count == 1 && t.cell_count == 1 && t.contact_count == 5);
}
