/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that other files name: what is below the folder is read, all else refused and never opened. */
#include <sys/stat.h>
#include <unistd.h>

#include "parser/language/read/reuse/used_files.h"
#include "tests/support/check.h"
#include "tests/unit/scratch.h"

static void write_text(const char *name, const char *text) {
  FILE *file = fopen(scratch_path(name), "wb");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

/*
 * top/study.yaml, top/points.csv, top/in/part.yaml; beside: secret.csv. Links: top/fine leads to
 * points.csv, top/out and top/outside out, top/deep to in. top/pipe is a FIFO.
 */
BEFORE_ALL {
  scratch_make();
  mkdir(scratch_path("top"), 0700);
  mkdir(scratch_path("top/in"), 0700);
  mkdir(scratch_path("topless"), 0700);
  write_text("secret.csv", "secret");
  write_text("topless/points.csv", "other");
  write_text("top/points.csv", "a,b\n1,2\n");
  write_text("top/in/part.yaml", "nodes: {}\n");
  write_text("top/empty", "");
  assert_int_equal(symlink("points.csv", scratch_path("top/fine")), 0);
  assert_int_equal(symlink("../secret.csv", scratch_path("top/out")), 0);
  assert_int_equal(symlink("..", scratch_path("top/outside")), 0);
  assert_int_equal(symlink("in", scratch_path("top/deep")), 0);
  assert_int_equal(symlink("circle", scratch_path("top/circle")), 0);
  assert_int_equal(symlink("/dev/zero", scratch_path("top/zero")), 0);
  assert_int_equal(mkfifo(scratch_path("top/pipe"), 0600), 0);
  assert_int_equal(symlink(scratch_path("top"), scratch_path("link")), 0);
}

static strut_status read_from(const char *root, const char *from, const char *name, size_t most,
                              strut_safe_text *file, strut_error *error) {
  return strut_safe_read(scratch_path(root), scratch_path(from), name, most, file, error);
}

TEST(files_below_the_folder_are_read) {
  strut_safe_text file, same;
  assert_ok(read_from("top", "top/study.yaml", "points.csv", 8, &file, NULL));
  assert_string_equal(file.text, "a,b\n1,2\n");
  assert_int_equal(file.length, 8);
  assert_string_equal(file.path, scratch_path("top/points.csv"));
  assert_ok(read_from("link", "link/study.yaml", "./fine", 8, &same, NULL));
  assert_true(same.inode == file.inode && same.device == file.device);
  strut_safe_text_free(&file);
  strut_safe_text_free(&same);
  assert_ok(read_from("top", "top/study.yaml", "deep/part.yaml", 99, &file, NULL));
  strut_safe_text_free(&file);
  assert_ok(read_from("top", "top/in/x.yaml", "part.yaml", 99, &file, NULL));
  assert_string_equal(file.text, "nodes: {}\n");
  strut_safe_text_free(&file);
  assert_ok(read_from("top", "top/study.yaml", "empty", 0, &file, NULL));
  assert_true(file.length == 0 && *file.text == '\0');
  strut_safe_text_free(&file);
}

TEST(all_else_is_refused) {
  static const struct {
    const char *root, *from, *name;
    strut_status status;
    const char *says;
  } bad[] = {
      {"top", "top/a.yaml", "", STRUT_BAD_SCENE, "expected the path of a file"},
      {"top", "top/a.yaml", "/etc/passwd", STRUT_BAD_SCENE, "is an absolute path"},
      {"top", "top/a.yaml", "../secret.csv", STRUT_BAD_SCENE, "has a '..'"},
      {"top", "top/a.yaml", "in/../../secret.csv", STRUT_BAD_SCENE, "has a '..'"},
      {"top", "top/a.yaml", "in/..", STRUT_BAD_SCENE, "has a '..'"},
      {"top", "top/a.yaml", "out", STRUT_BAD_SCENE, "leads out of the folder"},
      {"top", "top/a.yaml", "outside/secret.csv", STRUT_BAD_SCENE, "leads out of the folder"},
      {"top", "topless/a.yaml", "points.csv", STRUT_BAD_SCENE, "leads out of the folder"},
      {"top", "top/a.yaml", "zero", STRUT_BAD_SCENE, "leads out of the folder"},
      {"top", "top/a.yaml", "pipe", STRUT_BAD_SCENE, "is not a regular file"},
      {"top", "top/a.yaml", "in", STRUT_BAD_SCENE, "is not a regular file"},
      {"top", "top/a.yaml", ".", STRUT_BAD_SCENE, "is not a regular file"},
      {"top", "top/a.yaml", "none.csv", STRUT_FILE_TROUBLE, "No such file"},
      {"top", "top/a.yaml", "circle", STRUT_FILE_TROUBLE, "cannot read"},
      {"none", "none/a.yaml", "none.csv", STRUT_FILE_TROUBLE, "cannot read"}};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    strut_safe_text file;
    strut_error error = {0};
    strut_status status = read_from(bad[i].root, bad[i].from, bad[i].name, 1000, &file, &error);
    if (status != bad[i].status || !strstr(error.message, bad[i].says))
      fail_msg("'%s': status %d, %s", bad[i].name, status, error.message);
    assert_true(!file.text && !file.path);
  }
  strut_safe_text file;
  strut_error error = {0};
  assert_int_equal(strut_safe_read("/dev", "/dev/x", "zero", 1000, &file, &error), STRUT_BAD_SCENE);
  assert_fails(read_from("top", "top/a.yaml", "points.csv", 7, &file, &error), STRUT_BAD_SCENE,
               error, "has 8 bytes, expected at most 7");
}

TEST(every_failed_allocation_is_said) {
  REFUSE_EACH(n, status, 0) {
    OWN(strut_safe_text) file;
    status = refused(n, read_from("top", "top/study.yaml", "points.csv", 8, &file, NULL));
    assert_true(status == STRUT_OK || (!file.text && !file.path));
  }
  OWN(strut_arena) arena = {0};
  assert_string_equal(strut_folder_of("a/b/c.yaml", &arena), "a/b");
  assert_string_equal(strut_folder_of("c.yaml", &arena), ".");
  assert_string_equal(strut_folder_of("-", &arena), ".");
  assert_string_equal(strut_folder_of("/c.yaml", &arena), "/");
}
