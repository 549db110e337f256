/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The slots of a study on disk: whatever happens to the file, a row is whole or missing. */
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/study/results/slots.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

static const strut_slot_column columns[] = {
    {"frequency", "Hz", false}, {"start", "", true}, {"velocity", "m/s", false}};

static strut_slots_description a_plan(int64_t points) {
  strut_slots_description plan = {.hash = {1, 2, 3}, .version = "1.2.3", .name = "study"};
  plan.points = plan.count = points, plan.columns = columns, plan.column_count = 3;
  return plan;
}

/* The row of a point: every fifth one failed. */
static strut_status put(strut_slots *slots, int64_t point, strut_error *error) {
  double numbers[] = {0.1 * (double)point, point % 3 ? -1.0 / (double)point : (double)NAN};
  char words[1][STRUT_SLOT_WORD], message[64];
  snprintf(words[0], sizeof words[0], "state %d", (int)(point % 7));
  snprintf(message, sizeof message, "gone at t = %d s", (int)point);
  bool failed = point % 5 == 4;
  strut_result_slot row = {failed ? STRUT_DIVERGED : STRUT_OK, numbers, (const char(*)[24])words,
                           failed ? message : NULL};
  return strut_slots_put(slots, point, &row, error);
}

static void check_row(strut_slots *slots, int64_t point) {
  strut_result_slot row;
  char word[STRUT_SLOT_WORD], message[64] = "";
  assert_true(strut_slots_done(slots, point));
  assert_true(strut_slots_get(slots, point, &row));
  snprintf(word, sizeof word, "state %d", (int)(point % 7));
  if (point % 5 == 4) snprintf(message, sizeof message, "gone at t = %d s", (int)point);
  assert_int_equal(row.status, point % 5 == 4 ? STRUT_DIVERGED : STRUT_OK);
  assert_same_bits(row.numbers[0], 0.1 * (double)point);
  assert_same_bits(row.numbers[1], point % 3 ? -1.0 / (double)point : (double)NAN);
  assert_all_texts(row.words[0], word, row.message, message);
}

static strut_slots *open_slots(const char *path, const strut_slots_description *plan) {
  strut_slots *slots = NULL;
  assert_ok(strut_slots_open(path, plan, &slots, NULL));
  return slots;
}

static strut_slots *read_slots(const char *path) {
  strut_slots *slots = NULL;
  strut_slots_description plan;
  assert_ok(strut_slots_read(path, &slots, &plan, NULL));
  return slots;
}

static void write_bytes(const char *path, const char *bytes, size_t length) {
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  assert_int_equal(fwrite(bytes, 1, length, stream), length);
  assert_int_equal(fclose(stream), 0);
}

/* A finished file of some points, put in any order. */
static void make_file(const char *path, int64_t points) {
  strut_slots_description plan = a_plan(points);
  strut_slots *slots = open_slots(path, &plan);
  for (int64_t i = 0; i < points; i++)
    assert_int_equal(put(slots, (i * 7 + 3) % points, NULL), STRUT_OK);
  assert_int_equal(strut_slots_missing(slots), 0);
  strut_slots_close(slots);
}

/* A slot of such a file. */
enum { SLOT = 24 + 2 * 8 + 24 + STRUT_SLOT_MESSAGE };

BEFORE_EACH { scratch_make(); }

TEST(rows_come_back) {
  const char *path = scratch_path("a.slots");
  strut_slots_description plan = a_plan(1000), there;
  strut_slots *slots = open_slots(path, &plan);
  assert_int_equal(strut_slots_missing(slots), 1000);
  uint64_t before = strut_allocation_count();
  for (int64_t i = 999; i >= 500; i--) assert_int_equal(put(slots, i, NULL), STRUT_OK);
  assert_int_equal(strut_allocation_count(), before);
  assert_all_equal(strut_slots_missing(slots), 500, strut_slots_failed(slots), 100);
  check_row(slots, 999);
  strut_result_slot row;
  assert_false(strut_slots_get(slots, 499, &row));
  assert_int_equal(put(slots, 499, NULL), STRUT_OK);
  check_row(slots, 499);
  strut_slots_close(slots);
  slots = open_slots(path, &plan); /* the same again goes on */
  assert_int_equal(strut_slots_missing(slots), 499);
  for (int64_t i = 0; i < 499; i++) assert_int_equal(put(slots, i, NULL), STRUT_OK);
  assert_int_equal(strut_slots_sync(slots, NULL), STRUT_OK);
  strut_slots_close(slots);
  assert_int_equal(strut_slots_read(path, &slots, &there, NULL), STRUT_OK);
  assert_all_equal(strut_slots_missing(slots), 0, strut_slots_failed(slots), 200);
  for (int64_t i = 0; i < 1000; i++) check_row(slots, i);
  assert_all_texts(there.version, "1.2.3", there.columns[2].unit, "m/s");
  assert_all(there.columns[1].word, there.points == 1000);
  strut_slots_close(slots);
}

TEST(some_points_only) {
  strut_error error = {0};
  strut_slots_description plan = a_plan(100);
  plan.first = 3, plan.stride = 8, plan.count = 13; /* 3, 11, ..., 99 */
  strut_slots *slots = open_slots(scratch_path("a"), &plan);
  assert_int_equal(strut_slots_point(slots, 12), 99);
  assert_int_equal(put(slots, 4, &error), STRUT_USAGE);
  assert_int_equal(put(slots, 107, &error), STRUT_USAGE);
  for (int64_t i = 0; i < 13; i++) assert_int_equal(put(slots, 3 + 8 * i, NULL), STRUT_OK);
  assert_fails(put(slots, 11, &error), STRUT_USAGE, error, "has its result already");
  assert_int_equal(strut_slots_missing(slots), 0);
  for (int64_t i = 0; i < 13; i++) check_row(slots, 3 + 8 * i);
  strut_slots_close(slots);
  plan.count = 14;
  assert_int_equal(strut_slots_open(scratch_path("b"), &plan, &slots, &error), STRUT_USAGE);
  assert_false(scratch_exists(scratch_path("b")));
  plan = a_plan(3);
  plan.first = 5, plan.stride = 8, plan.count = 0; /* a shard of a study with fewer points */
  slots = open_slots(scratch_path("c"), &plan);
  assert_int_equal(strut_slots_missing(slots), 0);
  assert_int_equal(put(slots, 5, NULL), STRUT_USAGE);
  strut_slots_close(slots);
}

TEST(the_bytes_do_not_depend_on_the_order) {
  size_t length = 0;
  make_file(scratch_path("a"), 20);
  strut_slots_description plan = a_plan(20);
  for (int64_t i = 0; i < 20; i++) { /* opened anew for each */
    strut_slots *slots = open_slots(scratch_path("b"), &plan);
    assert_int_equal(put(slots, i, NULL), STRUT_OK);
    strut_slots_close(slots);
  }
  FREED char *a = scratch_read(scratch_path("a"), &length);
  scratch_expect(scratch_path("b"), a, length);
}

/* Cut at many lengths, close by all ends of slots and fields: rows are whole or missing, and the rest can be computed again. */
TEST(a_file_that_is_cut) {
  size_t length = 0;
  make_file(scratch_path("a"), 5);
  FREED char *bytes = scratch_read(scratch_path("a"), &length);
  strut_slots_description plan = a_plan(5);
  int64_t header = (int64_t)length - 5 * SLOT;
  assert_true(header > 0 && header % 64 == 0);
  for (size_t cut = 0; cut <= length; cut += cut % 64 < 2 || cut % 64 > 61 ? 1 : 29) {
    write_bytes(scratch_path("b"), bytes, cut);
    strut_slots *slots = open_slots(scratch_path("b"), &plan);
    int64_t whole = (int64_t)cut < header ? 0 : ((int64_t)cut - header) / SLOT;
    assert_int_equal(strut_slots_missing(slots), 5 - whole);
    for (int64_t i = 0; i < whole; i++) check_row(slots, i);
    for (int64_t i = whole; i < 5; i++) {
      assert_all(!strut_slots_done(slots, i), !strut_slots_get(slots, i, &(strut_result_slot){0}));
      assert_ok(put(slots, i, NULL));
    }
    strut_slots_close(slots);
    scratch_expect(scratch_path("b"), bytes, length);
  }
}

/* One bit turned anywhere: a slot is missing then, a header is refused, nothing else changes. */
TEST(a_bit_flipped_anywhere) {
  size_t length = 0;
  make_file(scratch_path("a"), 3);
  FREED char *bytes = scratch_read(scratch_path("a"), &length);
  size_t header = length - 3 * SLOT;
  for (size_t at = 0; at < length; at++)
    for (int bit = 0; bit < 8; bit += at < header + 64 ? 1 : 7) {
      strut_slots *slots = NULL;
      strut_slots_description plan = a_plan(3);
      strut_error error = {0};
      bytes[at] = (char)(bytes[at] ^ 1 << bit);
      write_bytes(scratch_path("b"), bytes, length);
      bytes[at] = (char)(bytes[at] ^ 1 << bit);
      strut_status status = strut_slots_open(scratch_path("b"), &plan, &slots, &error);
      if (at < header) {
        assert_int_equal(status, STRUT_FILE_TROUBLE);
        assert_null(slots);
        continue;
      }
      assert_int_equal(status, STRUT_OK);
      int64_t hit = (int64_t)((at - header) / SLOT);
      assert_int_equal(strut_slots_missing(slots), 1);
      for (int64_t i = 0; i < 3; i++) assert_int_equal(strut_slots_done(slots, i), i != hit);
      strut_slots_close(slots);
    }
}

/* A slot of the right bytes in the wrong place, or of another study, is none. */
TEST(slots_of_elsewhere) {
  size_t length = 0, other_length = 0;
  make_file(scratch_path("a"), 3);
  FREED char *bytes = scratch_read(scratch_path("a"), &length);
  size_t header = length - 3 * SLOT;
  strut_slots_description plan = a_plan(3);
  FREED char *copy = malloc(length);
  memcpy(copy, bytes, length);
  memcpy(copy + header, bytes + header + SLOT, SLOT);
  write_bytes(scratch_path("b"), copy, length);
  strut_slots *slots = open_slots(scratch_path("b"), &plan);
  assert_all(!strut_slots_done(slots, 0), strut_slots_done(slots, 1));
  strut_slots_close(slots);
  plan.hash[7] ^= 1;
  slots = open_slots(scratch_path("c"), &plan);
  assert_int_equal(put(slots, 2, NULL), STRUT_OK);
  strut_slots_close(slots);
  FREED char *other = scratch_read(scratch_path("c"), &other_length);
  assert_int_equal(other_length, length);
  memcpy(other + header, bytes + header, SLOT);
  write_bytes(scratch_path("c"), other, length);
  slots = open_slots(scratch_path("c"), &plan);
  assert_false(strut_slots_done(slots, 0));
  strut_slots_close(slots);
}

/* expect PLAN: the file at `path` is refused with a sentence that has these words. */
static void expect_refused(const char *path, const strut_slots_description *plan,
                           strut_status expected, const char *words) {
  strut_slots *slots = NULL;
  strut_error error = {0};
  assert_int_equal(strut_slots_open(path, plan, &slots, &error), expected);
  assert_null(slots);
  check_words(error.message, (const char *[]){words, path, NULL}, __FILE__, __LINE__);
}

TEST(other_studies_are_refused) {
  const char *path = scratch_path("a");
  size_t length = 0;
  make_file(path, 9);
  FREED char *bytes = scratch_read(path, &length);
  strut_slots_description plan = a_plan(9);
  plan.hash[15] = 1;
  expect_refused(path, &plan, STRUT_USAGE,
                 "differs in the model, its data, its parameters or the axes:");
  plan = a_plan(9);
  plan.version = "1.2.4";
  expect_refused(path, &plan, STRUT_USAGE, "differs in the version of strut (1.2.3, now 1.2.4)");
  plan = a_plan(10);
  expect_refused(path, &plan, STRUT_USAGE, "the number of points (9, now 10)");
  plan = a_plan(9);
  plan.column_count = 2;
  expect_refused(path, &plan, STRUT_USAGE, "the columns");
  plan = a_plan(9);
  plan.stride = 2, plan.count = 5;
  expect_refused(path, &plan, STRUT_USAGE, "their points");
  scratch_expect(path, bytes, length);
}

TEST(foreign_files_are_refused) {
  strut_slots_description plan = a_plan(9);
  const char *path = scratch_path("a");
  size_t length = 0;
  write_bytes(path, "frequency,velocity\n1,2\n", 23);
  expect_refused(path, &plan, STRUT_FILE_TROUBLE, "not a file of study results");
  FREED char *text = scratch_read(path, &length);
  assert_string_equal(text, "frequency,velocity\n1,2\n");
  make_file(scratch_path("b"), 9);
  FREED char *bytes = scratch_read(scratch_path("b"), &length);
  const char mark[4] = {bytes[8], bytes[9], bytes[10], bytes[11]}; /* of the order of bytes */
  for (int i = 0; i < 4; i++) bytes[8 + i] = mark[3 - i];
  write_bytes(path, bytes, length);
  expect_refused(path, &plan, STRUT_FILE_TROUBLE, "another byte order");
  memcpy(bytes + 8, mark, sizeof mark);
  bytes[12] = 2;
  write_bytes(path, bytes, length);
  expect_refused(path, &plan, STRUT_FILE_TROUBLE, "format 2");
  expect_refused(scratch_path("no/such"), &plan, STRUT_FILE_TROUBLE, "No such file");
  expect_refused(scratch_path("."), &plan, STRUT_FILE_TROUBLE, "Is a directory");
}

TEST(one_writer_at_a_time) {
  const char *path = scratch_path("a");
  strut_slots_description plan = a_plan(9);
  strut_slots *slots = open_slots(path, &plan);
  assert_int_equal(put(slots, 0, NULL), STRUT_OK);
  pid_t child = fork();
  if (child == 0) {
    strut_slots *other = NULL;
    strut_slots_description there;
    strut_error error = {0};
    bool refused = strut_slots_open(path, &plan, &other, &error) == STRUT_FILE_TROUBLE &&
                   strstr(error.message, "is writing");
    bool reads = strut_slots_read(path, &other, &there, &error) == STRUT_OK &&
                 strut_slots_done(other, 0) && strut_slots_missing(other) == 8;
    _exit(refused ? reads ? 0 : 2 : 1);
  }
  int how = 0;
  waitpid(child, &how, 0);
  assert_true(WIFEXITED(how));
  assert_int_equal(WEXITSTATUS(how), 0);
  strut_slots_close(slots);
  strut_slots_close(open_slots(path, &plan));
}

static strut_slots *share_slots(const char *path, const strut_slots_description *plan) {
  strut_slots *slots = NULL;
  return strut_slots_open_shared(path, plan, &slots, NULL) ? NULL : slots;
}

/* In a process of its own: claims 3, puts 4, tells so, and stays until it is killed. */
static void hold_points(const char *path, const strut_slots_description *plan, int tell) {
  strut_slots *slots = share_slots(path, plan);
  bool fine = slots && strut_slots_claim(slots, 3) && strut_slots_claim(slots, 4) &&
              put(slots, 4, NULL) == STRUT_OK;
  alarm(60); /* should the test fail */
  if (write(tell, fine ? "y" : "n", 1) == 1) pause();
  _exit(1);
}

TEST(claims_end_with_their_process) {
  const char *path = scratch_path("a");
  strut_slots_description plan = a_plan(9);
  char told = 0;
  int ends[2], how;
  assert_int_equal(pipe(ends), 0);
  strut_slots *slots = share_slots(path, &plan);
  assert_non_null(slots);
  pid_t child = fork();
  if (child == 0) hold_points(path, &plan, ends[1]);
  assert_int_equal(read(ends[0], &told, 1), 1);
  assert_int_equal(told, 'y');
  assert_false(strut_slots_claim(slots, 3));
  assert_false(strut_slots_done(slots, 3));
  assert_false(strut_slots_done(slots, 4)); /* not read yet */
  assert_false(strut_slots_claim(slots, 4));
  check_row(slots, 4);
  assert_int_equal(strut_slots_failed(slots), 1);
  assert_true(strut_slots_claim(slots, 5));
  pid_t other = fork();
  if (other == 0) {
    strut_slots *alone = NULL;
    _exit(strut_slots_open(path, &plan, &alone, NULL) == STRUT_FILE_TROUBLE ? 0 : 1);
  }
  waitpid(other, &how, 0);
  assert_true(WIFEXITED(how) && WEXITSTATUS(how) == 0);
  kill(child, SIGKILL);
  waitpid(child, &how, 0);
  assert_true(strut_slots_claim(slots, 3));
  assert_int_equal(put(slots, 3, NULL), STRUT_OK);
  assert_int_equal(strut_slots_missing(slots), 7);
  strut_slots_close(slots);
  close(ends[0]);
  close(ends[1]);
}

typedef struct worker {
  strut_slots *slots;
  int64_t from;
  bool good;
} worker;

static void *work(void *context) {
  worker *w = context;
  w->good = true;
  for (int64_t i = w->from; i < 8000; i += 4)
    w->good = w->good && put(w->slots, i, NULL) == STRUT_OK;
  return NULL;
}

TEST(threads) {
  strut_slots_description plan = a_plan(8000);
  strut_slots *slots = open_slots(scratch_path("a"), &plan);
  pthread_t threads[4];
  worker workers[4];
  for (int i = 0; i < 4; i++) {
    workers[i] = (worker){slots, i, false};
    assert_int_equal(pthread_create(&threads[i], NULL, work, &workers[i]), 0);
  }
  for (int i = 0; i < 4; i++) {
    pthread_join(threads[i], NULL);
    assert_true(workers[i].good);
  }
  assert_all_equal(strut_slots_missing(slots), 0, strut_slots_failed(slots), 1600);
  strut_slots_close(slots);
  slots = read_slots(scratch_path("a"));
  for (int64_t i = 0; i < 8000; i++) check_row(slots, i);
  strut_slots_close(slots);
}

/* Texts that are too long are cut between characters; nothing breaks a line of the table. */
TEST(texts_that_do_not_fit) {
  strut_slots_description plan = a_plan(2);
  strut_slots *slots = open_slots(scratch_path("a"), &plan);
  char message[401] = "", words[1][STRUT_SLOT_WORD];
  for (int i = 0; i < 200; i++) strcat(message, "\xC3\xA9");
  memset(words[0], 'w', sizeof words[0]); /* without an end */
  double numbers[] = {-(double)NAN, HUGE_VAL};
  strut_result_slot row = {STRUT_SINGULAR, numbers, (const char(*)[24])words, message};
  assert_int_equal(strut_slots_put(slots, 0, &row, NULL), STRUT_OK);
  row.message = "two\nlines\tof\x7Ftext";
  assert_int_equal(strut_slots_put(slots, 1, &row, NULL), STRUT_OK);
  assert_true(strut_slots_get(slots, 0, &row));
  assert_int_equal(strlen(row.message), 158);
  assert_memory_equal(row.message, message, 158);
  assert_int_equal(strlen(row.words[0]), STRUT_SLOT_WORD - 1);
  assert_same_bits(row.numbers[0], (double)NAN);
  assert_true(strut_slots_get(slots, 1, &row));
  assert_string_equal(row.message, "two lines of text");
  strut_slots_close(slots);
}

/* No room: a complaint, a missing point, and all well when there is room again. */
TEST(a_full_disk) {
  strut_slots_description plan = a_plan(200);
  strut_slots *slots = open_slots(scratch_path("a"), &plan);
  struct rlimit before, small;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  small = before;
  small.rlim_cur = 10001; /* in the middle of a slot */
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  strut_error error = {0};
  int64_t put_well = 0;
  while (put_well < 200 && put(slots, put_well, &error) == STRUT_OK) put_well++;
  assert_true(put_well > 10 && put_well < 100);
  assert_fails(error.status, STRUT_FILE_TROUBLE, error, "cannot write");
  assert_false(strut_slots_done(slots, put_well));
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  strut_slots_close(slots);
  slots = open_slots(scratch_path("a"), &plan);
  assert_int_equal(strut_slots_missing(slots), 200 - put_well);
  for (int64_t i = put_well; i < 200; i++) assert_int_equal(put(slots, i, NULL), STRUT_OK);
  for (int64_t i = 0; i < 200; i++) check_row(slots, i);
  strut_slots_close(slots);
}

TEST(a_full_small_disk) {
  const char *disk = scratch_make();
  if (!scratch_mount_small_disk(disk, 64)) skip();
  strut_slots_description plan = a_plan(1000);
  strut_slots *slots = open_slots(scratch_path("a"), &plan);
  strut_error error = {0};
  int64_t put_well = 0;
  while (put_well < 1000 && put(slots, put_well, &error) == STRUT_OK) put_well++;
  assert_all(put_well < 1000, strstr(error.message, "No space left on device"));
  strut_slots_close(slots);
  slots = open_slots(scratch_path("a"), &plan);
  assert_int_equal(strut_slots_missing(slots), 1000 - put_well);
  strut_slots_close(slots);
  scratch_unmount(disk);
}

TEST(no_memory) {
  strut_slots_description plan = a_plan(100), there;
  make_file(scratch_path("a"), 100);
  for (int mode = 0; mode < 3; mode++) {
    REFUSE_EACH(n, status, 0) {
      strut_slots *slots = NULL;
      status = refused(n, mode == 0   ? strut_slots_open(scratch_path("a"), &plan, &slots, NULL)
                          : mode == 1 ? strut_slots_read(scratch_path("a"), &slots, &there, NULL)
                                      : strut_slots_open(scratch_path("new"), &plan, &slots, NULL));
      if (status == STRUT_OK) assert_int_equal(strut_slots_missing(slots), mode < 2 ? 0 : 100);
      strut_slots_close(slots);
    }
  }
}

/* Rows that failed are missing until they have others; in the file they stay till then. */
TEST(failed_rows_once_more) {
  const char *path = scratch_path("a.slots");
  const double numbers[] = {1.0, 2.0};
  const char words[1][STRUT_SLOT_WORD] = {"well"};
  const strut_result_slot good = {STRUT_OK, numbers, words, NULL};
  strut_slots_description plan = a_plan(1000);
  strut_result_slot row;
  make_file(path, 1000);
  strut_slots *slots = open_slots(path, &plan);
  assert_int_equal(strut_slots_failed(slots), 200);
  assert_int_equal(strut_slots_retry(slots, NULL), STRUT_OK);
  assert_all_equal(strut_slots_failed(slots), 0, strut_slots_missing(slots), 200);
  assert_all(!strut_slots_done(slots, 4), strut_slots_done(slots, 5));
  assert_int_equal(strut_slots_put(slots, 4, &good, NULL), STRUT_OK);
  assert_int_equal(strut_slots_put(slots, 5, &good, NULL), STRUT_USAGE);
  assert_int_equal(put(slots, 9, NULL), STRUT_OK); /* fails again */
  assert_all_equal(strut_slots_missing(slots), 198, strut_slots_failed(slots), 1);
  strut_slots_close(slots);
  slots = read_slots(path);
  assert_all_equal(strut_slots_missing(slots), 0, strut_slots_failed(slots), 199);
  assert_true(strut_slots_get(slots, 4, &row));
  assert_int_equal(row.status, STRUT_OK);
  assert_string_equal(row.words[0], "well");
  check_row(slots, 9);
  check_row(slots, 14);
  strut_slots_close(slots);
}
