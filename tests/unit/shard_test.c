/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shards: who has which points, and what may be merged. */
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/study/results/study_table.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

static const strut_array_task nowhere = {0};

static void expect(const char *text, const strut_array_task *task, int64_t k, int64_t n) {
  strut_shard shard = {-1, -1};
  strut_error error = {0};
  if (strut_shard_read(text, task, &shard, &error) != STRUT_OK) fail_msg("%s", error.message);
  assert_all_equal(shard.index, k, shard.count, n);
}

static void refuse(const char *text, const strut_array_task *task, const char *words) {
  strut_shard shard;
  strut_error error = {0};
  assert_int_equal(strut_shard_read(text, task, &shard, &error), STRUT_USAGE);
  if (!strstr(error.message, words)) fail_msg("\"%s\" lacks \"%s\"", error.message, words);
}

TEST(texts) {
  expect("0/1", &nowhere, 0, 1);
  expect("7/8", &nowhere, 7, 8);
  expect("9998/9999", &nowhere, 9998, 9999);
  refuse("8/8", &nowhere, "numbered 0 to 7");
  refuse("0/0", &nowhere, "1 to 9999");
  refuse("0/10000", &nowhere, "1 to 9999");
  static const char *const bad[] = {"",       "1",      "/8",   "1/",     "-1/8",
                                    "1/8/9",  "1 /8",   "a/8",  "1.0/8",  "+1/8",
                                    "slurm/", "slurm8", "1/8 ", "slurms", "99999999999999999999/8"};
  strut_array_task task = {"1", "0", "7", "1", "8", NULL};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) refuse(bad[i], &task, "");
}

TEST(arrays) {
  refuse("slurm", &nowhere, "not a task of a Slurm job array");
  refuse("slurm/8", &nowhere, "not a task of a Slurm job array");
  expect("slurm", &(strut_array_task){"3", "0", "7", "1", "8", NULL}, 3, 8);
  expect("slurm", &(strut_array_task){"3", "1", "8", "1", "8", NULL}, 2, 8);
  expect("slurm", &(strut_array_task){"4", "0", "6", "2", "4", NULL}, 2, 4);
  expect("slurm", &(strut_array_task){"0", "0", "0", NULL, "1", NULL}, 0, 1);
  /* Sent again in part: only slurm/8 knows what the whole was. */
  refuse("slurm", &(strut_array_task){"3", "3", "3", "1", "1", NULL}, "slurm/N");
  refuse("slurm", &(strut_array_task){"3", "3", "7", "1", "2", NULL}, "slurm/N");
  refuse("slurm", &(strut_array_task){"0", "0", "7", "1", "2", NULL}, "slurm/N");
  expect("slurm/8", &(strut_array_task){"3", "3", "7", "1", "2", NULL}, 3, 8);
  refuse("slurm/8", &(strut_array_task){"8", "1", "8", "1", "8", NULL}, "numbered 0 to 7");
}

/* Every point once, in shards that differ by one point at most. */
TEST(all_points_once) {
  for (int64_t points = 0; points < 60; points++)
    for (int64_t n = 1; n < 70; n++) {
      int seen[60] = {0};
      for (int64_t k = 0; k < n; k++) {
        strut_slots_description plan = {.points = points};
        strut_shard_points((strut_shard){k, n}, &plan);
        assert_true(plan.count == points / n || plan.count == points / n + 1);
        for (int64_t i = 0; i < plan.count; i++) seen[plan.first + i * plan.stride]++;
      }
      for (int64_t i = 0; i < points; i++) assert_int_equal(seen[i], 1);
    }
  strut_slots_description plan = {.points = 1000000000};
  strut_shard_points((strut_shard){0, 0}, &plan);
  assert_int_equal(plan.count, 1000000000);
}

/* A small study on disk. */
static const strut_slot_column columns[] = {
    {"frequency", "Hz", false}, {"outcome", "1", true}, {"a \"b\", c", "m/s", false}};
static const strut_slots_description study = {
    .hash = {9}, .version = "1", .name = "s", .points = 23, .columns = columns, .column_count = 3};

static strut_slots *open_shard(strut_slots_description plan, strut_shard shard) {
  OWN(strut_arena) arena = {0};
  strut_slots *slots = NULL;
  strut_error error = {0};
  strut_shard_points(shard, &plan);
  assert_ok(strut_shard_begin(scratch_path("d"), shard, &error));
  char *path = strut_shard_path(scratch_path("d"), shard, &arena);
  if (strut_slots_open(path, &plan, &slots, &error) != STRUT_OK) fail_msg("%s", error.message);
  return slots;
}

/* Puts up to `most` points that a shard lacks. */
static void run_shard(strut_slots_description plan, strut_shard shard, int64_t most) {
  strut_slots *slots = open_shard(plan, shard);
  const strut_slots_description *own = strut_slots_description_of(slots);
  for (int64_t i = own->count - 1; i >= 0 && most > 0; i--) {
    int64_t p = strut_slots_point(slots, i);
    if (strut_slots_done(slots, p)) continue;
    double numbers[] = {0.1 * (double)p, p % 4 ? 1.0 / (double)(p + 1) : (double)NAN};
    char words[1][STRUT_SLOT_WORD];
    snprintf(words[0], sizeof words[0], p % 2 ? "I" : "II, \"b\"");
    strut_result_slot row = {p == 7 ? STRUT_DIVERGED : STRUT_OK, numbers, (const char(*)[24])words,
                             p == 7 ? "node 'a', gone" : NULL};
    assert_ok(strut_slots_put(slots, p, &row, NULL));
    most--;
  }
  strut_slots_close(slots);
}

static char *table_of(int64_t n) {
  strut_merged merged;
  size_t length = 0;
  assert_ok(strut_merge(scratch_path("d"), NULL, NULL, &merged, NULL));
  assert_all_equal(merged.shards, n, merged.points, 23, merged.failed, 1);
  return scratch_read(scratch_path("d/table.csv"), &length);
}

TEST(the_same_table) {
  scratch_make();
  run_shard(study, (strut_shard){0, 0}, 100);
  FREED char *whole = table_of(0);
  static const char begin[] =
      "point,frequency [Hz],outcome,\"a \"\"b\"\", c [m/s]\",status,message\n"
      "0,0,\"II, \"\"b\"\"\",,completed,\n"
      "1,0.1,I,0.5,completed,\n";
  assert_memory_equal(whole, begin, sizeof begin - 1);
  assert_non_null(strstr(whole, "\n7,0.7000000000000001,I,0.125,diverged,\"node 'a', gone\"\n8,"));
  for (int64_t n = 1; n < 40; n += n < 8 ? 1 : 9) {
    scratch_make();
    for (int64_t k = n - 1; k >= 0; k--) {
      run_shard(study, (strut_shard){k, n}, 1);
      run_shard(study, (strut_shard){k, n}, 100);
    }
    FREED char *merged = table_of(n);
    assert_string_equal(merged, whole);
  }
}

static void expect_merge(strut_status expected, const char *words) {
  strut_merged merged;
  strut_error error = {0};
  assert_int_equal(strut_merge(scratch_path("d"), NULL, NULL, &merged, &error), expected);
  if (!strstr(error.message, words)) fail_msg("\"%s\" lacks \"%s\"", error.message, words);
  assert_false(scratch_exists(scratch_path("d/table.csv")));
}

TEST(what_is_missing) {
  scratch_make();
  expect_merge(STRUT_FILE_TROUBLE, "holds no results of a study");
  run_shard(study, (strut_shard){0, 0}, 20);
  expect_merge(STRUT_FILE_TROUBLE, "3 of 23 points are missing");
  scratch_make();
  run_shard(study, (strut_shard){1, 8}, 100);
  run_shard(study, (strut_shard){2, 8}, 1);
  run_shard(study, (strut_shard){5, 8}, 0);
  expect_merge(STRUT_FILE_TROUBLE,
               ": 5 of 8 shards are missing (0, 3 to 4, 6 to 7), shard 2 lacks 2 of its 3 points, "
               "shard 5 lacks 3 of its 3 points; run these shards again to resume them");
  for (int64_t k = 0; k < 8; k++)
    if (k != 6) run_shard(study, (strut_shard){k, 8}, 100);
  expect_merge(STRUT_FILE_TROUBLE, ": 1 of 8 shards is missing (6); run");
  scratch_make(); /* so many that not all are named */
  for (int64_t k = 0; k < 999; k += 2) run_shard(study, (strut_shard){k, 999}, 0);
  expect_merge(STRUT_FILE_TROUBLE, "499 of 999 shards are missing (1, 3, 5,");
}

TEST(what_does_not_belong_together) {
  strut_error error = {0};
  strut_slots_description other = study;
  other.hash[0] = 8;
  scratch_make();
  run_shard(study, (strut_shard){0, 3}, 100);
  run_shard(other, (strut_shard){2, 3}, 100);
  expect_merge(STRUT_USAGE,
               "shards 0 and 2 belong to different studies, which differ in the model");
  assert_fails(strut_shard_begin(scratch_path("d"), (strut_shard){0, 2}, &error), STRUT_USAGE,
               error, "is divided into 3 shards, not 2");
  assert_fails(strut_shard_begin(scratch_path("d"), (strut_shard){0}, &error), STRUT_USAGE, error,
               "holds 3 shards of the study");
  scratch_make(); /* the same shard under two names */
  run_shard(study, (strut_shard){0, 2}, 100);
  assert_int_equal(link(scratch_path("d/shards/shard-0000-of-0002.slots"),
                        scratch_path("d/shards/shard-0001-of-0002.slots")),
                   0);
  expect_merge(STRUT_USAGE, "holds other points than its name says");
  scratch_make();
  run_shard(study, (strut_shard){0, 0}, 100);
  assert_fails(strut_shard_begin(scratch_path("d"), (strut_shard){0, 2}, &error), STRUT_USAGE,
               error, "holds the study in one piece");
  assert_ok(strut_directory_create(scratch_path("d/shards"), &error));
  strut_file_write_text(scratch_path("d/shards"), "shard-0001-of-0004.slots", "x", NULL);
  expect_merge(STRUT_USAGE, "holds the study twice");
  assert_int_equal(unlink(scratch_path("d/points.slots")), 0);
  expect_merge(STRUT_FILE_TROUBLE, "not a file of study results");
  strut_file_write_text(scratch_path("d/shards"), "shard-0001-of-0003.slots", "x", NULL);
  expect_merge(STRUT_USAGE, "which overlap");
}

TEST(no_memory) {
  scratch_make();
  for (int64_t k = 0; k < 3; k++) run_shard(study, (strut_shard){k, 3}, 100);
  REFUSE_EACH(n, status, 1) {
    strut_merged merged;
    status = refused(n, strut_merge(scratch_path("d"), NULL, NULL, &merged, NULL));
    if (status != STRUT_OK) assert_int_equal(scratch_count(scratch_path("d")), 1);
  }
}

TEST(a_full_disk) {
  strut_error error = {0};
  strut_merged merged;
  const char *disk = scratch_make();
  if (!scratch_mount_small_disk(disk, 20)) skip();
  run_shard(study, (strut_shard){0, 0}, 100);
  char filler[9000] = "";
  memset(filler, 'x', sizeof filler - 1);
  while (strut_file_write_text(disk, "filler", filler, &error) != STRUT_OK)
    filler[strlen(filler) - 1000] = '\0';
  assert_fails(strut_merge(scratch_path("d"), NULL, NULL, &merged, &error), STRUT_FILE_TROUBLE,
               error, "No space left on device");
  assert_false(scratch_exists(scratch_path("d/table.csv")));
  assert_int_equal(scratch_count(scratch_path("d")), 1);
  scratch_unmount(disk);
}
