/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recorded motion in memory: as the run had it, as its file gives it back, thinned, refused. */
#include "engine/output/trajectory.h"
#include "engine/output/record_files.h"
#include "tests/support/structures.h"
#include "tests/unit/scratch.h"

enum { ALL = 63 };

static strut_setup crawler(double every) {
  strut_setup setup = build_setup();
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  motion_experiment(&setup, 1e-4, 0.1);
  setup.experiment.output_every = every;
  setup.experiment.channels = ALL;
  return setup;
}

/* Runs with a file in the scratch directory where `file` says so, and fills the trajectory. */
static strut_status record(const strut_setup *setup, unsigned channels, size_t room, bool file,
                           strut_trajectory *t) {
  strut_sink *sinks[2] = {strut_trajectory_sink(t, &setup->scene, channels, room)};
  if (file) sinks[1] = strut_hdf5_create(scratch_path(""), "strut: 1\n", NULL);
  strut_run_options options = {.sinks = sinks, .sink_count = file ? 2 : 1, .force = true};
  OWN(strut_summary) summary;
  strut_status status = motion_try(setup, options, &summary, NULL);
  strut_trajectory_sink_free(sinks[0]);
  if (file) strut_hdf5_free(sinks[1]);
  return status;
}

static void assert_same(const double *a, const double *b, size_t count) {
  assert_int_equal(!a, !b);
  if (a) assert_memory_equal(a, b, count * sizeof *a);
}

static void assert_same_motion(const strut_trajectory *a, const strut_trajectory *b) {
  size_t n = a->frames;
  assert_all_equal(b->frames, n, b->every, a->every, b->recorded, a->recorded, b->node_count,
                   a->node_count, b->member_count, a->member_count);
  assert_all_equal(b->contact_count, a->contact_count, b->status, a->status);
  assert_memory_equal(b->contact_node, a->contact_node, a->contact_count * sizeof(int32_t));
  assert_same(a->time, b->time, n);
  assert_same(a->position, b->position, 2 * n * a->node_count);
  assert_same(a->velocity, b->velocity, 2 * n * a->node_count);
  assert_same(a->length, b->length, n * a->member_count);
  assert_same(a->force, b->force, n * a->member_count);
  assert_same(a->contact, b->contact, 2 * n * a->contact_count);
  assert_same(a->energy, b->energy, n * STRUT_ENERGIES);
}

BEFORE_EACH { scratch_make(); }

TEST(the_file_gives_back_what_the_run_had) {
  OWN(strut_trajectory) taken = {0}, read = {0};
  OWN(strut_setup) setup = crawler(1e-3);
  assert_ok(record(&setup, ALL, STRUT_TRAJECTORY_ROOM, true, &taken));
  assert_all_equal(taken.frames, 101, taken.recorded, 101, taken.every, 1, taken.contact_count, 5);
  assert_int_equal(taken.contact_node[3], 3);
  assert_near(taken.time[100], 0.1, 1e-12);
  assert_ok(
      strut_trajectory_read(scratch_path(""), &setup.scene, STRUT_TRAJECTORY_ROOM, &read, NULL));
  assert_same_motion(&taken, &read);
}

/* A sink takes what it asks for, whatever the scene records; the file has what the scene says. */
TEST(channels_of_its_own) {
  OWN(strut_trajectory) taken = {0}, read = {0};
  OWN(strut_setup) setup = crawler(1e-3);
  setup.experiment.channels = STRUT_CHANNEL_LENGTH;
  unsigned wanted = STRUT_CHANNEL_POSITION | STRUT_CHANNEL_ENERGY;
  assert_ok(record(&setup, wanted, STRUT_TRAJECTORY_ROOM, true, &taken));
  assert_true(taken.position && taken.energy && taken.time);
  assert_true(!taken.length && !taken.force && !taken.velocity && !taken.contact);
  assert_ok(
      strut_trajectory_read(scratch_path(""), &setup.scene, STRUT_TRAJECTORY_ROOM, &read, NULL));
  assert_true(read.length && !read.position && !read.energy);
}

/* Every so many-th sample from the first on, and the last: the same frames as without a limit. */
static void check_thinned(const strut_trajectory *few, const strut_trajectory *all, size_t room) {
  size_t frame = 1 + 2 * few->node_count + few->member_count, n = few->frames;
  assert_int_equal(few->recorded, all->frames);
  assert_true(few->every > 1 && (few->every & (few->every - 1)) == 0);
  assert_true(n * frame <= room + frame); /* the last one may come on top */
  assert_true(2 * (n + 1) * frame >= room / 2);
  for (size_t i = 0; i < n; i++) {
    size_t at = i + 1 < n ? i * few->every : all->frames - 1;
    assert_same_bits(few->time[i], all->time[at]);
    assert_memory_equal(few->position + 2 * i * few->node_count,
                        all->position + 2 * at * few->node_count,
                        2 * few->node_count * sizeof(double));
    assert_memory_equal(few->force + i * few->member_count, all->force + at * few->member_count,
                        few->member_count * sizeof(double));
  }
}

TEST(thinned_to_the_room) {
  static const size_t rooms[] = {200, 1000, 5000, 12345, 19000};
  OWN(strut_trajectory) all = {0};
  OWN(strut_setup) setup = crawler(1e-4);
  setup.experiment.channels = STRUT_CHANNEL_POSITION | STRUT_CHANNEL_FORCE;
  assert_ok(record(&setup, 0, STRUT_TRAJECTORY_ROOM, true, &all));
  assert_int_equal(all.frames, 1001);
  for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++) {
    strut_trajectory few = {0};
    assert_ok(record(&setup, 0, rooms[i], false, &few));
    check_thinned(&few, &all, rooms[i]);
    strut_trajectory_free(&few);
    assert_ok(strut_trajectory_read(scratch_path(""), &setup.scene, rooms[i], &few, NULL));
    check_thinned(&few, &all, rooms[i]);
    strut_trajectory_free(&few);
  }
}

TEST(a_run_that_diverged_is_marked) {
  OWN(strut_trajectory) taken = {0}, read = {0};
  OWN(strut_setup) setup = build_tethered(1.1, 0, 1);
  build_sized(&setup.scene, STRUT_BAR, 0, 1, 2e5, 1, 0, 1);
  motion_experiment(&setup, 0.01, 10); /* w dt = 4.5 */
  setup.experiment.output_every = 0.01;
  assert_int_equal(record(&setup, 0, STRUT_TRAJECTORY_ROOM, true, &taken), STRUT_DIVERGED);
  assert_int_equal(taken.status, STRUT_DIVERGED);
  assert_true(taken.frames > 1);
  assert_ok(
      strut_trajectory_read(scratch_path(""), &setup.scene, STRUT_TRAJECTORY_ROOM, &read, NULL));
  assert_same_motion(&taken, &read);
}

static void not_read(const strut_setup *setup, const char *directory, const char *why) {
  OWN(strut_trajectory) t = {0};
  strut_error error = {0};
  assert_int_equal(
      strut_trajectory_read(directory, &setup->scene, STRUT_TRAJECTORY_ROOM, &t, &error),
      STRUT_FILE_TROUBLE);
  if (!strstr(error.message, why)) fail_msg("'%s' does not say '%s'", error.message, why);
  assert_non_null(strstr(error.message, "trajectory.h5"));
}

TEST(refusals) {
  OWN(strut_trajectory) taken = {0};
  OWN(strut_setup) setup = crawler(1e-3);
  not_read(&setup, scratch_path("nowhere"), "No such file");
  assert_ok(record(&setup, ALL, STRUT_TRAJECTORY_ROOM, true, &taken));
  const char **names[] = {&setup.scene.nodes[2].name, &setup.scene.members[8].name};
  size_t *counts[] = {&setup.scene.contact_count, &setup.scene.node_count};
  for (int i = 0; i < 2; i++) {
    const char *name = *names[i];
    *names[i] = "another";
    not_read(&setup, scratch_path(""), "another structure");
    *names[i] = name, --*counts[i];
    not_read(&setup, scratch_path(""), "another structure");
    ++*counts[i];
  }
  FILE *file = fopen(scratch_path("trajectory.h5"), "r+b"); /* its first bytes */
  assert_true(file && fputs("this is no HDF5 file", file) > 0 && fclose(file) == 0);
  not_read(&setup, scratch_path(""), "not an HDF5 file");
}

TEST(every_allocation_may_fail) {
  OWN(strut_setup) setup = crawler(1e-4);
  OWN_POINTER(strut_model) model = motion_compile(&setup.scene);
  REFUSE_EACH(n, status, 1) {
    OWN(strut_trajectory) t = {0};
    OWN(strut_summary) summary = {0};
    strut_fail_allocation_after(n);
    strut_sink *sink = strut_trajectory_sink(&t, &setup.scene, ALL, 20000);
    strut_run_options options = {.sinks = &sink, .sink_count = 1, .force = true};
    if (sink) status = strut_simulate(model, &setup.experiment, &options, &summary, NULL);
    strut_fail_allocation_after(-1);
    strut_trajectory_sink_free(sink);
  }
}
