/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sweep itself: each point is computed once whatever kills it, and what a point costs besides. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "engine/study/results/study_table.h"
#include "engine/study/sweep/sweep.h"
#include "tests/support/test.h"
#include "tests/unit/scratch.h"

/* The thread sanitizer's own threads do not outlive a fork, and memory and time are its own. */
#if defined(__SANITIZE_THREAD__)
#define THREADS_WATCHED true
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define THREADS_WATCHED true
#endif
#endif
#ifndef THREADS_WATCHED
#define THREADS_WATCHED false
#endif

enum { POINTS = 400, MOST_KILLS = 30, THREADS = 2, MANY = THREADS_WATCHED ? 20000 : 1000000 };

/* Scenes that there are none of: the point fails at once, and nothing but the sweep costs time. */
typedef struct log {
  int file; /* -1: none */
} log_t;

static strut_status no_scene(void *context, const strut_study_value *values, strut_setup *setup,
                             strut_error *error) {
  log_t *log = context;
  (void)setup;
  if (log->file >= 0) {
    int32_t point = (int32_t)values[0].number;
    struct timespec pause = {0, 500000};
    if (write(log->file, &point, sizeof point) != sizeof point) abort();
    nanosleep(&pause, NULL);
  }
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "no scene"); /* a number would cost more than it all */
}

static strut_study_column column = {.name = "a", .unit = "m", .kind = STRUT_RANGE_STEP, .step = 1};
static strut_study_axis axis = {.column_count = 1, .columns = &column};
static const strut_study study = {.name = "test", .axis_count = 1, .axes = &axis};
static strut_slot_column columns[] = {{"a", "m", false}, {"velocity", "m/s", false}};

static strut_sweep_plan plan_of(int64_t points, log_t *log) {
  axis.count = points;
  return (strut_sweep_plan){.study = &study,
                            .scenes = {no_scene, NULL, log},
                            .points = points,
                            .axis_columns = 1,
                            .column_count = 2,
                            .columns = columns};
}

static strut_status sweep(const char *path, int64_t points, log_t *log, strut_sweep_state *state) {
  strut_sweep_plan plan = plan_of(points, log);
  const strut_slots_description file = {.version = "0",
                                        .name = "test",
                                        .points = points,
                                        .count = points,
                                        .columns = columns,
                                        .column_count = 2};
  strut_slots *slots;
  strut_status status = strut_slots_open(path, &file, &slots, NULL);
  if (status) return status;
  status = strut_sweep_run(&plan, slots, &(strut_sweep_options){.threads = THREADS}, state, NULL);
  strut_slots_close(slots);
  return status;
}

/* Runs in a child that is killed after some milliseconds. True where it had come to its end. */
static bool run_and_kill(const char *path, log_t *log, int milliseconds) {
  struct timespec pause = {0, milliseconds * 1000000L};
  int status = 0;
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    strut_sweep_state state;
    _exit(sweep(path, POINTS, log, &state) == STRUT_OK ? 0 : 1);
  }
  nanosleep(&pause, NULL);
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/* First of all tests: a process that has threads of its own may not fork into more. */
TEST(nothing_is_computed_twice) {
  if (THREADS_WATCHED) skip();
  scratch_make();
  const char *path = scratch_path("slots");
  log_t log = {open(scratch_path("log"), O_RDWR | O_CREAT | O_APPEND, 0600)};
  assert_true(log.file >= 0);
  int kills = 0;
  bool done = false;
  srand(7);
  for (; kills < MOST_KILLS && !done; kills++) done = run_and_kill(path, &log, 2 + rand() % 20);
  while (!done) done = run_and_kill(path, &log, 900);
  int32_t seen[POINTS] = {0}, point, again = 0;
  for (off_t at = 0; pread(log.file, &point, sizeof point, at) == sizeof point;
       at += (off_t)sizeof point)
    seen[point]++;
  for (int i = 0; i < POINTS; i++) {
    assert_true(seen[i] >= 1);
    again += seen[i] - 1;
  }
  print_message("%d kills, %d points computed again\n", kills, again);
  assert_true(kills > 3);
  assert_true(again <= THREADS * kills); /* those in flight */
  close(log.file);
}

/* The table of a file of slots: CPU time of a point [s]. */
static double table_of(const char *folder, const char *path) {
  strut_slots *slots;
  strut_slots_description plan;
  double began = test_seconds();
  assert_ok(strut_slots_read(path, &slots, &plan, NULL));
  assert_ok(strut_study_table_write(folder, "table", &(strut_slot_rows){&slots, 1, NULL, 0, false},
                                    NULL, NULL));
  strut_slots_close(slots);
  return (test_seconds() - began) / MANY;
}

/* Bounds that a busy machine keeps; what they are stands in the message. */
TEST(a_million_points_cost_little) {
  const char *folder = scratch_make(), *path = scratch_path("slots");
  log_t log = {-1};
  strut_sweep_state end;
  struct rusage before, after;
  getrusage(RUSAGE_SELF, &before);
  double began = test_seconds();
  assert_ok(sweep(path, MANY, &log, &end));
  double cost = (test_seconds() - began) / MANY, table = table_of(folder, path);
  getrusage(RUSAGE_SELF, &after);
  assert_true(end.done == MANY && end.failed == MANY && end.computed == MANY);
  print_message("%.2f us of CPU a point and %.2f us for its row of the table, %ld kB more\n",
                1e6 * cost, 1e6 * table, after.ru_maxrss - before.ru_maxrss);
  assert_true(THREADS_WATCHED || cost + table < 20e-6); /* without optimisation too */
  assert_true(THREADS_WATCHED ||
              after.ru_maxrss - before.ru_maxrss < 4000); /* a bit each is 122 kB */
  began = test_seconds();
  assert_ok(sweep(path, MANY, &log, &end));
  assert_true(end.computed == 0 && end.failed == MANY);
  print_message("%.2f us of CPU a point that is done\n", 1e6 * (test_seconds() - began) / MANY);
}
