/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trajectories as CSV: headers, every value's bits, full disks, no memory. */
#include "engine/output/record_files.h"
#include "tests/support/check.h"
#include "tests/support/heap.h"
#include "tests/unit/sample.h"
#include "tests/unit/scratch.h"

static strut_status feed(const char *directory, size_t rows, strut_status run_status,
                         strut_error *error) {
  strut_sink *sink = strut_csv_create(directory);
  if (!sink) return STRUT_NO_MEMORY;
  strut_status status = sample_feed(sink, rows, run_status, error);
  strut_csv_free(sink);
  return status;
}

/* The file's lines, `columns` columns each, hold the sample's rows bit by bit. */
static void assert_table(const char *name, const char *header, size_t rows, const size_t *columns,
                         size_t column_count) {
  size_t length = 0;
  FREED char *text = scratch_read(scratch_path(name), &length);
  assert_non_null(text);
  size_t head = strlen(header);
  assert_true(length >= head);
  assert_memory_equal(text, header, head);
  char *at = text + head;
  for (size_t row = 0; row < rows; row++) {
    for (size_t i = 0; i <= column_count; i++) {
      double expected = sample_value(row, i ? columns[i - 1] : 0);
      double value = strtod(at, &at);
      assert_memory_equal(&value, &expected, sizeof value);
      assert_int_equal(*at, i == column_count ? '\n' : ',');
      at++;
    }
  }
  assert_int_equal(at - text, length);
}

static void assert_all_tables(size_t rows) {
  assert_table("nodes.csv",
               "time [s],n1.x [m],n1.y [m],n1.vx [m/s],n1.vy [m/s],"
               "\"left, \"\"upper\"\".x [m]\",\"left, \"\"upper\"\".y [m]\","
               "\"left, \"\"upper\"\".vx [m/s]\",\"left, \"\"upper\"\".vy [m/s]\","
               "\xc3\xa4.x [m],\xc3\xa4.y [m],\xc3\xa4.vx [m/s],\xc3\xa4.vy [m/s]\n",
               rows, (const size_t[]){1, 2, 7, 8, 3, 4, 9, 10, 5, 6, 11, 12}, 12);
  assert_table("members.csv", "time [s],m1.length [m],m1.force [N],m2.length [m],m2.force [N]\n",
               rows, (const size_t[]){13, 15, 14, 16}, 4);
  assert_table("contacts.csv",
               "time [s],n1.normal [N],n1.friction [N],\"left, \"\"upper\"\".normal [N]\","
               "\"left, \"\"upper\"\".friction [N]\"\n",
               rows, (const size_t[]){17, 18, 19, 20}, 4);
  assert_table("energy.csv", "time [s],kinetic [J],elastic [J],gravity [J]\n", rows,
               (const size_t[]){21, 22, 23}, 3);
}

static const char *directory;

BEFORE_EACH { directory = scratch_make(); }

TEST(every_value_comes_back) {
  assert_ok(feed(directory, 1500, STRUT_OK, NULL));
  assert_int_equal(scratch_count(directory), 4);
  assert_all_tables(1500);
}

TEST(a_run_that_stopped_keeps_its_rows) {
  assert_ok(feed(directory, 7, STRUT_INTERRUPTED, NULL));
  assert_all_tables(7);
  assert_ok(feed(directory, 8, STRUT_DIVERGED, NULL));
  assert_all_tables(8);
  assert_ok(feed(directory, 0, STRUT_INTERRUPTED, NULL));
  assert_all_tables(0);
}

TEST(trouble_elsewhere_removes_the_files) {
  assert_ok(feed(directory, 7, STRUT_FILE_TROUBLE, NULL));
  assert_int_equal(scratch_count(directory), 0);
  assert_ok(feed(directory, 7, STRUT_NO_MEMORY, NULL));
  assert_int_equal(scratch_count(directory), 0);
  strut_sink *sink = strut_csv_create(directory); /* begun, never ended */
  assert_ok(sink->begin(sink->context, sample_layout(), NULL));
  strut_csv_free(sink);
  assert_int_equal(scratch_count(directory), 0);
}

TEST(only_files_with_channels) {
  strut_record_layout layout = *sample_layout();
  layout.channel_count = 1;
  strut_sink *sink = strut_csv_create(directory);
  assert_ok(sink->begin(sink->context, &layout, NULL));
  assert_ok(sink->end(sink->context, STRUT_OK, NULL));
  strut_csv_free(sink);
  assert_int_equal(scratch_count(directory), 1);
  assert_true(scratch_exists(scratch_path("nodes.csv")));
}

TEST(numbers_that_are_none) {
  size_t length;
  strut_record_layout layout = *sample_layout();
  layout.channels = &layout.channels[5];
  layout.channel_count = 1;
  double row[24] = {1.0};
  row[21] = (double)NAN, row[22] = (double)INFINITY, row[23] = (double)-INFINITY;
  strut_sink *sink = strut_csv_create(directory);
  assert_ok(sink->begin(sink->context, &layout, NULL));
  assert_ok(sink->rows(sink->context, row, 1, NULL));
  assert_ok(sink->end(sink->context, STRUT_DIVERGED, NULL));
  strut_csv_free(sink);
  FREED char *text = scratch_read(scratch_path("energy.csv"), &length);
  assert_string_equal(text, "time [s],kinetic [J],elastic [J],gravity [J]\n1,nan,inf,-inf\n");
}

TEST(a_full_disk) {
  const char *disk = scratch_make();
  int failures = 0;
  for (int kilobytes = 4; kilobytes <= 2048; kilobytes *= 2) {
    strut_error error = {0};
    if (!scratch_mount_small_disk(disk, kilobytes)) skip();
    strut_status status = feed(disk, 1500, STRUT_OK, &error);
    int left = scratch_count(disk);
    scratch_unmount(disk);
    if (status == STRUT_OK) {
      assert_int_equal(left, 4);
    } else {
      failures++;
      assert_all_equal(status, STRUT_FILE_TROUBLE, left, 0);
      assert_non_null(strstr(error.message, "No space left on device"));
    }
  }
  assert_in_range(failures, 4, 9);
}

/* Nothing comes into the folder, nor does anything stay behind: after some rounds malloc's own caches are full. */
TEST(no_memory) {
  size_t before = 0;
  for (int round = 0; round < 12; round++) {
    if (round == 4) before = heap_in_use();
    directory = scratch_make();
    REFUSE_EACH(n, status, 11) {
      status = refused(n, feed(directory, 5, STRUT_OK, NULL));
      if (status) assert_int_equal(scratch_count(directory), 0);
    }
  }
  assert_in_range(heap_in_use(), 0, before + 500);
}
