/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that appear whole or not at all, and directories of them. */
#include <errno.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/output/results.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

/* What the disk is asked for, in order; link options lead calls of fsync and renameat here. */
enum { MOST_ASKED = 16 };
static struct asked {
  bool renames;
  ino_t file; /* synchronised or renamed */
  off_t size; /* of it, then */
} asked[MOST_ASKED];
static int asked_count;
static int fsync_fails; /* with this errno */

int __real_fsync(int descriptor);
int __real_renameat(int from, const char *name, int to, const char *new_name);
int __wrap_fsync(int descriptor);
int __wrap_renameat(int from, const char *name, int to, const char *new_name);

int __wrap_fsync(int descriptor) {
  struct stat found;
  if (fsync_fails) return errno = fsync_fails, -1;
  if (asked_count < MOST_ASKED && fstat(descriptor, &found) == 0)
    asked[asked_count++] = (struct asked){false, found.st_ino, found.st_size};
  return __real_fsync(descriptor);
}

int __wrap_renameat(int from, const char *name, int to, const char *new_name) {
  struct stat found;
  if (asked_count < MOST_ASKED && fstatat(from, name, &found, 0) == 0)
    asked[asked_count++] = (struct asked){true, found.st_ino, found.st_size};
  return __real_renameat(from, name, to, new_name);
}

static void assert_content(const char *path, const char *expected) {
  size_t length = 0;
  FREED char *text = scratch_read(path, &length);
  assert_non_null(text);
  assert_string_equal(text, expected);
}

static const char *folder;

BEFORE_EACH { folder = scratch_make(); }

TEST(a_file_appears_on_commit_only) {
  strut_file file = {0};
  assert_ok(strut_file_open(&file, folder, "a.txt", NULL));
  fputs("hello\n", file.stream);
  fflush(file.stream);
  assert_false(scratch_exists(scratch_path("a.txt")));
  assert_int_equal(scratch_count(folder), 1);
  assert_ok(strut_file_commit(&file, NULL));
  assert_content(scratch_path("a.txt"), "hello\n");
  assert_int_equal(scratch_count(folder), 1);
  assert_null(file.stream);
  strut_file_abandon(&file); /* nothing happens */
  assert_true(scratch_exists(scratch_path("a.txt")));
}

TEST(abandon_keeps_the_old_file) {
  strut_file file = {0};
  assert_ok(strut_file_write_text(folder, "a.txt", "old", NULL));
  assert_ok(strut_file_open(&file, folder, "a.txt", NULL));
  fputs("new", file.stream);
  strut_file_abandon(&file);
  assert_content(scratch_path("a.txt"), "old");
  assert_int_equal(scratch_count(folder), 1);
  assert_ok(strut_file_write_text(folder, "a.txt", "new", NULL));
  assert_content(scratch_path("a.txt"), "new");
}

TEST(permissions_follow_the_umask) {
  struct stat found;
  mode_t before = umask(027);
  assert_ok(strut_file_write_text(folder, "a.txt", "x", NULL));
  umask(before);
  assert_int_equal(stat(scratch_path("a.txt"), &found), 0);
  assert_int_equal(found.st_mode & 0777, 0640);
}

/* A file's bytes are on the disk before its name is, and the name before it is told to be there. */
TEST(the_disk_has_a_file_before_its_name) {
  struct stat above, file;
  char text[5001];
  memset(text, 'x', 5000);
  text[5000] = '\0';
  asked_count = 0;
  assert_ok(strut_file_write_text(folder, "a.txt", text, NULL));
  assert_all_equal(stat(folder, &above), 0, stat(scratch_path("a.txt"), &file), 0);
  assert_int_equal(asked_count, 3);
  assert_true(!asked[0].renames && asked[0].file == file.st_ino && asked[0].size == 5000);
  assert_true(asked[1].renames && asked[1].file == file.st_ino);
  assert_true(!asked[2].renames && asked[2].file == above.st_ino);
}

TEST(a_disk_that_cannot_keep_it_is_reported) {
  strut_error error = {0};
  fsync_fails = EIO;
  strut_status status = strut_file_write_text(folder, "a.txt", "x", &error);
  fsync_fails = 0;
  assert_fails(status, STRUT_FILE_TROUBLE, error, "a.txt");
  assert_int_equal(scratch_count(folder), 0);
}

TEST(two_writers_do_not_meet) {
  strut_file first = {0}, second = {0};
  assert_ok(strut_file_open(&first, folder, "a.txt", NULL));
  assert_ok(strut_file_open(&second, folder, "a.txt", NULL));
  fputs("first", first.stream);
  fputs("second", second.stream);
  assert_ok(strut_file_commit(&first, NULL));
  assert_ok(strut_file_commit(&second, NULL));
  assert_content(scratch_path("a.txt"), "second");
  assert_int_equal(scratch_count(folder), 1);
}

/* What a killed process left goes; what another one writes stays. */
TEST(left_files_go) {
  int ready[2];
  assert_int_equal(pipe(ready), 0);
  pid_t child = fork();
  if (child == 0) {
    strut_file file = {0};
    bool begun = strut_file_open(&file, folder, "a.txt", NULL) == STRUT_OK &&
                 fputs("a part that is longer", file.stream) >= 0 && fflush(file.stream) == 0;
    if (!begun || write(ready[1], "x", 1) != 1) _exit(1);
    for (;;) pause();
  }
  char byte;
  assert_int_equal(read(ready[0], &byte, 1), 1);
  assert_int_equal(scratch_count(folder), 1);
  assert_ok(strut_file_write_text(folder, "a.txt", "new\n", NULL));
  assert_int_equal(scratch_count(folder), 2); /* its writer lives */
  kill(child, SIGKILL);
  assert_int_equal(waitpid(child, NULL, 0), child);
  assert_int_equal(scratch_count(folder), 2);
  assert_ok(strut_file_write_text(folder, "a.txt", "newer\n", NULL));
  assert_int_equal(scratch_count(folder), 1);
  assert_content(scratch_path("a.txt"), "newer\n");
  close(ready[0]);
  close(ready[1]);
}

TEST(messages_name_the_file_and_the_reason) {
  strut_file file = {0};
  strut_error error = {0};
  assert_fails(strut_file_open(&file, scratch_path("no"), "a.txt", &error), STRUT_FILE_TROUBLE,
               error, "no/a.txt': No such file or directory");
  assert_int_equal(mkdir(scratch_path("a.txt"), 0777), 0);
  assert_fails(strut_file_open(&file, scratch_path("."), "a.txt", &error), STRUT_FILE_TROUBLE,
               error, "Is a directory");
}

TEST(directories) {
  strut_error error = {0};
  assert_ok(strut_directory_create(scratch_path("a/b//c/"), &error));
  assert_int_equal(scratch_count(scratch_path("a/b/c")), 0);
  assert_ok(strut_directory_create(scratch_path("a/b"), &error));
  assert_ok(strut_file_write_text(scratch_path("a"), "f", "x", NULL));
  assert_int_equal(strut_directory_create(scratch_path("a/f"), &error), STRUT_FILE_TROUBLE);
  assert_fails(strut_directory_create(scratch_path("a/f/g"), &error), STRUT_FILE_TROUBLE, error,
               "cannot create directory");
  assert_int_equal(strut_directory_create("", &error), STRUT_FILE_TROUBLE);
}

TEST(a_full_disk_leaves_nothing) {
  strut_error error = {0};
  const char *disk = scratch_make();
  if (!scratch_mount_small_disk(disk, 16)) skip();
  FREED char *text = calloc(100001, 1);
  memset(text, 'x', 100000);
  assert_fails(strut_file_write_text(disk, "big", text, &error), STRUT_FILE_TROUBLE, error,
               "No space left on device");
  assert_int_equal(scratch_count(disk), 0);
  strut_file file = {0};
  assert_ok(strut_file_open(&file, disk, "small", &error));
  text[20000] = '\0';
  for (int i = 0; i < 5; i++) fputs(text, file.stream);
  error = (strut_error){0};
  assert_fails(strut_file_commit(&file, &error), STRUT_FILE_TROUBLE, error, "cannot write");
  assert_int_equal(scratch_count(disk), 0);
  scratch_unmount(disk);
}

TEST(no_memory_leaves_nothing) {
  REFUSE_EACH(n, status, 3) {
    status = refused(n, strut_file_write_text(folder, "a", "text", NULL));
    if (status) assert_int_equal(scratch_count(folder), 0);
  }
}

static void write_results(strut_results *results, const char *directory, const char *text,
                          bool energy) {
  assert_ok(strut_results_begin(results, directory, NULL));
  assert_ok(strut_file_write_text(results->stage, "summary.json", text, NULL));
  if (energy) assert_ok(strut_file_write_text(results->stage, "energy.csv", text, NULL));
}

TEST(results_appear_together) {
  strut_results results = {0};
  write_results(&results, scratch_path("out/one"), "1", true);
  assert_false(scratch_exists(scratch_path("out/one/summary.json")));
  assert_ok(strut_results_commit(&results, NULL));
  assert_int_equal(scratch_count(scratch_path("out/one")), 2);
  assert_content(scratch_path("out/one/energy.csv"), "1");

  write_results(&results, scratch_path("out/one"), "2", false); /* a failure keeps the old ones */
  strut_results_abandon(&results);
  assert_int_equal(scratch_count(scratch_path("out/one")), 2);
  assert_content(scratch_path("out/one/summary.json"), "1");

  assert_ok(strut_file_write_text(scratch_path("out/one"), "mine", "m", NULL));
  write_results(&results, scratch_path("out/one"), "3", false); /* no mix of two runs */
  assert_ok(strut_results_commit(&results, NULL));
  assert_content(scratch_path("out/one/summary.json"), "3");
  assert_false(scratch_exists(scratch_path("out/one/energy.csv")));
  assert_content(scratch_path("out/one/mine"), "m");
  assert_int_equal(scratch_count(scratch_path("out/one")), 2);
}

TEST(abandoned_results_leave_no_directory) {
  strut_results results = {0};
  write_results(&results, scratch_path("new"), "1", true);
  strut_results_abandon(&results);
  assert_int_equal(scratch_count(scratch_path("new")), -1);
  strut_results_abandon(&results);
}

TEST(results_know_early_what_will_fail) {
  strut_results results = {0};
  strut_error error = {0};
  assert_ok(strut_directory_create(scratch_path("out/nodes.csv"), NULL));
  assert_fails(strut_results_begin(&results, scratch_path("out"), &error), STRUT_FILE_TROUBLE,
               error, "out/nodes.csv': Is a directory");
  assert_int_equal(scratch_count(scratch_path("out")), 1);
  assert_fails(strut_results_begin(&results, "/proc/strut", &error), STRUT_FILE_TROUBLE, error,
               "/proc/strut");
  assert_fails(strut_results_begin(&results, "/proc", &error), STRUT_FILE_TROUBLE, error,
               "'/proc'");
}

TEST(results_without_memory) {
  strut_results results = {0};
  REFUSE_EACH(n, status, 0) {
    strut_fail_allocation_after(n);
    status = strut_results_begin(&results, scratch_path("out"), NULL);
    if (status == STRUT_OK) status = strut_results_commit(&results, NULL);
    granted_again((strut_status)status);
    if (status) assert_false(scratch_exists(scratch_path("out")));
  }
}

/* A process that ends without removing its stage, as one that is killed. */
static void leave_a_stage(const char *directory) {
  pid_t child = fork();
  if (child == 0) {
    strut_results results = {0};
    if (strut_results_begin(&results, directory, NULL) != STRUT_OK) _exit(1);
    _exit(strut_file_write_text(results.stage, "nodes.csv", "half", NULL) != STRUT_OK);
  }
  int status = 1;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_int_equal(status, 0);
}

TEST(stages_of_dead_processes_go) {
  strut_results alive = {0}, next = {0};
  FREED char *out = strdup(scratch_path("out"));
  assert_ok(strut_results_begin(&alive, out, NULL));
  assert_ok(strut_file_write_text(alive.stage, "nodes.csv", "mine", NULL));
  leave_a_stage(out);
  assert_int_equal(scratch_count(out), 2);
  assert_int_equal(mkdir(scratch_path("out/.strut-stage-7-0"), 0777), 0); /* killed at once */
  assert_int_equal(mkdir(scratch_path("out/.strut-stage-8-0"), 0777), 0);
  assert_int_equal(strut_file_write_text(scratch_path("out/.strut-stage-8-0"), "x", "x", NULL), 0);
  assert_ok(strut_results_begin(&next, out, NULL));
  assert_int_equal(scratch_count(out), 3); /* the living, the next, the one without a mark */
  assert_true(scratch_exists(scratch_path("out/.strut-stage-8-0/x")));
  assert_ok(strut_results_commit(&alive, NULL));
  assert_content(scratch_path("out/nodes.csv"), "mine");
  strut_results_abandon(&next);
  assert_int_equal(scratch_count(out), 2);
}

enum { WRITERS = 6 }; /* more than processors, so that the reader is interrupted now and then */

/* Puts ever other bytes where strut's file is, as another process of a sweep does. */
static void write_again_and_again(const char *directory, int writer) {
  static const char *const names[] = {"model.yaml", NULL};
  char stage[200], from[220];
  snprintf(stage, sizeof stage, "%s/stage-%d", directory, writer);
  snprintf(from, sizeof from, "%s/model.yaml", stage);
  if (mkdir(stage, 0777) != 0) _exit(1);
  for (int i = 0; i < 250; i++) {
    FILE *file = fopen(from, "wb");
    if (!file || fprintf(file, "%d %d\n", i, writer) < 1 || fclose(file) != 0) _exit(2);
    if (strut_stage_move(stage, directory, names, NULL) != STRUT_OK) _exit(3);
  }
  _exit(0);
}

TEST(a_file_that_other_processes_write_is_struts_own) {
  static const char *const names[] = {"model.yaml", NULL};
  const char *out = scratch_make();
  int refused = 0, code = 0;
  for (int i = 0; i < WRITERS; i++) {
    pid_t writer = fork();
    assert_true(writer >= 0);
    if (writer == 0) write_again_and_again(out, i);
  }
  for (int running = WRITERS; running > 0;) {
    refused += strut_ownership_check(out, names, NULL) != STRUT_OK;
    if (waitpid(-1, &code, WNOHANG) <= 0) continue;
    assert_int_equal(code, 0);
    running--;
  }
  assert_int_equal(refused, 0);
}
