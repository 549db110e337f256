/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trajectories as HDF5: read back through the library, equal bytes, full disks, silence. */
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <hdf5.h>
#include <hdf5_hl.h>

#include "engine/output/file.h"
#include "engine/output/record_files.h"
#include "tests/support/check.h"
#include "tests/unit/sample.h"
#include "tests/unit/scratch.h"

static strut_status feed(const char *directory, size_t rows, strut_status run_status,
                         const char *scene, strut_error *error) {
  strut_sink *sink = strut_hdf5_create(directory, scene, error);
  if (!sink) return STRUT_NO_MEMORY;
  strut_status status = sample_feed(sink, rows, run_status, error);
  strut_hdf5_free(sink);
  return status;
}

static void assert_text_attribute(hid_t object, const char *name, const char *expected) {
  char *text = NULL;
  hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
  assert_true(attribute >= 0);
  hid_t type = H5Aget_type(attribute);
  assert_all(H5Tis_variable_str(type) > 0, H5Aread(attribute, type, &text) >= 0);
  assert_string_equal(text, expected);
  H5free_memory(text);
  H5Tclose(type);
  H5Aclose(attribute);
}

static void assert_unit_and_values(hid_t file, const strut_record_channel *channel, size_t rows) {
  hid_t dataset = H5Dopen2(file, channel->name, H5P_DEFAULT);
  assert_true(dataset >= 0);
  assert_text_attribute(dataset, "units", channel->unit);
  hid_t space = H5Dget_space(dataset);
  hsize_t shape[3] = {0};
  assert_int_equal(H5Sget_simple_extent_ndims(space), 3);
  H5Sget_simple_extent_dims(space, shape, NULL);
  assert_all_equal(shape[0], rows, shape[1], channel->items, shape[2], channel->components);
  size_t size = channel->items * channel->components;
  FREED double *values = calloc(rows * size + 1, sizeof *values);
  assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  for (size_t row = 0; row < rows; row++) {
    for (size_t i = 0; i < size; i++) {
      double expected = sample_value(row, channel->offset + i);
      assert_memory_equal(&values[row * size + i], &expected, sizeof expected);
    }
  }
  H5Sclose(space);
  H5Dclose(dataset);
}

static void assert_scale(hid_t file, const char *dataset, unsigned dimension, const char *scale) {
  char name[64] = "";
  hid_t user = H5Dopen2(file, dataset, H5P_DEFAULT), used = H5Dopen2(file, scale, H5P_DEFAULT);
  assert_true(user >= 0 && used >= 0);
  assert_all_equal(H5DSis_scale(used), 1, H5DSis_attached(user, used, dimension), 1);
  assert_int_equal(H5DSget_num_scales(user, dimension), 1);
  assert_true(H5DSget_scale_name(used, name, sizeof name) > 0);
  assert_string_equal(name, scale);
  H5Dclose(user);
  H5Dclose(used);
}

static void assert_scales(hid_t file) {
  static const char *const names[][3] = {{"position", "node", "axis"},
                                         {"velocity", "node", "axis"},
                                         {"length", "member", NULL},
                                         {"force", "member", NULL},
                                         {"contact", "contact_node", "contact_component"},
                                         {"energy", "system", "energy_component"}};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    assert_scale(file, names[i][0], 0, "time");
    assert_scale(file, names[i][0], 1, names[i][1]);
    if (names[i][2]) assert_scale(file, names[i][0], 2, names[i][2]);
  }
}

static void assert_names(hid_t file, const char *name, const char *const *expected, size_t count) {
  hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT), type = H5Tcopy(H5T_C_S1);
  char texts[4][64] = {{0}};
  H5Tset_size(type, 64);
  H5Tset_cset(type, H5T_CSET_UTF8);
  hid_t space = H5Dget_space(dataset);
  assert_int_equal(H5Sget_simple_extent_npoints(space), count);
  assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts) >= 0);
  for (size_t i = 0; i < count; i++) assert_string_equal(texts[i], expected[i]);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(dataset);
}

static void assert_file(size_t rows, const char *status, const char *scene) {
  const strut_record_layout *layout = sample_layout();
  hid_t file = H5Fopen(scratch_path("trajectory.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_true(file >= 0);
  assert_text_attribute(file, "status", status);
  assert_text_attribute(file, "strut_version", STRUT_VERSION);
  assert_text_attribute(file, "scene", scene);
  for (size_t i = 0; i < layout->channel_count; i++)
    assert_unit_and_values(file, &layout->channels[i], rows);
  FREED double *time = calloc(rows + 1, sizeof *time);
  assert_true(H5LTread_dataset_double(file, "time", time) >= 0);
  for (size_t row = 0; row < rows; row++) {
    double expected = sample_value(row, 0);
    assert_memory_equal(&time[row], &expected, sizeof expected);
  }
  assert_scales(file);
  assert_names(file, "node", layout->channels[0].item_names, 3);
  assert_names(file, "contact_component", layout->channels[4].component_names, 2);
  assert_true(H5Fclose(file) >= 0);
}

static const char *directory;

BEFORE_EACH { directory = scratch_make(); }

TEST(every_value_comes_back) {
  assert_ok(feed(directory, 1500, STRUT_OK, "strut: 1\n", NULL));
  assert_int_equal(scratch_count(directory), 1);
  assert_file(1500, "completed", "strut: 1\n");
}

TEST(a_run_that_stopped_is_marked) {
  assert_ok(feed(directory, 7, STRUT_INTERRUPTED, "s", NULL));
  assert_file(7, "interrupted", "s");
  assert_ok(feed(directory, 41, STRUT_DIVERGED, "s", NULL));
  assert_file(41, "diverged", "s");
  assert_ok(feed(directory, 0, STRUT_INTERRUPTED, "s", NULL));
  assert_file(0, "interrupted", "s");
}

TEST(a_long_scene_fits) {
  enum { LENGTH = 3000000 };
  FREED char *scene = calloc(LENGTH + 1, 1);
  for (size_t i = 0; i < LENGTH; i++) scene[i] = (char)('a' + i % 23);
  assert_ok(feed(directory, 3, STRUT_OK, scene, NULL));
  assert_file(3, "completed", scene);
}

TEST(equal_runs_give_equal_bytes) {
  size_t length;
  assert_ok(feed(directory, 500, STRUT_OK, "scene", NULL));
  FREED char *first = scratch_read(scratch_path("trajectory.h5"), &length);
  for (int i = 0; i < 5; i++) {
    for (size_t size = 16; size < 20000; size += 24 + size / 4) { /* other garbage in the heap */
      FREED char *block = malloc(size);
      memset(block, 0x31 * (i + 1) + (int)size, size);
    }
    if (i == 2) sleep(1); /* another second, another time stamp if there were one */
    assert_ok(feed(directory, 500, STRUT_OK, "scene", NULL));
    scratch_expect(scratch_path("trajectory.h5"), first, length);
  }
}

TEST(rows_longer_than_a_chunk) {
  enum { NODES = 50000, ROWS = 3 };
  static const char *const axes[] = {"x", "y"};
  FREED const char **names = calloc(NODES, sizeof *names);
  for (size_t i = 0; i < NODES; i++) names[i] = "n";
  strut_record_channel channel = {
      STRUT_CHANNEL_POSITION, "position", "m", NODES, 2, 1, names, axes, NULL};
  strut_record_layout layout = {1 + 2 * NODES, 1, &channel, ROWS};
  FREED double *rows = sample_rows(&layout, 0, ROWS);
  strut_sink *sink = strut_hdf5_create(directory, "", NULL);
  assert_ok(sink->begin(sink->context, &layout, NULL));
  assert_ok(sink->rows(sink->context, rows, ROWS, NULL));
  assert_ok(sink->end(sink->context, STRUT_OK, NULL));
  strut_hdf5_free(sink);
  hid_t file = H5Fopen(scratch_path("trajectory.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_unit_and_values(file, &channel, ROWS);
  H5Fclose(file);
}

TEST(trouble_elsewhere_removes_the_file) {
  assert_ok(feed(directory, 7, STRUT_FILE_TROUBLE, "", NULL));
  assert_int_equal(scratch_count(directory), 0);
  strut_sink *sink = strut_hdf5_create(directory, "", NULL); /* begun, never ended */
  assert_ok(sink->begin(sink->context, sample_layout(), NULL));
  strut_hdf5_free(sink);
  assert_int_equal(scratch_count(directory), 0);
}

static herr_t note_error(hid_t stack, void *data) {
  (void)stack, (void)data;
  return 0;
}

TEST(the_host_keeps_its_error_handler) {
  H5E_auto2_t before = NULL, after = NULL;
  void *before_data = NULL, *after_data = NULL;
  int mine = 0;
  H5Eget_auto2(H5E_DEFAULT, &before, &before_data);
  H5Eset_auto2(H5E_DEFAULT, note_error, &mine);
  assert_ok(feed(directory, 7, STRUT_OK, "", NULL));
  H5Eget_auto2(H5E_DEFAULT, &after, &after_data);
  H5Eset_auto2(H5E_DEFAULT, before, before_data);
  assert_true(after == note_error && after_data == &mine);
}

/* As the program does: HDF5 cannot close a file once a write has failed, and would crash when the process exits. */
__attribute__((constructor)) static void leave_at_exit(void) { strut_hdf5_leave_at_exit(); }

/* In a process of its own, to its very end: HDF5 may complain when the program exits. */
static void feed_in_child(const char *disk, size_t rows, const char *errors) {
  int descriptor = open(errors, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  strut_error error = {0};
  dup2(descriptor, STDERR_FILENO);
  dup2(descriptor, STDOUT_FILENO);
  strut_status status = feed(disk, rows, STRUT_OK, "scene", &error);
  if (status == STRUT_OK) exit(0);
  bool right = status == STRUT_FILE_TROUBLE && strstr(error.message, "No space left on device");
  if (!right) fprintf(stderr, "%d %s\n", (int)status, error.message);
  exit(right ? 4 : 1);
}

TEST(a_full_disk_is_an_error_and_silent) {
  int failures = 0, successes = 0, result = 0;
  scratch_make();
  const char *disk = scratch_path("disk"), *errors = scratch_path("errors");
  assert_ok(strut_directory_create(disk, NULL));
  for (int kilobytes = 4; kilobytes <= 1024; kilobytes += kilobytes < 64 ? 4 : kilobytes / 4) {
    size_t length = 0;
    if (!scratch_mount_small_disk(disk, kilobytes)) skip();
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) feed_in_child(disk, 2000, errors);
    waitpid(child, &result, 0);
    int left = scratch_count(disk);
    scratch_unmount(disk);
    FREED char *printed = scratch_read(errors, &length);
    assert_string_equal(printed, "");
    assert_true(WIFEXITED(result));
    if (WEXITSTATUS(result) == 0) {
      successes++;
      assert_int_equal(left, 1);
    } else {
      failures++;
      assert_all_equal(WEXITSTATUS(result), 4, left, 0);
    }
  }
  assert_all(failures > 5, successes > 0);
}

TEST(no_memory) {
  REFUSE_EACH(n, status, 16) {
    status = refused(n, feed(directory, 5, STRUT_OK, "scene", NULL));
    if (status) assert_int_equal(scratch_count(directory), 0);
  }
}
